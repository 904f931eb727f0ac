//! `feedwright lab`: starts `feedwright-lab`, which is beside this command or on the PATH.

use std::io;
use std::path::PathBuf;
use std::process::{Command, ExitCode};

use miette::{Result, miette};

use crate::command::args::lab::LabArgs;

/// File name of the laboratory's command.
const NAME: &str = if cfg!(windows) {
    "feedwright-lab.exe"
} else {
    "feedwright-lab"
};

pub(crate) fn run(args: &LabArgs) -> Result<ExitCode> {
    let mut command = Command::new(program());
    command.args(&args.arguments);
    start(command).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => miette!(
            help = "in a checkout of feedwright: cargo install --path lab",
            "the laboratory is not installed: there is no {NAME} beside feedwright or on the PATH"
        ),
        _ => miette!("{NAME} does not start: {error}"),
    })
}

/// The laboratory beside this command, or its name, which the PATH is searched for.
fn program() -> PathBuf {
    let beside = std::env::current_exe()
        .ok()
        .map(|this| this.with_file_name(NAME));
    beside
        .filter(|path| path.is_file())
        .unwrap_or_else(|| PathBuf::from(NAME))
}

/// Takes the place of this process, so that signals and the exit code are those of the laboratory.
#[cfg(unix)]
fn start(mut command: Command) -> io::Result<ExitCode> {
    Err(std::os::unix::process::CommandExt::exec(&mut command))
}

/// Runs the laboratory and returns its exit code.
#[cfg(not(unix))]
fn start(mut command: Command) -> io::Result<ExitCode> {
    let code = command
        .status()?
        .code()
        .and_then(|code| u8::try_from(code).ok());
    Ok(code.map_or(ExitCode::FAILURE, ExitCode::from))
}
