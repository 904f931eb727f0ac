//! What happens besides motions: each unit of the machine has its row and its durations in the
//! report, and rotary axes that turn alone take their time.

use crate::command::Folder;

const TNV40: &str = include_str!("../../sim/machines/tnv40.toml");

const LAMP: &str = "
[plc.event.\"M64 P3\"]
row = \"lamp\"
label = \"lamp on\"
takes_s = 0.25

[plc.event.\"M65 P3\"]
row = \"lamp\"
label = \"lamp off\"
takes_s = 0
";

/// Machining time of a program without a controller, s.
fn time_s(folder: &Folder, program: &str, machine: &str) -> f64 {
    folder.file("part.ngc", program);
    folder
        .run_uncorrected(&["part.ngc", "--machine", machine, "--json", "r.json"])
        .succeeded();
    let results: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    results["runs"][0]["time_s"].as_f64().unwrap()
}

#[test]
fn every_unit_has_its_row_with_the_durations_of_the_machine_file() {
    let folder = Folder::new();
    folder.file("lit.toml", format!("{TNV40}{LAMP}"));
    let events = "T2 M6\nS4000 M3\nM8\nM64 P3\nG4 P0.5\nM0\nM65 P3\nM9\nM5\n";
    let program = |events: &str| format!("G21 G90 F1200\nG1 X1\n{events}X0\nM2\n");
    let with = time_s(&folder, &program(events), "lit.toml");
    let page = folder.text("part.report.html");
    // 4 s tool change, 4000 rev/min at 4000 rev/min/s up and down, coolant on and off, lamp, dwell;
    // as in the machine file.
    for (row, label, took) in [
        ("tool", "M6 tool change, ", "4.00 s"),
        ("spindle", "M3 spindle clockwise, ", "2.00 s"),
        ("coolant", "M8 flood coolant, ", "1.00 s"),
        ("lamp", "lamp on, ", "0.25 s"),
        ("dwell", "dwell 0.5 s, ", "0.50 s"),
        ("stop", "M0 program stop", ""),
    ] {
        let (_, rest) = page
            .split_once(&format!("<b>{row}</b>"))
            .unwrap_or_else(|| panic!("no row {row}"));
        let strip = rest.split_once("</span></span>").unwrap().0;
        assert!(strip.contains(label), "{row}: {strip}");
        assert!(strip.ends_with(&format!(">{took}")), "{row}: {strip}");
    }
    assert!(page.contains("lamp off"));
    // Two stops of the motion are one where all of it happens.
    let without = time_s(&folder, &program("M0\n"), "lit.toml");
    assert!(
        (with - without - 7.75).abs() < 0.002,
        "{with} s, {without} s"
    );
    // The machine file of the paper's machine does not name the output. The output then takes no
    // time and appears in the row of outputs.
    let plain = time_s(&folder, &program(events), "tnv40");
    assert!((with - plain - 0.25).abs() < 0.002, "{with} s, {plain} s");
    assert!(folder.text("part.report.html").contains("M64 P3 output on"));
}

#[test]
fn an_axis_that_turns_alone_takes_its_time_and_is_reported() {
    let folder = Folder::new();
    let program = |turn: &str| format!("G21 G90 F360\nG1 X1\n{turn}\nX0\nM2\n");
    let still = time_s(&folder, &program("M0"), "tnv40");
    let turned = |turn: &str| time_s(&folder, &program(turn), "tnv40") - still;
    // 36 degrees at 360 degrees/min.
    assert!((turned("A36") - 6.0).abs() < 0.002, "{}", turned("A36"));
    // The same in inches: the unit of length does not change angles.
    assert!((turned("G20\nF360\nC-36\nG21\nF360") - 6.0).abs() < 0.002);
    // U in place of X Y Z: millimeters.
    assert!((turned("U36") - 6.0).abs() < 0.002);
    // Inverse time: a tenth of a minute, whatever the way.
    assert!((turned("G93 F10 B90\nG94 F360") - 6.0).abs() < 0.002);
    // Rapids, and feeds beyond it, turn at the rate of the machine; without one, at once.
    folder.file("slow.toml", format!("{TNV40}\nrotary_deg_s = 3\n"));
    let still_slow = time_s(&folder, &program("M0"), "slow.toml");
    for (turn, slow_s, plain_s) in [
        ("G0 A36 B-6\nG1", 12.0, 0.0),
        ("A36", 12.0, 6.0),
        ("F90 A6\nF360", 4.0, 4.0),
    ] {
        assert!(
            (time_s(&folder, &program(turn), "slow.toml") - still_slow - slow_s).abs() < 0.002,
            "{turn}"
        );
        assert!((turned(turn) - plain_s).abs() < 0.002, "{turn}");
    }
    // 400 mm/s.
    assert!((turned("G0 U400\nG1") - 1.0).abs() < 0.002);
    folder.file("part.ngc", program("A36 C10"));
    let ran = folder.run_uncorrected(&["part.ngc"]).succeeded();
    let reported = ran.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        reported
            .contains("part.ngc: line 3: A, C moves; only X, Y and Z are simulated and controlled"),
        "{reported}"
    );
    assert_eq!(
        folder.run_uncorrected(&["circle.ngc"]).succeeded().stderr,
        ""
    );
}
