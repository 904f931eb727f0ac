//! The one rule for "worse": a cut is worse than another if its RMS error, its largest error or its
//! uncut path exceeds the other's by more than the allowance.
//!
//! `run`, `correct`, `never-worse`, the comparison and the report all judge by this rule.

use serde::Serialize;

use super::RunSummary;

/// Allowed increase of the RMS contour error, um. It is below the resolution of common encoders.
pub const RMS_UM: f64 = 0.05;
/// Allowed increase of the largest contour error, um. That error belongs to one moment and varies
/// with noise.
pub const MAX_UM: f64 = 1.0;
/// Allowed increase of the uncut path, um, for the same reason.
pub const UNCUT_UM: f64 = 1.0;

/// The errors of a cut that decide whether it is worse than another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CutErrors {
    /// RMS contour error, um.
    pub rms_um: f64,
    /// Largest contour error, um.
    pub max_um: f64,
    /// Uncut path, um; none if unknown.
    pub uncut_um: Option<f64>,
}

impl CutErrors {
    /// The errors of a run.
    pub(crate) const fn of(run: &RunSummary) -> Self {
        Self {
            rms_um: run.rms_um,
            max_um: run.max_um,
            uncut_um: Some(run.uncut_um),
        }
    }

    /// Compares RMS error, largest error and uncut path, in this order, with those of `before`. An
    /// unknown uncut path counts as unchanged.
    pub fn compared_with(&self, before: &Self) -> [ErrorChange; 3] {
        let (before_uncut_um, after_uncut_um) =
            before.uncut_um.zip(self.uncut_um).unwrap_or_default();
        let change = |what, before_um, after_um, allowed_um| ErrorChange {
            harm: Harm {
                what,
                before_um,
                after_um,
            },
            allowed_um,
        };
        [
            change("RMS", before.rms_um, self.rms_um, RMS_UM),
            change("max", before.max_um, self.max_um, MAX_UM),
            change("uncut", before_uncut_um, after_uncut_um, UNCUT_UM),
        ]
    }
}

/// One error of two cuts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorChange {
    harm: Harm,
    allowed_um: f64,
}

impl ErrorChange {
    /// Returns true if the error is worse. An error that is not a number is worse.
    pub fn is_worse(&self) -> bool {
        let is_allowed = self.harm.after_um - self.harm.before_um <= self.allowed_um;
        !is_allowed
    }

    /// Returns the increase in units of the allowance: above 1 is worse. Infinite for an error that
    /// is not a number.
    pub fn excess(&self) -> f64 {
        let excess = (self.harm.after_um - self.harm.before_um) / self.allowed_um;
        if excess.is_nan() {
            f64::INFINITY
        } else {
            excess
        }
    }
}

/// An error that is worse than the one it is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Harm {
    /// Name of the error, as in tables.
    pub(crate) what: &'static str,
    /// The error it is compared with, um.
    pub(crate) before_um: f64,
    /// The error, um.
    pub(crate) after_um: f64,
}

/// Returns the errors of `after` that are worse than the errors of `before`.
pub fn harm(before: &CutErrors, after: &CutErrors) -> Vec<Harm> {
    let changes = after.compared_with(before).into_iter();
    changes
        .filter(ErrorChange::is_worse)
        .map(|change| change.harm)
        .collect()
}

/// Lists `harm` as in "RMS 1.20 um for 1.00, max 9.00 um for 7.00".
pub(crate) fn listed(harm: &[Harm]) -> String {
    let one = |harm: &Harm| {
        format!(
            "{} {:.2} um for {:.2}",
            harm.what, harm.after_um, harm.before_um
        )
    };
    harm.iter().map(one).collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_above_the_allowance_or_not_a_number_is_worse() {
        let of = |rms_um, max_um, uncut_um| CutErrors {
            rms_um,
            max_um,
            uncut_um: Some(uncut_um),
        };
        let worse = |after: CutErrors| {
            harm(&of(10.0, 20.0, 20.0), &after)
                .iter()
                .map(|h| h.what)
                .collect::<Vec<_>>()
        };
        assert_eq!(worse(of(10.04, 20.9, 20.9)), [""; 0]);
        assert_eq!(worse(of(10.06, 20.0, 20.0)), ["RMS"]);
        assert_eq!(worse(of(1.0, 21.1, 400.0)), ["max", "uncut"]);
        assert_eq!(worse(of(f64::NAN, 1.0, 1.0)), ["RMS"]);
        let unknown = CutErrors {
            uncut_um: None,
            ..of(10.0, 20.0, 0.0)
        };
        assert_eq!(harm(&unknown, &of(1.0, 1.0, 400.0)), []);
    }

    #[test]
    fn the_excess_is_in_allowances() {
        let of = |rms_um| CutErrors {
            rms_um,
            max_um: 1.0,
            uncut_um: None,
        };
        let excess = |rms_um| of(rms_um).compared_with(&of(1.0))[0].excess();
        assert!((excess(1.1) - 2.0).abs() < 1e-9, "{}", excess(1.1));
        assert_eq!(excess(f64::NAN), f64::INFINITY);
    }
}
