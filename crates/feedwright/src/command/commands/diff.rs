//! `feedwright diff`: two results or two programs side by side.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use feedwright_gcode::{Program, Settings, input};
use miette::{IntoDiagnostic, Result, miette};

use crate::command::args::diff::DiffArgs;
use crate::command::console::Console;
use crate::command::message::printed;
use crate::command::streams::{check_inputs, report_written, tables};
use crate::command::table::{ConsoleTable, TableColumn};
use crate::job::JobError;
use crate::output::{OutputFile, OutputFiles};
use crate::results_diff::{DiffSide, diff_figures, write_diff_page};

pub(crate) fn run(args: &DiffArgs, console: &Console) -> Result<ExitCode> {
    let inputs = [
        ("BEFORE", args.before.as_path()),
        ("AFTER", args.after.as_path()),
    ];
    check_inputs(console, inputs.map(|(name, path)| (name, Some(path))))?;
    let mut files = OutputFiles::new(inputs.map(|(_, path)| path));
    let report = files.start_wanted(args.report.as_deref())?;
    let settings = args.reader.settings()?;
    let (before, after) = (
        side(&args.before, &settings)?,
        side(&args.after, &settings)?,
    );
    let figures = diff_figures(&before, &after);
    if figures.is_empty() || before.is_path != after.is_path {
        return Err(miette!(
            help = "compare two programs, or two JSON results of the same command",
            "{} and {} have nothing in common to compare",
            before.name,
            after.name
        ));
    }
    if let Some(mut file) = report {
        write_diff_page(&mut file, [&before, &after]).into_diagnostic()?;
        OutputFile::commit_all(vec![file], &console.bar(0))?;
    }
    let mut out = tables([args.report.as_deref()]);
    let mut reported = writeln!(out, "before: {}\nafter:  {}", before.name, after.name);
    let columns = ["", "before", "after", "ratio"]
        .map(TableColumn::new)
        .to_vec();
    let mut table = ConsoleTable::new(columns);
    for figure in figures {
        let [before, after] = [figure.before, figure.after].map(|value| format!("{value:.3}"));
        table.row(vec![figure.name.to_owned(), before, after, figure.ratio()]);
    }
    reported = reported
        .and_then(|()| table.print(&mut *out))
        .and_then(|()| report_written(&mut *out, [args.report.as_deref()]));
    printed(reported, ExitCode::SUCCESS)
}

/// A result by the ending of its file, else a program.
fn side(path: &Path, settings: &Settings) -> Result<DiffSide> {
    let name = input::name(path);
    if !path
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("json"))
    {
        return Ok(DiffSide::of_program(&Program::in_file(path), settings).map_err(JobError::from)?);
    }
    let bytes = input::read(path).map_err(|error| {
        miette!(
            help = "--json of run, correct or plan writes one",
            "cannot read {name}: {error}"
        )
    })?;
    let result = serde_json::from_slice(&bytes)
        .ok()
        .and_then(|result| DiffSide::of_result(&name, &result));
    result.ok_or_else(|| {
        miette!(
            help = "--json of run, correct or plan writes one",
            "{name}: this is no result of run, correct or plan"
        )
    })
}
