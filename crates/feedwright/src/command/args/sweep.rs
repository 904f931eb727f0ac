//! Options of `feedwright sweep` and `feedwright merge`.

use std::path::PathBuf;

use clap::Args;

/// A part of the jobs: the `number`th, from 1, of `of` parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct JobShard {
    pub(crate) number: u64,
    pub(crate) of: u64,
}

fn shard(text: &str) -> Result<JobShard, String> {
    let numbers = text
        .split_once('/')
        .and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
    match numbers {
        Some((number, of)) if 0 < number && number <= of => Ok(JobShard { number, of }),
        _ => Err(
            "it must be the number of a part and how many parts there are, such as 3/8".to_owned(),
        ),
    }
}

/// Run many programs on many machines; go on where a sweep ended
///
/// JOBS.toml lists the jobs. Each is what `feedwright run` does, and its result is a file in
/// FOLDER, named by the content of everything that the job reads. A result that is there is not
/// computed again, so that a sweep that was killed goes on, and any number of computers may work on
/// one folder. docs/sweeps.md describes the list.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright sweep JOBS.toml --out results
  feedwright sweep JOBS.toml --out results --shard $SLURM_ARRAY_TASK_ID/100
  feedwright merge results --out results.csv

Exit codes: 0 done; 1 a job has mistakes, which its result contains; 2 an error: a result is missing.")]
pub(crate) struct SweepJobsArgs {
    /// List of the jobs.
    #[arg(value_name = "JOBS.toml")]
    pub(crate) jobs: PathBuf,
    /// Folder of the results.
    #[arg(long, value_name = "FOLDER")]
    pub(crate) out: PathBuf,
    /// Part of the jobs, such as 3/8 for the third of eight. A job belongs to the same part,
    /// whatever else is in the list.
    #[arg(long, value_name = "I/N", value_parser = shard)]
    pub(crate) shard: Option<JobShard>,
    /// Jobs at once; as many as there are cores where it is left out. The results do not depend on
    /// it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) workers: Option<u16>,
}

/// Write the results of sweeps as one table
///
/// One row for each job, sorted by program, machine and controller. A result that is in several
/// folders is one row.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright merge results --out results.csv
  feedwright merge shard-1 shard-2 --out results.jsonl")]
pub(crate) struct MergeArgs {
    /// Folders of results.
    #[arg(value_name = "FOLDER", required = true)]
    pub(crate) folders: Vec<PathBuf>,
    /// Place of the table: .csv, or .jsonl for an object a line.
    #[arg(long, value_name = "FILE.csv|FILE.jsonl")]
    pub(crate) out: PathBuf,
}
