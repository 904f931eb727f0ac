//! Options of `feedwright diff`.

use std::path::PathBuf;

use clap::Args;

use super::reader::ReaderArgs;

/// Compare two results, or two programs
///
/// Figures before and after with their ratio. The page has both in one plot: the distribution of
/// the contour error of two runs, or the paths of two programs.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright diff before.json after.json --report diff.html
  feedwright diff part.ngc corrected.ngc")]
pub(crate) struct DiffArgs {
    /// JSON of run, correct or plan (.json), or a G-code program.
    #[arg(value_name = "BEFORE")]
    pub(crate) before: PathBuf,
    /// JSON of another run, or another program, to compare with BEFORE.
    #[arg(value_name = "AFTER")]
    pub(crate) after: PathBuf,
    /// Write a page: the figures and the plot.
    #[arg(long, value_name = "FILE.html")]
    pub(crate) report: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}
