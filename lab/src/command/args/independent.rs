//! Options of `feedwright-lab independent`.
use std::path::PathBuf;

use clap::Args;
use feedwright::command::ReaderArgs;

/// Identify machines of other equations from their logs, and cut on them
///
/// Each machine cuts the program of `feedwright excite`. It is identified from the log alone. Parts
/// are then cut uncorrected, by the identified model, and with published controllers by the same
/// machine file.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Example:
  feedwright-lab independent --machine knee-mill --random 3 --seed 7 --json independent.json

Exit codes: 0 lqg-identified is nowhere worse than uncorrected; 1 it is; 2 an error.")]
pub(crate) struct IndependentArgs {
    /// G-code programs, and folders of programs. Without any, star, circle, square and slot of
    /// parts/.
    pub(crate) programs: Vec<PathBuf>,
    /// Machine: bench-router, knee-mill or machining-center; may be given several times. Without it
    /// all three, or none with --random.
    #[arg(long, value_name = "NAME")]
    pub(crate) machine: Vec<String>,
    /// Machines drawn around these three, by the seed.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) random: u32,
    /// Seed of the first machine that is drawn, and of the training.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Program that is recorded to identify from [default: what `feedwright excite` writes for the
    /// data sheet].
    #[arg(long, value_name = "FILE.ngc")]
    pub(crate) excitation: Option<PathBuf>,
    /// Leave the delay of the record open; without this option the identification gets the delay 0,
    /// which is true.
    #[arg(long)]
    pub(crate) open_delay: bool,
    /// Controller; may be given several times. Without it, lqg-identified, feedforward,
    /// cross-coupled and disturbance-observer.
    #[arg(long, value_name = "NAME")]
    pub(crate) controller: Vec<String>,
    /// Cut no more of a program than this time of machining, s.
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    pub(crate) limit_s: f64,
    /// Write all results.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) json: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}
