//! Options of `feedwright correct`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;
use miette::Result;

use super::geometry::GeometryArgs;
use super::headings::{CUT, MEASURED, RESULTS};
use super::quantity::length_um;
use super::reader::ReaderArgs;
use crate::request::JobRequest;

/// Write a corrected program for a control without feedback
///
/// The correction is computed for the control that is named with --for: its planner, its arcs, its
/// decimals. The new program is read again, planned as that control would, cut in simulation and
/// compared with the original before it is written.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright correct part.ngc --machine mine.toml --for linuxcnc --out corrected.ngc
  feedwright correct part.ngc --machine mine.toml --for linuxcnc --log cut.csv --out second.ngc

Exit codes: 0 done; 1 out of --tolerance, or no better than uncorrected: nothing is written then; 2 an error.")]
pub(crate) struct CorrectArgs {
    /// G-code program.
    pub(crate) part: PathBuf,
    /// Machine: one that is built in (`feedwright machines` lists them), or a machine file (.toml).
    #[arg(long, value_name = "NAME|FILE.toml", default_value = feedwright_sim::DEFAULT_MACHINE, help_heading = CUT)]
    pub(crate) machine: OsString,
    /// Control that the corrected program is for: how it plans the speed, and what its blocks may
    /// hold.
    #[arg(long = "for", value_name = "CONTROL", default_value = crate::correct::TARGETS[0].name, long_help = controls("Control that the corrected program is for: how it plans the speed, and what its blocks may hold."), help_heading = CUT)]
    pub(crate) target: String,
    /// Log of a cut of this part: commanded and actual positions, by this program or by one that
    /// was corrected from it. What the logs show is corrected, not what the machine file says.
    /// Several logs: repeat the option.
    #[arg(long, value_name = "FILE", help_heading = MEASURED)]
    pub(crate) log: Vec<PathBuf>,
    /// Standard deviation of each value of the machine file, %; 0 if the values are exact. The
    /// default is 10 % for a file, and 0 for a built-in machine, which is simulated as it is
    /// written. Without a log, axes whose gains differ by chance count as matched, and a stretch is
    /// changed only where a gain is likely on every machine that the file may describe.
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, help_heading = CUT)]
    pub(crate) file_error: Option<f64>,
    /// Columns of the logs, by number from 0 or by name, and units:
    /// t=0,x.cmd=1,x.act=3,unit=mm,time=ms.
    #[arg(long, value_name = "COLUMNS", requires = "log", help_heading = MEASURED)]
    pub(crate) columns: Option<String>,
    /// Place of the corrected program; it is written only if it is better than the uncorrected
    /// program; otherwise the exit code is 1.
    #[arg(long, value_name = "FILE.ngc", help_heading = RESULTS)]
    pub(crate) out: Option<PathBuf>,
    /// Largest contour error allowed of the corrected program as the control cuts it, such as 10um,
    /// 0.01mm or 0.0004in; um where it has no unit. Exit code 1 where it is exceeded.
    #[arg(long, value_name = "LENGTH", value_parser = length_um, allow_negative_numbers = true, help_heading = CUT)]
    pub(crate) tolerance: Option<f64>,
    /// Write all results as JSON.
    #[arg(long, value_name = "FILE.json", help_heading = RESULTS)]
    pub(crate) json: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) geometry: GeometryArgs,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

impl CorrectArgs {
    /// Returns the request of these options.
    pub(crate) fn request(&self) -> Result<JobRequest> {
        Ok(JobRequest {
            program: self.part.clone(),
            machine: PathBuf::from(&self.machine),
            target: Some(self.target.clone()),
            logs: self.log.clone(),
            columns: self.columns.clone(),
            file_error: self.file_error,
            tolerance_um: self.tolerance,
            no_geometry: self.geometry.no_geometry,
            geometry: self.geometry.geometry.clone(),
            ..self.reader.request()?
        })
    }
}

/// Returns `about` followed by the controls of `--for`, one per line.
pub(super) fn controls(about: &str) -> String {
    let rows = crate::correct::TARGETS
        .iter()
        .map(|target| format!("\n  {:<10} {}", target.name, target.about));
    about.to_owned() + &rows.collect::<String>()
}
