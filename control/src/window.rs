//! The part of the path that a controller sees: knots behind (the paper's shift register) and ahead (the preview).
//!
//! Source: Lee, Cho and Jeon (2005), section 2.2: "previously stored N reference position data in a shift register".
//! Departure: a knot also carries the tangent, so that a corner between two knots is not cut off.

use crate::vector::{add_scaled, norm, sub};

/// Reference knots that the shift register holds. At a servo period of 1 ms they reach 0.26 s back, thirteen time
/// constants of a position loop of 50 1/s; a tool that lags further behind than that is not following.
pub const REGISTER_KNOTS: usize = 256;
/// Reference knots that the preview holds. At a servo period of 1 ms they reach as far ahead as the register reaches
/// back, more than twice the settling time of such a loop.
pub const PREVIEW_KNOTS: usize = 256;
/// A knot nearer than this to the last is not stored again, mm: at rest the register keeps its history.
const SAME_PLACE_MM: f64 = 1e-7;

/// A point of the programmed path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot<const N: usize> {
    /// Where it is, mm.
    pub position_mm: [f64; N],
    /// Unit direction of travel; at rest that of the adjoining motion.
    pub tangent: [f64; N],
    /// Planned feedrate, mm/s.
    pub feed_mm_s: f64,
}

impl<const N: usize> Knot<N> {
    /// A knot at the origin, at rest.
    pub const REST: Self = Self { position_mm: [0.0; N], tangent: [0.0; N], feed_mm_s: 0.0 };
}

/// The programmed path over plan time: where the tool is to be `tau_s` seconds into the feed plan.
pub trait Reference<const N: usize> {
    /// The knot at plan time `tau_s`. Before the start and beyond the end it rests there.
    fn knot(&mut self, tau_s: f64) -> Knot<N>;
}

/// The last [`REGISTER_KNOTS`] reference knots, one each servo period in which the reference moved.
#[derive(Debug, Clone)]
pub struct Register<const N: usize> {
    knots: [Knot<N>; REGISTER_KNOTS],
    newest: usize,
    len: usize,
}

impl<const N: usize> Default for Register<N> {
    fn default() -> Self {
        Self { knots: [Knot::REST; REGISTER_KNOTS], newest: 0, len: 0 }
    }
}

impl<const N: usize> Register<N> {
    /// Shifts a knot in; the oldest falls out. A knot in the place of the newest replaces it. Says whether it was
    /// shifted.
    #[inline]
    pub fn push(&mut self, knot: Knot<N>) -> bool {
        let moved = self.len == 0 || norm(sub(knot.position_mm, self.knots[self.newest].position_mm)) > SAME_PLACE_MM;
        if moved {
            self.newest = (self.newest + 1) % REGISTER_KNOTS;
            self.len = (self.len + 1).min(REGISTER_KNOTS);
        }
        self.knots[self.newest] = knot;
        moved
    }

    /// Number of knots held.
    #[inline]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether nothing was pushed yet.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// The knot pushed `age` moves ago; 0 is the newest. `age` beyond the register gives the oldest slot's content.
    #[inline]
    pub fn knot(&self, age: usize) -> &Knot<N> {
        &self.knots[(self.newest + REGISTER_KNOTS - age.min(REGISTER_KNOTS - 1)) % REGISTER_KNOTS]
    }
}

/// Reference knots ahead, on a grid of plan time with the servo period as its step.
#[derive(Debug, Clone)]
pub struct Preview<const N: usize> {
    knots: [Knot<N>; PREVIEW_KNOTS],
    /// Grid point that is looked up next; the ring holds the [`PREVIEW_KNOTS`] before it.
    next: u64,
    step_s: f64,
}

impl<const N: usize> Preview<N> {
    /// Empty, with a grid of `step_s` seconds.
    pub fn new(step_s: f64) -> Self {
        Self { knots: [Knot::REST; PREVIEW_KNOTS], next: 0, step_s }
    }

    /// Looks knots up until the grid reaches `ahead_s` beyond `tau_s`; at most [`PREVIEW_KNOTS`] of them.
    #[inline]
    pub fn fill<R: Reference<N> + ?Sized>(&mut self, reference: &mut R, tau_s: f64, ahead_s: f64) {
        // One more than the last grid point that a look between two points needs.
        let end = ((tau_s + ahead_s) / self.step_s) as u64 + 2;
        self.next = self.next.max(end.saturating_sub(PREVIEW_KNOTS as u64));
        while self.next < end {
            self.knots[(self.next % PREVIEW_KNOTS as u64) as usize] = reference.knot(self.next as f64 * self.step_s);
            self.next += 1;
        }
    }

    /// The knot at plan time `tau_s`, between two grid points.
    #[inline]
    pub fn at(&self, tau_s: f64) -> Knot<N> {
        let place = (tau_s / self.step_s).max(0.0);
        let before = place as u64;
        let part = place - before as f64;
        let (a, b) = (self.grid(before), self.grid(before + 1));
        let between = |p: [f64; N], q: [f64; N]| add_scaled(p, part, sub(q, p));
        Knot {
            position_mm: between(a.position_mm, b.position_mm),
            tangent: if part < 0.5 { a.tangent } else { b.tangent },
            feed_mm_s: a.feed_mm_s + part * (b.feed_mm_s - a.feed_mm_s),
        }
    }

    /// The knot of a grid point; the nearest that the ring holds where it does not hold it.
    #[inline]
    pub fn grid(&self, point: u64) -> &Knot<N> {
        let held = point.clamp(self.next.saturating_sub(PREVIEW_KNOTS as u64), self.next.saturating_sub(1));
        &self.knots[(held % PREVIEW_KNOTS as u64) as usize]
    }
}

/// What a controller sees of the path at the start of a feed period.
#[derive(Debug, Clone, Copy)]
pub struct Window<'a, const N: usize> {
    /// Knots behind, one a servo period; the newest is the current one.
    pub register: &'a Register<N>,
    /// Knots ahead, as far as [`crate::Schedule::preview`] asks for.
    pub preview: &'a Preview<N>,
    /// Plan time of the current knot, s.
    pub tau_s: f64,
    /// Feed period, s.
    pub feed_period_s: f64,
    /// Offset of the command from the path at the current knot, mm.
    pub offset_mm: [f64; N],
}

impl<'a, const N: usize> Window<'a, N> {
    /// Servo period, s.
    #[inline]
    pub fn servo_s(&self) -> f64 {
        self.preview.step_s
    }

    /// The current knot.
    #[inline]
    pub fn now(&self) -> Knot<N> {
        *self.register.knot(0)
    }

    /// The knot `periods` feed periods ahead at the planned feed.
    #[inline]
    pub fn ahead(&self, periods: usize) -> Knot<N> {
        self.preview.at(self.tau_s + periods as f64 * self.feed_period_s)
    }

    /// The sequence of knots: 0 is the current one, negative behind it, positive ahead of it.
    #[inline]
    pub fn knot(&self, index: i32) -> &'a Knot<N> {
        if index <= 0 {
            self.register.knot(index.unsigned_abs() as usize)
        } else {
            self.preview.grid((self.tau_s / self.preview.step_s) as u64 + u64::from(index.unsigned_abs()))
        }
    }

    /// The first and the last index of that sequence.
    #[inline]
    pub fn range(&self) -> [i32; 2] {
        let now = (self.tau_s / self.preview.step_s) as u64;
        let ahead = self.preview.next.saturating_sub(now + 1).min(PREVIEW_KNOTS as u64 - 1);
        [1 - self.register.len().max(1) as i32, ahead as i32]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f64) -> Knot<2> {
        Knot { position_mm: [x, 0.0], tangent: [1.0, 0.0], feed_mm_s: 1.0 }
    }

    #[test]
    fn the_register_keeps_the_newest_and_forgets_the_oldest() {
        let mut register = Register::default();
        for i in 0..1000 {
            register.push(at(f64::from(i)));
        }
        assert_eq!(register.len(), REGISTER_KNOTS);
        assert_eq!(register.knot(0).position_mm[0], 999.0);
        assert_eq!(register.knot(REGISTER_KNOTS - 1).position_mm[0], 744.0);
    }

    #[test]
    fn rest_does_not_flush_the_register() {
        let mut register = Register::default();
        register.push(at(0.0));
        register.push(at(1.0));
        for _ in 0..1000 {
            assert!(!register.push(at(1.0)));
        }
        assert_eq!((register.len(), register.knot(1).position_mm[0]), (2, 0.0));
    }
}
