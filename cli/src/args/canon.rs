//! Options of `feedwright canon`.

use std::path::PathBuf;

use clap::Args;

use super::reader::ReaderArgs;

#[derive(Debug, Args)]
pub(crate) struct CanonArgs {
    /// G-code program.
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}
