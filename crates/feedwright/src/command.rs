//! The `feedwright` command: arguments in, calls of the library, messages out. It converts and
//! never computes.
//!
//! Data go to stdout, messages and progress to stderr. Exit codes: 0 within tolerance, 1 out of
//! tolerance or worse than without a correction, 2 any error, 130 interrupted. Those of `check`: 0
//! at most warnings, 1 mistakes in a file, 2 a file that cannot be read.
//!
//! What is public here serves the laboratory, which has commands of its own and the same look. It
//! may change at any time.

mod date;
mod terminal;
mod args;
mod folded;
mod message;
mod progress;
mod console;
mod streams;
mod table;
mod files_to_check;
mod findings;
mod faults;
mod controls;
mod sweep;
mod hal_watch;
mod page_server;
mod commands;

use std::ffi::OsString;
use std::process::ExitCode;

use miette::Result;

use crate::controllers::CONTROLLERS;
use args::{Cli, CommandArgs, MachinesArgs, parse_from};

pub use crate::request::named::{find, settings};
pub use args::quantity::feed_mm_s;
pub use args::reader::ReaderArgs;
pub use args::run::RunArgs;
pub use args::{COLUMNS, CommonArgs, parse};
pub use commands::list::{controller, controllers};
pub use commands::run::run as run_part;
pub use console::Console;
pub use date::today;
pub use faults::{fault_findings, fault_text, mistake_json};
pub use files_to_check::FilesToCheck;
pub use message::{OUT_OF_TOLERANCE, printed, remark};
pub use streams::{make_folder, report_written, tables};
pub use sweep::job_list::JobList;
pub use sweep::result_table::{RESULT_COLUMNS, ResultColumn, ResultTable};
pub use sweep::{JobDone, do_job};
pub use table::{ConsoleTable, TableColumn};
pub use terminal::wrapped;

/// Runs the command of this process.
pub fn main() -> ExitCode {
    main_of(&std::env::args_os().collect::<Vec<_>>())
}

/// Runs a command line, whose first argument is the name of the command; help, version and mistakes
/// of it end the process.
pub fn main_of(arguments: &[OsString]) -> ExitCode {
    let cli: Cli = parse_from(arguments);
    let writes_files = cli.command.writes_files();
    with_console(cli.common.quiet, writes_files, |console| {
        run(cli.command, console)
    })
}

/// Runs a command, shows its error, and returns its exit code. Where the command writes files, an
/// interrupt ends it between two steps.
pub fn with_console(
    quiet: bool,
    writes_files: bool,
    command: impl FnOnce(&Console) -> Result<ExitCode>,
) -> ExitCode {
    let console = Console::new(quiet);
    if writes_files {
        console.listen();
    }
    match command(&console) {
        Ok(code) => code,
        Err(_) if console.is_interrupted() => message::interrupted(),
        Err(report) => message::fail(&report),
    }
}

fn run(command: CommandArgs, console: &Console) -> Result<ExitCode> {
    match command {
        CommandArgs::Sweep(args) => commands::sweep::run(&args, console),
        CommandArgs::Merge(args) => commands::merge::run(&args, console),
        CommandArgs::Run(args) => commands::run::run(*args, CONTROLLERS, console),
        CommandArgs::Correct(args) => commands::correct::run(&args, console),
        CommandArgs::Advise(args) => commands::advise::run(&args, console),
        CommandArgs::Plan(args) => commands::plan::run(&args, console),
        CommandArgs::Identify(args) => commands::identify::run(&args, console),
        CommandArgs::Excite(args) => commands::excite::run(&args, console),
        CommandArgs::Block(args) => commands::block::run(&args, console),
        CommandArgs::Linuxcnc(args) => commands::linuxcnc::run(&args, console),
        CommandArgs::Diff(args) => commands::diff::run(&args, console),
        CommandArgs::Check(args) => commands::check::run(&args, console),
        CommandArgs::Open(args) => commands::open::run(args, console),
        CommandArgs::Canon(args) => commands::canon::run(&args, console),
        CommandArgs::Machines(MachinesArgs { name: None, .. }) => commands::list::machines(),
        CommandArgs::Machines(MachinesArgs {
            name: Some(name),
            out,
        }) => commands::list::machine(&name, out.as_deref(), console),
        CommandArgs::Controllers { name: None } => controllers(CONTROLLERS),
        CommandArgs::Controllers { name: Some(name) } => controller(&name, CONTROLLERS),
        CommandArgs::Lab(args) => commands::lab::run(&args),
        CommandArgs::Cache(args) => commands::cache::run(&args),
        CommandArgs::Completions(args) => commands::completions::run(&args, console),
        CommandArgs::Man(args) => commands::man::run(&args, console),
    }
}
