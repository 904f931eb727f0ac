//! `feedwright machines` and `feedwright controllers`.

use std::io::Write;
use std::process::ExitCode;

use feedwright::controllers::{BEST, CONTROLLERS};
use feedwright::machine::{BUILT_IN, Machine};
use miette::Result;

use crate::message::shown;

pub(crate) fn machines() -> Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    for (name, text) in BUILT_IN {
        let machine = Machine::parse(&format!("{name}.toml"), text)?;
        shown(writeln!(out, "{name:<10} {} axes  {}", machine.axis_count(), machine.description))?;
    }
    Ok(ExitCode::SUCCESS)
}

pub(crate) fn controllers() -> Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    for entry in CONTROLLERS {
        let best = if entry.name == BEST { " (default)" } else { "" };
        shown(writeln!(out, "{:<18} {}; {}{best}", entry.name, entry.summary, entry.source))?;
    }
    Ok(ExitCode::SUCCESS)
}
