//! Options of `feedwright-lab held-out`.

use std::path::PathBuf;

use clap::Args;

use super::sweep::{OneController, SweepArgs, at_least_one};

/// Look for such harm with random programs on random machines
///
/// With --failures what fails is written.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Example:
  feedwright-lab held-out 1 100 --failures failures")]
pub(crate) struct HeldOutArgs {
    /// Seed of programs and machines.
    pub(crate) drawn_by: u64,
    /// Number of cuts.
    #[arg(value_parser = at_least_one)]
    pub(crate) count: usize,
    /// Programs for each machine, which is identified once for all of them.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) programs: u16,
    /// Only machines without encoder steps and delay.
    #[arg(long)]
    pub(crate) rigid: bool,
    /// Machines that also have what real axes have: ball screws, backlash, friction, cogging,
    /// feedforward, noise, other servo periods.
    #[arg(long, conflicts_with = "rigid")]
    pub(crate) realistic: bool,
    /// Write each failure as DIR/N.ngc and DIR/N.toml, the worst first.
    #[arg(long, value_name = "DIR")]
    pub(crate) failures: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) one: OneController,
    #[command(flatten)]
    pub(crate) sweep: SweepArgs,
}
