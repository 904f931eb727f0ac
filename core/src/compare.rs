//! The comparison: every controller on every contour and machine, in one table.
//!
//! Controllers are made from what is known of one machine, the nominal one, and cut on all others unseen; those that
//! identify also appear once more, identified on the machine that they cut on. Every controller with parameters is tuned
//! by the same search first ([`tuning`]). A table is the same bit by bit for the same options, whatever the number of
//! threads.
//!
//! | File | What |
//! |---|---|
//! | `compare/cut.rs` | one cut |
//! | `compare/tuned.rs` | the values that a controller runs with |
//! | `compare/tuning.rs` | the search that tunes every controller alike |
//! | `compare/table.rs` | rows and their ratios |
//! | `compare/overview.rs` | what tables over many rows are made of |
//! | `compare/verdict.rs` | what is claimed, row by row |
//! | `compare/tolerance.rs` | the machining time at which a tolerance just holds |
//! | `compare/page.rs` | the page |

pub mod table;
pub mod tuned;
mod cut;
pub mod tuning;
pub mod tolerance;
pub mod verdict;
pub mod overview;
pub mod page;

use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::controllers::{Entry, Knows, Setting};
use crate::gcode;
use crate::gcode::canon::Corner;
use crate::journal::Journal;
use crate::machine::Machine;
use crate::path::contour::CONTOURS;
use crate::path::pieces::Pieces;
use crate::path::{PathError, Step};
use crate::pipeline::RunError;
use crate::watch::Watch;
use cut::CompetitorMaker;
use table::ComparisonRow;
use tolerance::AtTolerance;
use tuned::Tuned;
use verdict::Verdict;

/// Feedrate of the contours, mm/s.
pub const FEED_MM_S: f64 = 50.0;
/// How corners of the contours are taken: at the speed that the machine's limits allow.
pub(crate) const CORNER: Corner = Corner::Continuous { tolerance_mm: None };
/// Contour on which controllers are tuned.
pub const TUNING_CONTOUR: &str = "eight";

/// Something to cut.
#[derive(Debug, Clone)]
pub struct Workpiece {
    /// Name.
    pub name: String,
    /// Whether it has no corners.
    pub smooth: bool,
    /// Its path.
    pub steps: Vec<Step>,
}

impl Workpiece {
    /// The closed-form contours at [`FEED_MM_S`].
    pub fn contours() -> Vec<Self> {
        CONTOURS
            .iter()
            .map(|contour| Self {
                name: contour.name.to_owned(),
                smooth: contour.is_smooth(),
                steps: contour.steps(FEED_MM_S, CORNER).expect("the built-in contours have a path"),
            })
            .collect()
    }

    /// A program, read by `settings` as it is elsewhere.
    ///
    /// # Errors
    /// A program with mistakes, one that leaves the XY plane, or one without a path.
    pub fn program(file: &Path, settings: gcode::Settings) -> Result<Self, PartError> {
        let summary = gcode::check(file, settings.clone()).map_err(crate::job::JobError::from)?;
        if summary.moves[2] {
            return Err(PartError::LeavesPlane { part: file.to_owned() });
        }
        let steps = gcode::Reader::open(file, settings).map_err(crate::job::JobError::from)?.map_while(Result::ok);
        let steps: Result<Vec<Step>, PathError> = Pieces::new(steps).collect();
        let name = file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned();
        let steps = steps.map_err(|fault| crate::job::JobError::Path { part: file.to_owned(), fault })?;
        Ok(Self { name, smooth: false, steps })
    }
}

/// Why a program cannot be compared on.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum PartError {
    /// It cannot be read, or has mistakes.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Program(#[from] crate::job::JobError),
    /// The comparison is of two axes.
    #[error("{} moves Z; the comparison is of motions in the XY plane", part.display())]
    #[diagnostic(help("feedwright run compares two controllers on programs in space"))]
    LeavesPlane {
        /// The program.
        part: PathBuf,
    },
}

/// A controller in the comparison.
#[derive(Debug, Clone, Copy)]
pub struct Competitor {
    /// Its row in the table of controllers.
    pub entry: &'static Entry,
    /// Whether it is identified on the machine that it cuts on, instead of the nominal one.
    pub identified_here: bool,
}

/// What stands behind the name of a competitor that is identified on the machine that it cuts on.
pub const IDENTIFIED_HERE: &str = "+identified";

impl Competitor {
    /// Its name in the table.
    pub fn name(&self) -> String {
        format!("{}{}", self.entry.name, if self.identified_here { IDENTIFIED_HERE } else { "" })
    }
}

/// Where the values of the controllers' parameters come from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub enum Tuning {
    /// A search, the same for all.
    Search,
    /// The defaults.
    Defaults,
    /// An earlier search; defaults for controllers that it does not name.
    Known(Vec<Tuned>),
}

/// What is to be compared.
#[derive(Debug, Clone)]
pub struct ComparisonOptions {
    /// Contours and parts.
    pub workpieces: Vec<Workpiece>,
    /// Machines; the first is the nominal one.
    pub machines: Vec<Machine>,
    /// Controllers, open loop among them: the ratios are against it.
    pub controllers: Vec<&'static Entry>,
    /// Seed of everything random.
    pub seed: u64,
    /// Values of the controllers' parameters.
    pub tuning: Tuning,
    /// Parameters that are set; the others of such a controller have their defaults.
    pub set: Vec<Setting>,
    /// Whether to look for the machining times at equal tolerance too.
    pub at_tolerance: bool,
}

/// A finished comparison.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// Name of the nominal machine.
    pub nominal: String,
    /// Seed.
    pub seed: u64,
    /// The values that the controllers ran with.
    pub tuned: Vec<Tuned>,
    /// All rows: by workpiece, then machine, then controller.
    pub rows: Vec<ComparisonRow>,
    /// What is claimed, row by row.
    pub verdicts: Vec<Verdict>,
    /// Machining times at equal tolerance, where they were asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub at_tolerance: Vec<AtTolerance>,
}

impl ComparisonOptions {
    /// The machine that controllers know.
    fn nominal(&self) -> &Machine {
        &self.machines[0]
    }

    /// All competitors in the order of the table.
    pub fn competitors(&self) -> Vec<Competitor> {
        let unseen = self.controllers.iter().map(|&entry| Competitor { entry, identified_here: false });
        let identifying = self.controllers.iter().filter(|entry| entry.knows == Knows::Identified);
        unseen.chain(identifying.map(|&entry| Competitor { entry, identified_here: true })).collect()
    }

    /// What the result depends on, apart from the program: the key of the journal.
    pub fn fingerprint(&self) -> String {
        let workpieces: Vec<_> = self.workpieces.iter().map(|w| (&w.name, format!("{:?}", w.steps))).collect();
        let machines: Vec<_> = self.machines.iter().map(|m| (&m.name, m.fingerprint())).collect();
        let names: Vec<_> = self.controllers.iter().map(|entry| entry.name).collect();
        let content = serde_json::json!([workpieces, machines, names, self.seed, self.tuning, self.set]);
        blake3::hash(content.to_string().as_bytes()).to_hex().to_string()
    }
}

/// What a journal holds of a comparison that was interrupted.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Finished {
    /// The values of a controller.
    Tuned(Tuned),
    /// A row.
    Row(ComparisonRow),
}

/// The journal of a comparison in a folder. The key is that of the options and of the program.
pub fn journal_path(folder: &Path, key: &str) -> PathBuf {
    folder.join(format!("compare-{key}.jsonl"))
}

fn tuned_key(entry: &Entry) -> String {
    serde_json::json!([entry.name]).to_string()
}

fn row_key(workpiece: &Workpiece, machine: &Machine, competitor: &Competitor) -> String {
    serde_json::json!([workpiece.name, machine.name, competitor.name()]).to_string()
}

/// Compares. Rows that the journal holds are not cut again.
///
/// # Errors
/// Where a machine has no sensible limits, or where it is ended from outside.
pub fn compare(
    options: &ComparisonOptions,
    journal: &Journal<Finished>,
    watch: &dyn Watch,
) -> Result<Comparison, RunError> {
    let tuned = tuned(options, journal, watch)?;
    let rows = table::in_order(&cuts(options, &tuned, journal, watch)?, options);
    let at_tolerance = if options.at_tolerance { tolerance::at_tolerance(options, &tuned, watch)? } else { Vec::new() };
    let nominal = options.nominal().name.clone();
    let verdicts = verdict::verdicts(&rows, &nominal, &options.workpieces);
    Ok(Comparison { nominal, seed: options.seed, tuned, rows, verdicts, at_tolerance })
}

/// The values of all controllers that have parameters.
fn tuned(options: &ComparisonOptions, journal: &Journal<Finished>, watch: &dyn Watch) -> Result<Vec<Tuned>, RunError> {
    let is_set = |entry: &Entry| options.set.iter().any(|set| set.controller == entry.name);
    let has_values = |entry: &&&'static Entry| entry.searched().count() > 0 || is_set(entry);
    let tunable: Vec<_> = options.controllers.iter().filter(has_values).collect();
    watch.begin("tuning every controller alike", tunable.len() as u64);
    let values = |entry: &'static Entry| -> Result<Tuned, RunError> {
        Ok(match &options.tuning {
            _ if is_set(entry) => Tuned::set(entry, &options.set),
            Tuning::Search => {
                let tuned = tuning::search(entry, options.nominal(), options.seed, watch)?;
                journal.add(&tuned_key(entry), &Finished::Tuned(tuned.clone()));
                tuned
            }
            Tuning::Defaults => Tuned::defaults(entry),
            Tuning::Known(known) => {
                let known = known.iter().find(|tuned| tuned.controller == entry.name);
                known.cloned().unwrap_or_else(|| Tuned::defaults(entry))
            }
        })
    };
    tunable
        .par_iter()
        .map(|entry| {
            let tuned = match journal.get(&tuned_key(entry)) {
                Some(Finished::Tuned(tuned)) => tuned.clone(),
                _ => values(entry)?,
            };
            watch.advance(1);
            Ok(tuned)
        })
        .collect()
}

/// One row for every workpiece, machine and competitor, by machine and competitor, ratios still open.
fn cuts(
    options: &ComparisonOptions,
    tuned: &[Tuned],
    journal: &Journal<Finished>,
    watch: &dyn Watch,
) -> Result<Vec<ComparisonRow>, RunError> {
    let nominal = options.nominal();
    let competitors = options.competitors();
    let pairs: Vec<(&Machine, &Competitor)> = options
        .machines
        .iter()
        .flat_map(|machine| competitors.iter().map(move |competitor| (machine, competitor)))
        // Identified on the nominal machine it is the unseen controller once more.
        .filter(|(machine, competitor)| !competitor.identified_here || machine.name != nominal.name)
        .collect();
    watch.begin("cutting", (pairs.len() * options.workpieces.len()) as u64);
    let rows: Result<Vec<Vec<ComparisonRow>>, RunError> = pairs
        .par_iter()
        .map(|(machine, competitor)| {
            let maker = CompetitorMaker { competitor, nominal, seed: options.seed, tuned };
            // Made once and where it is needed: what it has identified serves all workpieces.
            let mut controller = None;
            let mut row = |workpiece: &Workpiece| {
                let key = row_key(workpiece, machine, competitor);
                let row = match journal.get(&key) {
                    Some(Finished::Row(row)) => row.clone(),
                    _ => {
                        let controller = controller.get_or_insert_with(|| maker.make(machine));
                        let row = cut::row(workpiece, machine, competitor, &mut **controller, watch)?;
                        journal.add(&key, &Finished::Row(row.clone()));
                        row
                    }
                };
                watch.advance(1);
                Ok(row)
            };
            options.workpieces.iter().map(&mut row).collect()
        })
        .collect();
    Ok(rows?.concat())
}
