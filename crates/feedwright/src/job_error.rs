//! What can go wrong with a job: a program that is cut on a machine.

use feedwright_gcode::{self, CheckError, Program, ReadError, Summary};
use feedwright_plan::{LimitsError, PathError};
use feedwright_sim::{Cancelled, CompensationError, GeometryRefused, Machine, RunError, shown};
use thiserror::Error;

use crate::controllers::ModelMisfit;
use crate::fastest::FastestError;
use crate::measured::MeasuredError;
use crate::recorded_model::RecordedModelError;

/// Reasons why a job cannot be done.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum JobError {
    /// The program cannot be read at all.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Read(#[from] ReadError),
    /// The program has mistakes.
    #[error("{part}: {} mistake{}, nothing was cut", faults.len(), if faults.len() == 1 { "" } else { "s" })]
    Faults {
        /// The program.
        part: String,
        /// All of them, in program order.
        #[related]
        faults: Vec<feedwright_gcode::Diagnostic>,
    },
    /// A motion has no path.
    #[error("{part}: {fault}")]
    Path {
        /// The program.
        part: String,
        /// Cause.
        fault: PathError,
    },
    /// The program moves an axis that the machine does not have.
    #[error("{part} moves Z, and the machine `{machine}` has no [axis.z]")]
    #[diagnostic(help(
        "give the machine file a section [axis.z], or choose a machine with three axes"
    ))]
    NoZ {
        /// The program.
        part: String,
        /// The machine.
        machine: String,
    },
    /// A program with more motions than a correction keeps in memory.
    #[error(
        "{part} has {motions} motions and events, and a correction keeps up to {most} of them in memory"
    )]
    #[diagnostic(help(
        "split the program at a rapid and correct its parts one by one, or write it with longer blocks"
    ))]
    TooManyMotions {
        /// The program.
        part: String,
        /// Motions and events that it has.
        motions: u64,
        /// Largest number allowed.
        most: u64,
    },
    /// A program without a feed motion.
    #[error("{part} has no feed motion: there is nothing to cut")]
    #[diagnostic(help("G1, G2 and G3 cut; G0 is a rapid"))]
    NothingToCut {
        /// The program.
        part: String,
    },
    /// The geometry of the machine cannot be compensated.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Geometry(#[from] CompensationError),
    /// The geometry does not pass the check of its own measurement.
    #[error(transparent)]
    #[diagnostic(transparent)]
    GeometryRefused(#[from] GeometryRefused),
    /// The model does not suit.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Model(#[from] ModelMisfit),
    /// A value on the command line is out of its range.
    #[error("{name} is {}{unit}; it must lie {bounds}", shown(*value))]
    Value {
        /// Name of the option.
        name: &'static str,
        /// The value.
        value: f64,
        /// Unit of the value after a space, if it has one.
        unit: &'static str,
        /// The range in words.
        bounds: String,
        /// Remedy.
        #[help]
        hint: Option<&'static str>,
    },
    /// A corrected program was requested together with `--fastest` or `--reference`.
    #[error("no corrected program is made with {option}")]
    #[diagnostic(help("{}", if *option == "--fastest" {
        "the plan of least time holds for a cut with feedback: write its setpoints (.csv)"
    } else {
        "give the original as PART, without --reference"
    }))]
    NoProgramWith {
        /// The option.
        option: &'static str,
    },
    /// The log is not one of the program.
    #[error("{log} is not compared with {part}: {error}")]
    Measured {
        /// The log.
        log: String,
        /// The program.
        part: String,
        /// Cause.
        error: Box<MeasuredError>,
        /// Remedy.
        #[help]
        hint: Option<String>,
    },
    /// Nothing can be learned from a log of the part.
    #[error("{log} contains nothing for {part}: {error}")]
    NotLearned {
        /// The log.
        log: String,
        /// The program.
        part: String,
        /// Cause.
        error: String,
        /// Remedy.
        #[help]
        hint: Option<String>,
    },
    /// No plan is within the tolerance.
    #[error("{part}: {error}")]
    Fastest {
        /// The program.
        part: String,
        /// Cause.
        error: FastestError,
    },
    /// The cut did not come to its end.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(RunError),
    /// A log of the machine gives no model.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Recorded(#[from] RecordedModelError),
    /// The work was canceled.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Cancelled(#[from] Cancelled),
    /// A sink of the rows failed.
    #[error("the rows cannot be written: {0}")]
    Write(#[from] std::io::Error),
    /// The program went away, or changed, while it was cut.
    #[error("{part}: {cause}")]
    Reread {
        /// The program.
        part: String,
        /// Error of the operating system.
        cause: std::io::Error,
    },
}

impl JobError {
    /// A log that is not one of the program, with the remedy.
    pub(crate) fn of_log(log: &str, program: &Program, error: MeasuredError) -> Self {
        let hint = miette::Diagnostic::help(&error).map(|hint| hint.to_string());
        Self::Measured {
            log: log.to_owned(),
            part: program.name(),
            error: Box::new(error),
            hint,
        }
    }

    /// A log of the part that nothing can be learned from, with the remedy.
    pub(crate) fn of_part_log(
        log: &str,
        program: &Program,
        error: &dyn miette::Diagnostic,
    ) -> Self {
        let hint = error.help().map(|hint| hint.to_string());
        Self::NotLearned {
            log: log.to_owned(),
            part: program.name(),
            error: error.to_string(),
            hint,
        }
    }

    /// Converts the error of a cut of `program`.
    pub(crate) fn of_run(program: &Program, error: RunError) -> Self {
        match error {
            RunError::Read(error) => Self::Read(error),
            RunError::Path(fault) => Self::Path {
                part: program.name(),
                fault,
            },
            RunError::Write(error) => Self::Write(error),
            RunError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            RunError::Limits(_) | RunError::TooLong { .. } => Self::Run(error),
        }
    }
}

impl From<LimitsError> for JobError {
    fn from(error: LimitsError) -> Self {
        Self::Run(error.into())
    }
}

impl From<CheckError> for JobError {
    fn from(error: CheckError) -> Self {
        match error {
            CheckError::Read(error) => Self::Read(error),
            CheckError::Faults(faults) => {
                let part = faults
                    .first()
                    .map(|fault| fault.file.to_string())
                    .unwrap_or_default();
                Self::Faults { part, faults }
            }
        }
    }
}

/// Two axes where the program stays in the XY plane and the third would only stand still.
///
/// # Errors
/// A program that moves an axis that the machine does not have.
pub(crate) fn axes_that_move(
    program: &Program,
    summary: &Summary,
    machine: &Machine,
) -> Result<usize, JobError> {
    match (summary.moves[2], machine.axis_count()) {
        (false, _) => Ok(2),
        (true, 3..) => Ok(3),
        (true, _) => Err(JobError::NoZ {
            part: program.name(),
            machine: machine.name.clone(),
        }),
    }
}
