//! Contour error and uncut path against a script that shares nothing with the program: it reads the
//! program, the machine file and the trace, and searches by the definitions.
//!
//! The script: `oracle_scripts/contour_metric.py`.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::cut::cut;
use crate::python::python;
use crate::sweep::part_or_whole;
use feedwright::{BASELINE, BEST, CONTROLLERS};

/// Chords in place of arcs, and steps of the reference in place of its time 50 ms ahead, um.
const SAME_UM: f64 = 0.02;

/// Legs of 0.5 mm, shorter than what the tool lags.
const BATTLEMENT: &str = "G21 G90 F3000\nG1 X2\nG1 Y0.5\nG1 X2.5\nG1 Y0\nG1 X3\nG1 Y0.5\nG1 X3.5\nG1 Y0\nG1 X4\nG1 Y0.5\nG1 X4.5\n\
                          G1 Y0\nG1 X5\nG0 X8\nG1 Y0.2\nG1 X9\nM2\n";

/// Spikes of 6 and 11 degrees, a line there and back, a dwell between, and two turns of a small
/// circle.
const SPIKES: &str = "G21 G90 F3000\nG1 X10 Y0.5\nG1 X0 Y1.5\nG1 X10 Y3.5\nG1 X0\nG1 X10\nG4 P0.2\nG1 X11 Y3\n\
                      G3 X11 Y3 I-0.4 J0\nG3 X11 Y3 I-0.4 J0\nG2 X13 Y3 R1\nG1 X15\nM2\n";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// Needs 15 s of processor time: a script searches the whole path for each point of ten cuts.
#[test]
fn the_script_finds_the_same_contour_error_and_uncut_path() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let made = |name: &str, text: &str| {
        let file = folder.path().join(name);
        std::fs::write(&file, text).unwrap();
        file
    };
    let part = |name: &str| root().join("parts").join(name);
    let parts = [
        part("circle.ngc"),
        part("star.ngc"),
        part("square.ngc"),
        made("battlement.ngc", BATTLEMENT),
        made("spikes.ngc", SPIKES),
    ];
    let trace = folder.path().join("trace.csv");
    for (m, machine) in ["tnv40", "soft"].into_iter().enumerate() {
        let machine = root()
            .join("crates/sim/machines")
            .join(format!("{machine}.toml"));
        // The suite cuts each part on one machine, the sweep on both.
        for part in parts
            .iter()
            .skip(part_or_whole(m, 0))
            .step_by(part_or_whole(2, 1))
        {
            for name in [BASELINE, BEST] {
                let summary = cut(part, &machine, CONTROLLERS.find(name).unwrap(), &trace);
                let script =
                    root().join("crates/feedwright/tests/oracle_scripts/contour_metric.py");
                let output = Command::new(python)
                    .arg(script)
                    .args([&machine, part, &trace])
                    .output()
                    .unwrap();
                let what = format!("{} on {} with {name}", part.display(), machine.display());
                assert!(
                    output.status.success(),
                    "{what}: {}",
                    String::from_utf8_lossy(&output.stderr)
                );
                let said: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
                let pairs = [
                    ("rms_um", summary.rms_um),
                    ("max_um", summary.max_um),
                    ("uncut_um", summary.uncut_um),
                ];
                for (key, ours) in pairs {
                    let theirs = said[key].as_f64().unwrap();
                    println!("{what}: {key} {ours:.4}, the script {theirs:.4}");
                    assert!(
                        (ours - theirs).abs() <= SAME_UM + 1e-3 * theirs,
                        "{what}: {key} {ours}, the script {theirs}"
                    );
                }
            }
        }
    }
}
