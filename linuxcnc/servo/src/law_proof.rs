//! Checks the axis model against motion without a correction, before any correction uses the model.
//!
//! ```text
//! m  measured position less the position of the model axes, simulated along the same path
//! d  measured position less the path, taken as far back as these axes lag at constant speed
//! M, D  mean squares of m and d over motion without a correction
//! s^2   mean square that noise causes in a position, by the statistics of the model
//!
//! M <= (0.06)^2 D              from 20 ms of motion on: confirmed
//! M <= (0.15)^2 D              from 100 ms on
//! M <= (0.15)^2 D + 4 s^2      from 100 ms on, where D > 20 s^2
//! ```
//!
//! d is the error that a correction removes, and m is what the model gets wrong. A model that
//! predicts only a part of d does harm. The check needs motion that changes its speed: along a
//! straight line at constant speed d is zero.
//!
//! Below 2 um of d the model is neither confirmed nor rejected. Within the first second of motion
//! it is not rejected below 5 um either. It is never rejected where D is at most 20 s^2, which
//! means that noise may be a fifth of d.
//!
//! With the model of `tnv40` on LinuxCNC programs, sqrt(M / D) after 20 ms is at most:
//!
//! | Machine | sqrt(M / D) |
//! |---|--:|
//! | `tnv40` | 0.035 |
//! | twice the friction | 0.10 |
//! | 1.1 times the position-loop gain | 0.12 |
//! | 0.8 times the inertia | 0.14 |
//! | drive 1 ms late | 0.25 |
//! | drive 2 ms late, or twice the inertia | 0.5 |
//!
//! After 100 ms, a gain that is 10 % off gives 0.45 or more. An innovation, or a free run of 30 ms,
//! shows these errors only after the correction has done harm.
//!
//! The limits were chosen on seven programs with 20 wrong models of `tnv40`. With 0.25 in place of
//! 0.15, the model of `coarse` raises the RMS error of a square on `tnv40` from 10 to 18 um. With a
//! memory of 0.1 s, a model passes by chance on a machine with 0.8 times its inertia; with 1 s it
//! does not.
//!
//! Source: Ljung (1999), System Identification, section 16.6, compares the output of a simulation
//! without feedback with the measurement. Judging it against d is specific to feedwright.

/// Shares of d that may be missed, and the time of motion from which on they count, s.
const QUICK_SHARE: f64 = 0.06;
const QUICK_S: f64 = 0.02;
const SHARE: f64 = 0.15;
const SHOWN_S: f64 = 0.1;
/// Time over which squares are averaged, s.
const MEMORY_S: f64 = 1.0;
/// Times s^2 in M, and in the D that tells a wrong law from noise. The least D that proves a law (2 um), and that refutes one (5 um), mm^2.
const NOISE: f64 = 4.0;
const BEYOND_NOISE: f64 = 20.0;
const PROVES_MM2: f64 = 4e-6;
const REFUTES_MM2: f64 = 2.5e-5;

/// What motion without a correction has shown.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LawProof {
    /// s^2, mm^2.
    noise_mm2: f64,
    /// Time of motion, s.
    moved_s: f64,
    missed_mm2: f64,
    distance_mm2: f64,
    proven: bool,
}

impl LawProof {
    /// Nothing yet, where noise makes so much of a position, mm^2.
    pub(crate) fn new(noise_mm2: f64) -> Self {
        Self { noise_mm2, moved_s: 0.0, missed_mm2: 0.0, distance_mm2: 0.0, proven: false }
    }

    /// Whether the law has proven itself.
    pub(crate) fn is_proven(&self) -> bool {
        self.proven
    }

    /// Whether motion that would prove a law has not proven this one.
    pub(crate) fn is_refuted(&self) -> bool {
        let least_mm2 = if self.moved_s < MEMORY_S { REFUTES_MM2 } else { PROVES_MM2 };
        !self.proven && self.moved_s >= SHOWN_S && self.distance_mm2 >= least_mm2 && self.is_beyond_noise()
    }

    /// Nothing any more.
    pub(crate) fn forget(&mut self) {
        *self = Self::new(self.noise_mm2);
    }

    /// A servo period of motion without a correction, with m^2 and d^2.
    pub(crate) fn take_in(&mut self, missed_mm2: f64, distance_mm2: f64, servo_s: f64) {
        self.moved_s += servo_s;
        // At first the mean of all.
        let part = servo_s / self.moved_s.min(MEMORY_S);
        self.missed_mm2 += part * (missed_mm2 - self.missed_mm2);
        self.distance_mm2 += part * (distance_mm2 - self.distance_mm2);
        self.proven |= self.distance_mm2 >= PROVES_MM2 && self.holds();
    }

    fn is_beyond_noise(&self) -> bool {
        self.distance_mm2 > BEYOND_NOISE * self.noise_mm2
    }

    fn holds(&self) -> bool {
        let is_within =
            |share: f64, noise: f64| self.missed_mm2 <= share * share * self.distance_mm2 + noise * self.noise_mm2;
        let slowly = is_within(SHARE, if self.is_beyond_noise() { NOISE } else { 0.0 });
        (self.moved_s >= QUICK_S && is_within(QUICK_SHARE, 0.0)) || (self.moved_s >= SHOWN_S && slowly)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;

    /// State after `periods` servo periods with these m and d, mm.
    fn after(periods: u32, missed_mm: f64, distance_mm: f64, noise_mm: f64) -> LawProof {
        let mut proof = LawProof::new(noise_mm * noise_mm);
        (0..periods).for_each(|_| proof.take_in(missed_mm * missed_mm, distance_mm * distance_mm, SERVO_S));
        proof
    }

    #[test]
    fn the_share_that_may_be_missed_depends_on_the_time_of_motion() {
        for (periods, missed_mm, distance_mm, noise_mm, proven) in [
            (19, 0.0, 0.1, 0.0, false),
            (21, 0.0059, 0.1, 0.0, true),
            (99, 0.0061, 0.1, 0.0, false),
            (101, 0.0149, 0.1, 0.0, true),
            (5000, 0.0151, 0.1, 0.0, false),
            // Too little motion, and motion that noise hides.
            (5000, 0.0, 0.0019, 0.0, false),
            (5000, 0.03, 0.1, 0.02, true),
            (5000, 0.03, 0.1, 0.03, false),
        ] {
            let proof = after(periods, missed_mm, distance_mm, noise_mm);
            assert_eq!(proof.is_proven(), proven, "{periods} {missed_mm} {distance_mm} {noise_mm}");
        }
    }

    #[test]
    fn a_law_is_refuted_by_motion_that_would_have_proven_it() {
        for (periods, missed_mm, distance_mm, refuted) in [
            (90, 0.05, 0.1, false),
            (110, 0.05, 0.1, true),
            (110, 0.01, 0.1, false),
            (110, 0.004, 0.004, false),
            (1010, 0.004, 0.004, true),
        ] {
            assert_eq!(after(periods, missed_mm, distance_mm, 0.0).is_refuted(), refuted, "{periods} {missed_mm}");
        }
    }

    #[test]
    fn what_is_proven_stays_so_until_it_is_forgotten_and_what_is_no_number_proves_nothing() {
        let mut proof = after(30, 0.0, 0.1, 0.0);
        (0..1000).for_each(|_| proof.take_in(1.0, 0.01, SERVO_S));
        assert!(proof.is_proven());
        proof.forget();
        assert!(!proof.is_proven() && !proof.is_refuted());
        assert!(!after(5000, f64::NAN, 0.1, 0.0).is_proven());
        assert!(!after(5000, 0.0, f64::NAN, 0.0).is_proven());
    }
}
