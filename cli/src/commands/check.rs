//! `feedwright check`: all mistakes of programs, as a compiler tells them.

use std::io::Write;
use std::process::ExitCode;

use feedwright::gcode::{self, CheckError, Settings};
use miette::{IntoDiagnostic, Report, Result};

use crate::args::CheckArgs;
use crate::message::{fail, warn};

pub(crate) fn run(args: &CheckArgs) -> Result<ExitCode> {
    let mut code = ExitCode::SUCCESS;
    let mut out = std::io::stdout().lock();
    for file in &args.files {
        match gcode::check(file, Settings::default()) {
            Ok(summary) => {
                for warning in summary.warnings {
                    warn(warning.into());
                }
                writeln!(
                    out,
                    "{}: {} lines, {} motions, {:.3} mm of feed, {:.3} mm of rapids, read as {}",
                    file.display(),
                    summary.lines,
                    summary.motions,
                    summary.feed_mm,
                    summary.rapid_mm,
                    summary.dialect.0
                )
                .into_diagnostic()?;
            }
            Err(CheckError::Read(error)) => code = fail(&error.into()),
            Err(CheckError::Faults(faults)) => {
                for fault in faults {
                    code = fail(&Report::new(fault));
                }
            }
        }
    }
    Ok(code)
}
