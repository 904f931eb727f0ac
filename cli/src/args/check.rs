//! Options of `feedwright check`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::reader::ReaderArgs;

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// G-code programs, machine files (.toml), model files (.model.toml), and folders of programs.
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// How mistakes are told: text for people; json, sarif (2.1.0) and github (annotations of a workflow) on the standard output.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

/// How mistakes are told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    Text,
    Json,
    Sarif,
    Github,
}
