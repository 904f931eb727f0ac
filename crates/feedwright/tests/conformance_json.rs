//! docs/json.md has every key of the JSON results, and no other; all of them state format and
//! version.

use crate::command::Folder;
use crate::conformance_identify_log::{HEAD, rows, text};
use crate::json_keys;
use feedwright::RESULTS_FORMAT;
use serde_json::Value;

fn holds(section: &str, result: &str) {
    let value: Value = serde_json::from_str(result).unwrap();
    assert_eq!(
        (&value["format"], &value["version"]),
        (&RESULTS_FORMAT.into(), &env!("CARGO_PKG_VERSION").into())
    );
    json_keys::hold(section, &value);
}

/// Needs 10 s of processor time: runs every command that writes JSON.
#[test]
fn every_key_of_a_result_is_documented_and_every_documented_key_is_there() {
    let folder = Folder::new();
    let json = |arguments: &[&str]| {
        let ran = folder.run(&[arguments, &["--json", "result.json"]].concat());
        assert!(ran.stdout.contains("wrote result.json"), "{ran:?}");
        folder.text("result.json")
    };
    holds(
        "run",
        &json(&["run", "circle.ngc", "--out", "new.ngc", "--tolerance", "10"]),
    );
    holds(
        "run",
        &json(&[
            "run",
            "circle.ngc",
            "--against",
            "feedforward",
            "--controller",
            "uncorrected",
        ]),
    );
    holds(
        "correct",
        &json(&[
            "correct",
            "circle.ngc",
            "--machine",
            "tnv40",
            "--for",
            "generic",
        ]),
    );
    holds(
        "advise",
        &json(&[
            "advise",
            "circle.ngc",
            "--controller",
            "feedforward",
            "--tolerance",
            "10",
        ]),
    );
    holds(
        "advise",
        &json(&[
            "advise",
            "circle.ngc",
            "--controller",
            "feedforward",
            "--tolerance",
            "0.01",
        ]),
    );
    holds("plan", &json(&["plan", "circle.ngc", "--machine", "tnv40"]));
    folder.file("log.csv", text(HEAD, rows(1)));
    holds(
        "identify",
        &json(&["identify", "log.csv", "--out", "mine.toml"]),
    );
    folder.file("bar.csv", crate::conformance_geometry_command::bar());
    holds(
        "identify --geometry",
        &json(&[
            "identify",
            "--geometry",
            "bar.csv",
            "--out",
            "geometry.toml",
        ]),
    );
    folder.file("wrong.ngc", "G1 X1 F100 Q\n");
    holds(
        "check --format json",
        &folder
            .run(&["check", "--format", "json", "circle.ngc", "wrong.ngc"])
            .stdout,
    );
}
