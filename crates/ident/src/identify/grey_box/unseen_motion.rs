//! Uncertainty of the position on motion that a record does not have.
//!
//! ```text
//! U^2 = tr(S C S^T) / n        C covariance of all terms, those that were not admitted too; S derivatives of the position
//! ```
//!
//! over the n samples of a reference motion: both directions, from creeping to the highest speed of
//! the record, long strokes and short ones at its acceleration. A record that moves one way, or
//! never accelerates, leaves terms to their priors; C is as wide there. Where U exceeds the
//! residual of the model over the record, the direction of C that moves the position most names the
//! terms that the record does not determine.
//!
//! Source: G-optimality, Kiefer and Wolfowitz (1960), The equivalence of two extremum problems, for
//! the variance of a prediction as a measure of a design.

use super::admission::OPTIONAL;
use super::axis_record::AxisRecord;
use super::output_error::OutputErrors;
use super::standard_errors::StandardErrors;
use super::terms::{ModelTerm, TermValues};

/// Uncertainty of predictions of motion that a record does not have.
#[derive(Debug, Clone, PartialEq)]
pub struct UnseenMotion {
    /// Uncertainty of the position over the reference motion, um RMS, one standard deviation.
    pub uncertain_um: f64,
    /// Residual of the model over the fitted samples, um RMS.
    pub left_um: f64,
    /// Terms that most of it is due to.
    pub terms: Vec<ModelTerm>,
    /// The direction in which the record never moves, -1 or 1.
    pub never: Option<i8>,
}

/// Speeds of strokes, parts of the highest; lengths of short strokes, parts of the way in which it
/// is reached.
const SPEEDS: [f64; 5] = [0.01, 0.1, 0.3, 0.6, 1.0];
const SHORT: [f64; 4] = [0.3, 0.1, 0.03, 0.01];
/// Time of an even motion, and of a rest, s.
const EVEN_S: f64 = 0.15;
const REST_S: f64 = 0.1;
/// Time in which a record reaches its speed that shows no acceleration, s.
const REACHED_S: f64 = 0.05;
/// A term is named whose correlation with what is uncertain is more than this: half of its
/// variance.
const NAMED: f64 = 0.7;

impl UnseenMotion {
    /// Returns true if predictions of such motion are less certain than the residual over the
    /// record.
    pub fn is_open(&self) -> bool {
        self.uncertain_um.is_nan() || self.uncertain_um > self.left_um
    }

    /// Computes the uncertainty of a fit from its residual, mm, and from the highest speed and
    /// acceleration of the record, mm/s and mm/s2.
    pub(super) fn of(
        errors: &OutputErrors<'_>,
        values: &TermValues,
        fitted: &[ModelTerm],
        left_mm: f64,
        most: [f64; 2],
    ) -> Self {
        let mut terms = fitted.to_vec();
        terms.extend(OPTIONAL.into_iter().filter(|term| !fitted.contains(term)));
        let covariance = StandardErrors::of(errors, values, &terms).covariance;
        let command_mm = reference_mm(most, errors.record.sample_s);
        let actual_mm = vec![0.0; command_mm.len()];
        let whole = std::iter::once(0..command_mm.len()).collect::<Vec<_>>();
        let record = AxisRecord {
            stretches: &whole,
            command_mm: &command_mm,
            actual_mm: &actual_mm,
            ..*errors.record
        };
        let counts = vec![true; command_mm.len()];
        let reference = OutputErrors {
            record: &record,
            counts: &counts,
            deviation_mm: 1.0,
            priors: &[],
        };
        let slopes = reference.slopes(values, &terms);
        let (moves, _) = super::output_error::normal_equations(&slopes, &actual_mm);
        let moves = moves / command_mm.len() as f64;
        let uncertain_mm2 = (&covariance * &moves).trace();
        let motion = super::sample_split::motion(errors.record);
        let never = [-1, 1]
            .into_iter()
            .find(|way| !(0..motion.len()).any(|k| errors.counts[k] && motion[k] == *way));
        Self {
            uncertain_um: 1e3 * uncertain_mm2.max(0.0).sqrt(),
            left_um: 1e3 * left_mm,
            terms: named(&covariance, &moves, &terms),
            never,
        }
    }
}

/// Terms along the direction of a covariance that moves the position most.
fn named(
    covariance: &nalgebra::DMatrix<f64>,
    moves: &nalgebra::DMatrix<f64>,
    terms: &[ModelTerm],
) -> Vec<ModelTerm> {
    let Some(root) = covariance.clone().cholesky().map(|cholesky| cholesky.l()) else {
        return terms.to_vec();
    };
    let eigen = (root.transpose() * moves * &root).symmetric_eigen();
    let direction = &root * eigen.eigenvectors.column(eigen.eigenvalues.imax());
    let correlation = |i: usize| direction[i].abs() / covariance[(i, i)].sqrt();
    (0..terms.len())
        .filter(|&i| correlation(i) > NAMED)
        .map(|i| terms[i])
        .collect()
}

/// The reference motion, mm, one a sample: strokes there and back with rests between.
fn reference_mm([speed_mm_s, accel_mm_s2]: [f64; 2], sample_s: f64) -> Vec<f64> {
    let accel_mm_s2 = if accel_mm_s2 > 0.0 {
        accel_mm_s2
    } else {
        speed_mm_s / REACHED_S
    };
    let reached_mm = speed_mm_s * speed_mm_s / accel_mm_s2;
    let even = SPEEDS.map(|part| {
        (
            part * speed_mm_s,
            part * speed_mm_s * (EVEN_S + part * speed_mm_s / accel_mm_s2),
        )
    });
    let short = SHORT.map(|part| (speed_mm_s, part * reached_mm));
    let mut way_mm = vec![0.0; (REST_S / sample_s) as usize + 1];
    for (speed_mm_s, length_mm) in even.into_iter().chain(short) {
        for direction in [1.0, -1.0] {
            stroke(
                &mut way_mm,
                direction * length_mm,
                speed_mm_s,
                accel_mm_s2,
                sample_s,
            );
        }
        let at_mm = way_mm.last().copied().unwrap_or(0.0);
        way_mm.extend(std::iter::repeat_n(at_mm, (REST_S / sample_s) as usize));
    }
    way_mm
}

/// Appends a move of trapezoidal speed.
fn stroke(way_mm: &mut Vec<f64>, length_mm: f64, speed_mm_s: f64, accel_mm_s2: f64, sample_s: f64) {
    let from_mm = way_mm.last().copied().unwrap_or(0.0);
    let peak_mm_s = speed_mm_s.min((accel_mm_s2 * length_mm.abs()).sqrt());
    let ramp_s = peak_mm_s / accel_mm_s2;
    let time_s = length_mm.abs() / peak_mm_s + ramp_s;
    let gone_mm = |t: f64| {
        let (into, left) = (t.min(ramp_s), (time_s - t).clamp(0.0, ramp_s));
        let even_s = (t - into - (ramp_s - left)).max(0.0);
        let braked_mm = 0.5 * accel_mm_s2 * (ramp_s * ramp_s - left * left);
        0.5 * accel_mm_s2 * into * into + peak_mm_s * even_s + braked_mm
    };
    let samples = (time_s / sample_s).ceil().min(MOST_SAMPLES) as usize;
    way_mm.extend(
        (1..=samples)
            .map(|k| from_mm + length_mm.signum() * gone_mm((k as f64 * sample_s).min(time_s))),
    );
}

/// Samples of a stroke at the most: a record whose speeds are no speeds has no reference motion.
const MOST_SAMPLES: f64 = 1e5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_stroke_ends_where_it_should_at_its_speed_and_acceleration() {
        for (length_mm, speed_mm_s) in [(5.0, 50.0), (-0.2, 50.0), (1.0, 3.0)] {
            let mut way_mm = vec![1.0];
            stroke(&mut way_mm, length_mm, speed_mm_s, 500.0, 0.001);
            assert!(
                (way_mm.last().unwrap() - 1.0 - length_mm).abs() < 1e-9,
                "{length_mm}: {:?}",
                way_mm.last()
            );
            let speeds: Vec<f64> = way_mm
                .windows(2)
                .map(|pair| (pair[1] - pair[0]) / 0.001)
                .collect();
            assert!(speeds.iter().all(|speed| speed.abs() < speed_mm_s * 1.0001));
            assert!(
                speeds
                    .windows(2)
                    .all(|pair| (pair[1] - pair[0]).abs() < 0.5001 * 1.0001)
            );
        }
    }

    #[test]
    fn a_reference_motion_ends_where_it_begins() {
        let way_mm = reference_mm([60.0, 600.0], 0.001);
        assert!(
            way_mm.last().unwrap().abs() < 1e-9 && way_mm.len() > 2000,
            "{}",
            way_mm.len()
        );
    }
}
