//! Options of `feedwright check`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::reader::ReaderArgs;

/// Report all mistakes in programs, machine files and model files
///
/// Of a folder, in all programs in it and below. Nothing is cut.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright check part.ngc mine.toml
  feedwright check --format sarif programs > mistakes.sarif

Exit codes: 0 warnings at most; 1 mistakes; 2 a file that cannot be read.")]
pub(crate) struct CheckArgs {
    /// G-code programs, machine files (.toml), model files (.model.toml), and folders of programs.
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Format of the mistakes: text for people; json, sarif (2.1.0) and github (annotations of a
    /// workflow) on the standard output.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

/// Output format of the mistakes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    Text,
    Json,
    Sarif,
    Github,
}
