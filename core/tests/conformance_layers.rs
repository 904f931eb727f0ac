//! The order of the modules in `lib.rs` is the order in which data flows: a module uses only modules above it, and a crate
//! only crates below it.

#[path = "../../gcode/tests/common/source.rs"]
mod source;

use std::path::{Path, PathBuf};

use source::code;

/// Crates of the workspace: folder, and which of ours it depends on, outside of tests.
const CRATES: [(&str, &[&str]); 4] =
    [("gcode", &[]), ("control", &[]), ("core", &["feedwright-control", "feedwright-gcode"]), ("cli", &["feedwright"])];

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The modules that a file uses, with lines: first words after `crate::`, or after as many `super::` as lead to the root.
fn used(text: &str, depth: usize) -> Vec<(usize, String)> {
    let code = code(text);
    let above = "super::".repeat(depth);
    let mut uses = Vec::new();
    for prefix in ["crate::", above.as_str()] {
        for (at, _) in code.match_indices(prefix) {
            let after = code[at + prefix.len()..].trim_start();
            if code[..at].ends_with(is_word) || after.starts_with("super::") {
                continue;
            }
            let line = code[..at].matches('\n').count() + 1;
            uses.extend(first_words(after).into_iter().map(|word| (line, word)));
        }
    }
    uses
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// `a::b` starts with a; `{a::{b, c}, d}` with a and d.
fn first_words(path: &str) -> Vec<String> {
    let word = |text: &str| text.trim_start().chars().take_while(|&c| is_word(c)).collect::<String>();
    let Some(group) = path.strip_prefix('{') else { return vec![word(path)] };
    let mut depth = 0;
    let mut starts = vec![0];
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 0 => break,
            '}' => depth -= 1,
            ',' if depth == 0 => starts.push(at + 1),
            _ => {}
        }
    }
    starts.into_iter().map(|at| word(&group[at..])).filter(|word| !word.is_empty()).collect()
}

/// Modules of a crate in the order of `lib.rs`.
fn modules(src: &Path) -> Vec<String> {
    let lib = code(&read(&src.join("lib.rs")));
    let names = lib.lines().filter_map(|line| {
        let line = line.trim();
        let name = line.strip_prefix("pub mod ").or_else(|| line.strip_prefix("mod "))?;
        Some(name.strip_suffix(';')?.to_owned())
    });
    names.collect()
}

/// All files of a module, with the number of modules they stand in.
fn files(src: &Path, module: &str) -> Vec<(PathBuf, usize)> {
    fn walk(folder: &Path, depth: usize, found: &mut Vec<(PathBuf, usize)>) {
        let Ok(entries) = std::fs::read_dir(folder) else { return };
        for entry in entries {
            let path = entry.expect("the folder can be read").path();
            if path.is_dir() {
                walk(&path, depth + 1, found);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                found.push((path, depth));
            }
        }
    }
    let mut found = vec![(src.join(format!("{module}.rs")), 1)];
    walk(&src.join(module), 2, &mut found);
    found
}

#[test]
fn a_module_uses_only_modules_above_it() {
    let mut violations = Vec::new();
    for folder in ["control", "core"] {
        let src = root().join(folder).join("src");
        let modules = modules(&src);
        assert!(modules.len() > 5, "{folder}/src/lib.rs lists {modules:?}");
        let mut uses_seen = 0;
        for (place, module) in modules.iter().enumerate() {
            for (file, depth) in files(&src, module) {
                for (line, name) in used(&read(&file), depth) {
                    let Some(other) = modules.iter().position(|other| *other == name) else { continue };
                    uses_seen += 1;
                    if other > place {
                        let file = file.strip_prefix(&src).unwrap().display();
                        violations
                            .push(format!("{folder}/src/{file}:{line}: {module} uses {name}, which stands below it"));
                    }
                }
            }
        }
        assert!(uses_seen > modules.len(), "{folder}: the modules hardly use each other, was anything read?");
    }
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

#[test]
fn a_crate_depends_only_on_crates_below_it() {
    for (folder, allowed) in CRATES {
        let manifest: toml::Table = read(&root().join(folder).join("Cargo.toml")).parse().unwrap();
        let dependencies = manifest["dependencies"].as_table().unwrap();
        let ours: Vec<&str> =
            dependencies.keys().map(String::as_str).filter(|name| name.starts_with("feedwright")).collect();
        assert_eq!(ours, allowed, "{folder}/Cargo.toml");
    }
}

#[test]
fn uses_are_found_wherever_they_stand() {
    let found = |text, depth| used(text, depth).into_iter().map(|(_, name)| name).collect::<Vec<_>>();
    assert_eq!(found("use crate::path::Path;\nfn f(x: crate::feed::Plan) {}", 1), ["path", "feed"]);
    assert_eq!(found("use crate::{path::{Path, arc}, feed, plant::Plant};", 1), ["path", "feed", "plant"]);
    assert_eq!(found("use super::path::Path;", 1), ["path"]);
    assert_eq!(found("use super::path::Path;", 2), [""; 0]);
    assert_eq!(found("use super::super::path::Path;", 2), ["path"]);
    assert_eq!(used("\n\nuse crate::path;", 1), [(3, "path".to_owned())]);
}

#[test]
fn comments_and_strings_use_nothing() {
    let text =
        "//! [`crate::path`]\n/* crate::feed */ let s = \"\\\" crate::plant // \"; let c = '\"'; crate::trace::Row";
    assert_eq!(used(text, 1), [(2, "trace".to_owned())]);
}
