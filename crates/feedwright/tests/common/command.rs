//! Runs the command as a user does: in a folder of its own, looking at nothing but files, exit code
//! and what is printed.

use std::collections::BTreeMap;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use tempfile::TempDir;

/// Path of the command under test, from the package that the test belongs to.
const BINARY: &str = match (
    option_env!("CARGO_BIN_EXE_feedwright"),
    option_env!("CARGO_BIN_EXE_feedwright-lab"),
) {
    (Some(binary), _) | (None, Some(binary)) => binary,
    (None, None) => panic!("the package has no command"),
};

/// A part that every test may cut: a circle of 2 mm radius at 20 mm/s, done in under a second of
/// machining.
pub(crate) const CIRCLE: &str = "G21 G17 G90 G94 G64\nG0 X0 Y0\nG2 X0 Y0 I2 J0 F1200\nM2\n";

/// A working folder.
pub(crate) struct Folder(TempDir);

impl Folder {
    /// A folder in which `circle.ngc` is the only file.
    pub(crate) fn new() -> Self {
        let folder = Self(tempfile::tempdir().unwrap());
        folder.file("circle.ngc", CIRCLE);
        folder
    }

    pub(crate) fn path(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn file(&self, name: impl AsRef<Path>, content: impl AsRef<[u8]>) {
        std::fs::write(self.path().join(name), content).unwrap();
    }

    pub(crate) fn read(&self, name: impl AsRef<Path>) -> Vec<u8> {
        std::fs::read(self.path().join(name)).unwrap()
    }

    pub(crate) fn text(&self, name: impl AsRef<Path>) -> String {
        String::from_utf8(self.read(name)).unwrap()
    }

    /// Everything in the folder, hidden or not, with its content.
    pub(crate) fn content(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let mut found = BTreeMap::new();
        let mut folders = vec![self.path().to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                let kind = std::fs::symlink_metadata(&path).unwrap();
                if kind.is_dir() {
                    folders.push(path.clone());
                }
                let content = if kind.is_file() {
                    std::fs::read(&path).unwrap()
                } else {
                    Vec::new()
                };
                found.insert(path, content);
            }
        }
        found
    }

    /// The command, to be run here. Trained identifiers are kept from one test run to the next.
    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(BINARY);
        command.current_dir(self.path()).env(
            "FEEDWRIGHT_CACHE",
            Path::new(env!("CARGO_TARGET_TMPDIR")).join("cache"),
        );
        command
    }

    /// Runs the command to its end.
    pub(crate) fn run<S: AsRef<OsStr>>(&self, arguments: &[S]) -> Ran {
        Ran::from(self.command().args(arguments).output().unwrap())
    }

    /// Cuts without a controller, which needs no training.
    pub(crate) fn run_uncorrected<S: AsRef<OsStr>>(&self, arguments: &[S]) -> Ran {
        let mut all: Vec<OsString> = ["run", "--controller", "uncorrected"]
            .map(OsString::from)
            .to_vec();
        all.extend(
            arguments
                .iter()
                .map(|argument| argument.as_ref().to_owned()),
        );
        self.run(&all)
    }
}

/// Result of a run of the command.
#[derive(Debug)]
pub(crate) struct Ran {
    pub(crate) code: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl From<Output> for Ran {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
        }
    }
}

impl Ran {
    /// It went well.
    pub(crate) fn succeeded(self) -> Self {
        assert_eq!(self.code, Some(0), "{self:?}");
        self
    }

    /// Returns its stdout as one line: lines are wrapped to the width of the terminal.
    pub(crate) fn reported(&self) -> String {
        self.stdout.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// Returns its stderr as one line.
    pub(crate) fn remarked(&self) -> String {
        self.stderr.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// It ended with an error that says all of `says`, and printed nothing else.
    pub(crate) fn refused(&self, says: &[&str]) {
        self.ended(2, says);
    }

    /// `check` found mistakes, says all of `says`, and printed nothing else.
    pub(crate) fn faulty(&self, says: &[&str]) {
        self.ended(1, says);
    }

    fn ended(&self, code: i32, says: &[&str]) {
        assert_eq!(self.code, Some(code), "{self:?}");
        assert_eq!(self.stdout, "", "{self:?}");
        assert!(
            !self.stderr.contains("panicked") && !self.stderr.contains('\u{1b}'),
            "{}",
            self.stderr
        );
        // Messages are wrapped to the width of the terminal.
        let message = self
            .stderr
            .split(|c: char| c.is_whitespace() || c == '│')
            .filter(|word| !word.is_empty());
        let message = message.collect::<Vec<_>>().join(" ");
        for part in says {
            assert!(
                message.contains(part),
                "not reported: {part}\n{}",
                self.stderr
            );
        }
    }
}

/// Says that a check was not made, where people look.
pub(crate) fn skipped(what: &str) {
    eprintln!("SKIPPED: {what}");
}
