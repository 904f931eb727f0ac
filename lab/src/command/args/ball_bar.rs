//! Options of `feedwright-lab ball-bar`.
use std::path::PathBuf;

use clap::Args;

/// Measure a simulated machine with a ball bar
///
/// The bar cuts its own program (`feedwright excite --ballbar`) on a machine whose control
/// compensates nothing, or --program in its place. The file is what `feedwright identify
/// --geometry` reads. G, H and F of ISO 230-4 are printed.
#[derive(Debug, Args)]
#[command(
    after_long_help = "Example:\n  feedwright-lab ball-bar --machine workshop --noise 0.3 --out bar.csv"
)]
pub(crate) struct BallBarArgs {
    /// Built-in machine or machine file.
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "workshop")]
    pub(crate) machine: String,
    /// Program in the place of the bar's own, such as that one corrected; --radius and --feed are
    /// those that it was written with.
    #[arg(long, value_name = "FILE.ngc")]
    pub(crate) program: Option<PathBuf>,
    /// Radius, mm.
    #[arg(
        long,
        value_name = "MM",
        default_value_t = 50.0,
        allow_negative_numbers = true
    )]
    pub(crate) radius: f64,
    /// Feedrate, mm/min.
    #[arg(
        long,
        value_name = "MM_MIN",
        default_value_t = 1000.0,
        allow_negative_numbers = true
    )]
    pub(crate) feed: f64,
    /// Standard deviation of a sample, um.
    #[arg(
        long,
        value_name = "UM",
        default_value_t = 0.3,
        allow_negative_numbers = true
    )]
    pub(crate) noise: f64,
    /// Record the radius by the encoders, too.
    #[arg(long)]
    pub(crate) encoders: bool,
    /// Seed of the noise of bar and machine.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Place of the measurement.
    #[arg(long, value_name = "FILE.csv", default_value = "-")]
    pub(crate) out: PathBuf,
}
