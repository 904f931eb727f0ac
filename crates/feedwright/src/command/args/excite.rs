//! Options of `feedwright excite`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;

/// Write a program to record a log with, for identify
///
/// Run it on the machine in the air, record commanded and actual positions meanwhile, and give the log to `feedwright identify`. The
/// first lines of the program say what to check before.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Example:
  feedwright excite --machine limits.toml --travel 40 --out excite.ngc")]
pub(crate) struct ExciteArgs {
    /// Machine whose limits the program keeps: one that is built in, or a machine file (.toml).
    #[arg(long, value_name = "NAME|LIMITS.toml")]
    pub(crate) machine: OsString,
    /// Travel of each axis, mm: half of it on each side of where the machine stands.
    #[arg(long, value_name = "MM", default_value_t = feedwright_ident::ExciteOptions::default().travel_mm, allow_negative_numbers = true)]
    pub(crate) travel: f64,
    /// Place of the program.
    #[arg(long, value_name = "FILE.ngc")]
    pub(crate) out: PathBuf,
}
