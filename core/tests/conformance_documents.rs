//! The documents speak of what there is: their links lead somewhere, and every key of a machine file is explained.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use std::path::{Path, PathBuf};

/// Folders with documents; not searched deeper.
const FOLDERS: [&str; 4] = ["", "docs", "examples/01_paper_circle", "examples/02_horizon"];

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn documents() -> Vec<PathBuf> {
    let entries = FOLDERS.iter().flat_map(|folder| std::fs::read_dir(root().join(folder)).unwrap());
    entries.map(|entry| entry.unwrap().path()).filter(|path| path.extension().is_some_and(|e| e == "md")).collect()
}

/// Targets of the links and figures of a text that are files.
fn targets(text: &str) -> impl Iterator<Item = &str> {
    let links = text.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    links.map(|(target, _)| target).filter(|target| !target.contains("://") && !target.starts_with('#'))
}

fn lead_nowhere(document: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(document).unwrap();
    let folder = document.parent().unwrap();
    targets(&text).filter(|target| !folder.join(target).exists()).map(str::to_owned).collect()
}

#[test]
fn links_lead_somewhere() {
    let documents = documents();
    assert!(documents.len() >= 8, "{documents:?}");
    for document in documents {
        assert_eq!(lead_nowhere(&document), [""; 0], "{}", document.display());
    }
}

#[test]
fn every_key_of_a_machine_file_is_explained() {
    fn keys(table: &toml::Table, found: &mut Vec<String>) {
        for (key, value) in table {
            match value {
                toml::Value::Table(inner) => keys(inner, found),
                _ => found.push(key.clone()),
            }
        }
    }
    let document = std::fs::read_to_string(root().join("docs/machine-file.md")).unwrap();
    let (_, text) = feedwright::machine::BUILT_IN[0];
    let mut found = Vec::new();
    keys(&text.parse().unwrap(), &mut found);
    assert!(found.len() > 20, "{found:?}");
    for key in found {
        assert!(document.contains(&format!("| `{key}` |")), "docs/machine-file.md says nothing of {key}");
    }
}

#[test]
fn a_link_to_nothing_is_found() {
    let text = "[a](b.md) ![c](d.svg) [e](https://example.org) [f](#g)";
    assert_eq!(targets(text).collect::<Vec<_>>(), ["b.md", "d.svg"]);
}
