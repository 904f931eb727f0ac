//! `feedwright advise`: the feedrates at which a tolerance is held.

use std::io::Write;
use std::process::ExitCode;

use feedwright::controllers::Choices;
use feedwright::correct::advise::{Advice, AdviseJob, FeedCut, StretchAdvice, WayAdvice};
use feedwright::machine::Machine;
use feedwright::output::OutputFile;
use miette::{IntoDiagnostic, Result};
use serde_json::json;

use crate::args::advise::AdviseArgs;
use crate::console::Console;
use crate::controllers::find;
use crate::controls::{check_tolerance, control};
use crate::message::{OUT_OF_TOLERANCE, printed, warn};
use crate::streams::{ProgramInputs, tables, tell_written};

/// Stretches that are listed.
const LISTED: usize = 12;

pub(crate) fn run(args: &AdviseArgs, console: &Console) -> Result<ExitCode> {
    let target = control(&args.target)?;
    check_tolerance(Some(args.tolerance))?;
    let inputs = ProgramInputs::of(&args.part, &args.machine, &args.reader);
    inputs.check(console)?;
    let machine = Machine::load(&args.machine)?;
    let mut files = inputs.outputs();
    let report = args.report.as_deref().map(|path| files.start(path)).transpose()?;
    let figure = args.figure.as_deref().map(|path| files.start(path)).transpose()?;
    let json = args.json.as_deref().map(|path| files.start(path)).transpose()?;
    let job = AdviseJob {
        part: args.part.clone(),
        machine,
        target,
        controller: find(&args.controller)?,
        choices: Choices { seed: args.seed, ..Choices::default() },
        tolerance_um: args.tolerance,
        reader: args.reader.settings()?,
    };
    let bar = console.bar(0);
    let advice = job.run(&bar)?;
    bar.clear();
    for warning in advice.warnings.iter().cloned() {
        warn(warning.into());
    }
    let part = args.part.file_name().unwrap_or(args.part.as_os_str()).to_string_lossy();
    let mut complete = Vec::new();
    if let Some(mut file) = report {
        advice.write_page(&mut file, &part, &job.machine.name).into_diagnostic()?;
        complete.push(file);
    }
    if let Some(mut file) = figure {
        file.write_all(advice.figure().to_svg().as_bytes()).into_diagnostic()?;
        complete.push(file);
    }
    if let Some(mut file) = json {
        let mut value = serde_json::to_value(&advice).into_diagnostic()?;
        value["version"] = json!(env!("CARGO_PKG_VERSION"));
        value["part"] = json!(args.part.display().to_string());
        value["machine"] = json!(job.machine.name);
        serde_json::to_writer_pretty(&mut file, &value).into_diagnostic()?;
        writeln!(file).into_diagnostic()?;
        complete.push(file);
    }
    OutputFile::commit_all(complete, &bar)?;
    let code = if advice.holds() { ExitCode::SUCCESS } else { ExitCode::from(OUT_OF_TOLERANCE) };
    printed(print(args, &job, &advice), code)
}

fn print(args: &AdviseArgs, job: &AdviseJob, advice: &Advice) -> std::io::Result<()> {
    let files = || [args.report.as_deref(), args.figure.as_deref(), args.json.as_deref()];
    let out = &mut *tables(files());
    let Advice { tolerance_um, control, planner, programmed_mm_s: [_, largest_mm_s], .. } = advice;
    writeln!(out, "within {tolerance_um} um on {}: feed of the whole program, or of each stretch", job.machine.name)?;
    writeln!(
        out,
        "{:<18} {:>6} {:>8} {:>9} {:>7} {:>7} {:>13} {:>7}",
        "", "feed", "mm/min", "time s", "RMS um", "max um", "each: time s", "max um"
    )?;
    for WayAdvice { way, cuts, whole, by_stretch } in &advice.ways {
        write!(out, "{:<18}", way.name(advice.controller))?;
        match whole {
            Some(FeedCut { factor, time_s, rms_um, max_um }) => {
                let factor = factor.unwrap_or(1.0);
                let feed_mm_min = 60.0 * factor * largest_mm_s;
                let percent = 100.0 * factor;
                write!(out, " {percent:>4.0} % {feed_mm_min:>8.0} {time_s:>9.3} {rms_um:>7.2} {max_um:>7.2}")?;
            }
            None => write!(out, " {:<41}", least(cuts))?,
        }
        match by_stretch {
            Some(cut) => writeln!(out, " {:>13.3} {:>7.2}", cut.time_s, cut.max_um)?,
            None => writeln!(out, " {:>13} {:>7}", "-", "-")?,
        }
    }
    writeln!(out, "feed: of the programmed; mm/min: where F is the largest of the program")?;
    writeln!(
        out,
        "uncorrected, corrected: cut open loop as {control} plans (planner {planner}); corrected: for that feed"
    )?;
    print_stretches(out, advice)?;
    tell_written(out, files())
}

/// Where no feed holds: how near it comes.
fn least(cuts: &[FeedCut]) -> String {
    let nearest = cuts.iter().min_by(|a, b| a.max_um.total_cmp(&b.max_um));
    nearest.map_or_else(String::new, |cut| {
        format!("at none: {:.1} um at {:.0} %", cut.max_um, 100.0 * cut.factor.unwrap_or(1.0))
    })
}

/// The stretches that hold the smallest part of their feedrate.
fn print_stretches(out: &mut dyn Write, advice: &Advice) -> std::io::Result<()> {
    let listed = advice.slowest(LISTED);
    if advice.stretches.len() < 2 {
        return Ok(());
    }
    let most = if listed.len() < advice.stretches.len() { ", those that hold the least" } else { "" };
    writeln!(out, "\n{:<18} {:>10}   holds, mm/min{most}", "lines", "mm/min")?;
    writeln!(out, "{:<18} {:>10} {:>12} {:>12} {:>14}", "", "", "uncorrected", "corrected", advice.controller)?;
    for StretchAdvice { lines: [first, last], feed_mm_s, holds_mm_s } in listed {
        let [a, b, c] =
            holds_mm_s.map(|holds| holds.map_or_else(|| "-".to_owned(), |mm_s| format!("{:.0}", 60.0 * mm_s)));
        let lines = if first == last { first.to_string() } else { format!("{first} to {last}") };
        writeln!(out, "{lines:<18} {:>10.0} {a:>12} {b:>12} {c:>14}", 60.0 * feed_mm_s)?;
    }
    Ok(())
}
