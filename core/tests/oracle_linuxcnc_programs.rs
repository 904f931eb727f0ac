//! LinuxCNC reads the same programs: the same are refused, and what moves ends at the same points along the same arcs.
//!
//! The numbers come from LinuxCNC itself: `rs274` accepts or refuses, and `oracle_scripts/linuxcnc_canon.py` runs its interpreter in full
//! precision. What the path stage makes of an arc is compared with LinuxCNC's motion, and the points of its chords with our splines.
//! Programs are those in `oracle_data`, of the corpus beside the repository and those that the package installs. Differences that remain are
//! listed in `docs/gcode-differences.md` and in [`DIFFERENCES`].
#![expect(clippy::unwrap_used, reason = "a test helper may fail its test")]

use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use feedwright::gcode::canon::{Canon, Motion, MotionKind, Plane, Shape};
use feedwright::gcode::{Dialect, Reader, Settings, ToolTable};
use feedwright::path::pieces::Pieces;
use feedwright::path::{Piece, Step};

/// Largest distance between our points and LinuxCNC's, mm: its inches and our millimetres differ by rounding only.
const SAME_POINT_MM: f64 = 1e-6;
/// Largest distance between our centres and LinuxCNC's, mm.
const SAME_CENTRE_MM: f64 = 1e-6;
/// Largest distance of a point of LinuxCNC's arc from our path, mm.
const SAME_ARC_MM: f64 = 1e-6;
/// Points of an arc that are compared, ends included.
const ARC_POINTS: u32 = 9;
/// LinuxCNC takes an arc that ends this close to its start, mm, for a full turn (measured: between 6e-9 and 1e-8).
const FULL_TURN_MM: f64 = 8e-9;
/// Lines shorter than this are no motion, mm.
const NO_MOTION_MM: f64 = 1e-9;

/// Programs that are read differently on purpose: part of the path, and why.
const DIFFERENCES: &[(&str, &str)] = &[
    ("linuxcnc-nurbs/G6_", "G6.2 came with LinuxCNC 2.10"),
    ("camotics/compass.ngc", "a % that ends a program without a % at its beginning is a warning"),
    ("iniparam-failassign", "parameters of an INI file cannot be assigned"),
    ("ncfiles/cone.ngc", "rs274 alone has no axes U V W"),
    ("foam/foam.ngc", "rs274 alone has no axes U V W"),
    ("external_offsets/dyn_demo", "user M-codes need no file"),
    ("external_offsets/eoffsets", "user M-codes need no file"),
    ("external_offsets/jwp_z", "user M-codes need no file"),
    ("external_offsets/opa_demo", "user M-codes need no file"),
    ("geometry/xyzc", "user M-codes need no file"),
    ("macros/m106", "a subroutine without its end is refused"),
    ("ncfiles/smartprobe", "a dry run of a probe goes all the way"),
    ("ncfiles/useful-subroutines", "an inner arc of the tool's own radius leaves no path"),
    ("oracle_data/g5_2_outside_xy", "G5.2 is refused outside the XY plane, as G5 and G5.1 are by both"),
    ("g72-missing-iteration", "the passes of G72 that LinuxCNC's own expectation has are missing in the packaged 2.9"),
    ("ncfiles/lathe_g70_71_demo", "G70 with cutter compensation is not read"),
    ("turning_incremental", "LinuxCNC 2.9 goes to the words of G71 as coordinates in G91, too, then to the start"),
    (
        "turning_ends_below_start",
        "on which side the stock is where a profile ends on the other side than its cycle starts",
    ),
    ("turning_collinear", "LinuxCNC 2.9 has no distance to two lines that go straight on"),
    ("turning_corner_straight_on", "LinuxCNC 2.9 has no corner between two lines that go straight on"),
    ("turning_narrow_groove", "LinuxCNC 2.9 crashes at a groove narrower than D twice"),
    ("turning_negative_distance", "a negative D would cut into the part"),
    ("turning_compensation_inside", "codes in a profile that LinuxCNC passes over are refused"),
    ("turning_unit_inside", "codes in a profile that LinuxCNC passes over are refused"),
    ("turning_empty", "an empty profile is refused"),
    ("turning_one_motion", "LinuxCNC 2.9 goes on behind a profile of one motion as if it had made that motion"),
    ("turning_upward_entry", "on which side the stock is where a profile ends on the other side than its cycle starts"),
    (
        "machinist/repeat_behind_do_continue",
        "LinuxCNC 2.9 carries out a repeat twice as often behind a do that was continued",
    ),
    ("machinist/rotation_under_g92", "LinuxCNC 2.9 forgets G92 when the rotation of the active system changes"),
    (
        "machinist/cycle_across_units",
        "LinuxCNC 2.9 keeps the number and not the height at which cycles began when the unit changes",
    ),
    ("machinist/call_above_definition", "a definition below its call is stepped over"),
    ("machinist/plane_of_uvw", "planes of U, V and W are not read"),
    ("g84__g18__g99", "LinuxCNC 2.9 swaps the axes of G84 outside G17"),
    ("g84__g19__g99", "LinuxCNC 2.9 swaps the axes of G84 outside G17"),
];

#[derive(Debug)]
struct Theirs {
    moves: Vec<serde_json::Value>,
    refused: Option<String>,
    complete: bool,
}

fn programs_below(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else {
        return;
    };
    let mut entries: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() && !path.is_symlink() {
            programs_below(&path, found);
        } else if let Some(extension) = path.extension() {
            let extension = extension.to_string_lossy().to_ascii_lowercase();
            if ["ngc", "nc", "gcode"].contains(&extension.as_str()) && path.is_file() {
                found.push(path);
            }
        }
    }
}

fn programs() -> Vec<PathBuf> {
    let mut found = Vec::new();
    programs_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle_data"), &mut found);
    programs_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/corpus/gcode"), &mut found);
    let mut installed = vec!["/usr/share/linuxcnc/ncfiles", "/usr/share/axis"];
    // The samples of single configurations take most of the time; they run on request.
    if std::env::var("FEEDWRIGHT_ORACLE_ALL").is_ok() {
        installed.push("/usr/share/doc/linuxcnc/examples");
    }
    for folder in installed {
        programs_below(Path::new(folder), &mut found);
    }
    if let Ok(only) = std::env::var("FEEDWRIGHT_ORACLE_ONLY") {
        found.retain(|path| path.to_string_lossy().contains(&only));
    }
    found
}

/// Tools without length, an eighth of an inch thick; `rs274` alone counts in inches.
fn tool_table() -> String {
    (1..=99).map(|tool| format!("T{tool} P{tool} Z0 D0.125 ;\n")).collect()
}

/// Seconds that `rs274` has for a program, one attempt after the other. One that ends without a word, late or by a signal,
/// is asked again: on a busy machine that happens to any program.
const PATIENCE_S: [&str; 3] = ["2", "5", "20"];

/// What `rs274` says: `None` where it accepts.
fn verdict(path: &Path, tools: &Path) -> Option<String> {
    let attempt = |seconds: &str| {
        let mut command = Command::new("timeout");
        command.args([seconds, "rs274", "-g", "-t"]).arg(tools).arg(path).current_dir(path.parent().unwrap());
        command.output().unwrap()
    };
    let spoke = |output: &Output| output.status.success() || !output.stderr.is_empty();
    let [first, again @ ..] = PATIENCE_S;
    let output =
        again.iter().fold(attempt(first), |output, seconds| if spoke(&output) { output } else { attempt(seconds) });
    if output.status.success() {
        return None;
    }
    let text = String::from_utf8_lossy(&output.stderr).into_owned() + &format!(" [{:?}]", output.status.code());
    // Our reader only warns about a missing end.
    if text.contains("File ended with no percent sign") { None } else { Some(text.replace('\n', " | ")) }
}

fn theirs(paths: &[PathBuf]) -> Vec<Theirs> {
    let folder = tempfile::tempdir().unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/oracle_scripts/linuxcnc_canon.py");
    Command::new("/usr/bin/python3").arg(script).arg(folder.path()).args(paths).status().unwrap();
    (0..paths.len())
        .map(|number| {
            let text = std::fs::read_to_string(folder.path().join(format!("{number}.json"))).unwrap_or_default();
            let mut theirs = Theirs { moves: Vec::new(), refused: None, complete: false };
            for line in text.lines() {
                let Ok(value) = serde_json::from_str::<serde_json::Value>(line) else {
                    continue;
                };
                match value[0].as_str() {
                    Some("end") => theirs.complete = true,
                    Some("error") => theirs.refused = Some(format!("line {}: {}", value[1], value[2])),
                    _ => theirs.moves.push(value),
                }
            }
            theirs
        })
        .collect()
}

fn ours(path: &Path) -> (Vec<Motion>, Option<String>) {
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
    for step in reader {
        match step {
            Ok(Canon::Motion(motion)) => motions.push(motion),
            Ok(Canon::Event(_)) => {}
            Err(fault) => {
                return (motions, Some(format!("line {}: {}", fault.line, fault.message)));
            }
        }
    }
    (motions, None)
}

fn point(value: &serde_json::Value) -> [f64; 9] {
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

/// Whether two points differ; numbers that are none do.
fn far(a: &[f64], b: &[f64], limit: f64) -> bool {
    let distance = apart(a, b);
    distance.is_nan() || distance > limit || a.iter().chain(b).any(|value| value.is_nan())
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The path stage's curves of one motion.
fn path_of(motion: &Motion) -> Vec<Piece> {
    // Only the shape is compared.
    let motion = Motion { feed_mm_s: 1.0, ..motion.clone() };
    let steps = Pieces::new([Canon::Motion(motion)].into_iter());
    steps.filter_map(|step| if let Step::Piece(piece) = step.unwrap() { Some(piece) } else { None }).collect()
}

/// Distance of a point from a path, mm.
fn away_from(path: &[Piece], point: [f64; 3]) -> f64 {
    let to = |piece: &Piece| {
        let at = piece.curve.at(piece.curve.nearest(point, 0.0, piece.length_mm)).position_mm;
        (0..3).map(|axis| (at[axis] - point[axis]).powi(2)).sum::<f64>().sqrt()
    };
    path.iter().map(to).fold(f64::INFINITY, f64::min)
}

/// LinuxCNC's motion along an arc, written without the project: about the centre that its interpreter gives out, the radius and
/// the height change evenly with the angle. That its motion does so was measured in a running LinuxCNC 2.9 at 1 kHz; the
/// deviation was 1.3e-6 mm, of which 0.7e-6 is the printing of six decimals and the rest the interpolation at that speed.
struct Spiral {
    center: [f64; 2],
    axes: [usize; 3],
    radius: [f64; 2],
    height: [f64; 2],
    angle: f64,
    sweep: f64,
}

impl Spiral {
    fn new(start: [f64; 3], end: [f64; 9], center: [f64; 2], plane: Plane, turns: i32) -> Self {
        let axes = plane.axes();
        let [first, second, normal] = axes;
        let from = [start[first] - center[0], start[second] - center[1]];
        let to = [end[first] - center[0], end[second] - center[1]];
        let radius = [from[0].hypot(from[1]), to[0].hypot(to[1])];
        let sense = f64::from(turns.signum());
        let mut sweep = sense * (from[0] * to[1] - from[1] * to[0]).atan2(from[0] * to[0] + from[1] * to[1]);
        if sweep * radius[0] < FULL_TURN_MM {
            sweep += TAU;
        }
        sweep += TAU * f64::from(turns.abs() - 1);
        let angle = from[1].atan2(from[0]);
        Self { center, axes, radius, height: [start[normal], end[normal]], angle, sweep: sense * sweep }
    }

    fn at(&self, share: f64) -> [f64; 3] {
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
            (radius * self.sweep).hypot(self.radius[1] - self.radius[0]).hypot(self.height[1] - self.height[0])
        };
        (speed(0.0) + 4.0 * speed(0.5) + speed(1.0)) / 6.0
    }

    /// How far our path is from it: the largest distance of its points from our path, and the difference of the lengths; mm.
    fn apart(&self, motion: &Motion) -> [f64; 2] {
        let pieces = path_of(motion);
        let distance = (0..ARC_POINTS)
            .map(|number| away_from(&pieces, self.at(f64::from(number) / f64::from(ARC_POINTS - 1))))
            .fold(0.0, f64::max);
        let length: f64 = pieces.iter().map(|piece| piece.length_mm).sum();
        [distance, (length - self.length()).abs()]
    }
}

/// The first difference between the motions, if there is one. `largest` are the largest differences of arcs, their
/// lengths and points of splines so far, mm.
fn compare(ours: &[Motion], theirs: &Theirs, largest: &mut [f64; 3]) -> Option<String> {
    let mut before = [0.0; 9];
    let mut others = [0.0; 6];
    let mut moves = theirs
        .moves
        .iter()
        .filter(|value| {
            let end = point(&value[2]);
            let moves = value[0] == "arc" || apart(&end, &before) > NO_MOTION_MM;
            before = end;
            moves
        })
        .peekable();
    let mut returns = false;
    for (number, motion) in ours.iter().enumerate() {
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
            Some(format!("motion {number}, line {}: {what}; ours {motion:?}, theirs {value}", motion.line))
        };
        let Some(value) = moves.next() else {
            return place("they have no more motions", &serde_json::Value::Null);
        };
        let kind = value[0].as_str().unwrap_or("");
        match &motion.shape {
            Shape::Spline(_) => {
                // They cut the curve into chords and arcs, whose ends lie on it.
                let path = path_of(motion);
                let mut last = value;
                while apart(&point(&last[2]), &end) > SAME_POINT_MM {
                    match moves.next() {
                        Some(next) if next[0] == "feed" || next[0] == "arc" => {
                            let away = away_from(&path, std::array::from_fn(|axis| point(&last[2])[axis]));
                            largest[2] = largest[2].max(away);
                            if away.is_nan() || away > SAME_POINT_MM {
                                return place(&format!("a point {away} mm off the spline"), last);
                            }
                            last = next;
                        }
                        _ => return place("the spline ends elsewhere", last),
                    }
                }
                continue;
            }
            Shape::Arc { plane, center_mm, turns } => {
                let number = match plane {
                    Plane::Xy => 0,
                    Plane::Zx => 1,
                    Plane::Yz => 2,
                };
                let [first, second, _] = plane.axes();
                let center = [value[4][0].as_f64().unwrap_or(f64::NAN), value[4][1].as_f64().unwrap_or(f64::NAN)];
                if kind != "arc" || value[3] != number || value[5] != *turns {
                    return place("another shape", value);
                }
                if far(&center, &[center_mm[first], center_mm[second]], SAME_CENTRE_MM) {
                    return place("another centre", value);
                }
                let spiral = Spiral::new(motion.start_mm, end_of(motion), center, *plane, *turns);
                let [distance, length] = spiral.apart(motion);
                largest[0] = largest[0].max(distance);
                largest[1] = largest[1].max(length);
                // Not a number is far.
                if !(distance <= SAME_ARC_MM && length <= SAME_ARC_MM) {
                    return place(&format!("another arc, {distance} mm apart, {length} mm longer or shorter"), value);
                }
            }
            Shape::Line => {
                let is_rapid = motion.kind == MotionKind::Rapid;
                if kind == "arc" || is_rapid != (kind == "rapid") {
                    return place("another kind", value);
                }
            }
        }
        if far(&end, &point(&value[2]), SAME_POINT_MM) {
            return place("another end", value);
        }
        returns = kind == "tap";
    }
    moves.next().map(|value| format!("they move on: {value}"))
}

#[test]
fn linuxcnc_reads_the_same() {
    if Command::new("rs274").arg("-h").output().is_err() {
        eprintln!(
            "SKIPPED: LinuxCNC is not installed; on Debian: apt-get install --no-install-recommends linuxcnc-uspace"
        );
        return;
    }
    let paths = programs();
    assert!(!paths.is_empty(), "no programs to compare");
    let tools = tempfile::NamedTempFile::new().unwrap();
    std::fs::write(tools.path(), tool_table()).unwrap();
    let theirs = theirs(&paths);
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    let mut failures = Vec::new();
    let mut largest = [0.0; 3];
    for (path, theirs) in paths.iter().zip(&theirs) {
        let shown = path.display();
        let known = DIFFERENCES.iter().find(|row| shown.to_string().contains(row.0));
        let refused = verdict(path, tools.path());
        let (motions, fault) = ours(path);
        let failure = match (&refused, &fault) {
            (Some(_), Some(_)) => {
                *counts.entry("both refuse").or_default() += 1;
                None
            }
            (None, Some(fault)) => Some(format!("only we refuse: {fault}")),
            (Some(refused), None) => Some(format!("only they refuse: {refused}")),
            (None, None) if !theirs.complete || theirs.refused.is_some() => {
                *counts.entry("both accept, motions unknown").or_default() += 1;
                if std::env::var("FEEDWRIGHT_ORACLE_VERBOSE").is_ok() {
                    eprintln!("unknown: {shown}: {:?}", theirs.refused);
                }
                None
            }
            (None, None) => {
                *counts.entry("both accept, motions compared").or_default() += 1;
                compare(&motions, theirs, &mut largest)
            }
        };
        match (failure, known) {
            (Some(failure), None) => failures.push(format!("{shown}: {failure}")),
            (None, Some(_)) => failures.push(format!("{shown}: listed as a difference, but there is none")),
            (Some(_), Some(_)) => *counts.entry("known differences").or_default() += 1,
            (None, None) => {}
        }
    }
    eprintln!("{counts:?}; largest differences of arcs, their lengths and points of splines {largest:?} mm");
    assert!(failures.is_empty(), "{} differences:\n{}", failures.len(), failures.join("\n"));
}
