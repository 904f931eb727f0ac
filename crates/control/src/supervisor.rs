//! The supervisor stands between every controller and the machine, in a simulation as in a servo
//! thread.
//!
//! It holds each command within [`Bounds`], and engages a controller only while the correction
//! brings the tool nearer to the path:
//!
//! | Observation | Test | Action |
//! |---|---|---|
//! | the position is lost | it is NaN, moves faster than the machine can, or stands still while the command moves | disengages at once |
//! | the command is NaN | | disengages at once |
//! | on a machine for the first time | in motion without a correction, the model predicts half of the error to correct | does not engage before |
//! | the model of the controller is wrong | free runs of the model miss more than the error to correct, twice in a row or once by twice as much | disengages at once |
//! | predictions are wrong | four in a row miss by a fifth of the largest deviation | disengages at once |
//! | harm | the error is beyond 1.5 times the error without the correction, plus 5 um (mean square over 0.25 s) or 30 um (a single error) | disengages at once |
//! | [`Bounds::engaged_mm_s2`] keeps the offset from the requested one | | commands a smaller part of it |
//! | servo periods deviate from the model | innovations, over 5 ms | the controller requests less |
//! | the command was held to a bound | | the controller requests less |
//! | none of these, for a while | 0.1 s of motion, and twice as long out as the last time | engages again, within 40 ms or more |
//!
//! A controller disengages by a fade within [`Bounds::fade_mm_s2`]: the part of the offset that is
//! commanded falls, or, where the offset is no longer known, the last offset returns to the path. A
//! disengaged controller continues to learn.
//!
//! A wrong prediction of a model counts only beyond four standard deviations of noise, and twice; a
//! learned model replaces a correct one in one of a thousand trials
//! (`controller/lqg_identified/learning.rs`).
//!
//! Bounds of the harm, for a controller that does any harm within its bounds and knows the effect
//! of its offset, on a machine with a lag of 20 ms: every error is at most 1.5 times the largest
//! without it, plus 30 um and half the largest deviation; it exceeds the first two terms for at
//! most 0.15 s; and the mean square is at most 1.75 times the mean square without it, plus (5
//! um)^2. `tests/property_supervisor.rs` attacks it.
//!
//! | File | Content |
//! |---|---|
//! | `supervisor/feedback.rs` | plausibility of the measured position |
//! | `supervisor/first_use.rs` | test of a model before its first use |
//! | `supervisor/one_step.rs` | comparison of a servo period with the model |
//! | `supervisor/proof.rs` | test of a model that was wrong |
//! | `supervisor/validity.rs` | validity of a model for engagement |
//! | `supervisor/benefit.rs` | the contour error with and without the correction |
//! | `supervisor/bounds.rs` | bounds of every command |
//! | `supervisor/fade.rs` | motion of the offset back to the path |
//! | `supervisor/dose.rs` | part of an offset that is commanded |
//! | `supervisor/engagement.rs` | the states: shadow, engaged, fading |

pub(crate) mod feedback;
pub(crate) mod first_use;
pub(crate) mod one_step;
mod proof;
pub(crate) mod validity;
mod benefit;
mod bounds;
mod fade;
mod dose;
pub(crate) mod engagement;

use crate::command::{Command, FaultEvidence, Measured};
use crate::vector::{add_scaled, sub};
use crate::window::Window;
use benefit::Benefit;
pub use bounds::Bounds;
use dose::Dose;
pub use engagement::{Cause, FORGIVEN_S, Fade, State};
use engagement::{DecisionInputs, Engagement};
pub use fade::fade_acceleration;

/// Wrong predictions in a row that disengage the controller. A single one is a shock, which no
/// model predicts.
const WRONG_DECISIONS: u32 = 4;
/// Share of the largest deviation beyond which a prediction is wrong.
const WRONG_SHARE: f64 = 0.2;
/// Error up to which a prediction is never wrong, mm, however small the largest deviation is.
const MIN_WRONG_MM: f64 = 0.02;
/// Share of the error of a wrong prediction below which a prediction is good.
const GOOD_SHARE: f64 = 0.5;
/// Report of a controller on itself after a decision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SelfReport<const N: usize> {
    /// Error of its last prediction, mm; infinite where its model is wrong. `doubt` is the evidence
    /// for that.
    pub(crate) prediction_error_mm: f64,
    pub(crate) doubt: Option<FaultEvidence>,
    /// Displacement of the tool by its offset, mm, where it knows.
    pub(crate) moved_mm: Option<[f64; N]>,
    /// True if it reduces the contour error.
    pub(crate) corrects: bool,
    /// True if its offset acts in the servo period of the decision.
    pub(crate) acts_at_once: bool,
    /// True for each axis that it corrects with a learned model.
    pub(crate) learned: [bool; N],
}

/// The supervisor and its state between decisions.
#[derive(Debug, Clone)]
pub(crate) struct Supervisor<const N: usize> {
    bounds: Bounds,
    rate: f64,
    wrong: u32,
    benefit: Benefit<N>,
    engagement: Engagement,
    /// Commanded part of an offset that acts at once.
    dose: Dose<N>,
    /// True if a correction is wanted at all.
    allowed: bool,
    held: bool,
}

impl<const N: usize> Supervisor<N> {
    /// Creates a supervisor at the start of a program.
    pub(crate) fn new(bounds: Bounds) -> Self {
        Self {
            bounds,
            rate: 1.0,
            wrong: 0,
            benefit: Benefit::NONE,
            engagement: Engagement::START,
            dose: Dose::ALL,
            allowed: true,
            held: false,
        }
    }

    /// Returns the bounds of the command.
    pub(crate) fn bounds(&self) -> &Bounds {
        &self.bounds
    }

    /// Changes the bounds of the commands from the next decision on.
    pub(crate) fn hold_to(&mut self, bounds: Bounds) {
        self.bounds = bounds;
    }

    /// Switches the correction on or off from the next decision on.
    pub(crate) fn allow(&mut self, allowed: bool) {
        self.allowed = allowed;
    }

    /// Returns time and cause of the last disengagement.
    pub(crate) fn fade(&self) -> Option<Fade> {
        self.engagement.fade()
    }

    /// Returns the state of the controller: engaged, fading or in shadow.
    pub(crate) fn state(&self) -> State {
        self.engagement.state()
    }

    /// Returns true if the last command of an engaged controller was held to a bound.
    pub(crate) fn held(&self) -> bool {
        self.held
    }

    /// Returns the contour error without the correction, mm.
    pub(crate) fn without_mm(&self) -> f64 {
        self.benefit.open_mm()
    }

    /// Returns the command of the next feed period: the command of the controller within the
    /// bounds, or the way back to the path. `wanted` is `None` where the position was lost.
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
        let is_known = !matches!(bad, Some((Cause::NotANumber | Cause::LostFeedback, _)));
        let wanted = wanted.unwrap_or(Command::AS_PLANNED);
        let before = self.engagement.state();
        let state = self.engagement.go_on(&DecisionInputs {
            allowed: self.allowed,
            bad,
            good: told.prediction_error_mm < GOOD_SHARE * self.wrong_mm(),
            over: fade::is_over(window.offset_mm, window.offset_mm_s),
            moves: window.now().feed_mm_s > 0.0,
            period_s: window.feed_period_s,
        });
        let asked = match state {
            _ if told.acts_at_once => {
                if state != before && state != State::Shadow {
                    self.dose.turn(
                        if is_known {
                            wanted.offset_mm
                        } else {
                            window.offset_mm
                        },
                        self.bounds.fade_mm_s2,
                    );
                }
                self.dose.learn(told.learned);
                self.at_once(window, &wanted, state, is_known)
            }
            State::Engaged => wanted,
            State::Shadow => Command::AS_PLANNED,
            State::Fading => self.faded(window),
        };
        let command = self
            .bounds
            .hold(window, asked, self.rate, told.acts_at_once);
        self.held = state == State::Engaged && (command != asked || self.dose.is_reduced());
        self.rate = command.rate;
        command
    }

    /// Returns the command of a controller that acts at once: the part of its offset that is due,
    /// within the acceleration that the machine's owner allows. Unless `is_known`, the requested
    /// offset is unknown, and the offset goes back from its last place.
    fn at_once(
        &mut self,
        window: &Window<'_, N>,
        wanted: &Command<N>,
        state: State,
        is_known: bool,
    ) -> Command<N> {
        let period_s = window.feed_period_s;
        let is_in = state == State::Engaged;
        let due_mm = match state {
            State::Shadow => {
                self.dose.none();
                [0.0; N]
            }
            State::Engaged => self.dose.of(wanted.offset_mm, true, period_s),
            State::Fading => {
                let faded_mm = self.faded_mm(window);
                let due_mm = self.dose.of(wanted.offset_mm, false, period_s);
                if is_known && self.bounds.engaged_mm_s2 < f64::INFINITY {
                    core::array::from_fn(|axis| nearer(due_mm[axis], faded_mm[axis]))
                } else {
                    faded_mm
                }
            }
        };
        let offset_mm = self.bounds.accelerated_mm(window, due_mm);
        self.dose.take_in(sub(due_mm, offset_mm), period_s);
        Command {
            offset_mm,
            ..if is_in { *wanted } else { Command::AS_PLANNED }
        }
    }

    /// Returns the reason to disengage the controller and its evidence.
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
        // Where the predictions are invalid, so is the reported effect of the offset.
        let harm = if told.prediction_error_mm < f64::INFINITY {
            self.benefit.harm(
                window,
                measured.position_mm,
                &measured.contour,
                told.moved_mm,
            )
        } else {
            None
        };
        if !sum.is_finite() {
            Some((Cause::NotANumber, None))
        } else if self.wrong >= WRONG_DECISIONS {
            let missed = FaultEvidence {
                found_mm: told.prediction_error_mm,
                limit_mm: self.wrong_mm(),
            };
            // An infinite error is the controller's own judgment: it has no measured value.
            let measured = Some(missed).filter(|missed| missed.found_mm < f64::INFINITY);
            Some((Cause::WrongPredictions, told.doubt.or(measured)))
        } else {
            harm.filter(|_| told.corrects)
                .map(|harm| (Cause::Harmful, Some(harm)))
        }
    }

    /// Returns the error beyond which a prediction is wrong, mm.
    fn wrong_mm(&self) -> f64 {
        (WRONG_SHARE * self.bounds.deviation_mm).max(MIN_WRONG_MM)
    }

    /// Returns the next step of the way back to the path, at the planned feedrate.
    fn faded(&self, window: &Window<'_, N>) -> Command<N> {
        let acceleration_mm_s2 = self.fade_mm_s2(window, window.offset_mm_s);
        Command::accelerated(window, window.offset_mm_s, acceleration_mm_s2)
    }

    /// Returns the place of an offset that acts at once after one more period of its way back, mm.
    /// Without a limit of its acceleration, an offset that was reached in one step need not
    /// continue at the speed of that step.
    fn faded_mm(&self, window: &Window<'_, N>) -> [f64; N] {
        let mut speed_mm_s = window.offset_mm_s;
        if self.bounds.engaged_mm_s2 == f64::INFINITY {
            let axes = speed_mm_s.iter_mut().zip(window.offset_mm);
            axes.for_each(|(speed, offset_mm)| {
                *speed = fade::begins_mm_s(offset_mm, *speed, self.bounds.fade_mm_s2);
            });
        }
        let speed_mm_s = add_scaled(
            speed_mm_s,
            window.feed_period_s,
            self.fade_mm_s2(window, speed_mm_s),
        );
        add_scaled(window.offset_mm, window.feed_period_s, speed_mm_s)
    }

    /// Returns the acceleration of an offset with this speed on its way back, mm/s2.
    fn fade_mm_s2(&self, window: &Window<'_, N>, speed_mm_s: [f64; N]) -> [f64; N] {
        let mut acceleration_mm_s2 = speed_mm_s;
        let axes = acceleration_mm_s2.iter_mut().zip(window.offset_mm);
        axes.for_each(|(of, offset_mm)| {
            *of = fade_acceleration(offset_mm, *of, window.feed_period_s, self.bounds.fade_mm_s2);
        });
        acceleration_mm_s2
    }
}

/// Returns the due part of an offset that fades, but no more than its way back allows, mm.
fn nearer(due_mm: f64, faded_mm: f64) -> f64 {
    if due_mm * faded_mm > 0.0 && due_mm.abs() < faded_mm.abs() {
        due_mm
    } else {
        faded_mm
    }
}
