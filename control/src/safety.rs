//! The safety layer: it stands between every controller and the machine.
//!
//! It holds each command within [`Bounds`], and takes a controller out of the loop for good where it cannot be trusted
//! any more ([`Cause`]): within [`FADE_S`] the offset and the rate go over into the plan, and the rest is cut open loop.
//!
//! The offset fades along the quintic that leaves with the offset and the speed it has and arrives at rest,
//!
//! ```text
//! o(s) = o0 (1 - 10 s^3 + 15 s^4 - 6 s^5) + v0 T (s - 6 s^3 + 8 s^4 - 3 s^5),   s = t / T
//! ```
//!
//! Source: quintic between states of rest, as in Biagiotti and Melchiorri (2008), section 2.1.7.

use crate::contour_error::{ContourError, locate};
use crate::controller::{Command, Controller, Measured};
use crate::vector::{add_scaled, dot, limit_norm, norm, reject, scale, sub};
use crate::window::Window;

/// Time in which a controller that is not trusted any more leaves the loop, s: five time constants of a position loop
/// of 50 1/s, so that the tool follows without a transient of its own.
pub const FADE_S: f64 = 0.1;
/// Slowest and fastest that any controller may run the plan: a program always ends, and no command leaps.
const RATE_RANGE: [f64; 2] = [0.1, 3.0];
/// Time in which the correction may take up the highest speed it is allowed, s. Feedforward of the exact model takes as
/// little at a corner; of what leaps more, no machine could follow any.
const TAKE_UP_S: f64 = 0.001;
/// Decisions in a row without a measurement that a controller bridges by holding its offset. One is a glitch of a bus.
const LOST_DECISIONS: u32 = 3;
/// Decisions in a row with a wrong prediction. One is a shock, which no model foresees.
const WRONG_DECISIONS: u32 = 4;
/// A prediction is wrong where it misses by this part of the largest deviation.
const WRONG_SHARE: f64 = 0.2;
/// A prediction that misses by less than this is not worth a word, mm, however small the largest deviation is.
const LEAST_WRONG_MM: f64 = 0.02;
/// A tool that has not moved at all while the plan went on by this and twice the deviation is not measured, mm: no
/// machine lags so far that it has not even begun.
const LEAST_NAILED_MM: f64 = 0.5;

/// What the command is held to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Distance of the command from the path, mm.
    pub deviation_mm: f64,
    /// Speed of the offset, mm/s.
    pub speed_mm_s: f64,
    /// Acceleration of the offset and, along the path, of the feed against the planned, mm/s2. Its jerk is bounded with
    /// it: the acceleration changes only from one feed period to the next, by no more than twice this.
    pub acceleration_mm_s2: f64,
}

impl Bounds {
    /// For a machine whose rapid motions run at `rapid_mm_s`.
    pub fn new(deviation_mm: f64, rapid_mm_s: f64) -> Self {
        Self { deviation_mm, speed_mm_s: rapid_mm_s, acceleration_mm_s2: rapid_mm_s / TAKE_UP_S }
    }
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
    /// It made the contour error larger than it would have been without.
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
    /// Decisions made before it.
    pub decision: u64,
}

/// The layer and its state between decisions.
#[derive(Debug, Clone)]
pub struct Guard<const N: usize> {
    bounds: Bounds,
    decisions: u64,
    /// Offset rate, mm/s, and rate of the feed period that ends.
    velocity_mm_s: [f64; N],
    rate: f64,
    /// The last position that can be true, mm, and how far the plan has gone since the position last changed, mm.
    position_mm: Option<[f64; N]>,
    gone_mm: f64,
    lost: u32,
    wrong: u32,
    benefit: Benefit<N>,
    fading: Option<Fading<N>>,
}

/// A fade under way or done.
#[derive(Debug, Clone, Copy)]
struct Fading<const N: usize> {
    fade: Fade,
    offset_mm: [f64; N],
    velocity_mm_s: [f64; N],
    rate: f64,
}

impl<const N: usize> Guard<N> {
    /// At the start of a program.
    pub fn new(bounds: Bounds) -> Self {
        Self {
            bounds,
            decisions: 0,
            velocity_mm_s: [0.0; N],
            rate: 1.0,
            position_mm: None,
            gone_mm: 0.0,
            lost: 0,
            wrong: 0,
            benefit: Benefit::NONE,
            fading: None,
        }
    }

    /// Whether, when and why the controller was taken out.
    pub fn fade(&self) -> Option<Fade> {
        self.fading.map(|fading| fading.fade)
    }

    /// The command of the next feed period: the controller's, within the bounds, or the fade.
    #[inline]
    pub fn decide<C>(&mut self, controller: &mut C, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N>
    where
        C: Controller<N> + ?Sized,
    {
        let wanted = if self.fading.is_some() { None } else { self.ask(controller, window, measured) };
        let wanted = wanted.unwrap_or_else(|| self.without_controller(window));
        let command = self.hold(window, wanted);
        self.velocity_mm_s = scale(1.0 / window.feed_period_s, sub(command.offset_mm, window.offset_mm));
        self.rate = command.rate;
        self.decisions += 1;
        command
    }

    /// What the controller wants; nothing where it is not asked, or not trusted.
    fn ask<C>(&mut self, controller: &mut C, window: &Window<'_, N>, measured: &Measured<N>) -> Option<Command<N>>
    where
        C: Controller<N> + ?Sized,
    {
        if !self.believes(window, measured.position_mm) {
            self.lost += 1;
            self.fade_where(self.lost == LOST_DECISIONS, Cause::LostFeedback, window);
            return None;
        }
        self.lost = 0;
        controller.observe(measured);
        let command = controller.command(window, measured);
        let finite = command.rate.is_finite() && command.offset_mm.iter().all(|o| o.is_finite());
        let missed = controller.missed_mm() > (WRONG_SHARE * self.bounds.deviation_mm).max(LEAST_WRONG_MM);
        self.wrong = if missed { self.wrong + 1 } else { 0 };
        let harmful = self.benefit.is_harm(window, &measured.contour);
        self.fade_where(!finite, Cause::NotANumber, window);
        self.fade_where(self.wrong == WRONG_DECISIONS, Cause::WrongPredictions, window);
        self.fade_where(harmful && controller.corrects(), Cause::Harmful, window);
        if self.fading.is_some() { None } else { Some(command) }
    }

    /// Whether a tool can be there: not further from where it was than twice the highest speed leads, and not nailed
    /// down while the plan goes on.
    fn believes(&mut self, window: &Window<'_, N>, position_mm: [f64; N]) -> bool {
        let Some(last_mm) = self.position_mm else {
            self.position_mm = norm(position_mm).is_finite().then_some(position_mm);
            return self.position_mm.is_some();
        };
        let periods = f64::from(self.lost + 1);
        let moved_mm = norm(sub(position_mm, last_mm));
        let can_mm = self.bounds.deviation_mm + 2.0 * self.bounds.speed_mm_s * window.feed_period_s * periods;
        self.gone_mm += window.now().feed_mm_s * window.feed_period_s;
        if moved_mm.is_nan() || moved_mm > can_mm {
            return false;
        }
        if moved_mm > 0.0 {
            self.gone_mm = 0.0;
            self.position_mm = Some(position_mm);
        }
        self.gone_mm <= 2.0 * self.bounds.deviation_mm + LEAST_NAILED_MM
    }

    fn fade_where(&mut self, condition: bool, cause: Cause, window: &Window<'_, N>) {
        if condition && self.fading.is_none() {
            self.fading = Some(Fading {
                fade: Fade { cause, decision: self.decisions },
                offset_mm: window.offset_mm,
                velocity_mm_s: self.velocity_mm_s,
                rate: self.rate,
            });
        }
    }

    /// The fade, or what bridges a glitch: the offset as it is, the feed as planned.
    fn without_controller(&self, window: &Window<'_, N>) -> Command<N> {
        let Some(fading) = self.fading else { return Command { rate: 1.0, offset_mm: window.offset_mm } };
        let period_s = window.feed_period_s;
        let s = ((self.decisions + 1 - fading.fade.decision) as f64 * period_s / FADE_S.max(period_s)).min(1.0);
        let cube = s * s * s;
        let left = 1.0 - cube * (10.0 - s * (15.0 - 6.0 * s));
        let moved_s = FADE_S.max(period_s) * (s - cube * (6.0 - s * (8.0 - 3.0 * s)));
        Command {
            rate: 1.0 + (fading.rate - 1.0) * left,
            offset_mm: add_scaled(scale(left, fading.offset_mm), moved_s, fading.velocity_mm_s),
        }
    }

    /// The command within the bounds. That of the deviation goes before the others.
    fn hold(&self, window: &Window<'_, N>, wanted: Command<N>) -> Command<N> {
        let period_s = window.feed_period_s;
        let Bounds { deviation_mm, speed_mm_s, acceleration_mm_s2 } = self.bounds;
        let velocity = scale(1.0 / period_s, sub(wanted.offset_mm, window.offset_mm));
        let change = limit_norm(sub(velocity, self.velocity_mm_s), acceleration_mm_s2 * period_s);
        let velocity = limit_norm(add_scaled(self.velocity_mm_s, 1.0, change), speed_mm_s);
        let step = acceleration_mm_s2 * period_s / window.now().feed_mm_s.max(f64::MIN_POSITIVE);
        let rate = wanted.rate.clamp(RATE_RANGE[0], RATE_RANGE[1]).clamp(self.rate - step, self.rate + step);
        // Where nothing binds, the offset is the controller's to the bit.
        let free = add_scaled(window.offset_mm, period_s, velocity);
        let same = norm(sub(free, wanted.offset_mm)) <= SAME_MM;
        let offset_mm = if same { wanted.offset_mm } else { free };
        let end_mm = near_the_path(window, rate * period_s, offset_mm, deviation_mm);
        let near_mm = self.near_on_the_way(window, rate * period_s, end_mm);
        // What the path takes back comes on top, but not without bound.
        let step_mm = limit_norm(sub(near_mm, window.offset_mm), MOST_TAKEN_BACK * speed_mm_s * period_s);
        let held = norm(sub(near_mm, offset_mm)) > 0.0;
        Command { rate, offset_mm: if held { add_scaled(window.offset_mm, 1.0, step_mm) } else { offset_mm } }
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
const MOST_TAKEN_BACK: f64 = 2.0;
/// Offsets closer than this differ by rounding only, mm.
const SAME_MM: f64 = 1e-12;

/// Whether the correction does any good: the contour error eps as it is, against what it would be without,
///
/// ```text
/// eps_open = eps + o_f     o_f = offset, behind a lag of first order with the time by which the tool is behind
/// ```
///
/// across the path, both as mean squares over the last [`Benefit::MEMORY_S`]. In a loop that follows its command the
/// tool is off by the offset of then; where the correction has made the loop swing, most of eps is of its own making and
/// eps_open is small.
#[derive(Debug, Clone)]
struct Benefit<const N: usize> {
    filtered_mm: [f64; N],
    last_mm: [f64; N],
    square_mm2: f64,
    open_square_mm2: f64,
}

impl<const N: usize> Benefit<N> {
    const NONE: Self = Self { filtered_mm: [0.0; N], last_mm: [0.0; N], square_mm2: 0.0, open_square_mm2: 0.0 };
    /// Longer than a corner, shorter than a scrapped part.
    const MEMORY_S: f64 = 0.25;
    /// The estimate of what would be without is good to about this factor in the squares.
    const CERTAIN: f64 = 2.0;
    /// An RMS contour error below this is nobody's harm, mm.
    const LEAST_MM: f64 = 0.01;

    fn is_harm(&mut self, window: &Window<'_, N>, contour: &ContourError<N>) -> bool {
        let period_s = window.feed_period_s;
        let lag_s = f64::from((-contour.index).max(0)) * window.servo_s();
        // The tool has felt the offset of the feed period that ends, not the one that it ends with.
        let felt = scale(0.5, add_scaled(window.offset_mm, 1.0, self.last_mm));
        self.last_mm = window.offset_mm;
        let change = sub(felt, self.filtered_mm);
        self.filtered_mm = add_scaled(self.filtered_mm, period_s / (period_s + lag_s), change);
        let open = add_scaled(contour.vector_mm, 1.0, reject(self.filtered_mm, contour.tangent));
        let part = (period_s / Self::MEMORY_S).min(1.0);
        self.square_mm2 += part * (dot(contour.vector_mm, contour.vector_mm) - self.square_mm2);
        self.open_square_mm2 += part * (dot(open, open) - self.open_square_mm2);
        self.square_mm2 > Self::LEAST_MM * Self::LEAST_MM + Self::CERTAIN * self.open_square_mm2
    }
}

/// Looks at the path, of eight knots to either side each, before the nearest point counts as found.
const MOST_LOOKS: usize = 8;

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
    for _ in 0..MOST_LOOKS {
        let again = locate(window, command_mm, nearest.index, 0);
        if again.index == nearest.index {
            break;
        }
        nearest = again;
    }
    nearest.vector_mm
}
