//! `feedwright plan`: the cycle time of a program, on machines with and without limits of their
//! axes.

use std::process::{Command, Stdio};
use std::time::Duration;

use crate::command::{Folder, Ran};
use feedwright::TARGETS;
use feedwright_plan::FEED_PLANNERS;
use serde_json::Value;

const LIMITS: &str = "max_velocity_mm_s = 200\nmax_accel_mm_s2 = 2000\nmax_jerk_mm_s3 = 50000\n";

/// A machine file with limits of all axes.
fn folder() -> Folder {
    let folder = Folder::new();
    let axes = ["x", "y", "z"]
        .map(|axis| format!("[axis.{axis}]\n{LIMITS}"))
        .concat();
    let head = "base = \"tnv40\"\nname = \"m\"\ndescription = \"d\"\nsource = \"s\"\n";
    folder.file(
        "m.toml",
        format!("{head}[limits]\npath_tolerance_um = 10\n{axes}"),
    );
    folder.file(
        "two.ngc",
        "G21 F6000\nT1 M6\nG1 X10\nX10 Y10\nG4 P0.5\nT2 M6\nG1 X0 Y0\nG0 X5\nM2\n",
    );
    folder
}

fn planned(folder: &Folder, arguments: &[&str]) -> Value {
    let all: Vec<&str> = ["plan", "two.ngc", "--json", "p.json"]
        .iter()
        .chain(arguments)
        .copied()
        .collect();
    folder.run(&all).succeeded();
    serde_json::from_slice(&folder.read("p.json")).unwrap()
}

#[test]
fn the_cycle_time_is_the_sum_of_its_parts() {
    let folder = folder();
    let found = planned(&folder, &["--machine", "m.toml", "--bound"]);
    let number = |key: &str| {
        found[key]
            .as_f64()
            .unwrap_or_else(|| panic!("{key} is {}", found[key]))
    };
    assert_eq!(found["planner"], "time-optimal");
    let parts_s = number("cutting_s") + number("rapid_s") + number("waiting_s");
    assert!((parts_s - number("time_s")).abs() < 1e-9, "{found}");
    assert!(
        number("waiting_s") >= 0.5 && number("rapid_s") > 0.0,
        "{found}"
    );
    let tools: Vec<u64> = found["tools"]
        .as_array()
        .unwrap()
        .iter()
        .map(|tool| tool["tool"].as_u64().unwrap())
        .collect();
    assert!(tools.ends_with(&[1, 2]), "{tools:?}");
    let ratio = (number("cutting_s") + number("rapid_s")) / number("bound_s");
    assert!((0.999..1.03).contains(&ratio), "{ratio}");
    assert!(number("largest_violation") <= 1.0 + 1e-6, "{found}");
    assert!(number("largest_deviation_um") <= 10.1, "{found}");
    assert!(number("blocks_per_s") > 0.0);
}

#[test]
fn a_larger_tolerance_is_faster_and_works_on_every_machine() {
    let folder = folder();
    let time = |um: &str| {
        planned(&folder, &["--machine", "workshop", "--tolerance", um])["time_s"]
            .as_f64()
            .unwrap()
    };
    assert!(time("100") < time("1"));
    for machine in ["tnv40", "workshop", "stiff", "router"] {
        let found = planned(&folder, &["--machine", machine, "--tolerance", "1000"]);
        assert_eq!(
            (
                found["planner"].as_str(),
                found["path_tolerance_um"].as_f64()
            ),
            (Some("time-optimal"), Some(100.0))
        );
    }
    let too_small = [
        "plan",
        "two.ngc",
        "--machine",
        "workshop",
        "--tolerance",
        "0.02",
    ];
    assert!(
        folder
            .run(&too_small)
            .succeeded()
            .remarked()
            .contains("more than 0.02 um for its own error")
    );
    let other = [
        "plan",
        "two.ngc",
        "--machine",
        "m.toml",
        "--tolerance",
        "10",
        "--planner",
        "linuxcnc",
    ];
    folder
        .run(&other)
        .refused(&["--tolerance", "time-optimal", "G64 P"]);
    folder
        .run(&[
            "plan",
            "two.ngc",
            "--machine",
            "m.toml",
            "--tolerance",
            "-1",
        ])
        .refused(&["--tolerance", "-1"]);
    let found = planned(&folder, &["--machine", "tnv40"]);
    assert_eq!(
        (found["planner"].as_str(), found["bound_s"].as_f64()),
        (Some("trapezoid"), None)
    );
}

#[test]
fn a_cut_takes_the_planner_of_its_machine() {
    let folder = folder();
    let planned_s = planned(&folder, &["--machine", "m.toml"])["time_s"]
        .as_f64()
        .unwrap();
    folder
        .run(&[
            "run",
            "two.ngc",
            "--machine",
            "m.toml",
            "--json",
            "r.json",
            "--exact-settings",
        ])
        .succeeded();
    let results: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    let uncorrected_s = results["runs"][0]["time_s"].as_f64().unwrap();
    // The cut ends when the tool has settled behind the plan.
    assert!(
        uncorrected_s >= planned_s - 1e-3 && uncorrected_s < planned_s + 1.0,
        "{uncorrected_s} {planned_s}"
    );
}

#[test]
fn a_planner_is_taken_by_name() {
    let folder = folder();
    let planner = |name: &str| planned(&folder, &["--machine", "m.toml", "--planner", name]);
    let found = planner("linuxcnc");
    assert_eq!(found["planner"], "linuxcnc");
    assert!(
        found["cutting_s"].as_f64().unwrap() > 0.1
            && found["largest_deviation_um"].as_f64().is_some(),
        "{found}"
    );
    assert_eq!(planner("trapezoid")["planner"], "trapezoid");
    let unknown = [
        "plan",
        "two.ngc",
        "--machine",
        "m.toml",
        "--planner",
        "grbl",
    ];
    folder
        .run(&unknown)
        .refused(&["grbl", "time-optimal, linuxcnc"]);
    for machine in ["tnv40", "workshop", "stiff", "router", "emps"] {
        for planner in FEED_PLANNERS {
            let found = planned(&folder, &["--machine", machine, "--planner", planner.name]);
            assert_eq!(found["planner"], planner.name, "{machine}");
        }
    }
    let assumed = folder
        .run(&[
            "plan",
            "two.ngc",
            "--machine",
            "tnv40",
            "--planner",
            "linuxcnc",
        ])
        .succeeded();
    assert!(
        assumed
            .remarked()
            .contains("400 mm/s, 100 mm/s2 and 2500 mm/s3"),
        "{assumed:?}"
    );
}

#[test]
fn an_override_and_a_hold_change_the_time_of_the_plan() {
    let folder = folder();
    let operated = |arguments: &[&str]| {
        let all: Vec<&str> = ["--machine", "m.toml"]
            .iter()
            .chain(arguments)
            .copied()
            .collect();
        planned(&folder, &all)["override"].clone()
    };
    let half = operated(&["--override", "50"]);
    let number = |value: &Value, key: &str| {
        value[key]
            .as_f64()
            .unwrap_or_else(|| panic!("{key} is {}", value[key]))
    };
    // Most of the program are rests and rapids.
    assert!(
        number(&half, "time_s") > 1.05 * number(&half, "plan_s"),
        "{half}"
    );
    assert!(
        number(&half, "largest_violation") <= 1.001 && half["hold"].is_null(),
        "{half}"
    );
    let held = operated(&["--hold-at", "0.5"]);
    let hold = &held["hold"];
    assert!(
        (number(hold, "at_s") - 0.5).abs() < 2e-3 && number(hold, "stops_in_s") < 0.3,
        "{held}"
    );
    assert!(
        number(hold, "way_mm") >= 0.99 * number(hold, "least_mm"),
        "{held}"
    );
    for (wrong, reported) in [("-1", "-1"), ("201", "200"), ("NaN", "NaN")] {
        folder
            .run(&[
                "plan",
                "two.ngc",
                "--machine",
                "m.toml",
                "--override",
                wrong,
            ])
            .refused(&["--override", reported]);
    }
    folder
        .run(&["plan", "two.ngc", "--machine", "m.toml", "--hold-at", "-1"])
        .refused(&["--hold-at", "-1"]);
    let without = ["plan", "two.ngc", "--machine", "tnv40", "--override", "50"];
    folder
        .run(&without)
        .refused(&["trapezoid", "--planner time-optimal"]);
}

#[test]
fn the_time_of_each_line_adds_up_under_every_control() {
    let folder = folder();
    for target in TARGETS {
        let found = planned(
            &folder,
            &[
                "--machine",
                "m.toml",
                "--for",
                target.name,
                "--lines",
                "l.csv",
            ],
        );
        let lines = found["lines"].as_array().unwrap();
        let sum = |key: &str| {
            lines
                .iter()
                .map(|line| line[key].as_f64().unwrap())
                .sum::<f64>()
        };
        assert!(
            (sum("time_s") - found["time_s"].as_f64().unwrap()).abs() < 1e-9,
            "{}: {found}",
            target.name
        );
        assert!(
            (sum("waiting_s") - found["waiting_s"].as_f64().unwrap()).abs() < 1e-9,
            "{}: {found}",
            target.name
        );
        let dwell = lines.iter().find(|line| line["line"] == 5).unwrap();
        assert_eq!(dwell["waiting_s"], 0.5);
        let text = folder.text("l.csv");
        assert!(
            text.starts_with("line,time_s,waiting_s,text\n") && text.contains(",\"G1 X10\"\n"),
            "{text}"
        );
    }
    folder.file("quote.ngc", "G21 F600\nG1 X1 (a \"b\")\nM2\n");
    folder
        .run(&[
            "plan",
            "quote.ngc",
            "--machine",
            "m.toml",
            "--lines",
            "l.csv",
        ])
        .succeeded();
    assert!(
        folder.text("l.csv").contains("\"G1 X1 (a \"\"b\"\")\"\n"),
        "{}",
        folder.text("l.csv")
    );
    let both = [
        "plan",
        "two.ngc",
        "--machine",
        "m.toml",
        "--for",
        "grbl",
        "--planner",
        "linuxcnc",
    ];
    assert_eq!(folder.run(&both).code, Some(2));
}

#[test]
fn what_binds_is_named_under_every_planner() {
    let folder = folder();
    let star = concat!(env!("CARGO_MANIFEST_DIR"), "/../../parts/star.ngc");
    for machine in ["tnv40", "workshop"] {
        for planner in FEED_PLANNERS {
            let ran = folder
                .run(&[
                    "plan",
                    star,
                    "--machine",
                    machine,
                    "--planner",
                    planner.name,
                ])
                .succeeded();
            assert!(
                !ran.stdout.contains("no limit binds"),
                "{machine}, {}: {}",
                planner.name,
                ran.stdout
            );
        }
    }
    // From rest to rest over 1 mm at 100 mm/s2 nothing but the acceleration binds.
    folder.file("short.ngc", "G21 F6000\nG1 X1\nM2\n");
    folder
        .run(&[
            "plan",
            "short.ngc",
            "--machine",
            "tnv40",
            "--json",
            "p.json",
        ])
        .succeeded();
    let found: Value = serde_json::from_slice(&folder.read("p.json")).unwrap();
    assert_eq!(found["binding"][0]["limit"], "acceleration along the path");
    assert!(
        (found["binding"][0]["share"].as_f64().unwrap() - 1.0).abs() < 1e-9,
        "{found}"
    );
    assert!(
        found["slow_share"].as_f64().unwrap() > 1.0 - 1e-9,
        "{found}"
    );
}

#[test]
#[cfg(unix)]
fn an_interrupt_ends_a_long_solution_at_once_and_leaves_no_file() {
    let folder = folder();
    // One path of thousands of windows: as a whole it is one step of the search for the bound.
    let points: String = (0..4000)
        .map(|i| format!("X{} Y{}\n", i % 7 * i % 11, i % 5 * i % 13))
        .collect();
    folder.file("long.ngc", format!("G21 G64 F6000\nG1 X0 Y0\n{points}M2\n"));
    let before = folder.content();
    let mut command = folder.command();
    command.args([
        "plan",
        "long.ngc",
        "--machine",
        "workshop",
        "--bound",
        "--json",
        "p.json",
    ]);
    let child = command
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_secs(2));
    let sent = Command::new("kill")
        .arg("-INT")
        .arg(child.id().to_string())
        .status()
        .unwrap();
    let ran = Ran::from(child.wait_with_output().unwrap());
    assert!(sent.success() && ran.code == Some(130), "{ran:?}");
    assert_eq!(folder.content(), before);
}
