//! The order of `mod` lines is the order in which data flows: a file uses only files above it, a parent and its children belong
//! together, and a crate uses only crates below it. The reader holds itself to the same.

#[path = "../../gcode/tests/common/layers.rs"]
mod layers;
#[path = "../../gcode/tests/common/source.rs"]
mod source;

use std::path::{Path, PathBuf};

use layers::{check, files};

/// Crates of the workspace: folder, and which of ours it depends on, outside of tests.
const CRATES: [(&str, &[&str]); 4] =
    [("gcode", &[]), ("control", &[]), ("core", &["feedwright-control", "feedwright-gcode"]), ("cli", &["feedwright"])];

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn a_file_uses_only_files_above_it() {
    for (folder, outside) in [("control", [].as_slice()), ("core", &["gcode"]), ("cli", &[])] {
        let files = files(&root().join(folder).join("src"));
        assert!(files.len() > 15, "{folder}: lib.rs and its modules list {} files", files.len());
        let (violations, seen) = check(&files, &[], outside);
        assert!(seen > files.len(), "{folder}: {seen} uses in {} files, was anything read?", files.len());
        assert!(violations.is_empty(), "{folder}:\n{}", violations.join("\n"));
    }
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
