//! `feedwright machines` and `feedwright controllers`.

use std::io::{self, Write};
use std::process::ExitCode;

use feedwright::controllers::{BEST, CONTROLLERS, Knows};
use feedwright::machine::{BUILT_IN, Machine};
use feedwright::number::shown;
use miette::Result;

use crate::controllers;
use crate::message::printed;
use crate::terminal::wrapped;

pub(crate) fn machines() -> Result<ExitCode> {
    let mut lines = String::new();
    for (name, text) in BUILT_IN {
        let machine = Machine::parse(&format!("{name}.toml"), text)?;
        let line = format!("{name:<10} {} axes  {}", machine.axis_count(), machine.description);
        lines += &(wrapped(&line, 19) + "\n");
    }
    print(&lines)
}

pub(crate) fn controllers() -> Result<ExitCode> {
    let mut lines = String::new();
    for entry in CONTROLLERS {
        let best = if entry.name == BEST { " (default)" } else { "" };
        let line = format!("{:<26} {}; {}{best}", entry.name, entry.summary, entry.source);
        lines += &(wrapped(&line, 27) + "\n");
    }
    print(&lines)
}

pub(crate) fn controller(name: &str) -> Result<ExitCode> {
    let entry = controllers::find(name)?;
    let knows = match entry.knows {
        Knows::Nothing => "nothing",
        Knows::Identified => "what was identified from a recording",
        Knows::ExactModel => "the parameters of its model",
        Knows::Everything => "its parameters, and the statistics of everything that disturbs it",
        Knows::EarlierLaps => "what went wrong in earlier laps of the same part",
    };
    let head = [
        format!("{}: {}", entry.name, entry.summary),
        format!("source: {}", entry.source),
        format!("knows of the machine: {knows}"),
    ];
    let mut lines: String = head.iter().map(|line| wrapped(line, 2) + "\n").collect();
    if entry.laps > 1 {
        lines += &format!("laps of the part: {}, all but the last are practice\n", entry.laps);
    }
    if !entry.parameters.is_empty() {
        lines += "\nparameters, for --set NAME=VALUE:\n";
    }
    for parameter in entry.parameters {
        let default = shown(parameter.default);
        let reason = wrapped(&format!("    {}", parameter.reason), 4);
        lines += &format!("\n{} = {default}, allowed {}\n{reason}\n", parameter.name, parameter.range());
    }
    print(&lines)
}

fn print(lines: &str) -> Result<ExitCode> {
    printed(io::stdout().write_all(lines.as_bytes()), ExitCode::SUCCESS)
}
