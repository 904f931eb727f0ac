//! `linuxcnc setup` leaves the original as it is, can be repeated and undone, and replaces nothing
//! that was changed by hand. Every sample configuration of Debian's LinuxCNC is wired, or refused
//! with a reason.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use feedwright::{HALLIB, LinuxcncSetup, LinuxcncSetupError};

use crate::golden_linuxcnc_setup::copied;
use crate::missing::missing;

const SETUP: [&str; 3] = ["linuxcnc", "setup", "my.ini"];
/// Debian's folder of the samples.
const SAMPLES: &str = "/usr/share/doc/linuxcnc/examples/sample-configs";

#[test]
fn setup_is_repeated_and_undone_without_a_trace() {
    let folder = copied("mesa-servo-inch");
    let before = folder.content();
    folder.run(&SETUP).succeeded();
    let wired = folder.content();
    assert!(wired.len() > before.len() + 5, "{:?}", wired.keys());
    assert!(
        before.iter().all(|(path, bytes)| wired[path] == *bytes),
        "an original was changed"
    );
    folder.run(&SETUP).succeeded();
    assert_eq!(folder.content(), wired, "a second setup changed something");
    folder
        .run(&["linuxcnc", "setup", "my.ini", "--dry-run"])
        .succeeded();
    assert_eq!(folder.content(), wired);
    folder
        .run(&["linuxcnc", "setup", "my.ini", "--undo"])
        .succeeded();
    assert_eq!(folder.content(), before);
    folder
        .run(&["linuxcnc", "setup", "my.ini", "--undo"])
        .refused(&["nothing to undo", "name the INI file that setup was given"]);
}

#[test]
fn what_was_changed_by_hand_is_neither_replaced_nor_removed() {
    let folder = copied("ethercat");
    folder.run(&SETUP).succeeded();
    folder.file(
        "my-feedwright.ini",
        folder
            .text("my-feedwright.ini")
            .replace("ENABLE = 0", "ENABLE = 1"),
    );
    let changed = folder.content();
    folder.run(&SETUP).refused(&[
        "changed by hand since the last setup: my-feedwright.ini",
        "--replace",
    ]);
    assert_eq!(folder.content(), changed);
    let undone = folder
        .run(&["linuxcnc", "setup", "my.ini", "--undo"])
        .succeeded();
    assert!(
        undone
            .reported()
            .contains("kept my-feedwright.ini, which was changed by hand"),
        "{undone:?}"
    );
    folder
        .run(&SETUP)
        .refused(&["my-feedwright.ini is there already, and setup did not write it"]);
    folder
        .run(&["linuxcnc", "setup", "my.ini", "--replace"])
        .succeeded();
    assert!(folder.text("my-feedwright.ini").contains("ENABLE = 0"));
}

#[test]
fn the_copy_is_not_wired_again() {
    let folder = copied("ethercat");
    folder.run(&SETUP).succeeded();
    let ran = folder.run(&["linuxcnc", "setup", "my-feedwright.ini"]);
    assert_eq!(ran.code, Some(1));
    assert!(
        ran.reported()
            .contains("give setup the original INI file, not the copy"),
        "{ran:?}"
    );
}

#[test]
fn nothing_is_written_where_a_file_cannot_be() {
    let folder = copied("ethercat");
    std::fs::create_dir(folder.path().join("my-feedwright.toml")).unwrap();
    let before = folder.content();
    folder
        .run(&SETUP)
        .refused(&["cannot write", "my-feedwright.toml", "it is a directory"]);
    assert_eq!(folder.content(), before);
}

#[test]
fn the_machine_file_is_one_that_excite_takes() {
    for name in [
        "mesa-servo-inch",
        "analog-servo",
        "ethercat",
        "stepper-with-encoders",
    ] {
        let folder = copied(name);
        folder.run(&SETUP).succeeded();
        folder
            .run(&[
                "excite",
                "--machine",
                "my-feedwright.toml",
                "--out",
                "excite.ngc",
            ])
            .succeeded();
        folder
            .run(&["check", "my-feedwright.toml", "excite.ngc"])
            .succeeded();
    }
}

/// All INI files below a folder.
fn ini_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            ini_files(&path, found);
        } else if path.extension().is_some_and(|ending| ending == "ini") {
            found.push(path);
        }
    }
}

#[test]
fn every_sample_of_debian_is_wired_or_refused_with_the_reason() {
    if !Path::new(SAMPLES).is_dir() {
        return missing("LinuxCNC's sample configurations are not installed");
    }
    let mut samples = Vec::new();
    ini_files(Path::new(SAMPLES), &mut samples);
    samples.sort();
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let mut count = |what: String| *counts.entry(what).or_default() += 1;
    for ini in &samples {
        let mut setup = LinuxcncSetup {
            ini: ini.clone(),
            hallib: HALLIB.into(),
            simulate: None,
            raise_ferror: None,
            replace: false,
        };
        let plain = setup.survey();
        setup.simulate = Some("tnv40".to_owned());
        match (plain, setup.survey()) {
            (Ok(plain), _) if plain.is_wired() => count("wired".to_owned()),
            (Ok(_), Ok(simulated)) if simulated.is_wired() => {
                count("wired with --simulate".to_owned());
            }
            (Ok(plain), _) => {
                assert!(
                    !plain.refusals.is_empty() && plain.refusals.iter().all(|why| why.len() > 40),
                    "{}",
                    ini.display()
                );
                count(format!("refused: {}", kind_of(&plain.refusals[0])));
            }
            (Err(LinuxcncSetupError::Unreadable { path, .. }), _) => {
                assert!(!path.exists(), "{}: {}", ini.display(), path.display());
                count("not read: a file that it names is missing".to_owned());
            }
            (Err(other), _) => panic!("{}: {other}", ini.display()),
        }
    }
    for (what, number) in &counts {
        eprintln!("{number:4} {what}");
    }
    assert_eq!(counts.values().sum::<usize>(), samples.len());
    assert!(
        samples.len() > 250 && counts["wired"] > 10 && counts["wired with --simulate"] > 30,
        "{counts:?}"
    );
}

/// A refusal without the names in it.
fn kind_of(refusal: &str) -> &'static str {
    const KINDS: [(&str, &str); 9] = [
        ("Tcl program", "a HAL file is a Tcl program"),
        ("TWOPASS", "TWOPASS"),
        ("no HALFILE", "no HALFILE"),
        ("the kinematics is", "kinematics other than trivial"),
        ("has room for", "too many joints that pass through"),
        ("no X or no Y", "a lathe or a single axis"),
        ("steps that were sent", "step generators without encoders"),
        ("does not know whether", "an unknown position"),
        ("connected to nothing", "a joint that is not connected"),
    ];
    KINDS
        .iter()
        .find(|(words, _)| refusal.contains(words))
        .map_or("another reason", |(_, kind)| kind)
}
