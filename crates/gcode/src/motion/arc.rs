//! G2 and G3: arcs, full circles and helices, by centre (I J K) or by radius (R).
//!
//! The programmed centre is handed on as it is; where start and end are not equally far from it,
//! the path is a spiral (see `path/arcs.rs`). The rules are LinuxCNC 2.9's, found by trying arcs on
//! it: the radii at start and end may differ by 0.02 sqrt(2) mm (0.002 sqrt(2) inch), or by 0.1 %
//! of the larger radius, but never by more than a hundred times the former, and neither may be
//! below 0.00005 inch.

use std::f64::consts::TAU;
use std::sync::Arc;

use crate::canon::{Plane, Shape, Spline};
use crate::geometry::plane::PlaneArc;
use crate::geometry::spiral::{FULL_TURN_WITHIN_MM, Spiral};
use crate::motion::feed::{Speed, others};
use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::state::frame::Position;
use crate::state::modal::INCH_MM;
use crate::text::block::Block;
use crate::text::codes::{bit, letter, slot as slot_of};
use crate::text::diagnostic::{LineFault, Read};

/// Difference of the radii that is always accepted, mm and inch.
const RADIUS_SLACK: [f64; 2] = [
    0.02 * std::f64::consts::SQRT_2,
    0.002 * std::f64::consts::SQRT_2,
];
/// Difference of the radii that is never accepted, mm and inch.
const RADIUS_SLACK_MOST: [f64; 2] = [
    2.0 * std::f64::consts::SQRT_2,
    0.2 * std::f64::consts::SQRT_2,
];
/// Share of the radius that the difference must stay below where it lies between these two limits.
const RADIUS_SLACK_SHARE: f64 = 1e-3;
/// Smallest radius of an arc given by its centre, mm: 0.00005 inch, in both units.
const MIN_RADIUS_MM: f64 = 0.000_05 * INCH_MM;
/// R may be shorter than half the chord by this much, mm: 0.00005 inch, in both units; the arc is
/// then a half circle.
const CHORD_SLACK_MM: f64 = 0.000_05 * INCH_MM;
/// Full turns that P may ask for; a thread has fewer, and the turns are an i32 later.
const MAX_TURNS: i64 = 1_000_000;

/// Letters of the centre along X, Y, Z.
const CENTER_LETTERS: [u8; 3] = *b"ijk";

impl Interpreter {
    /// G2 (`counter_clockwise` false) and G3.
    pub(crate) fn arc(&mut self, block: &Block, counter_clockwise: bool) -> Read<()> {
        let extruder_mm = self.extruder_word(block);
        let target = self.target(block)?;
        if std::mem::take(&mut self.carried.left_compensation) {
            let message = "the first motion behind G40 must be straight, not an arc";
            return Err(
                LineFault::new("gcode::compensation", block.whole(), message)
                    .hint("the tool stands beside the contour: lead it away with G1 or G0 first"),
            );
        }
        let round = match self.round(block, &target, counter_clockwise) {
            Ok(round) => round,
            Err(fault) => {
                // What follows is checked from where this arc was meant to end.
                self.at = target;
                self.here = self.frame.to_machine(&target);
                return Err(fault);
            }
        };
        self.arc_as(block, &target, round, extruder_mm)
    }

    /// Along a circle to a point in program coordinates, beside it under cutter compensation.
    pub(crate) fn arc_as(
        &mut self,
        block: &Block,
        target: &Position,
        round: PlaneArc,
        extruder_mm: f64,
    ) -> Read<()> {
        if self.compensated_arc(block, target, round)? {
            return Ok(());
        }
        let fed = self.arc_to(block, target, round, extruder_mm);
        self.at = *target;
        fed
    }

    /// Moves along an arc given in program coordinates.
    pub(crate) fn arc_to(
        &mut self,
        block: &Block,
        target: &Position,
        round: PlaneArc,
        extruder_mm: f64,
    ) -> Read<()> {
        let plane = self.modal.plane;
        let [first, second, _] = plane.axes();
        if self.frame.rotation_deg != 0.0 && plane != Plane::Xy {
            return self.turned_arc(block, target, round, extruder_mm);
        }
        let mut center = self.frame.to_program(&self.here);
        center[first] = round.center[0];
        center[second] = round.center[1];
        let center = self.frame.to_machine(&center);
        let machine = self.frame.to_machine(target);
        let start = std::mem::replace(&mut self.here, machine);
        let [from, to, middle] = [start, machine, center].map(|[x, y, z, ..]| [x, y, z]);
        let length_mm = Spiral::new(from, to, middle, plane, round.turns).length_mm();
        let feed_mm_s = self.feed_for(block, length_mm)?;
        let others = others(&start, &machine, extruder_mm);
        let shape = Shape::Arc {
            plane,
            center_mm: [center[0], center[1], center[2]],
            turns: round.turns,
        };
        self.push_motion(Speed::Programmed, &start, shape, feed_mm_s, others);
        Ok(())
    }

    /// Hands out an arc outside XY in a coordinate system that is rotated about Z. Its plane is not
    /// XY, ZX or YZ of the machine, so the arc becomes one curve of cubic Bezier pieces.
    fn turned_arc(
        &mut self,
        block: &Block,
        target: &Position,
        round: PlaneArc,
        extruder_mm: f64,
    ) -> Read<()> {
        let from = self.frame.to_program(&self.here);
        let control_mm: Vec<[f64; 3]> =
            bezier_points(&from, target, round, self.modal.plane.axes())
                .into_iter()
                .map(|[x, y, z]| {
                    let mut point = from;
                    (point[0], point[1], point[2]) = (x, y, z);
                    let machine = self.frame.to_machine(&point);
                    [machine[0], machine[1], machine[2]]
                })
                .collect();
        let pieces = (control_mm.len() - 1) / 3;
        // Each inner knot three times: the curve passes through the ends of the pieces.
        let inner = (1..pieces).flat_map(|knot| [knot as f64; 3]);
        let knots = [0.0; 4]
            .into_iter()
            .chain(inner)
            .chain([pieces as f64; 4])
            .collect();
        let spline = Spline {
            degree: 3,
            knots,
            weights: vec![1.0; control_mm.len()],
            control_mm,
        };
        let machine = self.frame.to_machine(target);
        let start = std::mem::replace(&mut self.here, machine);
        let feed_mm_s = self.feed_for(block, spline.length_mm())?;
        let others = others(&start, &machine, extruder_mm);
        self.push_motion(
            Speed::Programmed,
            &start,
            Shape::Spline(Arc::new(spline)),
            feed_mm_s,
            others,
        );
        Ok(())
    }

    /// Centre and turns from the words of the block.
    pub(crate) fn round(
        &self,
        block: &Block,
        target: &Position,
        counter_clockwise: bool,
    ) -> Read<PlaneArc> {
        let turns = if block.has(b'p') {
            self.integer(block, b'p', 1, MAX_TURNS)? as i32
        } else {
            1
        };
        let turns = if counter_clockwise { turns } else { -turns };
        let [first, second, normal] = self.modal.plane.axes();
        let offsets = bit(b'i') | bit(b'j') | bit(b'k');
        let center = if block.has(b'r') {
            if block.set & offsets != 0 {
                return Err(LineFault::new(
                    "gcode::arc_format",
                    block.at_any(offsets),
                    "an arc has a radius R or a centre I J K, not both",
                ));
            }
            self.center_by_radius(block, target, counter_clockwise)?
        } else {
            // Post-processors for grbl write K0.
            let is_idle =
                self.dialect == Dialect::Grbl && block.get(CENTER_LETTERS[normal]) == Some(0.0);
            if block.has(CENTER_LETTERS[normal]) && !is_idle {
                let (wrong, plane) = (
                    letter(slot_of(CENTER_LETTERS[normal])),
                    ["G19 (YZ)", "G18 (ZX)", "G17 (XY)"][normal],
                );
                let [one, two] = [first, second].map(|axis| letter(slot_of(CENTER_LETTERS[axis])));
                let message = format!("{wrong} lies outside the arc's plane {plane}");
                return Err(LineFault::new(
                    "gcode::arc_plane",
                    block.at(CENTER_LETTERS[normal]),
                    message,
                )
                .hint(format!(
                    "the centre of this plane is {} and {}, or choose another plane",
                    one.min(two),
                    one.max(two)
                )));
            }
            if block.set & offsets == 0 {
                return Err(LineFault::new(
                    "gcode::arc_format",
                    block.whole(),
                    "the arc has neither a radius R nor a centre I J K",
                ));
            }
            self.center_by_offsets(block, target, [first, second])?
        };
        Ok(PlaneArc { center, turns })
    }

    fn center_by_offsets(
        &self,
        block: &Block,
        target: &Position,
        plane: [usize; 2],
    ) -> Read<[f64; 2]> {
        let mut center = plane.map(|axis| self.at[axis]);
        for (slot, axis) in plane.into_iter().enumerate() {
            let name = CENTER_LETTERS[axis];
            match block.get(name) {
                Some(value) => {
                    let value = value * self.modal.unit_mm;
                    if value.abs() > self.settings.coordinate_limit_mm {
                        return Err(self.too_far(block, name, value));
                    }
                    center[slot] = if self.modal.arc_absolute {
                        value
                    } else {
                        center[slot] + value
                    };
                }
                None if self.modal.arc_absolute => {
                    let message = format!(
                        "{} is missing: with G90.1 the centre needs both coordinates",
                        letter(slot_of(name))
                    );
                    return Err(LineFault::new("gcode::arc_format", block.whole(), message));
                }
                None => {}
            }
        }
        let radius_to = |point: &Position| {
            libm::hypot(point[plane[0]] - center[0], point[plane[1]] - center[1])
        };
        let (at_start, at_end) = (radius_to(&self.at), radius_to(target));
        let difference = (at_start - at_end).abs();
        let largest = at_start.max(at_end);
        let least = at_start.min(at_end);
        if least < MIN_RADIUS_MM {
            let message = if largest == 0.0 {
                "the arc's radius is 0 mm: centre, start and end are one point".to_owned()
            } else {
                format!("the arc's radius is {least:.6} mm; the limit is {MIN_RADIUS_MM} mm")
            };
            return Err(LineFault::new("gcode::arc_radius", block.whole(), message));
        }
        if difference > self.slack(RADIUS_SLACK_MOST)
            || (difference > self.slack(RADIUS_SLACK) && difference > RADIUS_SLACK_SHARE * largest)
        {
            let limit = (RADIUS_SLACK_SHARE * largest)
                .clamp(self.slack(RADIUS_SLACK), self.slack(RADIUS_SLACK_MOST));
            let message = format!(
                "the arc does not close: its radius is {at_start:.6} mm at the start and {at_end:.6} mm at the end, {difference:.6} mm apart; the limit is {limit:.6} mm"
            );
            let fault = LineFault::new("gcode::arc_radius", block.whole(), message);
            return Err(if self.modal.arc_absolute {
                fault.hint(
                    "G90.1 is active: I J K are the centre itself, not its distance from the start",
                )
            } else {
                fault.hint("I J K are distances from the start to the centre (G91.1); the line before may have ended elsewhere")
            });
        }
        Ok(center)
    }

    fn center_by_radius(
        &self,
        block: &Block,
        target: &Position,
        counter_clockwise: bool,
    ) -> Read<[f64; 2]> {
        let [first, second, _] = self.modal.plane.axes();
        let at = block.at(b'r');
        let radius = block.get(b'r').unwrap_or(0.0) * self.modal.unit_mm;
        if radius.abs() > self.settings.coordinate_limit_mm {
            return Err(self.too_far(block, b'r', radius));
        }
        let chord = [
            target[first] - self.at[first],
            target[second] - self.at[second],
        ];
        let length = libm::hypot(chord[0], chord[1]);
        let largest = [first, second]
            .iter()
            .fold(0.0, |most: f64, &axis| most.max(self.at[axis].abs()));
        // Ends that differ by the rounding of a sum or of a polar word give the centre any
        // direction.
        if length <= ROUNDINGS * f64::EPSILON * largest {
            return Err(LineFault::new(
                "gcode::arc_radius",
                at,
                "an arc with R must end elsewhere than it starts",
            )
            .hint("write a full circle with I J K"));
        }
        let half = 0.5 * length;
        if half > radius.abs() + CHORD_SLACK_MM {
            let message = format!(
                "R = {:.6} mm is too small to reach the end: it must be at least half the distance, {half:.6} mm",
                radius.abs()
            );
            return Err(LineFault::new("gcode::arc_radius", at, message));
        }
        let height = (radius * radius - half * half).max(0.0).sqrt();
        // Left of the chord for a counter-clockwise arc of up to half a circle; a negative R is the
        // longer way round.
        let side = if counter_clockwise == (radius > 0.0) {
            height
        } else {
            -height
        };
        let left = [-chord[1] / length, chord[0] / length];
        Ok([
            0.5 * (self.at[first] + target[first]) + side * left[0],
            0.5 * (self.at[second] + target[second]) + side * left[1],
        ])
    }

    /// A tolerance in mm: RS-274 gives each for both units.
    fn slack(&self, [in_mm, in_inch]: [f64; 2]) -> f64 {
        if self.modal.unit_mm == 1.0 {
            in_mm
        } else {
            in_inch * INCH_MM
        }
    }
}

/// Roundings that two ways to calculate the same place may differ by.
const ROUNDINGS: f64 = 8.0;

/// Angle of a Bezier piece, rad: of a quarter of a circle one piece is 2.7e-4 of the radius off,
/// with the sixth power of the angle; of this, 3e-10.
const PIECE_RAD: f64 = 0.157;

/// Control points of cubic Bezier pieces along an arc, helix or spiral.
fn bezier_points(
    from: &Position,
    to: &Position,
    round: PlaneArc,
    axes: [usize; 3],
) -> Vec<[f64; 3]> {
    let [first, second, normal] = axes;
    let out = |point: &Position| {
        [
            point[first] - round.center[0],
            point[second] - round.center[1],
        ]
    };
    let (a, b) = (out(from), out(to));
    let sense = f64::from(round.turns.signum());
    let (start_radius, end_radius) = (libm::hypot(a[0], a[1]), libm::hypot(b[0], b[1]));
    let mut sweep = sense * libm::atan2(a[0] * b[1] - a[1] * b[0], a[0] * b[0] + a[1] * b[1]);
    if sweep * start_radius < FULL_TURN_WITHIN_MM {
        sweep += TAU;
    }
    sweep += TAU * f64::from(round.turns.abs() - 1);
    let pieces = (sweep / PIECE_RAD).ceil().max(1.0);
    let step = sweep / pieces;
    let reach = 4.0 / 3.0 * libm::tan(0.25 * step);
    let begin = libm::atan2(a[1], a[0]);
    // The point at an angle along the way, and its change with the angle.
    let at = |angle: f64| {
        let share = angle / sweep;
        let (sin, cos) = libm::sincos(begin + sense * angle);
        let radius = start_radius + (end_radius - start_radius) * share;
        let slope = (end_radius - start_radius) / sweep;
        let (mut point, mut change) = ([0.0; 3], [0.0; 3]);
        point[first] = round.center[0] + radius * cos;
        point[second] = round.center[1] + radius * sin;
        point[normal] = from[normal] + (to[normal] - from[normal]) * share;
        change[first] = slope * cos - sense * radius * sin;
        change[second] = slope * sin + sense * radius * cos;
        change[normal] = (to[normal] - from[normal]) / sweep;
        (point, change)
    };
    let along = |(point, change): ([f64; 3], [f64; 3]), by: f64| {
        std::array::from_fn(|axis| point[axis] + by * change[axis])
    };
    let mut points = vec![[from[0], from[1], from[2]]];
    for piece in 1..=pieces as u64 {
        let angle = step * piece as f64;
        let (before, here) = (at(angle - step), at(angle));
        points.extend([along(before, reach), along(here, -reach), here.0]);
    }
    if let Some(last) = points.last_mut() {
        *last = [to[0], to[1], to[2]];
    }
    points
}
