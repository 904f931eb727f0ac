//! The live state machine: when a correction is in the loop, when it leaves, and when it comes back.
//!
//! ```text
//! Shadow --good for the wait--> Engaged --bad--> Fading --offset at rest--> Shadow
//! ```
//!
//! In Shadow and Fading the controller goes on deciding and learning, from what is commanded and measured, and nobody follows
//! it. *Good* is a position that is there, predictions that hold with a margin (hysteresis), and a correction that would do no
//! harm, for `GOOD_S` in a row. The first wait after a fault is `FIRST_WAIT_S`; each further one of the same making takes
//! twice as long, and a correction that has held for `FORGIVEN_S` begins anew.

use crate::controller::FaultEvidence;

/// Predictions that hold for so long in a row are good, s.
const GOOD_S: f64 = 0.1;
/// The least time out of the loop, s, at first and at the most.
const FIRST_WAIT_S: f64 = 0.2;
const LONGEST_WAIT_S: f64 = 3.2;
/// A correction that was in the loop for so long without a fault is trusted as at first, s.
const FORGIVEN_S: f64 = 5.0;

/// Where a correction is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// It decides and nobody follows: the command is the path.
    Shadow,
    /// It is in the loop.
    Engaged,
    /// It has left the loop, and its offset is on the way back to the path.
    Fading,
}

/// Why a controller was taken out of the loop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Its command was not a number.
    NotANumber,
    /// The position was not a number, leapt, or stood still while the command went on.
    LostFeedback,
    /// Its predictions were wrong for several decisions in a row.
    WrongPredictions,
    /// It made the contour error larger than it would have been without, or was about to.
    Harmful,
}

impl Cause {
    /// In words, after "because".
    pub fn words(self) -> &'static str {
        match self {
            Self::NotANumber => "its command was not a number",
            Self::LostFeedback => "the measured position was lost",
            Self::WrongPredictions => "its predictions were wrong",
            Self::Harmful => "it made the contour error larger",
        }
    }
}

/// When and why a controller was taken out of the loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fade {
    /// Why.
    pub cause: Cause,
    /// What that rests on; none where nothing was compared.
    pub evidence: Option<FaultEvidence>,
    /// Decisions made before it.
    pub decision: u64,
}

/// The state and what it follows.
#[derive(Debug, Clone)]
pub(super) struct Engagement {
    state: State,
    decisions: u64,
    /// The last fade.
    fade: Option<Fade>,
    /// Time in the loop, or out of it, and how long everything has been good, s.
    for_s: f64,
    good_s: f64,
    wait_s: f64,
}

impl Engagement {
    /// At the start of a program: in the loop.
    pub(super) const START: Self =
        Self { state: State::Engaged, decisions: 0, fade: None, for_s: 0.0, good_s: 0.0, wait_s: FIRST_WAIT_S };

    pub(super) fn state(&self) -> State {
        self.state
    }

    pub(super) fn fade(&self) -> Option<Fade> {
        self.fade
    }

    /// For how long it has been back in the loop, s; none of one that never left it.
    pub(super) fn back_for_s(&self) -> Option<f64> {
        self.fade.map(|_| self.for_s)
    }

    /// Goes on by a decision: `bad` is why the controller must not be followed, and what that rests on; `good` whether it may be followed again, and
    /// `over` whether its offset has come to rest.
    pub(super) fn go_on(
        &mut self,
        bad: Option<(Cause, Option<FaultEvidence>)>,
        good: bool,
        over: bool,
        period_s: f64,
    ) -> State {
        self.for_s += period_s;
        self.good_s = if good && bad.is_none() { self.good_s + period_s } else { 0.0 };
        match (self.state, bad) {
            (State::Engaged, Some((cause, evidence))) => self.leave(cause, evidence),
            (State::Engaged, None) if self.for_s > FORGIVEN_S => self.wait_s = FIRST_WAIT_S,
            (State::Engaged, None) => {}
            _ if self.for_s >= self.wait_s && self.good_s >= GOOD_S => {
                (self.state, self.for_s) = (State::Engaged, 0.0);
            }
            (State::Fading, _) if over => self.state = State::Shadow,
            _ => {}
        }
        self.decisions += 1;
        self.state
    }

    fn leave(&mut self, cause: Cause, evidence: Option<FaultEvidence>) {
        // A lost position is not the controller's fault.
        if self.fade.is_some() && cause != Cause::LostFeedback {
            self.wait_s = (2.0 * self.wait_s).min(LONGEST_WAIT_S);
        }
        self.fade = Some(Fade { cause, evidence, decision: self.decisions });
        (self.state, self.for_s, self.good_s) = (State::Fading, 0.0, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 0.003;

    /// Decisions until a controller that is good from now on is back.
    fn until_back(engagement: &mut Engagement) -> u32 {
        (1..10_000).find(|_| engagement.go_on(None, true, true, PERIOD_S) == State::Engaged).expect("it comes back")
    }

    #[test]
    fn it_leaves_at_once_and_is_back_within_a_second_of_a_first_fault() {
        let mut engagement = Engagement::START;
        assert_eq!(engagement.go_on(Some((Cause::LostFeedback, None)), false, false, PERIOD_S), State::Fading);
        for _ in 0..30 {
            assert_eq!(engagement.go_on(Some((Cause::LostFeedback, None)), false, false, PERIOD_S), State::Fading);
        }
        assert_eq!(engagement.go_on(None, true, true, PERIOD_S), State::Shadow);
        assert!(f64::from(until_back(&mut engagement)) * PERIOD_S < 0.5);
    }

    #[test]
    fn who_fails_again_and_again_waits_longer_and_who_holds_is_forgiven() {
        let mut engagement = Engagement::START;
        let mut waits = [0; 8];
        for wait in &mut waits {
            engagement.go_on(Some((Cause::Harmful, None)), false, true, PERIOD_S);
            *wait = until_back(&mut engagement);
        }
        assert!(waits.is_sorted() && waits[7] > 10 * waits[0], "{waits:?}");
        assert!(f64::from(waits[7]) * PERIOD_S <= LONGEST_WAIT_S + PERIOD_S);
        for _ in 0..2000 {
            engagement.go_on(None, true, true, PERIOD_S);
        }
        engagement.go_on(Some((Cause::Harmful, None)), false, true, PERIOD_S);
        assert!(until_back(&mut engagement) <= 2 * waits[0]);
    }

    #[test]
    fn what_is_good_only_now_and_then_stays_out() {
        let mut engagement = Engagement::START;
        engagement.go_on(Some((Cause::WrongPredictions, None)), false, true, PERIOD_S);
        for n in 0..5000 {
            assert_ne!(engagement.go_on(None, n % 10 != 0, true, PERIOD_S), State::Engaged);
        }
    }
}
