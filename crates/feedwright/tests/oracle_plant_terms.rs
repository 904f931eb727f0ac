//! Every term of the plant beyond a rigid axis with ideal drive and encoder: a script that shares
//! nothing with the program gets the same tool, noise included, and another one as soon as one
//! value differs; a zero is the same as no key, to the bit.
//!
//! The script: `oracle_scripts/resimulate.py`. Closed forms: `oracle_plant_lag.rs`, and with each
//! term in `crates/control/src/axis/` and `crates/sim/src/plant/`.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::cut::{cut, cut_with};
use crate::python::python;
use crate::sweep::part_or_whole;
use feedwright::{BASELINE, BEST, CONTROLLERS, Entry, GeometryChoice};
use feedwright_sim::machine_keys as keys;
use feedwright_sim::{Machine, Plant};

const HEAD: &str =
    "base = 'tnv40'\nname = 'all'\ndescription = 'everything that there is'\nsource = 'made up'\n";

/// Every key of an axis that may be left out and is zero then; with these all terms act, and a few
/// per cent more of each moves the tool by more than a nanometre.
const ALL: &[(&str, f64)] = &[
    ("speed_integral_s", 0.03),
    ("velocity_feedforward", 0.9),
    ("acceleration_feedforward", 0.4),
    ("torque_filter_hz", 400.0),
    ("speed_limit_mm_s", 40.0),
    ("speed_from_encoder", 1.0),
    ("speed_window_s", 0.00073),
    ("speed_held", 1.0),
    ("encoder_step_um", 0.02),
    ("encoder_noise_um", 0.05),
    ("interpolation_error_um", 0.2),
    ("signal_period_um", 20.0),
    ("interpolation_phase_rad", 1.3),
    ("measurement_delay_s", 0.0013),
    ("command_delay_s", 0.002),
    ("drive_delay_s", 0.0007),
    ("jitter_s", 0.0008),
    ("coulomb_asymmetry_nm", 0.02),
    ("stribeck_nm", 0.05),
    ("stribeck_mm_s", 2.0),
    ("presliding_um", 5.0),
    ("cogging_nm", 0.03),
    ("cogging_per_rev", 24.0),
    ("cogging_phase_rad", -0.8),
    ("ripple", 0.02),
    ("ripple_per_rev", 6.0),
    ("torque_noise_nm", 0.05),
    ("torque_noise_s", 0.002),
    ("disturbance_wander", 0.02),
    ("scale_um_m", 30.0),
    ("pitch_error_um", 2.0),
];

const GEOMETRY: &str =
    "[geometry]\nsquareness_xy_urad = 20\nsquareness_xz_urad = -30\nsquareness_yz_urad = 10\n";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn part(name: &str) -> PathBuf {
    root().join("parts").join(format!("{name}.ngc"))
}

/// A machine file whose three axes have these values.
fn text(values: &[(&str, f64)], more: &str) -> String {
    let lines: String = values
        .iter()
        .map(|(key, value)| format!("{key} = {value:?}\n"))
        .collect();
    let axes: String = ["x", "y", "z"]
        .iter()
        .map(|name| format!("[axis.{name}]\n{lines}"))
        .collect();
    format!("{HEAD}{axes}{more}")
}

fn machine(values: &[(&str, f64)], more: &str) -> Machine {
    Machine::parse("all.toml", &text(values, more)).unwrap()
}

/// All values but those of these keys.
fn without(keys: &[&str]) -> Vec<(&'static str, f64)> {
    ALL.iter()
        .filter(|(key, _)| !keys.contains(key))
        .copied()
        .collect()
}

fn entry(name: &str) -> &'static Entry {
    CONTROLLERS.find(name).unwrap()
}

fn resimulated(python: &str, machine: &Path, trace: &Path) -> Output {
    let script = root().join("crates/feedwright/tests/oracle_scripts/resimulate.py");
    Command::new(python)
        .arg(script)
        .args([machine, trace])
        .output()
        .unwrap()
}

/// Cuts a part on a machine of this text and has the script agree.
fn agrees(python: &str, part: &Path, text: &str, entry: &'static Entry) {
    let folder = tempfile::tempdir().unwrap();
    let (machine, trace) = (
        folder.path().join("all.toml"),
        folder.path().join("trace.csv"),
    );
    std::fs::write(&machine, text).unwrap();
    let axes = cut(part, &machine, entry, &trace).axes;
    let output = resimulated(python, &machine, &trace);
    let (said, failed) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(
        output.status.success(),
        "{}, {}: {said}{failed}\n{text}",
        part.display(),
        entry.name
    );
    assert_eq!(
        said.lines()
            .filter(|line| line.contains(" nm over "))
            .count(),
        axes,
        "{said}"
    );
}

/// Needs 11 s of processor time: a script simulates each machine again.
#[test]
fn the_script_gets_the_same_tool_with_everything_that_there_is() {
    let Some(python) = python() else { return };
    let screw: String = ["x", "y", "z"]
        .iter()
        .map(|name| {
            format!(
                "[axis.{name}.transmission]\ntable_share = 0.4\nresonance_hz = 90\ndamping_ratio = 0.05\nbacklash_um = 0\nscale_on_table = 1\n"
            )
        })
        .collect();
    let noise = "[noise]\nseed = 20260131\n";
    let (whole, table) = (
        text(ALL, &format!("{GEOMETRY}{noise}")),
        text(ALL, &format!("{screw}{GEOMETRY}{noise}")),
    );
    agrees(python, &part("circle"), &whole, entry(BEST));
    agrees(python, &part("star"), &whole, entry(BASELINE));
    // The same with a scale on the table; and with none of what takes the place of something else.
    agrees(python, &part("circle"), &table, entry(BASELINE));
    let instead = [
        "presliding_um",
        "speed_from_encoder",
        "speed_held",
        "measurement_delay_s",
        "jitter_s",
    ];
    let plain = without(&[&instead[..], &["torque_noise_s"]].concat());
    agrees(
        python,
        &part("square"),
        &text(&plain, "[noise]\nseed = 1\n"),
        entry(BASELINE),
    );
}

#[test]
fn so_it_does_in_space_and_over_long_rests() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let part = folder.path().join("rests.ngc");
    let program = "G21 G90 F1200\nG1 X3 Y1 Z-1\nG4 P2.3457\nG1 X1 Y4 Z-2\nM6 T1\nM8\nG4 P1.5\nG1 X0 Y0 Z0\nM2\n";
    std::fs::write(&part, program).unwrap();
    for &delay_s in part_or_whole(&[0.001, 0.02][..], &[0.001, 0.003, 0.02]) {
        let values: Vec<_> = without(&["measurement_delay_s"])
            .into_iter()
            .chain([("measurement_delay_s", delay_s)])
            .collect();
        agrees(python, &part, &text(&values, GEOMETRY), entry(BASELINE));
    }
}

/// Each key at one and a half times its value; the script is to get another tool then.
#[test]
fn a_machine_that_is_another_in_one_value_is_found_out() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let [machine, trace, other] =
        ["all.toml", "trace.csv", "other.toml"].map(|name| folder.path().join(name));
    // The speed limit is below the feed of the circle, and would hide what the feedforward does.
    let values = without(&["speed_limit_mm_s"]);
    let is_found = |text: &str, what: &str| {
        std::fs::write(&other, text).unwrap();
        let output = resimulated(python, &other, &trace);
        assert_eq!(
            output.status.code(),
            Some(1),
            "{what}: {}",
            String::from_utf8_lossy(&output.stdout)
        );
    };
    let short = folder.path().join("arc.ngc");
    std::fs::write(&short, "G21 G90 F1800\nG2 X4 Y4 I4 J0\nM2\n").unwrap();
    std::fs::write(&machine, text(&values, GEOMETRY)).unwrap();
    cut(&short, &machine, entry(BASELINE), &trace);
    assert!(resimulated(python, &machine, &trace).status.success());
    // The suite looks at every second key, the sweep at all.
    for (i, (key, value)) in values.iter().enumerate().step_by(part_or_whole(2, 1)) {
        let with = |value: f64| {
            let mut values = values.clone();
            values[i].1 = value;
            text(&values, GEOMETRY)
        };
        let is_flag = ["speed_from_encoder", "speed_held"].contains(key);
        is_found(&with(if is_flag { 0.0 } else { 1.5 * value }), key);
    }
    is_found(
        &text(&values, &GEOMETRY.replace("xy_urad = 20", "xy_urad = 21")),
        "squareness",
    );
    is_found(
        &text(&values, &format!("{GEOMETRY}[noise]\nseed = 1\n")),
        "seed",
    );
    let slow: Vec<_> = values
        .iter()
        .copied()
        .chain([("speed_limit_mm_s", 10.0)])
        .collect();
    std::fs::write(&machine, text(&slow, GEOMETRY)).unwrap();
    cut(&short, &machine, entry(BASELINE), &trace);
    is_found(&text(&values, GEOMETRY), "speed_limit_mm_s = 0");
}

/// Returns the output of two axes in one second at 50 mm/s round a circle, with reversals and a
/// rest.
fn bits(machine: &Machine, seed: Option<u64>) -> Vec<u64> {
    let start = [0.0; 2];
    let mut plant = match seed {
        Some(seed) => Plant::<2>::with_seed(machine, start, seed),
        None => Plant::<2>::new(machine, start),
    };
    let mut bits = Vec::new();
    for n in 0..1000_u32 {
        let phase = f64::from(n.min(900)) * 1e-3 * 10.0;
        let row = plant.step([5.0 * phase.sin(), 5.0 - 5.0 * phase.cos()]);
        bits.extend(
            [row.position_mm, row.measured_mm, row.torque_nm]
                .concat()
                .iter()
                .map(|value| value.to_bits()),
        );
    }
    bits
}

#[test]
fn a_zero_is_the_same_as_no_key_to_the_bit_and_anything_else_is_not() {
    let [plain, soft, coarse] =
        ["tnv40", "soft", "coarse"].map(|name| Machine::load(name.as_ref()).unwrap());
    let optional: Vec<&str> = keys::AXIS
        .iter()
        .filter(|key| key.optional && key.range[0] <= 0.0 && key.range[1] >= 0.0)
        .map(|key| key.name)
        .collect();
    let listed: Vec<&str> = ALL.iter().map(|(key, _)| *key).collect();
    assert!(
        optional.iter().all(|key| listed.contains(key)),
        "{optional:?} are to be in the list: {listed:?}"
    );
    for base in [&plain, &soft, &coarse] {
        let with_zero = |key: &str| {
            let text = ["x", "y", "z"].iter().fold(base.text(), |text, name| {
                text.replace(
                    &format!("[axis.{name}]\n"),
                    &format!("[axis.{name}]\n{key} = 0\n"),
                )
            });
            Machine::parse(
                "zero.toml",
                &format!("{text}[geometry]\nsquareness_xy_urad = 0\n"),
            )
            .unwrap()
        };
        let (wanted, whole) = (bits(base, None), bits(&machine(ALL, ""), None));
        for (key, value) in ALL {
            if !base.text().contains(key) {
                assert!(
                    bits(&with_zero(key), None) == wanted,
                    "{key} = 0 on {}",
                    base.name
                );
            }
            assert!(
                *value != 0.0
                    && (is_needed(key) || bits(&machine(&without(&[key]), ""), None) != whole),
                "{key}"
            );
        }
    }
}

/// Returns true if a key cannot be left out while another is there.
fn is_needed(key: &str) -> bool {
    [
        "signal_period_um",
        "stribeck_mm_s",
        "cogging_per_rev",
        "ripple_per_rev",
    ]
    .contains(&key)
}

#[test]
fn the_same_seed_gives_the_same_bits_and_others_give_others() {
    for key in [
        "encoder_noise_um",
        "torque_noise_nm",
        "disturbance_wander",
        "jitter_s",
    ] {
        let values = [(key, if key == "jitter_s" { 1e-3 } else { 0.1 })];
        let (first, second) = (
            machine(&values, "[noise]\nseed = 1\n"),
            machine(&values, "[noise]\nseed = 2\n"),
        );
        assert!(
            bits(&first, None) == bits(&first, None)
                && bits(&first, None) == bits(&second, Some(1)),
            "{key}"
        );
        assert!(bits(&first, None) != bits(&second, None), "{key}");
        assert!(
            bits(&machine(&values, ""), None) == bits(&first, Some(0)),
            "{key}"
        );
    }
    let exact = machine(
        &without(&[
            "encoder_noise_um",
            "torque_noise_nm",
            "disturbance_wander",
            "jitter_s",
        ]),
        "",
    );
    assert!(
        bits(&exact, Some(1)) == bits(&exact, Some(2)),
        "without noise nothing is random"
    );
}

/// Errors that no encoder sees change nothing that a controller receives: without them, the joints
/// of both machines are the same.
#[test]
fn the_error_of_the_joints_is_the_error_of_the_machine_without_its_geometry() {
    let folder = tempfile::tempdir().unwrap();
    let loops = [("velocity_feedforward", 0.95), ("encoder_noise_um", 0.05)];
    let geometry = [("scale_um_m", 100.0), ("pitch_error_um", 3.0)];
    let files = [
        text(&[loops, geometry].concat(), GEOMETRY),
        text(&loops, ""),
    ]
    .map(|text| {
        let path = folder.path().join(format!("{}.toml", text.len()));
        std::fs::write(&path, text).unwrap();
        path
    });
    for name in ["circle", "square", "pocket"] {
        for controller in [BASELINE, "feedforward"] {
            let entry = CONTROLLERS.find(controller).unwrap();
            let trace = folder.path().join("t.csv");
            let [with, plain] = files
                .each_ref()
                .map(|file| cut_with(GeometryChoice::Off, &part(name), file, entry, &trace));
            let (rms_um, max_um) = (with.joint_rms_um.unwrap(), with.joint_max_um.unwrap());
            let of_geometry = [with.rms_um - plain.rms_um, with.max_um - plain.max_um];
            let of_joints = [rms_um - plain.rms_um, max_um - plain.max_um];
            // Which rows cut, and from where on a corner is passed, goes by the tool.
            let few = of_joints
                .iter()
                .zip(of_geometry)
                .all(|(joints, whole)| joints.abs() < 0.05 * whole.abs());
            assert!(few, "{name}, {controller}: {of_joints:?} {of_geometry:?}");
            assert_eq!((plain.joint_rms_um, plain.joint_max_um), (None, None));
        }
    }
}
