//! The way back to a reference that is far off, no faster than the drive can brake.
//!
//! ```text
//! s = f(e)                                  the speed at which the regulator closes an error e of the position, rad/s
//! f(e) = l e                                |e| <= b a / 2 l^2
//! f(e) = sgn(e) (sqrt(2 b a |e|) - b a / 2 l)      beyond, with the same value and slope where they meet
//! ```
//!
//! with l = g_x / (1 + g_w) of the gains of the regulator: the torque of the speed loop is Kv times f(e) and the error of the speed, times 1 + g_w. a is
//! the acceleration that the drive has left for it, b the part of it that is relied on. A linear regulator that comes from far with a drive at its
//! torque limit asks for more speed than can be braked away, and overshoots as far as it came.
//!
//! A reference that takes more torque than there is, for long, cannot be followed; the axis by itself rounds it off. Then the offset goes back to
//! nothing, over [`TO_NOTHING_S`] of such demand, and comes back more slowly ([`Overtaxed`]). At a corner more is asked for only for a period or two.
//!
//! Source: Workman, Kosut and Franklin (1987), "Adaptive proximate time-optimal servomechanisms: continuous time case", Proc. American
//! Control Conference.

use crate::vector::bounded;

/// Part of the acceleration that is left that is relied on: the loops answer late.
const RELIED_ON: f64 = 0.5;
/// Part of the torque limit that counts as left where the reference takes more.
const LEAST_LEFT: f64 = 0.1;

/// Acceleration that is left beside what the reference takes, rad/s^2.
pub(super) fn left_rad_s2(torque_limit_nm: f64, reference_nm: f64, inertia_kg_m2: f64) -> f64 {
    let left_nm = torque_limit_nm - reference_nm.abs();
    left_nm.max(LEAST_LEFT * torque_limit_nm) / inertia_kg_m2
}

/// Speed at which an error of the position is to be closed, rad/s; `gain_1_s` is that of small errors.
pub(super) fn closing_rad_s(error_rad: f64, gain_1_s: f64, left_rad_s2: f64) -> f64 {
    let linear_rad_s = gain_1_s * error_rad;
    let most_rad_s2 = RELIED_ON * left_rad_s2;
    // The speed at which the two meet, twice b a / 2 l.
    let meeting_rad_s = most_rad_s2 / (2.0 * gain_1_s);
    if linear_rad_s.abs() > meeting_rad_s {
        let braked_rad_s = libm::sqrt(2.0 * most_rad_s2 * error_rad.abs()) - meeting_rad_s;
        libm::copysign(braked_rad_s, error_rad)
    } else {
        linear_rad_s
    }
}

/// Time with too large a demand after which nothing is left of the offset, s, and time without in which it comes back.
const TO_NOTHING_S: f64 = 0.03;
const BACK_S: f64 = 0.3;

/// How much of the time that has passed the reference took more torque than there is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Overtaxed {
    part: f64,
}

impl Overtaxed {
    /// It did not.
    pub(super) const NOT: Self = Self { part: 0.0 };

    /// Whether it does in this servo period.
    pub(super) fn take_in(&mut self, beyond: bool, servo_s: f64) {
        let change = if beyond { servo_s / TO_NOTHING_S } else { -servo_s / BACK_S };
        self.part = bounded(self.part + change, 0.0, 1.0);
    }

    /// How much of the offset is left.
    pub(super) fn left(&self) -> f64 {
        1.0 - self.part
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_and_slope_are_continuous_where_the_two_meet() {
        let (gain, left) = (200.0, 3000.0);
        let meeting_rad = RELIED_ON * left / (2.0 * gain * gain);
        for sign in [-1.0, 1.0] {
            let at = |parts: f64| closing_rad_s(sign * parts * meeting_rad, gain, left);
            assert!((at(1.0 - 1e-9) - at(1.0 + 1e-9)).abs() < 1e-6);
            let slopes = [0.999, 1.0].map(|parts| (at(parts + 0.001) - at(parts)) / (0.001 * meeting_rad * sign));
            assert!(slopes.iter().all(|slope| (slope - gain).abs() < 1e-3 * gain), "{slopes:?}");
        }
    }

    #[test]
    fn a_drive_at_its_limit_comes_to_rest_without_overshoot() {
        // A double integrator whose acceleration is bounded, under f and a loop of the speed ten times as fast as the gain.
        let (gain, left, step_s) = (100.0, 3000.0, 1e-5);
        let overshoot = |closing: &dyn Fn(f64) -> f64| {
            let (mut error_rad, mut speed_rad_s, mut least_rad) = (5.0_f64, 0.0_f64, 0.0_f64);
            for _ in 0..100_000 {
                let wanted_rad_s2 = 10.0 * gain * (-closing(error_rad) - speed_rad_s);
                speed_rad_s += step_s * wanted_rad_s2.max(-left).min(left);
                error_rad += step_s * speed_rad_s;
                least_rad = least_rad.min(error_rad);
            }
            assert!(error_rad.abs() < 1e-3, "{error_rad}");
            -least_rad
        };
        assert!(overshoot(&|error_rad| closing_rad_s(error_rad, gain, left)) < 1e-6);
        assert!(overshoot(&|error_rad| gain * error_rad) > 0.5, "the linear one is no example");
    }

    #[test]
    fn what_the_reference_takes_is_not_left() {
        assert_eq!(left_rad_s2(10.0, -4.0, 0.01), 600.0);
        assert_eq!(left_rad_s2(10.0, 12.0, 0.01), 100.0);
    }
}
