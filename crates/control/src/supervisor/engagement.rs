//! Question: is the correction engaged? The state machine takes in the verdicts of all tests.
//!
//! ```text
//! Shadow --good for the wait--> Engaged --bad--> Fading --offset at rest--> Shadow
//! ```
//!
//! In Shadow and Fading the controller continues to decide and to learn, from the actual commands
//! and measurements, but its command is not used. *Good* means a valid position, predictions that
//! hold with a margin (hysteresis), and a correction that would do no harm, for `GOOD_S` in a row.
//! The first wait after a fault is `FIRST_WAIT_S`; each further wait for the same kind of fault
//! takes twice as long, and after `FORGIVEN_S` without a fault the wait is the first one again.
//!
//! `GOOD_S` and `FORGIVEN_S` count only while the commanded path moves: a machine at rest confirms
//! every model. Bad evidence counts at any time. A controller that was switched off without bad
//! evidence engages again without new good evidence.

use crate::command::FaultEvidence;

/// Time for which predictions must hold in a row to be good, s of motion.
const GOOD_S: f64 = 0.1;
/// Shortest time out of the loop, s: the first wait and the longest wait.
const FIRST_WAIT_S: f64 = 0.2;
const LONGEST_WAIT_S: f64 = 3.2;
/// Motion without a fault while engaged, s, after which earlier faults no longer count. Below it,
/// the next fault adds to them.
pub const FORGIVEN_S: f64 = 5.0;

/// State of a correction.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// It decides, but its command is not used: the command is the path.
    Shadow,
    /// It is engaged.
    Engaged,
    /// It was disengaged, and its offset returns to the path.
    Fading,
}

/// Reason why a controller was disengaged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Its command was NaN or infinite.
    NotANumber,
    /// The position was NaN, leaped, or stood still while the command moved.
    LostFeedback,
    /// Its predictions were wrong for several decisions in a row.
    WrongPredictions,
    /// It made the contour error larger than the error without it.
    Harmful,
}

impl Cause {
    /// Returns the cause in words, to follow "because".
    pub fn words(self) -> &'static str {
        match self {
            Self::NotANumber => "its command was not a number",
            Self::LostFeedback => "the measured position was lost",
            Self::WrongPredictions => "its predictions were wrong",
            Self::Harmful => "it made the contour error larger",
        }
    }
}

/// Time and cause of a disengagement.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fade {
    /// Cause of the disengagement.
    pub cause: Cause,
    /// Evidence for the cause; `None` where nothing was compared.
    pub evidence: Option<FaultEvidence>,
    /// Decisions made before it.
    pub decision: u64,
    /// Number of disengagements, including this one.
    pub count: u32,
}

/// Inputs of a decision.
#[derive(Debug, Clone, Copy)]
pub(super) struct DecisionInputs {
    /// True if a correction is wanted at all.
    pub(super) allowed: bool,
    /// Reason to disengage the controller, with its evidence.
    pub(super) bad: Option<(Cause, Option<FaultEvidence>)>,
    /// True if the controller may engage again; `over`: true if its offset has come to rest.
    pub(super) good: bool,
    pub(super) over: bool,
    /// True if the commanded path moves.
    pub(super) moves: bool,
    /// Time since the last decision, s.
    pub(super) period_s: f64,
}

/// State of the engagement and its inputs.
#[derive(Debug, Clone)]
pub(super) struct Engagement {
    state: State,
    decisions: u64,
    /// The last fade.
    fade: Option<Fade>,
    /// Time since the last change of the state, s; motion while engaged, and motion in which
    /// everything was good, s.
    for_s: f64,
    held_s: f64,
    good_s: f64,
    wait_s: f64,
}

impl Engagement {
    /// State at the start of a program: engaged.
    pub(super) const START: Self = Self {
        state: State::Engaged,
        decisions: 0,
        fade: None,
        for_s: 0.0,
        held_s: 0.0,
        good_s: GOOD_S,
        wait_s: FIRST_WAIT_S,
    };

    pub(super) fn state(&self) -> State {
        self.state
    }

    pub(super) fn fade(&self) -> Option<Fade> {
        self.fade
    }

    /// Takes in a decision and returns the new state.
    pub(super) fn go_on(&mut self, seen: &DecisionInputs) -> State {
        let DecisionInputs {
            allowed,
            bad,
            good,
            over,
            moves,
            period_s,
        } = *seen;
        let moved_s = if moves { period_s } else { 0.0 };
        self.for_s += period_s;
        self.held_s = if self.state == State::Engaged {
            self.held_s + moved_s
        } else {
            0.0
        };
        self.good_s = if good && bad.is_none() {
            self.good_s + moved_s
        } else {
            0.0
        };
        match (self.state, bad) {
            (State::Engaged, Some((cause, evidence))) => self.fail(cause, evidence),
            (State::Engaged, None) if !allowed => self.leave(),
            (State::Engaged, None) if self.held_s > FORGIVEN_S => self.wait_s = FIRST_WAIT_S,
            (State::Engaged, None) => {}
            _ if allowed && self.for_s >= self.wait_s && self.good_s >= GOOD_S => {
                (self.state, self.for_s) = (State::Engaged, 0.0);
            }
            (State::Fading, _) if over => self.state = State::Shadow,
            _ => {}
        }
        self.decisions += 1;
        self.state
    }

    fn fail(&mut self, cause: Cause, evidence: Option<FaultEvidence>) {
        // A lost position is not the controller's fault.
        if self.fade.is_some() && cause != Cause::LostFeedback {
            self.wait_s = (2.0 * self.wait_s).min(LONGEST_WAIT_S);
        }
        let count = self.fade.map_or(0, |fade| fade.count).saturating_add(1);
        self.fade = Some(Fade {
            cause,
            evidence,
            decision: self.decisions,
            count,
        });
        self.leave();
        self.good_s = 0.0;
    }

    fn leave(&mut self) {
        (self.state, self.for_s) = (State::Fading, 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 0.003;

    /// A decision in motion with this fault of a controller whose offset has come to rest.
    fn goes_on(engagement: &mut Engagement, cause: Option<Cause>, good: bool, over: bool) -> State {
        let bad = cause.map(|cause| (cause, None));
        engagement.go_on(&DecisionInputs {
            allowed: true,
            bad,
            good,
            over,
            moves: true,
            period_s: PERIOD_S,
        })
    }

    /// A decision at rest with this fault.
    fn rests(engagement: &mut Engagement, cause: Option<Cause>) -> State {
        let bad = cause.map(|cause| (cause, None));
        engagement.go_on(&DecisionInputs {
            allowed: true,
            bad,
            good: true,
            over: true,
            moves: false,
            period_s: PERIOD_S,
        })
    }

    /// Decisions until a controller that is good from now on is back.
    fn until_back(engagement: &mut Engagement) -> u32 {
        (1..10_000)
            .find(|_| goes_on(engagement, None, true, true) == State::Engaged)
            .expect("it comes back")
    }

    #[test]
    fn it_leaves_at_once_and_is_back_within_a_second_of_a_first_fault() {
        let mut engagement = Engagement::START;
        assert_eq!(
            goes_on(&mut engagement, Some(Cause::LostFeedback), false, false),
            State::Fading
        );
        for _ in 0..30 {
            assert_eq!(
                goes_on(&mut engagement, Some(Cause::LostFeedback), false, false),
                State::Fading
            );
        }
        assert_eq!(goes_on(&mut engagement, None, true, true), State::Shadow);
        assert!(f64::from(until_back(&mut engagement)) * PERIOD_S < 0.5);
    }

    #[test]
    fn who_fails_again_and_again_waits_longer_and_who_holds_is_forgiven() {
        let mut engagement = Engagement::START;
        let mut waits = [0; 8];
        for wait in &mut waits {
            goes_on(&mut engagement, Some(Cause::Harmful), false, true);
            *wait = until_back(&mut engagement);
        }
        assert!(waits.is_sorted() && waits[7] > 10 * waits[0], "{waits:?}");
        assert!(f64::from(waits[7]) * PERIOD_S <= LONGEST_WAIT_S + PERIOD_S);
        for _ in 0..2000 {
            goes_on(&mut engagement, None, true, true);
        }
        goes_on(&mut engagement, Some(Cause::Harmful), false, true);
        assert!(until_back(&mut engagement) <= 2 * waits[0]);
    }

    #[test]
    fn at_rest_it_leaves_at_once_and_comes_back_in_motion() {
        let mut engagement = Engagement::START;
        assert_eq!(
            rests(&mut engagement, Some(Cause::WrongPredictions)),
            State::Fading
        );
        assert!((0..10_000).all(|_| rests(&mut engagement, None) == State::Shadow));
        assert!(f64::from(until_back(&mut engagement)) * PERIOD_S < GOOD_S + 2.0 * PERIOD_S);
    }

    #[test]
    fn at_rest_no_fault_is_forgiven() {
        let mut engagement = Engagement::START;
        let mut waits = [0; 3];
        for wait in &mut waits {
            goes_on(&mut engagement, Some(Cause::Harmful), false, true);
            *wait = until_back(&mut engagement);
            (0..10_000).for_each(|_| assert_eq!(rests(&mut engagement, None), State::Engaged));
        }
        assert!(waits[1] > waits[0] && waits[2] > waits[1], "{waits:?}");
    }

    #[test]
    fn what_is_good_only_now_and_then_stays_out() {
        let mut engagement = Engagement::START;
        goes_on(&mut engagement, Some(Cause::WrongPredictions), false, true);
        for n in 0..5000 {
            assert_ne!(
                goes_on(&mut engagement, None, n % 10 != 0, true),
                State::Engaged
            );
        }
    }

    #[test]
    fn what_is_not_wanted_leaves_without_a_fault_and_comes_back_when_it_is() {
        let mut engagement = Engagement::START;
        let mut asked = |allowed| {
            let inputs = DecisionInputs {
                allowed,
                bad: None,
                good: true,
                over: true,
                moves: false,
                period_s: PERIOD_S,
            };
            engagement.go_on(&inputs)
        };
        assert_eq!(
            [true, false, false].map(&mut asked),
            [State::Engaged, State::Fading, State::Shadow]
        );
        assert!((0..1000).all(|_| asked(false) == State::Shadow));
        assert_eq!(asked(true), State::Engaged);
        assert_eq!(engagement.fade(), None);
    }
}
