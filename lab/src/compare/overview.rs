//! Parts of tables over many rows: names in their order, a row by its names, an error over all
//! contours, a claim over all of its verdicts.

use feedwright_ident::quadratic_mean;
use serde::{Deserialize, Serialize};

use super::Comparison;
use super::table::{ComparisonRow, each_once};
use super::tolerance::AtTolerance;
use super::verdict::Verdict;

/// One claim, and its results everywhere.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Claimed {
    /// Text of the claim.
    pub claim: String,
    /// Largest value at which the claim holds.
    pub limit: f64,
    /// Its unit; empty for a ratio.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// Number of contours and machines on which it holds.
    pub held: usize,
    /// Number of contours and machines.
    pub of: usize,
    /// The largest value.
    pub worst: f64,
    /// Contour, machine and value where it falls short.
    pub short: Vec<(String, String, f64)>,
}

impl Claimed {
    /// The claims, in the order of the verdicts.
    pub(super) fn all(verdicts: &[Verdict]) -> Vec<Self> {
        let of_claim = |claim: &str| {
            let its: Vec<&Verdict> = verdicts
                .iter()
                .filter(|verdict| verdict.claim == claim)
                .collect();
            let place = |verdict: &&Verdict| {
                (
                    verdict.contour.clone(),
                    verdict.machine.clone(),
                    verdict.value,
                )
            };
            let short: Vec<_> = its
                .iter()
                .copied()
                .filter(|verdict| !verdict.holds)
                .map(|verdict| place(&verdict))
                .collect();
            Self {
                claim: claim.to_owned(),
                limit: its[0].limit,
                unit: its[0].unit.clone(),
                held: its.len() - short.len(),
                of: its.len(),
                worst: its
                    .iter()
                    .map(|verdict| verdict.value)
                    .fold(f64::NEG_INFINITY, f64::max),
                short,
            }
        };
        each_once(verdicts.iter().map(|verdict| &verdict.claim))
            .into_iter()
            .map(of_claim)
            .collect()
    }
}

impl Comparison {
    /// Contours and parts, in the order of the rows.
    pub fn contours(&self) -> Vec<&str> {
        each_once(self.rows.iter().map(|row| &row.contour))
    }

    /// Machines, in the order of the rows.
    pub fn machines(&self) -> Vec<&str> {
        each_once(self.rows.iter().map(|row| &row.machine))
    }

    /// The row of a cut; none where it was not asked for.
    pub fn row(&self, contour: &str, machine: &str, controller: &str) -> Option<&ComparisonRow> {
        self.rows.iter().find(|row| {
            row.contour == contour && row.machine == machine && row.controller == controller
        })
    }

    /// A number of the rows of a controller on a machine, contour by contour; none where a cut is
    /// missing or was not completed.
    pub fn on_contours(
        &self,
        machine: &str,
        controller: &str,
        number: fn(&ComparisonRow) -> f64,
    ) -> Option<Vec<f64>> {
        let row = |contour: &str| {
            self.row(contour, machine, controller)
                .filter(|row| row.completed)
        };
        self.contours()
            .into_iter()
            .map(|contour| row(contour).map(number))
            .collect()
    }

    /// RMS contour error over all contours (quadratic mean), um; none where a cut is missing or was
    /// not completed.
    pub fn rms_over_contours_um(&self, machine: &str, controller: &str) -> Option<f64> {
        self.on_contours(machine, controller, |row| row.rms_um)
            .map(quadratic_mean)
    }

    /// Returns the RMS contour error over all contours as [`Self::rms_over_contours_um`] does,
    /// without the geometry that no encoder sees where the machine has any.
    pub fn controlled_rms_over_contours_um(&self, machine: &str, controller: &str) -> Option<f64> {
        self.on_contours(machine, controller, ComparisonRow::controlled_rms_um)
            .map(quadratic_mean)
    }

    /// The feedrate at which a controller just holds the tolerance, mm/s, and its time there
    /// against uncorrected; none where it never does.
    pub fn just_holding(&self, contour: &str, controller: &str) -> Option<(f64, f64)> {
        let is_it = |row: &&AtTolerance| row.contour == contour && row.controller == controller;
        self.at_tolerance
            .iter()
            .find(is_it)
            .and_then(|row| row.feed_mm_s.zip(row.time_ratio))
    }
}
