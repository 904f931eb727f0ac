//! A program that can be read as often as it takes.

use std::borrow::Cow;
use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::flow::reader::Reader;
use crate::flow::summary::{CheckError, Summary, summarize};
use crate::settings::Settings;
use crate::text::input;
use crate::text::read_error::ReadError;

/// A G-code program: text in memory, or a file that is opened anew for each reading, so that a long
/// program takes no memory.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program(ProgramPlace);

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum ProgramPlace {
    Text { name: String, text: Arc<str> },
    File(PathBuf),
}

impl Program {
    /// The program in `text`; messages call it `name`. Bytes that are no UTF-8, which only comments
    /// have, become U+FFFD.
    pub fn from_text(name: impl Into<String>, text: impl AsRef<[u8]>) -> Self {
        Self(ProgramPlace::Text {
            name: name.into(),
            text: String::from_utf8_lossy(text.as_ref()).into(),
        })
    }

    /// The program in a file; `-` is the standard input, which is read once and kept. Nothing is
    /// opened yet.
    pub fn in_file(path: impl Into<PathBuf>) -> Self {
        Self(ProgramPlace::File(path.into()))
    }

    /// Returns the name that messages use: the path as the user gave it.
    pub fn name(&self) -> String {
        match &self.0 {
            ProgramPlace::Text { name, .. } => name.clone(),
            ProgramPlace::File(path) => input::name(path),
        }
    }

    /// Returns the name that reports use: the file name without its folder.
    pub fn file_name(&self) -> String {
        let name = self.name();
        Path::new(&name)
            .file_name()
            .map_or(Cow::from(&name), |last| last.to_string_lossy())
            .into_owned()
    }

    /// The file that it is in; none for a text and for the standard input.
    pub fn path(&self) -> Option<&Path> {
        match &self.0 {
            ProgramPlace::Text { .. } => None,
            ProgramPlace::File(path) => {
                Some(path.as_path()).filter(|path| !input::is_standard_input(path))
            }
        }
    }

    /// Begins to read it.
    ///
    /// # Errors
    /// A file that cannot be read, and what is no G-code program.
    pub fn reader(&self, settings: Settings) -> Result<Reader, ReadError> {
        match &self.0 {
            ProgramPlace::Text { name, text } => Reader::from_text(name, text.as_bytes(), settings),
            ProgramPlace::File(path) => Reader::open(path, settings),
        }
    }

    /// Runs through it.
    ///
    /// # Errors
    /// All faults of the program, up to [`Settings::max_errors`].
    pub fn check(&self, settings: Settings) -> Result<Summary, CheckError> {
        summarize(self.reader(settings).map_err(CheckError::Read)?)
    }

    /// Its text from the beginning, and how long that is, bytes.
    ///
    /// # Errors
    /// What the operating system says of the file.
    pub fn text(&self) -> io::Result<(Box<dyn BufRead + '_>, u64)> {
        let bytes = match &self.0 {
            ProgramPlace::Text { text, .. } => text.as_bytes(),
            ProgramPlace::File(path) if input::is_standard_input(path) => input::standard_input()?,
            ProgramPlace::File(path) => {
                let file = File::open(path)?;
                let size = file.metadata()?.len();
                return Ok((Box::new(BufReader::new(file)), size));
            }
        };
        Ok((Box::new(bytes), bytes.len() as u64))
    }
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use super::*;

    #[test]
    fn text_and_file_give_the_same_steps() {
        let text = "G21 G90 F600\nG1 X10 (\u{e4})\nM2\n";
        let file = tempfile::NamedTempFile::new().unwrap();
        std::fs::write(file.path(), text).unwrap();
        let programs = [
            Program::from_text("part.ngc", text),
            Program::in_file(file.path()),
        ];
        let read = |program: &Program| {
            let steps: Vec<_> = program
                .reader(Settings::default())
                .unwrap()
                .map(Result::unwrap)
                .collect();
            let mut all = String::new();
            let (mut whole, size) = program.text().unwrap();
            whole.read_to_string(&mut all).unwrap();
            assert_eq!((all.as_str(), size), (text, text.len() as u64));
            steps
        };
        assert_eq!(read(&programs[0]), read(&programs[1]));
        assert_eq!(programs[0].name(), "part.ngc");
        assert_eq!(programs[1].path(), Some(file.path()));
    }

    #[test]
    fn a_report_names_the_file_without_its_folder() {
        assert_eq!(Program::in_file("parts/star.ngc").file_name(), "star.ngc");
        assert_eq!(Program::in_file("-").file_name(), "standard input");
        assert_eq!(Program::in_file("-").path(), None);
    }
}
