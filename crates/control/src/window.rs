//! The part of the path that a controller sees: knots behind (the paper's shift register) and ahead
//! (the preview).
//!
//! Source: Lee, Cho and Jeon (2005), section 2.2: "previously stored N reference position data in a
//! shift register". Departure: a knot also carries the tangent, so that a corner between two knots
//! is not cut off.

use crate::vector::{add_scaled, bounded, dot, norm, reject, sub};

/// Number of reference knots that the shift register holds. At a servo period of 1 ms they reach
/// 0.26 s back, thirteen time constants of a position loop of 50 1/s; a tool with a longer lag is
/// not following.
pub const REGISTER_KNOTS: usize = 256;
/// Number of reference knots that the preview holds. At a servo period of 1 ms they reach as far
/// ahead as the register reaches back, more than twice the settling time of such a loop.
pub const PREVIEW_KNOTS: usize = 256;
/// Number of grid points that the preview keeps: as many behind the current knot as ahead of it.
const GRID_KNOTS: usize = 2 * PREVIEW_KNOTS;
/// Distance below which a plan time counts as on a grid point, in steps of the grid. Rounding is a
/// millionth of it, and the path does not turn in so short a time.
const AT_A_POINT: f64 = 1e-6;
/// Cosine of the turn between neighboring knots below which there is a corner between them (0.1
/// rad: a curve turns this much in one servo period only where its radius is below ten steps).
pub(crate) const CORNER_COSINE: f64 = 0.995;
/// Distance to the last knot below which a knot is not stored again, mm: at rest the register keeps
/// its history.
const SAME_PLACE_MM: f64 = 1e-7;

/// A point of the programmed path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Knot<const N: usize> {
    /// Position, mm.
    pub position_mm: [f64; N],
    /// Unit vector in the direction of travel; at rest, in the direction of the adjoining motion.
    pub tangent: [f64; N],
    /// Planned feedrate, mm/s.
    pub feed_mm_s: f64,
    /// True if the motion cuts, false for a rapid.
    pub cutting: bool,
}

impl<const N: usize> Knot<N> {
    /// A knot at the origin, at rest, with its tangent along the first axis.
    pub const REST: Self = {
        let mut tangent = [0.0; N];
        tangent[0] = 1.0;
        Self {
            position_mm: [0.0; N],
            tangent,
            feed_mm_s: 0.0,
            cutting: false,
        }
    };

    /// Returns true if every number is finite and the tangent is a unit vector.
    pub fn is_valid(&self) -> bool {
        let length = norm(self.tangent);
        (length - 1.0).abs() < 1e-3
            && norm(self.position_mm).is_finite()
            && self.feed_mm_s.is_finite()
    }

    /// Returns this knot if it is valid; otherwise `other` with a feedrate of 0.
    #[inline]
    pub fn or_as(self, other: &Self) -> Self {
        if self.is_valid() {
            self
        } else {
            Self {
                feed_mm_s: 0.0,
                ..*other
            }
        }
    }

    /// Returns the path between this knot and one `step_s` later, after `part` of the time: a cubic
    /// that meets both with their feedrates, or, with a corner between them, the two sides of the
    /// corner.
    #[inline]
    fn after(&self, next: &Self, step_s: f64, part: f64) -> Self {
        let chord = sub(next.position_mm, self.position_mm);
        let cosine = dot(self.tangent, next.tangent);
        let feed_mm_s = self.feed_mm_s + part * (next.feed_mm_s - self.feed_mm_s);
        let nearer = if part < 0.5 { self } else { next };
        let mut knot = Self {
            feed_mm_s,
            ..*nearer
        };
        if cosine >= CORNER_COSINE {
            let rest = 1.0 - part;
            let ends = [
                part * rest * rest * step_s * self.feed_mm_s,
                -part * part * rest * step_s * next.feed_mm_s,
            ];
            let straight = add_scaled(self.position_mm, part * part * (1.0 + 2.0 * rest), chord);
            knot.position_mm = add_scaled(
                add_scaled(straight, ends[0], self.tangent),
                ends[1],
                next.tangent,
            );
        } else if let Some(to_corner_mm) = corner(self, next) {
            let corner_mm = add_scaled(self.position_mm, to_corner_mm, self.tangent);
            let from_corner_mm = norm(sub(next.position_mm, corner_mm));
            let gone_mm = part * (to_corner_mm + from_corner_mm) - to_corner_mm;
            knot.tangent = if gone_mm < 0.0 {
                self.tangent
            } else {
                next.tangent
            };
            knot.position_mm = add_scaled(corner_mm, gone_mm, knot.tangent);
        } else {
            knot.position_mm = add_scaled(self.position_mm, part, chord);
        }
        knot
    }
}

/// Returns the distance from the first knot to the corner between two knots, mm: where the two
/// tangent lines meet. `None` where the path is smooth or turns back.
#[inline]
pub(crate) fn corner<const N: usize>(from: &Knot<N>, to: &Knot<N>) -> Option<f64> {
    let cosine = dot(from.tangent, to.tangent);
    if cosine.is_nan() || cosine.abs() >= CORNER_COSINE {
        return None;
    }
    // The corner is at p + a t1; a follows from the component of the chord across t2.
    let chord = sub(to.position_mm, from.position_mm);
    let across = |v: [f64; N]| reject(v, to.tangent);
    let (t, c) = (across(from.tangent), across(chord));
    Some(bounded(dot(c, t) / dot(t, t), 0.0, norm(chord)))
}

/// The programmed path over plan time: the reference position `tau_s` seconds into the feed plan.
pub trait KnotSource<const N: usize> {
    /// Returns the knot at plan time `tau_s`. Before the start and beyond the end the path rests
    /// there.
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
        Self {
            knots: [Knot::REST; REGISTER_KNOTS],
            newest: 0,
            len: 0,
        }
    }
}

impl<const N: usize> Register<N> {
    /// Shifts a knot in; the oldest falls out. A knot in the place of the newest replaces it.
    /// Returns true if it was shifted.
    #[inline]
    pub fn push(&mut self, knot: Knot<N>) -> bool {
        let moved =
            self.len == 0 || norm(sub(knot.position_mm, self.knot(0).position_mm)) > SAME_PLACE_MM;
        if moved {
            self.newest = (self.newest + 1) % REGISTER_KNOTS;
            self.len = (self.len + 1).min(REGISTER_KNOTS);
        }
        self.knots[self.newest % REGISTER_KNOTS] = knot;
        moved
    }

    /// Returns the number of knots in the register.
    #[inline]
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns true before the first push.
    #[inline]
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Returns the knot pushed `age` moves ago; 0 is the newest. An `age` beyond the register
    /// returns the content of its oldest slot.
    #[inline]
    pub fn knot(&self, age: usize) -> &Knot<N> {
        &self.knots[(self.newest + REGISTER_KNOTS - age.min(REGISTER_KNOTS - 1)) % REGISTER_KNOTS]
    }
}

/// Reference knots behind and ahead, on a grid of plan time with the servo period as its step.
#[derive(Debug, Clone)]
pub struct Preview<const N: usize> {
    knots: [Knot<N>; GRID_KNOTS],
    /// Next grid point to look up; the ring holds the [`GRID_KNOTS`] before it.
    next: u64,
    step_s: f64,
    /// True if another planner plans the feedrate. The path ahead is then the path that will be
    /// commanded, and a rate is a request that does not apply to this feed period.
    pub(crate) is_planned_elsewhere: bool,
}

impl<const N: usize> Preview<N> {
    /// Creates an empty preview with a grid of `step_s` seconds.
    pub fn new(step_s: f64) -> Self {
        Self {
            knots: [Knot::REST; GRID_KNOTS],
            next: 0,
            step_s,
            is_planned_elsewhere: false,
        }
    }

    /// Looks knots up until the grid reaches `ahead_s` beyond `tau_s`; at most `PREVIEW_KNOTS` of
    /// them ahead.
    #[inline]
    pub fn fill<R: KnotSource<N> + ?Sized>(&mut self, reference: &mut R, tau_s: f64, ahead_s: f64) {
        let (now, _) = self.place(tau_s);
        let (farthest, _) = self.place(tau_s + ahead_s);
        // Interpolation needs one grid point more than the last one.
        let end = farthest.min(now + PREVIEW_KNOTS as u64) + 2;
        self.next = self.next.max(end.saturating_sub(GRID_KNOTS as u64));
        while self.next < end {
            let before = *self.grid(self.next.saturating_sub(1));
            let knot = reference.knot(self.next as f64 * self.step_s);
            self.knots[(self.next % GRID_KNOTS as u64) as usize] = knot.or_as(&before);
            self.next += 1;
        }
    }

    /// Returns the knot at plan time `tau_s`, interpolated between two grid points.
    #[inline]
    pub fn at(&self, tau_s: f64) -> Knot<N> {
        let (point, part) = self.place(tau_s);
        let before = self.grid(point);
        if part > 0.0 {
            before.after(self.grid(point + 1), self.step_s, part)
        } else {
            *before
        }
    }

    /// Returns the knot of a grid point, or the nearest one in the ring.
    #[inline]
    pub fn grid(&self, point: u64) -> &Knot<N> {
        let held = point
            .min(self.next.saturating_sub(1))
            .max(self.next.saturating_sub(GRID_KNOTS as u64));
        &self.knots[(held % GRID_KNOTS as u64) as usize]
    }

    /// Returns the last grid point at or before a plan time, and the part of a step beyond it. Plan
    /// time is a multiple of the step except for rounding, which must not lead to the grid point
    /// before.
    #[inline]
    pub(crate) fn place(&self, tau_s: f64) -> (u64, f64) {
        let place = (tau_s / self.step_s).max(0.0);
        let nearest = libm::round(place);
        if (place - nearest).abs() < AT_A_POINT {
            return (nearest as u64, 0.0);
        }
        let point = place as u64;
        (point, place - point as f64)
    }
}

/// The part of the path that a controller sees at the start of a feed period.
#[derive(Debug, Clone, Copy)]
pub struct Window<'a, const N: usize> {
    /// Knots behind, one a servo period; the newest is the current one.
    pub register: &'a Register<N>,
    /// Knots ahead, as far as [`crate::Schedule::preview`] requests.
    pub preview: &'a Preview<N>,
    /// Plan time of the current knot, s.
    pub tau_s: f64,
    /// Feed period, s.
    pub feed_period_s: f64,
    /// Offset of the command from the path at the current knot, mm.
    pub offset_mm: [f64; N],
    /// Velocity of the offset at the current knot, mm/s.
    pub offset_mm_s: [f64; N],
}

impl<'a, const N: usize> Window<'a, N> {
    /// Returns the servo period, s.
    #[inline]
    pub fn servo_s(&self) -> f64 {
        self.preview.step_s
    }

    /// Returns the current knot.
    #[inline]
    pub fn now(&self) -> Knot<N> {
        *self.register.knot(0)
    }

    /// Returns the knot `periods` feed periods ahead at the planned feedrate.
    #[inline]
    pub fn ahead(&self, periods: usize) -> Knot<N> {
        self.at(periods as f64 * self.feed_period_s)
    }

    /// Returns the knot `ahead_s` from now in plan time; behind where that is negative.
    #[inline]
    pub fn at(&self, ahead_s: f64) -> Knot<N> {
        self.preview.at(self.tau_s + ahead_s)
    }

    /// Returns the grid point of the current knot.
    #[inline]
    fn point(&self) -> u64 {
        self.preview.place(self.tau_s).0
    }

    /// Returns a knot of the sequence: 0 is the current one, negative behind it, positive ahead of
    /// it.
    #[inline]
    pub fn knot(&self, index: i32) -> &'a Knot<N> {
        if index <= 0 {
            self.register.knot(index.unsigned_abs() as usize)
        } else {
            self.preview
                .grid(self.point() + u64::from(index.unsigned_abs()))
        }
    }

    /// Returns the first and the last index of that sequence.
    #[inline]
    pub fn range(&self) -> [i32; 2] {
        let ahead = self
            .preview
            .next
            .saturating_sub(self.point() + 1)
            .min(PREVIEW_KNOTS as u64 - 1);
        [1 - self.register.len().max(1) as i32, ahead as i32]
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;

    /// 50 mm/s along the first axis.
    pub(crate) struct Line;

    impl KnotSource<2> for Line {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            Knot {
                position_mm: [50.0 * tau_s, 0.0],
                tangent: [1.0, 0.0],
                feed_mm_s: 50.0,
                cutting: true,
            }
        }
    }

    fn at(x: f64) -> Knot<2> {
        Knot {
            position_mm: [x, 0.0],
            tangent: [1.0, 0.0],
            feed_mm_s: 1.0,
            cutting: true,
        }
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
