//! Layers: the `mod` lines of every file stand in the order in which data flows, and a file uses
//! only files above it. A parent and its children belong together. Methods count, too:
//! `self.arc(..)` is a use of the file that implements `arc`.

use std::path::Path;

use crate::layers::{File, check, files};

/// Types whose methods stand in many files, and how a value of them is called.
const SPREAD: [(&str, &str); 3] = [
    ("Interpreter", "interpreter"),
    ("Flow", "flow"),
    ("Reader", "reader"),
];

#[test]
fn a_file_uses_only_files_above_it() {
    let files = files(Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/src")));
    assert!(
        files.len() > 80,
        "lib.rs and its modules list {} files",
        files.len()
    );
    let (violations, seen) = check(&files, &SPREAD, &[]);
    assert!(
        seen > 10 * files.len(),
        "{seen} uses in {} files, was anything read?",
        files.len()
    );
    assert!(violations.is_empty(), "{}", violations.join("\n"));
}

#[test]
fn a_use_from_below_is_found_however_it_is_written() {
    let found = |upper: &str| {
        let lower = "impl Interpreter {\n    pub(crate) fn arc(&mut self) {}\n}\n";
        let files = [
            File::new("state", "mod frame;"),
            File::new("state/frame", upper),
            File::new("motion", lower),
        ];
        check(&files, &SPREAD, &[]).0
    };
    let used = ["state/frame.rs:1: uses motion, which stands below it"];
    assert_eq!(found("use crate::motion::Speed;"), used);
    assert_eq!(
        found("use crate::{state, motion::{Speed, self}};"),
        [used[0], used[0]]
    );
    assert_eq!(found("fn f(speed: crate::motion::Speed) {}"), used);
    assert_eq!(found("use super::super::motion::Speed;"), used);
    assert_eq!(
        found("fn f(interpreter: &mut Interpreter) { interpreter.arc(); }"),
        used
    );
    assert_eq!(
        found("impl Interpreter {\n    fn f(&self) { self.arc() }\n}").len(),
        1
    );
    assert_eq!(found("use crate::Reader;").len(), 1);
    for fine in [
        "use crate::state::Interpreter;",
        "use super::Interpreter;",
        "// crate::motion\nlet s = \"crate::motion\";",
        "impl Flow {\n    fn f(&self) { self.arc() }\n}",
        "impl Interpreter {\n    fn f(&self) { self.arc.here() }\n}",
    ] {
        assert_eq!(found(fine), [""; 0], "{fine}");
    }
}
