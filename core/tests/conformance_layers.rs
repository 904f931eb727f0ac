//! The layers of the code: a module uses only modules above it in its crate's `lib.rs`, the servo-thread crate depends on
//! nothing of ours, and the library knows no shell.

use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The modules of a crate in the order of its `lib.rs`.
fn modules(source: &Path) -> Vec<String> {
    let text = fs::read_to_string(source.join("lib.rs")).unwrap();
    text.lines()
        .filter_map(|line| line.trim().strip_prefix("pub ").unwrap_or(line.trim()).strip_prefix("mod "))
        .filter_map(|rest| rest.strip_suffix(';'))
        .map(str::to_owned)
        .collect()
}

/// The files of a module: `name.rs` and everything in `name/`.
fn files(source: &Path, module: &str) -> Vec<PathBuf> {
    let mut found = vec![source.join(module).with_extension("rs")];
    let mut folders = vec![source.join(module)];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = fs::read_dir(&folder) else { continue };
        for path in entries.map(|entry| entry.unwrap().path()) {
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                found.push(path);
            }
        }
    }
    found
}

/// First segments of all paths in `text` that start at the crate, outside comments: `a` and `b` of `crate::{a::x, b}`.
fn uses(text: &str) -> Vec<String> {
    let code: String = text.lines().map(|line| line.split("//").next().unwrap_or("").to_owned() + "\n").collect();
    let name =
        |text: &str| text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let mut found = Vec::new();
    for (at, _) in code.match_indices("crate::") {
        let rest = &code[at + "crate::".len()..];
        let Some(group) = rest.strip_prefix('{') else {
            found.push(name(rest));
            continue;
        };
        let mut depth = 1;
        found.push(name(group));
        for (at, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => found.push(name(&group[at + 1..])),
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
    }
    found
}

fn assert_layers(source: &Path) {
    let modules = modules(source);
    assert!(modules.len() > 2, "{} lists its modules", source.display());
    let mut checked = 0;
    for (layer, module) in modules.iter().enumerate() {
        for file in files(source, module) {
            let text = fs::read_to_string(&file).unwrap();
            for used in uses(&text) {
                let Some(other) = modules.iter().position(|name| *name == used) else { continue };
                assert!(other <= layer, "{} uses `{used}`, which stands below `{module}` in lib.rs", file.display());
                checked += usize::from(other < layer);
            }
        }
    }
    assert!(checked > 0, "no module of {} uses another: the search is broken", source.display());
}

#[test]
fn a_module_of_the_library_uses_only_modules_above_it() {
    assert_layers(&root().join("core/src"));
}

#[test]
fn a_module_of_the_servo_thread_uses_only_modules_above_it() {
    assert_layers(&root().join("control/src"));
}

#[test]
fn the_search_finds_what_it_is_for() {
    assert_eq!(uses("use crate::feed::{a, b};\n// crate::no\nlet x = crate::path::y;"), ["feed", "path"]);
    assert_eq!(uses("use crate::{\n    feed::{a, b},\n    path,\n};"), ["feed", "path", ""]);
}

/// Names of our packages among the dependencies of a package, of every kind.
fn ours(package: &str) -> Vec<String> {
    let text = fs::read_to_string(root().join(package).join("Cargo.toml")).unwrap();
    let file: toml::Table = text.parse().unwrap();
    let kinds = ["dependencies", "dev-dependencies", "build-dependencies"];
    let tables = kinds.iter().filter_map(|kind| file.get(*kind)?.as_table());
    tables.flat_map(|table| table.keys()).filter(|name| name.starts_with("feedwright")).cloned().collect()
}

#[test]
fn packages_depend_on_each_other_in_one_direction() {
    assert_eq!(ours("control"), [""; 0]);
    assert_eq!(ours("core"), ["feedwright-control"]);
    assert_eq!(ours("cli"), ["feedwright"]);
}

#[test]
fn the_servo_thread_is_no_std() {
    let text = fs::read_to_string(root().join("control/src/lib.rs")).unwrap();
    assert!(text.lines().any(|line| line == "#![no_std]"));
}
