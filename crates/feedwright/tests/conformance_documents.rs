//! The documents are consistent with the repository: their links lead to existing files and
//! headings, docs/machine-file.md explains every key of a machine file, and ARCHITECTURE.md names
//! only source files that exist.

use std::path::{Path, PathBuf};

/// Folders with documents; not searched deeper.
const FOLDERS: [&str; 7] = [
    "",
    "docs",
    "examples/01_paper_circle",
    "examples/02_contours",
    "examples/03_realism",
    "examples/04_planner",
    "examples/05_noise",
];

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

fn documents() -> Vec<PathBuf> {
    let entries = FOLDERS
        .iter()
        .flat_map(|folder| std::fs::read_dir(root().join(folder)).unwrap());
    entries
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "md"))
        .collect()
}

/// Links and figures of a text that stay within the repository, each as its file, empty for this
/// one, and its heading.
fn links(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let markdown = text
        .split("](")
        .skip(1)
        .filter_map(|rest| rest.split_once(')'));
    let html = ["src=\"", "srcset=\""]
        .into_iter()
        .flat_map(|name| text.split(name).skip(1));
    let all = markdown
        .chain(html.filter_map(|rest| rest.split_once('"')))
        .map(|(target, _)| target);
    all.filter(|target| !target.contains("://"))
        .map(|target| target.split_once('#').unwrap_or((target, "")))
}

/// Targets of the links and figures of a text that are files.
fn targets(text: &str) -> impl Iterator<Item = &str> {
    links(text)
        .map(|(file, _)| file)
        .filter(|file| !file.is_empty())
}

/// A heading as GitHub and mdbook name it in a link.
fn name(heading: &str) -> String {
    let kept = heading
        .chars()
        .filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

fn has_heading(text: &str, wanted: &str) -> bool {
    text.lines()
        .any(|line| line.starts_with('#') && name(line.trim_start_matches('#').trim()) == wanted)
}

fn lead_nowhere(document: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(document).unwrap();
    let leads = |file: &str, heading: &str| {
        let path = if file.is_empty() {
            document.to_owned()
        } else {
            document.parent().unwrap().join(file)
        };
        path.exists()
            && (heading.is_empty() || has_heading(&std::fs::read_to_string(path).unwrap(), heading))
    };
    let wrong = links(&text).filter(|(file, heading)| !leads(file, heading));
    wrong
        .map(|(file, heading)| format!("{file}#{heading}"))
        .collect()
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
fn every_page_is_in_the_manual() {
    let docs = root().join("docs");
    let manual = std::fs::read_to_string(docs.join("README.md")).unwrap();
    let listed: Vec<&str> = targets(&manual).collect();
    let pages = files(&docs, &["md"]);
    assert!(pages.len() > 15, "{pages:?}");
    let missing: Vec<String> = pages
        .into_iter()
        .filter(|page| page != "README.md" && !listed.contains(&page.as_str()))
        .collect();
    assert!(
        missing.is_empty(),
        "docs/README.md does not list {missing:?}"
    );
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
    let (_, text) = feedwright_sim::BUILT_IN_MACHINES[0];
    let mut found = Vec::new();
    keys(&text.parse().unwrap(), &mut found);
    assert!(found.len() > 20, "{found:?}");
    for key in found {
        assert!(
            document.contains(&format!("| `{key}` |")),
            "docs/machine-file.md says nothing of {key}"
        );
    }
}

/// Folders with the source files of which ARCHITECTURE.md speaks.
const SOURCES: [&str; 2] = ["crates", "lab"];

/// All files below a folder with one of these endings, as paths from there.
fn files(folder: &Path, endings: &[&str]) -> Vec<String> {
    fn walk(folder: &Path, from: &Path, endings: &[&str], found: &mut Vec<String>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                walk(&path, from, endings, found);
            } else if path
                .extension()
                .is_some_and(|e| endings.iter().any(|ending| e == *ending))
            {
                let words = path.strip_prefix(from).unwrap().components();
                found.push(
                    words
                        .map(|word| word.as_os_str().to_string_lossy())
                        .collect::<Vec<_>>()
                        .join("/"),
                );
            }
        }
    }
    let mut found = Vec::new();
    walk(folder, folder, endings, &mut found);
    found.sort();
    found
}

#[test]
fn every_file_of_which_the_architecture_speaks_is_there() {
    let text = std::fs::read_to_string(root().join("ARCHITECTURE.md")).unwrap();
    let there: Vec<String> = SOURCES
        .iter()
        .flat_map(|folder| {
            files(&root().join(folder), &["rs", "py"])
                .into_iter()
                .map(move |file| format!("{folder}/{file}"))
        })
        .collect();
    let quoted: Vec<&str> = text
        .split('`')
        .skip(1)
        .step_by(2)
        .filter(|word| !word.contains(['*', ' ']))
        .collect();
    let named: Vec<&str> = quoted
        .into_iter()
        .filter(|word| word.ends_with(".rs") || word.ends_with(".py"))
        .collect();
    assert!(named.len() > 30, "{named:?}");
    for name in named {
        let ending = format!("/{name}");
        assert!(
            there
                .iter()
                .any(|file| file == name || file.ends_with(&ending)),
            "ARCHITECTURE.md speaks of {name}"
        );
    }
}

#[test]
fn a_link_to_nothing_is_found() {
    let text = "[a](b.md) ![c](d.svg) [e](https://example.org) [f](#g)";
    assert_eq!(targets(text).collect::<Vec<_>>(), ["b.md", "d.svg"]);
    assert_eq!(
        links("[a](b.md#c) <img src=\"d.png\">").collect::<Vec<_>>(),
        [("b.md", "c"), ("d.png", "")]
    );
    assert!(
        has_heading("## `[axis.x]`, and _more_", "axisx-and-_more_") && !has_heading("## a", "b")
    );
}
