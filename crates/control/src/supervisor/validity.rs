//! Whether the law is good enough for the loop. A law that is wrong makes a regulator swing, and
//! its filter takes that for loads.
//!
//! ```text
//! m  measured position less that of a free run by the law, restarted every 30 ms from what the filter has
//! o  by how much the open loop would be off the reference, without loads; the largest of the last 30 ms, since m stems from all of them
//!
//! max <m^2> > (2 um)^2 + (4 s)^2 + <o^2>     over the last 20 ms, m of the axis that misses most: the law is wrong
//! ```
//!
//! where that is so in two free runs in a row, or in one by twice as much. One alone may have begun
//! with a speed that the steps of an encoder made: a law that is wrong misses in each.
//!
//! s is what noise and loads that nobody foresees move the axis by in a free run, by the
//! statistics. Where innovations are larger than that, an encoder is coarser than it is known to
//! be: what they make of m, if they are white, is added with three deviations.
//!
//! A law that misses more than it is to correct leaves more than no correction would; one that
//! misses less leaves less. The first motion is corrected in full: a correction that came in over
//! the first 50 um left 13.8 um of the figure of eight on workshop in place of 0.4, and took 21 N m
//! in place of 10.5. A wrong inertia shows where the speed changes, and not on the straight line
//! behind: a law that was wrong is wrong until it has held while the commanded speed changed as
//! much as then (`proof.rs`). A law that was learned (`controller/lqg_preview/learning.rs`) takes
//! the place of the nominal one without the record of that.
//!
//! A law that has begun just now, that is not followed, that is wrong, or by which servo periods do
//! not go (`one_step.rs`) is not trusted, and asks for little; trust takes 0.3 s. With all of it
//! from the beginning, the way back behind a lost position takes up to 44,000 mm/s^2 on tnv40, and
//! by the law of another machine three of 28 cuts are worse, one five times.
//!
//! In place of o a twentieth of the following error, which feedforward makes small, took the
//! correction out of the loop in 97 of 108 cuts on workshop by laws whose gains, inertia, friction
//! or delay were a few parts in a hundred off. On 424 such cuts of four machines o / 2 leaves 0.37
//! of the error in the median, o 0.31, and 2 o 0.25, but makes 12 cuts worse in place of 5; all
//! without learning. Over 5 ms references that are up to 1 ms late by chance make a law wrong.
//!
//! Source: the free run as in Ljung (1999), System Identification, section 16.6, where models are
//! validated by simulation; the rule is our own.

use crate::command::FaultEvidence;
use crate::vector::{bounded, dot, smooth_step};

use super::one_step::{Course, OneStep, RUN_S, TO_DOUBT_S};
use super::proof::Proof;

/// Time over which what is missed is averaged, s.
const MEMORY_S: f64 = 0.02;
/// What may be missed without any noise, mm^2 (2 um).
const LEAST_MM2: f64 = 4e-6;
/// Standard deviations of what nobody foresees.
const DEVIATIONS: f64 = 4.0;
/// Standard deviations of what the innovations show, if they are white. Those of a law that is
/// wrong are alike, and add up to 5 of them.
const SHOWN_DEVIATIONS: f64 = 3.0;
/// Laws that have held in motion for longer than this, s, and are wrong then, are those of a
/// machine that has changed.
const CHANGED_S: f64 = 1.0;
/// Times what may be missed that are far more.
const FAR: f64 = 2.0;

/// How far a law is followed, both 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Trusted {
    /// Its lowest price.
    pub(crate) near: f64,
    /// Loads that the filter finds by it.
    pub(crate) loads: f64,
}

impl Trusted {
    /// In everything.
    pub(crate) const FULLY: Self = Self {
        near: 1.0,
        loads: 1.0,
    };
}

/// What the axes showed in a servo period.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shown<const N: usize> {
    /// m, mm.
    pub(crate) missed_mm: [f64; N],
    /// o, mm.
    pub(crate) open_mm: [f64; N],
    /// Mean square of m by the last innovations, if they are white, mm^2.
    pub(crate) by_noise_mm2: f64,
    /// Position that the plan commands, mm.
    pub(crate) path_mm: [f64; N],
    /// Whether the plan moves.
    pub(crate) moves: bool,
}

/// What is known of the laws of all axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Validity<const N: usize> {
    /// What may always be missed, mm^2.
    always_mm2: f64,
    missed_mm2: f64,
    open_mm2: f64,
    largest_open_mm2: f64,
    by_noise_mm2: f64,
    /// Whether more was missed than may be in this free run and in the last, and for how long this
    /// one goes, s.
    beyond: [bool; 2],
    for_s: f64,
    proof: Proof<N>,
    course: Course,
    /// How far the laws are trusted near the reference, 0 to 1.
    near: f64,
    /// For how long they have held in motion, s, and whether they have just come to be wrong behind
    /// long enough of that.
    held_s: f64,
    has_changed: bool,
}

impl<const N: usize> Validity<N> {
    /// Nothing yet, of laws that noise and loads that nobody foresees make miss by a mean square of
    /// `unforeseen_mm2`.
    pub(crate) fn unknown(unforeseen_mm2: f64) -> Self {
        Self {
            always_mm2: LEAST_MM2 + DEVIATIONS * DEVIATIONS * unforeseen_mm2,
            missed_mm2: 0.0,
            open_mm2: 0.0,
            largest_open_mm2: 0.0,
            by_noise_mm2: 0.0,
            beyond: [false; 2],
            for_s: 0.0,
            proof: Proof::NOT_NEEDED,
            course: Course::AS_SAID,
            near: 0.0,
            held_s: 0.0,
            has_changed: false,
        }
    }

    /// Nothing any more.
    pub(crate) fn forget(&mut self) {
        *self = Self {
            always_mm2: self.always_mm2,
            ..Self::unknown(0.0)
        };
    }

    /// The laws are others from now on: what the ones before them missed says nothing of them.
    pub(crate) fn begin_law(&mut self) {
        (self.missed_mm2, self.beyond, self.proof) = (0.0, [false; 2], Proof::NOT_NEEDED);
        // Where the tool is by then, it is led back gently.
        self.near = 0.0;
    }

    /// How a servo period went within itself, before [`Self::take_in`].
    pub(crate) fn take_in_step(&mut self, step: OneStep, servo_s: f64) {
        self.course.take_in(step, servo_s);
    }

    /// A servo period.
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
        self.proof.take_in(path_mm, moves, self.misses(), servo_s);
        let holds = followed && self.course.is_as_said() && !self.misses();
        let change = if holds {
            servo_s / self.course.trust_time_s()
        } else {
            -servo_s / TO_DOUBT_S
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

    /// Whether the machine has become another one: laws that have held for long are wrong from this
    /// servo period on.
    pub(crate) fn has_machine_changed(&self) -> bool {
        self.has_changed
    }

    /// Whether free runs miss more than they may: twice in a row, or once by far.
    fn misses(&self) -> bool {
        self.is_beyond(FAR) || self.beyond == [true; 2]
    }

    /// Whether so many times more is missed than noise and what there is to correct; what is not a
    /// number is.
    fn is_beyond(&self, times: f64) -> bool {
        let holds = self.missed_mm2 <= times * times * self.allowed_mm2();
        !holds
    }

    /// What may be missed, mm^2: what noise makes, and what there is to correct.
    fn allowed_mm2(&self) -> f64 {
        self.always_mm2
            + SHOWN_DEVIATIONS * SHOWN_DEVIATIONS * self.by_noise_mm2
            + self.largest_open_mm2
    }

    /// How far the laws are followed.
    pub(crate) fn trusted(&self) -> Trusted {
        Trusted {
            near: smooth_step(self.near),
            loads: self.course.loads(),
        }
    }

    /// Whether the laws are wrong.
    pub(crate) fn is_wrong(&self) -> bool {
        self.misses() || self.proof.is_needed()
    }

    /// What is missed, and what may be, where that is too much.
    pub(crate) fn doubt(&self) -> Option<FaultEvidence> {
        let [found_mm, limit_mm] = [self.missed_mm2, self.allowed_mm2()].map(libm::sqrt);
        self.misses()
            .then_some(FaultEvidence { found_mm, limit_mm })
    }
}

/// The largest of the squares; not a number where one is none.
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
    fn a_law_is_wrong_where_it_misses_more_than_noise_and_what_there_is_to_correct() {
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
    fn a_law_is_trusted_that_holds_and_is_followed_for_a_while() {
        let goes_on = |validity: &mut Validity<2>, missed_mm: f64, followed: bool, periods: u32| {
            (0..periods)
                .for_each(|_| validity.take_in(&shown([missed_mm, 0.0]), followed, SERVO_S));
            validity.trusted().near
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
    fn a_machine_has_changed_where_laws_that_held_for_a_second_of_motion_are_wrong_and_once() {
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
