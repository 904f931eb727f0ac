//! The command line.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};
use feedwright::compare::{Knowledge, MAX_SEEDS, Shard};
use feedwright::gcode::{AUTO, Dialect, INCH_MM, Increment, Settings, ToolTable};
use miette::{Result, miette};

/// Predict the contour error of a CNC program on a machine, and correct it.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 110)]
pub(crate) struct Cli {
    /// Show no progress, and not as what a program is read.
    #[arg(short, long, global = true)]
    pub(crate) quiet: bool,
    #[command(subcommand)]
    pub(crate) command: CommandArgs,
}

#[derive(Debug, Subcommand)]
pub(crate) enum CommandArgs {
    /// Cut a part on a simulated machine, open loop and with a controller, and write the report.
    Run(Box<RunArgs>),
    /// Write a corrected program for a control that gets no feedback from us, and tell what it comes to as that control cuts it.
    Correct(CorrectArgs),
    /// Tell the cycle time of a program on a machine: by tool, by kind of motion, and what binds it.
    Plan(PlanArgs),
    /// Identify a machine from its LOG, and write its machine file; without a LOG, identify a simulated machine and write the
    /// model that a controller of `run` uses, for `run --model`.
    Identify(IdentifyArgs),
    /// Write a G-code program that shows how the axes of a machine behave: run it, record a log, identify the machine from it.
    Excite(ExciteArgs),
    /// Write what a component in a servo thread reads: a model, or a machine with exactly the numbers of its file, as a block of bytes.
    Block(BlockArgs),
    /// Run the experiments of Lee, Cho and Jeon (2005), section 4, and draw Figures 7 to 10.
    Paper(PaperArgs),
    /// Compare all controllers on contours and machines, in one table.
    Compare(CompareArgs),
    /// Cut programs on many machines, open loop and corrected, and list where the correction did harm.
    NeverWorse(NeverWorseArgs),
    /// The same with random programs on random machines, and the smallest case of what fails.
    HeldOut(HeldOutArgs),
    /// Report all mistakes of G-code programs, machine files and model files; of a folder, of all programs in it.
    Check(CheckArgs),
    /// Print the canonical motions of a program, one JSON object a line, in mm and s.
    Canon(CanonArgs),
    /// List the built-in machines.
    Machines,
    /// List the controllers; with a name, all of one and of its parameters.
    Controllers {
        /// Its name.
        name: Option<String>,
    },
}

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

#[derive(Debug, Args)]
pub(crate) struct CorrectArgs {
    /// G-code program.
    pub(crate) part: PathBuf,
    /// Built-in machine, or a machine file (.toml).
    #[arg(long, value_name = "NAME|FILE.toml", default_value = feedwright::machine::DEFAULT)]
    pub(crate) machine: OsString,
    /// Control that the corrected program is for: how it plans the speed, and what its blocks may hold.
    #[arg(long = "for", value_name = "CONTROL", default_value = feedwright::correct::TARGETS[0].name, long_help = controls())]
    pub(crate) target: String,
    /// Place of the corrected program; it is written only where it is better than the original, else the exit code is 1.
    #[arg(long, value_name = "FILE.ngc")]
    pub(crate) out: Option<PathBuf>,
    /// Largest contour error allowed of the corrected program as the control cuts it, um: exit code 1 where it is exceeded.
    #[arg(long, value_name = "UM", allow_negative_numbers = true)]
    pub(crate) tolerance: Option<f64>,
    /// Write all results.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) json: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

/// The controls of `--for`, one a line.
fn controls() -> String {
    let rows = feedwright::correct::TARGETS.iter().map(|target| format!("\n  {:<10} {}", target.name, target.about));
    let about = "Control that the corrected program is for: how it plans the speed, and what its blocks may hold.";
    about.to_owned() + &rows.collect::<String>()
}

#[derive(Debug, Args)]
pub(crate) struct PlanArgs {
    /// G-code program.
    pub(crate) part: PathBuf,
    /// Built-in machine, or a machine file (.toml).
    #[arg(long, value_name = "NAME|FILE.toml", default_value = feedwright::machine::DEFAULT)]
    pub(crate) machine: OsString,
    /// Distance of the planned path from the programmed one where the program says none, um, in place of the machine's
    /// path_tolerance_um.
    #[arg(long, value_name = "UM", allow_negative_numbers = true)]
    pub(crate) tolerance: Option<f64>,
    /// Planner in place of the one that suits the machine: trapezoid, time-optimal, unlimited, or linuxcnc, which plans as LinuxCNC 2.9 does.
    #[arg(long, value_name = "NAME")]
    pub(crate) planner: Option<String>,
    /// Plan each path from rest to rest as a whole too, and tell its time: what no plan can be faster than by much.
    #[arg(long)]
    pub(crate) bound: bool,
    /// Write all results.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) json: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

#[derive(Debug, Args)]
pub(crate) struct IdentifyArgs {
    /// Log of commanded and actual positions of a real machine: halsampler, halscope, MATLAB v5, Sinumerik Edge, or a table of text.
    /// Several are of one machine, with the same axes.
    #[arg(value_name = "LOG", conflicts_with_all = ["machine", "controller", "axes", "set", "seed"])]
    pub(crate) log: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) of_log: LogArgs,
    /// Built-in machine, or a machine file (.toml).
    #[arg(long, value_name = "NAME|FILE.toml", default_value = feedwright::machine::DEFAULT)]
    pub(crate) machine: OsString,
    /// Controller that the model is for; `feedwright controllers` lists them.
    #[arg(long, value_name = "NAME", default_value = feedwright::controllers::BEST)]
    pub(crate) controller: String,
    /// Axes of the model: 2 for programs that stay in the XY plane, 3 for others.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u8).range(2..=3))]
    pub(crate) axes: u8,
    /// Set a parameter of the controller; feed_period_s is the one that the model depends on.
    #[arg(long, value_name = "PARAMETER=VALUE")]
    pub(crate) set: Vec<String>,
    /// Seed of what is cut to identify the machine, and of the training.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Place of the machine file; of a simulated machine, of its model.
    #[arg(long, value_name = "FILE.toml", required_unless_present = "update")]
    pub(crate) out: Option<PathBuf>,
}

/// What is said of a log.
#[derive(Debug, Args)]
#[command(next_help_heading = "Options of a LOG")]
pub(crate) struct LogArgs {
    /// Which column is what, by number from 0 or by name, and units: t=0,x.cmd=1,x.act=3,x.torque=5,unit=mm,time=ms.
    #[arg(long, value_name = "COLUMNS", requires = "log")]
    pub(crate) columns: Option<feedwright::log::columns::Columns>,
    /// Machine file that is updated: what the logs do not tell stays as it is. It is written to --out, without that in its place.
    #[arg(long, value_name = "FILE.toml", requires = "log")]
    pub(crate) update: Option<PathBuf>,
    /// Fit this time of the log, s; all else by --score. Without both, blocks of motion take turns.
    #[arg(long, value_name = "FROM:TO", requires = "score", requires = "log")]
    pub(crate) fit: Option<Times>,
    /// Judge by this time of the log, s.
    #[arg(long, value_name = "FROM:TO", requires = "fit", requires = "log")]
    pub(crate) score: Option<Times>,
    /// Travel for a turn of the motor, mm; without it an axis counts as linear: kg, N s/m, N.
    #[arg(long, value_name = "MM_PER_REV", requires = "log", value_parser = positive)]
    pub(crate) lead: Option<f64>,
    /// Inertia at the motor, kg m2; without --lead the mass, kg. Positions do not tell it.
    #[arg(long, value_name = "KG_M2|KG", requires = "log", value_parser = positive)]
    pub(crate) inertia: Option<f64>,
    /// Viscous friction at the motor, N m s/rad; without --lead N s/m.
    #[arg(long, value_name = "N_M_S|N_S_PER_M", requires = "log", value_parser = positive)]
    pub(crate) viscous: Option<f64>,
    /// Torque, N m, for a unit of the torque column; without --lead force, N.
    #[arg(long, value_name = "N_M|N", requires = "log", value_parser = positive)]
    pub(crate) torque_gain: Option<f64>,
    /// Time over which the drive takes the speed from positions, s, of one that closes its loops at the rate of the log and recorded it
    /// itself: two samples are 0.002 at 1 kHz. Positions do not tell it.
    #[arg(long, value_name = "S", requires = "log", value_parser = positive)]
    pub(crate) speed_window: Option<f64>,
    /// By how much the log has the actual position later than the command, s: 0 where both were sampled at the same moment, as by
    /// halsampler. Without it a delay of the drive counts as one of the record.
    #[arg(long, value_name = "S", requires = "log", allow_negative_numbers = true)]
    pub(crate) record_delay: Option<f64>,
    /// Write a page: numbers, measured against predicted, what is left.
    #[arg(long, value_name = "FILE.html", requires = "log")]
    pub(crate) report: Option<PathBuf>,
    /// Write all results.
    #[arg(long, value_name = "FILE.json", requires = "log")]
    pub(crate) json: Option<PathBuf>,
}

/// A number above zero.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("it must be a number above 0".to_owned()),
    }
}

/// A part of a log.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Times(pub(crate) std::ops::Range<f64>);

impl std::str::FromStr for Times {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let ends = text.split_once(':').and_then(|(from, to)| Some((from.parse().ok()?, to.parse().ok()?)));
        match ends {
            Some((from, to)) if from < to => Ok(Self(from..to)),
            _ => Err("write two times in s, the earlier first, as in 0:12.5".to_owned()),
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct ExciteArgs {
    /// Built-in machine, or a machine file (.toml), whose limits the program keeps.
    #[arg(long, value_name = "NAME|LIMITS.toml")]
    pub(crate) machine: OsString,
    /// Travel of each axis, mm: half of it on each side of where the machine stands.
    #[arg(long, value_name = "MM", default_value_t = feedwright::excite::ExciteOptions::default().travel_mm, allow_negative_numbers = true)]
    pub(crate) travel: f64,
    /// Place of the program.
    #[arg(long, value_name = "FILE.ngc")]
    pub(crate) out: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct BlockArgs {
    /// Model file (.model.toml), built-in machine, or machine file (.toml).
    #[arg(value_name = "FILE.model.toml|NAME|FILE.toml")]
    pub(crate) file: OsString,
    /// Number of axes, 2 or 3 [default: all that there are].
    #[arg(long, value_parser = axes_of_a_block)]
    pub(crate) axes: Option<usize>,
    /// Place of the block.
    #[arg(long, value_name = "FILE.fwmodel")]
    pub(crate) out: PathBuf,
}

/// 2 or 3.
fn axes_of_a_block(text: &str) -> Result<usize, String> {
    match text {
        "2" => Ok(2),
        "3" => Ok(3),
        _ => Err("a block is of 2 or 3 axes".to_owned()),
    }
}

#[derive(Debug, Args)]
pub(crate) struct PaperArgs {
    /// Folder for the figures, the page and paper.json; made where it is missing.
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
    /// Built-in machine, or a machine file (.toml).
    #[arg(long, value_name = "NAME|FILE.toml", default_value = "tnv40")]
    pub(crate) machine: OsString,
    /// Number of seeds, from 1.
    #[arg(long, default_value_t = 10, value_parser = clap::value_parser!(u64).range(1..=1000))]
    pub(crate) seeds: u64,
}

#[derive(Debug, Args)]
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
    /// Set a parameter of a controller, such as two-dimensional.rho=0.01: it has its defaults then, and is not searched. May be given
    /// several times; `feedwright controllers NAME` lists them.
    #[arg(long, value_name = "NAME.PARAMETER=VALUE")]
    pub(crate) set: Vec<String>,
    /// Where the values of the controllers' parameters come from: earlier searches that are kept with the program (where there is none,
    /// a new search), a search for each controller and machine (an hour and more), or the defaults.
    #[arg(long, value_name = "SOURCE", value_enum, default_value_t = TuningSource::Recorded)]
    tuning: TuningSource,
    /// As --tuning defaults.
    #[arg(long, conflicts_with = "tuning")]
    no_tuning: bool,
    /// Search, and keep the values in this file beside those that it has; cut nothing. The program keeps core/src/compare/recorded.jsonl.
    #[arg(long, value_name = "FILE.jsonl", conflicts_with_all = ["json", "html", "merge", "at_tolerance"])]
    pub(crate) record: Option<PathBuf>,
    /// What is cut.
    #[arg(long, value_name = "WORK", value_enum, default_value_t = Work::Contours)]
    pub(crate) work: Work,
    /// Noise seeds that everything is cut with on a machine that has noise: the table has medians.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=i64::from(MAX_SEEDS)))]
    pub(crate) seeds: u32,
    /// What controllers are given of the machine; a row for each.
    #[arg(long, value_name = "GIVEN,...", value_enum, value_delimiter = ',', default_values_t = [Given::Own, Given::Identified, Given::TwentyPercentOff, Given::Unseen])]
    pub(crate) knowledge: Vec<Given>,
    /// Do only the i-th of n parts of the work; --merge puts the parts together.
    #[arg(long, value_name = "I/N", conflicts_with_all = ["json", "html", "merge"])]
    pub(crate) shard: Option<Shard>,
    /// Keep rows in this file as they are made, and go on with those that it has.
    #[arg(long, value_name = "FILE.jsonl", conflicts_with = "merge")]
    pub(crate) rows: Option<PathBuf>,
    /// Cut nothing: make the table of the rows in these files, with the same options as for them.
    #[arg(long, value_name = "FILE.jsonl,...", value_delimiter = ',')]
    pub(crate) merge: Vec<PathBuf>,
    /// Also find, for each smooth contour, the feedrate at which each controller just holds 10 um.
    #[arg(long)]
    pub(crate) at_tolerance: bool,
    /// Threads; all cores where it is left out. The table does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Write all rows.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) json: Option<PathBuf>,
    /// Write a page with the table and plots of the errors.
    #[arg(long, value_name = "FILE.html")]
    pub(crate) html: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

/// Where values of parameters come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TuningSource {
    /// Earlier searches that are kept with the program; a search where there is none.
    Recorded,
    /// A search.
    Search,
    /// The defaults.
    Defaults,
}

/// What is cut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Work {
    /// Seven contours at 50 mm/s.
    Contours,
    /// The contours, and the parts that come with the program.
    Development,
    /// Contours turned and scaled, and random programs, whose seeds were drawn after everything was tuned.
    HeldOut,
}

/// What controllers are given of a machine.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Given {
    /// Its parameters, an identification on it, or nothing, by the kind of the controller.
    Own,
    /// Parameters that are identified from a recording of the machine.
    Identified,
    /// Parameters that are 20 % off.
    #[value(name = "20%off")]
    TwentyPercentOff,
    /// An identification on tnv40.
    Unseen,
}

impl From<Given> for Knowledge {
    fn from(given: Given) -> Self {
        match given {
            Given::Own => Self::Own,
            Given::Identified => Self::Identified,
            Given::TwentyPercentOff => Self::TwentyPercentOff,
            Given::Unseen => Self::Unseen,
        }
    }
}

impl CompareArgs {
    pub(crate) fn tuning(&self) -> TuningSource {
        match (&self.record, self.no_tuning) {
            (Some(_), _) => TuningSource::Search,
            (None, true) => TuningSource::Defaults,
            (None, false) => self.tuning,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct NeverWorseArgs {
    /// G-code programs, and folders of programs.
    #[arg(required = true)]
    pub(crate) programs: Vec<PathBuf>,
    /// Only programs whose path fits this pattern, such as '*circle*'.
    #[arg(long, value_name = "GLOB")]
    pub(crate) only: Option<String>,
    /// Machine to cut on: built-in, or a machine file; may be given several times. Without it, 19 variants of tnv40.
    #[arg(long, value_name = "NAME|FILE.toml")]
    pub(crate) machine: Vec<OsString>,
    /// Cut no more of a program than this time of machining on tnv40, s.
    #[arg(long, value_name = "S", default_value_t = 600.0)]
    pub(crate) limit_s: f64,
    /// Cut so many of all pairs of program and machine, drawn by the seed.
    #[arg(long, value_name = "N")]
    pub(crate) sample: Option<usize>,
    #[command(flatten)]
    pub(crate) sweep: SweepArgs,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

#[derive(Debug, Args)]
pub(crate) struct HeldOutArgs {
    /// Seed of programs and machines.
    pub(crate) drawn_by: u64,
    /// Number of cuts.
    pub(crate) count: usize,
    /// Programs for each machine, which is identified once for all of them.
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u16).range(1..))]
    pub(crate) programs: u16,
    /// Only machines without encoder steps and delay.
    #[arg(long)]
    pub(crate) rigid: bool,
    /// Make the worst failures smaller and write each as DIR/N.ngc and DIR/N.toml.
    #[arg(long, value_name = "DIR")]
    pub(crate) failures: Option<PathBuf>,
    /// Failures that are made smaller.
    #[arg(long, value_name = "N", default_value_t = 10, requires = "failures")]
    pub(crate) smallest: usize,
    #[command(flatten)]
    pub(crate) sweep: SweepArgs,
}

/// How a controller is compared with open loop.
#[derive(Debug, Args)]
pub(crate) struct SweepArgs {
    /// Controller; `feedwright controllers` lists them.
    #[arg(long, value_name = "NAME", default_value = feedwright::controllers::BEST)]
    pub(crate) controller: String,
    /// Set a parameter of the controller, such as knots=10; may be given several times. `feedwright controllers NAME` lists them.
    #[arg(long, value_name = "PARAMETER=VALUE")]
    pub(crate) set: Vec<String>,
    /// Seed of the controller's training, and of the sample.
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Threads; all cores where it is left out. The result does not depend on it.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(crate) threads: Option<u16>,
    /// Where finished cuts are kept, so that an interrupted run goes on [default: in the cache, by version].
    #[arg(long, value_name = "FILE.jsonl")]
    pub(crate) journal: Option<PathBuf>,
    /// Write all cuts.
    #[arg(long, value_name = "FILE.json")]
    pub(crate) json: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct CheckArgs {
    /// G-code programs, machine files (.toml), model files (.model.toml), and folders of programs.
    #[arg(required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// How mistakes are told: text for people; json, sarif (2.1.0) and github (annotations of a workflow) on the standard output.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

#[derive(Debug, Args)]
pub(crate) struct CanonArgs {
    /// G-code program.
    pub(crate) file: PathBuf,
    #[command(flatten)]
    pub(crate) reader: ReaderArgs,
}

/// How programs are read; the same for all commands that read one.
#[derive(Debug, Args)]
#[command(next_help_heading = "Reading the program")]
pub(crate) struct ReaderArgs {
    /// Whose G-code it is: auto, linuxcnc, fanuc, haas, grbl, marlin or klipper; fanuc-mill, fanuc-lathe, haas-mill and haas-lathe where the
    /// program does not show the machine. auto looks at the beginning.
    #[arg(long, value_name = "NAME", default_value = AUTO)]
    pub(crate) dialect: String,
    /// What a length without a decimal point counts on a Fanuc or Haas: 0.01mm, 0.001mm or 0.0001mm [default: whole units].
    #[arg(long, value_name = "LENGTH", value_parser = Increment::named)]
    pub(crate) increment: Option<Increment>,
    /// Motions after which a program counts as endless.
    #[arg(long, value_name = "N", default_value_t = Settings::default().max_motions, value_parser = clap::value_parser!(u64).range(1..), allow_negative_numbers = true)]
    pub(crate) max_motions: u64,
    /// Lines without a motion in a row after which a loop counts as endless.
    #[arg(long, value_name = "N", default_value_t = Settings::default().max_idle_lines, value_parser = clap::value_parser!(u64).range(1..), allow_negative_numbers = true)]
    pub(crate) max_idle_lines: u64,
    /// Tools, as LinuxCNC keeps them: one `T1 P1 Z25.4 D6` a line.
    #[arg(long, value_name = "FILE.tbl")]
    pub(crate) tool_table: Option<PathBuf>,
    /// Unit of the lengths in the tool table.
    #[arg(long, value_name = "UNIT", value_enum, default_value_t = Unit::Mm, requires = "tool_table")]
    pub(crate) tool_unit: Unit,
    /// Folder of subroutines, each in a file of its name (.ngc); may be given several times. The program's own folder comes first.
    #[arg(long, value_name = "FOLDER")]
    pub(crate) subroutines: Vec<PathBuf>,
}

/// How mistakes are told.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    Text,
    Json,
    Sarif,
    Github,
}

/// Unit of lengths.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(crate) enum Unit {
    Mm,
    Inch,
}

impl ReaderArgs {
    /// What the reader has to know.
    pub(crate) fn settings(&self) -> Result<Settings> {
        let unit_mm = match self.tool_unit {
            Unit::Mm => 1.0,
            Unit::Inch => INCH_MM,
        };
        if let Some(folder) = self.subroutines.iter().find(|folder| !folder.is_dir()) {
            return Err(miette!(
                help = "name the folder that holds the files of the subroutines",
                "--subroutines {}: this is no folder",
                folder.display()
            ));
        }
        let tools = self.tool_table.as_deref().map(|table| ToolTable::read(table, unit_mm)).transpose()?;
        Ok(Settings {
            dialect: Dialect::named(&self.dialect)?,
            increment: self.increment,
            max_motions: self.max_motions,
            max_idle_lines: self.max_idle_lines,
            tools: tools.unwrap_or_default(),
            subroutine_paths: self.subroutines.clone(),
            ..Settings::default()
        })
    }
}
