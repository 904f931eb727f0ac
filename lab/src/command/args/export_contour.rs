//! Options of `feedwright-lab export-contour`.
use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;
use feedwright::command::feed_mm_s;

use crate::contour::CONTOURS;

/// Write a built-in contour as a G-code program
///
/// Straight lines and circles are written as they are; the other curves as arcs that meet without a
/// corner, within --tolerance of the curve. The contours are those of `feedwright-lab compare`.
#[derive(Debug, Args)]
#[command(
    after_long_help = "Example:\n  feedwright-lab export-contour eight --feed 3000mm/min --out eight.ngc"
)]
pub(crate) struct ExportContourArgs {
    /// Its name.
    #[arg(value_parser = PossibleValuesParser::new(CONTOURS.iter().map(|contour| contour.name)))]
    pub(crate) contour: String,
    /// Feedrate, with its unit, such as 3000mm/min or 50mm/s.
    #[arg(long, value_name = "FEED", default_value = "50mm/s", value_parser = feed_mm_s, allow_hyphen_values = true)]
    pub(crate) feed: f64,
    /// Largest distance of arcs from the curve, um.
    #[arg(
        long,
        value_name = "UM",
        default_value_t = 0.1,
        allow_negative_numbers = true
    )]
    pub(crate) tolerance: f64,
    /// Place of the program.
    #[arg(long, value_name = "FILE.ngc", default_value = "-")]
    pub(crate) out: PathBuf,
}
