//! `feedwright machines` and `feedwright controllers`.

use std::io::{self, Write};
use std::process::ExitCode;

use feedwright::controllers::{BEST, CONTROLLERS};
use feedwright::machine::{BUILT_IN, Machine};
use miette::Result;

use crate::message::printed;

pub(crate) fn machines() -> Result<ExitCode> {
    let mut lines = String::new();
    for (name, text) in BUILT_IN {
        let machine = Machine::parse(&format!("{name}.toml"), text)?;
        lines += &format!("{name:<10} {} axes  {}\n", machine.axis_count(), machine.description);
    }
    print(&lines)
}

pub(crate) fn controllers() -> Result<ExitCode> {
    let mut lines = String::new();
    for entry in CONTROLLERS {
        let best = if entry.name == BEST { " (default)" } else { "" };
        lines += &format!("{:<18} {}; {}{best}\n", entry.name, entry.summary, entry.source);
    }
    print(&lines)
}

fn print(lines: &str) -> Result<ExitCode> {
    printed(io::stdout().write_all(lines.as_bytes()), ExitCode::SUCCESS)
}
