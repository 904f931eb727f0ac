//! Options of `feedwright advise`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;
use miette::Result;

use super::correct::controls;
use super::geometry::GeometryArgs;
use super::headings::{CONTROLLER, CUT, RESULTS};
use super::quantity::length_um;
use super::reader::ReaderArgs;
use crate::request::JobRequest;

/// List the feedrates at which a program holds a tolerance
///
/// Three ways of cutting are compared: the program as it is, the corrected program, and a
/// controller that sees the tool. Feedrates are listed for the whole program, and for each stretch
/// between corners and stops. Where no feedrate holds the tolerance, the table lists which error
/// remains, and where.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Example:
  feedwright advise part.ngc --machine mine.toml --tolerance 10 --report advice.html

Exit codes: 0 done; 1 where no feed holds, in any way of cutting; 2 an error.")]
pub(crate) struct AdviseArgs {
    /// G-code program.
    pub(crate) part: PathBuf,
    /// Machine: one that is built in (`feedwright machines` lists them), or a machine file (.toml).
    #[arg(long, value_name = "NAME|FILE.toml", default_value = feedwright_sim::DEFAULT_MACHINE, help_heading = CUT)]
    pub(crate) machine: OsString,
    /// Largest contour error, such as 10um, 0.01mm or 0.0004in; um where it has no unit.
    #[arg(long, value_name = "LENGTH", value_parser = length_um, allow_negative_numbers = true, help_heading = CUT)]
    pub(crate) tolerance: f64,
    /// Control that cuts the program without feedback, as it is and corrected.
    #[arg(long = "for", value_name = "CONTROL", default_value = crate::correct::TARGETS[0].name, long_help = controls("Control that cuts the program without feedback, as it is and corrected."), help_heading = CUT)]
    pub(crate) target: String,
    /// Standard deviation of each value of the machine file, %; 0 if the values are exact. The
    /// default is the same as for `feedwright correct`: 10 % for a file, and 0 for a built-in
    /// machine, which is simulated as it is written.
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, help_heading = CUT, hide_short_help = true)]
    pub(crate) file_error: Option<f64>,
    /// Controller of the cut with feedback; `feedwright controllers` lists them.
    #[arg(long, value_name = "NAME", default_value = crate::controllers::BEST, help_heading = CONTROLLER, hide_short_help = true)]
    pub(crate) controller: String,
    /// Seed of the recording that the machine is identified from.
    #[arg(long, default_value_t = 1, help_heading = CONTROLLER, hide_short_help = true)]
    pub(crate) seed: u64,
    /// Write a page: table, figure, and the feedrates of each stretch.
    #[arg(long, value_name = "FILE.html", help_heading = RESULTS)]
    pub(crate) report: Option<PathBuf>,
    /// Write the figure: error over feedrate, and the feedrate that each stretch holds.
    #[arg(long, value_name = "FILE.svg", help_heading = RESULTS, hide_short_help = true)]
    pub(crate) figure: Option<PathBuf>,
    /// Write all results as JSON, those of every feed that was cut too.
    #[arg(long, value_name = "FILE.json", help_heading = RESULTS)]
    pub(crate) json: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) geometry: GeometryArgs,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

impl AdviseArgs {
    /// Returns the request of these options.
    pub(crate) fn request(&self) -> Result<JobRequest> {
        Ok(JobRequest {
            program: self.part.clone(),
            machine: PathBuf::from(&self.machine),
            target: Some(self.target.clone()),
            file_error: self.file_error,
            tolerance_um: Some(self.tolerance),
            controller: self.controller.clone(),
            seed: self.seed,
            no_geometry: self.geometry.no_geometry,
            geometry: self.geometry.geometry.clone(),
            ..self.reader.request()?
        })
    }
}
