//! `feedwright correct`, and `run --out FILE.ngc`: what they write, report and refuse.

use crate::command::Folder;
use serde_json::Value;

#[test]
fn what_is_reported_describes_the_file_and_decides_the_tolerance() {
    let folder = Folder::new();
    let arguments = [
        "correct",
        "circle.ngc",
        "--machine",
        "tnv40",
        "--out",
        "p.ngc",
        "--json",
        "p.json",
        "--tolerance",
        "2",
    ];
    let ran = folder.run(&arguments).succeeded();
    assert!(
        ran.stdout.contains("as exported") && ran.stdout.contains("within tolerance"),
        "{}",
        ran.stdout
    );
    let results: Value = serde_json::from_slice(&folder.read("p.json")).unwrap();
    let number = |side: &str, key: &str| results[side][key].as_f64().unwrap();
    assert!(
        number("as_exported", "rms_um") < 0.1 * number("uncorrected", "rms_um"),
        "{results}"
    );
    assert!(
        number("as_exported", "max_um") <= 2.0 && number("as_exported", "uncut_um") < 3.0,
        "{results}"
    );
    assert_eq!(results["written"], true);
    assert!(
        folder
            .text("p.ngc")
            .starts_with("(corrected by feedwright for the machine tnv40, control generic)\n")
    );
    let tight = [
        "correct",
        "circle.ngc",
        "--machine",
        "tnv40",
        "--out",
        "t.ngc",
        "--json",
        "t.json",
        "--tolerance",
        "0.01",
    ];
    let ran = folder.run(&tight);
    assert_eq!(ran.code, Some(1));
    assert!(
        ran.stdout.contains("out of tolerance") && ran.stdout.contains("t.ngc is not written"),
        "{}",
        ran.stdout
    );
    let results: Value = serde_json::from_slice(&folder.read("t.json")).unwrap();
    assert!(
        !folder.path().join("t.ngc").exists() && results["written"] == false,
        "{results}"
    );
}

#[test]
fn a_program_that_is_no_better_is_not_written() {
    let folder = Folder::new();
    folder.file("line.ngc", "G21 G90 G64\nG1 X40 F300\nM2\n");
    let ran = folder.run(&[
        "correct",
        "line.ngc",
        "--machine",
        "tnv40",
        "--out",
        "p.ngc",
        "--json",
        "p.json",
    ]);
    assert_eq!(ran.code, Some(1));
    assert!(
        ran.stdout.contains("no corrected program:"),
        "{}",
        ran.stdout
    );
    assert!(
        ran.stdout
            .contains("unchanged, lines 2: the error is below 1 um already"),
        "{}",
        ran.stdout
    );
    assert!(!folder.path().join("p.ngc").exists());
    let results: Value = serde_json::from_slice(&folder.read("p.json")).unwrap();
    assert!(
        results["written"] == false && results["refusal"].is_string(),
        "{results}"
    );
}

#[test]
fn run_writes_the_program_that_correct_writes_and_its_cut_is_the_last() {
    let folder = Folder::new();
    folder
        .run(&[
            "correct",
            "circle.ngc",
            "--machine",
            "tnv40",
            "--out",
            "p.ngc",
        ])
        .succeeded();
    let run = [
        "circle.ngc",
        "--machine",
        "tnv40",
        "--out",
        "r.ngc",
        "--json",
        "r.json",
        "--tolerance",
        "2",
    ];
    let ran = folder.run(&[&["run"], &run[..]].concat()).succeeded();
    assert!(
        ran.stdout.contains("\nas exported ") && ran.reported().contains("within tolerance"),
        "{}",
        ran.stdout
    );
    assert_eq!(folder.text("r.ngc"), folder.text("p.ngc"));
    let results: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    let (last, exported) = (&results["runs"][2], &results["exported"]);
    assert_eq!(last["controller"], "as exported");
    for key in ["rms_um", "max_um", "uncut_um", "time_s"] {
        assert_eq!(last[key], exported["as_exported"][key], "{key}");
    }
    // The largest of all cuts stands in the rows that the page shows.
    assert_eq!(
        last["worst"][0]["error_um"].as_f64().map(f64::abs),
        last["max_um"].as_f64(),
        "{last}"
    );
    assert!(
        exported["uncorrected"]["rms_um"].as_f64() > Some(10.0) && exported["control"] == "generic",
        "{exported}"
    );
    let text = folder.text("r.ngc");
    let line = last["worst"][0]["line"].as_u64().unwrap() as usize;
    assert_eq!(
        last["worst"][0]["text"].as_str(),
        text.lines().nth(line - 1),
        "{last}"
    );
}

#[test]
fn run_writes_no_program_that_is_no_better_and_the_exit_code_says_so() {
    let folder = Folder::new();
    folder.file("line.ngc", "G21 G90 G64\nG1 X40 F300\nM2\n");
    let ran = folder.run(&[
        "run",
        "line.ngc",
        "--machine",
        "tnv40",
        "--out",
        "p.ngc",
        "--tolerance",
        "100",
    ]);
    assert_eq!(ran.code, Some(1));
    assert!(
        ran.stdout.contains("no corrected program:") && !ran.stdout.contains("wrote p.ngc"),
        "{}",
        ran.stdout
    );
    assert!(
        !folder.path().join("p.ngc").exists() && folder.path().join("line.report.html").exists()
    );
    for (arguments, reported) in [
        (
            &["--out", "p.ngc", "--fastest", "--tolerance", "10"][..],
            &["no corrected program", "--fastest", "setpoints"][..],
        ),
        (
            &["--out", "p.ngc", "--reference", "circle.ngc"],
            &["no corrected program", "--reference", "original"],
        ),
        (
            &["--out", "p.ngc", "--for", "grpl"],
            &["--for", "did you mean 'grbl'?"],
        ),
        (
            &["--out", "p.csv", "--for", "grbl"],
            &["--for", "p.csv", "setpoints"],
        ),
        (
            &["--out", "p.ngc", "--controller", "feedforward"],
            &[
                "--controller feedforward",
                "feedwright correct line.ngc --out p.ngc",
            ],
        ),
    ] {
        folder
            .run(&[&["run", "line.ngc", "--machine", "tnv40"], arguments].concat())
            .refused(reported);
    }
}

#[test]
fn what_is_asked_for_wrongly_is_refused_with_a_hint() {
    let folder = Folder::new();
    folder
        .run(&["correct", "circle.ngc", "--for", "fanuk"])
        .refused(&["--for", "fanuk", "did you mean 'fanuc'?"]);
    folder
        .run(&["correct", "circle.ngc", "--tolerance", "-1"])
        .refused(&["--tolerance is -1 um", "above 0"]);
    folder
        .run(&["correct", "circle.ngc", "--file-error", "-1"])
        .refused(&["--file-error is -1 %", "between 0 and 50 %"]);
    folder
        .run(&["correct", "circle.ngc", "--out", "circle.ngc"])
        .refused(&["circle.ngc"]);
    folder.run(&["correct", "none.ngc"]).refused(&["none.ngc"]);
}

#[test]
fn a_program_is_measured_to_another_and_half_a_program_does_not_win() {
    let folder = Folder::new();
    folder.file("square.ngc", "G21 G90 G61 F1200\nG1 X10\nY10\nX0\nY0\nM2\n");
    folder.file("half.ngc", "G21 G90 G61 F1200\nG1 X10\nY10\nM2\n");
    folder.file(
        "beside.ngc",
        "G21 G90 G61 F1200\nG1 X10\nY10.1\nX0\nY0\nM2\n",
    );
    let uncut_and_max = |part: &str| {
        let arguments = [
            part,
            "--machine",
            "tnv40",
            "--reference",
            "square.ngc",
            "--json",
            "r.json",
        ];
        folder.run_uncorrected(&arguments).succeeded();
        let results: Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        assert_eq!(results["reference"], "square.ngc");
        ["uncut_um", "max_um"].map(|key| results["runs"][0][key].as_f64().unwrap())
    };
    let [whole_um, _] = uncut_and_max("square.ngc");
    let [half_um, _] = uncut_and_max("half.ngc");
    let [_, beside_um] = uncut_and_max("beside.ngc");
    assert!(whole_um < 50.0 && half_um > 4000.0, "{whole_um} {half_um}");
    assert!((90.0..120.0).contains(&beside_um), "{beside_um}");
}

#[test]
fn feedrates_are_advised_and_files_are_written() {
    let folder = Folder::new();
    let files = [
        "--report", "a.html", "--figure", "a.svg", "--json", "a.json",
    ];
    let base = ["advise", "circle.ngc", "--machine", "tnv40", "--tolerance"];
    let ran = folder
        .run(&[&base[..], &["5"], &files].concat())
        .succeeded();
    for reported in [
        "uncorrected",
        "corrected",
        "lqg-identified",
        "mm/min",
        "wrote a.svg",
    ] {
        assert!(
            ran.stdout.contains(reported),
            "{reported} in\n{}",
            ran.stdout
        );
    }
    assert!(
        ran.stdout.lines().all(|line| line.chars().count() <= 80),
        "{}",
        ran.stdout
    );
    let results: Value = serde_json::from_slice(&folder.read("a.json")).unwrap();
    assert_eq!(results["tolerance_um"], 5.0);
    assert!(
        results["ways"][0]["whole"]["max_um"].as_f64() <= Some(5.0),
        "{results}"
    );
    assert!(folder.text("a.html").contains("</html>") && folder.text("a.svg").starts_with("<svg"));
    let none = folder.run(&[&base[..], &["0.001"]].concat());
    assert_eq!(none.code, Some(1), "{}", none.stdout);
    assert!(none.stdout.contains("at no feed: "), "{}", none.stdout);
    folder
        .run(&["advise", "circle.ngc", "--tolerance", "-1"])
        .refused(&["--tolerance is -1 um", "above 0"]);
    folder
        .run(&["advise", "circle.ngc"])
        .refused(&["--tolerance"]);
}
