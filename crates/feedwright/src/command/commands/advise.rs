//! `feedwright advise`: the feedrates at which a tolerance is held.
use std::io::Write;
use std::process::ExitCode;

use feedwright_gcode::visible;
use miette::Result;
use serde_json::json;

use crate::command::args::advise::AdviseArgs;
use crate::command::console::Console;
use crate::command::message::{OUT_OF_TOLERANCE, printed, report_assumed_limits, warn};
use crate::command::streams::{check_request, outputs_of, report_written, tables};
use crate::command::table::{ConsoleTable, TableColumn};
use crate::command::terminal::{page_units, wrapped};
use crate::correct::FileAssumption;
use crate::correct::advise::{Advice, AdviseJob, FeedCut, STRETCH_LEGEND, WayAdvice};
use crate::output::OutputFile;
use crate::report::PageUnits;
use crate::results_format::{stamped, write_json};

/// Stretches that are listed.
const LISTED: usize = 12;

pub(crate) fn run(args: &AdviseArgs, console: &Console) -> Result<ExitCode> {
    let request = args.request()?;
    check_request(console, &request)?;
    let job = request.advise_job()?;
    report_assumed_limits(&job.machine, job.target.stages(&job.machine));
    let mut files = outputs_of(&request);
    let report = files.start_wanted(args.report.as_deref())?;
    let figure = files.start_wanted(args.figure.as_deref())?;
    let json = files.start_wanted(args.json.as_deref())?;
    let bar = console.bar(0);
    let advice = job.run(&bar)?;
    bar.clear();
    for warning in advice.warnings.iter().cloned() {
        warn(warning.into());
    }
    let part = args
        .part
        .file_name()
        .unwrap_or(args.part.as_os_str())
        .to_string_lossy();
    let mut complete = Vec::new();
    complete.extend(OutputFile::filled(report, |file| {
        advice.write_page(file, &part, &job.machine.name, page_units())
    })?);
    complete.extend(OutputFile::filled(figure, |file| {
        file.write_all(advice.figure(PageUnits::Metric).to_svg().as_bytes())
    })?);
    complete.extend(OutputFile::filled(json, |file| {
        let mut value = serde_json::to_value(&advice)?;
        value["part"] = json!(args.part.display().to_string());
        value["machine"] = json!(job.machine.name);
        write_json(file, &stamped(value))
    })?);
    OutputFile::commit_all(complete, &bar)?;
    let code = if advice.holds() {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(OUT_OF_TOLERANCE)
    };
    printed(print(args, &job, &advice), code)
}

fn print(args: &AdviseArgs, job: &AdviseJob, advice: &Advice) -> std::io::Result<()> {
    let files = || {
        [
            args.report.as_deref(),
            args.figure.as_deref(),
            args.json.as_deref(),
        ]
    };
    let out = &mut *tables(files());
    let Advice {
        tolerance_um,
        control,
        planner,
        programmed_mm_s: [_, largest_mm_s],
        ..
    } = advice;
    writeln!(
        out,
        "within {tolerance_um} um on {}: feed of the whole program, or of each stretch",
        visible(&job.machine.name)
    )?;
    let mut table = ConsoleTable::new(vec![
        TableColumn::new(""),
        TableColumn::new("feed"),
        TableColumn::new("mm/min"),
        TableColumn::new("time s"),
        TableColumn::optional("RMS um", 3),
        TableColumn::new("max um"),
        TableColumn::optional("each: time s", 1),
        TableColumn::optional("max um", 2),
    ]);
    for WayAdvice {
        way,
        whole,
        by_stretch,
        nearest,
        ..
    } in &advice.ways
    {
        let mut cells = vec![way.name(advice.controller).to_owned()];
        match whole {
            Some(FeedCut {
                factor,
                time_s,
                rms_um,
                max_um,
            }) => {
                let percent = 100.0 * factor.unwrap_or(1.0);
                cells.extend([
                    format!("{percent:.0} %"),
                    format!("{:.0}", 0.6 * percent * largest_mm_s),
                ]);
                cells.extend([
                    format!("{time_s:.3}"),
                    format!("{rms_um:.2}"),
                    format!("{max_um:.2}"),
                ]);
            }
            None => cells.extend(["none", "-", "-", "-", "-"].map(str::to_owned)),
        }
        match by_stretch {
            Some(cut) => cells.extend([format!("{:.3}", cut.time_s), format!("{:.2}", cut.max_um)]),
            None => cells.extend(["-", "-"].map(str::to_owned)),
        }
        table.row(cells);
        if let Some(nearest) = nearest {
            table.remark(format!(
                "{}. {}",
                nearest.sentence("um", *largest_mm_s),
                nearest.why()
            ));
        }
    }
    table.print(out)?;
    let notes = [
        "feed: of the programmed; mm/min: where F is the largest of the program; each: each stretch at the feed that it holds".to_owned(),
        format!("uncorrected, corrected: cut without feedback as {control} plans (planner {planner}); corrected: for that feed"),
    ];
    let assumed = advice.assumed.as_ref().map(FileAssumption::sentence);
    notes
        .iter()
        .chain(&assumed)
        .try_for_each(|note| writeln!(out, "{}", wrapped(note, 2)))?;
    print_stretches(out, advice)?;
    report_written(out, files())
}

/// The stretches that hold the smallest part of their feedrate.
fn print_stretches(out: &mut dyn Write, advice: &Advice) -> std::io::Result<()> {
    let listed = advice.slowest(LISTED);
    if advice.stretches.len() < 2 {
        return Ok(());
    }
    let most = if listed.len() < advice.stretches.len() {
        ": those that hold the least"
    } else {
        ""
    };
    writeln!(
        out,
        "\nfeed in mm/min that each stretch without a corner holds{most}"
    )?;
    let mut table = ConsoleTable::new(vec![
        TableColumn::new("lines"),
        TableColumn::new("programmed"),
        TableColumn::new("uncorrected"),
        TableColumn::new("corrected"),
        TableColumn::new(advice.controller),
        TableColumn::optional("left", 1),
    ]);
    for stretch in &listed {
        let [first, last] = stretch.lines;
        let lines = if first == last {
            first.to_string()
        } else {
            format!("{first} to {last}")
        };
        let [a, b, c] = [0, 1, 2].map(|way| stretch.cell(way, PageUnits::Metric));
        let remark = stretch.remark("um").unwrap_or_default();
        table.row(vec![
            lines,
            format!("{:.0}", 60.0 * stretch.feed_mm_s),
            a,
            b,
            c,
            remark,
        ]);
    }
    table.print(out)?;
    if listed
        .iter()
        .any(|stretch| stretch.nearest.iter().any(Option::is_some))
    {
        writeln!(out, "{}", wrapped(STRETCH_LEGEND, 2))?;
    }
    Ok(())
}
