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
use crate::study::Kept;

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
struct WorkUnit<'a> {
    machine: &'a Machine,
    competitor: Competitor,
    /// The contour on which the feed is raised; without one all work is cut.
    raised_on: Option<&'static Contour>,
}

impl<'a> WorkUnit<'a> {
    fn all(options: &'a ComparisonOptions) -> Vec<Self> {
        let mut all = Vec::new();
        for machine in &options.machines {
            all.extend(
                options
                    .competitors(machine)
                    .into_iter()
                    .map(|competitor| Self {
                        machine,
                        competitor,
                        raised_on: None,
                    }),
            );
        }
        if let Some(machine) = options.machines.first().filter(|_| options.at_tolerance) {
            for contour in tolerance::contours(options) {
                all.extend(options.controllers.iter().map(|entry| Self {
                    machine,
                    competitor: Competitor::own(entry),
                    raised_on: Some(contour),
                }));
            }
        }
        all
    }

    /// The machine and the controller whose values it needs.
    fn tuned_on(&self, options: &'a ComparisonOptions) -> (&'a Machine, &'static Entry) {
        let machine = match self.competitor.knowledge {
            Knowledge::Unseen => &options.nominal,
            _ => self.machine,
        };
        (machine, self.competitor.entry)
    }

    fn steps(&self, options: &ComparisonOptions) -> u64 {
        self.raised_on
            .map_or(options.workpieces.len() as u64, |_| 1)
    }

    /// Cuts every workpiece, or raises the feed until the tolerance just holds.
    fn work(
        &self,
        options: &ComparisonOptions,
        tuned: Option<&Tuned>,
        (kept, plans): (&Kept, &Plans),
        watch: &dyn Watch,
    ) -> Result<UnitResults, RunError> {
        let Self {
            machine,
            competitor,
            raised_on,
        } = self;
        let mut results = UnitResults::default();
        // Made once and where it is needed: what it has identified serves all workpieces and seeds.
        let mut made = None;
        let mut controller = || competitor.make(machine, &options.nominal, options.seed, tuned);
        if let Some(contour) = raised_on {
            let key = key([
                "at tolerance",
                contour.name,
                &machine.name,
                competitor.entry.name,
            ]);
            let row = kept.once(&key, || {
                tolerance::raised(
                    contour,
                    machine,
                    competitor,
                    &mut *controller(),
                    options,
                    watch,
                )
            })?;
            watch.advance(1);
            results.at_tolerance.push(row);
            return Ok(results);
        }
        let seeds = cut::seeds(machine, options);
        for workpiece in &options.workpieces {
            let key = key(["row", &workpiece.name, &machine.name, &competitor.name()]);
            let row = kept.once(&key, || {
                let controller = &mut **made.get_or_insert_with(&mut controller);
                let plan = plans.of(workpiece, machine);
                cut::row(
                    workpiece, machine, competitor, controller, &seeds, &plan, watch,
                )
            })?;
            watch.advance(1);
            results.rows.push(row);
        }
        Ok(results)
    }
}

fn key(parts: [&str; 4]) -> String {
    serde_json::json!(parts).to_string()
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
        units.iter().map(|unit| unit.steps(options)).sum(),
    );
    let plans = Plans::default();
    let work = |unit: &WorkUnit<'_>| {
        let (on, entry) = unit.tuned_on(options);
        let is_it = |tuned: &&Tuned| tuned.machine == on.name && tuned.controller == entry.name;
        unit.work(options, tuned.iter().find(is_it), (kept, &plans), watch)
    };
    let parts: Result<Vec<UnitResults>, RunError> = units.par_iter().map(work).collect();
    let mut all = UnitResults::default();
    for part in parts? {
        all.rows.extend(part.rows);
        all.at_tolerance.extend(part.at_tolerance);
    }
    Ok(UnitResults { tuned, ..all })
}

/// Machines and controllers whose values are needed, each once, in the order of machines and
/// controllers.
fn tuned_on(options: &ComparisonOptions) -> Vec<(&Machine, &'static Entry)> {
    let units = WorkUnit::all(options);
    let needed: Vec<_> = units.iter().map(|unit| unit.tuned_on(options)).collect();
    let nominal = &options.nominal;
    let others = options
        .machines
        .iter()
        .filter(|machine| machine.name != nominal.name);
    let mut all = Vec::new();
    for machine in std::iter::once(nominal).chain(others) {
        for &entry in options
            .controllers
            .iter()
            .filter(|entry| options.has_values(entry))
        {
            let mut needed = needed.iter();
            if needed.any(|(on, of)| on.name == machine.name && of.name == entry.name) {
                all.push((machine, entry));
            }
        }
    }
    all
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
    let pairs = tuned_on(options);
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
        let mut plans = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        plans.entry(key).or_default().clone()
    }
}
