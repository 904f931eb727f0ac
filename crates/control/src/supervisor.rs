//! The supervisor: it stands between every controller and the machine, in a simulation as in a servo thread.
//!
//! It holds each command within [`Bounds`], and follows a controller only while the tool is nearer to the path by it:
//!
//! | Seen | Test | Then |
//! |---|---|---|
//! | the position is lost | it is no number, moves faster than the machine can, or stands still while the command moves | out at once |
//! | the command is no number | | out at once |
//! | on a machine for the first time | a law that predicts half of what there is to correct, in motion without a correction | not in before |
//! | the law of the controller is wrong | free runs by it miss more than there is to correct, twice in a row or once by twice as much | out at once |
//! | predictions are wrong | four in a row miss by a fifth of the largest deviation | out at once |
//! | harm | the error is beyond 1.5 times that without the correction, and 5 um (mean square over 0.25 s) or 30 um (a single error) | out at once |
//! | [`Bounds::engaged_mm_s2`] keeps the offset from what is asked for | by more than 5 um | out at once |
//! | servo periods do not go as the law says | innovations, over 5 ms | it asks for less |
//! | the command was held to a bound | | it asks for less |
//! | nothing of this, for a while | 0.1 s, and twice as long out as the last time | back in, within 40 ms or more |
//!
//! Out is a fade within [`Bounds::fade_mm_s2`]. While a controller is out it goes on learning.
//!
//! Each wrong prediction of a law counts only beyond four standard deviations of noise, and twice; a learned law is taken for better than a right one
//! in one of a thousand trials (`controller/lqg_preview/learning.rs`).
//!
//! The bound of the harm, by a controller that harms as it likes within its bounds and knows what its offset does, on a machine with a lag of 20 ms: no error is beyond 1.5 times the largest
//! without it, 30 um and half the largest deviation; none stays beyond the first two for longer than 0.15 s; and the mean square is at most 1.75 times that
//! without it and (5 um)^2. `tests/property_supervisor.rs` attacks it.
//!
//! | File | What |
//! |---|---|
//! | `supervisor/feedback.rs` | whether the measured position can be true |
//! | `supervisor/first_use.rs` | what a law has to show before it is used for the first time |
//! | `supervisor/one_step.rs` | whether a servo period went as a law said |
//! | `supervisor/proof.rs` | what a law that was wrong has to hold through |
//! | `supervisor/validity.rs` | whether a law is good enough for the loop |
//! | `supervisor/benefit.rs` | the contour error with and without the correction |
//! | `supervisor/bounds.rs` | what every command is held to |
//! | `supervisor/fade.rs` | the way of the offset back to the path |
//! | `supervisor/engagement.rs` | the states: shadow, engaged, fading |

pub(crate) mod feedback;
pub(crate) mod first_use;
pub(crate) mod one_step;
mod proof;
pub(crate) mod validity;
mod benefit;
mod bounds;
mod fade;
pub(crate) mod engagement;

use crate::command::{Command, FaultEvidence, Measured};
use crate::vector::{bounded, norm, scale, smooth_step, sub};
use crate::window::Window;
use benefit::Benefit;
pub use bounds::Bounds;
pub use engagement::{Cause, Fade, State};
use engagement::{DecisionInputs, Engagement};
pub use fade::fade_acceleration;

/// A correction that acts at once takes at least this long to come back, s: twice the time constant of a usual position loop.
const LEAST_BACK_S: f64 = 0.04;
/// Decisions in a row with a wrong prediction. One is a shock, which no model foresees.
const WRONG_DECISIONS: u32 = 4;
/// The owner's acceleration may keep the offset so far from what is asked for, mm: what is harm in the mean (`supervisor/benefit.rs`).
const MOST_BEHIND_MM: f64 = 0.005;
/// A prediction is wrong where it misses by this part of the largest deviation.
const WRONG_SHARE: f64 = 0.2;
/// A prediction that misses by less than this is not worth a word, mm, however small the largest deviation is.
const MIN_WRONG_MM: f64 = 0.02;
/// A prediction is good where it misses by less than this part of a wrong one.
const GOOD_SHARE: f64 = 0.5;
/// What a controller says of itself behind a decision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SelfReport<const N: usize> {
    /// By how much its last prediction missed, mm; infinite where its law is wrong, and what that rests on.
    pub(crate) prediction_error_mm: f64,
    pub(crate) doubt: Option<FaultEvidence>,
    /// By how much its offset has moved the tool, mm, where it knows.
    pub(crate) moved_mm: Option<[f64; N]>,
    /// Whether it means to make the contour error smaller.
    pub(crate) corrects: bool,
    /// Whether its offset is there at once.
    pub(crate) acts_at_once: bool,
}

/// The supervisor and its state between decisions.
#[derive(Debug, Clone)]
pub(crate) struct Supervisor<const N: usize> {
    bounds: Bounds,
    rate: f64,
    wrong: u32,
    benefit: Benefit<N>,
    engagement: Engagement,
    /// Time in which a correction comes back, s.
    take_up_s: f64,
    /// Whether a correction is wanted at all.
    allowed: bool,
    held: bool,
    /// What was asked for last by a controller in the loop that acts at once, mm, and how far the owner's acceleration has kept the offset from it, mm.
    asked_mm: [f64; N],
    behind_mm: f64,
}

impl<const N: usize> Supervisor<N> {
    /// At the start of a program.
    pub(crate) fn new(bounds: Bounds) -> Self {
        Self {
            bounds,
            rate: 1.0,
            wrong: 0,
            benefit: Benefit::NONE,
            engagement: Engagement::START,
            take_up_s: LEAST_BACK_S,
            allowed: true,
            held: false,
            asked_mm: [0.0; N],
            behind_mm: 0.0,
        }
    }

    /// What the command is held to.
    pub(crate) fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Holds the commands to other bounds from the next decision on.
    pub(crate) fn hold_to(&mut self, bounds: Bounds) {
        self.bounds = bounds;
    }

    /// Whether a correction is wanted from the next decision on.
    pub(crate) fn allow(&mut self, allowed: bool) {
        self.allowed = allowed;
    }

    /// When and why the controller was taken out of the loop last.
    pub(crate) fn fade(&self) -> Option<Fade> {
        self.engagement.fade()
    }

    /// Whether the controller is in the loop.
    pub(crate) fn state(&self) -> State {
        self.engagement.state()
    }

    /// Whether the last command of a controller in the loop was held to a bound.
    pub(crate) fn held(&self) -> bool {
        self.held
    }

    /// Contour error that there would be without the correction, mm.
    pub(crate) fn without_mm(&self) -> f64 {
        self.benefit.open_mm()
    }

    /// By how much the correction was overdone lately.
    pub(crate) fn overdone(&self) -> f64 {
        self.benefit.overdone()
    }

    /// The command of the next feed period: what the controller wanted, within the bounds, or the way back to the path. It wanted nothing where the
    /// position was lost.
    #[inline]
    pub(crate) fn decide(
        &mut self,
        window: &Window<'_, N>,
        measured: &Measured<N>,
        wanted: Option<Command<N>>,
        told: &SelfReport<N>,
    ) -> Command<N> {
        let bad = match &wanted {
            Some(wanted) => self.judge(window, measured, wanted, told),
            None => Some((Cause::LostFeedback, None)),
        };
        let wanted = wanted.unwrap_or(Command::AS_PLANNED);
        let state = self.engagement.go_on(&DecisionInputs {
            allowed: self.allowed,
            bad,
            good: told.prediction_error_mm < GOOD_SHARE * self.wrong_mm(),
            over: fade::is_over(window.offset_mm, window.offset_mm_s),
            period_s: window.feed_period_s,
        });
        let asked = match state {
            State::Engaged if told.acts_at_once => {
                let asked = self.taken_up(wanted, window.feed_period_s);
                self.accelerated(window, asked)
            }
            State::Engaged => wanted,
            State::Shadow => Command::AS_PLANNED,
            State::Fading => self.faded(window, told.acts_at_once),
        };
        let command = self.bounds.hold(window, asked, self.rate, told.acts_at_once);
        self.held = state == State::Engaged && (command != asked || self.behind_mm > 0.0);
        self.rate = command.rate;
        if state != State::Engaged {
            (self.asked_mm, self.behind_mm) = (command.offset_mm, 0.0);
        }
        command
    }

    /// A controller that acts at once comes back as gently as it left: in the time in which an offset of this size is taken up from rest to rest within
    /// the acceleration of a fade. The largest of `o s(t / T)`, s = 3 x^2 - 2 x^3, is 6 o / T^2.
    fn taken_up(&mut self, wanted: Command<N>, period_s: f64) -> Command<N> {
        let Some(back_for_s) = self.engagement.back_for_s() else { return wanted };
        if back_for_s <= period_s {
            self.take_up_s = libm::sqrt(6.0 * norm(wanted.offset_mm) / self.bounds.fade_mm_s2).max(LEAST_BACK_S);
        }
        let part = bounded(back_for_s / self.take_up_s, 0.0, 1.0);
        if part < 1.0 { Command::straight(wanted.rate, scale(smooth_step(part), wanted.offset_mm)) } else { wanted }
    }

    /// What was asked for, within the owner's acceleration.
    fn accelerated(&mut self, window: &Window<'_, N>, asked: Command<N>) -> Command<N> {
        let last_mm = core::mem::replace(&mut self.asked_mm, asked.offset_mm);
        let offset_mm = self.bounds.accelerated_mm(window, asked.offset_mm, last_mm);
        self.behind_mm = norm(sub(asked.offset_mm, offset_mm));
        Command { offset_mm, ..asked }
    }

    /// Why a controller must not be followed, and what that rests on.
    fn judge(
        &mut self,
        window: &Window<'_, N>,
        measured: &Measured<N>,
        wanted: &Command<N>,
        told: &SelfReport<N>,
    ) -> Option<(Cause, Option<FaultEvidence>)> {
        let sum = wanted.rate + wanted.offset_mm.iter().chain(&wanted.bend_mm).sum::<f64>();
        self.wrong = match told.prediction_error_mm {
            f64::INFINITY => WRONG_DECISIONS,
            wrong_mm if wrong_mm > self.wrong_mm() => self.wrong + 1,
            _ => 0,
        };
        // Where nothing that is predicted can be true, neither can what an offset is said to have done.
        let harm = if told.prediction_error_mm < f64::INFINITY {
            self.benefit.harm(window, measured.position_mm, &measured.contour, told.moved_mm)
        } else {
            None
        };
        if !sum.is_finite() {
            Some((Cause::NotANumber, None))
        } else if self.wrong >= WRONG_DECISIONS {
            let missed = FaultEvidence { found_mm: told.prediction_error_mm, limit_mm: self.wrong_mm() };
            // An infinite error is the controller's own judgment: nothing was measured.
            let measured = Some(missed).filter(|missed| missed.found_mm < f64::INFINITY);
            Some((Cause::WrongPredictions, told.doubt.or(measured)))
        } else if self.behind_mm > MOST_BEHIND_MM {
            Some((Cause::TooQuick, Some(FaultEvidence { found_mm: self.behind_mm, limit_mm: MOST_BEHIND_MM })))
        } else {
            harm.filter(|_| told.corrects).map(|harm| (Cause::Harmful, Some(harm)))
        }
    }

    /// A prediction that misses by more is wrong, mm.
    fn wrong_mm(&self) -> f64 {
        (WRONG_SHARE * self.bounds.deviation_mm).max(MIN_WRONG_MM)
    }

    /// The next step of the way back to the path, at the feed of the plan.
    fn faded(&self, window: &Window<'_, N>, at_once: bool) -> Command<N> {
        let most_mm_s2 = self.bounds.fade_mm_s2;
        let (mut speed_mm_s, mut acceleration_mm_s2) = (window.offset_mm_s, [0.0; N]);
        let axes = speed_mm_s.iter_mut().zip(&mut acceleration_mm_s2).zip(window.offset_mm);
        for ((speed_mm_s, acceleration_mm_s2), offset_mm) in axes {
            if at_once {
                *speed_mm_s = fade::begins_mm_s(offset_mm, *speed_mm_s, most_mm_s2);
            }
            *acceleration_mm_s2 = fade_acceleration(offset_mm, *speed_mm_s, window.feed_period_s, most_mm_s2);
        }
        Command::accelerated(window, speed_mm_s, acceleration_mm_s2)
    }
}
