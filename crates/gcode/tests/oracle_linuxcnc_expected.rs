//! LinuxCNC's own interpreter tests: the motions that its `.expected` files print, against ours.
//!
//! The files print four decimals in the unit under way and program coordinates, so offsets are
//! followed here. They need no LinuxCNC.
use std::path::{Path, PathBuf};

use feedwright_gcode::canon::{Canon, MotionKind, Shape};
use feedwright_gcode::{Dialect, Reader, Settings, ToolTable};

/// Half of the last printed decimal, and as much again for sums of offsets, in the unit of the
/// program.
const PRINTED: f64 = 1.2e-4;

/// Tests whose motions are different, and why.
const DIFFERENCES: &[(&str, &str)] = &[
    (
        "g71-endless-loop_2",
        "G70 with cutter compensation is not read",
    ),
    (
        "g84__g18__g99",
        "the axes of G84 outside G17 are exchanged there",
    ),
    (
        "g84__g19__g99",
        "the axes of G84 outside G17 are exchanged there",
    ),
    (
        "cam-nisley",
        "needs the radius of a tool that its tool table has",
    ),
    ("machine-coord-params", "prints messages only"),
    ("iniparam", "needs an INI file"),
    (
        "inside-corners",
        "LinuxCNC goes straight through a flat outer corner and cuts into it; here an arc keeps the distance",
    ),
];

/// The tool that the threading test prints the length of, inches, and the one of the facing test.
const TOOLS: &str = "T4 Z0.7\nT2 Z0.1";

#[derive(Debug, PartialEq)]
struct Move {
    is_rapid: bool,
    is_arc: bool,
    end_mm: [f64; 3],
}

/// State printed in an `.expected` file.
struct Printed {
    unit_mm: f64,
    plane: [usize; 3],
    system: [f64; 3],
    shift: [f64; 3],
    tool: [f64; 3],
    rotation: f64,
}

impl Printed {
    fn machine(&self, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = std::array::from_fn(|axis| point[axis] * self.unit_mm + self.shift[axis]);
        let (sin, cos) = self.rotation.to_radians().sin_cos();
        let turned = [x * cos - y * sin, x * sin + y * cos, z];
        std::array::from_fn(|axis| turned[axis] + self.system[axis] + self.tool[axis])
    }

    /// Takes one line; returns the motion that it prints.
    fn line(&mut self, line: &str) -> Option<Move> {
        let command = line.split_once("N.....")?.1.trim();
        let (name, arguments) = command.split_once('(')?;
        let numbers: Vec<f64> = arguments
            .split([',', ' ', ')'])
            .filter_map(|text| text.parse().ok())
            .collect();
        let three = |from: usize| -> [f64; 3] {
            std::array::from_fn(|axis| numbers.get(from + axis).copied().unwrap_or(0.0))
        };
        let scaled = |values: [f64; 3], unit: f64| values.map(|value| value * unit);
        match name {
            "USE_LENGTH_UNITS" => {
                self.unit_mm = if arguments.contains("INCH") {
                    25.4
                } else {
                    1.0
                }
            }
            "SELECT_PLANE" if arguments.contains("XZ") => self.plane = [2, 0, 1],
            "SELECT_PLANE" if arguments.contains("YZ") => self.plane = [1, 2, 0],
            "SELECT_PLANE" => self.plane = [0, 1, 2],
            "SET_G5X_OFFSET" => self.system = scaled(three(1), self.unit_mm),
            "SET_G92_OFFSET" => self.shift = scaled(three(0), self.unit_mm),
            "SET_XY_ROTATION" => self.rotation = numbers[0],
            "USE_TOOL_LENGTH_OFFSET" => self.tool = scaled(three(0), self.unit_mm),
            "STRAIGHT_TRAVERSE" => {
                return Some(Move {
                    is_rapid: true,
                    is_arc: false,
                    end_mm: self.machine(three(0)),
                });
            }
            "STRAIGHT_FEED" | "STRAIGHT_PROBE" | "RIGID_TAP" => {
                return Some(Move {
                    is_rapid: false,
                    is_arc: false,
                    end_mm: self.machine(three(0)),
                });
            }
            "ARC_FEED" => {
                let mut end = [0.0; 3];
                (end[self.plane[0]], end[self.plane[1]], end[self.plane[2]]) =
                    (numbers[0], numbers[1], numbers[5]);
                return Some(Move {
                    is_rapid: false,
                    is_arc: true,
                    end_mm: self.machine(end),
                });
            }
            _ => {}
        }
        None
    }
}

/// Motions of an `.expected` file, without those that do not move, and the largest unit.
fn printed(path: &Path) -> (Vec<Move>, f64) {
    let mut state = Printed {
        unit_mm: 1.0,
        plane: [0, 1, 2],
        system: [0.0; 3],
        shift: [0.0; 3],
        tool: [0.0; 3],
        rotation: 0.0,
    };
    let text = std::fs::read_to_string(path).unwrap();
    let mut unit: f64 = 1.0;
    let moves = text
        .lines()
        .filter_map(|line| {
            let found = state.line(line);
            unit = unit.max(state.unit_mm);
            found
        })
        .collect();
    (moves, unit)
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3)
        .map(|axis| (a[axis] - b[axis]).abs())
        .fold(0.0, f64::max)
}

fn without_rests(moves: Vec<Move>, tolerance: f64) -> Vec<Move> {
    let mut before = [0.0; 3];
    let mut kept = Vec::new();
    for step in moves {
        if step.is_arc || apart(step.end_mm, before) > tolerance {
            before = step.end_mm;
            kept.push(step);
        }
    }
    kept
}

/// Compares one test; `Err` says where it differs.
fn compare(program: &Path, expected: &Path) -> Result<usize, String> {
    let settings = Settings {
        dialect: Some(Dialect::LinuxCnc),
        tools: ToolTable::parse(TOOLS, 25.4).unwrap(),
        ..Settings::default()
    };
    let mut ours = Vec::new();
    let reader = Reader::open(program, settings).map_err(|error| error.to_string())?;
    let mut is_return = false;
    for step in reader {
        match step {
            Ok(Canon::Motion(motion)) => {
                // RIGID_TAP comes back by itself.
                let returns = std::mem::take(&mut is_return);
                is_return = std::fs::read_to_string(expected)
                    .unwrap()
                    .contains("RIGID_TAP")
                    && !returns
                    && motion.kind == MotionKind::Feed;
                if !returns {
                    let is_arc = matches!(motion.shape, Shape::Arc { .. });
                    ours.push(Move {
                        is_rapid: motion.kind == MotionKind::Rapid,
                        is_arc,
                        end_mm: motion.end_mm,
                    });
                }
            }
            Ok(Canon::Event(_)) => {}
            Err(_) => break, // They stop at the first fault, too.
        }
    }
    let (theirs, unit) = printed(expected);
    let tolerance = PRINTED * unit;
    let (ours, theirs) = (
        without_rests(ours, tolerance),
        without_rests(theirs, tolerance),
    );
    for (number, (a, b)) in ours.iter().zip(&theirs).enumerate() {
        if a.is_rapid != b.is_rapid
            || a.is_arc != b.is_arc
            || apart(a.end_mm, b.end_mm) > 2.0 * tolerance
        {
            return Err(format!("motion {number}: ours {a:?}, theirs {b:?}"));
        }
    }
    if ours.len() == theirs.len() {
        Ok(ours.len())
    } else {
        Err(format!(
            "{} motions here, {} there",
            ours.len(),
            theirs.len()
        ))
    }
}

#[test]
fn motions_are_those_of_the_interpreter_tests() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/corpus/gcode/linuxcnc-interp-tests");
    let Ok(entries) = std::fs::read_dir(&folder) else {
        eprintln!(
            "SKIPPED: LinuxCNC's interpreter tests are not at {}; take tests/interp of its sources",
            folder.display()
        );
        return;
    };
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let mut failures = Vec::new();
    let (mut tests, mut compared) = (0, 0);
    for expected in paths.iter().filter(|path| {
        path.extension()
            .is_some_and(|extension| extension == "expected")
    }) {
        let name = expected.file_stem().unwrap().to_string_lossy().into_owned();
        let programs: Vec<&PathBuf> = paths
            .iter()
            .filter(|path| {
                let file = path.file_name().unwrap().to_string_lossy().into_owned();
                file == format!("{name}.ngc")
                    || (file.starts_with(&format!("{name}--")) && file.ends_with(".ngc"))
            })
            .collect();
        let main = programs
            .iter()
            .find(|path| path.ends_with(format!("{name}.ngc")))
            .or(if programs.len() == 1 {
                programs.first()
            } else {
                None
            });
        let Some(program) = main else { continue };
        tests += 1;
        let known = DIFFERENCES.iter().any(|row| row.0 == name);
        match compare(program, expected) {
            Ok(_) if known => {
                failures.push(format!(
                    "{name}: listed as a difference, but nothing differs"
                ));
            }
            Ok(count) => compared += count,
            Err(_) if known => {}
            Err(failure) => failures.push(format!("{name}: {failure}")),
        }
    }
    eprintln!("{tests} tests, {compared} motions equal");
    assert!(tests > 0);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
