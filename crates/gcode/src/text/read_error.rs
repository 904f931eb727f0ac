//! Why a file is no program at all.

use std::io;
use std::path::PathBuf;
use std::sync::Arc;

use thiserror::Error;

/// Why a program cannot be read at all.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum ReadError {
    /// No such file, no permission, or the disk fails.
    #[error("{path}: the program cannot be read: {cause}")]
    #[diagnostic(help(
        "give the path to the program from the current folder, or - for the standard input"
    ))]
    Io {
        /// Path as the user gave it.
        path: PathBuf,
        /// Error of the operating system.
        #[source]
        cause: io::Error,
    },
    /// A folder instead of a file.
    #[error("{path}: this is a folder, not a G-code program")]
    #[diagnostic(help("name a program in it; `feedwright check` takes folders"))]
    Directory {
        /// Path as the user gave it.
        path: PathBuf,
    },
    /// Bytes that no text has.
    #[error("{name}: byte {offset} is NUL: this is no G-code program but a binary file")]
    #[diagnostic(help("G-code is plain text; a slicer or CAM system exports it"))]
    Binary {
        /// Name as the user gave it.
        name: Arc<str>,
        /// Offset of the first NUL byte.
        offset: usize,
    },
    /// A file of another kind.
    #[error("{name}: this is {kind}, not a G-code program")]
    #[diagnostic(help("{hint}"))]
    OtherFile {
        /// Name as the user gave it.
        name: Arc<str>,
        /// Kind of file.
        kind: &'static str,
        /// Remedy.
        hint: &'static str,
    },
    /// Two bytes a character.
    #[error("{name}: the file is UTF-16 text, which no control reads")]
    #[diagnostic(help(
        "save it as UTF-8 or plain ASCII; editors ask for the encoding in \"Save as\""
    ))]
    Utf16 {
        /// Name as the user gave it.
        name: Arc<str>,
    },
    /// Nothing in it.
    #[error("{name}: the program is empty")]
    #[diagnostic(help(
        "the export may have failed; a program has at least a motion such as G1 X10 F100"
    ))]
    Empty {
        /// Name as the user gave it.
        name: Arc<str>,
    },
    /// Another language.
    #[error("{name}: line {line} is {language}, which this reader does not read: `{text}`")]
    #[diagnostic(help(
        "export the program as ISO G-code (RS-274), for instance with a LinuxCNC or Fanuc post-processor"
    ))]
    Refused {
        /// Name as the user gave it.
        name: Arc<str>,
        /// The control whose language it is.
        language: &'static str,
        /// The line that shows it, from 1.
        line: u32,
        /// Its text.
        text: String,
    },
    /// Signs of a mill and of a lathe, whose words cut different parts.
    #[error(
        "{name}: is this program for a mill or for a lathe? line {lathe_line} ({lathe}) is one of a lathe, line {mill_line} ({mill}) one of a mill"
    )]
    #[diagnostic(help(
        "say which: --dialect fanuc-lathe, haas-lathe or fanuc-mill; of lathes, G-code system A is read, in which U and W are distances and G90 is a cycle"
    ))]
    MillOrLathe {
        /// Name as the user gave it.
        name: Arc<str>,
        /// The first line that shows a lathe, from 1.
        lathe_line: u32,
        /// Sign of a lathe on that line.
        lathe: &'static str,
        /// The first line that shows a mill, from 1.
        mill_line: u32,
        /// Sign of a mill on that line.
        mill: &'static str,
    },
}
