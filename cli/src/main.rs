//! The `feedwright` command: arguments in, calls of the library, messages out. It converts and never computes.
//!
//! Data go to stdout, messages and progress to stderr. Exit codes: 0 within tolerance, 1 out of tolerance, 2 any error,
//! 130 interrupted. Those of `check`: 0 at most warnings, 1 mistakes in a file, 2 a file that cannot be read.

mod args;
mod commands;
mod controllers;
mod files;
mod findings;
mod message;
mod progress;
mod sweep;

use std::process::ExitCode;

use clap::Parser;

use args::{Cli, Command};

fn main() -> ExitCode {
    let cli = Cli::parse();
    if let Err(error) = ctrlc::set_handler(interrupted) {
        eprintln!("warning: an interrupt may leave unfinished files behind: {error}");
    }
    let quiet = cli.quiet;
    let result = match cli.command {
        Command::Run(args) => commands::run::run(*args, quiet),
        Command::Identify(args) => commands::identify::run(&args, quiet),
        Command::Paper(args) => commands::paper::run(&args, quiet),
        Command::Compare(args) => commands::compare::run(&args, quiet),
        Command::NeverWorse(args) => commands::never_worse::run(&args, quiet),
        Command::HeldOut(args) => commands::held_out::run(&args, quiet),
        Command::Check(args) => commands::check::run(&args, quiet),
        Command::Canon(args) => commands::canon::run(&args, quiet),
        Command::Machines => commands::list::machines(),
        Command::Controllers { name: None } => commands::list::controllers(),
        Command::Controllers { name: Some(name) } => commands::list::controller(&name),
    };
    result.unwrap_or_else(|report| message::fail(&report))
}

/// Ctrl-C and a request to terminate: nothing half-written stays.
fn interrupted() {
    feedwright::output::abandon_all();
    eprintln!("interrupted; no file was written");
    std::process::exit(message::INTERRUPTED.into());
}
