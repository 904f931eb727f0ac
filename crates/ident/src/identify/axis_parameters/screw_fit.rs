//! Compliance of the ball screw: table, resonance, damping and backlash, where a free run with them
//! has clearly smaller residuals.
//!
//! The resonance has many local minima. A search begins at each of [`STARTS_HZ`], on every
//! [`SUBSET`]th stretch of the recording. It is given up if it is no better than a rigid screw
//! after [`TRIED`]. The best search continues over the whole recording. Its result is used if it
//! leaves significantly less than a rigid screw from stretch to stretch, and if its resonance and
//! its share of the inertia are certain. Positions are measured at the motor: the table shows in
//! how the motor oscillates, and backlash in how it reverses.

use std::f64::consts::TAU;

use feedwright_control::Parameters;

use super::output_error_fit::{FitState, OutputErrorFit};
use super::{AxisEstimate, IDENTIFIED};

/// Resonances at which a search begins, Hz.
const STARTS_HZ: [f64; 4] = [30.0, 60.0, 110.0, 200.0];
/// The rest of a screw at which it begins: half the inertia, a damping ratio of 0.05, and little
/// backlash, mm.
const START_SHARE: f64 = 0.5;
const START_DAMPING: f64 = 0.05;
const START_BACKLASH_MM: f64 = 0.002;
/// Parts of the presliding of a rigid screw that are tried as backlash, the second where the first
/// leads nowhere. Where there is backlash, this presliding is mostly backlash.
const BACKLASH_SHARES: [f64; 2] = [0.0, 0.6];
/// Presliding that may be backlash, mm.
const LEAST_PRESLIDING_MM: f64 = 0.005;
/// A start above this many turns in a servo period is left out: nothing of it would be seen.
const MOST_TURNS: f64 = 0.25;
/// The starts are tried on every `SUBSET`th stretch.
const SUBSET: usize = 8;
/// Trials of a start: number of steps, and the most that it may leave after them, in squares of a
/// rigid screw. Then the further steps of a start, and the steps over the whole recording.
const TRIED: [(u32, f64); 2] = [(2, 1.5), (2, 1.0)];
const MORE_STEPS: u32 = 15;
const LAST_STEPS: u32 = 6;
/// Largest part of the squares of a rigid screw that may be left, and standard errors by which less
/// is left from stretch to stretch.
const LESS: f64 = 0.97;
const SIGNIFICANT: f64 = 4.0;
/// Standard errors of resonance and share at the most, parts of them.
const CERTAIN: [f64; 2] = [0.1, 0.3];

/// The axis with its screw, from one with a rigid screw; none where that does as well.
pub(super) fn with_screw(fit: &OutputErrorFit, rigid: &AxisEstimate) -> Option<AxisEstimate> {
    let servo_s = fit.known.periods.servo_s;
    let part = fit.every(SUBSET);
    let rigid_mm2 = part.start(rigid.parameters, 0).squares_mm2();
    let better = |mut state: FitState, steps: u32, than_mm2: f64| {
        part.steps(&mut state, steps).ok()?;
        (state.squares_mm2() < than_mm2).then_some(state)
    };
    let mut best: Option<FitState> = None;
    let has_presliding =
        rigid.parameters.presliding_rad > LEAST_PRESLIDING_MM * fit.known.parameters.rad_per_mm;
    for share in BACKLASH_SHARES
        .into_iter()
        .filter(|share| has_presliding || *share == 0.0)
    {
        for hz in STARTS_HZ.into_iter().filter(|hz| hz * servo_s < MOST_TURNS) {
            let started = part.start(start(fit, rigid.parameters, hz, share), IDENTIFIED.len());
            let tried = TRIED
                .into_iter()
                .try_fold(started, |state, (steps, times)| {
                    better(state, steps, times * rigid_mm2)
                });
            let Some(tried) = tried else { continue };
            let than_mm2 = best.as_ref().map_or(rigid_mm2, FitState::squares_mm2);
            best = better(tried, MORE_STEPS, than_mm2).or(best);
        }
        if best.is_some() {
            break;
        }
    }
    let mut whole = fit.start(best?.at, IDENTIFIED.len());
    fit.steps(&mut whole, LAST_STEPS).ok()?;
    let found = fit.estimate(&whole).ok()?;
    let certain = |value: fn(&Parameters) -> f64, most: f64| {
        value(&found.standard_errors) < most * value(&found.parameters)
    };
    let [resonance, share] = CERTAIN;
    let is_certain =
        certain(|axis| axis.resonance_rad_s, resonance) && certain(|axis| axis.table_share, share);
    (is_certain && is_less(&whole, &fit.start(rigid.parameters, 0))).then_some(found)
}

/// Returns true if the screw leaves significantly less of the stretches.
fn is_less(with_screw: &FitState, rigid: &FitState) -> bool {
    with_screw.squares_mm2() < LESS * rigid.squares_mm2()
        && is_below(rigid.by_stretch_mm2().zip(with_screw.by_stretch_mm2()))
}

/// Returns true if the second of pairs of squares is significantly below the first. A stretch in
/// which the axis stands still leaves nothing and does not count.
fn is_below(pairs_mm2: impl Iterator<Item = (f64, f64)>) -> bool {
    let less: Vec<f64> = pairs_mm2
        .map(|(a, b)| libm::log(a / b))
        .filter(|less| less.is_finite())
        .collect();
    let n = less.len() as f64;
    let mean = less.iter().sum::<f64>() / n;
    let variance = less.iter().map(|less| (less - mean).powi(2)).sum::<f64>() / (n - 1.0);
    mean > SIGNIFICANT * (variance / n).sqrt()
}

fn start(fit: &OutputErrorFit, rigid: Parameters, hz: f64, backlash_share: f64) -> Parameters {
    Parameters {
        table_share: START_SHARE,
        resonance_rad_s: TAU * hz,
        damping_ratio: START_DAMPING,
        backlash_rad: START_BACKLASH_MM * fit.known.parameters.rad_per_mm
            + backlash_share * rigid.presliding_rad,
        presliding_rad: (1.0 - backlash_share) * rigid.presliding_rad,
        ..rigid
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stretches_in_which_the_axis_stands_still_say_nothing() {
        let moves = [(4.0, 1.0), (4.4, 1.0), (3.6, 1.0), (4.2, 1.1)];
        let stands = [(0.0, 0.0); 3];
        let is_below = |pairs: &[&[(f64, f64)]]| is_below(pairs.concat().into_iter());
        assert!(is_below(&[&moves]) && is_below(&[&moves, &stands]));
        assert!(
            !is_below(&[&stands]) && !is_below(&[&moves[..1]]),
            "there is no spread to compare with"
        );
        assert!(!is_below(&[&[(1.0, 1.0), (2.0, 1.0), (1.0, 2.0)]]));
    }
}
