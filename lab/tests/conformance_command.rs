//! The command of the laboratory: accepted and rejected arguments, and written files.

use crate::command::Folder;
use serde_json::Value;

const TNV40: &str = include_str!("../../crates/sim/machines/tnv40.toml");

/// Returns the content of `r.json`, written by `--json r.json`.
fn results(folder: &Folder) -> Value {
    serde_json::from_slice(&folder.read("r.json")).unwrap()
}

#[test]
fn arguments_that_do_not_exist() {
    let folder = Folder::new();
    let before = folder.content();
    for (arguments, says) in [
        (&[][..], &["Usage"][..]),
        (&["fly"], &["fly", "Usage"]),
        (
            &["never-worse", "circle.ngc", "--sample", "0"],
            &["--sample", "from 1 on"],
        ),
        (&["held-out", "1", "0"], &["<COUNT>", "from 1 on"]),
        (&["paper"], &["--out"]),
        (&["paper", "--out", "p", "--seeds", "0"], &["--seeds"]),
        (
            &["paper", "--out", "circle.ngc"],
            &[
                "cannot make the folder circle.ngc",
                "a file stands in its place",
            ],
        ),
        (&["paper", "--out", "p", "--machine", "tnv41"], &["tnv41"]),
        (
            &["compare", "--set", "knots=10"],
            &["whose parameter it is is missing", "CONTROLLER.knots=10"],
        ),
        (
            &["run", "circle.ngc", "--controller", "cross-couplet"],
            &["did you mean 'cross-coupled'?"],
        ),
    ] {
        folder.run(arguments).refused(says);
        assert_eq!(before, folder.content(), "{arguments:?}");
    }
}

#[test]
fn a_comparison_of_what_does_not_exist() {
    let folder = Folder::new();
    folder.file("space.ngc", "G21 G90 F600\nG1 X1 Z1\nM2\n");
    folder.file("wrong.ngc", "G21 G90\nG1 X1\nM2\n");
    folder.file("two.ngc", "G21 G90 F600\nG1 X1\nG1 Y1\nM2\n");
    folder.file(
        "beside.ngc",
        "G21 G90 F600\nT1 M6\nG41 G1 X4\nX8\nG40 X9 Y9\nM2\n",
    );
    folder.file("faster.toml", TNV40.replace("kp_1_s = 50", "kp_1_s = 60"));
    let before = folder.content();
    for (arguments, says) in [
        (
            &["--only", "circel"][..],
            &["--only", "circel", "did you mean 'circle'?"][..],
        ),
        (
            &["--only", "circle,zero-fase"],
            &["zero-fase", "did you mean 'zero-phase'?"],
        ),
        (
            &["--part", "space.ngc"],
            &["space.ngc moves Z", "XY plane", "feedwright run"],
        ),
        (&["--part", "wrong.ngc"], &["wrong.ngc:2:1", "F"]),
        (&["--part", "missing.ngc"], &["missing.ngc", "No such file"]),
        (
            &["--part", "beside.ngc"],
            &[
                "beside.ngc:3:1",
                "tool 1 is not in the tool table",
                "--tool-table",
            ],
        ),
        (
            &["--part", "circle.ngc", "--tool-table", "no.tbl"],
            &["no.tbl"],
        ),
        (
            &["--part", "circle.ngc", "--dialect", "fanuk"],
            &["fanuk", "fanuc"],
        ),
        (
            &["--part", "two.ngc", "--max-motions", "1"],
            &["two.ngc", "motions"],
        ),
        (
            &["--part", "circle.ngc", "--part", "circle.ngc"],
            &["another 'circle.ngc' in the table", "file"],
        ),
        (
            &["--machine", "faster.toml"],
            &["another 'tnv40' in the table", "another `name`"],
        ),
        (&["--machine", "tnv4"], &["tnv4", "did you mean 'tnv40'?"]),
        (&["--threads", "0"], &["--threads", "0"]),
        (&["--json", "no/such/folder/r.json"], &["no/such/folder"]),
    ] {
        folder
            .run(&[&["compare"], arguments].concat())
            .refused(says);
    }
    assert_eq!(before, folder.content());
}

#[test]
fn contours_are_exported() {
    let folder = Folder::new();
    for name in [
        "circle",
        "ellipse",
        "eight",
        "star",
        "butterfly",
        "square",
        "line-line-circle",
    ] {
        let file = format!("{name}.ngc");
        folder
            .run(&[
                "export-contour",
                name,
                "--out",
                &file,
                "--feed",
                "1200mm/min",
            ])
            .succeeded();
        assert!(folder.text(&file).contains("F1200\n"));
    }
    folder
        .run(&["export-contour", "triangle"])
        .refused(&["triangle", "line-line-circle"]);
    folder
        .run(&["export-contour", "eight", "--feed", "0mm/s"])
        .refused(&["--feed is 0 mm/s"]);
    folder
        .run(&["export-contour", "eight", "--tolerance", "1e9"])
        .refused(&["--tolerance", "um"]);
}

#[test]
fn a_correction_that_is_worse_is_reported_and_not_written() {
    let folder = Folder::new();
    folder.file(
        "square.ngc",
        "G21 G17 G90 G94 G64\nG0 X0 Y0\nG1 X3 F3000\nY3\nX0\nY0\nM2\n",
    );
    let cut = |part: &str, controller: &str| {
        let machine = ["--machine", "tnv40", "--controller", controller];
        let outputs = ["--out", "setpoints.csv", "--json", "r.json"];
        folder.run(&[&["run", part], &machine[..], &outputs[..]].concat())
    };
    let worse = cut("square.ngc", "contour-compensation");
    assert_eq!(worse.code, Some(1), "{worse:?}");
    let text = worse.reported();
    assert!(
        text.contains(
            "contour-compensation is worse than uncorrected for this part on this machine (RMS"
        ),
        "{text}"
    );
    assert!(
        text.contains("setpoints.csv was not written: the uncorrected cut is better"),
        "{text}"
    );
    assert!(
        !folder.path().join("setpoints.csv").exists()
            && folder.path().join("square.report.html").exists()
    );
    let json: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    assert_eq!(json["worse_than_uncorrected"][0]["what"], "RMS");
    // At the corners of the square it asks for more than twice the acceleration limit.
    let better = cut("circle.ngc", "cross-coupled");
    assert_eq!(better.code, Some(0), "{better:?}");
    assert!(
        better.stdout.contains("wrote setpoints.csv")
            && folder.path().join("setpoints.csv").exists()
    );
}

#[test]
fn the_comparison_has_the_documented_rows_and_its_own_part() {
    let folder = Folder::new();
    // This program runs beside its contour by a distance that only a tool table states.
    folder.file(
        "beside.ngc",
        "G21 G90 F600\nT1 M6\nG41 G1 X4\nG1 X8\nG1 Y8\nG40 G1 X9 Y9\nM2\n",
    );
    folder.file("tools.tbl", "T1 P1 D2 ;\n");
    let parts = [
        "--part",
        "circle.ngc",
        "--part",
        "beside.ngc",
        "--tool-table",
        "tools.tbl",
        "--dialect",
        "linuxcnc",
    ];
    let only = [
        "--only",
        "square,tnv40,rough,uncorrected,contour-compensation",
        "--machine",
        "rough",
    ];
    let only = [&only[..], &["--tuning", "defaults"], &parts[..]].concat();
    let outputs = ["--json", "r.json"];
    let out = folder
        .run(&[&["compare"], &only[..], &outputs[..]].concat())
        .succeeded();
    assert!(
        out.stdout.contains("square on rough") && out.stdout.contains("wrote r.json"),
        "{out:?}"
    );
    let results = results(&folder);
    let contours: Vec<&str> = results["contours"]
        .as_array()
        .unwrap()
        .iter()
        .map(|name| name.as_str().unwrap())
        .collect();
    assert_eq!(contours, ["square", "circle.ngc", "beside.ngc"]);
    let rows = results["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2 * 2, "{rows:?}");
    for row in rows {
        assert!(
            row["machine"].is_string() && row["controller"].is_string(),
            "{row}"
        );
        for key in ["time_s", "rms_um", "max_um"] {
            let numbers = row[key].as_array().unwrap();
            assert_eq!(numbers.len(), contours.len(), "{row}");
            assert!(
                numbers.iter().all(|value| value.as_f64().unwrap() > 0.0),
                "{key}: {row}"
            );
        }
    }
    let again = [
        &["compare", "--threads", "1"],
        &only[..],
        &["--json", "again.json"],
    ]
    .concat();
    folder.run(&again).succeeded();
    assert_eq!(folder.read("r.json"), folder.read("again.json"));
}

#[test]
fn the_list_names_every_controller_with_its_parameters() {
    let folder = Folder::new();
    crate::controller_list::lists(&folder, feedwright_lab::CONTROLLERS);
}
