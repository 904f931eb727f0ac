//! `feedwright check`: all mistakes of programs and machine files, as a compiler tells them.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use feedwright::gcode::{self, CheckError, Settings};
use feedwright::machine::{self, Machine};
use miette::{Report, Result};

use crate::args::CheckArgs;
use crate::message::{fail, shown, warn};

pub(crate) fn run(args: &CheckArgs) -> Result<ExitCode> {
    let mut code = ExitCode::SUCCESS;
    for file in &args.files {
        match if is_machine(file) { machine(file) } else { program(file) } {
            Ok(line) => shown(print(&line))?,
            Err(reports) => {
                for report in reports {
                    code = fail(&report);
                }
            }
        }
    }
    Ok(code)
}

/// A machine file by its ending; everything else is a program.
fn is_machine(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml")) && machine::is_path(file)
}

fn machine(file: &Path) -> Result<String, Vec<Report>> {
    let machine = Machine::read(file).map_err(|error| vec![error.into()])?;
    Ok(format!("{}: machine {}, {} axes", file.display(), machine.name, machine.axis_count()))
}

fn program(file: &Path) -> Result<String, Vec<Report>> {
    let summary = gcode::check(file, Settings::default()).map_err(|error| match error {
        CheckError::Read(error) => vec![error.into()],
        CheckError::Faults(faults) => faults.into_iter().map(Report::new).collect(),
    })?;
    let line = format!(
        "{}: {} lines, {} motions, {:.3} mm of feed, {:.3} mm of rapids, read as {}",
        file.display(),
        summary.lines,
        summary.motions,
        summary.feed_mm,
        summary.rapid_mm,
        summary.dialect.0
    );
    for warning in summary.warnings {
        warn(warning.into());
    }
    Ok(line)
}

fn print(line: &str) -> io::Result<()> {
    writeln!(io::stdout(), "{line}")
}
