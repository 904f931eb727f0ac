//! The table: one row for each workpiece, machine and controller, with ratios against uncorrected.

use feedwright::BASELINE;
use feedwright_ident::median_and_spread;
use feedwright_sim::Machine;
use serde::{Deserialize, Serialize};

use super::competitor::Competitor;
use super::options::ComparisonOptions;
use super::work::Workpiece;

/// The numbers of one cut.
#[derive(Debug, Clone, Default)]
pub(super) struct CutNumbers {
    pub(super) time_s: f64,
    pub(super) rms_um: f64,
    pub(super) max_um: f64,
    /// RMS and largest contour error of the joints, um; none where the machine has no geometry that
    /// no encoder sees.
    pub(super) joint_um: Option<[f64; 2]>,
    pub(super) uncut_um: f64,
    pub(super) max_deviation_um: f64,
    pub(super) accel_mm_s2: f64,
    pub(super) peak_torque_nm: f64,
    pub(super) completed: bool,
    pub(super) faded_out: Option<&'static str>,
}

/// One row. Errors and times are medians over the noise seeds.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ComparisonRow {
    /// Contour or part.
    pub contour: String,
    /// Machine that was cut on.
    pub machine: String,
    /// Controller, and what it was given of the machine.
    pub controller: String,
    /// Machining time, s.
    pub time_s: f64,
    /// RMS contour error, um.
    pub rms_um: f64,
    /// The lowest and the highest of all noise seeds, um.
    pub rms_spread_um: [f64; 2],
    /// Largest contour error, um.
    pub max_um: f64,
    /// The lowest and the highest of all noise seeds, um.
    pub max_spread_um: [f64; 2],
    /// RMS contour error without the geometry that no encoder sees, um; none where the machine has
    /// no such geometry.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint_rms_um: Option<f64>,
    /// The largest, um.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joint_max_um: Option<f64>,
    /// Uncut path: largest distance from a programmed point to what the tool did in the time that
    /// it has for it, um. Of all seeds.
    pub uncut_um: f64,
    /// Largest distance of the command from the point of the path of the same instant, um. Of all
    /// seeds.
    pub max_deviation_um: f64,
    /// Largest acceleration of the command of any axis, mm/s2. Of all seeds.
    pub accel_mm_s2: f64,
    /// Largest torque of any axis, N m. Of all seeds.
    pub peak_torque_nm: f64,
    /// Machining time against uncorrected on the same machine.
    pub time_ratio: f64,
    /// RMS against uncorrected.
    pub rms_ratio: f64,
    /// Largest error against uncorrected.
    pub max_ratio: f64,
    /// Noise seeds that it was cut with.
    pub seeds: u32,
    /// Number of these seeds with which the cut did not come to its end, or the supervisor took the
    /// controller out of the loop.
    pub lost: u32,
    /// True if the cut came to its end with all of them.
    pub completed: bool,
    /// Cause for which the supervisor took the controller out of the loop, with the first seed for
    /// which it did.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub faded_out: Option<String>,
}

impl ComparisonRow {
    /// Creates the row from the measurements with each noise seed; ratios are still open.
    pub(super) fn new(
        workpiece: &Workpiece,
        machine: &Machine,
        competitor: &Competitor,
        measured: &[CutNumbers],
    ) -> Self {
        let numbers = |number: fn(&CutNumbers) -> f64| measured.iter().map(number);
        let spread = |number| median_and_spread(numbers(number));
        let worst = |number| numbers(number).fold(0.0, f64::max);
        let joint = |k: usize| {
            let um = measured.iter().map(|cut| Some(cut.joint_um?[k]));
            Some(median_and_spread(um.collect::<Option<Vec<f64>>>()?).0)
        };
        let is_lost = |cut: &&CutNumbers| !cut.completed || cut.faded_out.is_some();
        let faded_out = measured.iter().find_map(|cut| cut.faded_out);
        let ((rms_um, rms_spread_um), (max_um, max_spread_um)) =
            (spread(|cut| cut.rms_um), spread(|cut| cut.max_um));
        Self {
            contour: workpiece.name.clone(),
            machine: machine.name.clone(),
            controller: competitor.name(),
            time_s: spread(|cut| cut.time_s).0,
            rms_um,
            rms_spread_um,
            max_um,
            max_spread_um,
            joint_rms_um: joint(0),
            joint_max_um: joint(1),
            uncut_um: worst(|cut| cut.uncut_um),
            max_deviation_um: worst(|cut| cut.max_deviation_um),
            accel_mm_s2: worst(|cut| cut.accel_mm_s2),
            peak_torque_nm: worst(|cut| cut.peak_torque_nm),
            time_ratio: 1.0,
            rms_ratio: 1.0,
            max_ratio: 1.0,
            seeds: measured.len() as u32,
            lost: measured.iter().filter(is_lost).count() as u32,
            completed: measured.iter().all(|cut| cut.completed),
            faded_out: faded_out.map(str::to_owned),
        }
    }

    /// RMS contour error that a control with encoders alone can influence, um.
    pub fn controlled_rms_um(&self) -> f64 {
        self.joint_rms_um.unwrap_or(self.rms_um)
    }

    /// The largest of the same, um.
    pub fn controlled_max_um(&self) -> f64 {
        self.joint_max_um.unwrap_or(self.max_um)
    }

    /// Returns a note on a cut that diverged or left the loop, in words.
    pub fn note(&self) -> Option<String> {
        let of = match self.seeds {
            2.. => format!(" with {} of {} seeds", self.lost, self.seeds),
            _ => String::new(),
        };
        match (self.completed, &self.faded_out) {
            (false, _) => Some(format!("diverged{of}")),
            (true, Some(cause)) => Some(format!("left the loop{of}: {cause}")),
            (true, None) => None,
        }
    }
}

/// All rows by workpiece, then machine, in the order of the cuts otherwise; ratios filled in.
pub(super) fn in_order(cuts: &[ComparisonRow], options: &ComparisonOptions) -> Vec<ComparisonRow> {
    let mut rows = Vec::with_capacity(cuts.len());
    for workpiece in &options.workpieces {
        for machine in &options.machines {
            let is_here =
                |row: &&ComparisonRow| row.contour == workpiece.name && row.machine == machine.name;
            let here = cuts.iter().filter(is_here);
            let base = here.clone().find(|row| row.controller == BASELINE);
            rows.extend(here.map(|row| against(row.clone(), base)));
        }
    }
    rows
}

pub(super) fn against(mut row: ComparisonRow, base: Option<&ComparisonRow>) -> ComparisonRow {
    if let Some(base) = base {
        row.time_ratio = row.time_s / base.time_s;
        row.rms_ratio = row.rms_um / base.rms_um;
        row.max_ratio = row.max_um / base.max_um;
    }
    row
}

/// Names of a column, each once, in the order of the rows.
pub fn each_once<'a>(names: impl Iterator<Item = &'a String>) -> Vec<&'a str> {
    let mut once: Vec<&str> = Vec::new();
    for name in names {
        if !once.contains(&name.as_str()) {
            once.push(name);
        }
    }
    once
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::CONTROLLERS;

    #[test]
    fn a_row_has_medians_of_errors_the_worst_of_all_else_and_counts_what_was_lost() {
        let cut = |rms_um: f64, uncut_um: f64| CutNumbers {
            rms_um,
            uncut_um,
            completed: true,
            ..CutNumbers::default()
        };
        let mut measured = vec![cut(3.0, 7.0), cut(1.0, 9.0), cut(2.0, 8.0)];
        let workpiece = &Workpiece::contours()[0];
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let competitor = Competitor::own(CONTROLLERS.find(BASELINE).unwrap());
        let row = |cuts: &[CutNumbers]| ComparisonRow::new(workpiece, &machine, &competitor, cuts);
        let sound = row(&measured);
        let um = (sound.rms_um, sound.rms_spread_um, sound.uncut_um);
        assert_eq!(um, (2.0, [1.0, 3.0], 9.0));
        assert_eq!((sound.seeds, sound.lost, sound.completed), (3, 0, true));
        assert_eq!(sound.note(), None);
        assert_eq!((sound.joint_rms_um, sound.controlled_rms_um()), (None, 2.0));
        measured[1].completed = false;
        measured[2].faded_out = Some("why");
        let lost = row(&measured);
        assert_eq!((lost.lost, lost.completed), (2, false));
        assert_eq!(lost.note().unwrap(), "diverged with 2 of 3 seeds");
        for (k, cut) in measured.iter_mut().enumerate() {
            cut.joint_um = Some([k as f64, 10.0]);
        }
        assert_eq!(row(&measured).controlled_rms_um(), 1.0);
    }
}
