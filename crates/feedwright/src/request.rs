//! Request for a job, as a user states it: names, paths, texts and values with their units.
//!
//! Command line, sweep, Python, gym and page each make a [`JobRequest`]. An option is one field of
//! it: the jobs read it there. `JobRequest::job` (`job/lowered.rs`) reads the files, looks the names
//! up, and makes the job that runs.

pub(crate) mod named;
mod setting_map;

use std::path::{Path, PathBuf};
use std::str::FromStr;

use feedwright_gcode::input;
use feedwright_gcode::{AUTO, Dialect, INCH_MM, Increment, Program, Settings, ToolTable};
use feedwright_ident::{Columns, Log};
use feedwright_sim::{DEFAULT_MACHINE, GeometryFile, Machine, Watch, is_machine_path};
use miette::{Result, miette};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::compensation::{GeometryChoice, NamedGeometry};
use crate::controllers::{BASELINE, BEST, CONTROLLERS, Choices, Controllers, Entry};
use crate::correct::advise::AdviseJob;
use crate::correct::{CorrectJob, TARGETS, TargetControl};
use crate::job_error::JobError;
use crate::measured::MeasuredLog;
use named::{find, find_control, settings};
#[cfg(feature = "command")]
pub(crate) use setting_map::setting;

/// Largest error of a machine file that `--file-error` takes, %: beyond it, a file says too little
/// of a machine.
const MAX_FILE_ERROR: f64 = 50.0;

/// A tolerance of a metre is a mistaken unit.
const MAX_TOLERANCE_UM: f64 = 1e6;

/// Request for a job. Serialized, its fields are the keys of a job of a sweep; those that a sweep
/// had before others came are always written, since its addresses follow from them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct JobRequest {
    /// Path of the program, and its name in the results.
    pub program: PathBuf,
    /// Text of the program; it is not read from the path then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub program_text: Option<String>,
    /// Name or path of the machine, and its name in the results.
    pub machine: PathBuf,
    /// Text of the machine file; it is not read from the path then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine_text: Option<String>,
    /// Name of the controller.
    pub controller: String,
    /// Name of the controller that it is compared with.
    pub against: String,
    /// Values of its parameters; those of the other controller are called `NAME.parameter`.
    #[serde(with = "setting_map")]
    pub settings: Vec<(String, Value)>,
    /// Path of the model file.
    pub model: Option<PathBuf>,
    /// Takes the settings of the drives from the machine file.
    pub exact_settings: bool,
    /// Machines that fit the recording and are cut, too.
    pub band: u8,
    /// Seed of the recording.
    pub seed: u64,
    /// Largest contour error allowed, um.
    pub tolerance_um: Option<f64>,
    /// Feedrate in place of every programmed one, mm/s.
    pub feed_mm_s: Option<f64>,
    /// Cuts in the least time within the tolerance.
    pub fastest: bool,
    /// Name of the dialect.
    pub dialect: String,
    /// Path of the tool table.
    pub tool_table: Option<PathBuf>,
    /// The lengths in it are inches.
    pub inch_tools: bool,
    /// Folders of subroutines.
    pub subroutines: Vec<PathBuf>,
    /// Length of one unit of a number without a decimal point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub increment: Option<Increment>,
    /// Motions after which a program counts as endless.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_motions: Option<u64>,
    /// Lines without a motion in a row after which a loop counts as endless.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_idle_lines: Option<u64>,
    /// Path of the program that errors are measured to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reference: Option<PathBuf>,
    /// Path of the geometry file that is compensated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub geometry: Option<PathBuf>,
    /// Leaves the geometry uncompensated.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub no_geometry: bool,
    /// Paths of logs of a machine that cut the program.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub logs: Vec<PathBuf>,
    /// Columns of the logs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub columns: Option<String>,
    /// Name of the control that a corrected program is made for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub target: Option<String>,
    /// Standard deviation of each value of the machine file, %.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub file_error: Option<f64>,
    /// Finds which limit of the machine binds along the path, for the page.
    #[serde(skip)]
    pub with_limits: bool,
    /// Keeps the model that the controller has at the end of the cut.
    #[serde(skip)]
    pub learns: bool,
    /// Folder that the paths start in.
    #[serde(skip)]
    pub folder: PathBuf,
}

impl Default for JobRequest {
    fn default() -> Self {
        Self {
            program: PathBuf::new(),
            program_text: None,
            machine: DEFAULT_MACHINE.into(),
            machine_text: None,
            controller: BEST.to_owned(),
            against: BASELINE.to_owned(),
            settings: Vec::new(),
            model: None,
            exact_settings: false,
            band: 0,
            seed: 1,
            tolerance_um: None,
            feed_mm_s: None,
            fastest: false,
            dialect: AUTO.to_owned(),
            tool_table: None,
            inch_tools: false,
            subroutines: Vec::new(),
            increment: None,
            max_motions: None,
            max_idle_lines: None,
            reference: None,
            geometry: None,
            no_geometry: false,
            logs: Vec::new(),
            columns: None,
            target: None,
            file_error: None,
            with_limits: false,
            learns: false,
            folder: PathBuf::new(),
        }
    }
}

impl JobRequest {
    /// Returns a path of the request, from the folder of its paths.
    pub(crate) fn at(&self, path: impl AsRef<Path>) -> PathBuf {
        self.folder.join(path)
    }

    /// Returns the files that it reads beside program and machine, each with its option.
    #[cfg(feature = "command")]
    pub(crate) fn files(&self) -> impl Iterator<Item = (&'static str, &PathBuf)> {
        let files = [
            ("--model", &self.model),
            ("--tool-table", &self.tool_table),
            ("--reference", &self.reference),
            ("--geometry", &self.geometry),
        ];
        let logs = self.logs.iter().map(|log| ("--log", log));
        let named = files
            .into_iter()
            .filter_map(|(name, file)| Some((name, file.as_ref()?)));
        named.chain(logs)
    }

    /// Returns the program.
    pub fn program(&self) -> Program {
        match &self.program_text {
            Some(text) => Program::from_text(self.program.display().to_string(), text),
            None => Program::in_file(self.at(&self.program)),
        }
    }

    /// Returns the machine.
    ///
    /// # Errors
    /// A machine file that cannot be read or has mistakes, and a name that no machine has.
    pub fn machine(&self) -> Result<Machine> {
        Ok(match &self.machine_text {
            Some(text) => Machine::parse(&self.machine.display().to_string(), text)?,
            None if is_machine_path(&self.machine) => Machine::read(&self.at(&self.machine))?,
            None => Machine::load(self.machine.as_os_str())?,
        })
    }

    /// Returns the name of the machine file; `None` for a built-in machine.
    pub fn machine_file(&self) -> Option<String> {
        let is_file = self.machine_text.is_some() || is_machine_path(&self.machine);
        is_file.then(|| input::name(&self.machine))
    }

    /// Returns the settings of the reader of the program.
    ///
    /// # Errors
    /// A dialect that does not exist, and a tool table that cannot be read.
    pub fn reader(&self) -> Result<Settings> {
        let unit_mm = if self.inch_tools { INCH_MM } else { 1.0 };
        let tools = self
            .tool_table
            .as_ref()
            .map(|path| ToolTable::read(&self.at(path), unit_mm))
            .transpose()?;
        let usual = Settings::default();
        Ok(Settings {
            dialect: Dialect::named(&self.dialect)?,
            increment: self.increment,
            max_motions: self.max_motions.unwrap_or(usual.max_motions),
            max_idle_lines: self.max_idle_lines.unwrap_or(usual.max_idle_lines),
            tools: tools.unwrap_or_default(),
            subroutine_paths: self.subroutines.iter().map(|path| self.at(path)).collect(),
            ..usual
        })
    }

    /// Returns the geometry that is compensated.
    ///
    /// # Errors
    /// A geometry file that cannot be read or has mistakes.
    pub(crate) fn compensation(&self) -> Result<GeometryChoice> {
        let Some(path) = self.geometry.as_ref().filter(|_| !self.no_geometry) else {
            return Ok(if self.no_geometry {
                GeometryChoice::Off
            } else {
                GeometryChoice::Machine
            });
        };
        let path = self.at(path);
        Ok(GeometryChoice::File(Box::new(NamedGeometry {
            geometry: GeometryFile::read(&path)?,
            name: input::name(&path),
        })))
    }

    /// Refuses a request without a program, and names of controllers and parameters that do not
    /// exist.
    ///
    /// # Errors
    /// The first of them.
    pub fn check_names(&self, table: Controllers) -> Result<()> {
        if self.program.as_os_str().is_empty() {
            return Err(miette!(
                help = "program = \"part.ngc\"",
                "a job needs a program"
            ));
        }
        self.choices(self.controllers(table)?, table).map(drop)
    }

    /// The requested controller, and the one for comparison.
    pub(crate) fn controllers(&self, table: Controllers) -> Result<[&'static Entry; 2]> {
        Ok([find(&self.controller, table)?, find(&self.against, table)?])
    }

    pub(crate) fn choices(
        &self,
        both @ [controller, _]: [&'static Entry; 2],
        table: Controllers,
    ) -> Result<Choices> {
        let texts: Vec<String> = self.settings.iter().map(setting_map::text).collect();
        Ok(Choices {
            seed: self.seed,
            set: settings(&texts, table, Some(controller), &both)?,
            tries: true,
            ..Choices::default()
        })
    }

    /// Makes the job that corrects the program for a control without feedback.
    ///
    /// # Errors
    /// See [`JobRequest::job`], a tolerance and a file error out of range.
    pub fn correct_job(&self, watch: &dyn Watch) -> Result<CorrectJob> {
        let target = self.control()?;
        self.check_tolerance()?;
        self.check_file_error()?;
        Ok(CorrectJob {
            feed_mm_s: self.feed_mm_s,
            compensation: self.compensation()?,
            reader: self.reader()?,
            logs: self.measured(watch)?,
            file_error: self.file_error_part(),
            ..CorrectJob::new(self.program(), self.machine()?, target)
        })
    }

    /// Makes the job that finds the feedrates at which the tolerance holds.
    ///
    /// # Errors
    /// See [`JobRequest::job`], a tolerance that is missing, or out of range as the file error.
    pub fn advise_job(&self) -> Result<AdviseJob> {
        let target = self.control()?;
        self.check_tolerance()?;
        let tolerance_um = self
            .tolerance_um
            .ok_or_else(|| miette!("the tolerance is missing"))?;
        self.check_file_error()?;
        Ok(AdviseJob {
            controller: find(&self.controller, CONTROLLERS)?,
            choices: Choices {
                seed: self.seed,
                ..Choices::default()
            },
            compensation: self.compensation()?,
            reader: self.reader()?,
            file_error: self.file_error_part(),
            ..AdviseJob::new(self.program(), self.machine()?, target, tolerance_um)
        })
    }

    /// The control that a corrected program is for.
    fn control(&self) -> Result<&'static TargetControl> {
        self.target.as_deref().map_or(Ok(&TARGETS[0]), find_control)
    }

    /// Refuses a tolerance that is not above 0 or looks like another unit.
    pub(crate) fn check_tolerance(&self) -> Result<(), JobError> {
        let in_range = |value: &f64| *value > 0.0 && *value <= MAX_TOLERANCE_UM;
        let Some(value) = self.tolerance_um.filter(|value| !in_range(value)) else {
            return Ok(());
        };
        Err(JobError::Value {
            name: "--tolerance",
            value,
            unit: " um",
            bounds: format!("above 0 and up to {MAX_TOLERANCE_UM} um"),
            hint: Some("the unit is um: 0.01 mm is --tolerance 10"),
        })
    }

    /// Returns the error of the machine file, %: the stated one, or the usual one of a file.
    fn file_error_percent(&self) -> f64 {
        let is_file = self.machine_file().is_some();
        self.file_error
            .unwrap_or_else(|| 100.0 * CorrectJob::usual_file_error(is_file))
    }

    /// Refuses an error of the machine file that is out of range.
    pub(crate) fn check_file_error(&self) -> Result<()> {
        let percent = self.file_error_percent();
        if (0.0..=MAX_FILE_ERROR).contains(&percent) {
            return Ok(());
        }
        Err(miette!(
            help = "the unit is percent: 0 if the values are exact, 10 if they are typed by hand",
            "--file-error is {percent} %; it must lie between 0 and {MAX_FILE_ERROR} %"
        ))
    }

    /// Returns the error of the machine file, as a fraction.
    pub(crate) fn file_error_part(&self) -> f64 {
        self.file_error_percent() / 100.0
    }

    /// Reads the logs.
    pub(crate) fn measured(&self, watch: &dyn Watch) -> Result<Vec<MeasuredLog>> {
        let columns = self.columns.as_deref().map(Columns::from_str).transpose()?;
        let columns = columns.unwrap_or_default();
        let read = |path: &PathBuf| {
            let path = self.at(path);
            Ok(MeasuredLog {
                name: input::name(&path),
                log: Log::read_watched(&path, &columns, watch)?,
            })
        };
        self.logs.iter().map(read).collect()
    }
}
