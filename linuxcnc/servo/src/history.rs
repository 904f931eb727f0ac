//! The commands that were received lately, and the path that they make: positions alone, no
//! program.
//!
//! ```text
//! v(k) = (p(k+1) - p(k-1)) / 2 T                   where the path is smooth at k
//! v(k) = (p(k) - p(k-1)) / T                       where a corner lies behind it
//! v(k) = (p(k+1) - p(k)) / T                       where a corner lies before it
//! ```
//!
//! A corner is a chord that differs from both its neighbours, or a point between two straight
//! stretches. Source: central differences as of Catmull and Rom (1974), "A class of local
//! interpolating splines".

use feedwright_control::vector::{add_scaled, dot, norm, scale, sub};
use feedwright_control::{Knot, KnotSource};

use crate::through::{CHANNELS, Through};

/// Commands that are kept.
pub const KEPT: usize = 256;
/// Newer commands that a point needs for its velocity.
pub const NEWER: u64 = 2;
/// Cosine of a turn from one servo period to the next below which there may be a corner, 0.1 rad.
const TURN_COSINE: f64 = 0.995;
/// A stretch is straight beside a corner where it turns by less than this part of it.
const STRAIGHT: f64 = 0.25;
/// Commands nearer than this are the same place, mm.
pub const SAME_PLACE_MM: f64 = 1e-9;

/// A command.
#[derive(Debug, Clone, Copy)]
struct Received<const N: usize> {
    position_mm: [f64; N],
    /// Direction of the last motion.
    direction: [f64; N],
    cutting: bool,
    through: [f64; CHANNELS],
}

/// The last [`KEPT`] commands.
#[derive(Debug, Clone)]
pub struct History<const N: usize> {
    received: [Received<N>; KEPT],
    /// Commands received so far.
    count: u64,
    /// Servo periods in which neither the command nor a joint beside it has moved.
    at_rest: u64,
}

impl<const N: usize> History<N> {
    /// Nothing received.
    pub const EMPTY: Self = Self {
        received: [Received {
            position_mm: [0.0; N],
            direction: Knot::<N>::REST.tangent,
            cutting: false,
            through: [0.0; CHANNELS],
        }; KEPT],
        count: 0,
        at_rest: 0,
    };

    /// Begins anew.
    pub fn clear(&mut self) {
        (self.count, self.at_rest) = (0, 0);
    }

    /// Takes in the command of a servo period.
    pub fn push(&mut self, position_mm: [f64; N], through: &Through, cutting: bool) {
        let last = *self.at(self.count.saturating_sub(1));
        let chord = sub(position_mm, last.position_mm);
        let length_mm = norm(chord);
        let is_first = self.count == 0;
        let moved = !is_first && length_mm > SAME_PLACE_MM;
        let direction = if moved {
            scale(1.0 / length_mm, chord)
        } else {
            last.direction
        };
        let is_moving = moved || (!is_first && through.has_moved(&last.through));
        self.at_rest = if is_moving { 0 } else { self.at_rest + 1 };
        self.received[(self.count % KEPT as u64) as usize] = Received {
            position_mm,
            direction,
            cutting,
            through: through.command,
        };
        self.count += 1;
    }

    /// Number of the newest command.
    pub fn newest(&self) -> u64 {
        self.count.saturating_sub(1)
    }

    /// Servo periods in which neither the command nor a joint beside it has moved.
    pub fn at_rest(&self) -> u64 {
        self.at_rest
    }

    /// The command of this number; the nearest that is kept where it is not.
    pub fn position_mm(&self, number: u64) -> [f64; N] {
        self.at(number).position_mm
    }

    /// Returns the channel values that came with the command of this number.
    pub fn through(&self, number: u64) -> [f64; CHANNELS] {
        self.at(number).through
    }

    fn at(&self, number: u64) -> &Received<N> {
        let held = number
            .min(self.newest())
            .max(self.count.saturating_sub(KEPT as u64));
        &self.received[(held % KEPT as u64) as usize]
    }

    /// The path at the command of this number, with a servo period of `servo_s`.
    pub fn knot(&self, number: u64, servo_s: f64) -> Knot<N> {
        let here = *self.at(number);
        let p = |ahead: i64| self.position_mm(number.saturating_add_signed(ahead));
        let [before, into, out, after] =
            [[-1, -2], [0, -1], [1, 0], [2, 1]].map(|[to, from]| sub(p(to), p(from)));
        let moved_mm = match corner(before, into, out, after) {
            CornerSide::None => scale(0.5, add_scaled(into, 1.0, out)),
            CornerSide::Ahead => into,
            CornerSide::Behind => out,
        };
        let length_mm = norm(moved_mm);
        let tangent = if length_mm > SAME_PLACE_MM {
            scale(1.0 / length_mm, moved_mm)
        } else {
            here.direction
        };
        Knot {
            position_mm: here.position_mm,
            tangent,
            feed_mm_s: length_mm / servo_s,
            cutting: here.cutting,
        }
    }
}

/// Side of a point on which a corner lies.
enum CornerSide {
    None,
    /// The corner is at the point, or in the chord after it.
    Ahead,
    /// The corner is in the chord before the point.
    Behind,
}

fn corner<const N: usize>(
    before: [f64; N],
    into: [f64; N],
    out: [f64; N],
    after: [f64; N],
) -> CornerSide {
    let turn = turn(into, out);
    if turn < 1.0 - TURN_COSINE {
        return CornerSide::None;
    }
    let (turns_before, turns_after) = (self::turn(before, into), self::turn(out, after));
    // 1 - cos grows with the square of the angle.
    let straight = |other: f64| other < STRAIGHT * STRAIGHT * turn;
    if straight(turns_before) {
        CornerSide::Ahead
    } else if straight(turns_after) {
        CornerSide::Behind
    } else {
        CornerSide::None
    }
}

/// 1 less the cosine of the angle between two chords; 0 where one has no length.
fn turn<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    let length = norm(a) * norm(b);
    if length > SAME_PLACE_MM * SAME_PLACE_MM {
        1.0 - dot(a, b) / length
    } else {
        0.0
    }
}

/// The history as a path over time that begins at one of its commands.
#[derive(Debug)]
pub struct Delayed<'a, const N: usize> {
    /// The commands.
    pub history: &'a History<N>,
    /// Number of the command at time 0.
    pub first: u64,
    /// Servo period, s.
    pub servo_s: f64,
}

impl<const N: usize> KnotSource<N> for Delayed<'_, N> {
    fn knot(&mut self, tau_s: f64) -> Knot<N> {
        // A float that is not a number, or below zero, saturates to 0.
        let periods = libm::round(tau_s / self.servo_s) as u64;
        self.history
            .knot(self.first.saturating_add(periods), self.servo_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(points: impl IntoIterator<Item = [f64; 2]>) -> History<2> {
        let mut history = History::EMPTY;
        points
            .into_iter()
            .for_each(|point| history.push(point, &Through::NONE, true));
        history
    }

    #[test]
    fn the_velocity_of_a_circle_agrees_with_central_differences() {
        let angle = |k: u32| 0.005 * f64::from(k);
        let history =
            of((0..100).map(|k| [10.0 * libm::cos(angle(k)), 10.0 * libm::sin(angle(k))]));
        for k in 5..95 {
            let knot = history.knot(u64::from(k), 0.001);
            // The chord over two periods is 2 R sin(w T), across the radius.
            assert!((knot.feed_mm_s - 10.0 * libm::sin(0.005) / 0.001).abs() < 1e-9);
            assert!((knot.tangent[0] + libm::sin(angle(k))).abs() < 1e-12);
        }
    }

    #[test]
    fn a_corner_between_two_commands_leaves_both_sides_straight() {
        let points = (0..10).map(|k| [0.05 * f64::from(k) - 0.47, 0.0]);
        let history = of(points.chain((0..10).map(|k| [0.0, 0.03 + 0.05 * f64::from(k)])));
        assert_eq!(
            (0..10)
                .map(|k| history.knot(k, 0.001).tangent[0])
                .fold(2.0, f64::min),
            1.0
        );
        assert_eq!(
            (10..18)
                .map(|k| history.knot(k, 0.001).tangent[1])
                .fold(2.0, f64::min),
            1.0
        );
    }

    #[test]
    fn at_rest_it_looks_where_it_went_and_what_is_forgotten_is_the_oldest() {
        let history = of((0..2000).map(|k| [0.0, f64::from(k.min(1990))]));
        let knot = history.knot(1998, 0.001);
        assert_eq!(
            (knot.tangent, knot.feed_mm_s, history.at_rest()),
            ([0.0, 1.0], 0.0, 9)
        );
        assert_eq!(history.position_mm(0), [0.0, 1744.0]);
    }
}
