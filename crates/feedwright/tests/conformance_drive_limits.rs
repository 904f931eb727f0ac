//! The command is one that a drive may get: within its acceleration, and without alternating.

use serde_json::Value;

use crate::command::Folder;

const STAR: &str = include_str!("../../../parts/star.ngc");
/// Two straight lines: the way from rest to full feed, a corner, and the way back to rest.
const CORNER: &str = "G21 G90 G64\nG0 X0 Y0\nG1 X20 F3000\nY20\nM2\n";

/// Accelerations of the command of the last run from servo period to servo period, mm/s2, for each
/// of two axes.
fn accelerations(folder: &Folder, servo_s: f64) -> [Vec<f64>; 2] {
    let trace = folder.text("t.csv");
    let mut lines = trace.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let columns =
        ["cmd_x_mm", "cmd_y_mm"].map(|name| head.iter().position(|key| *key == name).unwrap());
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    columns.map(|column| {
        let at_mm: Vec<f64> = rows
            .iter()
            .map(|row| row[column].parse().unwrap())
            .collect();
        at_mm
            .windows(3)
            .map(|c| (c[2] - 2.0 * c[1] + c[0]) / (servo_s * servo_s))
            .collect()
    })
}

/// Counts the servo periods whose acceleration has the opposite sign of the acceleration one period
/// earlier, both above half the limit.
fn alternating(accelerations: &[f64], limit: f64) -> usize {
    accelerations
        .windows(2)
        .filter(|a| a[0] * a[1] < 0.0 && a[0].abs().min(a[1].abs()) > 0.5 * limit)
        .count()
}

#[test]
fn the_command_of_the_star_stays_near_the_limits_and_does_not_alternate() {
    let folder = Folder::new();
    folder.file("star.ngc", STAR);
    for (machine, limit) in [("workshop", 2000.0), ("stiff", 5000.0)] {
        folder
            .run(&[
                "run",
                "star.ngc",
                "--machine",
                machine,
                "--trace",
                "t.csv",
                "--json",
                "r.json",
                "--band",
                "0",
            ])
            .succeeded();
        let result: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        let said = result["runs"][1]["command_share"]["acceleration"]["share"]
            .as_f64()
            .unwrap();
        let found = accelerations(&folder, servo_s(machine));
        let largest = found
            .iter()
            .flatten()
            .fold(0.0_f64, |most, a| most.max(a.abs()))
            / limit;
        assert!(
            (said / largest - 1.0).abs() < 0.01,
            "{machine}: {said} {largest}"
        );
        assert!(largest <= 1.5, "{machine}: {largest} of the limit");
        for axis in &found {
            assert!(
                alternating(axis, limit) <= 2,
                "{machine}: {}",
                alternating(axis, limit)
            );
        }
    }
}

fn servo_s(machine: &str) -> f64 {
    if machine == "stiff" { 0.0005 } else { 0.001 }
}

/// Whatever the controller asks for: the ideal command of this machine jumps at the corner.
#[test]
fn an_offset_stays_within_the_acceleration_that_the_machine_file_states() {
    let folder = Folder::new();
    folder.file("corner.ngc", CORNER);
    for mm_s2 in [100.0, 1000.0] {
        let axes = ["x", "y", "z"]
            .map(|axis| format!("[axis.{axis}]\ncorrection_accel_mm_s2 = {mm_s2}\n"));
        folder.file(
            "slow.toml",
            format!("base = \"tnv40\"\nname = \"slow\"\n{}", axes.concat()),
        );
        let [corrected, alone] =
            [&["--exact-settings"][..], &["--controller", "uncorrected"]].map(|of| {
                let cut = [
                    "run",
                    "corner.ngc",
                    "--machine",
                    "slow.toml",
                    "--trace",
                    "t.csv",
                ];
                folder.run(&[&cut[..], of].concat()).succeeded();
                accelerations(&folder, 0.001)
            });
        let axes = corrected.iter().zip(&alone);
        let both = axes.flat_map(|(corrected, alone)| corrected.iter().zip(alone));
        let largest = both
            .map(|(with, without)| (with - without).abs())
            .fold(0.0, f64::max);
        assert!(
            (0.9..=1.001).contains(&(largest / mm_s2)),
            "{largest} of {mm_s2} mm/s2"
        );
    }
}

#[test]
fn a_command_beyond_twice_the_limit_is_not_for_use() {
    let folder = Folder::new();
    folder.file("corner.ngc", CORNER);
    let ran = folder.run(&[
        "run",
        "corner.ngc",
        "--machine",
        "tnv40",
        "--controller",
        "feedforward",
        "--out",
        "o.csv",
    ]);
    let said = ran.reported();
    assert!(
        said.starts_with("Do not use this command: it asks Y for "),
        "{said}"
    );
    assert!(
        said.contains(" times the acceleration limit of the machine file. Simulated,"),
        "{said}"
    );
    assert!(
        said.contains("o.csv was not written: no drive may get this command"),
        "{said}"
    );
    assert!(!folder.path().join("o.csv").exists());
}
