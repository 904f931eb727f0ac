//! The command ahead of a table that lags by lost motion: half of it, in the direction of travel.
//!
//! ```text
//! lead_i = L_i / 2 tanh(w / v_i),   w = (r_i(tau + T) - r_i(tau - T)) / 2 T
//! L_i = b_i + 2 F_i / k_i           v_i = a_i sqrt(0.385 L_i / l_i)     T = max_i v_i / a_i
//! ```
//!
//! Lost motion is the backlash b and what the friction F of both directions winds the screw of
//! stiffness k up. A table at rest needs no torque, so that an axis that rests has no lead. An axis
//! that turns at its acceleration a passes its speed by w / v = +-1 in the time 2 T. The lead then
//! accelerates by no more than l: the largest second derivative of tanh is 0.77. The mean speed
//! over 2 T takes the place of the speed, because the lead must not leap where the speed does, at a
//! corner.
//!
//! Symbols: L lost motion, mm; a acceleration of the axis and l of its lead, mm/s2; r reference of
//! the axis, mm, over plan time tau, s.
//!
//! Source: Nordin and Gutman (2002), "Controlling mechanical systems with backlash: a survey",
//! Automatica 38, section 4: the inverse of the gap, with a crossing of finite speed.

/// Half of the largest second derivative of tanh, 4 / (3 sqrt 3).
const STEEPEST: f64 = 0.385;

/// Compensation of the lost motion of N axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct LostMotion<const N: usize> {
    half_mm: [f64; N],
    /// Speed over which the lead turns its sign, mm/s.
    turns_mm_s: [f64; N],
    /// Time before and after the present moment over which the speed is averaged, s.
    window_s: f64,
}

impl<const N: usize> LostMotion<N> {
    /// Creates the compensation of axes with this lost motion, mm, and acceleration, mm/s2. The
    /// lead accelerates by at most `lead_mm_s2`.
    pub(super) fn new(lost_mm: [f64; N], accel_mm_s2: [f64; N], lead_mm_s2: [f64; N]) -> Self {
        let turns_mm_s = std::array::from_fn(|i| {
            accel_mm_s2[i] * (STEEPEST * lost_mm[i].abs() / lead_mm_s2[i]).sqrt()
        });
        let window_s = (0..N)
            .map(|i| turns_mm_s[i] / accel_mm_s2[i])
            .fold(0.0, f64::max);
        Self {
            half_mm: lost_mm.map(|mm| 0.5 * mm),
            turns_mm_s,
            window_s,
        }
    }

    /// Returns the lead of each axis command at plan time `tau_s`, mm; `at_mm` is the reference
    /// over plan time.
    pub(super) fn lead_mm(&self, tau_s: f64, mut at_mm: impl FnMut(f64) -> [f64; N]) -> [f64; N] {
        if self.window_s == 0.0 {
            return [0.0; N];
        }
        let [before_mm, after_mm] =
            [tau_s - self.window_s, tau_s + self.window_s].map(|at_s| at_mm(at_s.max(0.0)));
        std::array::from_fn(|i| {
            let speed_mm_s = (after_mm[i] - before_mm[i]) / (2.0 * self.window_s);
            // Without lost motion the quotient is no number.
            if self.half_mm[i] == 0.0 {
                0.0
            } else {
                self.half_mm[i] * libm::tanh(speed_mm_s / self.turns_mm_s[i])
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LOST_MM: f64 = 0.02;
    const ACCEL_MM_S2: f64 = 300.0;
    const STEP_S: f64 = 1e-4;

    /// Turns at the acceleration of the axis at 1 s, and stands from 2 s on.
    fn reference_mm(tau_s: f64) -> [f64; 2] {
        let from_turn_s = tau_s.min(2.0) - 1.0;
        [-0.5 * ACCEL_MM_S2 * from_turn_s * from_turn_s, 0.0]
    }

    #[test]
    fn half_of_the_lost_motion_is_ahead_in_motion_and_none_at_rest() {
        let lost = LostMotion::new([LOST_MM, 0.0], [ACCEL_MM_S2; 2], [ACCEL_MM_S2; 2]);
        let lead_mm = |tau_s: f64| lost.lead_mm(tau_s, reference_mm);
        for (tau_s, wanted_mm) in [(0.5, 0.01), (1.0, 0.0), (1.5, -0.01), (3.0, 0.0)] {
            let [found_mm, other_mm] = lead_mm(tau_s);
            assert!(
                (found_mm - wanted_mm).abs() < 1e-12 && other_mm == 0.0,
                "{tau_s}: {found_mm}"
            );
        }
    }

    #[test]
    fn a_turn_at_the_acceleration_of_the_axis_adds_no_more_than_the_lead_may_have() {
        for allowed_mm_s2 in [ACCEL_MM_S2, 0.5 * ACCEL_MM_S2] {
            let lost = LostMotion::new([LOST_MM], [ACCEL_MM_S2], [allowed_mm_s2]);
            let lead_mm = |n: u32| {
                lost.lead_mm(0.9 + f64::from(n) * STEP_S, |at_s| [reference_mm(at_s)[0]])[0]
            };
            let accel =
                |n: u32| (lead_mm(n + 1) - 2.0 * lead_mm(n) + lead_mm(n - 1)) / (STEP_S * STEP_S);
            let most_mm_s2 = (1..2000).map(|n| accel(n).abs()).fold(0.0, f64::max);
            assert!(
                most_mm_s2 < 1.001 * allowed_mm_s2 && most_mm_s2 > 0.99 * allowed_mm_s2,
                "{most_mm_s2}"
            );
        }
    }

    #[test]
    fn the_lead_of_an_axis_without_lost_motion_is_zero_to_the_bit() {
        let lost = LostMotion::new([0.0; 2], [ACCEL_MM_S2; 2], [ACCEL_MM_S2; 2]);
        assert_eq!(lost.lead_mm(0.5, |_| [f64::NAN; 2]), [0.0; 2]);
    }
}
