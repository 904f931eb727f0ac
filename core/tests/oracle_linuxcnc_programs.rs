//! LinuxCNC reads the same programs: the same are refused, and what moves ends at the same points along the same arcs.
//!
//! The numbers come from LinuxCNC itself: `rs274` accepts or refuses, and `oracle_scripts/linuxcnc_canon.py` runs its interpreter in full
//! precision. Programs are those of the corpus beside the repository and those that the package installs. Differences that remain are
//! listed in `docs/gcode-differences.md` and in [`DIFFERENCES`].
#![expect(clippy::unwrap_used, reason = "a test helper may fail its test")]

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

use feedwright::gcode::canon::{Canon, Motion, MotionKind, Plane, Shape};
use feedwright::gcode::{Dialect, Reader, Settings, ToolTable};

/// Largest distance between our points and LinuxCNC's, mm: its inches and our millimetres differ by rounding only.
const SAME_POINT_MM: f64 = 1e-6;
/// Centres may differ by as much as arcs may fail to close (half of it for most): theirs is moved until both radii agree.
const SAME_CENTRE_MM: f64 = 1e-6;
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
    ("inside-corners", "arcs with unequal radii are re-centred before they are offset: 0.5 um"),
    ("g84__g18__g99", "LinuxCNC 2.9 swaps the axes of G84 outside G17"),
    ("g84__g19__g99", "LinuxCNC 2.9 swaps the axes of G84 outside G17"),
    ("g71-endless-loop2", "G70-G72 are not read"),
    ("g72-missing-iteration", "G70-G72 are not read"),
    ("lathe_g7", "G70-G72 are not read"),
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

/// What `rs274` says: `None` where it accepts.
fn verdict(path: &Path, tools: &Path) -> Option<String> {
    let output = Command::new("timeout")
        .args(["2", "rs274", "-g", "-t"])
        .arg(tools)
        .arg(path)
        .current_dir(path.parent().unwrap())
        .output()
        .unwrap();
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

/// The first difference between the motions, if there is one.
fn compare(ours: &[Motion], theirs: &Theirs) -> Option<String> {
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
                let mut last = value;
                while apart(&point(&last[2]), &end) > SAME_POINT_MM {
                    match moves.next() {
                        Some(next) if next[0] == "feed" || next[0] == "arc" => last = next,
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
                // Their centre is moved so that both radii agree; ours is as programmed, within the tolerance of the arc.
                if far(&center, &[center_mm[first], center_mm[second]], SAME_CENTRE_MM) {
                    return place("another centre", value);
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
                compare(&motions, theirs)
            }
        };
        match (failure, known) {
            (Some(failure), None) => failures.push(format!("{shown}: {failure}")),
            (None, Some(_)) => failures.push(format!("{shown}: listed as a difference, but there is none")),
            (Some(_), Some(_)) => *counts.entry("known differences").or_default() += 1,
            (None, None) => {}
        }
    }
    eprintln!("{counts:?}");
    assert!(failures.is_empty(), "{} differences:\n{}", failures.len(), failures.join("\n"));
}
