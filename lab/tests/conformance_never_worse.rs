//! `feedwright-lab never-worse`: exit codes, files, and what it refuses.

use crate::command::Folder;
use serde_json::Value;

const UNCORRECTED: [&str; 3] = ["never-worse", "--controller", "uncorrected"];

fn arguments<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&UNCORRECTED[..], more].concat()
}

#[test]
fn uncorrected_is_never_worse_than_uncorrected() {
    let folder = Folder::new();
    let more = [
        "circle.ngc",
        "--machine",
        "tnv40",
        "--machine",
        "coarse",
        "--json",
        "n.json",
        "--results",
        "kept",
    ];
    let first = folder.run(&arguments(&more)).succeeded();
    assert!(
        first.stdout.contains("0 of 2 cuts worse than uncorrected"),
        "{}",
        first.stdout
    );
    let results: Value = serde_json::from_slice(&folder.read("n.json")).unwrap();
    assert_eq!(
        (
            results["judged"].as_u64(),
            results["rows"].as_array().unwrap().len()
        ),
        (Some(2), 2)
    );
    for row in results["rows"].as_array().unwrap() {
        assert_eq!(row["uncorrected"], row["corrected"]);
        assert_eq!(row["rigid"].as_bool(), Some(row["machine"] == "tnv40"));
    }
    let again = folder.run(&arguments(&more)).succeeded();
    assert!(
        again.stdout.contains("cuts that were there: 2"),
        "{}",
        again.stdout
    );
    assert_eq!(
        serde_json::from_slice::<Value>(&folder.read("n.json")).unwrap(),
        results
    );
}

#[test]
fn a_sample_is_the_same_for_the_same_seed() {
    let folder = Folder::new();
    let sample = |seed: &str| {
        let more = [
            ".",
            "--sample",
            "3",
            "--seed",
            seed,
            "--json",
            "n.json",
            "--results",
            "kept",
        ];
        folder.run(&arguments(&more)).succeeded();
        let results: Value = serde_json::from_slice(&folder.read("n.json")).unwrap();
        let machines: Vec<String> = results["rows"]
            .as_array()
            .unwrap()
            .iter()
            .map(|row| row["machine"].to_string())
            .collect();
        machines
    };
    let first = sample("1");
    assert_eq!((first.len(), &first), (3, &sample("1")));
    assert_ne!(first, sample("2"));
}

#[test]
fn what_cannot_be_cut_is_said() {
    let folder = Folder::new();
    folder.file("wrong.ngc", "G1 X[oops\nM2\n");
    folder
        .run(&arguments(&["missing"]))
        .refused(&["missing: there is no such file or folder"]);
    folder
        .run(&arguments(&["wrong.ngc"]))
        .refused(&["none of the programs can be cut"]);
    folder
        .run(&arguments(&["circle.ngc", "--only", "*star*"]))
        .refused(&["no program fits"]);
    folder
        .run(&arguments(&["circle.ngc", "--only", "["]))
        .refused(&["--only ["]);
    folder
        .run(&arguments(&["circle.ngc", "--limit-s", "0"]))
        .refused(&["--limit-s is 0 s"]);
    folder
        .run(&arguments(&["circle.ngc", "--json", "circle.ngc"]))
        .refused(&["circle.ngc"]);
    folder
        .run(&["never-worse", "circle.ngc", "--controller", "open"])
        .refused(&["no controller is called 'open'"]);
}

#[test]
fn realistic_machines_are_others_and_the_rest_stays_as_it_was() {
    let folder = Folder::new();
    let draw = |more: &[&str]| {
        let held_out = [
            "held-out",
            "5",
            "2",
            "--programs",
            "1",
            "--controller",
            "uncorrected",
            "--json",
            "n.json",
        ];
        folder
            .run(&[&held_out[..], &["--results", "kept"], more].concat())
            .succeeded();
        let results: Value = serde_json::from_slice(&folder.read("n.json")).unwrap();
        results["rows"].as_array().unwrap().clone()
    };
    let (plain, realistic) = (draw(&[]), draw(&["--realistic"]));
    let names = |rows: &[Value], key: &str| {
        rows.iter()
            .map(|row| row[key].to_string())
            .collect::<Vec<_>>()
    };
    assert_eq!(names(&plain, "program"), names(&realistic, "program"));
    assert!(
        plain
            .iter()
            .zip(&realistic)
            .all(|(a, b)| a["uncorrected"] != b["uncorrected"]),
        "{realistic:?}"
    );
    assert_eq!(realistic, draw(&["--realistic"]));
    folder
        .run(&["held-out", "5", "2", "--realistic", "--rigid"])
        .refused(&["--realistic", "--rigid"]);
}
