//! The `feedwright` command: arguments in, calls of the library, messages out. It converts and never computes.
//!
//! Data go to stdout, messages and progress to stderr. Exit codes: 0 within tolerance, 1 out of tolerance or worse than without a
//! correction, 2 any error, 130 interrupted. Those of `check`: 0 at most warnings, 1 mistakes in a file, 2 a file that cannot be read.

mod terminal;
mod args;
mod message;
mod progress;
mod console;
mod streams;
mod table;
mod files_to_check;
mod findings;
mod controllers;
mod controls;
mod sweep;
mod commands;

use std::process::ExitCode;

use miette::Result;

use args::{Cli, CommandArgs};
use console::Console;

fn main() -> ExitCode {
    let cli = Cli::from_command_line();
    let console = Console::new(cli.quiet);
    if cli.command.writes_files() {
        console.listen();
    }
    match run(cli.command, &console) {
        Ok(code) => code,
        Err(_) if console.is_interrupted() => message::interrupted(),
        Err(report) => message::fail(&report),
    }
}

fn run(command: CommandArgs, console: &Console) -> Result<ExitCode> {
    match command {
        CommandArgs::Run(args) => commands::run::run(*args, console),
        CommandArgs::Correct(args) => commands::correct::run(&args, console),
        CommandArgs::Advise(args) => commands::advise::run(&args, console),
        CommandArgs::Plan(args) => commands::plan::run(&args, console),
        CommandArgs::Identify(args) => commands::identify::run(&args, console),
        CommandArgs::Excite(args) => commands::excite::run(&args, console),
        CommandArgs::Block(args) => commands::block::run(&args, console),
        CommandArgs::Paper(args) => commands::paper::run(&args, console),
        CommandArgs::Compare(args) => commands::compare::run(&args, console),
        CommandArgs::NeverWorse(args) => commands::never_worse::run(&args, console),
        CommandArgs::HeldOut(args) => commands::held_out::run(&args, console),
        CommandArgs::Check(args) => commands::check::run(&args, console),
        CommandArgs::Canon(args) => commands::canon::run(&args, console),
        CommandArgs::Machines => commands::list::machines(),
        CommandArgs::Controllers { name: None } => commands::list::controllers(),
        CommandArgs::Controllers { name: Some(name) } => commands::list::controller(&name),
        CommandArgs::ExportContour(args) => commands::export_contour::run(&args, console),
        CommandArgs::Completions(args) => commands::completions::run(&args, console),
        CommandArgs::Man(args) => commands::man::run(&args, console),
    }
}
