//! The machining time at which a controller just holds a tolerance: the feedrate is raised until it does not.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::cut::{Maker, cut_once};
use super::tuning::Tuned;
use super::{CORNER, Competitor, Options, Watch, Workpiece};
use crate::controllers::BASELINE;
use crate::feed::LimitsError;
use crate::path::contour::CONTOURS;
use crate::trace::Outcome;

/// What the largest contour error may be, um.
pub const TOLERANCE_UM: f64 = 10.0;
/// Slowest feedrate that is tried, mm/s.
const SLOWEST_MM_S: f64 = 1.0;
/// Halvings of the range of the feedrate's logarithm: to half a percent.
const HALVINGS: u32 = 10;

/// What a controller comes to on one contour.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AtTolerance {
    /// Contour.
    pub contour: String,
    /// Controller.
    pub controller: String,
    /// Fastest programmed feedrate at which the largest contour error holds the tolerance, mm/s; the machine's highest where
    /// it holds at that too, nothing where it does not hold at the slowest.
    pub feed_mm_s: Option<f64>,
    /// Machining time there, s.
    pub time_s: Option<f64>,
    /// Machining time against open loop.
    pub time_ratio: Option<f64>,
}

/// All smooth contours, all controllers, on the nominal machine.
pub(super) fn at_tolerance(
    options: &Options,
    tuned: &[Tuned],
    watch: &dyn Watch,
) -> Result<Vec<AtTolerance>, LimitsError> {
    let smooth: Vec<&str> = CONTOURS.iter().filter(|contour| contour.is_smooth()).map(|contour| contour.name).collect();
    let wanted = options.workpieces.iter().map(|w| w.name.as_str()).filter(|name| smooth.contains(name));
    let pairs: Vec<_> = wanted.flat_map(|name| options.controllers.iter().map(move |&entry| (name, entry))).collect();
    watch.holding(pairs.len() as u64);
    let found: Result<Vec<AtTolerance>, LimitsError> = pairs
        .par_iter()
        .map(|&(name, entry)| {
            let competitor = Competitor { entry, at_home: false };
            let row = one(name, &competitor, options, tuned)?;
            watch.done();
            Ok(row)
        })
        .collect();
    let mut found = found?;
    let open: Vec<_> = found.iter().filter(|row| row.controller == BASELINE).cloned().collect();
    for row in &mut found {
        let base = open.iter().find(|base| base.contour == row.contour).and_then(|base| base.time_s);
        row.time_ratio = row.time_s.zip(base).map(|(time_s, base)| time_s / base);
    }
    Ok(found)
}

fn one(name: &str, competitor: &Competitor, options: &Options, tuned: &[Tuned]) -> Result<AtTolerance, LimitsError> {
    let machine = options.nominal();
    let mut controller = Maker { competitor, nominal: machine, seed: options.seed, tuned }.make(machine);
    let contour = CONTOURS.iter().find(|contour| contour.name == name).expect("only contours are asked for");
    let mut holds = |feed_mm_s: f64| -> Result<Option<f64>, LimitsError> {
        let steps = contour.steps(feed_mm_s, CORNER).expect("the feedrate is one");
        let workpiece = Workpiece { name: name.to_owned(), smooth: true, steps };
        let cut = cut_once(&workpiece, machine, &mut *controller, competitor.entry.laps, &mut [])?;
        let held = cut.run.outcome == Outcome::Completed && cut.statistics.max_um() <= TOLERANCE_UM;
        Ok(held.then_some(cut.run.time_s))
    };
    let fastest = machine.limits.max_feed_mm_s;
    let (mut low, mut high) = (SLOWEST_MM_S.ln(), fastest.ln());
    let mut best = match holds(fastest)? {
        Some(time_s) => return Ok(row(name, competitor, Some((fastest, time_s)))),
        None => holds(SLOWEST_MM_S)?.map(|time_s| (SLOWEST_MM_S, time_s)),
    };
    if best.is_some() {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match holds(middle.exp())? {
                Some(time_s) => (low, best) = (middle, Some((middle.exp(), time_s))),
                None => high = middle,
            }
        }
    }
    Ok(row(name, competitor, best))
}

fn row(contour: &str, competitor: &Competitor, best: Option<(f64, f64)>) -> AtTolerance {
    AtTolerance {
        contour: contour.to_owned(),
        controller: competitor.name(),
        feed_mm_s: best.map(|(feed_mm_s, _)| feed_mm_s),
        time_s: best.map(|(_, time_s)| time_s),
        time_ratio: None,
    }
}
