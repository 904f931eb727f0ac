//! Question: is a command permitted? The bounds hold for every controller.
//!
//! | Bound | Quantity | Value |
//! |---|---|---|
//! | deviation | distance of the command from the path; it has priority over the others | set for the machine |
//! | speed | speed of the offset | the speed of a rapid motion |
//! | acceleration | acceleration of the offset, and of the feed against the plan | the speed within [`TAKE_UP_S`] |
//! | command's acceleration | acceleration of path and offset of each axis, and its change in a servo period | set for the axis |
//! | rate | rate of plan time | [`SLOWEST`] to [`FASTEST`], or the permitted rise of the feed |
//!
//! An offset along the path does not count as a deviation. The path is known as chords between the
//! knots of the window.

use crate::command::Command;
use crate::contour_error::locate;
use crate::vector::{add_scaled, bounded, dot, limit_norm, norm, scale, sub};
use crate::window::Window;

use super::fade;

/// Slowest rate at which a controller may run the plan: a program always ends.
const SLOWEST: f64 = 0.1;
/// Fastest rate without another setting: no command leaps.
const FASTEST: f64 = 3.0;
/// Time in which the correction may reach its highest speed, s. Feedforward of the exact model
/// takes as little at a corner; no machine could follow a command that leaps more.
const TAKE_UP_S: f64 = 0.001;
/// Parts of the motion of the offset in a feed period at which its deviation is checked.
const ON_THE_WAY: [f64; 3] = [0.75, 0.5, 0.25];
/// Factor on the highest speed of the offset with which the bound of the deviation may move the
/// command.
const MAX_TAKEN_BACK: f64 = 2.0;
/// Difference of offsets up to which they differ by rounding only, mm.
const SAME_MM: f64 = 1e-12;
/// Number of searches of the path, of eight knots to either side each, before the nearest point
/// counts as found.
const MAX_LOOKS: usize = 8;

/// Bounds of the command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds<const N: usize> {
    /// Distance of the command from the path, mm.
    pub deviation_mm: f64,
    /// Speed of the offset, mm/s.
    pub speed_mm_s: f64,
    /// Acceleration of the offset and, along the path, of the feed against the planned feed, mm/s2,
    /// for every controller. It also bounds the jerk: the acceleration changes only from one feed
    /// period to the next, by no more than twice this.
    pub acceleration_mm_s2: f64,
    /// Acceleration of an offset that fades, mm/s2.
    pub fade_mm_s2: f64,
    /// Acceleration of each axis of an engaged offset that acts at once, mm/s2.
    pub engaged_mm_s2: f64,
    /// Acceleration of the command of each axis, the path included, where an offset acts at once,
    /// mm/s2.
    pub command_mm_s2: [f64; N],
    /// Fastest rate at which a controller may run the plan, as a part of its speed.
    pub fastest: f64,
}

impl<const N: usize> Bounds<N> {
    /// Creates the bounds of a machine whose rapid motions run at `rapid_mm_s` and whose
    /// corrections accelerate by `correction_mm_s2`.
    pub fn new(deviation_mm: f64, rapid_mm_s: f64, correction_mm_s2: f64) -> Self {
        let acceleration_mm_s2 = rapid_mm_s / TAKE_UP_S;
        let fade_mm_s2 = correction_mm_s2;
        Self {
            deviation_mm,
            speed_mm_s: rapid_mm_s,
            acceleration_mm_s2,
            fade_mm_s2,
            engaged_mm_s2: f64::INFINITY,
            command_mm_s2: [f64::INFINITY; N],
            fastest: FASTEST,
        }
    }

    /// Returns the next step toward a due offset with which the command of each axis stays within
    /// its acceleration, and changes it by no more than the limit from the last one: as fast as it
    /// can still be braked there. The accelerations are those of the path and of the last command. A
    /// step within these bounds is followed to the bit. If the path itself exceeds them, the offset
    /// keeps its speed.
    pub(super) fn accelerated_mm(
        &self,
        window: &Window<'_, N>,
        due_mm: [f64; N],
        [planned_mm_s2, last_mm_s2]: [[f64; N]; 2],
    ) -> [f64; N] {
        let period_s = window.feed_period_s;
        core::array::from_fn(|axis| {
            let (due_mm, limit_mm_s2) = (due_mm[axis], self.command_mm_s2[axis]);
            let (from_mm, from_mm_s) = (window.offset_mm[axis], window.offset_mm_s[axis]);
            let offset_mm_s2 = self.engaged_mm_s2.min(limit_mm_s2);
            let room_mm_s = |way: f64| {
                let room_mm_s2 = limit_mm_s2 + (way * last_mm_s2[axis]).min(0.0);
                let left_mm_s2 = room_mm_s2 - way * planned_mm_s2[axis];
                period_s * left_mm_s2.max(0.0).min(offset_mm_s2)
            };
            let [least_mm_s, most_mm_s] = [-room_mm_s(-1.0), room_mm_s(1.0)];
            let way_mm = due_mm - from_mm;
            let due_mm_s = way_mm / period_s - from_mm_s;
            if due_mm_s < least_mm_s || due_mm_s > most_mm_s {
                let closing_mm_s = libm::sqrt(fade::MARGIN * offset_mm_s2 * way_mm.abs())
                    .min(way_mm.abs() / period_s);
                let change_mm_s = libm::copysign(closing_mm_s, way_mm) - from_mm_s;
                from_mm + period_s * (from_mm_s + bounded(change_mm_s, least_mm_s, most_mm_s))
            } else {
                due_mm
            }
        })
    }

    /// Returns true if the acceleration of a command is limited.
    pub(super) fn limits_acceleration(&self) -> bool {
        let limits_mm_s2 = self.command_mm_s2.into_iter();
        limits_mm_s2.fold(self.engaged_mm_s2, f64::min) < f64::INFINITY
    }

    /// Limits the feedrate to `percent` above the planned one.
    pub fn feed_rise(self, percent: Option<f64>) -> Self {
        Self {
            fastest: percent.map_or(FASTEST, |percent| 1.0 + percent / 100.0),
            ..self
        }
    }

    /// Returns the command within the bounds; `last_rate` is the rate until now. An offset that
    /// acts at once refers to the present point of the path, any other to the point of the path at
    /// the end of the feed period.
    pub(super) fn hold(
        &self,
        window: &Window<'_, N>,
        wanted: Command<N>,
        last_rate: f64,
        at_once: bool,
    ) -> Command<N> {
        let period_s = window.feed_period_s;
        let Self {
            deviation_mm,
            speed_mm_s,
            acceleration_mm_s2,
            fastest,
            ..
        } = *self;
        // An offset that acts at once may step as far in a shorter period as in the time in which a
        // correction reaches its speed, and may stop at once.
        let longer = if at_once {
            (TAKE_UP_S / period_s).max(1.0)
        } else {
            1.0
        };
        let velocity = scale(1.0 / period_s, sub(wanted.offset_mm, window.offset_mm));
        let velocity = if at_once && norm(velocity) <= norm(window.offset_mm_s) {
            velocity
        } else {
            let change = limit_norm(
                sub(velocity, window.offset_mm_s),
                longer * longer * acceleration_mm_s2 * period_s,
            );
            add_scaled(window.offset_mm_s, 1.0, change)
        };
        let velocity = limit_norm(velocity, longer * speed_mm_s);
        let step = acceleration_mm_s2 * period_s / window.now().feed_mm_s.max(f64::MIN_POSITIVE);
        let rate = bounded(
            bounded(wanted.rate, SLOWEST, fastest),
            last_rate - step,
            last_rate + step,
        );
        // Where no bound acts, the offset equals the controller's to the bit.
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
        // The step back to the path adds to the motion of the offset, within a bound.
        let step_mm = limit_norm(
            sub(near_mm, window.offset_mm),
            MAX_TAKEN_BACK * longer * speed_mm_s * period_s,
        );
        Command::straight(rate, add_scaled(window.offset_mm, 1.0, step_mm))
    }

    /// Keeps the deviation within its bound between the two ends of the motion. The offset moves
    /// along a line and the path may curve: the command may be too far from the path on the way
    /// even if it is not at either end. The end then moves toward the path, within the permitted
    /// step.
    fn near_on_the_way(&self, window: &Window<'_, N>, ahead_s: f64, end_mm: [f64; N]) -> [f64; N] {
        let mut near_mm = end_mm;
        for part in ON_THE_WAY {
            let there_mm = add_scaled(window.offset_mm, part, sub(near_mm, window.offset_mm));
            let back_mm = sub(
                near_the_path(window, part * ahead_s, there_mm, self.deviation_mm),
                there_mm,
            );
            if norm(back_mm) > 0.0 {
                near_mm = add_scaled(near_mm, 1.0 / part, back_mm);
            }
        }
        if near_mm == end_mm {
            return end_mm;
        }
        let step_mm = limit_norm(
            sub(near_mm, window.offset_mm),
            self.speed_mm_s * window.feed_period_s,
        );
        let near_mm = add_scaled(window.offset_mm, 1.0, step_mm);
        near_the_path(window, ahead_s, near_mm, self.deviation_mm)
    }
}

/// Returns the acceleration of an offset that is this one at the end of the feed period, mm/s2.
pub(super) fn offset_mm_s2<const N: usize>(
    window: &Window<'_, N>,
    offset_mm: [f64; N],
) -> [f64; N] {
    let per_s = 1.0 / window.feed_period_s;
    let speed_mm_s = scale(per_s, sub(offset_mm, window.offset_mm));
    scale(per_s, sub(speed_mm_s, window.offset_mm_s))
}

/// Returns the acceleration of the path in the last two servo periods, mm/s2.
pub(super) fn planned_mm_s2<const N: usize>(window: &Window<'_, N>) -> [f64; N] {
    let servo_s = window.servo_s();
    let [here_mm, last_mm, before_mm] =
        [0.0, -servo_s, -2.0 * servo_s].map(|after_s| window.at(after_s).position_mm);
    let change_mm = sub(sub(here_mm, last_mm), sub(last_mm, before_mm));
    scale(1.0 / (servo_s * servo_s), change_mm)
}

/// Returns the offset `ahead_s` from now in plan time, moved back toward the path where the command
/// would be farther from it than `limit_mm`. An offset along the path does not count as a distance.
fn near_the_path<const N: usize>(
    window: &Window<'_, N>,
    ahead_s: f64,
    offset_mm: [f64; N],
    limit_mm: f64,
) -> [f64; N] {
    if norm(offset_mm) <= limit_mm {
        return offset_mm;
    }
    let next = window.preview.at(window.tau_s + ahead_s);
    // The path is unknown beyond the knots of the window.
    let [oldest, farthest] = window.range();
    let known = window.knot(if dot(offset_mm, next.tangent) < 0.0 {
        oldest
    } else {
        farthest
    });
    let known_mm = norm(sub(known.position_mm, next.position_mm));
    let offset_mm = limit_norm(offset_mm, known_mm.max(limit_mm));
    let command_mm = add_scaled(next.position_mm, 1.0, offset_mm);
    let lead_s = dot(offset_mm, next.tangent) / next.feed_mm_s;
    // Near rest the lead is not meaningful, and the point of the same time is on the path, too: a
    // result must be nearer than that.
    let guesses =
        [ahead_s + lead_s, ahead_s].map(|guess_s| way_to_the_path(window, command_mm, guess_s));
    let nearer = |a: [f64; N], b: [f64; N]| if norm(b) < norm(a) { b } else { a };
    let back_mm = guesses.into_iter().fold(scale(-1.0, offset_mm), nearer);
    let too_far_mm = norm(back_mm) - limit_mm;
    if too_far_mm <= 0.0 {
        return offset_mm;
    }
    add_scaled(offset_mm, too_far_mm / norm(back_mm), back_mm)
}

/// Returns the vector from a command to the nearest point of the path. The search begins at a time
/// from now.
fn way_to_the_path<const N: usize>(
    window: &Window<'_, N>,
    command_mm: [f64; N],
    guess_s: f64,
) -> [f64; N] {
    // The cast saturates where the float is too large or NaN; the window clamps it.
    let near = libm::round(guess_s / window.servo_s()) as i32;
    let mut nearest = locate(window, command_mm, near, 0);
    // Behind the current knot, the distance of the knots depends on the past rate, and the guess
    // may be off.
    for _ in 0..MAX_LOOKS {
        let again = locate(window, command_mm, nearest.index, 0);
        if again.index == nearest.index {
            break;
        }
        nearest = again;
    }
    nearest.vector_mm
}
