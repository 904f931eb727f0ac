//! The order of `mod` lines is the order in which data flows: a file uses only files above it, a
//! parent and its children belong together, and a crate uses only crates below it. The reader holds
//! itself to the same.

use std::path::{Path, PathBuf};

use crate::layers::{check, files};

/// Crates of the workspace: folder, and which of ours it depends on, outside of tests.
const CRATES: [(&str, &[&str]); 7] = [
    ("crates/gcode", &[]),
    ("crates/control", &[]),
    ("crates/plan", &["feedwright-control", "feedwright-gcode"]),
    (
        "crates/sim",
        &["feedwright-control", "feedwright-gcode", "feedwright-plan"],
    ),
    (
        "crates/ident",
        &[
            "feedwright-control",
            "feedwright-gcode",
            "feedwright-plan",
            "feedwright-sim",
        ],
    ),
    (
        "crates/feedwright",
        &[
            "feedwright-control",
            "feedwright-gcode",
            "feedwright-ident",
            "feedwright-plan",
            "feedwright-sim",
        ],
    ),
    (
        "lab",
        &[
            "feedwright",
            "feedwright-control",
            "feedwright-gcode",
            "feedwright-ident",
            "feedwright-plan",
            "feedwright-sim",
        ],
    ),
];

/// Crates that `feedwright` gives as its own modules: a path through its root to one of them is
/// fine.
const OUTSIDE: [&str; 5] = ["control", "gcode", "ident", "plan", "sim"];

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[test]
fn a_file_uses_only_files_above_it() {
    for (folder, _) in CRATES
        .into_iter()
        .filter(|(folder, _)| *folder != "crates/gcode")
    {
        let outside: &[&str] = if folder == "crates/feedwright" {
            &OUTSIDE
        } else {
            &[]
        };
        let files = files(&root().join(folder).join("src"));
        assert!(
            files.len() > 15,
            "{folder}: lib.rs and its modules list {} files",
            files.len()
        );
        let (violations, seen) = check(&files, &[], outside);
        assert!(
            seen > files.len(),
            "{folder}: {seen} uses in {} files, was anything read?",
            files.len()
        );
        assert!(
            violations.is_empty(),
            "{folder}:\n{}",
            violations.join("\n")
        );
    }
}

#[test]
fn a_crate_depends_only_on_crates_below_it() {
    for (folder, allowed) in CRATES {
        let manifest: toml::Table = read(&root().join(folder).join("Cargo.toml"))
            .parse()
            .unwrap();
        let dependencies = manifest["dependencies"].as_table().unwrap();
        let mut ours: Vec<&str> = dependencies
            .keys()
            .map(String::as_str)
            .filter(|name| name.starts_with("feedwright"))
            .collect();
        ours.sort_unstable();
        assert_eq!(ours, allowed, "{folder}/Cargo.toml");
    }
}

#[test]
fn no_crate_of_the_product_depends_on_the_laboratory() {
    let mut seen = 0;
    for entry in
        std::fs::read_dir(root().join("crates")).expect("the folder of the crates can be read")
    {
        let manifest = entry
            .expect("an entry of the folder can be read")
            .path()
            .join("Cargo.toml");
        assert!(
            !read(&manifest).contains("feedwright-lab"),
            "{} names the laboratory",
            manifest.display()
        );
        seen += 1;
    }
    assert_eq!(seen, CRATES.len() - 1, "folders in crates/");
}
