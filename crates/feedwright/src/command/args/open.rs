//! Options of `feedwright open`.

use std::path::PathBuf;

use clap::Args;

/// Show the page in a browser: see the cut, correct the program
///
/// The page is a part of this command and needs no network. It is served to this computer only, at an address that holds a secret, until
/// Ctrl-C. Everything is computed in the browser.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright open
  feedwright open part.ngc mine.toml
  feedwright open --no-browser part.ngc")]
pub(crate) struct OpenArgs {
    /// G-code program to begin with, and a machine file (.toml).
    #[arg(value_name = "FILES")]
    pub(crate) files: Vec<PathBuf>,
    /// Print the address only.
    #[arg(long)]
    pub(crate) no_browser: bool,
}
