//! Whether the law is that of the axis. A law that is not is no use to a regulator that goes by it: the loop may swing, and the filter takes
//! that for loads.
//!
//! ```text
//! m  measured position less that of a free run by the law, restarted every 30 ms from what the filter has
//! f  following error: command less measured position; the largest of the last 30 ms, since m stems from all of them
//!
//! max <m^2> > (2 um)^2 + (4 s)^2 + <f^2> / 20^2     over the last 20 ms, m of the axis that misses most: the law is wrong
//! ```
//!
//! s is what noise and loads that nobody foresees move the axis by in a free run, by the statistics. As long as the law has shown nothing,
//! little is risked: the correction comes in over the first way, 25 times as long as what may be missed. A wrong inertia shows where the speed
//! changes, and not on the straight line behind: a law that was wrong is wrong until it has held while the commanded speed changed as much as then
//! (`proof.rs`).
//!
//! A law that has begun just now, that is not followed, that is wrong, or by which servo periods do not go (`one_step.rs`) is
//! not trusted, and asks for little; trust takes 0.3 s.
//! With all of it from the beginning, the way back behind a lost position takes up to 44,000 mm/s^2 on tnv40, and by the law of another machine
//! three of 28 cuts are worse, one five times.
//!
//! Of 134 cuts on machines whose inertia, friction and gains are up to three times larger or smaller, that are late, or soft, 120 were worse than uncorrected by
//! the law of another machine, by up to 1.4 mm; now two are, by 2.1 times at the most. With 15 times as long four are, by 2.8.
//!
//! Against g, the way by which the offset has moved the tool by the law, in place of f: with g / 2 a law with gains, inertia and friction 10 %
//! off, which leaves a tenth of the error of the uncorrected cut, counts as wrong. With f / 10 a drive that is 2 ms late is found at the second corner of a square
//! and not at the start, and an offset that fades in a corner leads the tool off; the same with the sum of m^2 over the axes, which is more in a corner
//! than at a start. Over 5 ms references that are up to 1 ms late by chance make a law wrong, and leave 1.2 um in place of 0.3. With the f of the moment a law counts as wrong where an axis comes to rest.
//!
//! Source: the free run as in Ljung (1999), System Identification, section 16.6, where models are validated by simulation; the rule is our own.

use crate::vector::{bounded, dot, norm, smooth_step, sub};

use super::approach::Trusted;
use super::estimate::{AxisModel, Estimate, Sent};
use super::one_step::{Course, OneStep, TO_DOUBT_S};
use super::proof::Proof;

/// Time of a free run, s: about the time constant of a usual position loop.
const RUN_S: f64 = 0.03;
/// Time over which what is missed is averaged, s.
const MEMORY_S: f64 = 0.02;
/// What may be missed without any noise, mm^2 (2 um).
const LEAST_MM2: f64 = 4e-6;
/// Standard deviations of what nobody foresees, and the part of the following error.
const DEVIATIONS: f64 = 4.0;
const FOLLOWING_SHARE: f64 = 0.05;
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

/// What the axes showed in a servo period.
#[derive(Debug, Clone, Copy)]
pub(super) struct Shown<const N: usize> {
    /// m, mm.
    pub(super) missed_mm: [f64; N],
    /// f, mm.
    pub(super) following_mm: [f64; N],
    /// Measured position, mm.
    pub(super) position_mm: [f64; N],
    /// Position that the plan commands, mm.
    pub(super) path_mm: [f64; N],
}

/// What is known of the laws of all axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Validity<const N: usize> {
    /// What may always be missed, mm^2.
    always_mm2: f64,
    missed_mm2: f64,
    following_mm2: f64,
    largest_following_mm2: f64,
    proof: Proof<N>,
    /// Where it began, and how far from there it has been, mm.
    began_mm: Option<[f64; N]>,
    farthest_mm: f64,
    course: Course,
    /// How far the laws are trusted near the reference, 0 to 1.
    near: f64,
}

impl<const N: usize> Validity<N> {
    /// Nothing yet, of laws that noise and loads that nobody foresees make miss by a mean square of `unforeseen_mm2`.
    pub(super) fn unknown(unforeseen_mm2: f64) -> Self {
        Self {
            always_mm2: LEAST_MM2 + DEVIATIONS * DEVIATIONS * unforeseen_mm2,
            missed_mm2: 0.0,
            following_mm2: 0.0,
            largest_following_mm2: 0.0,
            proof: Proof::NOT_NEEDED,
            began_mm: None,
            farthest_mm: 0.0,
            course: Course::AS_SAID,
            near: 0.0,
        }
    }

    /// Nothing any more.
    pub(super) fn forget(&mut self) {
        *self = Self { always_mm2: self.always_mm2, ..Self::unknown(0.0) };
    }

    /// How a servo period went within itself, before [`Self::take_in`].
    pub(super) fn take_in_step(&mut self, step: OneStep, servo_s: f64) {
        self.course.take_in(step, servo_s);
    }

    /// A servo period.
    pub(super) fn take_in(&mut self, shown: &Shown<N>, followed: bool, servo_s: f64) {
        let Shown { missed_mm, following_mm, position_mm, path_mm } = *shown;
        let part = (servo_s / MEMORY_S).min(1.0);
        self.missed_mm2 += part * (largest_square(missed_mm) - self.missed_mm2);
        self.following_mm2 += part * (dot(following_mm, following_mm) - self.following_mm2);
        let kept_mm2 = (1.0 - servo_s / RUN_S).max(0.0) * self.largest_following_mm2;
        self.largest_following_mm2 = self.following_mm2.max(kept_mm2);
        self.proof.take_in(path_mm, self.misses(), servo_s);
        let began_mm = *self.began_mm.get_or_insert(position_mm);
        self.farthest_mm = self.farthest_mm.max(norm(sub(position_mm, began_mm)));
        let holds = followed && self.course.is_as_said() && !self.misses();
        let change = if holds { servo_s / self.course.trust_time_s() } else { -servo_s / TO_DOUBT_S };
        self.near = bounded(self.near + change, 0.0, 1.0);
    }

    /// Whether more is missed than noise and a part of the following error; what is not a number is.
    fn misses(&self) -> bool {
        let may_mm2 = self.always_mm2 + FOLLOWING_SHARE * FOLLOWING_SHARE * self.largest_following_mm2;
        let holds = self.missed_mm2 <= may_mm2;
        !holds
    }

    /// How far the laws are followed.
    pub(super) fn trusted(&self) -> Trusted {
        Trusted { near: smooth_step(self.near), loads: self.course.loads() }
    }

    /// Whether the laws are wrong.
    pub(super) fn is_wrong(&self) -> bool {
        self.misses() || self.proof.is_needed()
    }

    /// The part of the correction that is followed.
    pub(super) fn taken_up(&self) -> f64 {
        smooth_step((self.farthest_mm / (PROVEN * libm::sqrt(self.always_mm2))).min(1.0))
    }
}

/// The largest of the squares; not a number where one is none.
fn largest_square<const N: usize>(vector: [f64; N]) -> f64 {
    let larger = |a: f64, b: f64| if a >= b || a.is_nan() { a } else { b };
    vector.iter().map(|x| x * x).fold(0.0, larger)
}

/// Servo periods of a free run.
pub(super) fn run_periods(servo_s: f64) -> u32 {
    libm::ceil(RUN_S / servo_s) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;

    /// At a place of the first axis, mm.
    fn shown([missed_mm, following_mm]: [f64; 2], x_mm: f64) -> Shown<2> {
        Shown {
            missed_mm: [missed_mm, 0.0],
            following_mm: [0.0, following_mm],
            position_mm: [x_mm, 0.0],
            path_mm: [0.0; 2],
        }
    }

    fn after(periods: u32, missed_and_following_mm: [f64; 2], unforeseen_mm2: f64) -> Validity<2> {
        let mut validity = Validity::unknown(unforeseen_mm2);
        (0..periods).for_each(|_| validity.take_in(&shown(missed_and_following_mm, 0.0), true, SERVO_S));
        validity
    }

    #[test]
    fn a_law_is_wrong_where_it_misses_more_than_noise_and_a_twentieth_of_the_following_error() {
        for (missed_mm, following_mm, unforeseen_mm2, wrong) in [
            (0.0019, 0.0, 0.0, false),
            (0.0021, 0.0, 0.0, true),
            (0.0100, 0.2, 0.0, false),
            (0.0105, 0.2, 0.0, true),
            (0.039, 0.0, 1e-4, false),
            (0.041, 0.0, 1e-4, true),
            (f64::NAN, 1.0, 1.0, true),
        ] {
            let validity = after(200, [missed_mm, following_mm], unforeseen_mm2);
            assert_eq!(validity.is_wrong(), wrong, "{missed_mm} {following_mm} {unforeseen_mm2}");
        }
        assert!(!Validity::<2>::unknown(0.0).is_wrong());
    }

    #[test]
    fn what_was_missed_under_way_is_compared_with_the_following_error_under_way() {
        let mut validity = after(200, [0.008, 0.2], 0.0);
        (0..5).for_each(|_| validity.take_in(&shown([0.008, 0.0], 0.0), true, SERVO_S));
        assert!(!validity.is_wrong(), "it has just come to rest");
        (0..60).for_each(|_| validity.take_in(&shown([0.008, 0.0], 0.0), true, SERVO_S));
        assert!(validity.is_wrong());
    }

    #[test]
    fn a_law_is_trusted_that_holds_and_is_followed_for_a_while() {
        let goes_on = |validity: &mut Validity<2>, missed_mm: f64, followed: bool, periods: u32| {
            (0..periods).for_each(|_| validity.take_in(&shown([missed_mm, 0.0], 0.0), followed, SERVO_S));
            validity.trusted().near
        };
        let mut validity = Validity::unknown(0.0);
        assert_eq!(goes_on(&mut validity, 0.0, false, 1000), 0.0, "it is not followed");
        assert!((goes_on(&mut validity, 0.0, true, 150) - 0.5).abs() < 1e-9);
        assert_eq!(goes_on(&mut validity, 0.0, true, 151), 1.0);
        assert_eq!(goes_on(&mut validity, 0.01, true, 10), 0.0, "it misses");
        assert_eq!(goes_on(&mut validity, f64::NAN, true, 10), 0.0);
        validity.forget();
        assert_eq!(goes_on(&mut validity, 0.0, true, 301), 1.0);
    }

    #[test]
    fn a_correction_comes_in_over_the_first_way_and_stays() {
        let goes = |unforeseen_mm2: f64, to_mm: &[f64]| {
            let mut validity = after(100, [0.0, 0.0], unforeseen_mm2);
            to_mm.iter().for_each(|x_mm| validity.take_in(&shown([0.0; 2], *x_mm), true, SERVO_S));
            validity.taken_up()
        };
        let [begin, middle, end, back] = [0, 1, 2, 3].map(|n| goes(0.0, &[0.0, 0.025, 0.0501, 0.0][..=n]));
        assert_eq!([begin, end, back], [0.0, 1.0, 1.0]);
        assert!((middle - 0.5).abs() < 1e-9, "{middle}");
        // Four standard deviations of 10 um take 20 times as long.
        assert!(goes(1e-4, &[0.0501]) < 0.01);
    }
}
