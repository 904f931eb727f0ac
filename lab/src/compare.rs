//! The comparison: every controller on every workpiece and machine, in one table.
//!
//! The unit of work is a machine and a controller: each controller is tuned on each machine by the
//! same search, under the machine's noise ([`tuning`]). It is made from what it may know of that
//! machine ([`Knowledge`]), and cut on all workpieces with several noise seeds. A table is the same
//! bit by bit for the same options, whatever the number of threads.
//!
//! | File | What |
//! |---|---|
//! | `compare/noise.rs` | noise seeds, medians |
//! | `compare/work.rs` | what is cut |
//! | `compare/tuned.rs` | the values that a controller runs with |
//! | `compare/recorded.rs` | values that earlier searches came to |
//! | `compare/held_out_work.rs` | held-out work and its seeds |
//! | `compare/competitor.rs` | a controller and what it is given of the machine |
//! | `compare/options.rs` | what is compared |
//! | `compare/table.rs` | rows and their ratios |
//! | `compare/cut.rs` | one row: a cut for each noise seed |
//! | `compare/tuning.rs` | the search that tunes every controller alike |
//! | `compare/tolerance.rs` | the machining time at which a tolerance just holds |
//! | `compare/verdict.rs` | what is claimed, row by row |
//! | `compare/overview.rs` | what tables over many rows are made of |
//! | `compare/units.rs` | the work in units |
//! | `compare/results_file.rs` | the file of the results |

mod noise;
pub mod work;
pub mod tuned;
pub mod recorded;
pub mod held_out_work;
mod competitor;
mod options;
pub mod table;
mod cut;
pub mod tuning;
pub mod tolerance;
pub mod verdict;
pub mod overview;
mod units;
mod results_file;

pub use competitor::{Competitor, Knowledge};
use feedwright_sim::{RunError, Watch};
pub use noise::MAX_SEEDS;
pub use options::{ComparisonOptions, Tuning};
use overview::Claimed;
pub use units::tune_alone;
use units::work_on;
pub use work::{FEED_MM_S, PartError, Workpiece};

use crate::study::Kept;
use table::ComparisonRow;
use tolerance::AtTolerance;
use tuned::Tuned;
use verdict::Verdict;

/// A finished comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Name of the nominal machine.
    pub nominal: String,
    /// Seed.
    pub seed: u64,
    /// Noise seeds of each cut on a machine that has noise.
    pub noise_seeds: u32,
    /// The values that the controllers ran with, by machine.
    pub tuned: Vec<Tuned>,
    /// All rows: by workpiece, then machine, then controller.
    pub rows: Vec<ComparisonRow>,
    /// Verdict on each claim, row by row.
    pub verdicts: Vec<Verdict>,
    /// The verdicts by claim.
    pub claims: Vec<Claimed>,
    /// Machining times at equal tolerance, where they were asked for.
    pub at_tolerance: Vec<AtTolerance>,
}

impl Comparison {
    /// Builds the comparison from the results of all cuts.
    fn new(options: &ComparisonOptions, results: units::UnitResults) -> Self {
        let rows = table::in_order(&results.rows, options);
        let nominal = options.nominal.name.clone();
        let verdicts = verdict::verdicts(&rows, options);
        let at_tolerance = tolerance::against_baseline(results.at_tolerance);
        let (seed, noise_seeds) = (options.seed, options.noise_seeds);
        let claims = Claimed::all(&verdicts);
        Self {
            nominal,
            seed,
            noise_seeds,
            tuned: results.tuned,
            rows,
            verdicts,
            claims,
            at_tolerance,
        }
    }
}

/// Compares. Stored work is not done again.
///
/// # Errors
/// Where a machine has no sensible limits, or where it is ended from outside.
pub fn compare(
    options: &ComparisonOptions,
    kept: &Kept,
    watch: &dyn Watch,
) -> Result<Comparison, RunError> {
    Ok(Comparison::new(options, work_on(options, kept, watch)?))
}
