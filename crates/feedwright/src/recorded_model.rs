//! The model that a user has of a machine: identified only from a log.
//!
//! ```text
//! program of excite -> cut uncorrected -> log of commands and encoders
//!     -> model of each axis -> machine -> model
//! ```
//!
//! Models are kept by content: the same program and the same machine find the same model. The
//! results of the logs of built-in machines are shipped with the program:
//! `recorded_model/built_in.rs`.

mod built_in;

use std::path::Path;

use feedwright_gcode::Program;
use feedwright_ident::{
    AxisFacts, Columns, ExciteOptions, Log, Model, ModelVerdict, excitation_program, recorded_log,
};
use feedwright_sim::{Cancelled, Machine, Watch};
use miette::Diagnostic;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use thiserror::Error;

use crate::controllers::{Choices, Entry, Setup, identifying};
use crate::identifier_cache::geometry_content;
use crate::log_job::{LogIdentified, LogJob, LogJobError, identified_machine};
use crate::store::{keep, kept, program_key};

/// Largest number of machines that are drawn from a log. They are kept with the machine itself.
const MOST_FITTING: usize = 32;
/// Bits by which the number of a draw is shifted before it is added to the seed of the log, so that
/// consecutive seeds give different draws.
const SEED_SHIFT: u32 = 32;

/// Share of the log in the time of a first model, and of its recording in the time of the log: the
/// progress goes by them. Measured with a file like `workshop`, 20 s of 23 s, and 2.7 s of 19.4 s;
/// other machines take other shares, and their time left is off by as much.
const LOG_SHARE: f64 = 0.85;
const RECORD_SHARE: f64 = 0.14;

/// Seed of the logs that the program is shipped with: the default of `run`.
pub(crate) const BUILT_IN_SEED: u64 = 1;

/// A model that was identified from a log of a simulated machine.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct RecordedModel {
    /// The model.
    pub(crate) model: Model,
    /// Axes that the log does not determine well enough, in words.
    pub(crate) warnings: Vec<String>,
    /// Machines that fit the log about as well.
    pub(crate) fitting: Vec<Machine>,
}

/// Reasons why there is no model.
#[derive(Debug, Error, Diagnostic)]
pub enum RecordedModelError {
    /// The model of an axis cannot be identified from the log.
    #[error("a log of {machine} determines no model: {cause}")]
    #[diagnostic(help(
        "give a model with --model, take the settings of the drives from the machine file with --exact-settings, or cut without \
         a correction: --controller uncorrected"
    ))]
    NotDetermined {
        /// Name of the machine.
        machine: String,
        /// Cause.
        cause: String,
    },
    /// The work was canceled.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Result of a log: a machine or a model, and the axes in it that are uncertain.
struct FromLog<T> {
    found: T,
    warnings: Vec<String>,
    /// Other machines that fit the log about as well; `None` for a draw that no machine can be.
    fitting: Vec<Option<Machine>>,
}

/// The same as it is kept and shipped, with the texts of files.
#[derive(Serialize, Deserialize)]
struct KeptFromLog {
    text: String,
    #[serde(rename = "doubts")]
    warnings: Vec<String>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    fitting: Vec<String>,
}

/// A value whose file reads back as the same value, to the bit.
trait InFile: Sized {
    fn text(&self) -> String;
    fn read(text: &str) -> Option<Self>;
}

impl InFile for Machine {
    fn text(&self) -> String {
        self.text()
    }

    fn read(text: &str) -> Option<Self> {
        Self::parse("a machine file of the log", text).ok()
    }
}

impl InFile for Model {
    fn text(&self) -> String {
        self.text()
    }

    fn read(text: &str) -> Option<Self> {
        Self::parse("the model of the log", text).ok()
    }
}

impl KeptFromLog {
    fn of<T: InFile>(from_log: &FromLog<T>) -> Self {
        let text = |machine: &Option<Machine>| machine.as_ref().map(Machine::text);
        Self {
            text: from_log.found.text(),
            warnings: from_log.warnings.clone(),
            fitting: from_log
                .fitting
                .iter()
                .map(|machine| text(machine).unwrap_or_default())
                .collect(),
        }
    }

    fn read<T: InFile>(self) -> Option<FromLog<T>> {
        Some(FromLog {
            found: T::read(&self.text)?,
            warnings: self.warnings,
            fitting: self.fitting.iter().map(|text| InFile::read(text)).collect(),
        })
    }
}

impl<T: InFile> FromLog<T> {
    /// Returns what is shipped with the program, with at least `fitting` machines, or what is kept
    /// for the content; otherwise makes it.
    fn of(
        content: &Value,
        fitting: usize,
        make: impl FnOnce() -> Result<Self, RecordedModelError>,
    ) -> Result<Self, RecordedModelError> {
        if let Some(shipped) = built_in::from_log(content)
            .filter(|texts| texts.fitting.len() >= fitting)
            .and_then(KeptFromLog::read)
        {
            return Ok(shipped);
        }
        let Some(key) = program_key(content) else {
            return make();
        };
        if let Some(kept) = kept(&key).and_then(KeptFromLog::read) {
            return Ok(kept);
        }
        let made = make()?;
        keep(&key, &KeptFromLog::of(&made));
        Ok(made)
    }
}

impl FromLog<Machine> {
    /// Identifies a machine from a new log.
    fn identified(
        machine: &Machine,
        axes: usize,
        seed: u64,
        watch: &dyn Watch,
    ) -> Result<Self, RecordedModelError> {
        let mut identified = identified(machine, axes, seed, watch)?;
        let (name, warnings) = (
            format!("{} by its log", machine.name),
            warnings(&identified),
        );
        let recorded = identified_machine(&identified, &name)
            .map_err(|error| not_determined(machine, &error))?;
        let found = identified.machine.axes.clone();
        let mechanics_s = recorded.period.mechanics_s;
        let draw = |number: u64| {
            let seed = |axis: usize| {
                seed.wrapping_add((MOST_FITTING as u64 * axis as u64 + number) << SEED_SHIFT)
            };
            identified.machine.axes = found
                .iter()
                .enumerate()
                .map(|(i, axis)| axis.drawn(seed(i), mechanics_s))
                .collect();
            identified_machine(&identified, &name).ok()
        };
        Ok(Self {
            found: recorded,
            warnings,
            fitting: (1..=MOST_FITTING as u64).map(draw).collect(),
        })
    }
}

/// Returns the model of the first two or three axes of a machine, for a controller that uses one.
/// The machine cuts the program of `excite` uncorrected, and the model is identified from the log.
/// `date` becomes the date in the model file. `fitting` machines that fit the log about as well are
/// with it.
///
/// # Errors
/// No model can be identified from the log, or the work is canceled.
pub(crate) fn recorded_model(
    machine: &Machine,
    axes: usize,
    (entry, choices): (&Entry, &Choices),
    date: String,
    fitting: usize,
    watch: &dyn Watch,
) -> Result<RecordedModel, RecordedModelError> {
    let content = model_content(machine, axes, (entry, choices));
    let make = || {
        let mut steps = identifying(machine, watch);
        let (from_log, warnings) = steps.filled(LOG_SHARE, |watch| {
            recorded_machine(machine, axes, choices.seed, watch)
        })?;
        Ok(FromLog {
            found: trained(machine, &from_log, axes, (entry, choices), date)?,
            warnings,
            fitting: vec![],
        })
    };
    let from_log = FromLog::of(&content, 0, make)?;
    Ok(RecordedModel {
        model: from_log.found,
        warnings: from_log.warnings,
        fitting: match fitting {
            0 => Vec::new(),
            number => fitting_machines(machine, axes, choices.seed, number, watch)?,
        },
    })
}

/// Describes the inputs that determine the model of a log.
fn model_content(machine: &Machine, axes: usize, (entry, choices): (&Entry, &Choices)) -> Value {
    json!(["model", axes, entry.name, choices, log_content(machine)])
}

/// Returns the model of a machine that was identified from a log.
fn trained(
    machine: &Machine,
    from_log: &Machine,
    axes: usize,
    (entry, choices): (&Entry, &Choices),
    date: String,
) -> Result<Model, RecordedModelError> {
    Setup::new(from_log, choices)
        .train(entry, axes, date)
        .map_err(|error| not_determined(machine, &error))
}

/// Returns the first axes of a machine as identified from their log, and the axes that the log does
/// not determine well enough.
///
/// Fails if the model of an axis cannot be identified from the log, or if the work is canceled.
pub fn recorded_machine(
    machine: &Machine,
    axes: usize,
    seed: u64,
    watch: &dyn Watch,
) -> Result<(Machine, Vec<String>), RecordedModelError> {
    let from_log = machine_from_log(machine, axes, seed, 0, watch)?;
    Ok((from_log.found, from_log.warnings))
}

/// Returns up to 32 machines that fit the same log about as well. Their models are drawn from the
/// uncertainty of the identification; a draw beyond the ranges of a machine file is left out. The
/// same log gives the same machines.
///
/// # Errors
/// Fails as [`recorded_machine`] does.
fn fitting_machines(
    machine: &Machine,
    axes: usize,
    seed: u64,
    number: usize,
    watch: &dyn Watch,
) -> Result<Vec<Machine>, RecordedModelError> {
    let from_log = machine_from_log(machine, axes, seed, number, watch)?;
    Ok(from_log
        .fitting
        .into_iter()
        .flatten()
        .take(number)
        .collect())
}

/// Computes again what is shipped with the program for a built-in machine: the machine identified
/// from its log, and the model from it for a controller, as `run` has them by default. `date`
/// becomes the date in the model.
///
/// # Errors
/// Fails as [`recorded_machine`] does.
pub fn built_in_lines(
    machine: &Machine,
    axes: usize,
    entry: &Entry,
    date: String,
    watch: &dyn Watch,
) -> Result<Vec<String>, RecordedModelError> {
    let from_log = FromLog::identified(machine, axes, BUILT_IN_SEED, watch)?;
    let choices = Choices {
        seed: BUILT_IN_SEED,
        tries: true,
        ..Choices::default()
    };
    let mut lines = vec![built_in::line(
        &content(machine, axes, BUILT_IN_SEED),
        &KeptFromLog::of(&from_log),
    )];
    // A log that identifies a machine need not give a model: each cut then reports that.
    if let Ok(found) = trained(machine, &from_log.found, axes, (entry, &choices), date) {
        let model = KeptFromLog::of(&FromLog {
            found,
            warnings: from_log.warnings,
            fitting: vec![],
        });
        lines.push(built_in::line(
            &model_content(machine, axes, (entry, &choices)),
            &model,
        ));
    }
    Ok(lines)
}

/// Describes the inputs that determine the machine of a log.
fn content(machine: &Machine, axes: usize, seed: u64) -> Value {
    json!([
        "machine and those that fit",
        axes,
        seed,
        log_content(machine)
    ])
}

/// Describes the inputs that determine a log, and what is written with it. A field that a machine
/// does not use changes nothing.
fn log_content(machine: &Machine) -> Value {
    json!([
        machine.name,
        machine.fingerprint(),
        geometry_content(machine)
    ])
}

/// Returns the machine from the log and at least `fitting` others that fit as well: shipped with
/// the program, kept, or identified.
fn machine_from_log(
    machine: &Machine,
    axes: usize,
    seed: u64,
    fitting: usize,
    watch: &dyn Watch,
) -> Result<FromLog<Machine>, RecordedModelError> {
    FromLog::of(&content(machine, axes, seed), fitting, || {
        FromLog::identified(machine, axes, seed, watch)
    })
}

/// Records the log, and identifies the axes.
fn identified(
    machine: &Machine,
    axes: usize,
    seed: u64,
    watch: &dyn Watch,
) -> Result<LogIdentified, RecordedModelError> {
    // What is random in the log is not what is random in the cut.
    let recorder = Machine {
        axes: machine.axes.iter().take(axes).cloned().collect(),
        ..machine.clone()
    };
    let recorder = recorder.with_noise_seed(machine.noise.seed.wrapping_add(seed));
    let mut steps = identifying(machine, watch);
    let excitation = excitation_program(&recorder, ExciteOptions::default());
    let program = Program::from_text(
        "excite.ngc",
        excitation
            .map_err(|error| not_determined(machine, &error))?
            .text,
    );
    let text = match axes {
        2 => recorded_log::<2>(&recorder, &program),
        _ => recorded_log::<3>(&recorder, &program),
    };
    let text = text.map_err(|error| not_determined(machine, &error))?;
    let name = Path::new("the log of excite");
    let read = |watch: &dyn Watch| {
        Log::from_reader(
            name,
            text.as_bytes(),
            text.len() as u64,
            &Columns::default(),
            watch,
        )
    };
    let log = steps
        .filled(RECORD_SHARE, read)
        .map_err(|error| not_determined(machine, &error))?;
    let facts = AxisFacts {
        record_delay_s: Some(0.0),
        ..AxisFacts::default()
    };
    let job = LogJob {
        name: format!("a log of {}", machine.name),
        facts,
        ..LogJob::default()
    };
    steps
        .filled(1.0, |watch| job.run(log, watch))
        .map_err(|error| match error {
            LogJobError::Cancelled(cancelled) => RecordedModelError::Cancelled(cancelled),
            error => not_determined(machine, &error),
        })
}

fn not_determined(machine: &Machine, cause: &dyn Diagnostic) -> RecordedModelError {
    let reasons = cause
        .related()
        .into_iter()
        .flatten()
        .map(|reason| format!("; {reason}"));
    RecordedModelError::NotDetermined {
        machine: machine.name.clone(),
        cause: format!("{cause}{}", reasons.collect::<String>()),
    }
}

/// Returns the axes whose model is open or not good enough for a correction.
fn warnings(identified: &LogIdentified) -> Vec<String> {
    let is_sound = |verdict| {
        matches!(
            verdict,
            ModelVerdict::ModelHolds | ModelVerdict::LinearSuffices
        )
    };
    let axes = identified
        .machine
        .axes
        .iter()
        .enumerate()
        .filter(|(_, axis)| !is_sound(ModelVerdict::of(axis)));
    axes.map(|(i, axis)| {
        format!(
            "axis {}, by its simulated log: {}",
            axis.name,
            identified.verdict(i)
        )
    })
    .collect()
}

#[cfg(test)]
mod tests {
    use feedwright_sim::BUILT_IN_MACHINES;

    use super::*;
    use crate::controllers::{BEST, CONTROLLERS};

    #[test]
    fn what_the_program_is_shipped_with_is_found_by_the_machines_of_today() {
        let entry = CONTROLLERS.find(BEST).unwrap();
        let choices = Choices {
            seed: BUILT_IN_SEED,
            tries: true,
            ..Choices::default()
        };
        let (mut logs, mut models) = (0, 0);
        for (name, _) in BUILT_IN_MACHINES {
            let machine = Machine::load(name.as_ref()).unwrap();
            for axes in [2, 3] {
                logs += usize::from(
                    built_in::from_log(&content(&machine, axes, BUILT_IN_SEED)).is_some(),
                );
                models += usize::from(
                    built_in::from_log(&model_content(&machine, axes, (entry, &choices))).is_some(),
                );
            }
        }
        assert_eq!(
            logs + models,
            built_in::lines().count(),
            "a first cut identifies anew: `just built-in-logs`"
        );
    }
}
