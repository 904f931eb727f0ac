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
use std::sync::atomic::{AtomicU64, Ordering};

use feedwright::{Entry, cache_folder, key_of};
use feedwright_lab::{
    CONTROLLERS, Comparison, ComparisonOptions, Finished, Journal, Knowledge, Tuning, Workpiece, compare, journal_path,
};
use feedwright_sim::{Machine, Watch};
use levels::{BASE, KINDS, LEVELS};

type Failure = Box<dyn std::error::Error>;

/// What is cut.
const CONTOURS: [&str; 4] = ["circle", "eight", "star", "square"];
/// Seed of the comparison, the default of the command line.
const SEED: u64 = 1;
/// Noise seeds of each cut; the searches have another.
const NOISE_SEEDS: u32 = 3;
const USAGE: &str = "usage: noise_levels FOLDER [LEVELS [defaults]], with 1 to 5 levels of each kind";

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (folder, levels, tuning) = match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [folder] => (folder, LEVELS, Tuning::Search),
        [folder, levels] => (folder, count(levels)?, Tuning::Search),
        [folder, levels, "defaults"] => (folder, count(levels)?, Tuning::Defaults),
        _ => return Err(USAGE.into()),
    };
    let options = options(levels, tuning)?;
    let (journal, progress) = (journal(&options), Progress::default());
    let mut comparison = compare(&options, &journal, &progress)?;
    eprintln!();
    comparison.verdicts.clear();
    comparison.rows.iter_mut().for_each(|row| row.error_um.clear());
    write(Path::new(folder), &comparison)?;
    journal.remove();
    Ok(())
}

fn count(levels: &str) -> Result<usize, Failure> {
    Ok(levels.parse().ok().filter(|levels| (1..=LEVELS).contains(levels)).ok_or(USAGE)?)
}

/// The journal of these options and this program; none where there is no place for it.
fn journal(options: &ComparisonOptions) -> Journal<Finished> {
    let program = std::env::current_exe().and_then(std::fs::read).unwrap_or_default();
    let key = key_of(&[options.fingerprint().as_bytes(), &program]);
    let path = cache_folder().map(|folder| journal_path(&folder, &key));
    path.and_then(|path| Journal::open(&path).ok()).unwrap_or_else(Journal::none)
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
    let controllers: Option<Vec<&'static Entry>> =
        show::CONTROLLERS.into_iter().map(|name| CONTROLLERS.find(name)).collect();
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
        _ => (0..levels).map(|k| k * (LEVELS - 1) / (levels - 1)).collect(),
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
    std::fs::write(folder.join(show::COMPARISON), serde_json::to_string_pretty(comparison)? + "\n")?;
    for (name, drawing) in show::figures(comparison) {
        std::fs::write(folder.join(name), drawing)?;
    }
    if let Some(text) = rewritten {
        std::fs::write(document, text)?;
    }
    print!("{table}");
    Ok(())
}

/// Progress on stderr, in per cent.
#[derive(Default)]
struct Progress {
    stage: std::sync::Mutex<String>,
    steps: AtomicU64,
    done: AtomicU64,
}

impl Progress {
    fn show(&self, done: u64) {
        if let Ok(stage) = self.stage.lock() {
            eprint!("\r{stage}: {done} of {}   ", self.steps.load(Ordering::Relaxed));
        }
    }
}

impl Watch for Progress {
    fn begin(&self, stage: &str, steps: u64) {
        if let Ok(mut name) = self.stage.lock() {
            stage.clone_into(&mut name);
        }
        self.steps.store(steps, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
        eprintln!();
        self.show(0);
    }

    fn advance(&self, steps: u64) {
        self.show(self.done.fetch_add(steps, Ordering::Relaxed) + steps);
    }
}
