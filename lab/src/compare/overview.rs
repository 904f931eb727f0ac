//! Overviews of many rows: names in their order, a row by its names, a claim over all of its
//! verdicts.

use serde::{Deserialize, Serialize};

use super::Comparison;
use super::table::{ComparisonRow, each_once};
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
            let is_it = |verdict: &&Verdict| verdict.claim == claim;
            let its: Vec<&Verdict> = verdicts.iter().filter(is_it).collect();
            let place = |it: &&Verdict| (it.contour.clone(), it.machine.clone(), it.value);
            let short: Vec<_> = its
                .iter()
                .filter(|verdict| !verdict.holds)
                .map(place)
                .collect();
            let values = its.iter().map(|verdict| verdict.value);
            Self {
                claim: claim.to_owned(),
                limit: its[0].limit,
                unit: its[0].unit.clone(),
                held: its.len() - short.len(),
                of: its.len(),
                worst: values.fold(f64::NEG_INFINITY, f64::max),
                short,
            }
        };
        let claims = each_once(verdicts.iter().map(|verdict| &verdict.claim));
        claims.into_iter().map(of_claim).collect()
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
}
