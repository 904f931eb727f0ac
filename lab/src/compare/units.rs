//! The work of a comparison in units: the cuts of a competitor on a machine, or the raising of the
//! feed of a controller on a contour. Stored work is not done again.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use feedwright::Entry;
use feedwright_sim::{Machine, PlanCache, RunError, Watch};
use rayon::prelude::*;

use super::competitor::{Competitor, Knowledge};
use super::cut;
use super::options::ComparisonOptions;
use super::table::ComparisonRow;
use super::tolerance::{self, AtTolerance};
use super::tuned::Tuned;
use super::tuning;
use super::work::Workpiece;
use crate::contour::Contour;
use crate::kept::Kept;

/// All results, ratios still open.
#[derive(Debug, Default)]
pub(super) struct UnitResults {
    /// The values that the controllers ran with.
    pub(super) tuned: Vec<Tuned>,
    /// Rows by machine, competitor and workpiece.
    pub(super) rows: Vec<ComparisonRow>,
    /// Results at equal tolerance, by contour and controller.
    pub(super) at_tolerance: Vec<AtTolerance>,
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
            options
                .competitors(machine)
                .into_iter()
                .map(move |competitor| Self::Cuts(machine, competitor))
        });
        let on = options.machines.first().filter(|_| options.at_tolerance);
        let raised = on.into_iter().flat_map(|machine| {
            let contours = tolerance::contours(options);
            contours.into_iter().flat_map(move |contour| {
                options
                    .controllers
                    .iter()
                    .map(move |&entry| Self::Tolerance(machine, contour, entry))
            })
        });
        cuts.chain(raised).collect()
    }

    /// The machine and the controller whose values it needs.
    fn tuned_on(&self, options: &'a ComparisonOptions) -> (&'a Machine, &'static Entry) {
        match *self {
            Self::Cuts(
                _,
                Competitor {
                    entry,
                    knowledge: Knowledge::Unseen,
                },
            ) => (&options.nominal, entry),
            Self::Cuts(machine, Competitor { entry, .. }) | Self::Tolerance(machine, _, entry) => {
                (machine, entry)
            }
        }
    }

    fn steps(&self, options: &ComparisonOptions) -> usize {
        if matches!(self, Self::Cuts(..)) {
            options.workpieces.len()
        } else {
            1
        }
    }
}

fn key(parts: [&str; 4]) -> String {
    serde_json::json!(parts).to_string()
}

fn row_key(workpiece: &Workpiece, machine: &Machine, competitor: &Competitor) -> String {
    key(["row", &workpiece.name, &machine.name, &competitor.name()])
}

fn tolerance_key(machine: &Machine, contour: &Contour, entry: &Entry) -> String {
    key(["at tolerance", contour.name, &machine.name, entry.name])
}

/// Tunes and cuts everything.
///
/// # Errors
/// Where a machine has no sensible limits, or where it is ended from outside.
pub(super) fn work_on(
    options: &ComparisonOptions,
    kept: &Kept,
    watch: &dyn Watch,
) -> Result<UnitResults, RunError> {
    let units = WorkUnit::all(options);
    let tuned = tune_alone(options, kept, watch)?;
    watch.begin(
        "cutting",
        units.iter().map(|unit| unit.steps(options) as u64).sum(),
    );
    let plans = Plans::default();
    let parts: Result<Vec<UnitResults>, RunError> = units
        .par_iter()
        .map(|unit| {
            let (on, entry) = unit.tuned_on(options);
            let values = tuned
                .iter()
                .find(|tuned| tuned.machine == on.name && tuned.controller == entry.name);
            match unit {
                WorkUnit::Cuts(machine, competitor) => {
                    cuts(options, machine, competitor, values, kept, &plans, watch)
                }
                WorkUnit::Tolerance(machine, contour, entry) => {
                    raised(options, machine, contour, entry, values, kept, watch)
                }
            }
        })
        .collect();
    Ok(UnitResults::of(tuned, parts?))
}

impl UnitResults {
    fn of(tuned: Vec<Tuned>, parts: Vec<Self>) -> Self {
        let mut all = Self {
            tuned,
            ..Self::default()
        };
        for part in parts {
            all.rows.extend(part.rows);
            all.at_tolerance.extend(part.at_tolerance);
        }
        all
    }
}

/// Machines and controllers whose values the units need, each once, in the order of machines and
/// controllers.
fn tuned_on<'a>(
    options: &'a ComparisonOptions,
    units: &[WorkUnit<'a>],
) -> Vec<(&'a Machine, &'static Entry)> {
    let needed: Vec<_> = units.iter().map(|unit| unit.tuned_on(options)).collect();
    let is_needed = |machine: &Machine, entry: &Entry| {
        needed
            .iter()
            .any(|(on, of)| on.name == machine.name && of.name == entry.name)
    };
    let others = options
        .machines
        .iter()
        .filter(|machine| machine.name != options.nominal.name);
    std::iter::once(&options.nominal)
        .chain(others)
        .flat_map(|machine| {
            options
                .controllers
                .iter()
                .map(move |&entry| (machine, entry))
        })
        .filter(|(machine, entry)| options.has_values(entry) && is_needed(machine, entry))
        .collect()
}

/// Tunes the controllers, and cuts nothing.
///
/// # Errors
/// Where a machine has no sensible limits, or where it is ended from outside.
pub fn tune_alone(
    options: &ComparisonOptions,
    kept: &Kept,
    watch: &dyn Watch,
) -> Result<Vec<Tuned>, RunError> {
    let pairs = tuned_on(options, &WorkUnit::all(options));
    watch.begin("tuning every controller alike", pairs.len() as u64);
    let tune = |(machine, entry): &(&Machine, &'static Entry)| {
        let tuned = match options.given(machine, entry) {
            Some(given) => given,
            None => {
                let key = key(["tuned", &machine.name, entry.name, ""]);
                kept.once(&key, || tuning::search(entry, machine, options.seed, watch))?
            }
        };
        watch.advance(1);
        Ok(tuned)
    };
    pairs.par_iter().map(tune).collect()
}

/// The plan of each workpiece on each machine, for all controllers that cut it there.
#[derive(Default)]
struct Plans(Mutex<HashMap<[String; 2], Arc<PlanCache>>>);

impl Plans {
    fn of(&self, workpiece: &Workpiece, machine: &Machine) -> Arc<PlanCache> {
        let key = [workpiece.name.clone(), machine.name.clone()];
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .entry(key)
            .or_default()
            .clone()
    }
}

/// The rows of a competitor on a machine: one for each workpiece.
fn cuts(
    options: &ComparisonOptions,
    machine: &Machine,
    competitor: &Competitor,
    tuned: Option<&Tuned>,
    kept: &Kept,
    plans: &Plans,
    watch: &dyn Watch,
) -> Result<UnitResults, RunError> {
    let seeds = cut::seeds(machine, options);
    // Made once and where it is needed: what it has identified serves all workpieces and seeds.
    let mut controller = None;
    let mut row = |workpiece: &Workpiece| {
        let row = kept.once(&row_key(workpiece, machine, competitor), || {
            let controller = controller.get_or_insert_with(|| {
                competitor.make(machine, &options.nominal, options.seed, tuned)
            });
            let plan = plans.of(workpiece, machine);
            cut::row(
                workpiece,
                machine,
                competitor,
                &mut **controller,
                &seeds,
                &plan,
                watch,
            )
        })?;
        watch.advance(1);
        Ok(row)
    };
    let rows: Result<Vec<ComparisonRow>, RunError> =
        options.workpieces.iter().map(&mut row).collect();
    Ok(UnitResults {
        rows: rows?,
        ..UnitResults::default()
    })
}

/// The feed of a controller on a contour, raised until the tolerance just holds.
fn raised(
    options: &ComparisonOptions,
    machine: &Machine,
    contour: &'static Contour,
    entry: &'static Entry,
    tuned: Option<&Tuned>,
    kept: &Kept,
    watch: &dyn Watch,
) -> Result<UnitResults, RunError> {
    let row = kept.once(&tolerance_key(machine, contour, entry), || {
        let competitor = Competitor::own(entry);
        let mut controller = competitor.make(machine, &options.nominal, options.seed, tuned);
        tolerance::raised(
            contour,
            machine,
            &competitor,
            &mut *controller,
            options,
            watch,
        )
    })?;
    watch.advance(1);
    Ok(UnitResults {
        at_tolerance: vec![row],
        ..UnitResults::default()
    })
}
