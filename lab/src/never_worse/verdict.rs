//! Verdict on a cut: worse than uncorrected or not, by the rule of [`feedwright::harm`].
use feedwright::ErrorChange;
use serde::{Deserialize, Serialize};

use super::cut::SweepRow;

/// A way of being worse.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Failure {
    /// RMS contour error.
    Rms,
    /// Largest contour error.
    Max,
    /// More of the path stays uncut.
    Uncut,
    /// The program was not cut to its end, or not with the controller in the loop.
    Lost,
}

impl Failure {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Rms, Self::Max, Self::Uncut, Self::Lost];

    /// Its name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Rms => "RMS",
            Self::Max => "max",
            Self::Uncut => "uncut",
            Self::Lost => "lost",
        }
    }
}

impl SweepRow {
    /// Returns true if the uncorrected cut came to its end, so that there is a cut to compare with.
    pub fn is_judged(&self) -> bool {
        self.uncorrected.lost.is_none()
    }

    /// Returns the ways in which the cut is worse; empty if it is not judged.
    pub fn faults(&self) -> Vec<Failure> {
        let [rms, max, uncut] = self.changes();
        let is_fault = |fault: &Failure| match fault {
            Failure::Lost => self.corrected.lost.is_some(),
            Failure::Rms => rms.is_worse(),
            Failure::Max => max.is_worse(),
            Failure::Uncut => uncut.is_worse(),
        };
        match self.is_judged() {
            true => Failure::ALL.into_iter().filter(is_fault).collect(),
            false => Vec::new(),
        }
    }

    /// RMS error, largest error and uncut path, compared with the uncorrected cut.
    fn changes(&self) -> [ErrorChange; 3] {
        self.corrected
            .errors()
            .compared_with(&self.uncorrected.errors())
    }

    /// Returns the severity: the largest of the excesses, at least 1 if the cut is lost.
    pub fn severity(&self) -> f64 {
        let lost = self.corrected.lost.as_ref().map_or(0.0, |_| 1.0);
        self.changes()
            .iter()
            .map(ErrorChange::excess)
            .fold(lost, f64::max)
    }

    /// RMS contour error over the uncorrected one.
    pub fn rms_ratio(&self) -> f64 {
        /// An uncorrected RMS error below this counts as this, um.
        const MIN_UM: f64 = 1e-3;
        self.corrected.rms_um / self.uncorrected.rms_um.max(MIN_UM)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::never_worse::cut::Figures;

    /// A row of these figures: RMS and largest error, um.
    pub(crate) fn row(open: [f64; 2], corrected: [f64; 2]) -> SweepRow {
        let figures = |[rms_um, max_um]: [f64; 2]| Figures {
            rms_um,
            max_um,
            time_s: 1.0,
            ..Figures::default()
        };
        SweepRow {
            program: "p".to_owned(),
            machine: "m".to_owned(),
            model: None,
            controller: "c".to_owned(),
            rigid: true,
            uncorrected: figures(open),
            corrected: figures(corrected),
        }
    }

    #[test]
    fn worse_is_what_is_above_the_allowance() {
        assert_eq!(row([10.0, 20.0], [10.04, 20.9]).faults(), []);
        assert_eq!(row([10.0, 20.0], [10.06, 20.9]).faults(), [Failure::Rms]);
        assert_eq!(row([10.0, 20.0], [1.0, 21.1]).faults(), [Failure::Max]);
        assert_eq!(row([10.0, 20.0], [f64::NAN, 2.0]).faults(), [Failure::Rms]);
    }

    #[test]
    fn uncut_path_counts_where_both_know_it() {
        let mut uncut = row([10.0, 20.0], [1.0, 2.0]);
        uncut.corrected.uncut_um = Some(400.0);
        assert_eq!(uncut.faults(), []);
        uncut.uncorrected.uncut_um = Some(20.0);
        assert_eq!(uncut.faults(), [Failure::Uncut]);
        assert!((uncut.severity() - 380.0).abs() < 1e-9);
    }

    #[test]
    fn lost_is_worse_however_small_the_error_and_is_not_judged_where_uncorrected_is_lost() {
        let mut lost = row([10.0, 20.0], [1.0, 2.0]);
        lost.corrected.lost = Some("faded".to_owned());
        assert_eq!(lost.faults(), [Failure::Lost]);
        assert!(lost.severity() >= 1.0);
        lost.uncorrected.lost = Some("diverged".to_owned());
        assert_eq!(lost.faults(), []);
    }
}
