//! `feedwright machines` and `feedwright controllers`.
use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use feedwright_control::{IdentifierKind, Knows};
use feedwright_gcode::visible;
use feedwright_sim::{BUILT_IN_MACHINES, Machine, is_machine_path, shown};
use miette::{IntoDiagnostic, Result, miette};

use crate::command::console::Console;
use crate::command::message::printed;
use crate::command::streams::{report_written, tables};
use crate::command::terminal::wrapped;
use crate::controllers::{BEST, Controllers, Entry, range};
use crate::machine_document::machine_document;
use crate::output::{OutputError, OutputFile, OutputFiles};
use crate::request::named::find;

pub(crate) fn machines() -> Result<ExitCode> {
    let mut lines = String::new();
    for (name, text) in BUILT_IN_MACHINES {
        let machine = Machine::parse(&format!("{name}.toml"), text)?;
        let line = format!(
            "{name:<10} {} axes  {}",
            machine.axis_count(),
            machine.description
        );
        lines += &(wrapped(&line, 19) + "\n");
    }
    print(&lines)
}

/// Writes a built-in machine as a file to start from.
pub(crate) fn machine(name: &str, out: Option<&Path>, console: &Console) -> Result<ExitCode> {
    if is_machine_path(Path::new(name)) {
        return Err(miette!(
            help = "`feedwright machines` lists them",
            "'{}' is no built-in machine",
            visible(name)
        ));
    }
    Machine::load(name.as_ref())?;
    let text = machine_document(name)
        .into_diagnostic()?
        .unwrap_or_default();
    let Some(out) = out else { return print(&text) };
    let mut file = OutputFiles::new([]).start(out)?;
    file.write_all(text.as_bytes())
        .map_err(|error| OutputError::from_io(error, out))?;
    OutputFile::commit_all(vec![file], &console.bar(0))?;
    printed(
        report_written(&mut *tables([Some(out)]), [Some(out)]),
        ExitCode::SUCCESS,
    )
}

/// Lists the controllers of a table.
pub fn controllers(table: Controllers) -> Result<ExitCode> {
    let mut lines = String::new();
    for entry in table {
        let best = if entry.name == BEST { " (default)" } else { "" };
        let line = format!(
            "{:<26} {}; {}{best}",
            entry.name, entry.summary, entry.source
        );
        lines += &(wrapped(&line, 27) + "\n");
    }
    print(&lines)
}

/// Lists what a controller of a table is, and its parameters.
pub fn controller(name: &str, table: Controllers) -> Result<ExitCode> {
    let entry = find(name, table)?;
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
        format!("gains: {}", gains(entry)),
    ];
    let mut lines: String = head.iter().map(|line| wrapped(line, 2) + "\n").collect();
    if entry.laps > 1 {
        lines += &format!(
            "laps of the part: {}, all but the last are practice\n",
            entry.laps
        );
    }
    if !entry.parameters.is_empty() {
        lines += "\nparameters, for --set NAME=VALUE:\n";
    }
    for parameter in entry.parameters {
        let default = shown(parameter.default);
        let reason = wrapped(&format!("    {}", parameter.reason), 4);
        let unit = parameter
            .unit
            .map_or(String::new(), |unit| format!(" {unit}"));
        lines += &format!(
            "\n{} = {default}{unit}, allowed {}\n{reason}\n",
            parameter.name,
            range(parameter)
        );
    }
    print(&lines)
}

/// Describes the source of the gains of a controller.
fn gains(entry: &Entry) -> &'static str {
    match (entry.identifier, entry.knows) {
        (Some(IdentifierKind::Axes), _) => {
            "computed when it starts, from the identified model of each axis and the parameters below; none is typed in"
        }
        (Some(_), _) => "none; it follows the gradient of a trained network",
        (None, Knows::Nothing) if entry.parameters.is_empty() => "none",
        (None, Knows::Nothing) => "those of the parameters below",
        (None, Knows::EarlierLaps) => {
            "those of the parameters below, on the errors of earlier laps"
        }
        (None, Knows::Identified | Knows::ExactModel | Knows::Everything) => {
            "computed when it starts, from the model of the machine and the parameters below"
        }
    }
}

fn print(lines: &str) -> Result<ExitCode> {
    printed(io::stdout().write_all(lines.as_bytes()), ExitCode::SUCCESS)
}
