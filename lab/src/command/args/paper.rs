//! Options of `feedwright-lab paper`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;

/// Repeat the experiments of Lee, Cho and Jeon (2005)
///
/// Those of section 4, with Figures 7 to 10.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Example:
  feedwright-lab paper --out paper
  feedwright-lab paper --out paper --as-printed --draws 100")]
pub(crate) struct PaperArgs {
    /// Folder for the figures and paper.json; made where it is missing.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Machine: one that is built in (`feedwright machines` lists them), or a machine file (.toml).
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "tnv40")]
    pub(crate) machine: OsString,
    /// Number of seeds, from 1.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub(crate) seeds: u64,
    /// Cut as the paper prints it too: each departure of this repository undone alone, and all
    /// together; departures.json.
    #[arg(long)]
    pub(crate) as_printed: bool,
    /// Draw N times what the paper leaves open (step size, training set, disturbance), and give the
    /// ratios of Figure 8; draws.json.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..=10_000))]
    pub(crate) draws: Option<u64>,
}
