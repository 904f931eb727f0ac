//! `feedwright-lab mismatch`: several controllers, written files, and rejected arguments.

use crate::command::Folder;
use crate::json_keys;
use serde_json::Value;

const ARGUMENTS: [&str; 6] = [
    "mismatch",
    "lines.ngc",
    "--machine",
    "tnv40",
    "--controller",
    "disturbance-observer",
];
const TWO: [&str; 2] = ["--controller", "feedforward-cross-coupled"];

/// A folder with a program that takes five seconds.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.file(
        "lines.ngc",
        "G21 G17 G90 G94 F1500\nG2 X0 Y0 I10 J0\nG1 X20 Y15\nG1 X0 Y0\nM2\n",
    );
    folder
}

/// Returns the content of `r.json`, written by `--json r.json`; all of its keys are documented.
fn results(folder: &Folder) -> Value {
    let value = serde_json::from_slice(&folder.read("r.json")).unwrap();
    json_keys::hold("feedwright-lab mismatch", &value);
    value
}

#[test]
fn every_controller_is_made_for_the_same_machine_and_has_its_row_beside_ours() {
    let folder = folder();
    let run = |more: &[&str]| {
        folder.run(&[&ARGUMENTS[..], more, &["--gross", "--json", "r.json"]].concat())
    };
    let both = run(&TWO);
    assert!(matches!(both.code, Some(0 | 1)), "{both:?}");
    assert!(
        both.stdout
            .contains("tnv40: best peer feedforward-cross-coupled"),
        "{}",
        both.stdout
    );
    let two = results(&folder);
    let [groups, verdict] = [&two["groups"], &two["verdicts"][0]];
    let names: Vec<&str> = groups
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["controller"].as_str().unwrap())
        .collect();
    assert_eq!(
        (names, &verdict["ours"]),
        (
            vec!["disturbance-observer", TWO[1]],
            &"disturbance-observer".into()
        )
    );
    // The machine itself, and five gross differences.
    assert_eq!(
        (
            two["judged"].as_u64(),
            two["peer_rows"].as_array().unwrap().len()
        ),
        (Some(6), 6)
    );
    for group in groups.as_array().unwrap() {
        assert!(
            group["later_ratio"]["cuts"] == 5 && group["rms_ratio"]["cuts"] == 6,
            "{group}"
        );
    }
    assert_eq!(verdict["median"], groups[0]["rms_ratio"]["median"]);
    let ratio =
        verdict["median"].as_f64().unwrap() / groups[1]["rms_ratio"]["median"].as_f64().unwrap();
    assert!((verdict["ratio"].as_f64().unwrap() - ratio).abs() < 1e-12);
    // Alone, a controller cuts the same.
    run(&[]);
    let alone = results(&folder);
    assert_eq!(
        (&alone["rows"], &alone["groups"][0]),
        (&two["rows"], &groups[0])
    );
    // What is set goes before what is recorded.
    run(&["--set", "bandwidth_hz=1"]);
    assert_ne!(results(&folder)["groups"][0], groups[0]);
}

#[test]
fn what_does_not_go_together_is_refused() {
    let folder = folder();
    for (more, says) in [
        (
            &["--controller", "disturbance-observer"][..],
            &["disturbance-observer is there twice"][..],
        ),
        (
            &["--controller", "feedforwart"],
            &["did you mean 'feedforward'?"],
        ),
        (
            &["--controller", "feedforward", "--set", "velocity_gain=1"],
            &["CONTROLLER.velocity_gain=1"],
        ),
        (
            &["--set", "feedforward.velocity_gain=1"],
            &["feedforward does not take part"],
        ),
        (&["--limit-s", "0"], &["--limit-s"]),
    ] {
        folder.run(&[&ARGUMENTS[..], more].concat()).refused(says);
    }
}
