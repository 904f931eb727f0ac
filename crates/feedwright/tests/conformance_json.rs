//! docs/json.md has every key of the JSON results, and no other; all of them state format and version.

use std::path::Path;

use crate::command::Folder;
use crate::conformance_identify_log::{HEAD, rows, text};
use feedwright::RESULTS_FORMAT;
use serde_json::Value;

/// A row of the document: a key by its names, and whether it may be missing.
type DocumentedKey = (Vec<String>, bool);

/// The keys of a section, after those of all results.
fn documented(section: &str) -> Vec<DocumentedKey> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/json.md");
    let document = std::fs::read_to_string(path).unwrap();
    let parts: Vec<&str> = document.split("\n## ").collect();
    let wanted = format!("`{section}`");
    let part = parts.iter().find(|part| part.starts_with(&wanted)).unwrap_or_else(|| panic!("no section {section}"));
    let row = |line: &str| {
        let key = line.strip_prefix("| `")?.split('`').next()?;
        Some((key.split('.').map(str::to_owned).collect(), line.contains("may be missing")))
    };
    [parts[0], part].into_iter().flat_map(str::lines).filter_map(row).collect()
}

/// The keys of a value, by their names; what is null is missing.
fn keys(value: &Value, at: &[String], all: &mut Vec<Vec<String>>) {
    match value {
        Value::Null => {}
        Value::Object(entries) => {
            entries.iter().for_each(|(name, value)| keys(value, &[at, std::slice::from_ref(name)].concat(), all));
        }
        Value::Array(elements) => {
            let mut of_elements = at.to_vec();
            if let Some(last) = of_elements.last_mut() {
                *last += "[]";
            }
            elements.iter().for_each(|value| keys(value, &of_elements, all));
        }
        _ => all.push(at.to_vec()),
    }
}

fn is_meant(documented: &[String], found: &[String]) -> bool {
    match (documented, found) {
        ([], []) => true,
        ([rest], [_, ..]) if rest == "…" => true,
        ([name, documented @ ..], [here, found @ ..]) => {
            let same = name == here || (name == "*" && !here.ends_with("[]"));
            // What stands below a list has no `[]` in the document.
            let below = documented == ["…"] && here.strip_suffix("[]") == Some(name);
            (same && is_meant(documented, found)) || below
        }
        _ => false,
    }
}

fn holds(section: &str, result: &str) {
    let value: Value = serde_json::from_str(result).unwrap();
    assert_eq!((&value["format"], &value["version"]), (&RESULTS_FORMAT.into(), &env!("CARGO_PKG_VERSION").into()));
    let documented = documented(section);
    let mut found = Vec::new();
    keys(&value, &[], &mut found);
    for key in &found {
        assert!(
            documented.iter().any(|(row, _)| is_meant(row, key)),
            "{section}: docs/json.md lacks {}",
            key.join(".")
        );
    }
    for (row, may_be_missing) in &documented {
        let is_there = found.iter().any(|key| is_meant(row, key));
        assert!(is_there || *may_be_missing, "{section}: {} of docs/json.md is not there", row.join("."));
    }
}

#[test]
fn every_key_of_a_result_is_documented_and_every_documented_key_is_there() {
    let folder = Folder::new();
    let json = |arguments: &[&str]| {
        let ran = folder.run(&[arguments, &["--json", "result.json"]].concat());
        assert!(ran.stdout.contains("wrote result.json"), "{ran:?}");
        folder.text("result.json")
    };
    holds("run", &json(&["run", "circle.ngc", "--controller", "feedforward", "--out", "new.ngc", "--tolerance", "10"]));
    holds("run", &json(&["run", "circle.ngc", "--against", "feedforward", "--controller", "uncorrected"]));
    holds("correct", &json(&["correct", "circle.ngc", "--machine", "tnv40", "--for", "generic"]));
    holds("advise", &json(&["advise", "circle.ngc", "--controller", "feedforward", "--tolerance", "10"]));
    holds("advise", &json(&["advise", "circle.ngc", "--controller", "feedforward", "--tolerance", "0.01"]));
    holds("plan", &json(&["plan", "circle.ngc", "--machine", "tnv40"]));
    folder.file("log.csv", text(HEAD, rows(1)));
    holds("identify", &json(&["identify", "log.csv", "--out", "mine.toml"]));
    folder.file("wrong.ngc", "G1 X1 F100 Q\n");
    holds("check --format json", &folder.run(&["check", "--format", "json", "circle.ngc", "wrong.ngc"]).stdout);
}
