//! What LinuxCNC's `halsampler` writes is read without options: names of pins, the counter of
//! `halsampler -t`, lost samples, and inches.

use std::fmt::Write as _;

use crate::command::{Folder, Ran};
use crate::conformance_identify_log::rows as rows_of_one_axis;

const INCH_MM: f64 = 25.4;

/// Returns the lines before the rows: `# sample_time_s`, the unit, and the pins.
fn head(unit: &str, columns: &str) -> String {
    format!("# sample_time_s = 0.001\n{unit}# {columns}\n")
}

/// A circle of 3 s.
const PART: &str = "G21 G17 G90 G94 G64\nG0 X0 Y0\nG2 X0 Y0 I10 J0 F1200\nM2\n";

/// The circle, as a sampler in a LinuxCNC of that unit records it, with lost samples behind row
/// `lost`.
fn cut(folder: &Folder, columns: &str, unit: &str, unit_mm: f64, lost: Option<usize>) -> String {
    folder.file("part.ngc", PART);
    folder
        .run_uncorrected(&["part.ngc", "--machine", "tnv40", "--trace", "t.csv"])
        .succeeded();
    let text = folder.text("t.csv");
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let at = ["cmd_x_mm", "act_x_mm", "cmd_y_mm", "act_y_mm"]
        .map(|name| names.iter().position(|n| *n == name).unwrap());
    let mut log = head(unit, columns);
    for (row, line) in text.lines().skip(1).enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        if lost == Some(row) {
            log.push_str("overrun\n");
        }
        let values =
            at.map(|column| format!("{:.9}", cells[column].parse::<f64>().unwrap() / unit_mm));
        writeln!(log, "{} {}", 40 + row, values.join(" ")).unwrap();
    }
    log
}

const PINS: &str =
    "joint.0.motor-pos-cmd feedwright.actual-0 joint.1.motor-pos-cmd feedwright.actual-1";
const NAMED: &str = "n x.cmd x.act y.cmd y.act";
const RUN: [&str; 7] = [
    "part.ngc",
    "--machine",
    "tnv40",
    "--log",
    "log.txt",
    "--json",
    "r.json",
];

/// Returns the text on stderr without the line that is drawn beside a long message.
fn unframed(ran: &Ran) -> String {
    ran.remarked().replace("\u{2502} ", "")
}

fn measured_um(folder: &Folder) -> f64 {
    folder.run_uncorrected(&RUN).succeeded();
    let json: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    let runs = json["runs"].as_array().unwrap();
    runs.iter()
        .find(|run| run["controller"] == "measured")
        .unwrap()["rms_um"]
        .as_f64()
        .unwrap()
}

#[test]
fn a_cut_is_the_same_in_every_unit_and_by_every_name() {
    let folder = Folder::new();
    folder.file("log.txt", cut(&folder, NAMED, "", 1.0, None));
    let wanted_um = measured_um(&folder);
    assert!(wanted_um > 1.0, "{wanted_um}");
    for (columns, unit, unit_mm) in [
        (PINS, "", 1.0),
        (PINS, "# unit = inch\n", INCH_MM),
        (NAMED, "# unit = mm\n", 1.0),
        (NAMED, "# unit = inch\n", INCH_MM),
    ] {
        folder.file("log.txt", cut(&folder, columns, unit, unit_mm, None));
        let found_um = measured_um(&folder);
        // Nine digits of an inch are 25 fm.
        assert!(
            (found_um - wanted_um).abs() < 1e-3,
            "{columns} {unit}: {found_um}, {wanted_um}"
        );
    }
}

#[test]
fn a_log_in_another_unit_than_it_is_read_in_is_refused() {
    let folder = Folder::new();
    folder.file("log.txt", cut(&folder, NAMED, "", INCH_MM, None));
    let ran = folder.run_uncorrected(&RUN);
    assert_eq!(ran.code, Some(2));
    let reported = unframed(&ran);
    assert!(
        reported.contains("The log is in inch") && reported.contains("--columns unit=inch"),
        "{reported}"
    );
    folder.file("log.txt", cut(&folder, NAMED, "# unit = inch\n", 1.0, None));
    let reported = unframed(&folder.run_uncorrected(&RUN));
    assert!(
        reported.contains("The log is in mm, and was read in inch"),
        "{reported}"
    );
    let ran = folder.run_uncorrected(&[&RUN[..], &["--columns", "unit=mm"]].concat());
    let reported = unframed(&ran);
    assert!(
        reported.contains(
            "--columns says that positions are in mm, and the file that they are in inch"
        ),
        "{reported}"
    );
}

#[test]
fn lost_samples_are_marked() {
    let folder = Folder::new();
    folder.file("log.txt", cut(&folder, NAMED, "", 1.0, Some(400)));
    let ran = folder.run_uncorrected(&RUN);
    assert_eq!(ran.code, Some(2));
    assert!(ran.remarked().contains("the log has a gap"), "{ran:?}");
}

#[test]
fn an_axis_is_identified_from_inches_as_from_millimetres() {
    let folder = Folder::new();
    let mut found = Vec::new();
    for (unit, unit_mm) in [("# unit = mm\n", 1.0), ("# unit = inch\n", INCH_MM)] {
        let mut text = head(unit, "n x.planned x.cmd x.act");
        for (row, [_, command_mm, actual_mm]) in rows_of_one_axis(1).into_iter().enumerate() {
            let [command, actual] = [command_mm / unit_mm, actual_mm / unit_mm];
            writeln!(
                text,
                "{row} {:.9} {command:.9} {actual:.9}",
                command + 0.001
            )
            .unwrap();
        }
        folder.file("log.txt", text);
        folder
            .run(&["identify", "log.txt", "--out", "mine.toml"])
            .succeeded();
        let machine: toml::Table = folder.text("mine.toml").parse().unwrap();
        let axis = machine["axis"]["x"].as_table().unwrap().clone();
        found.push(["kp_1_s", "kv_nm_s_per_rad"].map(|key| axis[key].as_float().unwrap()));
    }
    for (mm, inch) in found[0].into_iter().zip(found[1]) {
        assert!((mm / inch - 1.0).abs() < 1e-4, "{found:?}");
    }
}
