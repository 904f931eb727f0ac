//! Question: does the model predict what the axis does? A wrong model makes a regulator swing, and
//! its filter interprets the swing as loads.
//!
//! ```text
//! m  measured position minus the position of a free run of the model, restarted every 30 ms from the state of the filter
//! o  distance of the open loop from the reference, without loads; the largest of the last 30 ms, because m depends on all of them
//!
//! max <m^2> > (2 um)^2 + (4 s)^2 + <o^2>     over the last 20 ms, m of the axis with the largest one: the model is wrong
//! ```
//!
//! if that holds in two free runs in a row, or in one by twice as much. A single run may have begun
//! with a speed from the steps of an encoder: a wrong model misses in each run.
//!
//! Evidence: the root mean square of m and its limit.
//!
//! s is the motion of the axis in a free run by noise and unforeseen loads, by the statistics.
//! Where innovations are larger than that, an encoder is coarser than known: their contribution to
//! m, if they are white, is added with three deviations.
//!
//! A model that misses more than the error to correct leaves a larger error than no correction; a
//! model that misses less leaves a smaller one. The first motion is corrected in full: a correction
//! that engaged over the first 50 um left 13.8 um of the figure of eight on `workshop` in place of
//! 0.4, and took 21 N m in place of 10.5. A wrong inertia shows where the speed changes, and not on
//! the straight line after it: a wrong model stays wrong until it has held while the commanded
//! speed changed as much as then (`readmission.rs`). A learned model
//! (`controller/lqg_identified/learning.rs`) replaces the nominal one without this record.
//!
//! A model has little weight and requests little if it has just begun, is not followed, is wrong,
//! or if servo periods deviate from it (`one_step.rs`); the weight rises in 0.3 s. With full weight
//! from the beginning, the way back after a lost position takes up to 44,000 mm/s^2 on `tnv40`, and
//! with the model of another machine three of 28 cuts are worse, one five times.
//!
//! In place of o, a twentieth of the following error, which feedforward makes small, disengaged the
//! correction in 97 of 108 cuts on `workshop` with models whose gains, inertia, friction or delay
//! were a few percent off. On 424 such cuts of four machines o / 2 leaves 0.37 of the error in the
//! median, o 0.31, and 2 o 0.25, but makes 12 cuts worse in place of 5; all without learning. With
//! an average over 5 ms, references that happen to be up to 1 ms late make a model wrong.
//!
//! Source: the free run as in Ljung (1999), System Identification, section 16.6, where models are
//! validated by simulation; the rule is our own.

use crate::command::{FaultEvidence, Verdict};
use crate::vector::{bounded, dot, smooth_step};

use super::one_step::{Course, FALL_S, OneStep, RUN_S};
use super::readmission::Readmission;
use super::{DEVIATIONS, NO_ERROR_MM2};

/// Time over which m^2 is averaged, s.
const MEMORY_S: f64 = 0.02;
/// Standard deviations of the part that the innovations show, if they are white. The innovations of
/// a wrong model are alike, and add up to 5 of them.
const SHOWN_DEVIATIONS: f64 = 3.0;
/// Time in motion after which a model that becomes wrong indicates a changed machine, s.
const CHANGED_S: f64 = 1.0;
/// Factor on the permitted m at which one free run is enough.
const FAR: f64 = 2.0;

/// Weights of a model, both 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ModelWeights {
    /// Weight of the model near the reference: at 1 the regulator uses its lowest control weight.
    pub(crate) near: f64,
    /// Weight of the loads that the filter finds with the model.
    pub(crate) loads: f64,
}

impl ModelWeights {
    /// Full weight.
    pub(crate) const FULLY: Self = Self {
        near: 1.0,
        loads: 1.0,
    };
}

/// Result of a servo period of all axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shown<const N: usize> {
    /// m, mm.
    pub(crate) missed_mm: [f64; N],
    /// o, mm.
    pub(crate) open_mm: [f64; N],
    /// Mean square of m from the last innovations, if they are white, mm^2.
    pub(crate) by_noise_mm2: f64,
    /// Position that the plan commands, mm.
    pub(crate) path_mm: [f64; N],
    /// True if the plan moves.
    pub(crate) moves: bool,
}

/// Validity of the models of all axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Validity<const N: usize> {
    /// Permitted m^2 at any time, mm^2.
    always_mm2: f64,
    missed_mm2: f64,
    open_mm2: f64,
    largest_open_mm2: f64,
    by_noise_mm2: f64,
    /// True if m was larger than permitted in this free run and in the last one, and the time since
    /// this one began, s.
    beyond: [bool; 2],
    for_s: f64,
    readmission: Readmission<N>,
    course: Course,
    /// Weight of the models near the reference, 0 to 1.
    near: f64,
    /// Time for which the models have held in motion, s, and whether they have just become wrong
    /// after a long enough time.
    held_s: f64,
    has_changed: bool,
}

impl<const N: usize> Validity<N> {
    /// Creates the validity before any motion, of models whose mean square error by noise and
    /// unforeseen loads is `unforeseen_mm2`.
    pub(crate) fn unknown(unforeseen_mm2: f64) -> Self {
        Self {
            always_mm2: NO_ERROR_MM2 + DEVIATIONS * DEVIATIONS * unforeseen_mm2,
            missed_mm2: 0.0,
            open_mm2: 0.0,
            largest_open_mm2: 0.0,
            by_noise_mm2: 0.0,
            beyond: [false; 2],
            for_s: 0.0,
            readmission: Readmission::NOT_NEEDED,
            course: Course::AS_SAID,
            near: 0.0,
            held_s: 0.0,
            has_changed: false,
        }
    }

    /// Forgets all results.
    pub(crate) fn forget(&mut self) {
        *self = Self {
            always_mm2: self.always_mm2,
            ..Self::unknown(0.0)
        };
    }

    /// Restarts for other models: the errors of the earlier ones give no evidence on them.
    pub(crate) fn begin_model(&mut self) {
        (self.missed_mm2, self.beyond, self.readmission) =
            (0.0, [false; 2], Readmission::NOT_NEEDED);
        // The tool returns gently from its present place.
        self.near = 0.0;
    }

    /// Takes in the agreement within a servo period, before [`Self::take_in`].
    pub(crate) fn take_in_step(&mut self, step: OneStep, servo_s: f64) {
        self.course.take_in(step, servo_s);
    }

    /// Takes in a servo period.
    pub(crate) fn take_in(&mut self, shown: &Shown<N>, followed: bool, servo_s: f64) {
        let Shown {
            missed_mm,
            open_mm,
            by_noise_mm2,
            path_mm,
            moves,
        } = *shown;
        let part = (servo_s / MEMORY_S).min(1.0);
        self.missed_mm2 += part * (largest_square(missed_mm) - self.missed_mm2);
        self.by_noise_mm2 += part * (by_noise_mm2 - self.by_noise_mm2);
        self.open_mm2 += part * (dot(open_mm, open_mm) - self.open_mm2);
        let kept_mm2 = (1.0 - servo_s / RUN_S).max(0.0) * self.largest_open_mm2;
        self.largest_open_mm2 = self.open_mm2.max(kept_mm2);
        self.for_s += servo_s;
        if self.for_s >= RUN_S {
            (self.for_s, self.beyond) = (0.0, [false, self.beyond[0]]);
        }
        self.beyond[0] |= self.is_beyond(1.0);
        self.readmission
            .take_in(path_mm, moves, self.misses(), servo_s);
        let holds = followed && self.course.is_as_said() && !self.misses();
        let change = if holds {
            servo_s / self.course.rise_time_s()
        } else {
            -servo_s / FALL_S
        };
        self.near = bounded(self.near + change, 0.0, 1.0);
        let is_wrong = self.is_wrong();
        self.has_changed = is_wrong && self.held_s > CHANGED_S;
        self.held_s = if is_wrong {
            0.0
        } else {
            self.held_s + if moves { servo_s } else { 0.0 }
        };
    }

    /// Returns true if the machine has changed: models that have held for long are wrong from this
    /// servo period on.
    pub(crate) fn has_machine_changed(&self) -> bool {
        self.has_changed
    }

    /// Returns true if free runs miss more than permitted: twice in a row, or once by far.
    fn misses(&self) -> bool {
        self.is_beyond(FAR) || self.beyond == [true; 2]
    }

    /// Returns true if m is larger than `times` times the permitted value. NaN counts as larger.
    fn is_beyond(&self, times: f64) -> bool {
        let holds = self.missed_mm2 <= times * times * self.allowed_mm2();
        !holds
    }

    /// Returns the permitted m^2, mm^2: noise plus the error to correct.
    fn allowed_mm2(&self) -> f64 {
        self.always_mm2
            + SHOWN_DEVIATIONS * SHOWN_DEVIATIONS * self.by_noise_mm2
            + self.largest_open_mm2
    }

    /// Returns the weights of the models.
    pub(crate) fn model_weights(&self) -> ModelWeights {
        ModelWeights {
            near: smooth_step(self.near),
            loads: self.course.loads(),
        }
    }

    /// Returns true if the models are wrong.
    fn is_wrong(&self) -> bool {
        self.misses() || self.readmission.is_needed()
    }

    /// Returns the verdict on the models; its evidence is m and its permitted value.
    pub(crate) fn verdict(&self) -> Verdict {
        if self.misses() {
            let [found_mm, limit_mm] = [self.missed_mm2, self.allowed_mm2()].map(libm::sqrt);
            let evidence = Some(FaultEvidence { found_mm, limit_mm });
            Verdict::Wrong { evidence }
        } else if self.readmission.is_needed() {
            Verdict::Wrong { evidence: None }
        } else {
            Verdict::Sound
        }
    }
}

/// Returns the largest of the squares, or NaN if one is NaN.
fn largest_square<const N: usize>(vector: [f64; N]) -> f64 {
    let larger = |a: f64, b: f64| if a >= b || a.is_nan() { a } else { b };
    vector.iter().map(|x| x * x).fold(0.0, larger)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;

    fn shown([missed_mm, open_mm]: [f64; 2]) -> Shown<2> {
        let [missed_mm, open_mm] = [[missed_mm, 0.0], [0.0, open_mm]];
        Shown {
            missed_mm,
            open_mm,
            by_noise_mm2: 0.0,
            path_mm: [0.0; 2],
            moves: true,
        }
    }

    fn after(periods: u32, missed_and_open_mm: [f64; 2], unforeseen_mm2: f64) -> Validity<2> {
        let mut validity = Validity::unknown(unforeseen_mm2);
        (0..periods).for_each(|_| validity.take_in(&shown(missed_and_open_mm), true, SERVO_S));
        validity
    }

    #[test]
    fn a_model_is_wrong_where_it_misses_more_than_noise_and_the_error_to_correct() {
        for (missed_mm, open_mm, unforeseen_mm2, wrong) in [
            (0.0019, 0.0, 0.0, false),
            (0.0021, 0.0, 0.0, true),
            (0.0100, 0.01, 0.0, false),
            (0.0105, 0.01, 0.0, true),
            (0.039, 0.0, 1e-4, false),
            (0.041, 0.0, 1e-4, true),
            (f64::NAN, 1.0, 1.0, true),
        ] {
            let validity = after(200, [missed_mm, open_mm], unforeseen_mm2);
            assert_eq!(
                validity.is_wrong(),
                wrong,
                "{missed_mm} {open_mm} {unforeseen_mm2}"
            );
        }
        assert!(!Validity::<2>::unknown(0.0).is_wrong());
    }

    #[test]
    fn one_free_run_that_misses_may_be_chance_and_two_are_not() {
        let [once, twice, by_far] = [(25, 0.003), (45, 0.003), (25, 0.008)];
        let is_wrong = |(periods, missed_mm)| after(periods, [missed_mm, 0.0], 0.0).is_wrong();
        assert_eq!([once, twice, by_far].map(is_wrong), [false, true, true]);
    }

    #[test]
    fn what_was_missed_under_way_is_compared_with_what_there_was_to_correct_under_way() {
        let mut validity = after(200, [0.008, 0.01], 0.0);
        (0..5).for_each(|_| validity.take_in(&shown([0.008, 0.0]), true, SERVO_S));
        assert!(!validity.is_wrong(), "it has just come to rest");
        (0..60).for_each(|_| validity.take_in(&shown([0.008, 0.0]), true, SERVO_S));
        assert!(validity.is_wrong());
    }

    #[test]
    fn a_model_that_holds_and_is_followed_for_a_while_gets_its_full_weight() {
        let goes_on = |validity: &mut Validity<2>, missed_mm: f64, followed: bool, periods: u32| {
            (0..periods)
                .for_each(|_| validity.take_in(&shown([missed_mm, 0.0]), followed, SERVO_S));
            validity.model_weights().near
        };
        let mut validity = Validity::unknown(0.0);
        assert_eq!(
            goes_on(&mut validity, 0.0, false, 1000),
            0.0,
            "it is not followed"
        );
        assert!((goes_on(&mut validity, 0.0, true, 150) - 0.5).abs() < 1e-9);
        assert_eq!(goes_on(&mut validity, 0.0, true, 151), 1.0);
        assert_eq!(goes_on(&mut validity, 0.01, true, 10), 0.0, "it misses");
        assert_eq!(goes_on(&mut validity, f64::NAN, true, 10), 0.0);
        validity.forget();
        assert_eq!(goes_on(&mut validity, 0.0, true, 301), 1.0);
    }

    #[test]
    fn a_machine_has_changed_where_models_that_held_for_a_second_of_motion_are_wrong_and_once() {
        let changes = |held: u32, forgotten: bool| {
            let mut validity = after(held, [0.0; 2], 0.0);
            if forgotten {
                validity.forget();
            }
            (0..200)
                .filter(|_| {
                    validity.take_in(&shown([0.01, 0.0]), true, SERVO_S);
                    validity.has_machine_changed()
                })
                .count()
        };
        assert_eq!(
            [(1100, false), (900, false), (1100, true)]
                .map(|(held, forgotten)| changes(held, forgotten)),
            [1, 0, 0]
        );
    }
}
