//! Programs of other controls, read in the dialect that is chosen for them: which are refused, and
//! that nothing but dialect is the reason.

use std::path::Path;

use feedwright_gcode::{CheckError, Program, Settings};

/// Programs that are refused, and a part of the reason.
const REFUSED: &[(&str, &str)] = &[
    // Another language: parameters and loops of BeagleG.
    ("beagleg/polygon-24-vs-arc.gcode", "a value is missing"),
    ("beagleg/spiral-cut.gcode", "a value is missing"),
    (
        "beagleg/square-moves-small-segments.gcode",
        "a value is missing",
    ),
    ("beagleg/spline-character.gcode", "exclude each other"),
    // Faults: arcs that do not close, a full circle without a centre.
    (
        "cncjs/Circle_Diamond_Square_Calibration.gcode",
        "does not close",
    ),
    (
        "cncjs/full-circle-without-xyz.gcode",
        "neither a radius R nor a centre",
    ),
    ("fanuc-easyplot/BOTTLE.NC", "does not close"),
    ("fanuc-easyplot/CONTOUR_ABS.NC", "does not close"),
    ("printrun/arc_test.gcode", "does not close"),
    // Needs what only the control has: tool radii, the plane that a lathe begins with, a probe.
    (
        "cncjs/helical-thread-milling.gcode",
        "not in the tool table",
    ),
    ("fanuc-easyplot/TEST_TURN.NC", "outside the arc's plane"),
    (
        "gcode-preview/mach3.gcode",
        "G31 (a motion until a signal, on other controls) is not read",
    ),
];

#[test]
fn programs_of_other_controls_are_read() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/corpus/gcode");
    if !corpus.is_dir() {
        eprintln!(
            "SKIPPED: no corpus of foreign programs at {}",
            corpus.display()
        );
        return;
    }
    let mut failures = Vec::new();
    for folder in [
        "beagleg",
        "camotics",
        "cncjs",
        "fanuc-easyplot",
        "gcode-preview",
        "linuxcnc-tp",
        "printrun",
        "scurve-forum",
        "ugs",
    ] {
        let mut paths: Vec<_> = std::fs::read_dir(corpus.join(folder))
            .unwrap()
            .map(|entry| entry.unwrap().path())
            .collect();
        paths.sort();
        for path in paths {
            let shown = path.display().to_string();
            let known = REFUSED.iter().find(|row| shown.ends_with(row.0));
            match (Program::in_file(&path).check(Settings::default()), known) {
                (Ok(_), None) => {}
                (Err(CheckError::Faults(faults)), Some(row))
                    if faults[0].message.contains(row.1) => {}
                (Err(CheckError::Faults(faults)), _) => {
                    failures.push(format!(
                        "{shown}:{}: {} ({} faults)",
                        faults[0].line,
                        faults[0].message,
                        faults.len()
                    ));
                }
                (Err(CheckError::Read(error)), _) => failures.push(format!("{shown}: {error}")),
                (Ok(_), Some(_)) => {
                    failures.push(format!("{shown}: listed as refused, but it is read"));
                }
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
