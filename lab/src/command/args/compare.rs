//! Options of `feedwright-lab compare`.
use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args, ValueEnum};
use feedwright::command::ReaderArgs;
use feedwright_sim::{GeometryFile, Machine, Squareness};
use miette::Result;

use crate::compare::{Knowledge, MAX_SEEDS};

/// Compare all controllers on contours and machines
///
/// One table: errors, time, torque, and how they compare with the uncorrected cut.
#[derive(Debug, Args)]
#[command(after_long_help = "\
Examples:
  feedwright-lab compare --only workshop --json compare.json
  feedwright-lab compare --only circle,star,tnv40,uncorrected,lqg-identified")]
pub(crate) struct CompareArgs {
    /// Only these contours, machines and controllers; what is not named in its kind is left out.
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) only: Vec<String>,
    /// Cut this program too, in the XY plane; may be given several times.
    #[arg(long, value_name = "FILE")]
    pub(crate) part: Vec<PathBuf>,
    /// Cut on this machine too; may be given several times.
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) machine: Vec<OsString>,
    /// Seed of everything random.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Set a parameter of a controller, such as two-dimensional.rho=0.01: it has its defaults then,
    /// and is not searched. May be given several times; `feedwright-lab controllers NAME` lists
    /// them.
    #[arg(long, value_name = "NAME.PARAMETER=VALUE")]
    pub(crate) set: Vec<String>,
    /// Source of the controllers' parameter values: stored searches (a new search if none is
    /// stored), a search for each controller and machine (an hour and more), or the defaults.
    #[arg(long, value_name = "SOURCE", value_enum, default_value_t = TuningSource::Recorded)]
    tuning: TuningSource,
    /// Search, and keep the values in this file beside those that it has; cut nothing. The program
    /// keeps lab/src/compare/recorded.jsonl.
    #[arg(long, value_name = "FILE.jsonl", conflicts_with_all = ["json", "at_tolerance"])]
    pub(crate) record: Option<PathBuf>,
    /// Work to cut.
    #[arg(long, value_name = "WORK", value_enum, default_value_t = Work::Contours)]
    pub(crate) work: Work,
    /// Noise seeds that everything is cut with on a machine that has noise: the table has medians.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SEEDS)))]
    pub(crate) seeds: u32,
    /// Knowledge of the machine that controllers get; one row for each.
    #[arg(long, value_name = "GIVEN,...", value_enum, value_delimiter = ',', default_values_t = [Given::Own, Given::Identified, Given::TwentyPercentOff, Given::Unseen])]
    pub(crate) knowledge: Vec<Given>,
    /// Geometry that every control compensates, uncorrected or not: none, known (as the machine
    /// file states it), opposite (the same with wrong signs), or a geometry file (.toml).
    #[arg(long, value_name = "GEOMETRY", default_value = "none")]
    pub(crate) geometry: Compensated,
    /// Folder of finished work, so that an interrupted run continues [default: in the cache, until
    /// the run is complete].
    #[arg(long, value_name = "FOLDER")]
    pub(crate) results: Option<PathBuf>,
    /// Also find, for each smooth contour, the feedrate at which each controller just holds 10 um.
    #[arg(long)]
    pub(crate) at_tolerance: bool,
    /// Threads; all cores where it is left out. The table does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Write errors, times, tuned values and claims.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) json: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

/// Source of parameter values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TuningSource {
    /// Stored searches; a new search if none is stored.
    Recorded,
    /// A search.
    Search,
    /// The defaults.
    Defaults,
}

/// Work to cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Work {
    /// Seven contours at 50 mm/s.
    Contours,
    /// The contours, and the parts that come with the program.
    Development,
    /// Contours turned and scaled, and random programs, whose seeds were drawn after everything was
    /// tuned.
    HeldOut,
}

/// Geometry that a control compensates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Compensated {
    /// None.
    None,
    /// Geometry in the machine file, as `feedwright run` compensates it.
    Known,
    /// The same with wrong signs.
    Opposite,
    /// Geometry in a geometry file.
    File(PathBuf),
}

impl From<OsString> for Compensated {
    fn from(text: OsString) -> Self {
        match text.to_str() {
            Some("none") => Self::None,
            Some("known") => Self::Known,
            Some("opposite") => Self::Opposite,
            _ => Self::File(text.into()),
        }
    }
}

impl Compensated {
    /// The machine with such a control.
    pub(crate) fn on(&self, machine: &Machine) -> Result<Machine> {
        match self {
            Self::None => Ok(machine.clone()),
            Self::Known => Ok(machine.compensating_own()?),
            Self::File(path) => {
                let geometry = GeometryFile::read(path)?;
                geometry.check()?;
                Ok(machine.compensating(geometry.known()?)?)
            }
            Self::Opposite => {
                let mut opposite = machine.clone();
                for axis in &mut opposite.axes {
                    (axis.scale_um_m, axis.pitch_error_um) =
                        (-axis.scale_um_m, -axis.pitch_error_um);
                }
                let Squareness {
                    squareness_xy_urad,
                    squareness_xz_urad,
                    squareness_yz_urad,
                } = machine.geometry;
                opposite.geometry = Squareness {
                    squareness_xy_urad: -squareness_xy_urad,
                    squareness_xz_urad: -squareness_xz_urad,
                    squareness_yz_urad: -squareness_yz_urad,
                };
                Ok(Machine {
                    compensated: opposite.compensating_own()?.compensated,
                    ..machine.clone()
                })
            }
        }
    }
}

/// Knowledge of a machine that controllers get.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Given {
    /// Its parameters, an identification on it, or nothing, by the kind of the controller.
    Own,
    /// Parameters that are identified from a recording of the machine.
    Identified,
    /// Parameters that are 20 % off.
    #[value(name = "20%off")]
    TwentyPercentOff,
    /// An identification on tnv40.
    Unseen,
    /// Values identified from a log of the machine, including the settings of its drives.
    Log,
}

impl From<Given> for Knowledge {
    fn from(given: Given) -> Self {
        match given {
            Given::Own => Self::Own,
            Given::Identified => Self::Identified,
            Given::TwentyPercentOff => Self::TwentyPercentOff,
            Given::Unseen => Self::Unseen,
            Given::Log => Self::Log,
        }
    }
}

impl CompareArgs {
    pub(crate) fn tuning(&self) -> TuningSource {
        if self.record.is_some() {
            TuningSource::Search
        } else {
            self.tuning
        }
    }
}
