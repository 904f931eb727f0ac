//! An arc motion as arcs that meet both of its ends.
//!
//! Programs round their numbers, so the programmed centre `c` is seldom equally far from start and end. Both ends hold;
//! the centre gives way:
//!
//! * up to half a turn, the centre moves to the nearest point from which both ends are equally far (on the perpendicular
//!   bisector of the chord);
//! * beyond half a turn that point may be far away (the chord may be tiny), so the last turn is cut at half its angle, on
//!   the mean radius, into two arcs that are re-centred each;
//! * whole turns before the last one keep the programmed centre and the start's radius.
//!
//! The path stays within the difference of the two radii of the programmed circle; the kinks at the cuts are of the order
//! of that difference over the radius.

use super::arc::{Arc, recenter};
use super::vector::{Vector, add_scaled};
use super::{MIN_LENGTH_MM, PathError};
use crate::gcode::canon::Plane;
use std::f64::consts::{PI, TAU};

/// An arc whose ends are this close, seen along the circle, is a full turn: programs are written to 1e-5 mm at best, and
/// offsets and inches add rounding far below this.
const FULL_TURN_MM: f64 = 1e-6;

/// Radii that differ by less than this are equal: the ends then meet the circle to better than the path's exactness.
const EQUAL_RADII_MM: f64 = 1e-10;

/// What an arc motion says.
pub(super) struct Request {
    pub(super) line: u32,
    pub(super) start_mm: Vector,
    pub(super) end_mm: Vector,
    pub(super) plane: Plane,
    pub(super) center_mm: Vector,
    pub(super) turns: i32,
}

/// Arcs of a motion, in order, each with its start.
pub(super) fn arcs(request: &Request) -> Result<Vec<(Vector, Arc)>, PathError> {
    let Request { line, start_mm, end_mm, plane, center_mm, turns } = *request;
    if turns == 0 {
        return Err(PathError::ArcTurns { line });
    }
    let [first, second, normal] = plane.axes();
    let from = [start_mm[first] - center_mm[first], start_mm[second] - center_mm[second]];
    let to = [end_mm[first] - center_mm[first], end_mm[second] - center_mm[second]];
    let radius_from = from[0].hypot(from[1]);
    let radius_to = to[0].hypot(to[1]);
    let radius_mm = radius_from.min(radius_to);
    if radius_mm < MIN_LENGTH_MM {
        return Err(PathError::ArcRadius { line, radius_mm });
    }

    let sense = f64::from(turns.signum());
    let between = sense * (from[0] * to[1] - from[1] * to[0]).atan2(from[0] * to[0] + from[1] * to[1]);
    let last_turn = if between * radius_mm > FULL_TURN_MM { between } else { between + TAU };
    let whole_turns = f64::from(turns.unsigned_abs() - 1);
    let sweep = last_turn + TAU * whole_turns;
    let rise_per_rad = (end_mm[normal] - start_mm[normal]) / sweep;

    // Ends the arc at `end`, re-centring it.
    let ending = |start: Vector, end: Vector, center: Vector| {
        let chord = [end[first] - start[first], end[second] - start[second]];
        let to_center = [center[first] - start[first], center[second] - start[second]];
        let (to_center, sweep) = recenter(chord, to_center, sense);
        (start, Arc::new(start, to_center, plane, sweep, end[normal] - start[normal]))
    };
    // Turns by `sweep` about the programmed centre.
    let turning = |start: Vector, sweep: f64| {
        let to_center = [-from[0], -from[1]];
        (start, Arc::new(start, to_center, plane, sense * sweep, rise_per_rad * sweep))
    };

    let equal = (radius_from - radius_to).abs() <= EQUAL_RADII_MM;
    if equal && (sweep > PI) {
        return Ok(vec![turning(start_mm, sweep)]);
    }
    let mut arcs = Vec::with_capacity(3);
    let mut here = start_mm;
    if whole_turns > 0.0 {
        arcs.push(turning(here, TAU * whole_turns));
        here[normal] += rise_per_rad * TAU * whole_turns;
    }
    if last_turn > PI {
        let mean = 0.5 * (radius_from + radius_to) / radius_from;
        let (sin, cos) = (0.5 * sense * last_turn).sin_cos();
        let mut middle = center_mm;
        middle[first] += mean * (from[0] * cos - from[1] * sin);
        middle[second] += mean * (from[0] * sin + from[1] * cos);
        middle[normal] = add_scaled(here, 0.5 * rise_per_rad * last_turn, [1.0; 3])[normal];
        arcs.push(ending(here, middle, center_mm));
        here = middle;
    }
    arcs.push(ending(here, end_mm, center_mm));
    Ok(arcs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn request(start_mm: Vector, end_mm: Vector, center_mm: Vector, turns: i32) -> Request {
        Request { line: 1, start_mm, end_mm, plane: Plane::Xy, center_mm, turns }
    }

    #[test]
    fn equal_ends_make_a_full_circle() {
        for turns in [1, -1] {
            let arcs = arcs(&request([10.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0; 3], turns)).unwrap();
            assert_eq!(arcs.len(), 1);
            assert!((arcs[0].1.length_mm() - 20.0 * PI).abs() < 1e-12);
            let quarter = arcs[0].1.at(5.0 * PI).position_mm;
            assert!((quarter[1] - 10.0 * f64::from(turns)).abs() < 1e-12);
        }
    }

    #[test]
    fn turns_add_whole_turns() {
        let arcs = arcs(&request([10.0, 0.0, 0.0], [0.0, 10.0, 6.5], [0.0; 3], 3)).unwrap();
        let length: f64 = arcs.iter().map(|(_, arc)| arc.length_mm()).sum();
        assert!((length - (10.0 * 4.5 * PI).hypot(6.5)).abs() < 1e-12);
    }

    #[test]
    fn a_centre_on_the_start_is_refused() {
        let error = arcs(&request([1.0, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], 1)).unwrap_err();
        assert!(matches!(error, PathError::ArcRadius { .. }), "{error}");
    }

    proptest! {
        /// Both ends hold to 1e-9 mm, the arcs join, and the path stays within the radii's difference of the circle.
        #[test]
        fn both_ends_hold(
            radius in 0.1..100.0f64, from in -7.0..7.0f64, sweep in 0.01..6.2f64, miss in -1e-3..1e-3f64,
            rise in -5.0..5.0f64, turns in prop::sample::select(vec![-3, -2, -1, 1, 2, 3]),
            plane in prop::sample::select(vec![Plane::Xy, Plane::Zx, Plane::Yz]),
        ) {
            let center = [3.0, -2.0, 7.0];
            let [first, second, normal] = plane.axes();
            let at = |radius: f64, angle: f64, rise: f64| {
                let mut point = center;
                point[first] += radius * angle.cos();
                point[second] += radius * angle.sin();
                point[normal] += rise;
                point
            };
            let sense = f64::from(turns).signum();
            let start_mm = at(radius, from, 0.0);
            let end_mm = at(radius + miss, from + sense * sweep, rise);
            let arcs = arcs(&Request { line: 1, start_mm, end_mm, plane, center_mm: center, turns }).unwrap();
            let mut here = start_mm;
            let mut length = 0.0;
            for (start, arc) in &arcs {
                prop_assert!(super::super::vector::distance(here, *start) < 1e-9);
                here = arc.at(arc.length_mm()).position_mm;
                length += arc.length_mm();
                for i in 0..=20 {
                    let point = arc.at(arc.length_mm() * f64::from(i) / 20.0).position_mm;
                    let distance = (point[first] - center[first]).hypot(point[second] - center[second]);
                    prop_assert!((distance - radius).abs() <= 1.5 * miss.abs() + 1e-9, "{} {}", distance, radius);
                }
            }
            prop_assert!(super::super::vector::distance(here, end_mm) < 1e-9);
            let turned = sweep + TAU * (f64::from(turns).abs() - 1.0);
            prop_assert!((length - (radius * turned).hypot(rise)).abs() < 2e-3 * (turned + 1.0));
        }
    }
}
