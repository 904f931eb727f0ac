//! Programs to measure the geometry with.

use std::fmt::Write;

use feedwright_sim::{AXIS_NAMES, to_four_digits};

/// A ball bar: circles in both directions about the zero of the work coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BallBarProgram {
    /// Radius, mm.
    pub radius_mm: f64,
    /// Feedrate, mm/min.
    pub feed_mm_min: f64,
    /// Axes of the plane: 0 and 1 for xy.
    pub plane: [usize; 2],
}

/// Way that the bar is shorter than the start of the program, mm: within the stroke of a
/// telescoping ball bar.
pub(super) const FEED_IN_MM: f64 = 1.0;
/// Arc before and behind the measured one, degrees: the machine has its speed, and the servos have
/// settled.
pub(super) const OVERSHOOT_DEG: f64 = 90.0;
/// The same in a plane with z, where the spindle bounds the arc.
const SHORT_OVERSHOOT_DEG: f64 = 2.0;

impl BallBarProgram {
    /// First and last angle that is measured, degrees, and the arc before and behind.
    pub(super) fn arc_deg(&self) -> ([f64; 2], f64) {
        if self.plane == [0, 1] {
            ([0.0, 360.0], OVERSHOOT_DEG)
        } else {
            ([-20.0, 200.0], SHORT_OVERSHOOT_DEG)
        }
    }

    /// Points of the moves of a direction: start, first and last point of the arc, end; and how
    /// many full turns the arc has besides.
    fn points(&self, way: f64) -> ([[f64; 2]; 4], bool) {
        let ([first, last], over) = self.arc_deg();
        let [from, to] = if way > 0.0 {
            [first - over, last + over]
        } else {
            [last + over, first - over]
        };
        let at = |angle_deg: f64, radius_mm: f64| {
            let (sin, cos) = libm::sincos(angle_deg.to_radians());
            [radius_mm * cos, radius_mm * sin].map(|mm| (mm * 1e5).round() / 1e5 + 0.0)
        };
        let outside = self.radius_mm + FEED_IN_MM;
        (
            [
                at(from, outside),
                at(from, self.radius_mm),
                at(to, self.radius_mm),
                at(to, outside),
            ],
            (to - from).abs() >= 360.0,
        )
    }

    /// The program.
    pub fn text(&self) -> String {
        let [a, b] = self.plane.map(|axis| AXIS_NAMES[axis].to_uppercase());
        let [i, j] = self.plane.map(|axis| ["I", "J", "K"][axis]);
        let plane = if self.plane == [0, 1] {
            "G17"
        } else if self.plane == [0, 2] {
            "G18"
        } else {
            "G19"
        };
        let ([first, last], over) = self.arc_deg();
        let mut text = format!(
            "(ball bar of {} mm in {}{}: both directions, measured from {first} to {last} degrees)\n(the zero of the work coordinates is at the \
             center ball; note its machine position for center_mm)\n(the arc goes {over} degrees beyond at both ends; the bar trips within \
             {FEED_IN_MM} mm outside of the radius)\nG21 G40 G49 G80 G90 G91.1 G94 {plane}\nF{}\n",
            self.radius_mm,
            a.to_lowercase(),
            b.to_lowercase(),
            to_four_digits(self.feed_mm_min)
        );
        for way in [1.0, -1.0] {
            let ([start, from, to, end], has_turn) = self.points(way);
            // G18 looks along -y: from z to x is counterclockwise there.
            let counterclockwise = (way > 0.0) != (self.plane == [0, 2]);
            let code = if counterclockwise { "G3" } else { "G2" };
            let center = format!("{i}{} {j}{}", -from[0] + 0.0, -from[1] + 0.0);
            let word = if way > 0.0 {
                "counterclockwise"
            } else {
                "clockwise"
            };
            let point = |of: [f64; 2]| format!("{a}{} {b}{}", of[0], of[1]);
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "({word})\nG0 {}\nM0 (mount the bar, start its record)\nG1 {}",
                point(start),
                point(from)
            );
            if has_turn {
                let _ = writeln!(text, "{code} {} {center}", point(from));
            }
            let _ = writeln!(
                text,
                "{code} {} {center}\nG1 {}\nM0 (stop the record)",
                point(to),
                point(end)
            );
        }
        text + "M2\n"
    }
}

/// A grid of points in both directions of both axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GridProgram {
    /// Travel of each axis, mm, from the zero of the work coordinates.
    pub travel_mm: f64,
    /// Distance of the points, mm.
    pub step_mm: f64,
    /// Feedrate, mm/min.
    pub feed_mm_min: f64,
}

/// Rest at each point of a grid, s.
const REST_S: f64 = 1.0;

impl GridProgram {
    /// Points of a line.
    fn points(&self) -> u32 {
        (self.travel_mm / self.step_mm + 1e-9)
            .floor()
            .clamp(1.0, 200.0) as u32
            + 1
    }

    /// The program: rows along x, then rows along y, each there and back.
    pub fn text(&self) -> String {
        let count = self.points();
        let mut text = format!(
            "(grid of {count} x {count} points, {} mm apart, from the zero of the work coordinates)\n(rests {REST_S} s at each: read the \
             grid encoder or the laser there)\nG21 G17 G40 G49 G80 G90 G94 G61\nF{}\n",
            self.step_mm,
            to_four_digits(self.feed_mm_min)
        );
        for [along, across] in [["X", "Y"], ["Y", "X"]] {
            for row in 0..count {
                for point in (0..count).chain((0..count).rev()) {
                    let [along_mm, across_mm] =
                        [point, row].map(|number| f64::from(number) * self.step_mm);
                    let _ = writeln!(
                        text,
                        "G1 {along}{along_mm} {across}{across_mm}\nG4 P{REST_S}"
                    );
                }
            }
        }
        text + "M2\n"
    }
}
