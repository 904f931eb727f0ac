//! What is asked for, and what can go wrong with it.

use std::io::BufRead;
use std::path::PathBuf;

use thiserror::Error;

use super::Outputs;
use crate::controllers::{Choices, Entry, ModelMisfit};
use crate::feed::LimitsError;
use crate::gcode::canon::{Canon, MotionKind};
use crate::gcode::{self, CheckError, ReadError, Reader, Summary};
use crate::machine::Machine;
use crate::model::Model;
use crate::output::OutputError;
use crate::path::PathError;
use crate::report::{Report, Run, WorstPlace};
use crate::trace::{Outcome, Row, Sink};

/// A part, a machine, two controllers, and what to write.
#[derive(Debug, Clone)]
pub struct Job {
    /// The G-code program.
    pub part: PathBuf,
    /// The machine that cuts it.
    pub machine: Machine,
    /// The controller that is asked for.
    pub controller: &'static Entry,
    /// What it is compared against.
    pub against: &'static Entry,
    /// Replaces every programmed feedrate, mm/s.
    pub feed_mm_s: Option<f64>,
    /// Settings of the controllers.
    pub choices: Choices,
    /// A model for the controller that is asked for, in place of a training.
    pub model: Option<Model>,
    /// Largest contour error that is allowed, um.
    pub tolerance_um: Option<f64>,
    /// Settings of the reader.
    pub reader: gcode::Settings,
    /// Files that were read to make this job, besides the program: no output may take their place.
    pub inputs: Vec<PathBuf>,
    /// Files to write.
    pub outputs: Outputs,
}

/// What the job is at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Reading the whole program once.
    Reading,
    /// Making a controller: training its identifier, where it is not in the cache.
    Preparing {
        /// Name of the controller.
        controller: &'static str,
    },
    /// Cutting.
    Cutting {
        /// Name of the controller.
        controller: &'static str,
    },
    /// Writing the files.
    Writing,
}

/// Is told how the job goes on.
pub trait Progress {
    /// A stage begins.
    fn stage(&mut self, stage: Stage);
    /// Part of the stage that is done, 0 to 1.
    fn part(&mut self, part: f64);
}

/// Tells nobody.
impl Progress for () {
    fn stage(&mut self, _: Stage) {}
    fn part(&mut self, _: f64) {}
}

/// Why a job cannot be done.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum Error {
    /// The program cannot be read at all.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Read(#[from] ReadError),
    /// The program has mistakes.
    #[error("{}: {} mistake{}, nothing was cut", part.display(), faults.len(), if faults.len() == 1 { "" } else { "s" })]
    Faults {
        /// The program.
        part: PathBuf,
        /// All of them, in program order.
        #[related]
        faults: Vec<gcode::Diagnostic>,
    },
    /// A motion has no path.
    #[error("{}: {fault}", part.display())]
    Path {
        /// The program.
        part: PathBuf,
        /// Why.
        fault: PathError,
    },
    /// The machine's limits are none.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Limits(#[from] LimitsError),
    /// The program moves an axis that the machine does not have.
    #[error("{} moves Z, and the machine `{machine}` has no [axis.z]", part.display())]
    #[diagnostic(help("give the machine file a section [axis.z], or choose a machine with three axes"))]
    NoZ {
        /// The program.
        part: PathBuf,
        /// The machine.
        machine: String,
    },
    /// A value on the command line is out of its range.
    #[error("{name} is {}{unit}; it must lie {bounds}", shown(*value))]
    Value {
        /// Name of the option.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its unit after a space, where it has one.
        unit: &'static str,
        /// The range in words.
        bounds: String,
        /// Remedy.
        #[help]
        hint: Option<&'static str>,
    },
    /// `--out` with an ending that says nothing.
    #[error("{} does not say what to write", path.display())]
    #[diagnostic(help("the ending decides: .csv for setpoints, .ngc for G-code"))]
    Ending {
        /// The place.
        path: PathBuf,
    },
    /// The model does not suit.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Model(#[from] ModelMisfit),
    /// A file cannot be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Output(#[from] OutputError),
    /// The program went away, or changed, while it was cut.
    #[error("{}: {cause}", part.display())]
    Reread {
        /// The program.
        part: PathBuf,
        /// What the system says.
        cause: std::io::Error,
    },
}

/// A number for people: with an exponent where it would be a row of zeros.
fn shown(value: f64) -> String {
    let plain = value == 0.0 || !value.is_finite() || (1e-5..1e9).contains(&value.abs());
    if plain { value.to_string() } else { format!("{value:e}") }
}

impl Job {
    /// The controllers in the order in which they cut: the one that is asked for last, and once.
    pub(super) fn controllers(&self) -> Vec<&'static Entry> {
        if self.against.name == self.controller.name {
            vec![self.controller]
        } else {
            vec![self.against, self.controller]
        }
    }

    /// Two axes where the program stays in the XY plane and the third would only stand still.
    pub(super) fn axes(&self, summary: &Summary) -> Result<usize, Error> {
        match (summary.moves[2], self.machine.axis_count()) {
            (false, _) => Ok(2),
            (true, 3..) => Ok(3),
            (true, _) => Err(Error::NoZ { part: self.part.clone(), machine: self.machine.name.clone() }),
        }
    }

    /// The canonical steps of the program, with the feedrate replaced where that was asked for.
    pub(super) fn program(&self) -> Result<impl Iterator<Item = Canon> + Send + use<>, Error> {
        let feed_mm_s = self.feed_mm_s;
        // The program was checked from end to end before: a mistake here means that the file changed, and ends it.
        let steps = Reader::open(&self.part, self.reader.clone())?.map_while(Result::ok);
        Ok(steps.map(move |mut step| {
            if let (Canon::Motion(motion), Some(feed_mm_s)) = (&mut step, feed_mm_s)
                && motion.kind == MotionKind::Feed
            {
                motion.feed_mm_s = feed_mm_s;
            }
            step
        }))
    }

    /// The part as the report calls it: the file's name.
    pub(super) fn part_name(&self) -> String {
        self.part.file_name().unwrap_or(self.part.as_os_str()).to_string_lossy().into_owned()
    }

    /// Looks up the texts of the worst places' lines, in one pass over the program.
    pub(super) fn fill_in_texts(&self, worst: &mut [WorstPlace]) -> Result<(), Error> {
        let reread = |cause| Error::Reread { part: self.part.clone(), cause };
        let last = worst.iter().map(|place| place.line).max().unwrap_or(0);
        let mut file = std::io::BufReader::new(std::fs::File::open(&self.part).map_err(reread)?);
        let mut text = Vec::new();
        for line in 1..=last {
            text.clear();
            file.read_until(b'\n', &mut text).map_err(reread)?;
            for place in worst.iter_mut().filter(|place| place.line == line) {
                place.text = String::from_utf8_lossy(&text).trim_end().to_owned();
            }
        }
        Ok(())
    }

    /// Everything that the page shows.
    pub(super) fn report(&self, axes: usize, summary: &Summary, runs: Vec<Run>) -> Report {
        let value = |name: &str, value: String| (name.to_owned(), value);
        let mut settings = vec![
            value("Compared against", self.against.name.to_owned()),
            value("Controller", format!("{}: {}", self.controller.name, self.controller.summary)),
            value("Source of the method", self.controller.source.to_owned()),
            value("Axes controlled", axes.to_string()),
            value("Program read as", format!("{}: {}", summary.dialect.0, summary.dialect.1)),
            value("Seed", self.choices.seed.to_string()),
        ];
        if let Some(model) = self.model.as_ref().map(Model::about) {
            settings.push(value("Model", format!("{}, {}", model.source, model.date)));
        }
        for set in &self.choices.set {
            settings.push(value(&format!("{}, {}", set.controller, set.name), set.value.to_string()));
        }
        if let Some(feed_mm_s) = self.feed_mm_s {
            settings.push(value("Feedrate, in place of the programmed", format!("{feed_mm_s} mm/s")));
        }
        Report {
            title: format!("{} on {}", self.part_name(), self.machine.name),
            part: self.part_name(),
            machine: describe(&self.machine),
            settings,
            tolerance_um: self.tolerance_um,
            runs,
        }
    }

    /// Whether the run that was asked for is one to be content with.
    pub(super) fn within_tolerance(&self, report: &Report) -> bool {
        report.runs.last().is_some_and(|run| {
            run.summary.outcome == Outcome::Completed
                && self.tolerance_um.is_none_or(|tolerance_um| run.summary.max_um <= tolerance_um)
        })
    }
}

/// The machine's values, named and with units.
fn describe(machine: &Machine) -> Vec<(String, String)> {
    let mut lines = vec![
        ("Machine".to_owned(), format!("{}: {}", machine.name, machine.description)),
        ("Source".to_owned(), machine.source.clone()),
    ];
    // The keys of the file carry their units; the serialisation lists all of them without a second list here.
    let sections = [
        ("period".to_owned(), serde_json::json!(machine.period)),
        ("limits".to_owned(), serde_json::json!(machine.limits)),
    ];
    let axes =
        ["x", "y", "z"].iter().zip(&machine.axes).map(|(name, axis)| (format!("axis.{name}"), serde_json::json!(axis)));
    for (section, values) in sections.into_iter().chain(axes) {
        for (key, value) in values.as_object().into_iter().flatten() {
            lines.push((format!("{section}.{key}"), value.to_string()));
        }
    }
    lines
}

/// Tells the progress of a cut by its arc length.
pub(super) struct Told<'a> {
    progress: &'a mut dyn Progress,
    length_mm: f64,
    rows: u32,
}

/// Rows between two tellings: a tenth of a second of machining.
const ROWS_BETWEEN: u32 = 100;

impl<'a> Told<'a> {
    pub(super) fn new(progress: &'a mut dyn Progress, summary: &Summary) -> Self {
        Self { progress, length_mm: summary.feed_mm + summary.rapid_mm, rows: 0 }
    }
}

impl Sink for Told<'_> {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        self.rows += 1;
        if self.rows == ROWS_BETWEEN {
            self.rows = 0;
            self.progress.part((row.s_mm / self.length_mm).min(1.0));
        }
        Ok(())
    }
}

/// Rows go to files whose errors name them; anything else is of the program.
impl From<std::io::Error> for Error {
    fn from(error: std::io::Error) -> Self {
        Self::Output(OutputError::from_io(error, std::path::Path::new("the output")))
    }
}

impl From<CheckError> for Error {
    fn from(error: CheckError) -> Self {
        match error {
            CheckError::Read(error) => Self::Read(error),
            CheckError::Faults(faults) => {
                let part = faults.first().map(|fault| PathBuf::from(&*fault.file)).unwrap_or_default();
                Self::Faults { part, faults }
            }
        }
    }
}
