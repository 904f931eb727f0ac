//! Options of `feedwright plan`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;
use miette::Result;

use super::geometry::GeometryArgs;
use super::headings::{CUT, RESULTS};
use super::quantity::length_um;
use super::reader::ReaderArgs;
use crate::request::JobRequest;

/// Compute the cycle time of a program, and what limits it
///
/// The time is listed by tool, by kind of motion, and by the limit that binds: feedrate,
/// acceleration or jerk of an axis.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Example:
  feedwright plan part.ngc --machine mine.toml --planner linuxcnc")]
pub(crate) struct PlanArgs {
    /// G-code program.
    pub(crate) part: PathBuf,
    /// Machine: one that is built in (`feedwright machines` lists them), or a machine file (.toml).
    #[arg(long, value_name = "NAME|FILE.toml", default_value = feedwright_sim::DEFAULT_MACHINE, help_heading = CUT)]
    pub(crate) machine: OsString,
    /// Largest distance of the tool from the programmed path, such as 10um, 0.01mm or 0.0004in; um
    /// where it has no unit: deviation of the plan and predicted error of the machine together. The
    /// machine is simulated for it.
    #[arg(long, value_name = "LENGTH", value_parser = length_um, allow_negative_numbers = true, help_heading = CUT)]
    pub(crate) tolerance: Option<f64>,
    /// Planner in place of the one that suits the machine: trapezoid, time-optimal, unlimited, or
    /// linuxcnc, which plans as LinuxCNC 2.9 does.
    #[arg(long, value_name = "NAME", help_heading = CUT)]
    pub(crate) planner: Option<String>,
    /// Plan as this control does, and list the time of each line: generic, linuxcnc, grbl or fanuc.
    #[arg(long = "for", value_name = "CONTROL", conflicts_with = "planner", help_heading = CUT)]
    pub(crate) target: Option<String>,
    /// Write the time of each line as a table: line, time_s, waiting_s and its text.
    #[arg(long, value_name = "FILE.csv", help_heading = RESULTS)]
    pub(crate) lines: Option<PathBuf>,
    /// Also plan each path as a whole from rest to rest, and print its time. No plan can be much
    /// faster.
    #[arg(long, help_heading = CUT, hide_short_help = true)]
    pub(crate) bound: bool,
    /// Print the cutting time at this feed override, 0 to 200 %, which is applied during the cut:
    /// the path stays as planned.
    #[arg(long = "override", value_name = "PERCENT", allow_negative_numbers = true, help_heading = CUT)]
    pub(crate) override_percent: Option<f64>,
    /// Print where the tool rests if feed hold is pressed this long after the start, s.
    #[arg(long, value_name = "S", allow_negative_numbers = true, help_heading = CUT)]
    pub(crate) hold_at: Option<f64>,
    /// Write all results as JSON.
    #[arg(long, value_name = "FILE.json", help_heading = RESULTS)]
    pub(crate) json: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) geometry: GeometryArgs,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

impl PlanArgs {
    /// Returns the request of these options.
    pub(crate) fn request(&self) -> Result<JobRequest> {
        Ok(JobRequest {
            program: self.part.clone(),
            machine: PathBuf::from(&self.machine),
            tolerance_um: self.tolerance,
            no_geometry: self.geometry.no_geometry,
            geometry: self.geometry.geometry.clone(),
            ..self.reader.request()?
        })
    }
}
