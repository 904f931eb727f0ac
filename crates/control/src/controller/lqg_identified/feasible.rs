//! Check of the torque for the reference ahead.
//!
//! ```text
//! a = (r(t) - 2 r(t - h) + r(t - 2h)) / h^2           at the far end of what is known of the reference
//! |J a + B v + Fc sgn v| > 0.9 Tmax                   the torque is not sufficient
//! ```
//!
//! A reference that takes more torque than available cannot be followed: the axis falls behind, and
//! swings when it catches up. The axis without correction rounds the reference off. Until such a
//! reference has passed, the motion of the axis without any offset replaces the reference: for all
//! axes of a machine over the same [`TO_OPEN_S`], before the reference acts. A corner of the path
//! is averaged over h: the regulator compensates for a shorter demand.
//!
//! Source: the reference is changed where it would violate a bound, as by a reference governor,
//! Gilbert, Kolmanovsky and Tan (1995), "Discrete-time reference governors and the nonlinear
//! control of systems with state and control constraints"; the replacement is our own.

use crate::axis::AxisModel;
use crate::vector::{bounded, smooth_step};

/// h, s. With 4 ms a drive that is just strong enough for its plan leaves as much error as
/// uncorrected at the corners of a square, with 10 and 20 ms a fifth.
const AVERAGED_S: f64 = 0.01;
/// Part of the torque that is available for the reference.
const FOR_REFERENCE: f64 = 0.9;
/// Time in which the motion of the axis without correction takes over, s, and time in which it
/// hands back.
const TO_OPEN_S: f64 = 0.02;
const BACK_S: f64 = 0.05;

/// Times before the end of the known reference at which [`is_beyond`] needs it, s.
pub(super) const BEFORE_END_S: [f64; 3] = [0.0, AVERAGED_S, 2.0 * AVERAGED_S];

/// Returns true if an axis takes more torque than available along its reference, mm at
/// [`BEFORE_END_S`].
pub(super) fn is_beyond(
    axis_model: &AxisModel,
    [newest_mm, middle_mm, oldest_mm]: [f64; 3],
) -> bool {
    let parameters = &axis_model.parameters;
    let speed_rad_s = (newest_mm - oldest_mm) / (2.0 * AVERAGED_S) * parameters.rad_per_mm;
    let acceleration_mm_s2 =
        ((newest_mm - middle_mm) - (middle_mm - oldest_mm)) / (AVERAGED_S * AVERAGED_S);
    let sign = if speed_rad_s == 0.0 {
        0.0
    } else {
        libm::copysign(1.0, speed_rad_s)
    };
    let inertia_nm = parameters.inertia_kg_m2 * acceleration_mm_s2 * parameters.rad_per_mm;
    (inertia_nm + axis_model.friction_nm(speed_rad_s, sign)).abs()
        > FOR_REFERENCE * parameters.torque_limit_nm
}

/// Degree to which the motion of the axes without correction replaces the reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Feasibility {
    /// Time until a reference beyond the torque has passed, s.
    until_s: f64,
    open: f64,
}

impl Feasibility {
    /// The reference is followed.
    pub(super) const FOLLOWED: Self = Self {
        until_s: 0.0,
        open: 0.0,
    };

    /// Takes in a servo period; `beyond` is true if the torque is not sufficient for the reference
    /// that acts in `ahead_s`.
    pub(super) fn take_in(&mut self, beyond: bool, ahead_s: f64, servo_s: f64) {
        self.until_s = if beyond {
            ahead_s
        } else {
            self.until_s - servo_s
        };
        let change = if self.until_s > 0.0 {
            servo_s / TO_OPEN_S
        } else {
            -servo_s / BACK_S
        };
        self.open = bounded(self.open + change, 0.0, 1.0);
    }

    /// Returns the weight of the motion of the axes without correction, 0 to 1.
    pub(super) fn open(&self) -> f64 {
        smooth_step(self.open)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::{Parameters, Periods};
    use crate::controller::feedforward;

    /// 0.01 kg m^2, 1 N m of friction, 10 N m, 1 rad a mm.
    fn axis_model() -> AxisModel {
        let parameters = Parameters {
            rad_per_mm: 1.0,
            torque_limit_nm: 10.0,
            viscous_friction_nm_s: 0.0,
            ..feedforward::tests::axis(0.0, 1.0)
        };
        AxisModel::new(
            parameters,
            Periods {
                servo_s: 0.001,
                mechanics_s: 1e-4,
                mechanics_per_servo: 10,
            },
        )
    }

    #[test]
    fn what_takes_more_than_nine_tenths_of_the_torque_is_beyond() {
        let is_beyond =
            |at_mm: &dyn Fn(f64) -> f64| is_beyond(&axis_model(), BEFORE_END_S.map(at_mm));
        let speeds_up =
            |mm_s2: f64| is_beyond(&|before_s| 0.5 * mm_s2 * (1.0 - before_s) * (1.0 - before_s));
        let slows_down =
            |mm_s2: f64| is_beyond(&|before_s| -0.5 * mm_s2 * (1.0 + before_s) * (1.0 + before_s));
        assert_eq!(
            [790.0, 810.0].map(speeds_up),
            [false, true],
            "friction comes on top"
        );
        assert_eq!(
            [990.0, 1010.0].map(slows_down),
            [false, true],
            "friction helps"
        );
        assert!(
            !is_beyond(&|before_s| -100.0 * before_s),
            "a constant speed takes friction only"
        );
        assert!(!is_beyond(&|_| f64::NAN));
    }

    #[test]
    fn the_axes_by_themselves_take_over_until_it_has_passed() {
        let mut feasibility = Feasibility::FOLLOWED;
        let open = [0; 20].map(|_| {
            feasibility.take_in(true, 0.04, 0.001);
            feasibility.open()
        });
        assert!(
            open.windows(2).all(|pair| pair[1] > pair[0]) && open[19] == 1.0,
            "{open:?}"
        );
        let after = |feasibility: &mut Feasibility, periods: u32| {
            (0..periods).for_each(|_| feasibility.take_in(false, 0.04, 0.001));
            feasibility.open()
        };
        assert_eq!(after(&mut feasibility, 38), 1.0);
        assert_eq!(after(&mut feasibility, 55), 0.0);
    }
}
