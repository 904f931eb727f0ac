//! The safety layer: it stands between every controller and the machine.
//!
//! It holds each command within [`Bounds`], and follows a controller only while it can be trusted: a correction that fails
//! leaves the loop at once, and comes back after its predictions have held for a while.
//!
//! | File | What |
//! |---|---|
//! | `safety/feedback.rs` | whether the measured position can be true |
//! | `safety/benefit.rs` | the contour error with and without the correction |
//! | `safety/disengagement.rs` | the states: shadow, engaged, fading |
//! | `safety/fade.rs` | the way of the offset back to the path |

mod benefit;
pub(crate) mod disengagement;
mod fade;
pub(crate) mod feedback;

use crate::contour_error::locate;
use crate::controller::{Command, Controller, FaultEvidence, Measured};
use crate::vector::{add_scaled, bounded, dot, limit_norm, norm, scale, smooth_step, sub};
use crate::window::Window;
use benefit::Benefit;
use disengagement::Engagement;
pub use disengagement::{Cause, Fade, State};
pub use fade::fade_acceleration;

/// Slowest that any controller may run the plan: a program always ends.
const SLOWEST: f64 = 0.1;
/// Fastest where nobody says otherwise: no command leaps.
const FASTEST: f64 = 3.0;
/// Time in which the correction may take up the highest speed it is allowed, s. Feedforward of the exact model takes as
/// little at a corner; of what leaps more, no machine could follow any.
const TAKE_UP_S: f64 = 0.001;
/// A correction that acts at once takes at least this long to come back, s: twice the time constant of a usual position loop.
const LEAST_BACK_S: f64 = 0.04;
/// Decisions in a row with a wrong prediction. One is a shock, which no model foresees.
const WRONG_DECISIONS: u32 = 4;
/// A prediction is wrong where it misses by this part of the largest deviation.
const WRONG_SHARE: f64 = 0.2;
/// A prediction that misses by less than this is not worth a word, mm, however small the largest deviation is.
const MIN_WRONG_MM: f64 = 0.02;
/// A prediction is good where it misses by less than this part of a wrong one.
const GOOD_SHARE: f64 = 0.5;
/// Decisions in a row in which harm is foreseen.
const FORESEEN_DECISIONS: u32 = 8;
/// Harm is foreseen where the mean square of the contour error over the horizon is beyond this many times that without the
/// correction, and this much, mm^2 (10 um).
const FORESEEN: f64 = 4.0;
const FORESEEN_MM2: f64 = 1e-4;

/// What the command is held to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Distance of the command from the path, mm.
    pub deviation_mm: f64,
    /// Speed of the offset, mm/s.
    pub speed_mm_s: f64,
    /// Acceleration of the offset and, along the path, of the feed against the planned, mm/s2, of any controller. Its jerk is
    /// bounded with it: the acceleration changes only from one feed period to the next, by no more than twice this.
    pub acceleration_mm_s2: f64,
    /// Acceleration of an offset that fades, mm/s2.
    pub fade_mm_s2: f64,
    /// Fastest that a controller may run the plan, as a part of its speed.
    pub fastest: f64,
}

impl Bounds {
    /// For a machine whose rapid motions run at `rapid_mm_s` and whose corrections accelerate by `correction_mm_s2`.
    pub fn new(deviation_mm: f64, rapid_mm_s: f64, correction_mm_s2: f64) -> Self {
        let acceleration_mm_s2 = rapid_mm_s / TAKE_UP_S;
        let fade_mm_s2 = correction_mm_s2;
        Self { deviation_mm, speed_mm_s: rapid_mm_s, acceleration_mm_s2, fade_mm_s2, fastest: FASTEST }
    }

    /// With at most `percent` above the planned feedrate.
    pub fn feed_rise(self, percent: Option<f64>) -> Self {
        Self { fastest: percent.map_or(FASTEST, |percent| 1.0 + percent / 100.0), ..self }
    }
}

/// The layer and its state between decisions.
#[derive(Debug, Clone)]
pub(crate) struct Guard<const N: usize> {
    bounds: Bounds,
    rate: f64,
    wrong: u32,
    foreseen: u32,
    benefit: Benefit<N>,
    engagement: Engagement,
    /// Time in which a correction comes back, s.
    take_up_s: f64,
}

impl<const N: usize> Guard<N> {
    /// At the start of a program.
    pub(crate) fn new(bounds: Bounds) -> Self {
        Self {
            bounds,
            rate: 1.0,
            wrong: 0,
            foreseen: 0,
            benefit: Benefit::NONE,
            engagement: Engagement::START,
            take_up_s: LEAST_BACK_S,
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

    /// When and why the controller was taken out of the loop last.
    pub(crate) fn fade(&self) -> Option<Fade> {
        self.engagement.fade()
    }

    /// Whether the controller is in the loop.
    pub(crate) fn state(&self) -> State {
        self.engagement.state()
    }

    /// The command of the next feed period: the controller's, within the bounds, or the way back to the path. `lost` says
    /// that the measured position was not there.
    #[inline]
    pub(crate) fn decide<C>(
        &mut self,
        controller: &mut C,
        window: &Window<'_, N>,
        measured: &Measured<N>,
        lost: bool,
    ) -> Command<N>
    where
        C: Controller<N> + ?Sized,
    {
        let (wanted, bad) = if lost {
            controller.observe(window, None);
            (Command::AS_PLANNED, Some((Cause::LostFeedback, None)))
        } else {
            controller.observe(window, Some(measured));
            let wanted = controller.command(window, measured);
            let bad = self.judge(controller, window, measured, &wanted);
            (wanted, bad)
        };
        let good = controller.prediction_error_mm() < GOOD_SHARE * self.wrong_mm();
        let over = fade::is_over(window.offset_mm, window.offset_mm_s);
        let at_once = controller.acts_at_once();
        let asked = match self.engagement.go_on(bad, good, over, window.feed_period_s) {
            State::Engaged if at_once => self.taken_up(wanted, window.feed_period_s),
            State::Engaged => wanted,
            State::Shadow => Command::AS_PLANNED,
            State::Fading => self.faded(window, at_once),
        };
        let command = self.hold(window, asked, at_once);
        self.rate = command.rate;
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

    /// Why a controller must not be followed, and what that rests on. It hears how well it did.
    fn judge<C>(
        &mut self,
        controller: &mut C,
        window: &Window<'_, N>,
        measured: &Measured<N>,
        wanted: &Command<N>,
    ) -> Option<(Cause, Option<FaultEvidence>)>
    where
        C: Controller<N> + ?Sized,
    {
        let sum = wanted.rate + wanted.offset_mm.iter().chain(&wanted.bend_mm).sum::<f64>();
        let prediction_error_mm = controller.prediction_error_mm();
        self.wrong = match prediction_error_mm {
            f64::INFINITY => WRONG_DECISIONS,
            wrong_mm if wrong_mm > self.wrong_mm() => self.wrong + 1,
            _ => 0,
        };
        let [with_mm2, without_mm2] = controller.foreseen_mm2();
        let allowed_mm2 = FORESEEN_MM2 + FORESEEN * without_mm2;
        let foreseen = with_mm2 > allowed_mm2;
        self.foreseen = if foreseen { self.foreseen + 1 } else { 0 };
        // Where nothing that is predicted can be true, neither can what an offset is said to have done.
        let harm = if prediction_error_mm < f64::INFINITY {
            self.benefit.harm(window, measured.position_mm, &measured.contour, controller.moved_mm())
        } else {
            None
        };
        controller.judged(self.benefit.overdone());
        if !sum.is_finite() {
            Some((Cause::NotANumber, None))
        } else if self.wrong >= WRONG_DECISIONS {
            let missed = FaultEvidence { found_mm: prediction_error_mm, limit_mm: self.wrong_mm() };
            Some((Cause::WrongPredictions, controller.doubt().or(Some(missed))))
        } else if controller.corrects() && (harm.is_some() || self.foreseen >= FORESEEN_DECISIONS) {
            let foreseen = FaultEvidence { found_mm: libm::sqrt(with_mm2), limit_mm: libm::sqrt(allowed_mm2) };
            Some((Cause::Harmful, harm.or(Some(foreseen))))
        } else {
            None
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

    /// The command within the bounds. That of the deviation goes before the others. An offset that is there at once is one from the
    /// path as it is now, any other from where it leads to in a feed period.
    fn hold(&self, window: &Window<'_, N>, wanted: Command<N>, at_once: bool) -> Command<N> {
        let period_s = window.feed_period_s;
        let Bounds { deviation_mm, speed_mm_s, acceleration_mm_s2, .. } = self.bounds;
        // One that acts at once may step as far in a shorter period as in the time in which a correction takes up its speed, and may stop
        // at once.
        let longer = if at_once { (TAKE_UP_S / period_s).max(1.0) } else { 1.0 };
        let velocity = scale(1.0 / period_s, sub(wanted.offset_mm, window.offset_mm));
        let velocity = if at_once && norm(velocity) <= norm(window.offset_mm_s) {
            velocity
        } else {
            let change = limit_norm(sub(velocity, window.offset_mm_s), longer * longer * acceleration_mm_s2 * period_s);
            add_scaled(window.offset_mm_s, 1.0, change)
        };
        let velocity = limit_norm(velocity, longer * speed_mm_s);
        let step = acceleration_mm_s2 * period_s / window.now().feed_mm_s.max(f64::MIN_POSITIVE);
        let rate = bounded(bounded(wanted.rate, SLOWEST, self.bounds.fastest), self.rate - step, self.rate + step);
        // Where nothing binds, the offset is the controller's to the bit.
        let free = add_scaled(window.offset_mm, period_s, velocity);
        let same = norm(sub(free, wanted.offset_mm)) <= SAME_MM;
        let offset_mm = if same { wanted.offset_mm } else { free };
        let near_mm = if at_once {
            near_the_path(window, 0.0, offset_mm, deviation_mm)
        } else {
            let end_mm = near_the_path(window, rate * period_s, offset_mm, deviation_mm);
            self.near_on_the_way(window, rate * period_s, end_mm)
        };
        if same && near_mm == offset_mm {
            return Command { rate, ..wanted };
        }
        // What the path takes back comes on top, but not without bound.
        let step_mm = limit_norm(sub(near_mm, window.offset_mm), MAX_TAKEN_BACK * longer * speed_mm_s * period_s);
        Command::straight(rate, add_scaled(window.offset_mm, 1.0, step_mm))
    }

    /// The offset moves along a line, the path perhaps not: on the way it may be too far where neither end is. Its end then
    /// moves towards the path, and the step is no longer than it may be.
    fn near_on_the_way(&self, window: &Window<'_, N>, ahead_s: f64, end_mm: [f64; N]) -> [f64; N] {
        let mut near_mm = end_mm;
        for part in ON_THE_WAY {
            let there_mm = add_scaled(window.offset_mm, part, sub(near_mm, window.offset_mm));
            let back_mm = sub(near_the_path(window, part * ahead_s, there_mm, self.bounds.deviation_mm), there_mm);
            if norm(back_mm) > 0.0 {
                near_mm = add_scaled(near_mm, 1.0 / part, back_mm);
            }
        }
        if near_mm == end_mm {
            return end_mm;
        }
        let step_mm = limit_norm(sub(near_mm, window.offset_mm), self.bounds.speed_mm_s * window.feed_period_s);
        let near_mm = add_scaled(window.offset_mm, 1.0, step_mm);
        near_the_path(window, ahead_s, near_mm, self.bounds.deviation_mm)
    }
}

/// Parts of the way of the offset in a feed period at which its deviation is looked at.
const ON_THE_WAY: [f64; 3] = [0.75, 0.5, 0.25];
/// The bound of the deviation may move the command by this many times the highest speed of the offset.
const MAX_TAKEN_BACK: f64 = 2.0;
/// Offsets closer than this differ by rounding only, mm.
const SAME_MM: f64 = 1e-12;

/// Looks at the path, of eight knots to either side each, before the nearest point counts as found.
const MAX_LOOKS: usize = 8;

/// The offset `ahead_s` from now in plan time, taken back towards the path where the command would be further from it than
/// `limit_mm`. An offset along the path is none from the path.
fn near_the_path<const N: usize>(window: &Window<'_, N>, ahead_s: f64, offset_mm: [f64; N], limit_mm: f64) -> [f64; N] {
    if norm(offset_mm) <= limit_mm {
        return offset_mm;
    }
    let next = window.preview.at(window.tau_s + ahead_s);
    // Beyond the knots that the window holds nobody knows where the path is.
    let [oldest, farthest] = window.range();
    let known = window.knot(if dot(offset_mm, next.tangent) < 0.0 { oldest } else { farthest });
    let known_mm = norm(sub(known.position_mm, next.position_mm));
    let offset_mm = limit_norm(offset_mm, known_mm.max(limit_mm));
    let command_mm = add_scaled(next.position_mm, 1.0, offset_mm);
    let lead_s = dot(offset_mm, next.tangent) / next.feed_mm_s;
    // Near rest the lead says nothing, and the point of the same instant is on the path, too: what is found must be nearer.
    let guesses = [ahead_s + lead_s, ahead_s].map(|guess_s| way_to_the_path(window, command_mm, guess_s));
    let nearer = |a: [f64; N], b: [f64; N]| if norm(b) < norm(a) { b } else { a };
    let back_mm = guesses.into_iter().fold(scale(-1.0, offset_mm), nearer);
    let too_far_mm = norm(back_mm) - limit_mm;
    if too_far_mm <= 0.0 {
        return offset_mm;
    }
    add_scaled(offset_mm, too_far_mm / norm(back_mm), back_mm)
}

/// From a command to the nearest point of the path, looked for from a time after now on.
fn way_to_the_path<const N: usize>(window: &Window<'_, N>, command_mm: [f64; N], guess_s: f64) -> [f64; N] {
    // A float that is too large, or not a number, saturates; the window clamps it.
    let near = libm::round(guess_s / window.servo_s()) as i32;
    let mut nearest = locate(window, command_mm, near, 0);
    // Behind, the knots are as far apart as the rate made them, and the guess may be off.
    for _ in 0..MAX_LOOKS {
        let again = locate(window, command_mm, nearest.index, 0);
        if again.index == nearest.index {
            break;
        }
        nearest = again;
    }
    nearest.vector_mm
}
