//! Options of the commands that compare controllers with the uncorrected cut on many machines.

use std::path::PathBuf;

use clap::Args;

use crate::compare::Shard;

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

/// How controllers are compared with the uncorrected cut.
#[derive(Debug, Args)]
pub(crate) struct SweepArgs {
    /// Set a parameter of the controller, such as knots=10; may be given several times. `feedwright-lab controllers NAME` lists them.
    #[arg(long, value_name = "PARAMETER=VALUE")]
    pub(crate) set: Vec<String>,
    /// Seed of the recording that machines are identified from, and of the sample.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Threads; all cores where it is left out. The result does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Where finished cuts are kept, so that an interrupted run goes on [default: in the cache, by version].
    #[arg(long, value_name = "FILE.jsonl")]
    pub(crate) journal: Option<PathBuf>,
    /// Cut the i-th of n parts of the cuts alone. Give each part a --journal; the same command with --merge makes the table of all.
    #[arg(long, value_name = "I/N", requires = "journal")]
    pub(crate) shard: Option<Shard>,
    /// Journals of shards, or of other runs of the same version: what they have is not cut again.
    #[arg(long, value_name = "FILE.jsonl,...", value_delimiter = ',')]
    pub(crate) merge: Vec<PathBuf>,
    /// Write all cuts.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) json: Option<PathBuf>,
}
