//! The supervisor stands between every controller and the machine, in a simulation as in a servo
//! thread.
//!
//! It holds each command within [`Bounds`], and engages a controller only while the correction
//! brings the tool nearer to the path. All judges are in this folder, but for the one that needs no
//! motion: whether a command can follow a drive (`axis/numbers.rs`). A controller that predicts
//! keeps the state of the judges of its model, and reports their verdict ([`SelfReport`]).
//!
//! | File | Question | If not |
//! |---|---|---|
//! | `supervisor/feedback.rs` | can the measured position be true? | disengages at once |
//! | `supervisor/outliers.rs` | can an innovation be motion of the axis? | the filter uses the part that can |
//! | `supervisor/whiteness.rs` | is the noise of the measurement as stated? | the filter takes another noise |
//! | `supervisor/load.rs` | can the load that a filter finds be real? | disengages at once |
//! | `supervisor/one_step.rs` | does the axis move within a servo period as its model expects? | the controller requests less |
//! | `supervisor/readmission.rs` | may a model be used again after it was wrong? | stays disengaged |
//! | `supervisor/validity.rs` | does the model predict what the axis does? | disengages at once |
//! | `supervisor/first_use.rs` | does the model belong to this machine? | does not engage before |
//! | `supervisor/model_choice.rs` | does the nominal model explain an axis as well as the learned one? | the axis follows the learned one |
//! | `supervisor/predictions.rs` | do the controller's predictions come true? | disengages after four |
//! | `supervisor/benefit.rs` | is the tool as near to the path as without the correction? | disengages at once |
//! | `supervisor/trial.rs` | does a correction without a model of the axes help? | commands a smaller share |
//! | `supervisor/fade.rs` | how does an offset return to the path? | |
//! | `supervisor/bounds.rs` | is a command permitted? | it is held to the bound |
//! | `supervisor/dose.rs` | does an offset fit into [`Bounds::engaged_mm_s2`]? | commands a smaller part of it |
//! | `supervisor/engagement.rs` | is the correction engaged? | waits for 0.1 s of good motion, longer after each fault |
//!
//! A command that is not a number disengages at once.
//!
//! A controller disengages by a fade within [`Bounds::fade_mm_s2`]: the part of the offset that is
//! commanded falls, or, where the offset is no longer known, the last offset returns to the path. A
//! disengaged controller continues to learn.
//!
//! A wrong prediction of a model counts only beyond four standard deviations of noise, and twice; a
//! learned model replaces a correct one in one of a thousand trials (`supervisor/model_choice.rs`).
//!
//! Bounds of the harm, for a controller that does any harm within its bounds and knows the effect
//! of its offset, on a machine with a lag of 20 ms: every error is at most 1.5 times the largest
//! without it, plus 30 um and half the largest deviation; it exceeds the first two terms for at
//! most 0.15 s; and the mean square is at most 1.75 times the mean square without it, plus (5
//! um)^2. `tests/property_supervisor.rs` attacks it.

pub(crate) mod feedback;
pub(crate) mod outliers;
pub(crate) mod whiteness;
pub(crate) mod load;
pub(crate) mod one_step;
mod readmission;
pub(crate) mod validity;
pub(crate) mod first_use;
pub(crate) mod model_choice;
mod predictions;
mod benefit;
pub(crate) mod trial;
mod fade;
mod bounds;
mod dose;
pub(crate) mod engagement;

use crate::command::{Command, FaultEvidence, Measured, SelfReport, Verdict};
use crate::vector::{add_scaled, sub};
use crate::window::Window;
use benefit::Benefit;
pub use bounds::Bounds;
use dose::Dose;
pub use engagement::{Cause, FORGIVEN_S, Fade, State};
use engagement::{DecisionInputs, Engagement};
pub use fade::fade_acceleration;
use predictions::Predictions;

/// Standard deviations beyond which an error is not noise.
pub(crate) const DEVIATIONS: f64 = 4.0;
/// Square of an error that is no evidence against a model, mm^2 (2 um).
const NO_ERROR_MM2: f64 = 4e-6;

/// The supervisor and its state between decisions.
#[derive(Debug, Clone)]
pub(crate) struct Supervisor<const N: usize> {
    bounds: Bounds<N>,
    rate: f64,
    predictions: Predictions,
    benefit: Benefit<N>,
    engagement: Engagement,
    /// Commanded part of an offset that acts at once.
    dose: Dose<N>,
    /// True if a correction is wanted at all.
    allowed: bool,
    held: bool,
    /// Acceleration of the last command, mm/s2.
    last_mm_s2: [f64; N],
}

impl<const N: usize> Supervisor<N> {
    /// Creates a supervisor at the start of a program.
    pub(crate) fn new(bounds: Bounds<N>) -> Self {
        Self {
            bounds,
            rate: 1.0,
            predictions: Predictions::NONE,
            benefit: Benefit::NONE,
            engagement: Engagement::START,
            dose: Dose::ALL,
            allowed: true,
            held: false,
            last_mm_s2: [0.0; N],
        }
    }

    /// Returns the bounds of the command.
    pub(crate) fn bounds(&self) -> &Bounds<N> {
        &self.bounds
    }

    /// Changes the bounds of the commands from the next decision on.
    pub(crate) fn hold_to(&mut self, bounds: Bounds<N>) {
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
        report: &SelfReport<N>,
    ) -> Command<N> {
        let (bad, good) = match &wanted {
            Some(wanted) => self.judge(window, measured, wanted, report),
            None => (Some((Cause::LostFeedback, None)), false),
        };
        let is_known = !matches!(bad, Some((Cause::NotANumber | Cause::LostFeedback, _)));
        let wanted = wanted.unwrap_or(Command::AS_PLANNED);
        let before = self.engagement.state();
        let state = self.engagement.go_on(&DecisionInputs {
            allowed: self.allowed,
            bad,
            good,
            over: before == State::Fading && fade::is_over(window.offset_mm, window.offset_mm_s),
            moves: window.now().feed_mm_s > 0.0,
            period_s: window.feed_period_s,
        });
        let planned_mm_s2 = bounds::planned_mm_s2(window);
        let asked = match state {
            _ if report.acts_at_once => {
                self.dose.learn(report.learned);
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
                self.at_once(window, &wanted, (state, is_known), planned_mm_s2)
            }
            State::Engaged => wanted,
            State::Shadow => Command::AS_PLANNED,
            State::Fading => self.faded(window),
        };
        let command = self
            .bounds
            .hold(window, asked, self.rate, report.acts_at_once);
        self.held = state == State::Engaged && (command != asked || self.dose.is_reduced());
        self.rate = command.rate;
        let offset_mm_s2 = bounds::offset_mm_s2(window, command.offset_mm);
        self.last_mm_s2 = add_scaled(planned_mm_s2, 1.0, offset_mm_s2);
        command
    }

    /// Returns the command of a controller that acts at once: the part of its offset that is due,
    /// within the acceleration that the machine's owner allows. Unless `is_known`, the requested
    /// offset is unknown, and the offset goes back from its last place.
    fn at_once(
        &mut self,
        window: &Window<'_, N>,
        wanted: &Command<N>,
        (state, is_known): (State, bool),
        planned_mm_s2: [f64; N],
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
                if is_known && self.bounds.limits_acceleration() {
                    core::array::from_fn(|axis| nearer(due_mm[axis], faded_mm[axis]))
                } else {
                    faded_mm
                }
            }
        };
        let offset_mm =
            self.bounds
                .accelerated_mm(window, due_mm, [planned_mm_s2, self.last_mm_s2]);
        // What is cut off by the limits of the axes alone is soon made up: the plan leaves room.
        if self.bounds.engaged_mm_s2 < f64::INFINITY {
            self.dose.take_in(sub(due_mm, offset_mm), period_s);
        }
        Command {
            offset_mm,
            ..if is_in { *wanted } else { Command::AS_PLANNED }
        }
    }

    /// Returns the reason to disengage the controller with its evidence, and true if the
    /// predictions are good.
    fn judge(
        &mut self,
        window: &Window<'_, N>,
        measured: &Measured<N>,
        wanted: &Command<N>,
        report: &SelfReport<N>,
    ) -> (Option<(Cause, Option<FaultEvidence>)>, bool) {
        let sum = wanted.rate + wanted.offset_mm.iter().chain(&wanted.bend_mm).sum::<f64>();
        let predictions = self.predictions.judge(report, self.bounds.deviation_mm);
        // Where the predictions are invalid, so is the reported effect of the offset.
        let is_valid =
            !matches!(report.model, Verdict::Wrong { .. }) && report.missed_mm.is_finite();
        let harm = if is_valid {
            self.benefit.harm(
                window,
                measured.position_mm,
                &measured.contour,
                report.moved_mm,
            )
        } else {
            None
        };
        let bad = if !sum.is_finite() {
            Some((Cause::NotANumber, None))
        } else if let Verdict::Wrong { evidence } = predictions {
            Some((Cause::WrongPredictions, evidence))
        } else {
            harm.filter(|_| report.corrects)
                .map(|harm| (Cause::Harmful, Some(harm)))
        };
        (bad, matches!(predictions, Verdict::Sound))
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
        if !self.bounds.limits_acceleration() {
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
