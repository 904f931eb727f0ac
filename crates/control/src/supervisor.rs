//! The supervisor: it stands between every controller and the machine, in a simulation as in a
//! servo thread.
//!
//! It holds each command within [`Bounds`], and follows a controller only while the tool is nearer
//! to the path by it:
//!
//! | Seen | Test | Then |
//! |---|---|---|
//! | the position is lost | it is no number, moves faster than the machine can, or stands still while the command moves | out at once |
//! | the command is no number | | out at once |
//! | on a machine for the first time | a law that predicts half of what there is to correct, in motion without a correction | not in before |
//! | the law of the controller is wrong | free runs by it miss more than there is to correct, twice in a row or once by twice as much | out at once |
//! | predictions are wrong | four in a row miss by a fifth of the largest deviation | out at once |
//! | harm | the error is beyond 1.5 times that without the correction, and 5 um (mean square over 0.25 s) or 30 um (a single error) | out at once |
//! | [`Bounds::engaged_mm_s2`] keeps the offset from what is asked for | | less of it is commanded |
//! | servo periods do not go as the law says | innovations, over 5 ms | it asks for less |
//! | the command was held to a bound | | it asks for less |
//! | nothing of this, for a while | 0.1 s of motion, and twice as long out as the last time | back in, within 40 ms or more |
//!
//! Out is a fade within [`Bounds::fade_mm_s2`]: less and less of what is asked for now, or the way
//! back of an offset of which nothing is known any more. While a controller is out it goes on
//! learning.
//!
//! Each wrong prediction of a law counts only beyond four standard deviations of noise, and twice;
//! a learned law is taken for better than a right one in one of a thousand trials
//! (`controller/lqg_preview/learning.rs`).
//!
//! The bound of the harm, by a controller that harms as it likes within its bounds and knows what
//! its offset does, on a machine with a lag of 20 ms: no error is beyond 1.5 times the largest
//! without it, 30 um and half the largest deviation; none stays beyond the first two for longer
//! than 0.15 s; and the mean square is at most 1.75 times that without it and (5 um)^2.
//! `tests/property_supervisor.rs` attacks it.
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
//! | `supervisor/dose.rs` | how much of an offset is commanded |
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

/// Decisions in a row with a wrong prediction. One is a shock, which no model foresees.
const WRONG_DECISIONS: u32 = 4;
/// A prediction is wrong where it misses by this part of the largest deviation.
const WRONG_SHARE: f64 = 0.2;
/// A prediction that misses by less than this is not worth a word, mm, however small the largest
/// deviation is.
const MIN_WRONG_MM: f64 = 0.02;
/// A prediction is good where it misses by less than this part of a wrong one.
const GOOD_SHARE: f64 = 0.5;
/// What a controller says of itself behind a decision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SelfReport<const N: usize> {
    /// By how much its last prediction missed, mm; infinite where its law is wrong, and what that
    /// rests on.
    pub(crate) prediction_error_mm: f64,
    pub(crate) doubt: Option<FaultEvidence>,
    /// By how much its offset has moved the tool, mm, where it knows.
    pub(crate) moved_mm: Option<[f64; N]>,
    /// Whether it means to make the contour error smaller.
    pub(crate) corrects: bool,
    /// Whether its offset is there at once.
    pub(crate) acts_at_once: bool,
    /// Which axes it corrects by what it learned.
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
    /// How much of an offset that acts at once is commanded.
    dose: Dose<N>,
    /// Whether a correction is wanted at all.
    allowed: bool,
    held: bool,
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
            dose: Dose::ALL,
            allowed: true,
            held: false,
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

    /// The command of the next feed period: what the controller wanted, within the bounds, or the
    /// way back to the path. It wanted nothing where the position was lost.
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

    /// The command of a controller that acts at once: the part of its offset that is due, within
    /// the owner's acceleration. Where nothing `is_known` of what it asks for, the offset goes back
    /// from where it is.
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
        // Where nothing that is predicted can be true, neither can what an offset is said to have
        // done.
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
            // An infinite error is the controller's own judgment: nothing was measured.
            let measured = Some(missed).filter(|missed| missed.found_mm < f64::INFINITY);
            Some((Cause::WrongPredictions, told.doubt.or(measured)))
        } else {
            harm.filter(|_| told.corrects)
                .map(|harm| (Cause::Harmful, Some(harm)))
        }
    }

    /// A prediction that misses by more is wrong, mm.
    fn wrong_mm(&self) -> f64 {
        (WRONG_SHARE * self.bounds.deviation_mm).max(MIN_WRONG_MM)
    }

    /// The next step of the way back to the path, at the feed of the plan.
    fn faded(&self, window: &Window<'_, N>) -> Command<N> {
        let acceleration_mm_s2 = self.fade_mm_s2(window, window.offset_mm_s);
        Command::accelerated(window, window.offset_mm_s, acceleration_mm_s2)
    }

    /// Where an offset that is there at once is a period further on its way back, mm. What is there
    /// in one step has no speed that it has to go on with where no acceleration is asked of it.
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

    /// The acceleration of an offset on its way back that has this speed, mm/s2.
    fn fade_mm_s2(&self, window: &Window<'_, N>, speed_mm_s: [f64; N]) -> [f64; N] {
        let mut acceleration_mm_s2 = speed_mm_s;
        let axes = acceleration_mm_s2.iter_mut().zip(window.offset_mm);
        axes.for_each(|(of, offset_mm)| {
            *of = fade_acceleration(offset_mm, *of, window.feed_period_s, self.bounds.fade_mm_s2);
        });
        acceleration_mm_s2
    }
}

/// What is due of an offset that fades, but no more than its way back has, mm.
fn nearer(due_mm: f64, faded_mm: f64) -> f64 {
    if due_mm * faded_mm > 0.0 && due_mm.abs() < faded_mm.abs() {
        due_mm
    } else {
        faded_mm
    }
}
