//! Question: can an innovation be motion of the axis? An encoder may be frozen, or leap by less than
//! `feedback.rs` detects.
//!
//! ```text
//! |nu| <= 4 sigma + (Tmax / J) Ts^2 / 2
//! ```
//!
//! is the bound of an innovation nu. A measurement that repeats itself to the bit while the axis
//! moves is not used. The bound is the noise, plus the travel of the axis in a servo period under a
//! force as large as the drive's own. A larger innovation comes from the encoder and not from the
//! axis, or the model is not the axis's. The first does not last, because the supervisor detects it
//! by then. An innovation that remains after [`LASTS_S`] counts as the second, and is used in full.
//!
//! Evidence: the innovation of the filter and its bound; the filter uses the part within the bound.
//!
//! Source: bounded innovations as in Masreliez and Martin (1977), "Robust Bayesian estimation for
//! the linear model and robustifying the Kalman filter", IEEE Trans. Automatic Control 22(3); the
//! bound is our own.

use crate::axis::AxisModel;
use crate::vector::bounded;

use super::DEVIATIONS;

/// Time after which a large innovation is used in full, s: the supervisor detects a frozen encoder
/// within 20 ms.
const LASTS_S: f64 = 0.025;

/// Returns the largest innovation that is used in full, rad.
pub(crate) fn bound_rad(axis_model: &AxisModel, measured_rad2: f64) -> f64 {
    let servo_s = axis_model.periods.servo_s;
    let accelerated_rad = 0.5 * axis_model.parameters.torque_limit_nm
        / axis_model.parameters.inertia_kg_m2
        * servo_s
        * servo_s;
    DEVIATIONS * libm::sqrt(measured_rad2) + accelerated_rad
}

/// Time for which innovations were larger than the bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Outliers {
    for_s: f64,
}

impl Outliers {
    /// State before any measurement.
    pub(crate) const NONE: Self = Self { for_s: 0.0 };

    /// Returns the part of the innovation of a measurement that is used, rad. A measurement may
    /// repeat the last one to the bit.
    pub(crate) fn bounded_rad(
        &mut self,
        repeats: bool,
        missed_rad: f64,
        bound_rad: f64,
        servo_s: f64,
    ) -> f64 {
        if missed_rad.abs() <= bound_rad {
            self.for_s = 0.0;
            return missed_rad;
        }
        self.for_s += servo_s;
        if self.for_s > LASTS_S {
            missed_rad
        } else if repeats {
            0.0
        } else {
            bounded(missed_rad, -bound_rad, bound_rad)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::{Parameters, Periods};

    const SERVO_S: f64 = 0.001;

    #[test]
    fn the_bound_is_four_deviations_and_the_travel_of_a_period_under_the_largest_torque() {
        let parameters = Parameters {
            torque_limit_nm: 30.0,
            inertia_kg_m2: 0.01,
            ..Parameters::NOTHING
        };
        let periods = Periods {
            servo_s: SERVO_S,
            mechanics_s: SERVO_S,
            mechanics_per_servo: 1,
        };
        // A deviation of 2 mrad; 3000 rad/s2 from rest for 1 ms is 1.5 mrad.
        let bound_rad = bound_rad(&AxisModel::new(parameters, periods), 4e-6);
        assert!((bound_rad - 9.5e-3).abs() < 1e-15, "{bound_rad}");
    }

    #[test]
    fn a_small_innovation_is_used_and_a_large_one_only_where_it_lasts() {
        let mut outliers = Outliers::NONE;
        let mut used = |missed_rad| outliers.bounded_rad(false, missed_rad, 0.01, SERVO_S);
        assert_eq!([0.0, 0.01, -0.009].map(&mut used), [0.0, 0.01, -0.009]);
        assert_eq!(
            [1.0, -1.0, f64::INFINITY].map(&mut used),
            [0.01, -0.01, 0.01]
        );
        // One that is small begins the time anew.
        assert_eq!(used(0.001), 0.001);
        let first = (0..100).position(|_| used(1.0) == 1.0);
        assert!(matches!(first, Some(24 | 25)), "{first:?}");
    }

    #[test]
    fn nothing_of_a_frozen_encoder_is_used_unless_the_axis_stands() {
        let mut outliers = Outliers::NONE;
        let taken =
            [0.0, 0.005, 0.05, 0.1].map(|missed| outliers.bounded_rad(true, missed, 0.01, SERVO_S));
        assert_eq!(taken, [0.0, 0.005, 0.0, 0.0]);
    }
}
