//! The limit, peers and the controllers of feedwright over the level of each kind of noise:
//! `just noise-levels`, the study examples/05_noise.
//!
//! `noise_levels FOLDER [LEVELS [defaults]]` tunes every peer on `tnv40` with one kind of noise at
//! each level, and then cuts there. It writes the comparison (noise.json) and a figure for each
//! kind into the folder, and updates the table of the README.md there, if it exists.
//!
//! LEVELS, 1 to 5, is the number of levels of each kind, spread from the lowest to the highest.
//! With `defaults` the peers are not tuned: the result is a trial, and the table says so. An
//! interrupted run continues where it stopped.

mod levels;
mod show;

use std::path::Path;
use std::process::ExitCode;

use feedwright::Entry;
use feedwright::command::{Console, with_console};
use feedwright_lab::{
    CONTROLLERS, Comparison, ComparisonOptions, Kept, Knowledge, Tuning, Workpiece, compare,
};
use feedwright_sim::Machine;
use levels::{BASE, KINDS, LEVELS};
use miette::miette;

type Failure = Box<dyn std::error::Error>;

/// Contours to cut.
const CONTOURS: [&str; 4] = ["circle", "eight", "star", "square"];
/// Seed of the comparison, the default of the command line.
const SEED: u64 = 1;
/// Noise seeds of each cut; the searches have another.
const NOISE_SEEDS: u32 = 3;
const USAGE: &str =
    "usage: noise_levels FOLDER [LEVELS [defaults]], with 1 to 5 levels of each kind";

fn main() -> ExitCode {
    let code = |(): ()| ExitCode::SUCCESS;
    with_console(false, true, |console| {
        run(console).map(code).map_err(|error| miette!("{error}"))
    })
}

fn run(console: &Console) -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (folder, levels, tuning) = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..]
    {
        [folder] => (folder, LEVELS, Tuning::Search),
        [folder, levels] => (folder, count(levels)?, Tuning::Search),
        [folder, levels, "defaults"] => (folder, count(levels)?, Tuning::Defaults),
        _ => return Err(USAGE.into()),
    };
    let options = options(levels, tuning)?;
    let kept = Kept::open(None, &options.fingerprint())?;
    let bar = console.bar(0);
    let comparison = compare(&options, &kept, &bar);
    bar.clear();
    // It claims nothing.
    let comparison = Comparison {
        claims: vec![],
        ..comparison?
    };
    write(Path::new(folder), &comparison)?;
    kept.complete();
    Ok(())
}

fn count(levels: &str) -> Result<usize, Failure> {
    Ok(levels
        .parse()
        .ok()
        .filter(|levels| (1..=LEVELS).contains(levels))
        .ok_or(USAGE)?)
}

/// Every controller on every machine.
fn options(levels: usize, tuning: Tuning) -> Result<ComparisonOptions, Failure> {
    let nominal = Machine::load(BASE.as_ref())?;
    let mut machines = vec![nominal.clone()];
    for kind in &KINDS {
        for k in spread(levels) {
            machines.push(kind.machine(kind.levels[k])?);
        }
    }
    let controllers: Option<Vec<&'static Entry>> = show::CONTROLLERS
        .into_iter()
        .map(|name| CONTROLLERS.find(name))
        .collect();
    let mut workpieces = Workpiece::contours();
    workpieces.retain(|workpiece| CONTOURS.contains(&workpiece.name.as_str()));
    Ok(ComparisonOptions {
        workpieces,
        nominal,
        machines,
        controllers: controllers.ok_or("a controller of the study is none of the table")?,
        knowledge: vec![Knowledge::Own],
        seed: SEED,
        noise_seeds: NOISE_SEEDS,
        tuning,
        set: Vec::new(),
        at_tolerance: false,
    })
}

/// Returns the indices of `levels` of the levels, spread from the lowest to the highest. A single
/// one is the middle.
fn spread(levels: usize) -> Vec<usize> {
    match levels {
        1 => vec![LEVELS / 2],
        _ => (0..levels)
            .map(|k| k * (LEVELS - 1) / (levels - 1))
            .collect(),
    }
}

fn write(folder: &Path, comparison: &Comparison) -> Result<(), Failure> {
    let table = show::table(comparison)?;
    let document = folder.join(show::DOCUMENT);
    let rewritten = match std::fs::read_to_string(&document) {
        Ok(text) => {
            let old = show::place(&text)?;
            Some([&text[..old.start], &table, &text[old.end..]].concat())
        }
        Err(_) => None,
    };
    std::fs::create_dir_all(folder)?;
    std::fs::write(folder.join(show::COMPARISON), comparison.text())?;
    for (name, drawing) in show::figures(comparison) {
        std::fs::write(folder.join(name), drawing)?;
    }
    if let Some(text) = rewritten {
        std::fs::write(document, text)?;
    }
    print!("{table}");
    Ok(())
}
