//! Options of `feedwright-lab mismatch`.
use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;
use feedwright::command::ReaderArgs;

use super::sweep::SweepArgs;

/// Cut by a model of one machine on machines that differ from it
///
/// Each controller is made for the machine: from a model that is identified on it, or from its
/// values. Then each program is cut on variants: inertia, friction, gains, feedforward and delay,
/// alone and together. A controller of which nothing is set has the values that a search has found
/// for the machine and that are recorded; without such values it has its defaults.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Our controller is lqg-identified, or the first one where that is not named. Columns: median, 90 % and largest of the RMS error over the \
uncorrected one; worse: cuts with a worse error than uncorrected; out: cuts that end without the controller in the loop; later: median of \
the error from the third second of motion on, over the error of the same controller without a difference.

Examples:
  feedwright-lab mismatch parts --machine workshop --drawn 4 --seed 7
  feedwright-lab mismatch parts --controller lqg-identified --controller feedforward

Exit codes: 0 no cut of our controller is worse; 1 one is; 2 an error.")]
pub(crate) struct MismatchArgs {
    /// G-code programs, and folders of programs.
    #[arg(required = true)]
    pub(crate) programs: Vec<PathBuf>,
    /// Machine of the model: built-in, or a machine file; may be given several times. Without it,
    /// workshop, stiff, tnv40 and router.
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) machine: Vec<OsString>,
    /// Controller; may be given several times. `feedwright-lab controllers` lists them.
    #[arg(long, value_name = "NAME", default_value = feedwright::BEST)]
    pub(crate) controller: Vec<String>,
    /// Gross differences: three times the inertia or a third of it, 0.7 of the position gain, 2 ms
    /// more delay, three times the friction.
    #[arg(long)]
    pub(crate) gross: bool,
    /// Variants in which everything differs, drawn by the seed, for each of 10 and 20 %.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(crate) drawn: u32,
    /// Cut no more of a program than this time of machining on the machine of the model, s.
    #[arg(long, value_name = "S", default_value_t = 60.0)]
    pub(crate) limit_s: f64,
    #[command(flatten)]
    pub(crate) sweep: SweepArgs,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}
