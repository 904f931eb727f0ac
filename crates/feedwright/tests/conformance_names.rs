//! Names of types: no two types of the workspace have the same name without a reason.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use crate::source::code;

/// Folders of the crates.
const FOLDERS: [&str; 7] = [
    "crates/gcode",
    "crates/control",
    "crates/plan",
    "crates/sim",
    "crates/ident",
    "crates/feedwright",
    "lab",
];

/// Names that several files give to a type of theirs, and why.
const SHARED: &[(&str, &str)] = &[
    (
        "Settings",
        "every member of a family has its own; they are written with its module, `cross_coupled::Settings`",
    ),
    (
        "Cli",
        "the arguments of a command, `feedwright` or `feedwright-lab`",
    ),
    (
        "CommandArgs",
        "the subcommands of a command, `feedwright` or `feedwright-lab`",
    ),
];

/// Names of the types that a source text declares outside of its tests. Associated types do not
/// count: a trait names them.
fn declared(text: &str) -> BTreeSet<String> {
    let code = code(text);
    let mut names = BTreeSet::new();
    for line in code
        .lines()
        .take_while(|line| !line.ends_with("mod tests {"))
    {
        let item = line.trim_start();
        let public = item
            .strip_prefix("pub")
            .map_or(item, |rest| match rest.strip_prefix('(') {
                Some(scope) => scope
                    .split_once(')')
                    .map_or("", |(_, item)| item)
                    .trim_start(),
                None => rest.trim_start(),
            });
        let Some((keyword, name)) = public.split_once(' ') else {
            continue;
        };
        let is_associated = keyword == "type" && line.starts_with(' ');
        if ["struct", "enum", "trait", "type", "union"].contains(&keyword) && !is_associated {
            names.insert(
                name.chars()
                    .take_while(|&c| c.is_alphanumeric() || c == '_')
                    .collect(),
            );
        }
    }
    names
}

/// Collects the Rust files below a folder, without its build folder.
pub(crate) fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.ends_with("target") {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "rs") {
            found.push(path);
        }
    }
}

/// All names with the files that declare them.
fn names() -> BTreeMap<String, Vec<String>> {
    let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
    let mut names: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for folder in FOLDERS {
        let mut sources = Vec::new();
        rust_files(&root.join(folder).join("src"), &mut sources);
        sources.retain(|path| !path.ends_with("tests.rs"));
        sources.sort();
        for file in sources {
            let place = file
                .strip_prefix(root)
                .unwrap()
                .to_str()
                .unwrap()
                .to_owned();
            for name in declared(&std::fs::read_to_string(&file).unwrap()) {
                names.entry(name).or_default().push(place.clone());
            }
        }
    }
    names
}

#[test]
fn no_type_name_stands_twice_without_a_reason() {
    let names = names();
    assert!(
        names.len() > 300,
        "{} names: was anything read?",
        names.len()
    );
    let is_shared = |name: &str| SHARED.iter().any(|(shared, _)| *shared == name);
    let twice: Vec<String> = names
        .iter()
        .filter(|(name, places)| places.len() > 1 && !is_shared(name))
        .map(|(name, places)| format!("{name}: {}", places.join(", ")))
        .collect();
    assert!(
        twice.is_empty(),
        "give all but one of these a name of its own:\n{}",
        twice.join("\n")
    );
}

#[test]
fn names_that_are_listed_do_stand_twice() {
    let names = names();
    for (name, why) in SHARED {
        let places = names.get(*name).map_or(0, Vec::len);
        assert!(
            places > 1,
            "{name} stands in {places} files and needs no reason: {why}"
        );
    }
}

#[test]
fn types_are_found_however_they_are_declared() {
    let text = "/// struct A;\nstruct B;\npub enum C<T> {\n    Struct(T),\n}\npub(crate) trait D: Sync {\n    type Item;\n}\n\
                pub(super) type E = u8;\nimpl I for B {\n    type Item = u8;\n}\nmod inner {\n    pub(in crate::x) struct F(u8);\n}\n\
                const S: &str = \"struct G\";\n#[cfg(test)]\npub(super) mod tests {\n    struct H;\n}\n";
    assert_eq!(
        declared(text)
            .iter()
            .map(String::as_str)
            .collect::<Vec<_>>(),
        ["B", "C", "D", "E", "F"]
    );
}
