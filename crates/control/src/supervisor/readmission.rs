//! Question: may a model be used again after it was wrong?
//!
//! ```text
//! c  change of the commanded speed: difference from its mean over the last 30 ms
//!
//! c0 largest c while the model was wrong
//!
//! c falls below c0 / 2, reaches 0.9 c0, and the model holds for 60 ms from there; or it holds for T at 0.9 c0
//! ```
//!
//! Evidence: the motion through which the model holds, measured by the change of the commanded speed.
//!
//! With three times the inertia in the model, every corner is wrong and every straight line in
//! between is right: such a model, accepted on the line, did harm in each corner again. On a
//! circle, where c is constant, time decides: T is 60 ms at first, and four times as long each time
//! that the model was wrong again, up to 1 s. With 1 s from the beginning, a model with twice the
//! friction leaves 15.5 um on a circle in place of 0.9, because the first 60 ms of a motion miss a
//! larger part of the following error than the rest. After a shock on a straight line only the time
//! counts.
//!
//! These times count only while the path moves: at rest every model holds.

use crate::vector::{add_scaled, norm, sub};

use super::one_step::RUN_S;

/// Time over which an error of the model shows, s: two free runs.
const TO_SHOW_S: f64 = 2.0 * RUN_S;
/// Largest T, s, and its growth factor.
const MOST_S: f64 = 1.0;
const AGAIN: f64 = 4.0;
/// Part of c0 that counts as reached, part below which c is small, and the c0 that counts as zero,
/// mm/s.
const AS_MUCH: f64 = 0.9;
const LITTLE: f64 = 0.5;
const NO_CHANGE_MM_S: f64 = 1.0;

/// Progress of the test since the model was last wrong.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ReadmissionTrial {
    /// True once c was small.
    calm: bool,
    /// Time since c was reached again, s, and time for which it was reached, s.
    since_s: Option<f64>,
    at_as_much_s: f64,
}

impl ReadmissionTrial {
    const BEGUN: Self = Self {
        calm: false,
        since_s: None,
        at_as_much_s: 0.0,
    };

    /// Takes in a servo period of motion with a c, of a model that was wrong at c0. Returns true if
    /// the model has held for long enough.
    fn holds_through(
        &mut self,
        change_mm_s: f64,
        wrong_mm_s: f64,
        needs_s: f64,
        servo_s: f64,
    ) -> bool {
        let as_much = change_mm_s >= AS_MUCH * wrong_mm_s;
        self.calm |= change_mm_s < LITTLE * wrong_mm_s;
        self.at_as_much_s += if as_much { servo_s } else { 0.0 };
        let begins = (as_much && self.calm) || wrong_mm_s < NO_CHANGE_MM_S;
        self.since_s = self
            .since_s
            .map(|since_s| since_s + servo_s)
            .or(begins.then_some(0.0));
        self.since_s > Some(TO_SHOW_S) || self.at_as_much_s > needs_s
    }
}

/// Changes of the commanded speed, while the model was wrong and since then.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Readmission<const N: usize> {
    path_mm: Option<[f64; N]>,
    /// `None` until the speed is known.
    mean_mm_s: Option<[f64; N]>,
    /// Largest recent c, and its value when the model was wrong.
    lately_mm_s: f64,
    wrong_mm_s: f64,
    /// True if the model has not passed the test yet; `needs_s` is T, s.
    needed: bool,
    needs_s: f64,
    trial: ReadmissionTrial,
}

impl<const N: usize> Readmission<N> {
    /// State of a model that was never wrong.
    pub(super) const NOT_NEEDED: Self = Self {
        path_mm: None,
        mean_mm_s: None,
        lately_mm_s: 0.0,
        wrong_mm_s: 0.0,
        needed: false,
        needs_s: TO_SHOW_S,
        trial: ReadmissionTrial::BEGUN,
    };

    /// Takes in a servo period in which the model is wrong or holds. At rest it gives no evidence
    /// that the model holds.
    pub(super) fn take_in(&mut self, path_mm: [f64; N], moves: bool, wrong: bool, servo_s: f64) {
        let part = (servo_s / RUN_S).min(1.0);
        let mut change_mm_s = 0.0;
        if let Some(last_mm) = self.path_mm.replace(path_mm) {
            let speed_mm_s = sub(path_mm, last_mm).map(|mm| mm / servo_s);
            // A program that begins in motion has no change yet.
            let mean_mm_s = self.mean_mm_s.unwrap_or(speed_mm_s);
            let off_mm_s = sub(speed_mm_s, mean_mm_s);
            self.mean_mm_s = Some(add_scaled(mean_mm_s, part, off_mm_s));
            change_mm_s = norm(off_mm_s);
        }
        self.lately_mm_s = change_mm_s.max((1.0 - part) * self.lately_mm_s);
        if wrong {
            (self.needed, self.trial) = (true, ReadmissionTrial::BEGUN);
            self.wrong_mm_s = self.wrong_mm_s.max(self.lately_mm_s);
        } else if self.needed && !moves {
            self.trial.calm |= change_mm_s < LITTLE * self.wrong_mm_s;
        } else if self.needed
            && self
                .trial
                .holds_through(change_mm_s, self.wrong_mm_s, self.needs_s, servo_s)
        {
            (self.needed, self.wrong_mm_s) = (false, 0.0);
            self.needs_s = (AGAIN * self.needs_s).min(MOST_S);
        }
    }

    /// Returns true if the model has not passed the test yet.
    pub(super) fn is_needed(&self) -> bool {
        self.needed
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;

    /// Along a line whose speed goes from 0 to 50 mm/s within 25 ms, 0.4 s each; `wrong` by the
    /// servo period.
    fn goes(corners: usize, wrong: impl Fn(usize) -> bool) -> Readmission<1> {
        let mut readmission = Readmission::NOT_NEEDED;
        let mut x_mm = 0.0;
        for n in 0..400 * corners {
            x_mm += 50.0 * SERVO_S * ((n % 400) as f64 / 25.0).min(1.0);
            readmission.take_in([x_mm], true, wrong(n), SERVO_S);
        }
        readmission
    }

    #[test]
    fn a_model_that_fails_where_the_speed_changes_has_to_hold_there() {
        assert!(!goes(1, |_| false).is_needed());
        assert!(
            goes(1, |n| (10..40).contains(&n)).is_needed(),
            "the straight line behind is not enough"
        );
        assert!(
            !goes(2, |n| (10..40).contains(&n)).is_needed(),
            "it has held through the second corner"
        );
        assert!(goes(3, |n| (10..40).contains(&(n % 400))).is_needed());
    }

    #[test]
    fn where_the_speed_changes_all_the_time_readmission_takes_longer_each_time() {
        let mut readmission = Readmission::NOT_NEEDED;
        let mut periods = 0;
        let mut holds_for = || {
            let mut after_s = 0.0;
            for n in 0_u32.. {
                let t_s = f64::from(periods) * SERVO_S;
                periods += 1;
                readmission.take_in([50.0 * t_s * t_s], true, n < 200, SERVO_S);
                if !readmission.is_needed() {
                    break;
                }
                after_s = f64::from(n.saturating_sub(200)) * SERVO_S;
            }
            after_s
        };
        for expected_s in [0.06, 0.24, 0.96, 1.0, 1.0] {
            let held_s = holds_for();
            assert!(
                (held_s - expected_s).abs() < 3.0 * SERVO_S,
                "{held_s} {expected_s}"
            );
        }
    }

    #[test]
    fn one_that_begins_in_motion_has_changed_nothing() {
        let mut readmission = Readmission::NOT_NEEDED;
        (0..100_u32)
            .for_each(|n| readmission.take_in([0.05 * f64::from(n)], true, n < 20, SERVO_S));
        assert!(!readmission.is_needed(), "a straight line is enough");
    }

    #[test]
    fn a_shock_on_a_straight_line_needs_no_readmission() {
        assert!(!goes(1, |n| (250..260).contains(&n)).is_needed());
    }

    #[test]
    fn at_rest_no_model_holds_through_anything() {
        let mut readmission = Readmission::<1>::NOT_NEEDED;
        (0..10_000).for_each(|n| readmission.take_in([0.0], false, n < 20, SERVO_S));
        assert!(readmission.is_needed());
        (0..70_u32).for_each(|n| readmission.take_in([0.05 * f64::from(n)], true, false, SERVO_S));
        assert!(!readmission.is_needed());
    }

    #[test]
    fn what_is_not_a_number_does_not_readmit() {
        let mut readmission = goes(1, |n| (10..40).contains(&n));
        readmission.take_in([f64::NAN], true, false, SERVO_S);
        assert!(readmission.is_needed());
    }
}
