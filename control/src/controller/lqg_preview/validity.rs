//! Whether the law is that of the axis. A law that is not is no use to a regulator that goes by it: the loop may swing, and the filter takes
//! that for loads.
//!
//! ```text
//! m  measured position less that of a free run by the law, restarted every 30 ms from what the filter has
//! f  following error: command less measured position
//!
//! <m^2> > (2 um)^2 + (4 s)^2 + (f / 10)^2     over the last 5 ms: the law is wrong
//! ```
//!
//! s is what noise and loads that nobody foresees move the axis by in a free run, by the statistics. As long as the law has shown nothing,
//! little is risked: in the first 4 / Kp of motion the correction comes in gradually.
//!
//! Against g, the way by which the offset has moved the tool by the law, in place of f: with g / 2 a law with gains, inertia and friction 10 %
//! off, which leaves a tenth of the error of open loop, counts as wrong. With f / 5 three of 36 such cuts are worse than open loop, with f / 10 none.
//!
//! Source: the free run as in Ljung (1999), System Identification, section 16.6, where models are validated by simulation; the rule is our own.

use crate::vector::dot;

use super::estimate::{AxisModel, Estimate, Sent};

/// Time of a free run, s: about the time constant of a usual position loop.
const RUN_S: f64 = 0.03;
/// Time over which squares are averaged, s.
const MEMORY_S: f64 = 0.005;
/// What may always be missed, mm^2 (2 um).
const LEAST_MM2: f64 = 4e-6;
/// Standard deviations of what nobody foresees, and the part of the following error.
const DEVIATIONS: f64 = 4.0;
const FOLLOWING_SHARE: f64 = 0.1;
/// Time constants of the position loop in which a correction comes in.
const TAKE_UP: f64 = 4.0;

/// A free run beside the filter, of an axis.
#[derive(Debug, Clone, Copy)]
pub(super) struct LawTrial {
    free: Estimate,
    for_s: f64,
    missed_rad: f64,
}

impl LawTrial {
    /// From an estimate on.
    pub(super) fn from(estimate: &Estimate) -> Self {
        Self { free: *estimate, for_s: 0.0, missed_rad: 0.0 }
    }

    /// m, rad.
    pub(super) fn missed_rad(&self) -> f64 {
        self.missed_rad
    }

    /// One servo period on; `estimate` is that of the filter, which has taken in what was measured.
    pub(super) fn go_on(&mut self, model: &AxisModel, sent: &Sent, measured_rad: f64, estimate: &Estimate) {
        model.predict(&mut self.free, sent);
        self.missed_rad = measured_rad - model.shown_rad(&self.free);
        self.for_s += model.law.periods.servo_s;
        if self.for_s >= RUN_S {
            (self.free, self.for_s) = (*estimate, 0.0);
        }
    }
}

/// What is known of the laws of all axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Validity {
    missed_mm2: f64,
    following_mm2: f64,
    /// Time for which the path has moved, s.
    moved_s: f64,
}

impl Validity {
    /// Nothing yet.
    pub(super) const UNKNOWN: Self = Self { missed_mm2: 0.0, following_mm2: 0.0, moved_s: 0.0 };

    /// A servo period, with m and f of the axes, mm.
    pub(super) fn take_in<const N: usize>(
        &mut self,
        missed_mm: [f64; N],
        following_mm: [f64; N],
        moves: bool,
        servo_s: f64,
    ) {
        let part = (servo_s / MEMORY_S).min(1.0);
        self.missed_mm2 += part * (dot(missed_mm, missed_mm) - self.missed_mm2);
        self.following_mm2 += part * (dot(following_mm, following_mm) - self.following_mm2);
        self.moved_s += if moves { servo_s } else { 0.0 };
    }

    /// Whether the laws are wrong, where noise and loads that nobody foresees miss by a mean square of `unforeseen_mm2`.
    pub(super) fn is_wrong(&self, unforeseen_mm2: f64) -> bool {
        let allowed_mm2 = LEAST_MM2
            + DEVIATIONS * DEVIATIONS * unforeseen_mm2
            + FOLLOWING_SHARE * FOLLOWING_SHARE * self.following_mm2;
        let holds = self.missed_mm2 <= allowed_mm2;
        // What is not a number does not hold.
        !holds
    }

    /// The part of the correction that is followed, for a position loop with this time constant.
    pub(super) fn taken_up(&self, time_constant_s: f64) -> f64 {
        let part = (self.moved_s / (TAKE_UP * time_constant_s)).min(1.0);
        part * part * (3.0 - 2.0 * part)
    }
}

/// Servo periods of a free run.
pub(super) fn run_periods(servo_s: f64) -> u32 {
    libm::ceil(RUN_S / servo_s) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;

    fn after(periods: u32, missed_mm: f64, following_mm: f64) -> Validity {
        let mut validity = Validity::UNKNOWN;
        (0..periods).for_each(|_| validity.take_in([missed_mm, 0.0], [0.0, following_mm], true, SERVO_S));
        validity
    }

    #[test]
    fn a_law_is_wrong_where_it_misses_more_than_noise_and_a_tenth_of_the_following_error() {
        for (missed_mm, following_mm, unforeseen_mm2, wrong) in [
            (0.0019, 0.0, 0.0, false),
            (0.0021, 0.0, 0.0, true),
            (0.019, 0.2, 0.0, false),
            (0.021, 0.2, 0.0, true),
            (0.039, 0.0, 1e-4, false),
            (0.041, 0.0, 1e-4, true),
            (f64::NAN, 1.0, 1.0, true),
        ] {
            let validity = after(200, missed_mm, following_mm);
            assert_eq!(validity.is_wrong(unforeseen_mm2), wrong, "{missed_mm} {following_mm} {unforeseen_mm2}");
        }
        assert!(!Validity::UNKNOWN.is_wrong(0.0));
    }

    #[test]
    fn a_correction_comes_in_while_the_path_moves() {
        assert_eq!(Validity::UNKNOWN.taken_up(0.02), 0.0);
        assert!((after(40, 0.0, 0.0).taken_up(0.02) - 0.5).abs() < 1e-9);
        assert_eq!(after(81, 0.0, 0.0).taken_up(0.02), 1.0);
        let mut standing = Validity::UNKNOWN;
        (0..100).for_each(|_| standing.take_in([0.0; 2], [0.0; 2], false, SERVO_S));
        assert_eq!(standing.taken_up(0.02), 0.0);
    }
}
