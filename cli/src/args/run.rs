//! Options of `feedwright run`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::Args;

use super::reader::ReaderArgs;

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// G-code program.
    pub(crate) part: PathBuf,
    /// Built-in machine, or a machine file (.toml).
    #[arg(long, value_name = "NAME|FILE.toml", default_value = feedwright::machine::DEFAULT)]
    pub(crate) machine: OsString,
    /// Controller; `feedwright controllers` lists them.
    #[arg(long, value_name = "NAME", default_value = feedwright::controllers::BEST)]
    pub(crate) controller: String,
    /// Controller to compare against.
    #[arg(long, value_name = "NAME", default_value = feedwright::controllers::BASELINE)]
    pub(crate) against: String,
    /// Feedrate in place of every programmed one, mm/s.
    #[arg(long, value_name = "MM_S", allow_negative_numbers = true)]
    pub(crate) feed: Option<f64>,
    /// Set a parameter of the controller, such as knots=10; of the other as NAME.knots=10. May be given several times;
    /// `feedwright controllers NAME` lists them.
    #[arg(long, value_name = "PARAMETER=VALUE")]
    pub(crate) set: Vec<String>,
    /// Largest contour error allowed, um: exit code 1 where it is exceeded.
    #[arg(long, value_name = "UM", allow_negative_numbers = true)]
    pub(crate) tolerance: Option<f64>,
    /// Measure errors and uncut path to this program in place of PART: what another program for the same part comes to.
    #[arg(long, value_name = "ORIGINAL.ngc", conflicts_with = "fastest")]
    pub(crate) reference: Option<PathBuf>,
    /// Cut in the least time in which the tool stays within --tolerance; feedrates are the ceiling.
    #[arg(long, requires = "tolerance")]
    pub(crate) fastest: bool,
    /// Write one row per servo period.
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) trace: Option<PathBuf>,
    /// Write all results.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) json: Option<PathBuf>,
    /// Write the corrected command: setpoints per servo period (.csv), or a program for another control (.ngc).
    #[arg(long, value_name = "FILE.csv|FILE.ngc")]
    pub(crate) out: Option<PathBuf>,
    /// Place of the report [default: PART.report.html beside where you are].
    #[arg(long, value_name = "FILE.html")]
    pub(crate) report: Option<PathBuf>,
    /// Seed of the identifier's training.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Model of the machine for the controller, in place of a training; `feedwright identify` writes one.
    #[arg(long, value_name = "FILE.model.toml")]
    pub(crate) model: Option<PathBuf>,
    /// Log of commanded and actual positions, recorded while a machine cut this program: its contour error is shown beside those predicted.
    #[arg(long, value_name = "LOG")]
    pub(crate) log: Option<PathBuf>,
    /// Which column of the log is what, by number from 0 or by name, and units: t=0,x.cmd=1,x.act=3,unit=mm,time=ms.
    #[arg(long, value_name = "COLUMNS", requires = "log")]
    pub(crate) columns: Option<String>,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}
