//! Length and extent of an arc whose radii at start and end may be unequal.
//!
//! Such an arc is a spiral about its centre: over the angle `t` that it has turned, up to `sweep`,
//! radius and height change evenly, `r(t) = r0 + (r1 - r0) t / sweep`. `path/arcs.rs` cuts the same
//! curve into circular arcs.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::canon::Plane;

/// Halvings of a quarter turn: what is left is below the rounding of an angle.
const HALVINGS: usize = 55;

/// An arc, equal radii included.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Spiral {
    axes: [usize; 3],
    center: [f64; 2],
    radius: [f64; 2],
    height: [f64; 2],
    /// Direction of the start from the centre, rad.
    angle: f64,
    /// 1 counter-clockwise, -1 clockwise.
    sense: f64,
    /// Angle between start and end, all turns of P included, rad, above 0.
    sweep: f64,
}

impl Spiral {
    /// The arc of a motion; `turns` as in [`Shape::Arc`](crate::canon::Shape::Arc).
    pub(crate) fn new(
        start: [f64; 3],
        end: [f64; 3],
        center: [f64; 3],
        plane: Plane,
        turns: i32,
    ) -> Self {
        let axes = plane.axes();
        let [first, second, normal] = axes;
        let center = [center[first], center[second]];
        let from = [start[first] - center[0], start[second] - center[1]];
        let to = [end[first] - center[0], end[second] - center[1]];
        let radius = [libm::hypot(from[0], from[1]), libm::hypot(to[0], to[1])];
        let sense = f64::from(turns.signum());
        let mut sweep = sense
            * libm::atan2(
                from[0] * to[1] - from[1] * to[0],
                from[0] * to[0] + from[1] * to[1],
            );
        if sweep * radius[0].min(radius[1]) <= FULL_TURN_WITHIN_MM {
            sweep += TAU;
        }
        sweep += TAU * (f64::from(turns).abs() - 1.0).max(0.0);
        let angle = libm::atan2(from[1], from[0]);
        Self {
            axes,
            center,
            radius,
            height: [start[normal], end[normal]],
            angle,
            sense,
            sweep,
        }
    }

    /// Length, mm: the integral of sqrt((r sweep)^2 + (r1 - r0)^2 + rise^2) over the share of the
    /// way, in closed form. The two terms are written without differences of nearly equal numbers,
    /// so that they hold for equal radii, too.
    pub(crate) fn length_mm(&self) -> f64 {
        let ([r0, r1], sweep) = (self.radius, self.sweep);
        let change = r1 - r0;
        let straight = libm::hypot(change, self.height[1] - self.height[0]);
        let [v0, v1] = [r0, r1].map(|r| libm::hypot(r * sweep, straight));
        if v0 == 0.0 || v1 == 0.0 {
            return straight;
        }
        let round = (r0 + r1) * (sweep * sweep * (r0 * r0 + r1 * r1) + straight * straight)
            / (r1 * v1 + r0 * v0);
        let slope = sweep * (r0 + r1) / (r1 * v0 + r0 * v1);
        let bend = if change == 0.0 {
            slope
        } else {
            libm::asinh(slope * change) / change
        };
        0.5 * (round + straight * straight / sweep * bend)
    }

    /// The points that lie farthest out along the plane's axes, other than start and end. The
    /// height is the start's.
    pub(crate) fn extremes(&self, start: [f64; 3]) -> impl Iterator<Item = [f64; 3]> {
        let spiral = *self;
        // The outermost turn has them: seen from the end with the larger radius, the radius
        // shrinks.
        let outward = spiral.radius[1] > spiral.radius[0];
        let (angle, sense, radius) = if outward {
            (
                spiral.angle + spiral.sense * spiral.sweep,
                -spiral.sense,
                spiral.radius[1],
            )
        } else {
            (spiral.angle, spiral.sense, spiral.radius[0])
        };
        let shrinks = (spiral.radius[1] - spiral.radius[0]).abs() / spiral.sweep;
        let radius_after = move |turned: f64| radius - shrinks * turned.clamp(0.0, spiral.sweep);
        (0..8).filter_map(move |quarter| {
            // Straight out along an axis after this angle, now or a turn later.
            let to_axis = (sense * (f64::from(quarter % 4) * FRAC_PI_2 - angle)).rem_euclid(TAU)
                + TAU * f64::from(quarter / 4);
            // Farthest out where r' cos - r sin vanishes, up to a quarter turn before the axis.
            // What is compared grows with the angle.
            let (mut turned, mut too_far) = (to_axis - FRAC_PI_2, to_axis);
            for _ in 0..HALVINGS {
                let middle = 0.5 * (turned + too_far);
                if middle + libm::atan(shrinks / radius_after(middle)) <= to_axis {
                    turned = middle;
                } else {
                    too_far = middle;
                }
            }
            if shrinks == 0.0 {
                turned = to_axis;
            }
            if !(0.0..=spiral.sweep).contains(&turned) {
                return None;
            }
            let (sin, cos) = libm::sincos(angle + sense * turned);
            let mut point = start;
            point[spiral.axes[0]] = spiral.center[0] + radius_after(turned) * cos;
            point[spiral.axes[1]] = spiral.center[1] + radius_after(turned) * sin;
            Some(point)
        })
    }
}

/// An arc that ends this close to its start, mm along the circle, is a full turn: as in the path
/// stage, and on LinuxCNC.
pub(crate) const FULL_TURN_WITHIN_MM: f64 = 8e-9;

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Points of the spiral by its definition, for brute force.
    fn points(spiral: &Spiral, count: u32) -> impl Iterator<Item = [f64; 3]> {
        let spiral = *spiral;
        (0..=count).map(move |number| {
            let share = f64::from(number) / f64::from(count);
            let even = |[from, to]: [f64; 2]| from + (to - from) * share;
            let (sin, cos) = libm::sincos(spiral.angle + spiral.sense * spiral.sweep * share);
            let mut point = [0.0; 3];
            point[spiral.axes[0]] = spiral.center[0] + even(spiral.radius) * cos;
            point[spiral.axes[1]] = spiral.center[1] + even(spiral.radius) * sin;
            point[spiral.axes[2]] = even(spiral.height);
            point
        })
    }

    fn boxed(points: impl Iterator<Item = [f64; 3]>) -> [[f64; 3]; 2] {
        points.fold(
            [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]],
            |[low, high], point| {
                [0, 1].map(|end| {
                    std::array::from_fn(|axis| {
                        if end == 0 {
                            low[axis].min(point[axis])
                        } else {
                            high[axis].max(point[axis])
                        }
                    })
                })
            },
        )
    }

    #[test]
    fn equal_radii_are_a_helix() {
        let spiral = Spiral::new([10.0, 0.0, 0.0], [0.0, 10.0, 3.0], [0.0; 3], Plane::Xy, 2);
        assert!(
            (spiral.length_mm() - libm::hypot(2.5 * std::f64::consts::PI * 10.0, 3.0)).abs()
                < 1e-12
        );
    }

    /// Length and box of the spiral against those of 20,000 chords.
    fn compare(
        radius: f64,
        ratio: f64,
        [from, to]: [f64; 2],
        rise: f64,
        turns: i32,
        plane: Plane,
    ) -> Result<(), TestCaseError> {
        let [first, second, normal] = plane.axes();
        let at = |radius: f64, angle: f64, height: f64| {
            let mut point = [0.0; 3];
            point[first] = 3.0 + radius * libm::cos(angle);
            point[second] = -2.0 + radius * libm::sin(angle);
            point[normal] = height;
            point
        };
        let (start, end) = (at(radius, from, 0.0), at(radius * ratio, to, rise));
        let mut center = start;
        (center[first], center[second]) = (3.0, -2.0);
        let spiral = Spiral::new(start, end, center, plane, turns);
        let count = 20_000;
        let chords: Vec<_> = points(&spiral, count).collect();
        let length: f64 = chords
            .windows(2)
            .map(|pair| {
                (0..3)
                    .map(|axis| (pair[1][axis] - pair[0][axis]).powi(2))
                    .sum::<f64>()
                    .sqrt()
            })
            .sum();
        // A chord is shorter than its arc by the square of its angle over 24; each is rounded where
        // it is added.
        let step = spiral.sweep / f64::from(count);
        let off = step * step + f64::from(count) * f64::EPSILON;
        prop_assert!(
            (spiral.length_mm() / length - 1.0).abs() <= off,
            "{} {length}",
            spiral.length_mm()
        );
        let ours = boxed([start, end].into_iter().chain(spiral.extremes(start)));
        let theirs = boxed(chords.into_iter());
        // The farthest chord point misses the farthest point by the sagitta of a step: an eighth of
        // its square times the second derivative by the angle, to which a radius that changes adds
        // twice its rate.
        let rate = (radius * (ratio - 1.0) / spiral.sweep).abs();
        let sagitta = (radius.max(radius * ratio) + 2.0 * rate) * step * step / 8.0;
        for (ours, theirs) in ours.iter().flatten().zip(theirs.iter().flatten()) {
            prop_assert!(
                (ours - theirs).abs() <= sagitta + 1e-12,
                "{ours} {theirs} {spiral:?}"
            );
        }
        Ok(())
    }

    #[test]
    fn a_short_arc_that_rises_steeply_is_rounded_in_every_chord() {
        compare(
            0.01,
            0.2,
            [3.776277189232309, 3.7772162666179736],
            16.755608685418682,
            1,
            Plane::Xy,
        )
        .unwrap();
    }

    proptest! {
        #[test]
        fn length_and_box_are_those_of_many_chords(
            radius in 0.01..100.0_f64,
            ratio in 0.2..5.0_f64,
            angles in [0.0..TAU, 0.0..TAU],
            rise in -20.0..20.0_f64,
            turns in prop::sample::select(vec![1, -1, 2, -3]),
            plane in prop::sample::select(vec![Plane::Xy, Plane::Zx, Plane::Yz]),
        ) {
            compare(radius, ratio, angles, rise, turns, plane)?;
        }
    }
}
