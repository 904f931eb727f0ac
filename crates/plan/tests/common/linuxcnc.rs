//! LinuxCNC beside this reader: what `rs274` and LinuxCNC's interpreter say to a program, and where
//! its motions differ from ours.
//!
//! Used by the test over the corpus and by the comparison of generated programs.

use std::cell::Cell;
use std::collections::HashSet;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::Command;

use feedwright_gcode::canon::{Canon, EventKind, Motion, MotionKind, Plane, Shape};
use feedwright_gcode::{Dialect, Reader, Settings, ToolTable};
use feedwright_plan::{Piece, Pieces, Step};

/// Largest distance between our points and LinuxCNC's, mm: its inches and our millimetres differ by
/// rounding only.
const SAME_POINT_MM: f64 = 1e-6;
/// Largest distance between our centres and LinuxCNC's, mm.
const SAME_CENTRE_MM: f64 = 1e-6;
/// Largest distance of a point of LinuxCNC's arc from our path, mm.
const SAME_ARC_MM: f64 = 1e-6;
/// Points of an arc that are compared, ends included.
const ARC_POINTS: u32 = 9;
/// LinuxCNC takes an arc that ends this close to its start, mm, for a full turn (measured: between
/// 6e-9 and 1e-8).
const FULL_TURN_MM: f64 = 8e-9;
/// Lines shorter than this are no motion, mm.
const NO_MOTION_MM: f64 = 1e-9;

#[derive(Debug)]
pub(crate) struct Theirs {
    pub(crate) moves: Vec<serde_json::Value>,
    pub(crate) refused: Option<String>,
    pub(crate) complete: bool,
}

/// Tools without length, an eighth of an inch thick; `rs274` alone counts in inches.
pub(crate) fn tool_table() -> String {
    (1..=99)
        .map(|tool| format!("T{tool} P{tool} Z0 D0.125 ;\n"))
        .collect()
}

pub(crate) fn theirs(paths: &[PathBuf]) -> Vec<Theirs> {
    let folder = tempfile::tempdir().unwrap();
    let script =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle_scripts/linuxcnc_canon.py");
    let mut command = Command::new("/usr/bin/python3");
    command.arg(script).arg(folder.path()).args(paths);
    // The interpreter keeps what it says to itself; a program that crashes it leaves a file without
    // an end.
    command.status().unwrap();
    (0..paths.len())
        .map(|number| {
            let text = std::fs::read_to_string(folder.path().join(format!("{number}.json")))
                .unwrap_or_default();
            let mut theirs = Theirs {
                moves: Vec::new(),
                refused: None,
                complete: false,
            };
            for line in text.lines() {
                let Ok(value) = serde_json::from_str::<serde_json::Value>(line) else {
                    continue;
                };
                match value[0].as_str() {
                    Some("end") => theirs.complete = true,
                    Some("error") => {
                        theirs.refused = Some(format!("line {}: {}", value[1], value[2]));
                    }
                    _ => theirs.moves.push(value),
                }
            }
            theirs
        })
        .collect()
}

/// A motion of ours.
#[derive(Debug, Clone)]
pub(crate) struct Ours {
    motion: Motion,
    /// True where the operator makes the motion in LinuxCNC: the retraction of G88.
    by_hand: bool,
    /// Allowed distance of its end from LinuxCNC's, mm.
    within_mm: f64,
}

pub(crate) fn ours(path: &Path) -> (Vec<Ours>, Option<String>) {
    let settings = Settings {
        dialect: Some(Dialect::LinuxCnc),
        max_idle_lines: 1_000_000,
        max_motions: 3_000_000,
        tools: ToolTable::parse(&tool_table(), 25.4).unwrap(),
        ..Settings::default()
    };
    let mut motions = Vec::new();
    let reader = match Reader::open(path, settings) {
        Ok(reader) => reader,
        Err(error) => return (motions, Some(error.to_string())),
    };
    // The line of a stop and a start of the spindle, one right behind the other: G88, whose next
    // motion is the retraction.
    let (mut stopped, mut started) = (None, None);
    for step in reader {
        match step {
            Ok(Canon::Motion(motion)) => {
                let by_hand =
                    started.take() == Some(motion.line) && motion.kind == MotionKind::Rapid;
                motions.push(Ours {
                    motion,
                    by_hand,
                    within_mm: SAME_POINT_MM,
                });
            }
            Ok(Canon::Event(event)) => {
                let line = Some(event.line);
                match event.kind {
                    EventKind::MCode { code: 3 | 4, .. } => {
                        started = stopped.take().filter(|stop| Some(*stop) == line);
                    }
                    EventKind::MCode { code: 0, .. } => stopped = line,
                    _ => (stopped, started) = (None, None),
                }
            }
            Err(fault) => {
                return (
                    motions,
                    Some(format!("line {}: {}", fault.line, fault.message)),
                );
            }
        }
    }
    (motions, None)
}

pub(crate) fn point(value: &serde_json::Value) -> [f64; 9] {
    std::array::from_fn(|axis| value[axis].as_f64().unwrap_or(f64::NAN))
}

fn end_of(motion: &Motion) -> [f64; 9] {
    let mut end = [0.0; 9];
    end[..3].copy_from_slice(&motion.end_mm);
    if let Some(axes) = &motion.others.axes {
        end[3..].copy_from_slice(&axes[1]);
    }
    end
}

/// Returns true if two points differ. NaN always differs.
fn far(a: &[f64], b: &[f64], limit: f64) -> bool {
    let distance = apart(a, b);
    distance.is_nan() || distance > limit || a.iter().chain(b).any(|value| value.is_nan())
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// The path stage's curves of one motion.
pub(crate) fn path_of(motion: &Motion) -> Vec<Piece> {
    // Only the shape is compared.
    let motion = Motion {
        feed_mm_s: 1.0,
        ..motion.clone()
    };
    let steps = Pieces::new([Canon::Motion(motion)].into_iter());
    steps
        .filter_map(|step| {
            if let Step::Piece(piece) = step.unwrap() {
                Some(piece)
            } else {
                None
            }
        })
        .collect()
}

/// Distance of a point from a path, mm.
pub(crate) fn away_from(path: &[Piece], point: [f64; 3]) -> f64 {
    let to = |piece: &Piece| {
        let at = piece
            .curve
            .at(piece.curve.nearest(point, 0.0, piece.length_mm))
            .position_mm;
        (0..3)
            .map(|axis| (at[axis] - point[axis]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    path.iter().map(to).fold(f64::INFINITY, f64::min)
}

/// LinuxCNC's motion along an arc, written without the project: about the centre that its
/// interpreter gives out, the radius and the height change evenly with the angle. That its motion
/// does so was measured in a running LinuxCNC 2.9 at 1 kHz; the deviation was 1.3e-6 mm, of which
/// 0.7e-6 is the printing of six decimals and the rest the interpolation at that speed.
pub(crate) struct Spiral {
    center: [f64; 2],
    axes: [usize; 3],
    radius: [f64; 2],
    height: [f64; 2],
    angle: f64,
    sweep: f64,
}

impl Spiral {
    pub(crate) fn new(
        start: [f64; 3],
        end: [f64; 9],
        center: [f64; 2],
        plane: Plane,
        turns: i32,
    ) -> Self {
        let axes = plane.axes();
        let [first, second, normal] = axes;
        let from = [start[first] - center[0], start[second] - center[1]];
        let to = [end[first] - center[0], end[second] - center[1]];
        let radius = [from[0].hypot(from[1]), to[0].hypot(to[1])];
        let sense = f64::from(turns.signum());
        let mut sweep =
            sense * (from[0] * to[1] - from[1] * to[0]).atan2(from[0] * to[0] + from[1] * to[1]);
        if sweep * radius[0] < FULL_TURN_MM {
            sweep += TAU;
        }
        sweep += TAU * f64::from(turns.abs() - 1);
        let angle = from[1].atan2(from[0]);
        Self {
            center,
            axes,
            radius,
            height: [start[normal], end[normal]],
            angle,
            sweep: sense * sweep,
        }
    }

    pub(crate) fn at(&self, share: f64) -> [f64; 3] {
        let even = |[from, to]: [f64; 2]| from + (to - from) * share;
        let (sin, cos) = (self.angle + self.sweep * share).sin_cos();
        let mut point = [0.0; 3];
        point[self.axes[0]] = self.center[0] + even(self.radius) * cos;
        point[self.axes[1]] = self.center[1] + even(self.radius) * sin;
        point[self.axes[2]] = even(self.height);
        point
    }

    /// Simpson's rule over the speed, which hardly changes.
    fn length(&self) -> f64 {
        let speed = |share: f64| {
            let radius = self.radius[0] + (self.radius[1] - self.radius[0]) * share;
            (radius * self.sweep)
                .hypot(self.radius[1] - self.radius[0])
                .hypot(self.height[1] - self.height[0])
        };
        (speed(0.0) + 4.0 * speed(0.5) + speed(1.0)) / 6.0
    }

    /// Returns the deviation of our path, mm: the largest distance of the points of this spiral
    /// from our path, and the difference of the lengths.
    fn apart(&self, motion: &Motion) -> [f64; 2] {
        let pieces = path_of(motion);
        let distance = (0..ARC_POINTS)
            .map(|number| {
                away_from(
                    &pieces,
                    self.at(f64::from(number) / f64::from(ARC_POINTS - 1)),
                )
            })
            .fold(0.0, f64::max);
        let length: f64 = pieces.iter().map(|piece| piece.length_mm).sum();
        [distance, (length - self.length()).abs()]
    }
}

/// Totals of a comparison.
#[derive(Debug, Default)]
pub(crate) struct Totals {
    /// Largest differences of arcs, their lengths and points of splines, mm.
    pub(crate) largest_mm: [f64; 3],
    /// Flat corners of cutter compensation, where LinuxCNC cuts into the contour.
    pub(crate) flat_corners: u64,
}

/// Corners up to 0.05 rad are flat to LinuxCNC's compensation: the chord of that angle.
const FLAT_RAD: f64 = 0.049_994_8;

/// Diameter of the tool in the table, and of one that the program computes, mm.
const TABLE_MM: f64 = 0.125 * 25.4;

/// Radius of the largest tool that the program compensates for, mm: `G41.1 D` and `G42.1 D`, or the
/// tool table. 0 without.
pub(crate) fn compensated_radius(text: &str) -> f64 {
    let text = text.to_ascii_uppercase().replace(' ', "");
    let unit = if text.contains("G20") { 25.4 } else { 1.0 };
    let diameter = |rest: &str| {
        let number: String = rest
            .chars()
            .take_while(|c| c.is_ascii_digit() || *c == '.')
            .collect();
        number.parse().map_or(TABLE_MM, |d: f64| d * unit)
    };
    let given = ["G41.1D", "G42.1D"]
        .iter()
        .flat_map(|code| text.split(code).skip(1))
        .map(diameter);
    let by_table = ["G41", "G42"].iter().any(|code| {
        text.match_indices(code)
            .any(|(at, _)| !text[at + 3..].starts_with('.'))
    });
    let table = if by_table { TABLE_MM } else { 0.0 };
    0.5 * given.fold(table, f64::max)
}

/// The program without its compensation: every motion goes along the contour.
pub(crate) fn without_compensation(text: &str) -> String {
    let line = |line: &str| {
        let mut kept = line.to_ascii_uppercase().replace([' ', '\t'], "");
        for code in ["G40", "G41.1", "G42.1", "G41", "G42"] {
            let Some(at) = kept.find(code).filter(|_| !kept.starts_with(['(', ';'])) else {
                continue;
            };
            kept.replace_range(at..at + code.len(), "");
            if let Some(at) = kept.find('D').filter(|_| code != "G40") {
                let number = kept[at + 1..].find(|c: char| !c.is_ascii_digit() && c != '.');
                kept.replace_range(at..number.map_or(kept.len(), |length| at + 1 + length), "");
            }
        }
        kept
    };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// Direction of a motion in the plane, at its end or its start; none where it does not move there.
fn direction(motion: &Motion, normal: usize, at_end: bool) -> Option<[f64; 3]> {
    let mut way: [f64; 3] = std::array::from_fn(|axis| motion.end_mm[axis] - motion.start_mm[axis]);
    if let Shape::Arc {
        plane,
        center_mm,
        turns,
    } = &motion.shape
    {
        let [first, second, _] = plane.axes();
        let at = if at_end {
            motion.end_mm
        } else {
            motion.start_mm
        };
        let sense = f64::from(turns.signum());
        (way[first], way[second]) = (
            sense * (center_mm[second] - at[second]),
            sense * (at[first] - center_mm[first]),
        );
    }
    way[normal] = 0.0;
    let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
    (length > 0.0).then(|| way.map(|x| x / length))
}

/// Lines that begin at a flat corner of the contour.
pub(crate) fn flat_lines(text: &str) -> HashSet<u32> {
    let settings = Settings {
        dialect: Some(Dialect::LinuxCnc),
        max_motions: 1_000_000,
        ..Settings::default()
    };
    let Ok(reader) = Reader::from_text("contour", without_compensation(text), settings) else {
        return HashSet::new();
    };
    let normal = if text.to_ascii_uppercase().contains("G18") {
        1
    } else {
        2
    };
    let motions = reader.filter_map(|step| {
        if let Ok(Canon::Motion(motion)) = step {
            Some(motion)
        } else {
            None
        }
    });
    let (mut before, mut flat): (Option<[f64; 3]>, _) = (None, HashSet::new());
    for motion in motions {
        let (start, end) = (
            direction(&motion, normal, false),
            direction(&motion, normal, true),
        );
        if let (Some(a), Some(b)) = (before, start)
            && (0..3)
                .map(|axis| (a[axis] - b[axis]).powi(2))
                .sum::<f64>()
                .sqrt()
                <= FLAT_RAD
        {
            flat.insert(motion.line);
        }
        before = end.or(before);
    }
    flat
}

/// Returns true if a motion is an arc that turns no farther than a flat corner.
fn turns_little(motion: &Motion) -> bool {
    let Shape::Arc { center_mm, .. } = &motion.shape else {
        return false;
    };
    let apart = |a: [f64; 3], b: [f64; 3]| {
        (0..3)
            .map(|axis| (a[axis] - b[axis]).powi(2))
            .sum::<f64>()
            .sqrt()
    };
    let chord = apart(motion.start_mm, motion.end_mm);
    chord > NO_MOTION_MM && chord <= apart(motion.start_mm, *center_mm) * FLAT_RAD * 1.001
}

/// The motions without the arcs round flat corners, whose ends may be farther from LinuxCNC's.
fn without_flat_corners(text: &str, ours: &[Ours], totals: &mut Totals) -> Vec<Ours> {
    let radius_mm = compensated_radius(text);
    let flat = if radius_mm > 0.0 {
        flat_lines(text)
    } else {
        HashSet::new()
    };
    let mut kept: Vec<Ours> = Vec::with_capacity(ours.len());
    for (number, step) in ours.iter().enumerate() {
        let motion = &step.motion;
        let next = ours.get(number + 1).map(|next| next.motion.line);
        // A loop may repeat its line: an arc of the program turns farther than that round a flat
        // corner, or is full.
        let is_round = radius_mm > 0.0 && turns_little(motion);
        if is_round && next == Some(motion.line) && flat.contains(&motion.line) {
            totals.flat_corners += 1;
            continue;
        }
        let is_flat = next.is_some_and(|next| next != motion.line && flat.contains(&next));
        totals.flat_corners += u64::from(is_flat);
        // Both offset curves end beside the corner, and meet within r times its angle.
        kept.push(Ours {
            within_mm: if is_flat {
                radius_mm * FLAT_RAD
            } else {
                SAME_POINT_MM
            },
            ..step.clone()
        });
    }
    kept
}

/// Returns true if a straight motion continues in the next one. At a surface speed (G96) our
/// motions are cut into pieces.
fn goes_on(motion: &Motion, next: &Motion) -> bool {
    let way = |motion: &Motion| -> [f64; 3] {
        std::array::from_fn(|axis| motion.end_mm[axis] - motion.start_mm[axis])
    };
    let [a, b] = [way(motion), way(next)];
    let length = |way: [f64; 3]| way.iter().map(|x| x * x).sum::<f64>().sqrt();
    let ahead: f64 = (0..3).map(|axis| a[axis] * b[axis]).sum();
    let beside = (0..3)
        .map(|axis| (a[axis] * length(b) - b[axis] * length(a)).abs())
        .fold(0.0, f64::max);
    motion.line == next.line
        && motion.kind == MotionKind::Feed
        && next.kind == MotionKind::Feed
        && motion.shape == Shape::Line
        && next.shape == Shape::Line
        && ahead > 0.0
        && beside <= SAME_POINT_MM * length(b)
}

/// The first difference between the motions of the program `text`, if there is one.
pub(crate) fn compare(
    text: &str,
    ours: &[Ours],
    theirs: &Theirs,
    totals: &mut Totals,
) -> Option<String> {
    let is_cut = text.to_ascii_uppercase().contains("G96");
    let before = Cell::new([0.0; 9]);
    let mut others = [0.0; 6];
    let mut moves = theirs
        .moves
        .iter()
        .filter(|value| {
            let end = point(&value[2]);
            let moves = value[0] == "arc" || apart(&end, &before.get()) > NO_MOTION_MM;
            // A rigid tap comes back to where it began.
            if value[0] != "tap" {
                before.set(end);
            }
            moves
        })
        .peekable();
    let mut returns = false;
    let ours = without_flat_corners(text, ours, totals);
    // Theirs, while ours are pieces of it.
    let mut under_way = None;
    for (
        number,
        Ours {
            motion,
            by_hand,
            within_mm,
        },
    ) in ours.iter().enumerate()
    {
        if std::mem::take(&mut returns) {
            // Their rigid tap comes back by itself.
            continue;
        }
        if motion.shape == Shape::Line
            && motion.others.axes.is_none()
            && apart(&motion.start_mm, &motion.end_mm) <= NO_MOTION_MM
        {
            continue;
        }
        let mut end = end_of(motion);
        if let Some(axes) = &motion.others.axes {
            others = axes[1];
        }
        end[3..].copy_from_slice(&others);
        let place = |what: &str, value: &serde_json::Value| {
            Some(format!(
                "motion {number}, line {}: {what}; ours {motion:?}, theirs {value}",
                motion.line
            ))
        };
        if *by_hand {
            before.set(end);
            continue;
        }
        let Some(value) = under_way.take().or_else(|| moves.next()) else {
            return place("they have no more motions", &serde_json::Value::Null);
        };
        let wrong = match &motion.shape {
            // An arc in a plane that is turned out of the axes': only its end can be compared.
            Shape::Spline(_) if value[0] == "arc" => None,
            Shape::Spline(_) => {
                if let Some((wrong, value)) = wrong_spline(motion, &end, value, &mut moves, totals)
                {
                    return place(&wrong, value);
                }
                continue;
            }
            Shape::Arc { .. } => wrong_arc(motion, value, totals),
            Shape::Line => {
                let is_rapid = motion.kind == MotionKind::Rapid;
                (value[0] == "arc" || is_rapid != (value[0] == "rapid"))
                    .then(|| "another kind".to_owned())
            }
        };
        if let Some(wrong) = wrong {
            return place(&wrong, value);
        }
        // A rigid tap says nothing of the axes that do not move.
        let axes = if value[0] == "tap" { 0..3 } else { 0..9 };
        if far(&end[axes.clone()], &point(&value[2])[axes], *within_mm) {
            if is_cut
                && ours
                    .get(number + 1)
                    .is_some_and(|next| goes_on(motion, &next.motion))
            {
                under_way = Some(value);
                continue;
            }
            return place("another end", value);
        }
        returns = value[0] == "tap";
    }
    let moves_on = |value: &serde_json::Value| {
        format!(
            "motion {}, line {}: we have no more; theirs {value}",
            ours.len(),
            value[1]
        )
    };
    moves.next().map(moves_on)
}

/// Returns the difference between LinuxCNC's arc and ours, if there is one.
fn wrong_arc(motion: &Motion, value: &serde_json::Value, totals: &mut Totals) -> Option<String> {
    let Shape::Arc {
        plane,
        center_mm,
        turns,
    } = &motion.shape
    else {
        return None;
    };
    let number = match plane {
        Plane::Xy => 0,
        Plane::Zx => 1,
        Plane::Yz => 2,
    };
    let [first, second, _] = plane.axes();
    let center = [
        value[4][0].as_f64().unwrap_or(f64::NAN),
        value[4][1].as_f64().unwrap_or(f64::NAN),
    ];
    if value[0] != "arc" || value[3] != number || value[5] != *turns {
        return Some("another shape".to_owned());
    }
    if far(
        &center,
        &[center_mm[first], center_mm[second]],
        SAME_CENTRE_MM,
    ) {
        return Some("another centre".to_owned());
    }
    let spiral = Spiral::new(motion.start_mm, end_of(motion), center, *plane, *turns);
    let [distance, length] = spiral.apart(motion);
    totals.largest_mm[0] = totals.largest_mm[0].max(distance);
    totals.largest_mm[1] = totals.largest_mm[1].max(length);
    // Not a number is far.
    let is_same = distance <= SAME_ARC_MM && length <= SAME_ARC_MM;
    (!is_same).then(|| format!("another arc, {distance} mm apart, {length} mm longer or shorter"))
}

/// Returns the difference between a spline and the chords and arcs that LinuxCNC cuts it into,
/// whose ends must lie on it, and the move with the difference.
fn wrong_spline<'a>(
    motion: &Motion,
    end: &[f64; 9],
    first: &'a serde_json::Value,
    moves: &mut std::iter::Peekable<impl Iterator<Item = &'a serde_json::Value>>,
    totals: &mut Totals,
) -> Option<(String, &'a serde_json::Value)> {
    let path = path_of(motion);
    let mut last = first;
    while apart(&point(&last[2]), end) > SAME_POINT_MM {
        let Some(next) = moves.next_if(|next| next[0] == "feed" || next[0] == "arc") else {
            return Some(("the spline ends elsewhere".to_owned(), last));
        };
        let away = away_from(&path, std::array::from_fn(|axis| point(&last[2])[axis]));
        totals.largest_mm[2] = totals.largest_mm[2].max(away);
        if away.is_nan() || away > SAME_POINT_MM {
            return Some((format!("a point {away} mm off the spline"), last));
        }
        last = next;
    }
    None
}
