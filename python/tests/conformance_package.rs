//! The package in Python: its examples, its tests and those of its manual, with the module that
//! cargo has just built.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;

/// The interpreter of all tests.
static PYTHON: OnceLock<Option<PathBuf>> = OnceLock::new();
/// Packages of Python that the tests import.
const NEEDED: [&str; 5] = [
    "distributed==2026.8.0",
    "gymnasium==1.4.0",
    "matplotlib==3.11.2",
    "numpy==2.4.6",
    "pyarrow==26.0.1",
];

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// An interpreter with what the tests import, made once; none where Python 3.11 or PyPI are
/// missing.
fn interpreter(target: &Path) -> Option<PathBuf> {
    let folder = target.join("python-tests");
    let python = folder.join("bin/python");
    let has = |code: &str| {
        Command::new(&python)
            .args(["-c", code])
            .output()
            .is_ok_and(|ran| ran.status.success())
    };
    if has("import distributed, gymnasium, matplotlib, numpy, pyarrow") {
        return Some(python);
    }
    let run = |program: &Path, arguments: &[&str]| {
        Command::new(program)
            .args(arguments)
            .output()
            .is_ok_and(|ran| ran.status.success())
    };
    let recent = "import sys; sys.exit(sys.version_info < (3, 11))";
    let made = run(Path::new("python3"), &["-c", recent])
        && run(
            Path::new("python3"),
            &["-m", "venv", "--clear", folder.to_str()?],
        )
        && run(
            &python,
            &[
                &["-m", "pip", "install", "--quiet", "--only-binary", ":all:"][..],
                &NEEDED,
            ]
            .concat(),
        );
    made.then_some(python)
}

#[test]
fn the_package_does_what_its_examples_and_tests_say() {
    runs("test_package.py");
}

#[test]
fn the_gym_does_what_its_examples_and_tests_say() {
    runs("test_lab.py");
}

#[test]
fn a_sweep_loses_nothing_whoever_is_killed() {
    runs("test_sweep.py");
}

/// Runs a file of tests with the package.
fn runs(tests: &str) {
    // Beside the executable of this test.
    let built = std::env::current_exe().unwrap();
    let built = built
        .parent()
        .unwrap()
        .join(format!("{DLL_PREFIX}feedwright_python{DLL_SUFFIX}"));
    let target = built.ancestors().nth(3).unwrap();
    let Some(python) = PYTHON.get_or_init(|| interpreter(target)) else {
        assert!(
            std::env::var_os("CI").is_none(),
            "no Python 3.11 with venv, or PyPI is out of reach"
        );
        eprintln!(
            "NOT TESTED: the package of Python, for want of Python 3.11 with venv, or of PyPI"
        );
        return;
    };
    let place = tempfile::tempdir().unwrap();
    let package = place.path().join("feedwright");
    std::fs::create_dir(&package).unwrap();
    for file in std::fs::read_dir(root().join("python/feedwright")).unwrap() {
        let file = file.unwrap().path();
        if file.is_file() {
            std::fs::copy(&file, package.join(file.file_name().unwrap())).unwrap();
        }
    }
    std::fs::copy(&built, package.join("_feedwright.abi3.so")).unwrap();
    let ran = Command::new(python)
        .arg(root().join("python/tests").join(tests))
        .env("PYTHONPATH", place.path())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .env("FEEDWRIGHT_DOCS", root().join("docs"))
        .env("FEEDWRIGHT_PARTS", root().join("parts"))
        .current_dir(root())
        .output()
        .unwrap();
    let reported = String::from_utf8_lossy(&ran.stderr);
    assert!(
        ran.status.success() && reported.contains("\nOK"),
        "{reported}{}",
        String::from_utf8_lossy(&ran.stdout)
    );
}
