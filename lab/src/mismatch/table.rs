//! Results of cuts by wrong models: a row for each machine of a model and each controller, and our
//! controller beside the best of the others.

use serde::Serialize;

use crate::never_worse::cut::SweepRow;
use crate::never_worse::summary::{Quantiles, SweepSummary};
use crate::never_worse::verdict::Failure;

use super::same_name;

/// Cuts of a controller that was made for one machine, on the variants of that machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MismatchGroup {
    /// Machine of the model.
    pub model: String,
    /// Controller.
    pub controller: String,
    /// RMS contour error over the uncorrected one.
    pub rms_ratio: Quantiles,
    /// Cuts that are worse than uncorrected in an error.
    pub worse: usize,
    /// Cuts that ended without the controller in the loop, or not at all.
    pub lost: usize,
    /// RMS contour error from the third second of motion on, over the error of the same controller
    /// on the variant that changes nothing.
    pub later_ratio: Option<Quantiles>,
}

/// Our controller beside the best of the others, by the models of one machine.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MismatchVerdict {
    /// Machine of the model.
    pub model: String,
    /// Our controller.
    pub ours: String,
    /// Its median of RMS over uncorrected.
    pub median: f64,
    /// The controller with the least median of the others; none where there is no other.
    pub peer: Option<String>,
    /// Its median.
    pub peer_median: Option<f64>,
    /// Our median over it.
    pub ratio: Option<f64>,
}

/// All of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MismatchSummary {
    /// Cuts of our controller.
    #[serde(flatten)]
    pub ours: SweepSummary,
    /// Groups by machine and controller.
    pub groups: Vec<MismatchGroup>,
    /// Verdicts by machine.
    pub verdicts: Vec<MismatchVerdict>,
    /// Cuts of the other controllers.
    pub peer_rows: Vec<SweepRow>,
}

impl MismatchSummary {
    /// Summarizes these rows; `ours` is one of their controllers.
    pub fn of(rows: Vec<SweepRow>, ours: &str) -> Self {
        let groups = groups(&rows);
        let verdicts = groups
            .iter()
            .filter(|group| group.controller == ours)
            .map(|group| group.beside(&groups))
            .collect();
        let (own, peer_rows) = rows.into_iter().partition(|row| row.controller == ours);
        Self {
            ours: SweepSummary::of(own),
            groups,
            verdicts,
            peer_rows,
        }
    }
}

/// Returns the groups in the order of the rows, without groups of which nothing can be judged.
fn groups(rows: &[SweepRow]) -> Vec<MismatchGroup> {
    let mut names: Vec<(&str, &str)> = Vec::new();
    for row in rows {
        let name = (model(row), row.controller.as_str());
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let group = |name| MismatchGroup::of(name, rows);
    names.into_iter().filter_map(group).collect()
}

/// Machine of the model.
fn model(row: &SweepRow) -> &str {
    row.model.as_deref().unwrap_or(&row.machine)
}

impl MismatchGroup {
    fn of((of_model, controller): (&str, &str), rows: &[SweepRow]) -> Option<Self> {
        let is_of = |row: &&SweepRow| {
            row.is_judged() && model(row) == of_model && row.controller == controller
        };
        let cuts: Vec<&SweepRow> = rows.iter().filter(is_of).collect();
        let same = same_name(of_model);
        let later_ratio = |row: &SweepRow| {
            let is_same = |it: &&&SweepRow| it.machine == same && it.program == row.program;
            let of_same = cuts.iter().find(is_same)?;
            Some(row.corrected.later_rms_um? / of_same.corrected.later_rms_um?)
        };
        let others = cuts.iter().filter(|row| row.machine != same);
        let later = others.filter_map(|row| later_ratio(row)).collect();
        let faults: Vec<Vec<Failure>> = cuts.iter().map(|row| row.faults()).collect();
        let having = |is_it: fn(&Failure) -> bool| {
            faults
                .iter()
                .filter(|faults| faults.iter().any(is_it))
                .count()
        };
        Some(Self {
            model: of_model.to_owned(),
            controller: controller.to_owned(),
            rms_ratio: Quantiles::of(cuts.iter().map(|row| row.rms_ratio()).collect())?,
            worse: having(|fault| *fault != Failure::Lost),
            lost: having(|fault| *fault == Failure::Lost),
            later_ratio: Quantiles::of(later),
        })
    }

    /// Compares the group with the best of the others by the same models.
    fn beside(&self, all: &[Self]) -> MismatchVerdict {
        let is_other = |it: &&Self| it.model == self.model && it.controller != self.controller;
        let others = all.iter().filter(is_other);
        let best = others.min_by(|a, b| a.rms_ratio.median.total_cmp(&b.rms_ratio.median));
        let median = self.rms_ratio.median;
        let peer_median = best.map(|best| best.rms_ratio.median);
        MismatchVerdict {
            model: self.model.clone(),
            ours: self.controller.clone(),
            median,
            peer: best.map(|best| best.controller.clone()),
            peer_median,
            ratio: peer_median.map(|peer| median / peer),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::never_worse::cut::Figures;

    /// Uncorrected 10 um; RMS of the corrected cut, and of what is left of it later on.
    fn row(model: &str, variant: &str, controller: &str, [rms_um, later_um]: [f64; 2]) -> SweepRow {
        let figures = |rms_um, later_rms_um| Figures {
            rms_um,
            max_um: rms_um,
            later_rms_um,
            ..Figures::default()
        };
        SweepRow {
            program: "p".to_owned(),
            machine: format!("{model}-{variant}"),
            model: Some(model.to_owned()),
            controller: controller.to_owned(),
            rigid: true,
            uncorrected: figures(10.0, None),
            corrected: figures(rms_um, (later_um > 0.0).then_some(later_um)),
        }
    }

    #[test]
    fn each_machine_and_controller_has_its_row_and_its_cut_without_a_difference() {
        let mut rows = vec![
            row("a", "same", "ours", [1.0, 0.5]),
            row("a", "same", "peer", [2.0, 2.0]),
            row("a", "kp", "ours", [3.0, 1.5]),
            row("a", "kp", "peer", [4.0, 8.0]),
            row("a", "ti", "ours", [11.0, 0.0]),
            row("a", "ti", "peer", [9.0, 3.0]),
            row("a-b", "same", "ours", [5.0, 1.0]),
        ];
        rows[2].corrected.lost = Some("faded".to_owned());
        let MismatchSummary {
            ours,
            groups,
            verdicts,
            peer_rows,
        } = MismatchSummary::of(rows, "ours");
        let names: Vec<_> = groups
            .iter()
            .map(|group| (group.model.as_str(), group.controller.as_str()))
            .collect();
        assert_eq!(names, [("a", "ours"), ("a", "peer"), ("a-b", "ours")]);
        let [own, peer, other] = &groups[..] else {
            unreachable!("three names")
        };
        let ratios = |group: &MismatchGroup| {
            (
                group.rms_ratio.cuts,
                group.rms_ratio.median,
                group.rms_ratio.largest,
            )
        };
        assert_eq!((ratios(own), ratios(peer)), ((3, 0.3, 1.1), (3, 0.4, 0.9)));
        assert_eq!(
            ([own.worse, own.lost], [peer.worse, peer.lost]),
            ([1, 1], [0, 0])
        );
        let later =
            |group: &MismatchGroup| group.later_ratio.map(|ratio| (ratio.cuts, ratio.median));
        // Of ours the cut on "ti" was too short; the peer has 8 / 2 and 3 / 2, and the upper one is
        // the median of two.
        assert_eq!(
            (later(own), later(peer), later(other)),
            (Some((1, 3.0)), Some((2, 4.0)), None)
        );
        assert_eq!((ours.judged, ours.worse, peer_rows.len()), (4, 2, 3));
        let beside =
            |verdict: &MismatchVerdict| (verdict.median, verdict.peer.clone(), verdict.peer_median);
        assert_eq!(
            beside(&verdicts[0]),
            (0.3, Some("peer".to_owned()), Some(0.4))
        );
        assert!((verdicts[0].ratio.unwrap_or_default() - 0.75).abs() < 1e-12);
        assert_eq!(beside(&verdicts[1]), (0.5, None, None));
    }
}
