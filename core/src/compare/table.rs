//! The table: one row for each workpiece, machine and controller, with ratios against open loop.

use serde::{Deserialize, Serialize};

use super::{ComparisonOptions, Competitor, Workpiece};
use crate::controllers::{BASELINE, Knows};
use crate::machine::Machine;
use crate::report::Statistics;
use crate::simulate::RunResult;
use crate::trace::Outcome;

/// One row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ComparisonRow {
    /// Contour or part.
    pub contour: String,
    /// Machine that was cut on.
    pub machine: String,
    /// Controller.
    pub controller: String,
    /// Machining time, s.
    pub time_s: f64,
    /// RMS contour error, um.
    pub rms_um: f64,
    /// Largest contour error, um.
    pub max_um: f64,
    /// Uncut path: largest distance from a programmed point to what the tool did in the time that it has for it, um.
    #[serde(default)]
    pub uncut_um: f64,
    /// Largest distance of the command from the point of the path of the same instant, um.
    pub max_deviation_um: f64,
    /// Largest torque of any axis, N m.
    pub peak_torque_nm: f64,
    /// Machining time against open loop on the same machine.
    pub time_ratio: f64,
    /// RMS against open loop.
    pub rms_ratio: f64,
    /// Largest error against open loop.
    pub max_ratio: f64,
    /// Whether it was cut to its end.
    pub completed: bool,
    /// Why the safety layer took the controller out of the loop, where it did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub faded_out: Option<String>,
    /// Contour error along the cut, um, for plots.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub error_um: Vec<f32>,
}

impl ComparisonRow {
    pub(super) fn new(
        workpiece: &Workpiece,
        machine: &Machine,
        competitor: &Competitor,
        statistics: &Statistics,
        run: &RunResult,
        error_um: Vec<f32>,
    ) -> Self {
        Self {
            contour: workpiece.name.clone(),
            machine: machine.name.clone(),
            controller: competitor.name(),
            time_s: run.time_s,
            rms_um: statistics.rms_um(),
            max_um: statistics.max_um(),
            uncut_um: run.uncut_mm * 1e3,
            max_deviation_um: statistics.max_deviation_um(),
            peak_torque_nm: statistics.peak_torque_nm().into_iter().fold(0.0, f64::max),
            time_ratio: 1.0,
            rms_ratio: 1.0,
            max_ratio: 1.0,
            completed: run.outcome == Outcome::Completed,
            faded_out: run.faded_out.map(|faded| faded.cause.to_owned()),
            error_um,
        }
    }
}

/// All rows by workpiece, then machine, in the order of the cuts otherwise; ratios filled in.
pub(super) fn in_order(cuts: &[ComparisonRow], options: &ComparisonOptions) -> Vec<ComparisonRow> {
    let mut rows = Vec::with_capacity(cuts.len());
    for workpiece in &options.workpieces {
        for machine in &options.machines {
            let here = cuts.iter().filter(|row| row.contour == workpiece.name && row.machine == machine.name);
            let base = here.clone().find(|row| row.controller == BASELINE);
            rows.extend(here.map(|row| against(row.clone(), base)));
        }
    }
    rows
}

fn against(mut row: ComparisonRow, base: Option<&ComparisonRow>) -> ComparisonRow {
    if let Some(base) = base {
        row.time_ratio = row.time_s / base.time_s;
        row.rms_ratio = row.rms_um / base.rms_um;
        row.max_ratio = row.max_um / base.max_um;
    }
    row
}

/// What the controller of a row knows; nothing where its name is none.
pub fn knows(row: &ComparisonRow) -> Option<Knows> {
    let name = row.controller.strip_suffix(super::IDENTIFIED_HERE).unwrap_or(&row.controller);
    crate::controllers::Entry::find(name).map(|entry| entry.knows)
}
