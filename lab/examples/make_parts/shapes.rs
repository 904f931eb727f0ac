//! The closed contours: circle of the paper, ellipse, eight, star, square, and the slot.

use std::f64::consts::PI;
use std::fmt::Write;

use crate::biarc::{Curve, approximate};
use crate::word;

/// 50 mm/s, the feed of the paper, in mm/min.
const FEED: &str = "F3000";

struct Ellipse;
struct Eight;
struct Star;

impl Curve for Ellipse {
    fn point(&self, a: f64) -> [f64; 2] {
        [20.0 * a.cos(), 10.0 * a.sin()]
    }
    fn derivative(&self, a: f64) -> [f64; 2] {
        [-20.0 * a.sin(), 10.0 * a.cos()]
    }
}

impl Curve for Eight {
    fn point(&self, a: f64) -> [f64; 2] {
        [15.0 * a.sin(), 10.0 * (2.0 * a).sin()]
    }
    fn derivative(&self, a: f64) -> [f64; 2] {
        [15.0 * a.cos(), 20.0 * (2.0 * a).cos()]
    }
}

impl Curve for Star {
    fn point(&self, a: f64) -> [f64; 2] {
        let r = 12.0 + 4.0 * (5.0 * a).cos();
        [r * a.cos(), r * a.sin()]
    }
    fn derivative(&self, a: f64) -> [f64; 2] {
        let (r, dr) = (12.0 + 4.0 * (5.0 * a).cos(), -20.0 * (5.0 * a).sin());
        [dr * a.cos() - r * a.sin(), dr * a.sin() + r * a.cos()]
    }
}

/// File names and texts.
pub(crate) fn all() -> Vec<(&'static str, String)> {
    vec![
        ("circle.ngc", circle()),
        ("ellipse.ngc", curve("Ellipse: x = 20 cos a, y = 10 sin a", &Ellipse, 4)),
        ("eight.ngc", curve("Figure eight: x = 15 sin a, y = 10 sin 2a", &Eight, 4)),
        ("star.ngc", curve("Rounded five-pointed star: 12 + 4 cos 5a times cos a, sin a", &Star, 10)),
        ("square.ngc", square()),
        ("slot.ngc", slot()),
    ]
}

fn circle() -> String {
    format!(
        "(Circle of R = 10 mm: x = R - R cos a, y = R sin a)\n\
         (Equation 11 of Lee, Cho, Jeon, IFAC 2005; 50 mm/s)\n\
         (One full turn from X0 Y0, exact)\n\
         G21 G17 G90 G94 G64\n\
         G0 X0 Y0\n\
         G2 X0 Y0 I10 J0 {FEED}\n\
         M2\n"
    )
}

/// A closed curve over 0..2 pi, cut into `sections` equal parts of the parameter so that its symmetry shows in the arcs.
fn curve(title: &str, curve: &impl Curve, sections: u32) -> String {
    let section = |i: u32| 2.0 * PI * f64::from(i) / f64::from(sections);
    let moves: Vec<_> = (0..sections).flat_map(|i| approximate(curve, section(i), section(i + 1))).collect();
    let mut at = curve.point(0.0);
    let mut text = format!(
        "({title}, a from 0 to 360 degrees, mm)\n\
         ({} arcs, tangent to each other, within 0.5 um of the curve; 50 mm/s)\n\
         G21 G17 G90 G94 G64\n\
         G0 {} {}\n\
         {FEED}\n",
        moves.len(),
        word('X', at[0]),
        word('Y', at[1])
    );
    for step in &moves {
        let [x, y] = [word('X', step.end[0]), word('Y', step.end[1])];
        match step.center {
            None => writeln!(text, "G1 {x} {y}"),
            Some(center) => writeln!(
                text,
                "{} {x} {y} {} {}",
                if step.clockwise { "G2" } else { "G3" },
                word('I', round(center[0]) - round(at[0])),
                word('J', round(center[1]) - round(at[1]))
            ),
        }
        .expect("a string takes all that is written");
        at = step.end;
    }
    text + "M2\n"
}

/// What the file says of a coordinate: the centre is counted from the start as it was printed.
fn round(value_mm: f64) -> f64 {
    (value_mm * 1e6).round() / 1e6
}

fn square() -> String {
    format!(
        "(Square of 20 x 20 mm with sharp corners; 50 mm/s)\n\
         (G61: the corners are cut exactly, nothing is blended)\n\
         G21 G17 G90 G94 G61\n\
         G0 X0 Y0\n\
         G1 X20 Y0 {FEED}\n\
         G1 X20 Y20\n\
         G1 X0 Y20\n\
         G1 X0 Y0\n\
         M2\n"
    )
}

fn slot() -> String {
    format!(
        "(Bent slot 14 mm wide: two straight legs of 20 mm and a bend of R = 20 mm; path of the centre of a cutter of 8 mm)\n\
         (Centre line first, then the outline with tangent lead-in and lead-out; 50 mm/s)\n\
         (Lines and arcs meet smoothly, the curvature jumps; arcs by radius and by centre, one incremental move)\n\
         G21 G17 G90 G94 G64\n\
         G0 X0 Y0\n\
         (centre line)\n\
         G1 X20 {FEED}\n\
         G3 X40 Y20 R20\n\
         G1 Y40\n\
         (back, and on to the outer wall by a quarter turn)\n\
         Y30\n\
         G3 X43 Y33 I0 J3\n\
         (upper end)\n\
         G1 Y40\n\
         G3 X37 Y40 I-3 J0\n\
         (inner wall)\n\
         G1 Y20\n\
         G2 X20 Y3 R17\n\
         G91 G1 X-20\n\
         (left end)\n\
         G90 G3 X0 Y-3 I0 J-3\n\
         (outer wall)\n\
         G1 X20\n\
         G3 X43 Y20 I0 J23\n\
         G1 Y33\n\
         (off the wall by a quarter turn)\n\
         G3 X40 Y36 I-3 J0\n\
         M2\n"
    )
}
