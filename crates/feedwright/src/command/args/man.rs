//! Options of `feedwright man`.

use std::path::PathBuf;

use clap::Args;

/// Write the manual pages
///
/// One for feedwright and one for each of its commands, as in feedwright-run.1.
#[derive(Debug, Args)]
#[command(
    after_long_help = "Example:\n  feedwright man --out ~/.local/share/man/man1\n  man feedwright-run"
)]
pub(crate) struct ManArgs {
    /// Folder for the pages; made where it is missing.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}
