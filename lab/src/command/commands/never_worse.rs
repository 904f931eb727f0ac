//! `feedwright-lab never-worse`: programs on many machines, uncorrected and corrected.
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright::command::{Console, FilesToCheck, printed};
use feedwright_gcode::Settings;
use feedwright_sim::{Machine, Watch};
use glob::Pattern;
use miette::{Result, miette};
use rayon::prelude::*;

use crate::command::args::never_worse::NeverWorseArgs;
use crate::command::sweep::{Sweep, code, loaded, print};
use crate::never_worse::program::{Length, SweepProgram};
use crate::never_worse::summary::SweepSummary;
use crate::never_worse::{SweepJob, jobs, machines, sample};

/// The machine whose time counts where long programs are shortened.
const PACE: &str = "tnv40";
/// A week of machining, s: more is a mistaken unit.
const MAX_S: f64 = 7.0 * 24.0 * 3600.0;

pub(crate) fn run(args: &NeverWorseArgs, console: &Console) -> Result<ExitCode> {
    checked(args.limit_s)?;
    let machines = if args.machine.is_empty() {
        machines::machines()?
    } else {
        loaded(&args.machine)?
    };
    let files = files(args)?;
    let machine_files: Vec<PathBuf> = args.machine.iter().map(PathBuf::from).collect();
    let inputs: Vec<&Path> = files
        .iter()
        .chain(&machine_files)
        .map(PathBuf::as_path)
        .collect();
    let controller = std::slice::from_ref(&args.one.controller);
    let sweep = Sweep::new(&args.sweep, controller, &inputs)?;
    let pace = Machine::load(PACE.as_ref())?;
    let settings = args.reader.settings()?;
    let programs = read(&files, &settings, &pace, args.limit_s, console)?;
    let jobs = jobs(programs, machines);
    let jobs = match args.sample {
        Some(count) => sample(jobs, count, args.sweep.seed),
        None => jobs,
    };
    announce(&jobs);
    let (summary, printing) = sweep.run(&jobs, console, SweepSummary::of, print)?;
    printed(printing, code(summary.worse > 0))
}

/// A time of machining that can be cut, s.
pub(super) fn checked(limit_s: f64) -> Result<()> {
    if limit_s > 0.0 && limit_s <= MAX_S {
        return Ok(());
    }
    let help = "600 is the first ten minutes of machining";
    Err(miette!(
        help = help,
        "--limit-s is {limit_s} s; it must lie above 0 and up to {MAX_S} s"
    ))
}

/// The programs in these places.
pub(super) fn found(places: &[PathBuf]) -> Result<Vec<PathBuf>> {
    if let Some(missing) = places.iter().find(|path| !path.exists()) {
        return Err(miette!(
            help = "name programs, or folders that hold some",
            "{}: there is no such file or folder",
            missing.display()
        ));
    }
    let found = FilesToCheck::find(places);
    if let Some(fault) = found.faults.first() {
        return Err(miette!("{fault}"));
    }
    Ok(found.files)
}

/// The programs that are asked for.
fn files(args: &NeverWorseArgs) -> Result<Vec<PathBuf>> {
    let found = found(&args.programs)?;
    let Some(only) = &args.only else {
        return Ok(found);
    };
    let pattern = Pattern::new(only).map_err(|error| miette!("--only {only}: {error}"))?;
    let fits = |file: &PathBuf| pattern.matches_path(file);
    let files: Vec<PathBuf> = found.into_iter().filter(fits).collect();
    if files.is_empty() {
        return Err(miette!(
            help = "the pattern is for the whole path: '*circle*'",
            "--only {only}: no program fits"
        ));
    }
    Ok(files)
}

/// Reads all programs, and shortens long ones by their time on a machine; those with mistakes are
/// counted and left out.
pub(super) fn read(
    files: &[PathBuf],
    settings: &Settings,
    pace: &Machine,
    limit_s: f64,
    console: &Console,
) -> Result<Vec<SweepProgram>> {
    let length = Length(pace, limit_s);
    let bar = console.bar(0);
    bar.begin("reading the programs", files.len() as u64);
    let read = |file: &PathBuf| {
        let is_cancelled = bar.is_cancelled();
        let program = (!is_cancelled).then(|| SweepProgram::read(file, settings, length).ok());
        bar.advance(1);
        program.flatten()
    };
    let programs: Vec<SweepProgram> = files.par_iter().filter_map(read).collect();
    bar.clear();
    bar.check()?;
    let refused = files.len() - programs.len();
    if refused > 0 {
        eprintln!(
            "left out, with mistakes or without motion: {refused} of {} (feedwright check says why)",
            files.len()
        );
    }
    if programs.is_empty() {
        return Err(miette!("none of the programs can be cut"));
    }
    Ok(programs)
}

fn announce(jobs: &[SweepJob]) {
    let hours = jobs.iter().map(|job| job.program.machining_s).sum::<f64>() / 3600.0;
    let shortened = jobs.iter().filter(|job| job.program.shortened).count();
    let parts = match shortened {
        0 => String::new(),
        _ => format!("; {shortened} of them of the beginning of a program"),
    };
    let cuts = jobs.len();
    eprintln!("{cuts} cuts, {hours:.1} h of machining on {PACE}{parts}");
}
