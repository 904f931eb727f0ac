//! Keeps the correction out once the same cause has taken it out of the loop twice, until the
//! operator resets it.
//!
//! A wrong model fails in every corner. Each time, the supervisor lets the correction back in after
//! a while, and the axes are moved off the path and back. The second time, waiting shows nothing
//! new: somebody has to look at the machine or at the model.
//!
//! The count starts anew where the correction has held for [`FORGIVEN_S`] of motion, where another
//! cause takes it out, and the first time that each axis uses a model learned in motion: the
//! earlier faults belong to another model. With twice the inertia from one servo period to the
//! next, a circle takes the correction out twice before both axes have learned, and never again. A
//! lost position is nobody's fault and does not count. The latch is reset when the correction is
//! switched off and on again, or when the amplifiers were off.

use feedwright_control::{Cause, FORGIVEN_S, Fade};

/// Times in a row that one cause takes the correction out, after which it stays out.
const LATCHES: u32 = 2;

/// The last causes, and whether they keep the correction out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Latch<const N: usize> {
    cause: Option<Cause>,
    times: u32,
    /// Axes that have gone by what they learned.
    learned: [bool; N],
    /// Number of the last fade that was taken in.
    count: u32,
    /// Motion in the loop since, s.
    held_s: f64,
}

impl<const N: usize> Latch<N> {
    /// Nothing has taken the correction out.
    pub(crate) const OPEN: Self = Self {
        cause: None,
        times: 0,
        learned: [false; N],
        count: 0,
        held_s: 0.0,
    };

    /// Takes in a servo period: the last fade of the supervisor, the axes that go by what they
    /// learned, and the time for which the correction was in the loop in motion, s.
    pub(crate) fn take_in(&mut self, left: Option<Fade>, learned: [bool; N], held_s: f64) {
        self.held_s += held_s;
        let count = left.map_or(0, |left| left.count);
        let is_new = count > self.count;
        self.count = count;
        if self.latched().is_some() {
            return;
        }
        for (known, learned) in self.learned.iter_mut().zip(learned) {
            if learned && !*known {
                (*known, self.times) = (true, 0);
            }
        }
        let Some(cause) = left
            .map(|left| left.cause)
            .filter(|cause| is_new && *cause != Cause::LostFeedback)
        else {
            return;
        };
        let again = self.cause == Some(cause) && self.held_s <= FORGIVEN_S;
        self.times = if again { self.times + 1 } else { 1 };
        (self.cause, self.held_s) = (Some(cause), 0.0);
    }

    /// Lets the correction in again. The last fade stays the one that was taken in.
    pub(crate) fn reset(&mut self) {
        *self = Self {
            count: self.count,
            ..Self::OPEN
        };
    }

    /// Returns the cause that keeps the correction out; none while it may come back.
    pub(crate) fn latched(&self) -> Option<Cause> {
        self.cause.filter(|_| self.times >= LATCHES)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SERVO_S: f64 = 0.001;
    const NOTHING: [bool; 2] = [false; 2];

    /// Returns the latch after faults, with this time of motion in the loop before each, s.
    fn after(faults: &[(Cause, f64)]) -> Latch<2> {
        let mut latch = Latch::OPEN;
        for (count, (cause, before_s)) in (1..).zip(faults) {
            let last = latch_fade(count - 1, *cause);
            (0..(before_s / SERVO_S) as u32).for_each(|_| latch.take_in(last, NOTHING, SERVO_S));
            (0..10).for_each(|_| latch.take_in(latch_fade(count, *cause), NOTHING, 0.0));
        }
        latch
    }

    fn latch_fade(count: u32, cause: Cause) -> Option<Fade> {
        (count > 0).then_some(Fade {
            cause,
            evidence: None,
            decision: 0,
            count,
        })
    }

    #[test]
    fn the_second_fault_of_a_cause_latches_unless_the_correction_has_held_or_another_cause_came() {
        use Cause::{Harmful, LostFeedback, WrongPredictions};
        for (faults, latched) in [
            (&[(Harmful, 1.0)][..], None),
            (&[(Harmful, 1.0), (Harmful, 1.0)], Some(Harmful)),
            (&[(Harmful, 1.0), (Harmful, 5.1)], None),
            (&[(Harmful, 9.0), (Harmful, 4.9)], Some(Harmful)),
            (
                &[(Harmful, 1.0), (WrongPredictions, 1.0), (Harmful, 1.0)],
                None,
            ),
            (
                &[(Harmful, 1.0), (LostFeedback, 1.0), (Harmful, 1.0)],
                Some(Harmful),
            ),
            (
                &[
                    (LostFeedback, 1.0),
                    (LostFeedback, 1.0),
                    (LostFeedback, 1.0),
                ],
                None,
            ),
            (
                &[(Harmful, 1.0), (Harmful, 1.0), (WrongPredictions, 9.0)],
                Some(Harmful),
            ),
        ] {
            assert_eq!(after(faults).latched(), latched, "{faults:?}");
        }
    }

    #[test]
    fn what_was_learned_begins_anew_once_for_each_axis() {
        let mut latch = after(&[(Cause::Harmful, 1.0)]);
        for (count, learned, latched) in [
            (2, [true, false], None),
            (2, [false, false], None),
            (3, [false, true], None),
            (3, [true, true], None),
            (4, [true, true], Some(Cause::Harmful)),
            (5, [true, true], Some(Cause::Harmful)),
        ] {
            latch.take_in(latch_fade(count, Cause::Harmful), learned, SERVO_S);
            assert_eq!(latch.latched(), latched, "{count} {learned:?}");
        }
    }

    #[test]
    fn a_reset_forgets_every_fault() {
        let mut latch = after(&[(Cause::Harmful, 1.0), (Cause::Harmful, 1.0)]);
        latch.reset();
        latch.take_in(latch_fade(2, Cause::Harmful), NOTHING, SERVO_S);
        assert_eq!(latch.latched(), None);
        latch.take_in(latch_fade(3, Cause::Harmful), NOTHING, SERVO_S);
        assert_eq!(latch.latched(), None);
        latch.take_in(latch_fade(4, Cause::Harmful), NOTHING, SERVO_S);
        assert_eq!(latch.latched(), Some(Cause::Harmful));
    }

    #[test]
    fn a_delay_that_is_given_up_and_taken_up_again_forgives_nothing() {
        let mut latch = after(&[(Cause::Harmful, 1.0)]);
        latch.take_in(None, NOTHING, 0.0);
        assert_eq!(latch.latched(), None);
        latch.take_in(latch_fade(1, Cause::Harmful), NOTHING, SERVO_S);
        assert_eq!(latch.latched(), Some(Cause::Harmful));
    }
}
