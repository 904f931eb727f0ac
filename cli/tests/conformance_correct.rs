//! `feedwright correct`: what it writes, tells and refuses.

#[path = "common/command.rs"]
#[expect(dead_code, reason = "every test file uses a part of this")]
mod common;

use common::Folder;
use serde_json::Value;

#[test]
fn what_is_told_is_that_of_the_file_and_decides_the_tolerance() {
    let folder = Folder::new();
    let arguments =
        ["correct", "circle.ngc", "--machine", "tnv40", "--out", "p.ngc", "--json", "p.json", "--tolerance", "2"];
    let ran = folder.run(&arguments).succeeded();
    assert!(ran.stdout.contains("as exported") && ran.stdout.contains("within tolerance"), "{}", ran.stdout);
    let results: Value = serde_json::from_slice(&folder.read("p.json")).unwrap();
    let number = |side: &str, key: &str| results[side][key].as_f64().unwrap();
    assert!(number("as_exported", "rms_um") < 0.1 * number("original", "rms_um"), "{results}");
    assert!(number("as_exported", "max_um") <= 2.0 && number("as_exported", "uncut_um") < 3.0, "{results}");
    assert_eq!(results["written"], true);
    assert!(folder.text("p.ngc").starts_with("(corrected by feedwright for the machine tnv40, control generic)\n"));
    let tight = ["correct", "circle.ngc", "--machine", "tnv40", "--tolerance", "0.01"];
    let ran = folder.run(&tight);
    assert_eq!(ran.code, Some(1));
    assert!(ran.stdout.contains("out of tolerance"), "{}", ran.stdout);
}

#[test]
fn a_program_that_is_no_better_is_not_written() {
    let folder = Folder::new();
    folder.file("line.ngc", "G21 G90 G64\nG1 X40 F300\nM2\n");
    let ran = folder.run(&["correct", "line.ngc", "--machine", "tnv40", "--out", "p.ngc", "--json", "p.json"]);
    assert_eq!(ran.code, Some(1));
    assert!(ran.stdout.contains("no corrected program:"), "{}", ran.stdout);
    assert!(!folder.path().join("p.ngc").exists());
    let results: Value = serde_json::from_slice(&folder.read("p.json")).unwrap();
    assert!(results["written"] == false && results["refusal"].is_string(), "{results}");
}

#[test]
fn what_is_asked_for_wrongly_is_refused_with_a_hint() {
    let folder = Folder::new();
    folder.run(&["correct", "circle.ngc", "--for", "fanuk"]).refused(&["--for", "fanuk", "did you mean 'fanuc'?"]);
    folder.run(&["correct", "circle.ngc", "--tolerance", "-1"]).refused(&["--tolerance is -1 um", "above 0"]);
    folder.run(&["correct", "circle.ngc", "--out", "circle.ngc"]).refused(&["circle.ngc"]);
    folder.run(&["correct", "none.ngc"]).refused(&["none.ngc"]);
}
