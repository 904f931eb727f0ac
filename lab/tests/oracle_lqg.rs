//! The limit against an independent script, `oracle_scripts/lqg.py`: the gains of its filter and
//! its regulator, and what is left of the position in the closed loop on a machine that is linear,
//! where the theory says it exactly.

use std::path::Path;
use std::process::Command;

use crate::cut::cut;
use crate::python::python;
use feedwright_control::{AxisModel, LqgGains, LqgIdentified, LqgSettings, Part};
use feedwright_lab::CONTROLLERS;
use feedwright_sim::Machine;

/// tnv40 without the disturbance, linear once it moves, under noise: encoder and torque; what
/// stands in place of `DISTURBANCE` is beside.
const NOISY: &str = "
base = 'tnv40'
name = 'noisy'
description = 'tnv40 with noise'
source = 'made up'
[axis.z]
correction_accel_mm_s2 = 1e6
[axis.x]
correction_accel_mm_s2 = 1e6
encoder_noise_um = 0.5
torque_noise_nm = 0.1
torque_noise_s = 0.005
DISTURBANCE
[axis.y]
correction_accel_mm_s2 = 1e6
encoder_noise_um = 0.2
torque_noise_nm = 0.05
torque_noise_s = 0.002
DISTURBANCE
";

/// A ball screw that gives, and no backlash.
const SCREW: &str = "
[axis.NAME.transmission]
table_share = 0.4
resonance_hz = 70
damping_ratio = 0.03
backlash_um = 0
";

/// The program has ten states, the script those that are not always zero: x, w, n, p, q, d, and the
/// table's where the screw gives.
const THEIRS: [usize; 8] = [0, 1, 4, 5, 6, 7, 8, 9];

/// Gains agree to this part of themselves, or of what the gain of the load is: the program begins
/// with a variance of states that no noise reaches, which it has not quite forgotten at its end.
const GAINS_AGREE: f64 = 2e-3;
/// The load is a random walk so slow that its gain is found over some 10 s: the program ends its
/// iteration after 20 s, 16 % below the stationary gain, which the script has.
const LOAD_AGREES: f64 = 0.2;

/// The RMS over some 20 s of a cut: with a correlation of about 5 ms 4000 values are independent,
/// so that four standard errors are 5 %.
const RMS_AGREES: f64 = 0.05;

#[derive(serde::Deserialize)]
struct Script {
    filter: Vec<f64>,
    regulator: Vec<f64>,
    rms_um: f64,
}

fn script(python: &str, machine: &Path, axis: &str) -> Script {
    let script = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../crates/feedwright/tests/oracle_scripts/lqg.py");
    let weight = LqgSettings::DEFAULT.control_weight_s2.to_string();
    let output = Command::new(python)
        .arg(script)
        .arg(machine)
        .args([axis, &weight])
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    serde_json::from_slice(&output.stdout).unwrap()
}

fn agree(ours: &[f64; 10], theirs: &[f64], what: &str) {
    for (&state, theirs) in THEIRS.iter().zip(theirs) {
        let size = theirs.abs().max(ours[7].abs());
        let agree = if what == "filter" && state == 7 {
            LOAD_AGREES
        } else {
            GAINS_AGREE
        };
        assert!(
            (ours[state] - theirs).abs() < agree * size,
            "{what} {state}: {ours:?} {theirs}"
        );
    }
}

#[test]
fn the_gains_are_those_of_the_script() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("noisy.toml");
    let screws = ["x", "y"].map(|name| SCREW.replace("NAME", name)).concat();
    for (disturbance, screws) in [
        ("disturbance_nm = 0", ""),
        ("disturbance_wander = 0.02", ""),
        ("disturbance_nm = 0", screws.as_str()),
    ] {
        std::fs::write(&file, NOISY.replace("DISTURBANCE", disturbance) + screws).unwrap();
        let machine = Machine::read(&file).unwrap();
        let known = machine.known();
        let axes = std::array::from_fn(|i| {
            let parts = [Part::Screw, Part::Noise];
            let all = machine.axes[i].parameters();
            let axis = known.axis(i).nominal.taking(&parts, &all);
            AxisModel::new(axis, known.period.periods())
        });
        let limit = LqgIdentified::<2>::new(axes, LqgSettings::DEFAULT);
        for (gains, axis) in limit.gains().iter().zip(["x", "y"]) {
            let LqgGains {
                filter, regulator, ..
            } = gains;
            let theirs = script(python, &file, axis);
            agree(filter, &theirs.filter, "filter");
            agree(regulator, &theirs.regulator, "regulator");
        }
    }
}

#[test]
fn on_a_linear_machine_what_is_left_is_what_the_theory_says() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let [file, part, trace] =
        ["noisy.toml", "line.ngc", "line.csv"].map(|name| folder.path().join(name));
    std::fs::write(&file, NOISY.replace("DISTURBANCE", "disturbance_nm = 0")).unwrap();
    // Along the diagonal the contour error is the difference of both errors over the square root
    // of 2.
    std::fs::write(&part, "G21 G90 F600\nG1 X141 Y141\nM2\n").unwrap();
    let found_um = cut(
        &part,
        &file,
        CONTROLLERS.find("lqg-preview").unwrap(),
        &trace,
    )
    .rms_um;
    let [x_um, y_um] = ["x", "y"].map(|axis| script(python, &file, axis).rms_um);
    let wanted_um = (0.5 * (x_um * x_um + y_um * y_um)).sqrt();
    assert!(
        (found_um / wanted_um - 1.0).abs() < RMS_AGREES,
        "{found_um} {wanted_um}"
    );
}
