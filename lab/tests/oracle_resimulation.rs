//! A trace proves itself: a script that shares nothing with the program computes the act columns
//! from the machine file and the cmd columns, to 1 nm, whatever controller made the command and
//! whatever the machine has on top of a rigid axis.
//!
//! The script is `oracle_scripts/resimulate.py`, written from the equations of the plant. With a
//! finer step it also measures the error that the program's integration adds to them, against the
//! closed form of that error; both limits are derived in the script.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use crate::cut::cut;
use crate::python::python;
use crate::sweep::part_or_whole;
use feedwright::{BASELINE, BEST, Entry};
use feedwright_lab::CONTROLLERS;

/// Lines of the pocket that are cut: tool change, dwell, rapids, the first helix and the first
/// passes of a level.
const POCKET_LINES: usize = 30;

/// Refinements of the step: the same step, and a quarter of it, which leaves three quarters of the
/// error that the integration adds.
const BOTH: &[u32] = &[1, 4];

/// Machine file with features that no machine of the project has: the scale on the table, with
/// backlash inside the position loop, and with all the steps; delays that are no whole number of
/// servo periods; a screw without damping.
const ODD: &str = "
base = 'tnv40'
name = 'odd'
description = 'scale on the table, screw, delay and steps'
source = 'made up'
[axis.x]
drive_delay_s = 0.0013
[axis.x.transmission]
table_share = 0.3
resonance_hz = 110
damping_ratio = 0.05
backlash_um = 2
scale_on_table = 1
[axis.y]
kd = 0.2
encoder_step_um = 0.5
drive_delay_s = 0.0004
torque_bits = 10
[axis.y.transmission]
table_share = 0.6
resonance_hz = 80
damping_ratio = 0
backlash_um = 0
scale_on_table = 1
";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn machine_file(name: &str) -> PathBuf {
    root()
        .join("crates/sim/machines")
        .join(format!("{name}.toml"))
}

fn part(name: &str) -> PathBuf {
    root().join("parts").join(format!("{name}.ngc"))
}

/// The controllers that stand for all where all would take long: the script knows of none, it reads
/// what they command.
fn two() -> [&'static Entry; 2] {
    [BASELINE, BEST].map(|name| CONTROLLERS.find(name).unwrap())
}

/// A finer step for those two alone. Others drive the rapids of the pocket into the torque limit,
/// where the closed form of the integration's error does not hold.
fn finer(entry: &Entry) -> &'static [u32] {
    if two().iter().any(|one| one.name == entry.name) {
        BOTH
    } else {
        &[1]
    }
}

/// Runs the script on a trace, its mechanics stepped `finer` times as often, and returns its
/// output.
fn resimulated(python: &str, machine: &Path, trace: &Path, finer: u32) -> Output {
    let script = root().join("crates/feedwright/tests/oracle_scripts/resimulate.py");
    Command::new(python)
        .arg(script)
        .args([machine, trace])
        .arg(finer.to_string())
        .output()
        .unwrap()
}

/// Cuts a part and has the script agree, its mechanics stepped `finer` times as often.
fn agrees(python: &str, part: &Path, machine: &Path, entry: &'static Entry, finer: &[u32]) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("trace.csv");
    let axes = cut(part, machine, entry, &file).axes;
    for &finer in finer {
        let output = resimulated(python, machine, &file, finer);
        let (said, failed) = (
            String::from_utf8_lossy(&output.stdout),
            String::from_utf8_lossy(&output.stderr),
        );
        let what = format!(
            "{}, {}, {}: {said}{failed}",
            part.display(),
            machine.display(),
            entry.name
        );
        assert!(output.status.success(), "{what}");
        // The script may only pass where it has looked at every axis.
        assert_eq!(
            said.lines()
                .filter(|line| line.contains(" nm over "))
                .count(),
            axes,
            "{what}"
        );
    }
}

#[test]
fn the_machine_file_and_the_command_give_the_tool_positions() {
    let Some(python) = python() else { return };
    for entry in CONTROLLERS {
        agrees(
            python,
            &part("circle"),
            &machine_file("tnv40"),
            entry,
            finer(entry),
        );
    }
}

#[test]
#[ignore = "a sweep, minutes: just sweep"]
fn so_they_do_with_every_controller() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let pocket = short_pocket(folder.path());
    for entry in CONTROLLERS {
        for part in [part("star"), part("square"), pocket.clone()] {
            agrees(python, &part, &machine_file("tnv40"), entry, finer(entry));
        }
        for machine in ["soft", "coarse"] {
            agrees(
                python,
                &part("circle"),
                &machine_file(machine),
                entry,
                steps(machine, entry),
            );
        }
    }
    let odd = odd(folder.path());
    for entry in two() {
        for machine in ["soft", "coarse"] {
            agrees(
                python,
                &part("star"),
                &machine_file(machine),
                entry,
                steps(machine, entry),
            );
        }
        agrees(python, &part("star"), &odd, entry, BOTH);
    }
    agrees(
        python,
        &pocket,
        &machine_file("coarse"),
        &feedwright::UNCORRECTED,
        BOTH,
    );
}

/// Returns the refinements for a machine and a controller. With backlash, a finer step moves the
/// times at which the flanks strike, and the closed form does not cover the response to a quick
/// command. With the same step, the results agree to the last digit.
fn steps(machine: &str, entry: &Entry) -> &'static [u32] {
    if machine == "soft" && entry.name == BEST {
        &[1]
    } else {
        finer(entry)
    }
}

/// The machine that the project does not have, in a folder.
fn odd(folder: &Path) -> PathBuf {
    let odd = folder.join("odd.toml");
    std::fs::write(&odd, ODD).unwrap();
    odd
}

/// The beginning of the pocket, in a folder.
fn short_pocket(folder: &Path) -> PathBuf {
    let pocket = std::fs::read_to_string(part("pocket")).unwrap();
    let lines: Vec<&str> = pocket.lines().take(POCKET_LINES).chain(["M2\n"]).collect();
    let short = folder.join("pocket.ngc");
    std::fs::write(&short, lines.join("\n")).unwrap();
    short
}

#[test]
fn so_they_do_with_backlash_encoder_steps_delay_and_torque_steps() {
    let Some(python) = python() else { return };
    for machine in ["soft", "coarse"] {
        for name in part_or_whole(&["square"][..], &["circle", "square"]) {
            for entry in two() {
                agrees(
                    python,
                    &part(name),
                    &machine_file(machine),
                    entry,
                    steps(machine, entry),
                );
            }
        }
    }
}

/// Checks the machine without the controllers that chatter: with backlash inside the position loop
/// the flanks then strike each other all the time, each blow amplifies the last bits of the one
/// before, and an error of 3 nm remains after a square.
#[test]
fn so_they_do_on_a_machine_that_the_project_does_not_have() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let odd = odd(folder.path());
    for name in ["circle", "square"] {
        for entry in two() {
            agrees(python, &part(name), &odd, entry, BOTH);
        }
    }
}

#[test]
fn so_they_do_in_space() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let pocket = short_pocket(folder.path());
    agrees(
        python,
        &pocket,
        &machine_file("tnv40"),
        CONTROLLERS.find(BEST).unwrap(),
        &[1],
    );
    agrees(
        python,
        &pocket,
        &machine_file("soft"),
        &feedwright::UNCORRECTED,
        BOTH,
    );
}

/// Longer than what is simulated of them, one beside the other, one no whole number of feed
/// periods.
#[test]
fn so_they_do_over_long_rests() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let part = folder.path().join("rests.ngc");
    let text = "G21 G90 F1200\nG1 X3 Y1\nG4 P2.3457\nG1 X1 Y4\nM6 T1\nM8\nG4 P1.5\nG1 X0 Y0\nM2\n";
    std::fs::write(&part, text).unwrap();
    for machine in ["tnv40", "coarse"] {
        for entry in two() {
            agrees(python, &part, &machine_file(machine), entry, &[1]);
            let file = folder.path().join("trace.csv");
            cut(&part, &machine_file(machine), entry, &file);
            let text = std::fs::read_to_string(&file).unwrap();
            let times: Vec<f64> = text
                .lines()
                .skip(1)
                .map(|row| row.split(',').next().unwrap().parse().unwrap())
                .collect();
            let gaps_s: Vec<f64> = times
                .windows(2)
                .map(|two| two[1] - two[0])
                .filter(|gap_s| *gap_s > 0.01)
                .collect();
            for (gap_s, wanted_s) in gaps_s.iter().zip([1.3457, 3.0, 0.5]) {
                assert!((gap_s - wanted_s).abs() < 0.005, "{gaps_s:?}");
            }
            assert_eq!(gaps_s.len(), 3, "{gaps_s:?}");
            assert!(times[times.len() - 1] > 2.3457 + 4.0 + 1.5);
        }
    }
}

/// The script does not accept everything.
#[test]
fn a_trace_with_a_wrong_position_is_found_out() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("trace.csv");
    cut(
        &part("circle"),
        &machine_file("tnv40"),
        &feedwright::UNCORRECTED,
        &file,
    );
    let text = std::fs::read_to_string(&file).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    let column = lines[0]
        .split(',')
        .position(|name| name == "act_x_mm")
        .unwrap();
    let mut fields: Vec<String> = lines[500].split(',').map(str::to_owned).collect();
    fields[column] = (fields[column].parse::<f64>().unwrap() + 2e-6).to_string();
    lines[500] = fields.join(",");
    std::fs::write(&file, lines.join("\n")).unwrap();
    let output = resimulated(python, &machine_file("tnv40"), &file, 1);
    assert_eq!(output.status.code(), Some(1), "2 nm off were not noticed");
}

/// Nor does it look past any value of what a machine has on top of a rigid axis.
#[test]
fn a_machine_that_is_another_in_one_value_is_found_out() {
    let Some(python) = python() else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("trace.csv");
    let others: [(&str, &[[&str; 2]]); 2] = [
        (
            "soft",
            &[
                ["table_share = 0.5", "table_share = 0.505"],
                ["resonance_hz = 60", "resonance_hz = 60.6"],
                ["damping_ratio = 0.02", "damping_ratio = 0.022"],
                ["backlash_um = 5", "backlash_um = 5.05"],
                ["backlash_um = 5", "backlash_um = 5\nscale_on_table = 1"],
            ],
        ),
        (
            "coarse",
            &[
                ["encoder_step_um = 1", "encoder_step_um = 1.01"],
                ["drive_delay_s = 0.001", "drive_delay_s = 0.0011"],
                ["torque_bits = 12", "torque_bits = 13"],
            ],
        ),
    ];
    for (name, changes) in others {
        cut(
            &part("circle"),
            &machine_file(name),
            &feedwright::UNCORRECTED,
            &file,
        );
        let text = std::fs::read_to_string(machine_file(name)).unwrap();
        for [from, to] in changes {
            let other = folder.path().join("other.toml");
            // Of the x axis alone.
            std::fs::write(&other, text.replacen(from, to, 1)).unwrap();
            let output = resimulated(python, &other, &file, 1);
            assert_eq!(
                output.status.code(),
                Some(1),
                "{to}: {}",
                String::from_utf8_lossy(&output.stdout)
            );
        }
    }
}
