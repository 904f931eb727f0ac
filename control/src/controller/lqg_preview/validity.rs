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
//! little is risked: the correction comes in over the first way, 25 times as long as what may be missed.
//!
//! Of 134 cuts on machines whose inertia, friction and gains are up to three times larger or smaller, that are late, or soft, 120 were worse than open loop by
//! the law of another machine, by up to 1.4 mm; now two are, by 2.1 times at the most. With 15 times as long four are, by 2.8.
//!
//! Against g, the way by which the offset has moved the tool by the law, in place of f: with g / 2 a law with gains, inertia and friction 10 %
//! off, which leaves a tenth of the error of open loop, counts as wrong. With f / 5 three of 36 such cuts are worse than open loop, with f / 10 none.
//!
//! Source: the free run as in Ljung (1999), System Identification, section 16.6, where models are validated by simulation; the rule is our own.

use crate::vector::{dot, norm, smooth_step, sub};

use super::estimate::{AxisModel, Estimate, Sent};

/// Time of a free run, s: about the time constant of a usual position loop.
const RUN_S: f64 = 0.03;
/// Time over which squares are averaged, s.
const MEMORY_S: f64 = 0.005;
/// What may be missed without any noise, mm^2 (2 um).
const LEAST_MM2: f64 = 4e-6;
/// Standard deviations of what nobody foresees, and the part of the following error.
const DEVIATIONS: f64 = 4.0;
const FOLLOWING_SHARE: f64 = 0.1;
/// Way from the start over which a correction comes in, times what may be missed: a law that is wrong by a few parts in a hundred shows there.
const PROVEN: f64 = 25.0;

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
pub(super) struct Validity<const N: usize> {
    missed_mm2: f64,
    following_mm2: f64,
    /// Where it began, and how far from there it has been, mm.
    began_mm: Option<[f64; N]>,
    farthest_mm: f64,
}

impl<const N: usize> Validity<N> {
    /// Nothing yet.
    pub(super) const UNKNOWN: Self = Self { missed_mm2: 0.0, following_mm2: 0.0, began_mm: None, farthest_mm: 0.0 };

    /// A servo period, with m and f of the axes and their measured position, mm.
    pub(super) fn take_in(&mut self, missed_mm: [f64; N], following_mm: [f64; N], position_mm: [f64; N], servo_s: f64) {
        let part = (servo_s / MEMORY_S).min(1.0);
        self.missed_mm2 += part * (dot(missed_mm, missed_mm) - self.missed_mm2);
        self.following_mm2 += part * (dot(following_mm, following_mm) - self.following_mm2);
        let began_mm = *self.began_mm.get_or_insert(position_mm);
        self.farthest_mm = self.farthest_mm.max(norm(sub(position_mm, began_mm)));
    }

    /// Whether the laws are wrong, where noise and loads that nobody foresees miss by a mean square of `unforeseen_mm2`.
    pub(super) fn is_wrong(&self, unforeseen_mm2: f64) -> bool {
        let following_mm2 = FOLLOWING_SHARE * FOLLOWING_SHARE * self.following_mm2;
        let holds = self.missed_mm2 <= always_mm2(unforeseen_mm2) + following_mm2;
        // What is not a number does not hold.
        !holds
    }

    /// The part of the correction that is followed.
    pub(super) fn taken_up(&self, unforeseen_mm2: f64) -> f64 {
        let part = (self.farthest_mm / (PROVEN * libm::sqrt(always_mm2(unforeseen_mm2)))).min(1.0);
        smooth_step(part)
    }
}

/// What may always be missed, mm^2.
fn always_mm2(unforeseen_mm2: f64) -> f64 {
    LEAST_MM2 + DEVIATIONS * DEVIATIONS * unforeseen_mm2
}

/// Servo periods of a free run.
pub(super) fn run_periods(servo_s: f64) -> u32 {
    libm::ceil(RUN_S / servo_s) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;

    fn after(periods: u32, missed_mm: f64, following_mm: f64) -> Validity<2> {
        let mut validity = Validity::UNKNOWN;
        (0..periods).for_each(|_| validity.take_in([missed_mm, 0.0], [0.0, following_mm], [0.0; 2], SERVO_S));
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
        assert!(!Validity::<2>::UNKNOWN.is_wrong(0.0));
    }

    #[test]
    fn a_correction_comes_in_over_the_first_way_and_stays() {
        let mut validity = after(100, 0.0, 0.0);
        let mut at = |x_mm: f64| {
            validity.take_in([0.0; 2], [0.0; 2], [x_mm, 0.0], SERVO_S);
            validity.taken_up(0.0)
        };
        let [begin, middle, end, back] = [0.0, 0.025, 0.0501, 0.0].map(&mut at);
        assert_eq!([begin, end, back], [0.0, 1.0, 1.0]);
        assert!((middle - 0.5).abs() < 1e-9, "{middle}");
        // Four standard deviations of 10 um take 20 times as long.
        assert!(validity.taken_up(1e-4) < 0.01);
    }
}
