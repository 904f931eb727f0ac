//! The machining time at which a controller just holds a tolerance: the feedrate is raised until it
//! exceeds the tolerance.

use feedwright::BASELINE;
use feedwright_control::Controller;
use feedwright_sim::{Machine, Outcome, Run, RunError, Watch};
use serde::{Deserialize, Serialize};

use super::competitor::Competitor;
use super::cut::{cut, seeds};
use super::options::ComparisonOptions;
use super::work::Workpiece;
use crate::contour::{CONTOURS, CORNER, Contour};

/// Largest contour error that is allowed, um.
pub const TOLERANCE_UM: f64 = 10.0;
/// Slowest feedrate that is tried, mm/s.
const SLOWEST_MM_S: f64 = 1.0;
/// Halvings of the range of the feedrate's logarithm: to half a percent.
const HALVINGS: u32 = 10;

/// Result of a controller on one contour.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AtTolerance {
    /// Contour.
    pub contour: String,
    /// Controller.
    pub controller: String,
    /// Fastest programmed feedrate at which the largest contour error holds the tolerance, mm/s;
    /// the machine's highest where it holds at that too, nothing where it does not hold at the
    /// slowest.
    pub feed_mm_s: Option<f64>,
    /// Machining time there, s.
    pub time_s: Option<f64>,
    /// Machining time against uncorrected.
    pub time_ratio: Option<f64>,
}

/// The smooth contours among the workpieces.
pub(super) fn contours(options: &ComparisonOptions) -> Vec<&'static Contour> {
    let named = |workpiece: &Workpiece| {
        let is_it = |it: &&Contour| it.name == workpiece.name && it.is_smooth();
        CONTOURS.iter().find(is_it)
    };
    options.workpieces.iter().filter_map(named).collect()
}

/// Raises the feedrate of a controller on a contour and returns the result; the ratio is still
/// open.
pub(super) fn raised(
    contour: &Contour,
    machine: &Machine,
    competitor: &Competitor,
    controller: &mut dyn Controller<2>,
    options: &ComparisonOptions,
    watch: &dyn Watch,
) -> Result<AtTolerance, RunError> {
    // One noise seed is enough for a feedrate.
    let machine = machine.with_noise_seed(seeds(machine, options)[0]);
    let run = Run::on(&machine).laps(competitor.entry.laps).watched(watch);
    let best = fastest(contour, run, controller, &machine)?;
    Ok(AtTolerance {
        contour: contour.name.to_owned(),
        controller: competitor.name(),
        feed_mm_s: best.map(|best| best.feed_mm_s),
        time_s: best.map(|best| best.time_s),
        time_ratio: None,
    })
}

/// Ratios filled in.
pub(super) fn against_baseline(mut found: Vec<AtTolerance>) -> Vec<AtTolerance> {
    let open: Vec<_> = found
        .iter()
        .filter(|row| row.controller == BASELINE)
        .cloned()
        .collect();
    for row in &mut found {
        let base = open.iter().find(|base| base.contour == row.contour);
        let ratio = |time_s: f64| Some(time_s / base?.time_s?);
        row.time_ratio = row.time_s.and_then(ratio);
    }
    found
}

/// A feedrate at which the tolerance holds, and the machining time there.
#[derive(Clone, Copy)]
struct Holding {
    feed_mm_s: f64,
    time_s: f64,
}

/// The fastest that is found, by bisection: nothing where the tolerance does not hold at the
/// slowest.
fn fastest(
    contour: &Contour,
    run: Run<'_>,
    controller: &mut dyn Controller<2>,
    machine: &Machine,
) -> Result<Option<Holding>, RunError> {
    let mut holding = |feed_mm_s: f64| -> Result<Option<Holding>, RunError> {
        let steps = contour
            .steps(feed_mm_s, CORNER)
            .expect("the feedrate is one");
        let cut = cut(&Workpiece::of(contour.name, steps), controller, run)?;
        let is_complete = cut.run.outcome == Outcome::Completed;
        let holds = is_complete && cut.statistics.max_um() <= TOLERANCE_UM;
        let time_s = cut.run.time_s;
        Ok(holds.then_some(Holding { feed_mm_s, time_s }))
    };
    let highest = machine.limits.max_feed_mm_s;
    if let Some(at_highest) = holding(highest)? {
        return Ok(Some(at_highest));
    }
    let Some(mut best) = holding(SLOWEST_MM_S)? else {
        return Ok(None);
    };
    let (mut low, mut high) = (libm::log(SLOWEST_MM_S), libm::log(highest));
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match holding(libm::exp(middle))? {
            Some(faster) => (low, best) = (middle, faster),
            None => high = middle,
        }
    }
    Ok(Some(best))
}
