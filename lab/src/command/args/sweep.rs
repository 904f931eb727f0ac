//! Options of the commands that compare controllers with the uncorrected cut on many machines.

use std::path::PathBuf;

use clap::Args;

/// A number of cuts.
pub(super) fn at_least_one(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if count > 0 => Ok(count),
        _ => Err("it must be a whole number from 1 on".to_owned()),
    }
}

/// The one controller of a command.
#[derive(Debug, Args)]
pub(crate) struct OneController {
    /// Controller; `feedwright-lab controllers` lists them.
    #[arg(long, value_name = "NAME", default_value = feedwright::BEST)]
    pub(crate) controller: String,
}

/// Options of a comparison with the uncorrected cut.
#[derive(Debug, Args)]
pub(crate) struct SweepArgs {
    /// Set a parameter of the controller, such as knots=10; may be given several times.
    /// `feedwright-lab controllers NAME` lists them.
    #[arg(long, value_name = "PARAMETER=VALUE")]
    pub(crate) set: Vec<String>,
    /// Seed of the recording that machines are identified from, and of the sample.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Threads; all cores where it is left out. The result does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Folder of finished cuts, so that an interrupted run continues [default: in the cache, until
    /// the run is complete].
    #[arg(long, value_name = "FOLDER")]
    pub(crate) results: Option<PathBuf>,
    /// Write all cuts.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) json: Option<PathBuf>,
}
