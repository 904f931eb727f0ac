//! Licenses and sources of everything that is built are those that deny.toml allows, and the HAL
//! component links next to nothing.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Command;

use serde_json::Value;

/// Packages that the HAL component may link besides our own crates.
const IN_SERVO_THREAD: [&str; 1] = ["libm"];
/// Packages of a build for one platform: fewer mean that nothing was read.
const LEAST_PACKAGES: usize = 80;

fn root() -> PathBuf {
    PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
}

fn table(path: &Path) -> toml::Table {
    std::fs::read_to_string(path).unwrap().parse().unwrap()
}

fn texts(value: &toml::Value) -> Vec<String> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|text| text.as_str().unwrap().to_owned())
        .collect()
}

/// The packages that this platform needs, as cargo has resolved them. They were built before this
/// test, so that nothing is fetched.
fn packages() -> Vec<Value> {
    let rustc = Command::new("rustc").arg("-vV").output().unwrap();
    let reported = String::from_utf8(rustc.stdout).unwrap();
    let host = reported
        .lines()
        .find_map(|line| line.strip_prefix("host: "))
        .unwrap();
    let ran = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--format-version",
            "1",
            "--locked",
            "--offline",
            "--filter-platform",
            host,
        ])
        .current_dir(root())
        .output()
        .unwrap();
    assert!(
        ran.status.success(),
        "{}",
        String::from_utf8_lossy(&ran.stderr)
    );
    let metadata: Value = serde_json::from_slice(&ran.stdout).unwrap();
    metadata["packages"].as_array().unwrap().clone()
}

/// Returns true if these licenses fulfill an SPDX expression: every part between `AND` has an
/// allowed license.
fn permits(expression: &str, allowed: &[String]) -> bool {
    expression
        .replace(" / ", " OR ")
        .replace('/', " OR ")
        .split(" AND ")
        .all(|part| {
            let part = part.trim_matches(['(', ')', ' ']);
            part.split(" OR ")
                .any(|license| allowed.iter().any(|allowed| allowed == license.trim()))
        })
}

#[test]
fn every_dependency_has_an_allowed_license_and_comes_from_an_allowed_registry() {
    let deny = table(&root().join("deny.toml"));
    let allowed = texts(&deny["licenses"]["allow"]);
    let registries: Vec<String> = texts(&deny["sources"]["allow-registry"])
        .iter()
        .map(|registry| format!("registry+{registry}"))
        .collect();
    let packages = packages();
    assert!(
        packages.len() >= LEAST_PACKAGES,
        "{} packages",
        packages.len()
    );
    for package in packages {
        let name = package["name"].as_str().unwrap();
        let license = package["license"].as_str().unwrap_or("none");
        assert!(
            permits(license, &allowed),
            "{name} has the license {license}"
        );
        let source = package["source"].as_str();
        let is_ours = source.is_none() && name.starts_with("feedwright");
        assert!(
            is_ours
                || source.is_some_and(|source| registries.iter().any(|allowed| allowed == source)),
            "{name}: {source:?}"
        );
    }
}

#[test]
fn licenses_that_are_not_allowed_are_refused() {
    let allowed = ["MIT".to_owned(), "Unicode-3.0".to_owned()];
    for (expression, is_permitted) in [
        ("MIT", true),
        ("Apache-2.0/MIT", true),
        ("(MIT OR Apache-2.0) AND Unicode-3.0", true),
        ("MIT AND GPL-3.0-only", false),
        ("GPL-3.0-only", false),
        ("none", false),
    ] {
        assert_eq!(permits(expression, &allowed), is_permitted, "{expression}");
    }
}

#[test]
fn a_servo_thread_links_our_crates_and_the_functions_of_libm() {
    for manifest in ["linuxcnc/hal", "linuxcnc/servo", "crates/control"] {
        let manifest = table(&root().join(manifest).join("Cargo.toml"));
        for name in manifest["dependencies"].as_table().unwrap().keys() {
            assert!(
                name.starts_with("feedwright-") || IN_SERVO_THREAD.contains(&name.as_str()),
                "{name}"
            );
        }
        assert!(!manifest.contains_key("build-dependencies"));
    }
}

/// Returns the packages that a package of ours needs by a lock file, without versions.
fn locked<'a>(lock: &'a toml::Table, name: &str) -> Option<BTreeSet<&'a str>> {
    let package = lock["package"]
        .as_array()
        .unwrap()
        .iter()
        .find(|package| package["name"].as_str() == Some(name))?;
    let needed = package
        .get("dependencies")
        .and_then(toml::Value::as_array)
        .into_iter()
        .flatten();
    Some(
        needed
            .map(|text| text.as_str().unwrap().split(' ').next().unwrap())
            .collect(),
    )
}

/// Returns the packages that a manifest needs on any platform: always, and with all features.
fn needed(manifest: &toml::Table) -> [BTreeSet<&str>; 2] {
    let platforms = manifest
        .get("target")
        .and_then(toml::Value::as_table)
        .into_iter()
        .flat_map(|table| table.values());
    let tables = std::iter::once(&manifest["dependencies"])
        .chain(platforms.map(|platform| &platform["dependencies"]));
    let all: Vec<(&String, &toml::Value)> =
        tables.flat_map(|table| table.as_table().unwrap()).collect();
    let is_optional =
        |value: &toml::Value| value.get("optional").and_then(toml::Value::as_bool) == Some(true);
    let always = all.iter().filter(|(_, value)| !is_optional(value));
    [
        always.map(|(name, _)| name.as_str()).collect(),
        all.iter().map(|(name, _)| name.as_str()).collect(),
    ]
}

/// No command of this workspace reads the lock files of the other two, so that only their own
/// builds would find them out of date.
#[test]
fn every_lock_file_knows_what_our_crates_need() {
    let mut compared = 0;
    for folder in std::fs::read_dir(root().join("crates")).unwrap() {
        let manifest = table(&folder.unwrap().path().join("Cargo.toml"));
        let name = manifest["package"]["name"].as_str().unwrap();
        let [always, all] = needed(&manifest);
        for workspace in ["linuxcnc", "fuzz"] {
            let lock = table(&root().join(workspace).join("Cargo.lock"));
            if let Some(locked) = locked(&lock, name) {
                assert!(
                    always.is_subset(&locked) && locked.is_subset(&all),
                    "{workspace}/Cargo.lock says that {name} needs {locked:?}, its manifest {all:?}; \
                     `cargo metadata --offline` in {workspace} mends it"
                );
                compared += 1;
            }
        }
    }
    assert!(compared >= 7, "{compared} packages");
}
