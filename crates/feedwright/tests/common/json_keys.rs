//! The keys of JSON results beside those that docs/json.md lists.

use std::path::Path;

use serde_json::Value;

/// A row of the document: a key by its names, and whether it may be missing.
type DocumentedKey = (Vec<String>, bool);

/// The keys of a section, after those of all results.
fn documented(section: &str) -> Vec<DocumentedKey> {
    // The crates of the product are one folder deeper than the laboratory.
    let mut places = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .map(|folder| folder.join("docs/json.md"));
    let document = std::fs::read_to_string(places.find(|path| path.exists()).unwrap()).unwrap();
    let parts: Vec<&str> = document.split("\n## ").collect();
    let wanted = format!("`{section}`");
    let part = parts
        .iter()
        .find(|part| part.starts_with(&wanted))
        .unwrap_or_else(|| panic!("no section {section}"));
    let row = |line: &str| {
        let key = line.strip_prefix("| `")?.split('`').next()?;
        Some((
            key.split('.').map(str::to_owned).collect(),
            line.contains("may be missing"),
        ))
    };
    [parts[0], part]
        .into_iter()
        .flat_map(str::lines)
        .filter_map(row)
        .collect()
}

/// The keys of a value, by their names; what is null is missing.
fn keys(value: &Value, at: &[String], all: &mut Vec<Vec<String>>) {
    match value {
        Value::Null => {}
        Value::Object(entries) => {
            entries.iter().for_each(|(name, value)| {
                keys(value, &[at, std::slice::from_ref(name)].concat(), all);
            });
        }
        Value::Array(elements) => {
            let mut of_elements = at.to_vec();
            if let Some(last) = of_elements.last_mut() {
                *last += "[]";
            }
            elements
                .iter()
                .for_each(|value| keys(value, &of_elements, all));
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

/// Every key of a result is in its section of the document, and every key there is in the result,
/// unless it may be missing.
pub(crate) fn hold(section: &str, value: &Value) {
    let documented = documented(section);
    let mut found = Vec::new();
    keys(value, &[], &mut found);
    for key in &found {
        assert!(
            documented.iter().any(|(row, _)| is_meant(row, key)),
            "{section}: docs/json.md lacks {}",
            key.join(".")
        );
    }
    for (row, may_be_missing) in &documented {
        let is_there = found.iter().any(|key| is_meant(row, key));
        assert!(
            is_there || *may_be_missing,
            "{section}: {} of docs/json.md is not there",
            row.join(".")
        );
    }
}
