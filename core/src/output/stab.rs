//! One straight segment past many points in order: the kernel of the polyline writer.
//!
//! Given an anchor a and points p_1 .. p_n, find an end b such that every p_k lies within r of the segment a b, at
//! parameters that do not decrease (so the Fréchet distance is at most r), or say that there is none.
//!
//! Seen from a, with u the direction to p_n and v, w across it, a ray a + x (u + alpha v + beta w) passes p_k, which lies at
//! (x_k, y_k, z_k), within r if |(alpha, beta) - (y_k, z_k) / x_k| <= r / x_k. So the cone of directions that each point
//! allows is a disc, and the cone that all of them allow is an intersection of discs, a convex region of which the extreme
//! point in any direction is found exactly by incremental linear-type programming. Source of the cone: Williams, "An
//! efficient algorithm for the piecewise linear approximation of planar curves", Computer Graphics and Image Processing
//! 8(2), 1978, doi:10.1016/0146-664X(78)90055-2; of the ordered stabbing: Guibas, Hershberger, Mitchell, Snoeyink,
//! "Approximating polygons and subdivisions with minimum-link paths", 1993, doi:10.1142/S0218195993000257.
//!
//! Departure: distance is measured across u and not across the ray, which is at most 1 / cos of the angle between them too
//! strict: 1e-6 of r where the ray turns by 1.4 mrad. Points within r of a are met at a itself. Every answer is verified by
//! [`passes`] with true distances, so rounding can cost a block but never the guarantee.

use crate::vector::{Vector, add_scaled, cross, dot, norm, scale, sub};

/// The ray may leave a disc by this share of its radius: rounding of coordinates of 1000 mm against discs of 1e-5.
const SLACK: f64 = 1e-9;

/// An end for a segment from `anchor` past all `points` within `r`, as far as possible away from `next`.
///
/// On a curve the end then lies on its outer side, from where the following segment reaches further.
pub(super) fn stab(anchor: Vector, points: &[Vector], next: Option<Vector>, r: f64) -> Option<Vector> {
    let last = *points.last()?;
    let reach = sub(last, anchor);
    let length = norm(reach);
    // Within reach of the anchor there is no direction; the polyline simply does not move on.
    if length <= r {
        return points.iter().all(|p| norm(sub(*p, anchor)) <= r).then_some(anchor);
    }
    let frame = SegmentAxes::along(scale(1.0 / length, reach));
    // From the far end to the near one: far discs are small, so that few of the others still matter.
    let mut discs = Vec::with_capacity(points.len());
    for p in points.iter().rev() {
        let offset = sub(*p, anchor);
        if norm(offset) <= r {
            continue;
        }
        let [x, y, z] = frame.coordinates(offset);
        if x <= 0.0 {
            return None;
        }
        discs.push(Disc { center: [y / x, z / x], radius: r / x });
    }
    let goal = next.and_then(|next| frame.away_from(sub(next, anchor))).unwrap_or([1.0, 0.0]);
    let [alpha, beta] = extreme(&discs, goal)?;
    let direction = frame.direction(alpha, beta);
    Some(add_scaled(anchor, length, direction))
}

/// Whether all `points` lie within `r` of the segment from `a` to `b`, in order, the last one within `r` of `b`.
pub(super) fn passes(a: Vector, b: Vector, points: &[Vector], r: f64) -> bool {
    let along = sub(b, a);
    let length = norm(along);
    let unit = if length > 0.0 { scale(1.0 / length, along) } else { [0.0; 3] };
    // The smallest parameter that the points so far allow.
    let mut reached = 0.0_f64;
    let in_order = points.iter().all(|p| {
        let offset = sub(*p, a);
        let at = dot(offset, unit);
        let across_sq = dot(offset, offset) - at * at;
        let half_sq = r * r - across_sq;
        if half_sq < 0.0 {
            return false;
        }
        let half = half_sq.sqrt();
        reached = reached.max(at - half);
        reached <= (at + half).min(length) && at + half >= 0.0
    });
    in_order && points.last().is_none_or(|p| norm(sub(*p, b)) <= r)
}

struct Disc {
    center: [f64; 2],
    radius: f64,
}

impl Disc {
    fn holds(&self, c: [f64; 2]) -> bool {
        (c[0] - self.center[0]).hypot(c[1] - self.center[1]) <= self.radius * (1.0 + SLACK)
    }

    fn top(&self, goal: [f64; 2]) -> [f64; 2] {
        [self.center[0] + self.radius * goal[0], self.center[1] + self.radius * goal[1]]
    }

    /// Where two circles cross.
    fn crossings(&self, other: &Self) -> Option<[[f64; 2]; 2]> {
        let v = [other.center[0] - self.center[0], other.center[1] - self.center[1]];
        let d = v[0].hypot(v[1]);
        let along = (d * d + self.radius * self.radius - other.radius * other.radius) / (2.0 * d);
        let across_sq = self.radius * self.radius - along * along;
        // Circles that touch cross in one point twice.
        if across_sq.is_nan() || across_sq < -SLACK * self.radius * self.radius {
            return None;
        }
        let across = across_sq.max(0.0).sqrt();
        let e = [v[0] / d, v[1] / d];
        let foot = [self.center[0] + along * e[0], self.center[1] + along * e[1]];
        Some([[foot[0] - across * e[1], foot[1] + across * e[0]], [foot[0] + across * e[1], foot[1] - across * e[0]]])
    }
}

/// The point of the discs' intersection that lies furthest along `goal` (a unit vector); `None` where they have none in common.
///
/// Incremental: a disc that holds the extreme point so far changes nothing; of one that does not, the new extreme point lies
/// on its circle. What the others leave of that may be several arcs: the point is the top, or an end of any of them.
fn extreme(discs: &[Disc], goal: [f64; 2]) -> Option<[f64; 2]> {
    let mut best = discs.first().map_or([0.0; 2], |disc| disc.top(goal));
    for (k, disc) in discs.iter().enumerate().skip(1) {
        if !disc.holds(best) {
            best = extreme_on(disc, &discs[..k], goal)?;
        }
    }
    Some(best)
}

fn extreme_on(disc: &Disc, others: &[Disc], goal: [f64; 2]) -> Option<[f64; 2]> {
    let mut best = disc.top(goal);
    for (j, other) in others.iter().enumerate() {
        if other.holds(best) {
            continue;
        }
        let height = |c: &[f64; 2]| c[0] * goal[0] + c[1] * goal[1];
        let so_far = &others[..=j];
        let ends = so_far.iter().filter_map(|other| disc.crossings(other)).flatten();
        let left = ends.filter(|c| so_far.iter().all(|other| other.holds(*c)));
        best = left.max_by(|a, b| height(a).total_cmp(&height(b)))?;
    }
    Some(best)
}

/// Right-handed axes: along, and two across.
struct SegmentAxes {
    u: Vector,
    v: Vector,
    w: Vector,
}

impl SegmentAxes {
    fn along(u: Vector) -> Self {
        // Across u in the XY plane where there is such a direction, so that a plane path stays plane.
        let level = u[0].hypot(u[1]);
        let v = if level > 1e-6 { [-u[1] / level, u[0] / level, 0.0] } else { [1.0, 0.0, 0.0] };
        let v = unit(sub(v, scale(dot(u, v), u)));
        Self { u, v, w: cross(u, v) }
    }

    fn coordinates(&self, p: Vector) -> Vector {
        [dot(p, self.u), dot(p, self.v), dot(p, self.w)]
    }

    fn direction(&self, alpha: f64, beta: f64) -> Vector {
        add_scaled(add_scaled(self.u, alpha, self.v), beta, self.w)
    }

    /// Unit vector across u, away from where `p` lies; `None` where it lies on u.
    fn away_from(&self, p: Vector) -> Option<[f64; 2]> {
        let (y, z) = (dot(p, self.v), dot(p, self.w));
        let size = y.hypot(z);
        (size > 1e-9).then(|| [-y / size, -z / size])
    }
}

fn unit(a: Vector) -> Vector {
    scale(1.0 / norm(a), a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn disc(x: f64, y: f64, radius: f64) -> Disc {
        Disc { center: [x, y], radius }
    }

    #[test]
    fn extreme_point_of_a_lens_is_its_tip() {
        let discs = [disc(-3.0, 0.0, 5.0), disc(3.0, 0.0, 5.0)];
        let [x, y] = extreme(&discs, [0.0, 1.0]).unwrap();
        assert!(x.abs() < 1e-12 && (y - 4.0).abs() < 1e-12);
        assert_eq!(extreme(&discs, [1.0, 0.0]), Some([2.0, 0.0]));
        assert_eq!(extreme(&[disc(-3.0, 0.0, 2.0), disc(3.0, 0.0, 2.0)], [0.0, 1.0]), None);
    }

    #[test]
    fn of_a_circle_that_is_left_in_two_arcs_both_count() {
        let discs = [
            disc(0.0, 0.8519998974446397, 1.4201293388027836),
            disc(0.0, -0.7555555508788134, 1.1338207733087715),
            disc(-0.675313592423269, 0.0, 0.667987396911714),
            disc(0.44199801514314496, 0.23715657237363333, 0.7864006178481008),
        ];
        let goal = [f64::cos(5.657648183126011), f64::sin(5.657648183126011)];
        let [x, y] = extreme(&discs, goal).unwrap();
        // Of all crossings that every disc holds, one by one.
        let mut best = f64::NEG_INFINITY;
        for disc in &discs {
            let crossings = discs.iter().filter_map(|other| disc.crossings(other)).flatten();
            let held = crossings.filter(|c| discs.iter().all(|disc| disc.holds(*c)));
            best = held.map(|c| c[0] * goal[0] + c[1] * goal[1]).fold(best, f64::max);
        }
        assert!((x * goal[0] + y * goal[1] - best).abs() < 1e-12);
    }

    #[test]
    fn order_matters_not_only_distance() {
        let there_and_back = [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]];
        assert!(!passes([0.0; 3], [3.0, 0.0, 0.0], &there_and_back, 0.4));
        assert!(passes([0.0; 3], [3.0, 0.0, 0.0], &there_and_back, 0.5));
        assert!(!passes([0.0; 3], [2.0, 0.0, 0.0], &[[3.0, 0.0, 0.0]], 0.5));
    }

    proptest! {
        /// Against a search over a grid of directions: what the grid finds, the exact method finds, and at least as far along.
        #[test]
        fn extreme_is_no_worse_than_a_grid(raw in prop::collection::vec((-1.0..1.0, -1.0..1.0, 0.3..1.5), 1..8), angle in 0.0..6.3) {
            let discs: Vec<Disc> = raw.iter().map(|&(x, y, radius)| disc(x, y, radius)).collect();
            let goal = [f64::cos(angle), f64::sin(angle)];
            let height = |c: [f64; 2]| c[0] * goal[0] + c[1] * goal[1];
            let strictly = |c: [f64; 2]| discs.iter().all(|d| (c[0] - d.center[0]).hypot(c[1] - d.center[1]) <= d.radius);
            let grid = (0..=100).flat_map(|i| (0..=100).map(move |j| [f64::from(i) * 0.05 - 2.5, f64::from(j) * 0.05 - 2.5]));
            let best_of_grid = grid.filter(|c| strictly(*c)).map(height).fold(f64::NEG_INFINITY, f64::max);
            match extreme(&discs, goal) {
                Some(c) => {
                    prop_assert!(discs.iter().all(|d| d.holds(c)));
                    prop_assert!(height(c) >= best_of_grid - 1e-9);
                }
                None => prop_assert_eq!(best_of_grid, f64::NEG_INFINITY),
            }
        }

        /// Points beside a random segment, in order: there is a segment past them, and what is found passes them.
        #[test]
        fn a_segment_that_exists_is_found(
            far in 0.02..2.0, tilt in (-1.0..1.0, -1.0..1.0), noise in prop::collection::vec((0.0..1.0, -0.7..0.7, -0.7..0.7), 1..40),
        ) {
            let r = 1e-3;
            let count = noise.len() as f64;
            let direction = unit([1.0, tilt.0, tilt.1]);
            let frame = SegmentAxes::along(direction);
            let points: Vec<Vector> = noise.iter().enumerate().map(|(k, n)| {
                let x = far * (k as f64 + 0.5 + 0.4 * n.0) / count + 2.0 * r;
                [0, 1, 2].map(|i| x * frame.u[i] + r * (n.1 * frame.v[i] + n.2 * frame.w[i]))
            }).collect();
            let end = stab([0.0; 3], &points, None, r);
            prop_assert!(end.is_some());
            prop_assert!(passes([0.0; 3], end.unwrap(), &points, r * (1.0 + 1e-6)));
        }
    }
}
