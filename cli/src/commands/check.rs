//! `feedwright check`: all mistakes of programs and machine files, as a compiler tells them.
//!
//! Files are read in parallel, each as a stream; what is printed comes in the order of the arguments, whatever the number of threads.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

use feedwright::gcode::{self, CheckError, Settings};
use feedwright::machine::Machine;
use miette::{Report, Result, miette};
use rayon::iter::{ParallelBridge, ParallelIterator};

use crate::args::CheckArgs;
use crate::files::Files;
use crate::message::{fail, printed, warn};
use crate::progress::Bar;

/// What is told of one file.
struct Verdict {
    /// What it amounts to; `None` where it has mistakes.
    line: Option<String>,
    /// Mistakes, or warnings where there is none.
    reports: Vec<Report>,
}

pub(crate) fn run(args: &CheckArgs, quiet: bool) -> Result<ExitCode> {
    let settings = args.reader.settings()?;
    let found = Files::find(&args.files);
    let bar = Bar::new(quiet, found.files.len() as u64);
    let mut code = ExitCode::SUCCESS;
    for remark in &found.remarks {
        eprintln!("{remark}");
    }
    for fault in &found.faults {
        code = fail(&miette!("{fault}"));
    }
    let result = print(&found.files, &settings, &bar, &mut code);
    bar.clear();
    printed(result, code)
}

/// Checks all files and prints each verdict as soon as those before it are printed.
fn print(files: &[PathBuf], settings: &Settings, bar: &Bar, code: &mut ExitCode) -> io::Result<()> {
    let enough = AtomicBool::new(false);
    let (sender, receiver) = mpsc::channel();
    rayon::in_place_scope(|scope| {
        let enough = &enough;
        scope.spawn(move |_| {
            // A bridge hands the files out one by one, so that verdicts come about in their order.
            files.iter().enumerate().par_bridge().for_each_with(sender, |sender, (number, file)| {
                // Nobody listens any more once printing has failed.
                if !enough.load(Ordering::Relaxed) {
                    let _ = sender.send((number, verdict(file, settings)));
                }
            });
        });
        let result = print_in_order(files, &receiver, bar, code);
        enough.store(true, Ordering::Relaxed);
        result
    })
}

fn print_in_order(
    files: &[PathBuf],
    verdicts: &mpsc::Receiver<(usize, Verdict)>,
    bar: &Bar,
    code: &mut ExitCode,
) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let (mut early, mut next, mut faulty) = (BTreeMap::new(), 0, 0);
    for (number, verdict) in verdicts {
        early.insert(number, verdict);
        while let Some(verdict) = early.remove(&next) {
            bar.aside(|| {
                for report in verdict.reports {
                    if verdict.line.is_some() { warn(report) } else { *code = fail(&report) }
                }
                verdict.line.iter().try_for_each(|line| writeln!(out, "{}: {line}", files[next].display()))
            })?;
            faulty += usize::from(verdict.line.is_none());
            bar.step();
            next += 1;
        }
    }
    if files.len() > 1 {
        writeln!(out, "{} files: {} without mistakes, {faulty} with mistakes", files.len(), files.len() - faulty)?;
    }
    Ok(())
}

fn verdict(file: &Path, settings: &Settings) -> Verdict {
    let is_machine = file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    if is_machine { machine(file) } else { program(file, settings.clone()) }
}

fn machine(file: &Path) -> Verdict {
    match Machine::read(file) {
        Ok(machine) => {
            let line = Some(format!("machine {}, {} axes", machine.name, machine.axis_count()));
            Verdict { line, reports: Vec::new() }
        }
        Err(error) => Verdict { line: None, reports: vec![error.into()] },
    }
}

fn program(file: &Path, settings: Settings) -> Verdict {
    let summary = match gcode::check(file, settings) {
        Ok(summary) => summary,
        Err(CheckError::Read(error)) => return Verdict { line: None, reports: vec![error.into()] },
        Err(CheckError::Faults(faults)) => {
            return Verdict { line: None, reports: faults.into_iter().map(Report::new).collect() };
        }
    };
    let (dialect, reason) = summary.dialect;
    let line = format!(
        "{}, {}, {:.3} mm of feed, {:.3} mm of rapids, read as {dialect}: {reason}",
        counted(summary.lines, "line"),
        counted(summary.motions, "motion"),
        summary.feed_mm,
        summary.rapid_mm
    );
    Verdict { line: Some(line), reports: summary.warnings.into_iter().map(Report::new).collect() }
}

fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
