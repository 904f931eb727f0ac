//! Question: does the nominal model explain an axis as well as the learned one?
//!
//! Both models run freely beside their filters, from the states of these filters on, and miss the
//! measurement by m:
//!
//! ```text
//! l <- l + ln (<m^2> + e^2) / (<m_learned^2> + e^2)        over a free run
//! e^2 = (0.1 um)^2 + 16 variances of the measurement + the mean square error of a free run by unforeseen loads
//! ```
//!
//! The learned model is followed from l = 6.9 on, and no longer below 0: of correct nominal models,
//! one in a thousand is replaced (Wald). Where another axis of the machine follows its learned
//! model, one in a hundred, l = 4.6: with a correct model in one axis and a wrong one in the other,
//! the axes lag by different times. With 2.3 in place of 6.9, 36 cuts with wrong models leave 0.069
//! of the error in the median in place of 0.087, and with 0 one of them is worse. A run counts once,
//! however long: its error at its end stems from its beginning. Every 4 ms the run is checked: a
//! run that alone is sufficient evidence for the learned model counts at once. l counts up to 13.8
//! (Page), so that a change is noticed. A learned model that is certainly worse is begun anew. A
//! nominal model whose errors are within the noise stays as it is to the bit.
//!
//! Evidence: l, the logarithm of the likelihood ratio of the learned model and the nominal one.
//!
//! Rejected alternatives: innovations in place of free runs rejected correct models, because steps
//! of an encoder are not white noise. A single filter with the nominal model, whose innovations are
//! computed, cannot decide: its own first order states that they are large. Where both models miss
//! alike, by a load that neither has, l is a random walk, which reaches 6.9 sooner or later: along
//! 20 programs recorded in LinuxCNC, a model identified on `tnv40` left 0.063 and 0.059 of the error
//! in two, and 0.023 and 0.010 where it was kept. With d^2 / 2 subtracted in each run, where d is
//! the logarithm, l hardly reaches it (de la Pena, 1999). But then one of the cuts with models of
//! other machines is worse (linuxcnc/servo/tests/property_wrong_model.rs).
//!
//! Source: Wald (1947), Sequential Analysis, and Page (1954), Continuous inspection schemes,
//! Biometrika 41.

use crate::vector::bounded;

use super::one_step::run_periods;

/// l above which the learned model is followed: of correct nominal models, one in a thousand is
/// replaced.
const CERTAIN: f64 = 6.9;
/// The same where another axis follows its learned model: one in a hundred.
const LIKELY: f64 = 4.6;
/// Largest l, and its largest change at once.
const MOST_CERTAIN: f64 = 2.0 * CERTAIN;
const MOST_OF_RUN: f64 = 7.0;
/// Time between two checks of the free runs, s.
const COMPARED_S: f64 = 0.004;

/// Consequence of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct ModelChange {
    /// True if the other model is followed from now on.
    pub(crate) turns: bool,
    /// True if the learned model is the nominal one again.
    pub(crate) begins_anew: bool,
}

/// Present choice, and errors of the free runs of the two models.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ModelChoice {
    /// Mean square error of a servo period by the encoder and unforeseen loads, rad^2.
    noise_rad2: f64,
    /// Servo periods between two checks, and of a free run.
    compared_periods: u32,
    run_periods: u32,
    /// True if the learned model is followed.
    is_learned: bool,
    /// Sums of squares of the followed model and of the other one, rad^2, and the length of these
    /// runs, servo periods.
    missed_rad2: [f64; 2],
    periods: u32,
    /// l before these runs, and l with their evidence.
    before: f64,
    likelihood: f64,
}

impl ModelChoice {
    /// Chooses the nominal model, before any measurement.
    pub(crate) fn nominal(noise_rad2: f64, servo_s: f64) -> Self {
        Self {
            noise_rad2,
            // The cast saturates where the float is too large or NaN.
            compared_periods: (libm::round(COMPARED_S / servo_s) as u32).max(1),
            run_periods: run_periods(servo_s),
            is_learned: false,
            missed_rad2: [0.0; 2],
            periods: 0,
            before: 0.0,
            likelihood: 0.0,
        }
    }

    /// Returns true if the learned model is followed.
    pub(crate) fn is_learned(&self) -> bool {
        self.is_learned
    }

    /// Takes in the errors of the free runs of the followed model and of the other one in a servo
    /// period, rad. `is_likely` is true where another axis of the machine follows its learned
    /// model.
    pub(crate) fn take_in(
        &mut self,
        missed_rad: [f64; 2],
        moves: bool,
        is_likely: bool,
    ) -> ModelChange {
        let was_learned = self.is_learned;
        let [followed_rad, other_rad] = missed_rad;
        let learned_rad = if was_learned { followed_rad } else { other_rad };
        if !learned_rad.is_finite() {
            self.likelihood = -CERTAIN;
        } else if moves {
            self.missed_rad2
                .iter_mut()
                .zip(missed_rad)
                .for_each(|(sum, rad)| *sum += rad * rad);
            self.periods += 1;
            let is_over = self.periods >= self.run_periods;
            if is_over || self.periods.is_multiple_of(self.compared_periods) {
                self.look(is_over);
            }
        }
        let needed = if was_learned {
            0.0
        } else if is_likely {
            LIKELY
        } else {
            CERTAIN
        };
        self.is_learned = self.likelihood > needed;
        let turns = was_learned != self.is_learned;
        let begins_anew = was_learned && turns || self.likelihood <= -CERTAIN;
        ModelChange { turns, begins_anew }
    }

    /// Evaluates the errors of the runs. Unfinished runs count only if they alone are sufficient
    /// evidence for the learned model.
    fn look(&mut self, is_over: bool) {
        let explained_rad2 = f64::from(self.periods) * self.noise_rad2;
        let [followed, other] = self.missed_rad2.map(|rad2| rad2 + explained_rad2);
        let likelier = libm::log(if self.is_learned {
            other / followed
        } else {
            followed / other
        });
        let likelier = if likelier.is_nan() {
            -MOST_OF_RUN
        } else {
            bounded(likelier, -MOST_OF_RUN, MOST_OF_RUN)
        };
        if is_over || likelier >= CERTAIN {
            self.likelihood = bounded(self.before + likelier, -CERTAIN, MOST_CERTAIN);
        }
        if is_over {
            (self.missed_rad2, self.periods, self.before) = ([0.0; 2], 0, self.likelihood);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns l after a number of comparisons. The nominal model misses by the first angle, the
    /// learned one by the second, rad; noise is 1 rad.
    fn after(times: u32, [nominal_rad, learned_rad]: [f64; 2]) -> f64 {
        let mut choice = ModelChoice::nominal(1.0, 0.001);
        for _ in 0..times {
            (choice.missed_rad2, choice.periods) =
                ([nominal_rad * nominal_rad, learned_rad * learned_rad], 1);
            choice.look(true);
        }
        choice.likelihood
    }

    #[test]
    fn two_models_that_differ_by_what_noise_explains_are_not_distinguished_soon() {
        assert!(after(10, [0.5, 0.1]) < CERTAIN);
        assert_eq!(after(100, [1.0, 1.0]), 0.0);
        assert!(
            after(1, [100.0, 0.0]) > CERTAIN,
            "one run is enough where the evidence is that strong"
        );
        assert!(
            after(1, [20.0, 0.0]) < CERTAIN && after(2, [20.0, 0.0]) > CERTAIN,
            "and two are soon"
        );
        assert_eq!(after(100, [1.0, 100.0]), -CERTAIN);
        assert_eq!(after(2, [1.0, f64::NAN]), -CERTAIN);
        assert_eq!(after(100, [100.0, 1.0]), MOST_CERTAIN);
    }

    #[test]
    fn a_learned_model_that_is_followed_is_judged_the_other_way_round() {
        let mut choice = ModelChoice {
            is_learned: true,
            missed_rad2: [1e4, 0.0],
            periods: 1,
            ..ModelChoice::nominal(1.0, 0.001)
        };
        choice.look(true);
        assert_eq!(choice.likelihood, -CERTAIN);
    }
}
