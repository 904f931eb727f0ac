//! Options of `feedwright canon`.

use std::path::PathBuf;

use clap::Args;

use super::reader::ReaderArgs;

/// Print the motions of a program, one JSON object a line
///
/// Modes, offsets, loops, subroutines, cycles and compensation are resolved; lengths are in mm,
/// feedrates in mm/s.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Example:
  feedwright canon part.ngc | jq -c 'select(.kind == \"feed\")'")]
pub(crate) struct CanonArgs {
    /// G-code program.
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}
