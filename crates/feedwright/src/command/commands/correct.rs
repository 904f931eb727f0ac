//! `feedwright correct`: a corrected program for a control that gets no feedback from us.
use std::io::Write;
use std::process::ExitCode;

use feedwright_gcode::Program;
use feedwright_sim::Machine;
use miette::{IntoDiagnostic, Result};
use serde_json::{Value, json};

use crate::command::args::correct::CorrectArgs;
use crate::command::console::Console;
use crate::command::controls::{check_tolerance, compensation, control, print_correction};
use crate::command::message::{OUT_OF_TOLERANCE, printed, tell_assumed_limits, warn};
use crate::command::streams::{ProgramInputs, tables, tell_written};
use crate::command::table::{ConsoleTable, TableColumn, figure};
use crate::command::terminal::wrapped;
use crate::correct::exported::ExportedFigures;
use crate::correct::{CorrectJob, CorrectOutcome};
use crate::output::OutputFile;
use crate::results_format::{json_text, stamped};

pub(crate) fn run(args: &CorrectArgs, console: &Console) -> Result<ExitCode> {
    let target = control(&args.target)?;
    check_tolerance(args.tolerance)?;
    let inputs =
        ProgramInputs::of(&args.part, &args.machine, &args.reader).with_geometry(args.geometry.geometry.as_deref());
    inputs.check(console)?;
    let machine = Machine::load(&args.machine)?;
    let mut files = inputs.outputs();
    let mut out = args.out.as_deref().map(|path| files.start(path)).transpose()?;
    let json = args.json.as_deref().map(|path| files.start(path)).transpose()?;
    let reader = args.reader.settings()?;
    tell_assumed_limits(&machine, target.stages(&machine));
    let compensation = compensation(&args.geometry)?;
    let job = CorrectJob { reader, compensation, ..CorrectJob::new(Program::in_file(&args.part), machine, target) };
    let bar = console.bar(0);
    let outcome = job.run(&bar)?;
    bar.clear();
    for warning in outcome.warnings.iter().cloned() {
        warn(warning.into());
    }
    let ExportedFigures { max_um, completed, .. } = outcome.corrected;
    let within = completed && args.tolerance.is_none_or(|tolerance_um| max_um <= tolerance_um);
    let mut complete = Vec::new();
    match (outcome.program().filter(|_| within), &mut out) {
        (Some(program), Some(file)) => file.write_all(program.as_bytes()).into_diagnostic()?,
        _ => out = None,
    }
    complete.extend(out);
    if let Some(mut file) = json {
        let results = results(args, &job, &outcome, within).into_diagnostic()?;
        writeln!(file, "{}", json_text(&results).into_diagnostic()?).into_diagnostic()?;
        complete.push(file);
    }
    OutputFile::commit_all(complete, &bar)?;
    let good = within && outcome.refusal.is_none();
    let code = if good { ExitCode::SUCCESS } else { ExitCode::from(OUT_OF_TOLERANCE) };
    printed(print(args, &outcome, within), code)
}

/// The figures of a correction, and what was asked for.
fn results(args: &CorrectArgs, job: &CorrectJob, outcome: &CorrectOutcome, within: bool) -> serde_json::Result<Value> {
    let mut results = json!({
        "part": args.part.display().to_string(),
        "machine": job.machine.name,
        "tolerance_um": args.tolerance,
        "within_tolerance": within,
        "written": within && outcome.program().is_some() && args.out.is_some(),
    });
    if let (Value::Object(all), Value::Object(figures)) = (&mut results, serde_json::to_value(outcome)?) {
        all.extend(figures);
    }
    Ok(stamped(results))
}

fn print(args: &CorrectArgs, outcome: &CorrectOutcome, within: bool) -> std::io::Result<()> {
    let mut out = tables([args.out.as_deref(), args.json.as_deref()]);
    let CorrectOutcome { uncorrected, corrected, .. } = outcome;
    let mut table = ConsoleTable::new(vec![
        TableColumn::new(""),
        TableColumn::new("time s"),
        TableColumn::new("RMS um"),
        TableColumn::new("max um"),
        TableColumn::optional("uncut um", 1),
        TableColumn::optional("blocks", 2),
    ]);
    for (name, figures) in [("uncorrected", uncorrected), ("as exported", corrected)] {
        let ExportedFigures { rms_um, max_um, uncut_um, time_s, blocks, .. } = figures;
        let errors = [rms_um, max_um, uncut_um].map(|um| figure(*um, 2));
        let cells = std::iter::once(figure(*time_s, 3)).chain(errors).chain([blocks.to_string()]);
        table.row(std::iter::once(name.to_owned()).chain(cells).collect());
        if !figures.completed {
            table.remark("diverged: the servo loop of this machine is unstable".to_owned());
        }
    }
    table.print(&mut *out)?;
    let note = "both cut without feedback, as the control plans them; errors are distances to the programmed path";
    writeln!(out, "{}", wrapped(note, 2))?;
    print_correction(&mut *out, outcome)?;
    if let Some(tolerance_um) = args.tolerance {
        let verdict = if within { "within" } else { "out of" };
        writeln!(out, "{verdict} tolerance: max {} um, allowed {tolerance_um} um", figure(corrected.max_um, 2))?;
    }
    let written = args.out.as_deref().filter(|_| within && outcome.program().is_some());
    if let (None, Some(path), None) = (written, &args.out, &outcome.refusal) {
        writeln!(out, "{} is not written", path.display())?;
    }
    tell_written(&mut *out, [written, args.json.as_deref()])
}
