//! Options of `feedwright identify`.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{ArgGroup, Args};
use feedwright_ident::KnownValue;

use super::headings::SIMULATED;
use super::quantity::length_mm;

/// Identify a machine from its log, and write its machine file
///
/// The log has commanded and actual positions of the axes at the servo period. Without a log a
/// simulated machine is identified, and the model is written that `feedwright run --model` takes.
#[derive(Debug, Args)]
#[command(group(ArgGroup::new("measured").args(["log", "geometry"])))]
#[command(after_long_help = "\
Examples:
  feedwright identify cut.csv --out mine.toml --report mine.html
  feedwright identify today.csv --update mine.toml
  feedwright identify cut.csv --out mine.toml --excite-next next.ngc
  feedwright identify log.txt --kp 50±5% --integral-time 0.02±10% --out mine.toml
  feedwright identify --machine workshop --out workshop.model.toml
  feedwright identify --geometry ballbar.csv --geometry x=laser.csv --machine mine.toml --out geometry.toml
  feedwright identify --geometry x=x.comp --machine mine.toml --out geometry.toml")]
pub(crate) struct IdentifyArgs {
    /// Log of commanded and actual positions of a real machine: halsampler, halscope, MATLAB v5,
    /// Sinumerik Edge, or a table of text. Several are of one machine, with the same axes.
    #[arg(value_name = "LOG", conflicts_with_all = ["machine", "controller", "axes", "set", "seed"])]
    pub(crate) log: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) of_log: LogArgs,
    #[command(flatten)]
    pub(crate) of_geometry: MeasuredGeometryArgs,
    /// Machine: one that is built in (`feedwright machines` lists them), or a machine file (.toml).
    #[arg(long, value_name = "NAME|FILE.toml", default_value = feedwright_sim::DEFAULT_MACHINE, help_heading = SIMULATED)]
    pub(crate) machine: OsString,
    /// Controller that the model is for; `feedwright controllers` lists them.
    #[arg(long, value_name = "NAME", default_value = crate::controllers::BEST, help_heading = SIMULATED, hide_short_help = true)]
    pub(crate) controller: String,
    /// Axes of the model: 2 for programs that stay in the XY plane, 3 for others.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3), help_heading = SIMULATED, hide_short_help = true)]
    pub(crate) axes: u8,
    /// Set a parameter of the controller; feed_period_s is the one that the model depends on.
    #[arg(long, value_name = "PARAMETER=VALUE", help_heading = SIMULATED, hide_short_help = true)]
    pub(crate) set: Vec<String>,
    /// Seed of the recording that a simulated machine is identified from.
    #[arg(long, default_value_t = 1, help_heading = SIMULATED, hide_short_help = true)]
    pub(crate) seed: u64,
    /// Place of the machine file; of a simulated machine, of its model; with --geometry, of the
    /// geometry file.
    #[arg(long, value_name = "FILE.toml", required_unless_present = "update")]
    pub(crate) out: Option<PathBuf>,
}

/// Options that describe a log.
#[derive(Debug, Args)]
#[command(next_help_heading = "Options of a LOG")]
pub(crate) struct LogArgs {
    /// Columns of the log, by number from 0 or by name, and units:
    /// t=0,x.cmd=1,x.act=3,x.torque=5,unit=mm,time=ms.
    #[arg(long, value_name = "COLUMNS", requires = "log")]
    pub(crate) columns: Option<feedwright_ident::Columns>,
    /// Machine file that is updated: values that the logs do not determine stay as they are. The
    /// result is written to --out, or over this file if there is no --out.
    #[arg(long, value_name = "FILE.toml", requires = "log")]
    pub(crate) update: Option<PathBuf>,
    /// Identify from this part of the log, s; --score says by which to judge. Without both, blocks
    /// of motion take turns.
    #[arg(
        long,
        value_name = "FROM:TO",
        requires = "score",
        requires = "log",
        hide_short_help = true
    )]
    pub(crate) fit: Option<Times>,
    /// Judge by this part of the log, s.
    #[arg(
        long,
        value_name = "FROM:TO",
        requires = "fit",
        requires = "log",
        hide_short_help = true
    )]
    pub(crate) score: Option<Times>,
    /// Travel for a turn of the motor, such as 5mm or 0.2in; mm where it has no unit. Without it an
    /// axis counts as linear: kg, N s/m, N.
    #[arg(long, value_name = "LENGTH", requires = "log", value_parser = lead_mm)]
    pub(crate) lead: Option<f64>,
    /// Inertia at the motor, kg m2; without --lead the mass, kg. It cannot be identified from
    /// positions.
    #[arg(long, value_name = "KG_M2|KG", requires = "log", value_parser = positive)]
    pub(crate) inertia: Option<f64>,
    /// Viscous friction at the motor, N m s/rad; without --lead N s/m.
    #[arg(long, value_name = "N_M_S|N_S_PER_M", requires = "log", value_parser = positive, hide_short_help = true)]
    pub(crate) viscous: Option<f64>,
    /// Torque, N m, for a unit of the torque column; without --lead force, N.
    #[arg(long, value_name = "N_M|N", requires = "log", value_parser = positive, hide_short_help = true)]
    pub(crate) torque_gain: Option<f64>,
    /// Position gain of the drive, 1/s. With ± it is known within that standard deviation, and the
    /// log corrects it; without, it is taken as it is.
    #[arg(long, value_name = "VALUE[±SPREAD[%]]", requires = "log")]
    pub(crate) kp: Option<KnownValue>,
    /// Integral time of the speed loop, s, as --kp; 0 is a loop without integral.
    #[arg(
        long,
        value_name = "VALUE[±SPREAD[%]]",
        requires = "log",
        hide_short_help = true
    )]
    pub(crate) integral_time: Option<KnownValue>,
    /// Part of the commanded speed that is fed forward, as --kp.
    #[arg(
        long,
        value_name = "VALUE[±SPREAD[%]]",
        requires = "log",
        hide_short_help = true
    )]
    pub(crate) velocity_feedforward: Option<KnownValue>,
    /// Part of the commanded acceleration that is fed forward, as --kp.
    #[arg(
        long,
        value_name = "VALUE[±SPREAD[%]]",
        requires = "log",
        hide_short_help = true
    )]
    pub(crate) acceleration_feedforward: Option<KnownValue>,
    /// Delay from the control to the drive, s, as --kp.
    #[arg(
        long,
        value_name = "VALUE[±SPREAD[%]]",
        requires = "log",
        hide_short_help = true
    )]
    pub(crate) drive_delay: Option<KnownValue>,
    /// Delay from the control to a position loop in the drive, s: a whole number of servo periods.
    /// Without it, the delay is identified from the log, where --record-delay is given.
    #[arg(long, value_name = "S", requires = "log", value_parser = command_delay, hide_short_help = true)]
    pub(crate) command_delay: Option<f64>,
    /// Time over which the drive takes the speed from positions, s, of one that closes its loops at
    /// the rate of the log and recorded it itself: two samples are 0.002 at 1 kHz. It cannot be
    /// identified from positions.
    #[arg(long, value_name = "S", requires = "log", value_parser = positive, hide_short_help = true)]
    pub(crate) speed_window: Option<f64>,
    /// Delay of the recorded actual position behind the recorded command, s: 0 if both are sampled
    /// at the same moment, as halsampler does. Without it, a delay of the drive counts as a delay
    /// of the record.
    #[arg(
        long,
        value_name = "S",
        requires = "log",
        allow_negative_numbers = true,
        hide_short_help = true
    )]
    pub(crate) record_delay: Option<f64>,
    /// Write the program that moves the axes as the log did not, and as it would take to settle
    /// what is open. Where nothing is open, none is written.
    #[arg(long, value_name = "FILE.ngc", requires = "log")]
    pub(crate) excite_next: Option<PathBuf>,
    /// Write a page: numbers, measured against predicted, what is left.
    #[arg(long, value_name = "FILE.html", requires = "log")]
    pub(crate) report: Option<PathBuf>,
    /// Write all results as JSON.
    #[arg(long, value_name = "FILE.json", requires = "measured")]
    pub(crate) json: Option<PathBuf>,
}

/// Options that describe measurements of the geometry.
#[derive(Debug, Args)]
#[command(next_help_heading = "Options of the geometry")]
pub(crate) struct MeasuredGeometryArgs {
    /// Measurement of the geometry of --machine: ball bar, laser or scale, test part, grid encoder,
    /// or compensation file of LinuxCNC. x=FILE says which axis it is of. Several are fitted
    /// together; --out gets the geometry file.
    #[arg(long, value_name = "[AXIS=]FILE", conflicts_with_all = ["log", "controller", "axes", "set", "seed"], requires = "out")]
    pub(crate) geometry: Vec<AxisFile>,
    /// Write the errors of an axis as a compensation file of LinuxCNC.
    #[arg(
        long,
        value_name = "AXIS=FILE",
        requires = "geometry",
        hide_short_help = true
    )]
    pub(crate) comp_file: Vec<AxisFile>,
    /// Type of the compensation files that are written: 0 has positions of the tool, 1 has what is
    /// added to the command.
    #[arg(long, value_name = "0|1", default_value_t = 0, value_parser = clap::value_parser!(u8).range(0..=1), hide_short_help = true)]
    pub(crate) comp_type: u8,
}

/// A file, perhaps of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AxisFile {
    pub(crate) axis: Option<usize>,
    pub(crate) path: PathBuf,
}

impl std::str::FromStr for AxisFile {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let axis_of = |name: &str| {
            feedwright_sim::AXIS_NAMES
                .iter()
                .position(|axis| *axis == name.to_lowercase())
        };
        let named = text
            .split_once('=')
            .and_then(|(name, path)| Some((axis_of(name)?, path)));
        let (axis, path) = named.map_or((None, text), |(axis, path)| (Some(axis), path));
        if path.is_empty() {
            Err("the name of the file is missing".to_owned())
        } else {
            Ok(Self {
                axis,
                path: path.into(),
            })
        }
    }
}

/// A number above zero.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("it must be a number above 0".to_owned()),
    }
}

fn lead_mm(text: &str) -> Result<f64, String> {
    let lead_mm = length_mm(text)?;
    if lead_mm > 0.0 && lead_mm.is_finite() {
        Ok(lead_mm)
    } else {
        Err("it must be above 0 mm".to_owned())
    }
}

fn command_delay(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if (0.0..=0.02).contains(&value) => Ok(value),
        _ => Err("it must be 0 to 0.02 s".to_owned()),
    }
}

/// A part of a log.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Times(pub(crate) std::ops::Range<f64>);

impl std::str::FromStr for Times {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let ends = text
            .split_once(':')
            .and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
        match ends {
            Some((from, to)) if from < to => Ok(Self(from..to)),
            _ => Err("write two times in s, the earlier first, as in 0:12.5".to_owned()),
        }
    }
}
