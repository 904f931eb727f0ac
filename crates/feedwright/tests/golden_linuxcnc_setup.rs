//! `linuxcnc setup` on configurations of every kind: what it says and what it writes, as
//! tests/linuxcnc/NAME/expected.txt has it. FEEDWRIGHT_UPDATE_DOCUMENTS=1 writes these files anew.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use crate::command::Folder;

/// A configuration, whether it is wired, and options.
const CASES: [(&str, u8, &[&str]); 15] = [
    ("mesa-servo-inch", 0, &[]),
    ("analog-servo", 0, &["--raise-ferror", "4"]),
    ("stepper-with-encoders", 0, &[]),
    ("ethercat", 0, &[]),
    (
        "simulated",
        0,
        &["--simulate", "tnv40", "--raise-ferror", "6"],
    ),
    ("mesa-servo-inch", 1, &["--simulate", "tnv40"]),
    ("mesa-stepper", 1, &[]),
    ("gantry", 0, &[]),
    ("rotary", 0, &[]),
    ("lathe", 1, &[]),
    ("delta", 1, &[]),
    ("tcl", 1, &[]),
    ("broken", 1, &[]),
    ("old-names", 1, &[]),
    ("missing-hal", 2, &[]),
];

fn fixture(name: &str) -> PathBuf {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/linuxcnc")).join(name)
}

/// The files of a folder.
pub(crate) fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    let file = |entry: std::fs::DirEntry| {
        entry.path().is_file().then(|| {
            (
                entry.file_name().into_string().unwrap(),
                std::fs::read(entry.path()).unwrap(),
            )
        })
    };
    entries.filter_map(file).collect()
}

/// A folder with a copy of a fixture.
pub(crate) fn copied(name: &str) -> Folder {
    let folder = Folder::new();
    for (file, bytes) in files(&fixture(name))
        .into_iter()
        .filter(|(file, _)| !file.starts_with("expected"))
    {
        folder.file(&file, bytes);
    }
    folder
}

#[test]
fn what_setup_says_and_writes_is_as_it_was() {
    for (name, code, options) in CASES {
        let folder = copied(name);
        let before = files(folder.path());
        let ran = folder.run(&[&["linuxcnc", "setup", "my.ini"], options].concat());
        assert_eq!(
            ran.code,
            Some(i32::from(code)),
            "{name}: {}{}",
            ran.stdout,
            ran.stderr
        );
        let mut text = ran.stdout + &ran.stderr;
        for (file, bytes) in files(folder.path()) {
            match before.get(&file) {
                Some(old) => assert_eq!(*old, bytes, "{name}: setup changed {file}"),
                None if file.ends_with(".fwmodel") => {
                    writeln!(text, "==> {file}: {} bytes", bytes.len()).unwrap();
                }
                None if file.ends_with(".files") || file.ends_with(".sh") => {
                    writeln!(text, "==> {file}").unwrap();
                }
                None => write!(text, "==> {file}\n{}", String::from_utf8(bytes).unwrap()).unwrap(),
            }
        }
        let place = fixture(name).join(if options.contains(&"--simulate") && code == 1 {
            "expected-simulate.txt"
        } else {
            "expected.txt"
        });
        if std::env::var_os("FEEDWRIGHT_UPDATE_DOCUMENTS").is_some() {
            std::fs::write(&place, &text).unwrap();
        }
        let expected = std::fs::read_to_string(&place).unwrap_or_default();
        let difference = expected
            .lines()
            .zip(text.lines())
            .find(|(old, new)| old != new);
        assert!(
            text == expected,
            "{name}: first difference: {difference:?}\n{text}"
        );
    }
}
