//! In what a correction is worse than no correction, and what counts as worse.

use serde::Serialize;

use super::RunSummary;

/// The RMS may be larger by so much, um: below what any encoder resolves.
pub const RMS_UM: f64 = 0.05;
/// The largest error may be larger by so much, um.
pub const MAX_UM: f64 = 1.0;
/// The uncut path may be larger by so much, um.
pub const UNCUT_UM: f64 = 1.0;

/// A way in which a run is worse than another.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Harm {
    /// What is worse, as in tables.
    pub what: &'static str,
    /// Of the run that it is compared with, um.
    pub before_um: f64,
    /// Of the run, um.
    pub after_um: f64,
}

/// In what `after` is worse than `before`: RMS and largest contour error, and uncut path. A number that is none is worse.
pub(crate) fn harm(before: &RunSummary, after: &RunSummary) -> Vec<Harm> {
    let figures = [
        ("RMS", before.rms_um, after.rms_um, RMS_UM),
        ("max", before.max_um, after.max_um, MAX_UM),
        ("uncut", before.uncut_um, after.uncut_um, UNCUT_UM),
    ];
    let is_worse = |(what, before_um, after_um, allowed_um): (&'static str, f64, f64, f64)| {
        let is_fine = after_um - before_um <= allowed_um;
        (!is_fine).then_some(Harm { what, before_um, after_um })
    };
    figures.into_iter().filter_map(is_worse).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{RunFacts, Statistics};
    use super::*;

    #[test]
    fn worse_is_what_is_above_the_allowance_or_no_number() {
        let of = |rms_um: f64, max_um: f64, uncut_um: f64| RunSummary {
            rms_um,
            max_um,
            uncut_um,
            ..Statistics::new().summary(RunFacts::default(), |_| String::new())
        };
        let worse = |after: RunSummary| harm(&of(10.0, 20.0, 20.0), &after).iter().map(|h| h.what).collect::<Vec<_>>();
        assert_eq!(worse(of(10.04, 20.9, 20.9)), [""; 0]);
        assert_eq!(worse(of(10.06, 20.0, 20.0)), ["RMS"]);
        assert_eq!(worse(of(1.0, 21.1, 400.0)), ["max", "uncut"]);
        assert_eq!(worse(of(f64::NAN, 1.0, 1.0)), ["RMS"]);
    }
}
