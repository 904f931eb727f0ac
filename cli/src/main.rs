//! The `feedwright` command: arguments in, calls of the library, messages out. It converts and never computes.
//!
//! Data go to stdout, messages and progress to stderr. Exit codes: 0 within tolerance, 1 out of tolerance, 2 any error,
//! 130 interrupted. Those of `check`: 0 at most warnings, 1 mistakes in a file, 2 a file that cannot be read.

mod args;
mod commands;
mod console;
mod controllers;
mod files;
mod findings;
mod message;
mod progress;
mod sweep;

use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};
use console::Console;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let console = Console::new(cli.quiet);
    // The others write no files.
    let writes =
        !matches!(cli.command, Command::Check(_) | Command::Canon(_) | Command::Machines | Command::Controllers { .. });
    if writes {
        console.listen();
    }
    let result = match cli.command {
        Command::Run(args) => commands::run::run(*args, &console),
        Command::Paper(args) => commands::paper::run(&args, &console),
        Command::Compare(args) => commands::compare::run(&args, &console),
        Command::NeverWorse(args) => commands::never_worse::run(&args, &console),
        Command::HeldOut(args) => commands::held_out::run(&args, &console),
        Command::Check(args) => commands::check::run(&args, &console),
        Command::Canon(args) => commands::canon::run(&args, &console),
        Command::Machines => commands::list::machines(),
        Command::Controllers { name: None } => commands::list::controllers(),
        Command::Controllers { name: Some(name) } => commands::list::controller(&name),
    };
    match result {
        Ok(code) => code,
        Err(_) if console.is_interrupted() => message::interrupted(),
        Err(report) => message::fail(&report),
    }
}
