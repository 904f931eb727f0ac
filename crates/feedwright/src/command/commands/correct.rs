//! `feedwright correct`: a corrected program for a control that gets no feedback from us.
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright_sim::fixed;
use miette::{IntoDiagnostic, Result};
use serde_json::{Value, json};

use crate::command::args::correct::CorrectArgs;
use crate::command::console::Console;
use crate::command::controls::print_correction;
use crate::command::message::{OUT_OF_TOLERANCE, printed, remark, report_assumed_limits, warn};
use crate::command::streams::{check_request, outputs_of, report_written, tables};
use crate::command::table::{ConsoleTable, TableColumn};
use crate::command::terminal::wrapped;
use crate::correct::exported::ExportedFigures;
use crate::correct::{
    CorrectJob, CorrectOutcome, CutProgram, LearnedOutcome, LearnedValue, PredictedCut,
};
use crate::output::{OutputFile, is_standard_output};
use crate::results_format::{stamped, write_json};

pub(crate) fn run(args: &CorrectArgs, console: &Console) -> Result<ExitCode> {
    let request = args.request()?;
    check_request(console, &request)?;
    let bar = console.bar(0);
    let mut job = request.correct_job(&bar)?;
    let mut files = outputs_of(&request);
    let mut out = files.start_wanted(args.out.as_deref())?;
    let json = files.start_wanted(args.json.as_deref())?;
    report_assumed_limits(&job.machine, job.target.stages(&job.machine));
    job.keep = kept_beside(args);
    let outcome = job.run(&bar).inspect_err(|_| {
        bar.clear();
        if let Some(kept) = job.kept_pieces() {
            remark(&format!(
                "finished pieces are kept in {}; the same command goes on with them",
                kept.display()
            ));
        }
    })?;
    bar.clear();
    if let (true, Some(kept)) = (outcome.is_lost, &job.keep) {
        remark(&format!(
            "{} cannot be written; pieces were not kept for another run",
            kept.display()
        ));
    }
    for warning in outcome.warnings.iter().cloned() {
        warn(warning.into());
    }
    let ExportedFigures {
        max_um, completed, ..
    } = outcome.corrected;
    let within = completed
        && args
            .tolerance
            .is_none_or(|tolerance_um| max_um <= tolerance_um);
    let mut complete = Vec::new();
    match (outcome.program().filter(|_| within), &mut out) {
        (Some(program), Some(file)) => file.write_all(program.as_bytes()).into_diagnostic()?,
        _ => out = None,
    }
    complete.extend(out);
    complete.extend(OutputFile::filled(json, |file| {
        write_json(file, &results(args, &job, &outcome, within)?)
    })?);
    OutputFile::commit_all(complete, &bar)?;
    job.forget_pieces().into_diagnostic()?;
    let good = within && outcome.refusal.is_none();
    let code = if good {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(OUT_OF_TOLERANCE)
    };
    printed(print(args, &outcome, within), code)
}

/// Returns the path where finished pieces of a long program are kept: beside the corrected program,
/// if that is a file.
fn kept_beside(args: &CorrectArgs) -> Option<PathBuf> {
    let is_file = |path: &&Path| {
        !is_standard_output(path) && !std::fs::metadata(path).is_ok_and(|found| !found.is_file())
    };
    args.out.as_deref().filter(is_file).map(|path| {
        let mut name = path.as_os_str().to_owned();
        name.push(".pieces");
        name.into()
    })
}

/// The figures of a correction, and what was asked for.
fn results(
    args: &CorrectArgs,
    job: &CorrectJob,
    outcome: &CorrectOutcome,
    within: bool,
) -> serde_json::Result<Value> {
    let mut results = json!({
        "part": args.part.display().to_string(),
        "machine": job.machine.name,
        "tolerance_um": args.tolerance,
        "within_tolerance": within,
        "written": within && outcome.program().is_some() && args.out.is_some(),
    });
    if let (Value::Object(all), Value::Object(figures)) =
        (&mut results, serde_json::to_value(outcome)?)
    {
        all.extend(figures);
    }
    Ok(stamped(results))
}

fn print(args: &CorrectArgs, outcome: &CorrectOutcome, within: bool) -> std::io::Result<()> {
    let mut out = tables([args.out.as_deref(), args.json.as_deref()]);
    let CorrectOutcome {
        uncorrected,
        corrected,
        ..
    } = outcome;
    let mut table = ConsoleTable::new(vec![
        TableColumn::new(""),
        TableColumn::new("time s"),
        TableColumn::new("RMS um"),
        TableColumn::new("max um"),
        TableColumn::optional("uncut um", 1),
        TableColumn::optional("blocks", 2),
    ]);
    for (name, figures) in [("uncorrected", uncorrected), ("as exported", corrected)] {
        let ExportedFigures {
            rms_um,
            max_um,
            uncut_um,
            time_s,
            blocks,
            ..
        } = figures;
        let errors = [rms_um, max_um, uncut_um].map(|um| fixed(*um, 2));
        let cells = std::iter::once(fixed(*time_s, 3))
            .chain(errors)
            .chain([blocks.to_string()]);
        table.row(std::iter::once(name.to_owned()).chain(cells).collect());
        if !figures.completed {
            table.remark("diverged: the servo loop of this machine is unstable".to_owned());
        }
    }
    table.print(&mut *out)?;
    let note = "both cut without feedback, as the control plans them; errors are distances to the programmed path";
    writeln!(out, "{}", wrapped(note, 2))?;
    if outcome.pieces > 1 {
        let note = format!(
            "corrected in {} pieces, one by one; each has its own limits of blocks and time",
            outcome.pieces
        );
        writeln!(out, "{}", wrapped(&note, 2))?;
    }
    if let Some(learned) = &outcome.learned {
        print_learned(&mut *out, learned)?;
    }
    print_correction(&mut *out, outcome)?;
    if let Some(tolerance_um) = args.tolerance {
        let verdict = if within { "within" } else { "out of" };
        writeln!(
            out,
            "{verdict} tolerance: max {} um, allowed {tolerance_um} um",
            fixed(corrected.max_um, 2)
        )?;
    }
    let written = args
        .out
        .as_deref()
        .filter(|_| within && outcome.program().is_some());
    if let (None, Some(path), None) = (written, &args.out, &outcome.refusal) {
        writeln!(out, "{} is not written", path.display())?;
    }
    report_written(&mut *out, [written, args.json.as_deref()])
}

/// Prints the results of the logs, and the expected result of the next cut.
fn print_learned(out: &mut dyn Write, learned: &LearnedOutcome) -> std::io::Result<()> {
    let mut table = ConsoleTable::new(vec![
        TableColumn::new("log"),
        TableColumn::new("program"),
        TableColumn::new("RMS um"),
        TableColumn::new("max um"),
        TableColumn::optional("model misses um", 1),
        TableColumn::optional("corrected um", 1),
    ]);
    for log in &learned.logs {
        let program = match log.program {
            CutProgram::Original => "original",
            CutProgram::Corrected => "corrected",
        };
        let figures =
            [log.rms_um, log.max_um, log.model_missed_um, log.missed_um].map(|um| fixed(um, 2));
        let name = Path::new(&log.log)
            .file_name()
            .map_or(log.log.clone(), |name| name.to_string_lossy().into_owned());
        table.row(
            [name, program.to_owned()]
                .into_iter()
                .chain(figures)
                .collect(),
        );
    }
    writeln!(out)?;
    table.print(out)?;
    for log in learned.logs.iter().filter(|log| log.takes_another_time()) {
        let note = format!(
            "{} took {} s, and {} s are planned: the limits of the control or its feed override are not those of the machine file",
            log.log,
            fixed(log.time_s, 3),
            fixed(log.planned_s, 3)
        );
        writeln!(out, "{}", wrapped(&note, 2))?;
    }
    let values = learned
        .values
        .iter()
        .filter(|value| (value.factor - 1.0).abs() > 2.0 * value.standard_deviation);
    let values = values.map(
        |LearnedValue {
             axis,
             value,
             factor,
             standard_deviation,
         }| {
            let [percent, sd] = [factor - 1.0, *standard_deviation].map(|part| 100.0 * part);
            format!("{axis} {} {percent:+.1} +- {sd:.1} %", value.words())
        },
    );
    let values: Vec<String> = values.collect();
    if !values.is_empty() {
        writeln!(
            out,
            "{}",
            wrapped(
                &format!("the machine is not as its file: {}", values.join(", ")),
                2
            )
        )?;
    }
    let [repeats, rest] = [learned.repeats_um, learned.rest_um].map(|um| fixed(um, 2));
    let note =
        format!("beside that, RMS {repeats} um repeat and are corrected, and {rest} um do not");
    writeln!(out, "{}", wrapped(&note, 2))?;
    let Some(PredictedCut {
        rms_um,
        band_um,
        max_um,
        ..
    }) = learned.predicted
    else {
        return Ok(());
    };
    let [rms, low, high, max] = [rms_um, band_um[0], band_um[1], max_um].map(|um| fixed(um, 2));
    let note = format!(
        "the encoders are to show RMS {rms} um ({low} to {high}) and max {max} um in the next cut"
    );
    writeln!(out, "{}", wrapped(&note, 2))
}
