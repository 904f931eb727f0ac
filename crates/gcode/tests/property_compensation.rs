//! Cutter compensation over random contours: the path of the tool's centre is everywhere as far
//! from the contour as the tool's radius, wherever the tool fits.
//!
//! The contour is kept here as the lines and arcs that the program is printed from; distances are
//! those of points from them.
use std::f64::consts::{PI, TAU};

use feedwright_gcode::canon::{Canon, Motion, MotionKind, Shape};
use feedwright_gcode::{Diagnostic, Reader, Settings};
use proptest::prelude::*;

/// Largest deviation of the distance from the radius, mm. The program is printed to 1e-9 mm; a
/// joint may take 1e-7 mm.
const SLACK_MM: f64 = 1e-6;
/// Points of a motion that are looked at.
const POINTS: u32 = 40;
/// Length of the way to the contour and away from it: longer than any radius.
const LEAD_MM: f64 = 50.0;

type Point = [f64; 2];

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn length(a: Point) -> f64 {
    a[0].hypot(a[1])
}

fn from_polar(at: Point, angle: f64, by: f64) -> Point {
    [at[0] + by * angle.cos(), at[1] + by * angle.sin()]
}

/// One motion of the contour: a turn before it, then a line, or an arc to the left (`bend` above 0)
/// or right.
#[derive(Debug, Clone)]
struct Stroke {
    turn: f64,
    length_mm: f64,
    /// Angle of an arc, rad; 0 is a line.
    bend: f64,
}

/// A line or an arc of the contour; radius and centre are those of an arc.
#[derive(Debug, Clone)]
struct Element {
    start: Point,
    end: Point,
    arc: Option<(Point, f64, f64)>,
}

impl Element {
    /// Distance of a point, mm.
    fn distance(&self, point: Point) -> f64 {
        let to_ends = length(minus(point, self.start)).min(length(minus(point, self.end)));
        let Some((center, radius, bend)) = self.arc else {
            let (way, to) = (minus(self.end, self.start), minus(point, self.start));
            let along = (way[0] * to[0] + way[1] * to[1]) / length(way);
            if !(0.0..=length(way)).contains(&along) {
                return to_ends;
            }
            return (way[0] * to[1] - way[1] * to[0]).abs() / length(way);
        };
        let angle_of = |point: Point| minus(point, center)[1].atan2(minus(point, center)[0]);
        let swept = bend.signum() * (angle_of(point) - angle_of(self.start));
        if swept.rem_euclid(TAU) <= bend.abs() {
            (length(minus(point, center)) - radius).abs()
        } else {
            to_ends
        }
    }
}

/// The contour from the origin along X, and its program with a way to it and away from it.
fn program(strokes: &[Stroke], is_left: bool, radius: f64) -> (String, Vec<Element>) {
    let side = if is_left { 1.0 } else { -1.0 };
    let (mut at, mut heading) = ([0.0, 0.0], 0.0);
    let mut elements = Vec::new();
    let code = if is_left { 41 } else { 42 };
    let mut text = format!(
        "G21 G17 G90 F600\nG0 X{:.9} Y0\nG{code}.1 D{:.9} G1 X0 Y0\n",
        -LEAD_MM,
        2.0 * radius
    );
    for stroke in strokes {
        heading += stroke.turn;
        let start = at;
        if stroke.bend == 0.0 {
            at = from_polar(at, heading, stroke.length_mm);
            text += &format!("G1 X{:.9} Y{:.9}\n", at[0], at[1]);
            elements.push(Element {
                start,
                end: at,
                arc: None,
            });
        } else {
            let sense = stroke.bend.signum();
            let arc_radius = stroke.length_mm / stroke.bend.abs();
            let center = from_polar(at, heading + 0.5 * PI * sense, arc_radius);
            heading += stroke.bend;
            at = from_polar(center, heading - 0.5 * PI * sense, arc_radius);
            let [i, j] = minus(center, start);
            let code = if sense > 0.0 { 3 } else { 2 };
            text += &format!("G{code} X{:.9} Y{:.9} I{i:.9} J{j:.9}\n", at[0], at[1]);
            elements.push(Element {
                start,
                end: at,
                arc: Some((center, arc_radius, stroke.bend)),
            });
        }
    }
    let away = from_polar(at, heading + 0.5 * PI * side, LEAD_MM);
    text += &format!("G40 G1 X{:.9} Y{:.9}\nM2\n", away[0], away[1]);
    (text, elements)
}

/// Motions, faults and warnings.
fn read(text: &str) -> (Vec<Motion>, Vec<Diagnostic>) {
    let (mut motions, mut faults) = (Vec::new(), Vec::new());
    let mut reader = Reader::from_text("contour", text, Settings::default()).unwrap();
    for step in reader.by_ref() {
        match step {
            Ok(Canon::Motion(motion)) => motions.push(motion),
            Ok(Canon::Event(_)) => {}
            Err(fault) => faults.push(fault),
        }
    }
    faults.extend_from_slice(reader.warnings());
    (motions, faults)
}

/// Points of a motion in the plane, its ends included.
fn points(motion: &Motion) -> Vec<Point> {
    let flat = |[x, y, _]: [f64; 3]| [x, y];
    let (start, end) = (flat(motion.start_mm), flat(motion.end_mm));
    let shares = (0..=POINTS).map(|n| f64::from(n) / f64::from(POINTS));
    let Shape::Arc {
        center_mm, turns, ..
    } = &motion.shape
    else {
        return shares
            .map(|t| {
                [
                    start[0] + t * (end[0] - start[0]),
                    start[1] + t * (end[1] - start[1]),
                ]
            })
            .collect();
    };
    let center = flat(*center_mm);
    let (from, to) = (minus(start, center), minus(end, center));
    let sense = f64::from(turns.signum());
    let mut swept =
        sense * (from[0] * to[1] - from[1] * to[0]).atan2(from[0] * to[0] + from[1] * to[1]);
    if swept < 0.0 {
        swept += TAU;
    }
    let (angle, radii) = (from[1].atan2(from[0]), [length(from), length(to)]);
    shares
        .map(|t| {
            from_polar(
                center,
                angle + sense * swept * t,
                radii[0] + t * (radii[1] - radii[0]),
            )
        })
        .collect()
}

/// Returns the first point of the path, without entry and exit, whose distance from the contour is
/// not the radius: line, point, distance. Only the elements next to the current one count, because
/// the tool may not fit between others.
fn wrong(motions: &[Motion], elements: &[Element], radius: f64) -> Option<String> {
    let last_line = 3 + elements.len() as u32;
    for pair in motions
        .windows(2)
        .filter(|pair| (4..=last_line).contains(&pair[0].line))
    {
        let motion = &pair[0];
        let number = motion.line as usize - 4;
        // A line that rounds a corner first has two motions: the corner's neighbours end with its
        // own element.
        let is_corner = pair[1].line == motion.line;
        for point in points(motion) {
            let near = number.saturating_sub(1)
                ..elements.len().min(number + if is_corner { 1 } else { 2 });
            let nearest = elements[near]
                .iter()
                .map(|element| element.distance(point))
                .fold(f64::INFINITY, f64::min);
            if (nearest - radius).abs() > SLACK_MM {
                return Some(format!(
                    "line {}: {point:?} is {nearest} mm from the contour, not {radius}",
                    motion.line
                ));
            }
        }
    }
    None
}

fn strokes() -> impl Strategy<Value = Vec<Stroke>> {
    let flat = prop_oneof![
        -0.05..0.05f64,
        -2e-3..2e-3f64,
        Just(0.0),
        Just(1e-5),
        Just(-1e-4)
    ];
    let turn = prop_oneof![3 => flat, 2 => -2.5..2.5f64];
    let bend = prop_oneof![3 => Just(0.0), 1 => 0.2..0.8f64, 1 => -0.8..-0.2f64];
    let one = (turn, 5.0..30.0f64, bend).prop_map(|(turn, length_mm, bend)| Stroke {
        turn,
        length_mm,
        bend,
    });
    prop::collection::vec(one, 1..7).prop_map(without_crossings)
}

/// An arc behind a sharp turn, or one before it, would cross its neighbour: no tool fits there.
fn without_crossings(mut strokes: Vec<Stroke>) -> Vec<Stroke> {
    for number in 0..strokes.len() {
        let before = number
            .checked_sub(1)
            .map_or(0.0, |before| strokes[before].bend);
        if before != 0.0 || strokes[number].bend != 0.0 {
            strokes[number].turn = strokes[number].turn.clamp(-1.0, 1.0);
        }
    }
    strokes
}

/// Way that an inner corner of two lines takes from each of them, mm.
fn retreat(turn: f64, side: f64, radius: f64) -> f64 {
    radius * (0.5 * (turn * side).max(0.0)).tan()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(5000))]

    #[test]
    fn the_path_keeps_its_distance(strokes in strokes(), is_left: bool, radius in prop_oneof![0.05..3.0f64, 3.0..12.0f64]) {
        let (text, elements) = program(&strokes, is_left, radius);
        let (motions, faults) = read(&text);
        if faults.is_empty() {
            let wrong = wrong(&motions, &elements, radius);
            prop_assert!(wrong.is_none(), "{}\n{text}", wrong.unwrap_or_default());
        } else {
            // A contour of lines is refused, or warned of, only where they are too short for their
            // corners.
            let side = if is_left { 1.0 } else { -1.0 };
            let is_straight = strokes.iter().all(|stroke| stroke.bend == 0.0);
            let taken = |n: usize| strokes.get(n).map_or(0.0, |stroke| retreat(stroke.turn, side, radius));
            let fits = |n: usize| taken(n) + taken(n + 1) < 0.999 * strokes[n].length_mm;
            prop_assert!(!is_straight || !(0..strokes.len()).all(fits), "{faults:?}\n{text}");
        }
    }
}

/// Regression: after a corner flatter than 0.05 rad, the reader computed the next inner corner from
/// a tilted line. The tool went 10.9 um into the contour.
#[test]
fn an_inner_corner_behind_a_flat_one_lies_beside_its_own_line() {
    let text = "G21 G17 F100\nG0 X-20 Y-30\nG1 G41.1 D20 X0 Y0\nG1 X30 Y0\nX40.4875 Y-0.5129\nX43.4185 Y59.4154\n\
                G40 G1 X23.4185 Y79.4154\nM2\n";
    let (motions, faults) = read(text);
    assert!(faults.is_empty(), "{faults:?}");
    let corner = motions.iter().rfind(|motion| motion.line == 5).unwrap();
    assert!((corner.end_mm[1] - 9.963_636).abs() < 1e-6, "{corner:?}");
}

/// A line that an inner corner before it has nearly used up, and another behind it: it met the far
/// side of the arc's circle, and the tool was 7 um in the contour.
#[test]
fn a_line_too_short_for_both_its_corners_is_refused_before_an_arc_too() {
    let text = "G21 G17 G90 F600\nG0 X-50 Y0\nG42.1 D22.963978615 G1 X0 Y0\nG1 X3.276279918 Y-6.353381369\n\
                G3 X5.746732698 Y-10.690850765 I22.850233972 J10.142327516\nG40 G1 X-35 Y-39\nM2\n";
    let (_, faults) = read(text);
    assert!(
        faults[0].message.contains("does not fit") && faults[0].line == 5,
        "{faults:?}"
    );
}

/// LinuxCNC's rapids go straight past an outer corner, and the tool cuts into it. The reader warns.
#[test]
fn a_rapid_past_an_outer_corner_is_straight_and_reported() {
    let text = "G21 F100\nG0 X-20 Y-30\nG1 G41.1 D5 X0 Y0\nG1 X30 Y0\nG0 X30 Y-20\nG1 X10\nG40 G1 X0 Y-40\nM2\n";
    let mut reader = Reader::from_text("rapid", text, Settings::default()).unwrap();
    let motions: Vec<Motion> = reader
        .by_ref()
        .filter_map(|step| {
            if let Canon::Motion(motion) = step.unwrap() {
                Some(motion)
            } else {
                None
            }
        })
        .filter(|motion| motion.line == 5)
        .collect();
    assert!(
        motions
            .iter()
            .all(|motion| motion.shape == Shape::Line && motion.kind == MotionKind::Rapid),
        "{motions:?}"
    );
    assert_eq!(motions[0].end_mm, [32.5, 0.0, 0.0]);
    let warning = &reader.warnings()[0];
    assert!(
        warning.line == 5 && warning.message.contains("0.7322 mm into the contour"),
        "{warning:?}"
    );
}
