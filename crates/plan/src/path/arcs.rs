//! An arc motion as arcs that meet both of its ends.
//!
//! Programs round their numbers, so the programmed centre `c` is seldom equally far from start and
//! end. Both ends hold and the centre stays; what is cut is then no circle but a spiral, whose
//! radius changes evenly with the angle over all turns:
//!
//! `r(phi) = r_start + (r_end - r_start) phi / sweep`
//!
//! This is what LinuxCNC 2.9 does, measured on its motion (1 kHz, slow enough that the
//! interpolation shows nothing). The spiral is cut into circular arcs that begin and end on it,
//! each re-centred on the perpendicular bisector of its chord. With `k = (r_end - r_start) / sweep`
//! an arc over the angle `d` leaves the spiral by `k d^3 / (72 sqrt 3)` (its radius changes as a
//! sine, not evenly) and by `k^2 d^2 / (8 r)` (its centre is off by `k`); it runs ahead by `k d^2 /
//! 8`, which a helix sees times the sine of its pitch angle; and it meets the next one with a kink
//! of `k d^2 / (6 r)`. These four choose `d`.

use feedwright_gcode::canon::Plane;

use super::arc::{Arc, recenter};
use super::{MIN_LENGTH_MM, PathError};
use crate::vector::Vector;
use std::f64::consts::{PI, TAU};

/// An arc whose ends are this close, seen along the circle, is a full turn. Measured on LinuxCNC
/// 2.9 with radii of 2 and 20 mm: 6e-9 mm is a full turn, 1e-8 mm is no motion to speak of. Offsets
/// and inches add rounding far below this.
const FULL_TURN_MM: f64 = 8e-9;

/// Radii that differ by less than this are equal: the ends then meet the circle to better than the
/// path's exactness.
const EQUAL_RADII_MM: f64 = 1e-10;

/// An arc leaves the spiral by less than this for each of three reasons: together less than a third
/// of what is resolved elsewhere ([`super::MAX_GAP_MM`]).
const SPIRAL_WITHIN_MM: f64 = 1e-7;

/// Largest kink where two arcs of a spiral meet: half of what the feed plan takes for a tangent
/// joint.
const SPIRAL_KINK_RAD: f64 = 5e-4;

/// A spiral has no more arcs than this, so that memory stays bounded whatever a motion says.
const MAX_ARCS: f64 = 4096.0;

/// Largest number of turns that are all spiral. With more, only the last turn is: the arcs would be
/// too many.
const MAX_SPIRAL_TURNS: f64 = 1000.0;

/// Data of an arc motion.
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
    let Request {
        line,
        start_mm,
        end_mm,
        plane,
        center_mm,
        turns,
    } = *request;
    if turns == 0 {
        return Err(PathError::ArcTurns { line });
    }
    let [first, second, normal] = plane.axes();
    let [from, to] =
        [start_mm, end_mm].map(|at| [at[first] - center_mm[first], at[second] - center_mm[second]]);
    let [radius_from, radius_to] = [from, to].map(|at| libm::hypot(at[0], at[1]));
    let radius_mm = radius_from.min(radius_to);
    if radius_mm < MIN_LENGTH_MM {
        return Err(PathError::ArcRadius { line, radius_mm });
    }
    let sense = f64::from(turns.signum());
    let between = sense
        * libm::atan2(
            from[0] * to[1] - from[1] * to[0],
            from[0] * to[0] + from[1] * to[1],
        );
    let last_turn = if between * radius_mm > FULL_TURN_MM {
        between
    } else {
        between + TAU
    };
    let whole_turns = f64::from(turns.unsigned_abs() - 1);
    let sweep = last_turn + TAU * whole_turns;
    let rise_per_rad = (end_mm[normal] - start_mm[normal]) / sweep;

    // Turns by `sweep` about the programmed centre.
    let turning = |sweep: f64| {
        let to_center = [-from[0], -from[1]];
        (
            start_mm,
            Arc::new(
                start_mm,
                to_center,
                plane,
                sense * sweep,
                rise_per_rad * sweep,
            ),
        )
    };
    let change_mm = radius_to - radius_from;
    if change_mm.abs() <= EQUAL_RADII_MM && sweep > PI {
        return Ok(vec![turning(sweep)]);
    }

    let mut arcs = Vec::new();
    let mut here = start_mm;
    let mut left = sweep;
    if whole_turns > MAX_SPIRAL_TURNS {
        arcs.push(turning(TAU * whole_turns));
        here[normal] += rise_per_rad * TAU * whole_turns;
        left = last_turn;
    }
    let count = arcs_of_spiral(change_mm, left, radius_mm, rise_per_rad);
    let bottom = here[normal];
    for number in 1..=count {
        let share = f64::from(number) / f64::from(count);
        let next = if number == count {
            end_mm
        } else {
            let (sin, cos) = libm::sincos(sense * share * left);
            let scale = 1.0 + share * change_mm / radius_from;
            let mut point = center_mm;
            point[first] += scale * (from[0] * cos - from[1] * sin);
            point[second] += scale * (from[0] * sin + from[1] * cos);
            point[normal] = bottom + rise_per_rad * left * share;
            point
        };
        let chord = [next[first] - here[first], next[second] - here[second]];
        let to_center = [
            center_mm[first] - here[first],
            center_mm[second] - here[second],
        ];
        let (to_center, turned) = recenter(chord, to_center, sense);
        arcs.push((
            here,
            Arc::new(here, to_center, plane, turned, next[normal] - here[normal]),
        ));
        here = next;
    }
    Ok(arcs)
}

/// Number of arcs for a spiral whose radius changes by `change_mm`: see the head of this file.
fn arcs_of_spiral(change_mm: f64, sweep_rad: f64, radius_mm: f64, rise_per_rad: f64) -> u32 {
    let change_mm = change_mm.abs();
    let by_sine =
        libm::cbrt(change_mm * sweep_rad * sweep_rad / (72.0 * 3.0f64.sqrt() * SPIRAL_WITHIN_MM));
    let by_center = change_mm * (8.0 * radius_mm * SPIRAL_WITHIN_MM).sqrt().recip();
    let pitch_sine = rise_per_rad.abs() / libm::hypot(rise_per_rad, radius_mm);
    let by_pitch = (change_mm * sweep_rad * pitch_sine / (8.0 * SPIRAL_WITHIN_MM)).sqrt();
    let by_kink = (change_mm * sweep_rad / (6.0 * radius_mm * SPIRAL_KINK_RAD)).sqrt();
    // An arc that is re-centred turns by half a turn at most.
    let by_turn = sweep_rad / PI;
    by_sine
        .max(by_center)
        .max(by_pitch)
        .max(by_kink)
        .max(by_turn)
        .clamp(1.0, MAX_ARCS)
        .ceil() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn request(start_mm: Vector, end_mm: Vector, center_mm: Vector, turns: i32) -> Request {
        Request {
            line: 1,
            start_mm,
            end_mm,
            plane: Plane::Xy,
            center_mm,
            turns,
        }
    }

    #[test]
    fn equal_ends_make_a_full_circle() {
        for turns in [1, -1] {
            let arcs = arcs(&request(
                [10.0, 0.0, 0.0],
                [10.0, 0.0, 0.0],
                [0.0; 3],
                turns,
            ))
            .unwrap();
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
        assert!((length - libm::hypot(10.0 * 4.5 * PI, 6.5)).abs() < 1e-12);
    }

    #[test]
    fn a_centre_on_the_start_is_refused() {
        let error = arcs(&request([1.0, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], 1)).unwrap_err();
        assert!(matches!(error, PathError::ArcRadius { .. }), "{error}");
    }

    /// Largest distance between the arcs and the spiral about the programmed centre, seen at many
    /// points of each arc.
    fn off_the_spiral_mm(arcs: &[(Vector, Arc)], request: &Request, sweep: f64) -> f64 {
        let [first, second, normal] = request.plane.axes();
        let polar = |point: Vector| {
            let (x, y) = (
                point[first] - request.center_mm[first],
                point[second] - request.center_mm[second],
            );
            (libm::hypot(x, y), libm::atan2(y, x))
        };
        let ((radius_from, angle_from), (radius_to, _)) =
            (polar(request.start_mm), polar(request.end_mm));
        let sense = f64::from(request.turns.signum());
        let (mut turned, mut worst) = (0.0, 0.0f64);
        // A height that is off counts as the distance from the helix.
        let flat = radius_from * sweep;
        let pitch_cosine =
            flat / libm::hypot(flat, request.end_mm[normal] - request.start_mm[normal]);
        for (_, arc) in arcs {
            for number in 0..=16 {
                let point = arc
                    .at(arc.length_mm() * f64::from(number) / 16.0)
                    .position_mm;
                let (radius, angle) = polar(point);
                let step = sense * (angle - angle_from) - turned;
                turned += step - TAU * (step / TAU).round();
                let even = radius_from + (radius_to - radius_from) * turned / sweep;
                let height = request.start_mm[normal]
                    + (request.end_mm[normal] - request.start_mm[normal]) * turned / sweep;
                worst = worst
                    .max((radius - even).abs())
                    .max((point[normal] - height).abs() * pitch_cosine);
            }
        }
        assert!((turned - sweep).abs() < 1e-9, "{turned} {sweep}");
        worst
    }

    #[test]
    fn unequal_radii_make_the_spiral_of_linuxcnc() {
        // The two arcs measured on LinuxCNC: a quarter, and two turns nearly complete with a rise.
        let quarter = request([10.0, 0.0, 0.0], [0.0, 10.02, 0.0], [-0.01, 0.003, 0.0], 1);
        let sweep = libm::atan2(10.017f64, 0.01) + libm::atan2(0.003f64, 10.01);
        assert!(off_the_spiral_mm(&arcs(&quarter).unwrap(), &quarter, sweep) < 3e-7);
        let helix = request([1.0, 0.0, 0.0], [1.02, -0.01, 3.0], [0.0; 3], 2);
        let sweep = 2.0 * TAU - libm::atan2(0.01f64, 1.02);
        assert!(off_the_spiral_mm(&arcs(&helix).unwrap(), &helix, sweep) < 3e-7);
    }

    #[test]
    fn a_tiny_spiral_and_a_million_turns_are_bounded() {
        let tiny = request([-0.01, -0.003, 0.0], [0.0, 0.017, 0.0], [0.0; 3], 1);
        let sweep = 1.5 * PI - libm::atan2(0.003f64, 0.01);
        assert!(off_the_spiral_mm(&arcs(&tiny).unwrap(), &tiny, sweep) < 3e-7);
        let many = request([10.0, 0.0, 0.0], [0.0, 10.02, 1.0], [0.0; 3], 1_000_000);
        assert!(arcs(&many).unwrap().len() < 100);
        let far = request([1.0, 0.0, 0.0], [0.0, 1e6, 0.0], [0.0; 3], 1);
        assert!(arcs(&far).unwrap().len() <= 4096);
    }

    proptest! {
        /// Both ends hold to 1e-9 mm, the arcs join, and the path stays within the radii's
        /// difference of the circle.
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
                point[first] += radius * libm::cos(angle);
                point[second] += radius * libm::sin(angle);
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
                prop_assert!(crate::vector::distance(here, *start) < 1e-9);
                here = arc.at(arc.length_mm()).position_mm;
                length += arc.length_mm();
                for i in 0..=20 {
                    let point = arc.at(arc.length_mm() * f64::from(i) / 20.0).position_mm;
                    let distance = libm::hypot(point[first] - center[first], point[second] - center[second]);
                    prop_assert!((distance - radius).abs() <= miss.abs() + 1e-6, "{} {}", distance, radius);
                }
            }
            prop_assert!(crate::vector::distance(here, end_mm) < 1e-9);
            let turned = sweep + TAU * (f64::from(turns).abs() - 1.0);
            let request = Request { line: 1, start_mm, end_mm, plane, center_mm: center, turns };
            prop_assert!(off_the_spiral_mm(&arcs, &request, turned) < 3e-7);
            prop_assert!((length - libm::hypot(radius * turned, rise)).abs() < 2e-3 * (turned + 1.0));
        }
    }
}
