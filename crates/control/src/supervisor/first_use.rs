//! Question: does the model belong to this machine? It is tested before its first use, in motion
//! without a correction.
//!
//! ```text
//! m  measured position minus the one of the axes by the model alone, simulated along the same path
//! d  measured position minus the path, taken as far back as these axes lag at constant speed
//!
//! <m^2> <= <d^2> / 4      after 20 ms of motion, where <d^2> > (2 um)^2 + 20 s^2: it is used
//! ```
//!
//! Evidence: mean squares of m and d.
//!
//! A correction removes d, and m remains: with a model that predicts half of d, a correction
//! removes at least half of it. s^2 is the variance of the position by noise. The test needs motion
//! that changes its speed: along a straight line d is zero.
//!
//! A model that has not passed the test is not used. A learned model that replaces it has to pass
//! the same test. Then the correction engages within [`IN_S`]: with 0.065 s a helix and a figure of
//! eight that begin where the machine stands are cut within 2.1 and 6 um, with 0.1 s the helix
//! within 3.9, with 0.03 s the eight within 17, because the axis is then ahead of its reference.
//!
//! Source: a simulation without feedback compared with the measurement as in Ljung (1999), System
//! Identification, section 16.6; the share is our own.

use crate::vector::bounded;

use super::NO_ERROR_MM2;

/// Largest share of d^2 that may remain as m^2.
const SHARE: f64 = 0.25;
/// Time of motion after which the test counts, s, and time over which squares are averaged, s.
const SHOWN_S: f64 = 0.02;
const MEMORY_S: f64 = 1.0;
/// Part of the smallest d^2 that counts, in variances of the noise.
const BEYOND_NOISE: f64 = 20.0;
/// Time in which the correction engages, s.
const IN_S: f64 = 0.065;

/// Results of motion without a correction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct FirstUse {
    /// Smallest d^2 that counts, mm^2.
    least_mm2: f64,
    moved_s: f64,
    missed_mm2: f64,
    distance_mm2: f64,
    is_shown: bool,
    share: f64,
}

impl FirstUse {
    /// Creates the test before any motion; `noise_mm2` is the variance of the position by noise,
    /// mm^2.
    pub(crate) fn new(noise_mm2: f64) -> Self {
        let least_mm2 = NO_ERROR_MM2 + BEYOND_NOISE * noise_mm2;
        Self {
            least_mm2,
            moved_s: 0.0,
            missed_mm2: 0.0,
            distance_mm2: 0.0,
            is_shown: false,
            share: 0.0,
        }
    }

    /// Forgets all results.
    pub(crate) fn forget(&mut self) {
        *self = Self {
            least_mm2: self.least_mm2,
            ..Self::new(0.0)
        };
    }

    /// Restarts an unfinished test for another model.
    pub(crate) fn begin_model(&mut self) {
        if !self.is_shown {
            (self.moved_s, self.missed_mm2, self.distance_mm2) = (0.0, 0.0, 0.0);
        }
    }

    /// Takes in a servo period, with m^2 and d^2 where the machine moves.
    pub(crate) fn take_in(&mut self, seen_mm2: Option<[f64; 2]>, servo_s: f64) {
        self.share = bounded(
            self.share + if self.is_shown { servo_s / IN_S } else { 0.0 },
            0.0,
            1.0,
        );
        let Some([missed_mm2, distance_mm2]) = seen_mm2.filter(|_| !self.is_shown) else {
            return;
        };
        self.moved_s += servo_s;
        // Until then the mean of all periods.
        let part = servo_s / self.moved_s.min(MEMORY_S);
        self.missed_mm2 += part * (missed_mm2 - self.missed_mm2);
        self.distance_mm2 += part * (distance_mm2 - self.distance_mm2);
        let is_enough = self.moved_s >= SHOWN_S && self.distance_mm2 > self.least_mm2;
        self.is_shown = is_enough && self.missed_mm2 <= SHARE * self.distance_mm2;
    }

    /// Returns true if the model has passed the test.
    pub(crate) fn is_shown(&self) -> bool {
        self.is_shown
    }

    /// Returns the part of the correction that is used, 0 to 1.
    pub(crate) fn share(&self) -> f64 {
        self.share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;

    fn after(periods: u32, [missed_mm, distance_mm, noise_mm]: [f64; 3]) -> FirstUse {
        let mut first = FirstUse::new(noise_mm * noise_mm);
        let seen_mm2 = Some([missed_mm * missed_mm, distance_mm * distance_mm]);
        (0..periods).for_each(|_| first.take_in(seen_mm2, SERVO_S));
        first
    }

    #[test]
    fn a_model_is_used_that_predicts_half_of_the_error_to_correct() {
        for (periods, seen_mm, is_shown) in [
            (19, [0.0, 0.1, 0.0], false),
            (21, [0.049, 0.1, 0.0], true),
            (5000, [0.051, 0.1, 0.0], false),
            // Too little motion, and motion that noise hides.
            (5000, [0.0, 0.0019, 0.0], false),
            (5000, [0.04, 0.1, 0.02], true),
            (5000, [0.04, 0.1, 0.03], false),
            (5000, [f64::NAN, 0.1, 0.0], false),
            (5000, [0.0, f64::NAN, 0.0], false),
        ] {
            assert_eq!(
                after(periods, seen_mm).is_shown(),
                is_shown,
                "{periods} {seen_mm:?}"
            );
        }
    }

    #[test]
    fn it_comes_in_gradually_and_what_was_shown_stays_so() {
        let mut first = after(21, [0.0, 0.1, 0.0]);
        assert!(first.share() < 0.05);
        (0..100).for_each(|_| first.take_in(Some([1.0, 0.0]), SERVO_S));
        first.begin_model();
        assert!(first.is_shown() && first.share() == 1.0);
        let mut refuted = after(1000, [0.1, 0.1, 0.0]);
        refuted.begin_model();
        (0..21).for_each(|_| refuted.take_in(Some([0.0, 0.01]), SERVO_S));
        assert!(
            refuted.is_shown(),
            "errors of the model before do not count"
        );
    }
}
