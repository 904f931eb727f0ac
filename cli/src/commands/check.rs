//! `feedwright check`: all mistakes of programs and machine files, as a compiler tells them.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use feedwright::gcode::{self, CheckError, Settings};
use feedwright::machine::Machine;
use miette::{Report, Result};

use crate::args::CheckArgs;
use crate::message::{fail, printed, warn};

pub(crate) fn run(args: &CheckArgs) -> Result<ExitCode> {
    let mut code = ExitCode::SUCCESS;
    let result = print(args, &mut code);
    printed(result, code)
}

fn print(args: &CheckArgs, code: &mut ExitCode) -> io::Result<()> {
    let mut out = io::stdout().lock();
    for file in &args.files {
        let is_machine = file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
        match if is_machine { machine(file) } else { program(file) } {
            Ok(line) => writeln!(out, "{}: {line}", file.display())?,
            Err(reports) => reports.iter().for_each(|report| *code = fail(report)),
        }
    }
    Ok(())
}

fn machine(file: &Path) -> Result<String, Vec<Report>> {
    let machine = Machine::read(file).map_err(|error| vec![error.into()])?;
    Ok(format!("machine {}, {} axes", machine.name, machine.axis_count()))
}

fn program(file: &Path) -> Result<String, Vec<Report>> {
    let summary = gcode::check(file, Settings::default()).map_err(|error| match error {
        CheckError::Read(error) => vec![error.into()],
        CheckError::Faults(faults) => faults.into_iter().map(Report::new).collect(),
    })?;
    for warning in summary.warnings {
        warn(warning.into());
    }
    Ok(format!(
        "{} lines, {} motions, {:.3} mm of feed, {:.3} mm of rapids, read as {}",
        summary.lines, summary.motions, summary.feed_mm, summary.rapid_mm, summary.dialect.0
    ))
}
