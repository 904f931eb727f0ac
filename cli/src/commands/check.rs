//! `feedwright check`: all mistakes of programs, as a compiler tells them.

use std::io::{self, Write};
use std::process::ExitCode;

use feedwright::gcode::{self, CheckError, Settings};
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
                )?;
            }
            Err(CheckError::Read(error)) => *code = fail(&error.into()),
            Err(CheckError::Faults(faults)) => {
                for fault in faults {
                    *code = fail(&Report::new(fault));
                }
            }
        }
    }
    Ok(())
}
