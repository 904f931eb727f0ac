//! Options of `feedwright excite`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;

use super::quantity::{length_mm, size_mm, slow_feed_mm_min};

/// Write a program to record a log with, for identify
///
/// Run it on the machine in the air, record commanded and actual positions meanwhile, and give the
/// log to `feedwright identify`. The first lines of the program say what to check before. With
/// --ballbar or --grid the program measures the geometry instead.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright excite --machine limits.toml --travel 40 --out excite.ngc
  feedwright excite --machine mine.toml --ballbar 100 --feed 500 --out ballbar.ngc
  feedwright excite --machine mine.toml --grid 10 --travel 80 --out grid.ngc")]
pub(crate) struct ExciteArgs {
    /// Machine whose limits the program keeps: one that is built in, or a machine file (.toml).
    #[arg(long, value_name = "NAME|LIMITS.toml")]
    pub(crate) machine: OsString,
    /// Travel of each axis, such as 40mm or 1.5in; mm where it has no unit: half of it on each side
    /// of where the machine stands.
    #[arg(long, value_name = "LENGTH", value_parser = length_mm, default_value_t = feedwright_ident::ExciteOptions::default().travel_mm, allow_negative_numbers = true)]
    pub(crate) travel: f64,
    /// Write the program of a ball bar of this radius, mm where it has no unit: circles in both
    /// directions about the zero of the work coordinates.
    #[arg(long, value_name = "RADIUS", conflicts_with = "travel", value_parser = size_mm)]
    pub(crate) ballbar: Option<f64>,
    /// Write a program that rests at points of a grid, this far apart (mm where it has no unit),
    /// over --travel from the zero of the work coordinates.
    #[arg(long, value_name = "STEP", conflicts_with = "ballbar", value_parser = size_mm)]
    pub(crate) grid: Option<f64>,
    /// Feedrate of --ballbar and --grid, such as 500mm/min or 20ipm; mm/min where it has no unit. A
    /// ball bar shows the geometry best where servos lag least: slowly.
    #[arg(long, value_name = "FEED", default_value_t = 500.0, value_parser = slow_feed_mm_min)]
    pub(crate) feed: f64,
    /// Plane of --ballbar; with z, arcs of 220 degrees.
    #[arg(long, value_name = "PLANE", default_value = "xy", value_parser = ["xy", "xz", "yz"], requires = "ballbar")]
    pub(crate) plane: String,
    /// Place of the program.
    #[arg(long, value_name = "FILE.ngc")]
    pub(crate) out: PathBuf,
}
