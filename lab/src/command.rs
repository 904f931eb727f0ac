//! The `feedwright-lab` command: what experiments need, and the commands of `feedwright` that take
//! a controller, with all controllers.

mod args;
mod sweep;
mod commands;

use std::process::ExitCode;

use feedwright::command::{Console, controller, controllers, parse, run_part, with_console};
use miette::Result;

use crate::peers::CONTROLLERS;
use args::{Cli, CommandArgs};

/// Runs the command of this process.
pub fn main() -> ExitCode {
    let cli: Cli = parse();
    let writes_files = !matches!(cli.command, CommandArgs::Controllers { .. });
    with_console(cli.common.quiet, writes_files, |console| {
        run(cli.command, console)
    })
}

fn run(command: CommandArgs, console: &Console) -> Result<ExitCode> {
    match command {
        CommandArgs::Run(args) => run_part(*args, CONTROLLERS, console),
        CommandArgs::Controllers { name: None } => controllers(CONTROLLERS),
        CommandArgs::Controllers { name: Some(name) } => controller(&name, CONTROLLERS),
        CommandArgs::Compare(args) => commands::compare::run(&args, console),
        CommandArgs::NeverWorse(args) => commands::never_worse::run(&args, console),
        CommandArgs::HeldOut(args) => commands::held_out::run(&args, console),
        CommandArgs::Mismatch(args) => commands::mismatch::run(&args, console),
        CommandArgs::Independent(args) => commands::independent::run(&args, console),
        CommandArgs::Paper(args) => commands::paper::run(&args, console),
        CommandArgs::ExportContour(args) => commands::export_contour::run(&args, console),
        CommandArgs::BallBar(args) => commands::ball_bar::run(&args, console),
    }
}
