//! `feedwright machines` and `feedwright controllers`.

use std::io::Write;
use std::process::ExitCode;

use feedwright::controllers::{BEST, CONTROLLERS};
use feedwright::machine::{BUILT_IN, Machine};
use miette::{IntoDiagnostic, Result};

pub(crate) fn machines() -> Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    for (name, text) in BUILT_IN {
        let machine = Machine::parse(&format!("{name}.toml"), text)?;
        writeln!(out, "{name:<10} {} axes  {}", machine.axis_count(), machine.description).into_diagnostic()?;
    }
    Ok(ExitCode::SUCCESS)
}

pub(crate) fn controllers() -> Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    for entry in CONTROLLERS {
        let best = if entry.name == BEST { " (default)" } else { "" };
        writeln!(out, "{:<18} {}; {}{best}", entry.name, entry.summary, entry.source).into_diagnostic()?;
    }
    Ok(ExitCode::SUCCESS)
}
