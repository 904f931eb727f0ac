//! `run --log`: an axis that stands still, in the program and in the log, needs no `--columns`.

use std::fmt::Write as _;

use crate::command::Folder;

/// A program along Y alone, 2 s long.
const ALONG_Y: &str = "G21 G90 G64\nG0 X0 Y0\nG1 Y20 F600\nM2\n";

/// Command and actual position of both axes, from the trace of an uncorrected cut: x stands still,
/// and swings by its disturbance.
fn rows(folder: &Folder) -> Vec<[String; 5]> {
    folder
        .run_uncorrected(&["y.ngc", "--machine", "tnv40", "--trace", "t.csv"])
        .succeeded();
    let text = folder.text("t.csv");
    let mut lines = text.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let at = |name: &str| head.iter().position(|column| *column == name).unwrap();
    let columns = ["t_s", "cmd_x_mm", "act_x_mm", "cmd_y_mm", "act_y_mm"].map(at);
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            columns.map(|column| cells[column].to_owned())
        })
        .collect()
}

fn log(head: &str, rows: &[[String; 5]]) -> String {
    rows.iter().fold(head.to_owned(), |mut text, row| {
        writeln!(text, "{}", row.join(",")).unwrap();
        text
    })
}

#[test]
fn an_axis_that_stands_still_needs_no_columns() {
    let folder = Folder::new();
    folder.file("y.ngc", ALONG_Y);
    let rows = rows(&folder);
    folder.file("named.csv", log("t_s,x.cmd,x.act,y.cmd,y.act\n", &rows));
    folder.file("bare.csv", log("", &rows));
    let measured = |name: &str| {
        let ran = folder
            .run_uncorrected(&[
                "y.ngc",
                "--machine",
                "tnv40",
                "--log",
                name,
                "--json",
                "r.json",
            ])
            .succeeded();
        let json: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        let run = json["runs"]
            .as_array()
            .unwrap()
            .iter()
            .find(|run| run["controller"] == "measured")
            .unwrap()
            .clone();
        (run["max_um"].as_f64().unwrap(), ran)
    };
    let (named_um, ran) = measured("named.csv");
    assert!(ran.stderr.contains("axis x stands still"), "{}", ran.stderr);
    assert!(
        ran.stdout.contains("measured, not simulated"),
        "{}",
        ran.stdout
    );
    assert!(named_um > 0.1, "what x swings by is in it: {named_um}");
    let (bare_um, ran) = measured("bare.csv");
    let reported = ran.stderr.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(
        reported.contains("x of the log is taken for y of the program"),
        "{reported}"
    );
    assert!(
        reported.contains("axis x stands still in the program, and the log has no record of it"),
        "{reported}"
    );
    assert!(bare_um < named_um, "{bare_um} {named_um}");
}
