//! Options of `feedwright run`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;
use miette::Result;

use super::correct::controls;
use super::geometry::GeometryArgs;
use super::headings::{CONTROLLER, CUT, MEASURED, RESULTS};
use super::quantity::{feed_mm_s, length_um};
use super::reader::ReaderArgs;
use crate::controllers::BEST;
use crate::request::{JobRequest, setting};

/// Cut a part on a simulated machine, and show its contour error
///
/// The program is cut twice, uncorrected and with a controller that corrects the command, and both
/// are written into a report (PART.report.html, one file that any browser shows). Nothing moves:
/// all figures are those of a simulation of the machine file.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright run part.ngc
  feedwright run part.ngc --machine mine.toml --tolerance 10 --out setpoints.csv
  feedwright run part.ngc --machine mine.toml --log cut.csv
  cat part.ngc | feedwright run - --json - | jq '.runs[].max_um'

Exit codes: 0 done; 1 out of --tolerance, the correction is worse than uncorrected (--out is not written then), or it was out of the loop for \
most of the cut or at its end; 2 an error.

`feedwright correct` writes a corrected program.")]
pub struct RunArgs {
    /// G-code program.
    pub(crate) part: PathBuf,
    /// Machine: one that is built in (`feedwright machines` lists them), or a machine file (.toml).
    #[arg(long, value_name = "NAME|FILE.toml", default_value = feedwright_sim::DEFAULT_MACHINE, help_heading = CUT)]
    pub(crate) machine: OsString,
    /// Controller that corrects the command [default: lqg-identified]; `feedwright controllers`
    /// lists them.
    #[arg(long, value_name = "NAME", help_heading = CONTROLLER, hide_short_help = true)]
    pub(crate) controller: Option<String>,
    /// Controller to compare with.
    #[arg(long, value_name = "NAME", default_value = crate::controllers::BASELINE, help_heading = CONTROLLER, hide_short_help = true)]
    pub(crate) against: String,
    /// Feedrate in place of every programmed one, with its unit: 3000mm/min, 50mm/s or 120ipm.
    #[arg(long, value_name = "FEED", value_parser = feed_mm_s, allow_hyphen_values = true, help_heading = CUT)]
    pub(crate) feed: Option<f64>,
    /// Set a parameter of the controller, such as knots=10; of the other as NAME.knots=10. May be
    /// given several times; `feedwright controllers NAME` lists them.
    #[arg(long, value_name = "PARAMETER=VALUE", help_heading = CONTROLLER, hide_short_help = true)]
    pub(crate) set: Vec<String>,
    /// Largest contour error allowed, such as 10um, 0.01mm or 0.0004in; um where it has no unit.
    /// The planned path uses what the predicted error of the machine leaves of it. Exit code 1
    /// where it is exceeded. Where --out is a program, that program decides.
    #[arg(long, value_name = "LENGTH", value_parser = length_um, allow_negative_numbers = true, help_heading = CUT)]
    pub(crate) tolerance: Option<f64>,
    /// Measure errors and uncut path to this program in place of PART: what another program for the
    /// same part comes to. A corrected program is planned as the control plans that its comment
    /// names.
    #[arg(long, value_name = "ORIGINAL.ngc", conflicts_with = "fastest", help_heading = MEASURED, hide_short_help = true)]
    pub(crate) reference: Option<PathBuf>,
    /// Cut in the least time in which the tool stays within --tolerance; feedrates are the ceiling.
    #[arg(long, requires = "tolerance", help_heading = CUT)]
    pub(crate) fastest: bool,
    /// Write a row per servo period: path, command, tool, torque, contour error.
    #[arg(long, value_name = "FILE.csv", help_heading = RESULTS, hide_short_help = true)]
    pub(crate) trace: Option<PathBuf>,
    /// Write all results as JSON.
    #[arg(long, value_name = "FILE.json", help_heading = RESULTS)]
    pub(crate) json: Option<PathBuf>,
    /// Write setpoints, the command of the controller's cut per servo period (.csv), or a corrected
    /// program for a control without feedback, as `feedwright correct` does (.ngc). It is written
    /// only where it is better than without, else the exit code is 1.
    #[arg(long, value_name = "FILE.csv|FILE.ngc", help_heading = RESULTS)]
    pub(crate) out: Option<PathBuf>,
    /// Control that a program of --out is for [default: generic].
    #[arg(long = "for", value_name = "CONTROL", requires = "out", long_help = controls("Control that a program of --out is for [default: generic]."), help_heading = RESULTS, hide_short_help = true)]
    pub(crate) target: Option<String>,
    /// Place of the report [default: PART.report.html in the current folder].
    #[arg(long, value_name = "FILE.html", help_heading = RESULTS)]
    pub(crate) report: Option<PathBuf>,
    /// Seed of the recording that the machine is identified from.
    #[arg(long, default_value_t = 1, help_heading = CONTROLLER, hide_short_help = true)]
    pub(crate) seed: u64,
    /// Identified model for the controller; `feedwright identify` writes one. Without it, the
    /// simulated machine cuts the program of `feedwright excite`, and is identified from what its
    /// encoders show, as a real one would be.
    #[arg(long, value_name = "FILE.model.toml", help_heading = CONTROLLER, hide_short_help = true)]
    pub(crate) model: Option<PathBuf>,
    /// Give the controller the settings of the drives as the machine file has them, and identify
    /// only inertia and friction. Nobody knows a real machine so well.
    #[arg(long, conflicts_with = "model", help_heading = CONTROLLER, hide_short_help = true)]
    pub(crate) exact_settings: bool,
    /// Machines, 0 to 32, that fit the recording as well as the identified one: they are cut with
    /// the same controller, and their errors make the band of the prediction.
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u8).range(0..=32), conflicts_with_all = ["exact_settings", "model"], help_heading = CONTROLLER, hide_short_help = true)]
    pub(crate) band: u8,
    /// Place of the model that the controller has at the end of the cut, with what it learned of
    /// the machine: next time the beginning is corrected as well.
    #[arg(long, value_name = "FILE.model.toml", requires = "model", help_heading = RESULTS, hide_short_help = true)]
    pub(crate) learned: Option<PathBuf>,
    /// Log of commanded and actual positions, recorded while a machine cut this program: the
    /// contour error measured is shown beside those predicted.
    #[arg(long, value_name = "LOG", help_heading = MEASURED)]
    pub(crate) log: Option<PathBuf>,
    /// Columns of the log, by number from 0 or by name, and units:
    /// t=0,x.cmd=1,x.act=3,unit=mm,time=ms.
    #[arg(long, value_name = "COLUMNS", requires = "log", help_heading = MEASURED)]
    pub(crate) columns: Option<String>,
    #[command(flatten)]
    pub(crate) geometry: GeometryArgs,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

impl RunArgs {
    /// Returns the request of these options.
    pub(crate) fn request(&self) -> Result<JobRequest> {
        Ok(JobRequest {
            program: self.part.clone(),
            machine: PathBuf::from(&self.machine),
            controller: self.controller.clone().unwrap_or_else(|| BEST.to_owned()),
            against: self.against.clone(),
            feed_mm_s: self.feed,
            settings: self.set.iter().map(|text| setting(text)).collect(),
            tolerance_um: self.tolerance,
            reference: self.reference.clone(),
            fastest: self.fastest,
            seed: self.seed,
            model: self.model.clone(),
            exact_settings: self.exact_settings,
            band: self.band,
            learns: self.learned.is_some(),
            logs: self.log.iter().cloned().collect(),
            columns: self.columns.clone(),
            no_geometry: self.geometry.no_geometry,
            geometry: self.geometry.geometry.clone(),
            with_limits: true,
            ..self.reader.request()?
        })
    }
}
