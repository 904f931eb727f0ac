//! The work of a comparison in units: the cuts of a competitor on a machine, or the raising of the feed of a controller on a contour.
//! A shard is every n-th unit. What a journal holds is not done again, and a comparison can be put together from journals alone.

use std::collections::HashMap;
use std::str::FromStr;
use std::sync::{Arc, Mutex, PoisonError};

use feedwright::Entry;
use feedwright_sim::{Machine, PlanCache, RunError, Watch};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::competitor::{Competitor, Knowledge};
use super::cut;
use super::options::{ComparisonOptions, RowsStamp};
use super::table::ComparisonRow;
use super::tolerance::{self, AtTolerance};
use super::tuned::Tuned;
use super::tuning;
use super::work::Workpiece;
use crate::contour::Contour;
use crate::journal::Journal;

/// What a journal holds of a comparison.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub enum Finished {
    /// Of which comparison it is, and by which program.
    Stamp(RowsStamp),
    /// The values of a controller on a machine.
    Tuned(Tuned),
    /// A row.
    Row(ComparisonRow),
    /// The feed at which a tolerance just holds.
    AtTolerance(AtTolerance),
}

/// All that was worked out, ratios still open.
#[derive(Debug, Default)]
pub struct UnitResults {
    /// The values that the controllers ran with.
    pub tuned: Vec<Tuned>,
    /// Rows by machine, competitor and workpiece.
    pub rows: Vec<ComparisonRow>,
    /// By contour and controller.
    pub at_tolerance: Vec<AtTolerance>,
}

/// A part of the units: those whose number, counted from 0, leaves `index` when divided by `count`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    index: usize,
    count: usize,
}

impl Shard {
    /// All of them.
    pub const ALL: Self = Self { index: 0, count: 1 };

    pub(crate) fn of<T>(self, units: Vec<T>) -> Vec<T> {
        units.into_iter().skip(self.index).step_by(self.count).collect()
    }
}

impl FromStr for Shard {
    type Err = String;

    /// `i/n`, i from 1 to n.
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index: index - 1, count }),
            _ => Err("a shard is i/n with i from 1 to n, such as 2/3".to_owned()),
        }
    }
}

/// What no journal holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct MissingUnits {
    /// In words, in the order of the work.
    pub units: Vec<String>,
}

/// A unit of work.
#[derive(Clone, Copy)]
enum WorkUnit<'a> {
    Cuts(&'a Machine, Competitor),
    Tolerance(&'a Machine, &'static Contour, &'static Entry),
}

impl<'a> WorkUnit<'a> {
    fn all(options: &'a ComparisonOptions) -> Vec<Self> {
        let cuts = options.machines.iter().flat_map(|machine| {
            options.competitors(machine).into_iter().map(move |competitor| Self::Cuts(machine, competitor))
        });
        let on = options.machines.first().filter(|_| options.at_tolerance);
        let raised = on.into_iter().flat_map(|machine| {
            let contours = tolerance::contours(options);
            contours.into_iter().flat_map(move |contour| {
                options.controllers.iter().map(move |&entry| Self::Tolerance(machine, contour, entry))
            })
        });
        cuts.chain(raised).collect()
    }

    /// The machine and the controller whose values it needs.
    fn tuned_on(&self, options: &'a ComparisonOptions) -> (&'a Machine, &'static Entry) {
        match *self {
            Self::Cuts(_, Competitor { entry, knowledge: Knowledge::Unseen }) => (&options.nominal, entry),
            Self::Cuts(machine, Competitor { entry, .. }) | Self::Tolerance(machine, _, entry) => (machine, entry),
        }
    }

    fn steps(&self, options: &ComparisonOptions) -> usize {
        if matches!(self, Self::Cuts(..)) { options.workpieces.len() } else { 1 }
    }
}

fn key(parts: [&str; 4]) -> String {
    serde_json::json!(parts).to_string()
}

fn tuned_key(machine: &Machine, entry: &Entry) -> String {
    key(["tuned", &machine.name, entry.name, ""])
}

fn row_key(workpiece: &Workpiece, machine: &Machine, competitor: &Competitor) -> String {
    key(["row", &workpiece.name, &machine.name, &competitor.name()])
}

fn tolerance_key(machine: &Machine, contour: &Contour, entry: &Entry) -> String {
    key(["at tolerance", contour.name, &machine.name, entry.name])
}

/// Tunes and cuts what belongs to a shard; what the journal holds is not done again.
///
/// # Errors
/// Where a machine has no sensible limits, or where it is ended from outside.
pub fn work_on(
    options: &ComparisonOptions,
    shard: Shard,
    journal: &Journal<Finished>,
    watch: &dyn Watch,
) -> Result<UnitResults, RunError> {
    let units = shard.of(WorkUnit::all(options));
    let tuned = tune(options, &units, journal, watch)?;
    watch.begin("cutting", units.iter().map(|unit| unit.steps(options) as u64).sum());
    let plans = Plans::default();
    let parts: Result<Vec<UnitResults>, RunError> = units
        .par_iter()
        .map(|unit| {
            let (on, entry) = unit.tuned_on(options);
            let values = tuned.iter().find(|tuned| tuned.machine == on.name && tuned.controller == entry.name);
            match unit {
                WorkUnit::Cuts(machine, competitor) => {
                    cuts(options, machine, competitor, values, journal, &plans, watch)
                }
                WorkUnit::Tolerance(machine, contour, entry) => {
                    raised(options, machine, contour, entry, values, journal, watch)
                }
            }
        })
        .collect();
    Ok(UnitResults::of(tuned, parts?))
}

/// Tunes what belongs to a shard, and cuts nothing.
///
/// # Errors
/// As [`work_on`].
pub fn tune_alone(
    options: &ComparisonOptions,
    shard: Shard,
    journal: &Journal<Finished>,
    watch: &dyn Watch,
) -> Result<Vec<Tuned>, RunError> {
    tune(options, &shard.of(WorkUnit::all(options)), journal, watch)
}

/// The comparison as journals have it.
///
/// # Errors
/// What none of them has.
pub fn merged(options: &ComparisonOptions, journal: &Journal<Finished>) -> Result<UnitResults, MissingUnits> {
    let units = WorkUnit::all(options);
    let (mut results, mut missing) = (UnitResults::default(), Vec::new());
    for (machine, entry) in tuned_on(options, &units) {
        match known(options, machine, entry, journal) {
            Some(tuned) => results.tuned.push(tuned),
            None => missing.push(format!("the values of {} on {}", entry.name, machine.name)),
        }
    }
    for unit in &units {
        match unit {
            WorkUnit::Cuts(machine, competitor) => {
                let before = results.rows.len();
                results.rows.extend(options.workpieces.iter().filter_map(|workpiece| {
                    match journal.get(&row_key(workpiece, machine, competitor)) {
                        Some(Finished::Row(row)) => Some(row.clone()),
                        _ => None,
                    }
                }));
                let open = options.workpieces.len() - (results.rows.len() - before);
                if open > 0 {
                    let (name, of) = (competitor.name(), options.workpieces.len());
                    missing.push(format!("{name} on {}: {open} of {of} workpieces", machine.name));
                }
            }
            WorkUnit::Tolerance(machine, contour, entry) => {
                match journal.get(&tolerance_key(machine, contour, entry)) {
                    Some(Finished::AtTolerance(row)) => results.at_tolerance.push(row.clone()),
                    _ => missing.push(format!("the tolerance of {} on {}", entry.name, contour.name)),
                }
            }
        }
    }
    if missing.is_empty() { Ok(results) } else { Err(MissingUnits { units: missing }) }
}

impl UnitResults {
    fn of(tuned: Vec<Tuned>, parts: Vec<Self>) -> Self {
        let mut all = Self { tuned, ..Self::default() };
        for part in parts {
            all.rows.extend(part.rows);
            all.at_tolerance.extend(part.at_tolerance);
        }
        all
    }
}

/// Machines and controllers whose values the units need, each once, in the order of machines and controllers.
fn tuned_on<'a>(options: &'a ComparisonOptions, units: &[WorkUnit<'a>]) -> Vec<(&'a Machine, &'static Entry)> {
    let needed: Vec<_> = units.iter().map(|unit| unit.tuned_on(options)).collect();
    let is_needed = |machine: &Machine, entry: &Entry| {
        needed.iter().any(|(on, of)| on.name == machine.name && of.name == entry.name)
    };
    let others = options.machines.iter().filter(|machine| machine.name != options.nominal.name);
    std::iter::once(&options.nominal)
        .chain(others)
        .flat_map(|machine| options.controllers.iter().map(move |&entry| (machine, entry)))
        .filter(|(machine, entry)| options.has_values(entry) && is_needed(machine, entry))
        .collect()
}

/// Values that are given, or that a journal holds.
fn known(
    options: &ComparisonOptions,
    machine: &Machine,
    entry: &'static Entry,
    journal: &Journal<Finished>,
) -> Option<Tuned> {
    options.given(machine, entry).or_else(|| match journal.get(&tuned_key(machine, entry)) {
        Some(Finished::Tuned(tuned)) => Some(tuned.clone()),
        _ => None,
    })
}

/// The values that the units need.
fn tune(
    options: &ComparisonOptions,
    units: &[WorkUnit<'_>],
    journal: &Journal<Finished>,
    watch: &dyn Watch,
) -> Result<Vec<Tuned>, RunError> {
    let pairs = tuned_on(options, units);
    watch.begin("tuning every controller alike", pairs.len() as u64);
    pairs
        .par_iter()
        .map(|(machine, entry)| {
            let tuned = match known(options, machine, entry, journal) {
                Some(tuned) => tuned,
                None => {
                    let tuned = tuning::search(entry, machine, options.seed, watch)?;
                    journal.add(&tuned_key(machine, entry), &Finished::Tuned(tuned.clone()));
                    tuned
                }
            };
            watch.advance(1);
            Ok(tuned)
        })
        .collect()
}

/// The plan of each workpiece on each machine, for all controllers that cut it there.
#[derive(Default)]
struct Plans(Mutex<HashMap<[String; 2], Arc<PlanCache>>>);

impl Plans {
    fn of(&self, workpiece: &Workpiece, machine: &Machine) -> Arc<PlanCache> {
        let key = [workpiece.name.clone(), machine.name.clone()];
        self.0.lock().unwrap_or_else(PoisonError::into_inner).entry(key).or_default().clone()
    }
}

/// The rows of a competitor on a machine: one for each workpiece.
fn cuts(
    options: &ComparisonOptions,
    machine: &Machine,
    competitor: &Competitor,
    tuned: Option<&Tuned>,
    journal: &Journal<Finished>,
    plans: &Plans,
    watch: &dyn Watch,
) -> Result<UnitResults, RunError> {
    let seeds = cut::seeds(machine, options);
    // Made once and where it is needed: what it has identified serves all workpieces and seeds.
    let mut controller = None;
    let mut row = |workpiece: &Workpiece| {
        let key = row_key(workpiece, machine, competitor);
        let row = match journal.get(&key) {
            Some(Finished::Row(row)) => row.clone(),
            _ => {
                let controller =
                    controller.get_or_insert_with(|| competitor.make(machine, &options.nominal, options.seed, tuned));
                let plan = plans.of(workpiece, machine);
                let row = cut::row(workpiece, machine, competitor, &mut **controller, &seeds, &plan, watch)?;
                journal.add(&key, &Finished::Row(row.clone()));
                row
            }
        };
        watch.advance(1);
        Ok(row)
    };
    let rows: Result<Vec<ComparisonRow>, RunError> = options.workpieces.iter().map(&mut row).collect();
    Ok(UnitResults { rows: rows?, ..UnitResults::default() })
}

/// The feed of a controller on a contour, raised until the tolerance just holds.
fn raised(
    options: &ComparisonOptions,
    machine: &Machine,
    contour: &'static Contour,
    entry: &'static Entry,
    tuned: Option<&Tuned>,
    journal: &Journal<Finished>,
    watch: &dyn Watch,
) -> Result<UnitResults, RunError> {
    let key = tolerance_key(machine, contour, entry);
    let row = match journal.get(&key) {
        Some(Finished::AtTolerance(row)) => row.clone(),
        _ => {
            let competitor = Competitor::own(entry);
            let mut controller = competitor.make(machine, &options.nominal, options.seed, tuned);
            let row = tolerance::raised(contour, machine, &competitor, &mut *controller, options, watch)?;
            journal.add(&key, &Finished::AtTolerance(row.clone()));
            row
        }
    };
    watch.advance(1);
    Ok(UnitResults { at_tolerance: vec![row], ..UnitResults::default() })
}
