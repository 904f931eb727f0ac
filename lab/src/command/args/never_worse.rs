//! Options of `feedwright-lab never-worse`.
use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;
use feedwright::command::ReaderArgs;

use super::sweep::{OneController, SweepArgs, at_least_one};

/// Find programs and machines where a correction does harm
///
/// Each program is cut on each machine, uncorrected and corrected.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Example:
  feedwright-lab never-worse parts --sample 100 --limit-s 60

Exit codes: 0 nothing is worse; 1 a cut is; 2 an error.")]
pub(crate) struct NeverWorseArgs {
    /// G-code programs, and folders of programs.
    #[arg(required = true)]
    pub(crate) programs: Vec<PathBuf>,
    /// Only programs whose path fits this pattern, such as '*circle*'.
    #[arg(long, value_name = "GLOB")]
    pub(crate) only: Option<String>,
    /// Machine to cut on: built-in, or a machine file; may be given several times. Without it, 19
    /// variants of tnv40.
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) machine: Vec<OsString>,
    /// Cut no more of a program than this time of machining on tnv40, s.
    #[arg(long, value_name = "S", default_value_t = 600.0)]
    pub(crate) limit_s: f64,
    /// Cut N of all pairs of program and machine, drawn by the seed.
    #[arg(long, value_name = "N", value_parser = at_least_one)]
    pub(crate) sample: Option<usize>,
    #[command(flatten)]
    pub(crate) one: OneController,
    #[command(flatten)]
    pub(crate) sweep: SweepArgs,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}
