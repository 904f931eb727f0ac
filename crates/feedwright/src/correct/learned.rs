//! Learns the machine from logs of cuts of the part, for the next correction: iterative learning
//! from part to part.
//!
//! Each log is the cut of a program: the original, or one that was corrected before. The log has
//! that program's command, so its text is not needed.
//!
//! 1. The log is checked and aligned with the original by its command (`part_record.rs`).
//! 2. The [values of the model](model_fit) are corrected as far as the logs show them. Values
//!    that were learned at one command then hold at another.
//! 3. The error that the model still does not explain is laid over the path. [The part that
//!    repeats](repeats) is added to the simulated tool.
//!
//! The correction then uses the simulated tool as before. Its prediction has a band, which covers
//! other likely values of the model and the error that did not repeat.
//!
//! Source: iterative learning control (Bristow, Tharayil and Alleyne 2006).
//!
//! | File | Content |
//! |---|---|
//! | `error.rs` | reasons why nothing is learned from a log |
//! | `part_record.rs` | a log in the coordinates of the program |
//! | `model_fit.rs` | values of the model |
//! | `repeats.rs` | the error that repeats |
//! | `place_error.rs` | errors moved from the samples of one command to the samples of another |

mod error;
mod part_record;
mod model_fit;
mod repeats;
mod place_error;

use feedwright_plan::Step;
use feedwright_plan::vector::{Vector, add_scaled, dot, sub};
use feedwright_sim::{Machine, Row, Stages, Watch};
use serde::Serialize;

use super::nominal::deterministic;
use crate::measured::MeasuredLog;
pub(crate) use error::LearnError;
pub(crate) use model_fit::LearnedValue;
use model_fit::{ModelFit, at, fit, followed, noise_of};
pub(crate) use part_record::CutProgram;
use part_record::PartRecord;
pub(super) use place_error::PathTrack;
pub(crate) use place_error::PlaceError;
use repeats::repeating;

/// Seed of the sample of noise.
const SEED: u64 = 0x5eed;
/// Largest error across the path that a model may leave unexplained: this fraction of the contour
/// error that it explains, plus [`MOST_LEFT_UM`], um. A log with a larger remainder is rejected as
/// too noisy.
const MOST_LEFT: f64 = 0.7;
const MOST_LEFT_UM: f64 = 0.5;
/// A cut of the original is reported if its time differs from the planned time by more than this
/// fraction.
#[cfg(feature = "command")]
const SAME_TIME: f64 = 0.02;

/// Source and content of one log.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LearnedLog {
    /// The log.
    pub(crate) log: String,
    /// Program that was cut.
    pub(crate) program: CutProgram,
    /// RMS distance of its command from the original program, um.
    pub(crate) off_um: f64,
    /// Time between samples, s.
    pub(crate) sample_time_s: f64,
    /// Duration of the cut, s.
    pub(crate) time_s: f64,
    /// Time that the original is planned to take, s.
    pub(crate) planned_s: f64,
    /// Measured RMS contour error, um.
    pub(crate) rms_um: f64,
    /// Largest measured contour error, um.
    pub(crate) max_um: f64,
    /// RMS distance across the path between the model of the machine file and the measured
    /// position, um.
    pub(crate) model_missed_um: f64,
    /// The same distance with the values that the logs show, um.
    pub(crate) missed_um: f64,
}

/// The error that the next cut is predicted to have at the encoders.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct PredictedCut {
    /// RMS contour error, um.
    pub rms_um: f64,
    /// Band of the RMS contour error, um.
    pub band_um: [f64; 2],
    /// Upper end of the part that repeats from cut to cut, um.
    pub(crate) repeats_um: f64,
    /// Largest contour error, um.
    pub(crate) max_um: f64,
}

/// Result of learning from logs.
#[derive(Debug, Clone, Serialize)]
pub struct LearnedOutcome {
    /// The logs, in their order.
    pub(crate) logs: Vec<LearnedLog>,
    /// Values of the model.
    pub(crate) values: Vec<LearnedValue>,
    /// RMS across the path of the error that repeats beside the model and is corrected, um.
    pub(crate) repeats_um: f64,
    /// RMS across the path of the error that does not repeat, um.
    pub(crate) rest_um: f64,
    /// The next cut, where a program was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub predicted: Option<PredictedCut>,
}

impl LearnedLog {
    /// Returns true if the control took another time for the program than planned.
    #[cfg(feature = "command")]
    pub(crate) fn takes_another_time(&self) -> bool {
        self.program == CutProgram::Original
            && (self.time_s / self.planned_s - 1.0).abs() > SAME_TIME
    }
}

/// The machine as the logs show it.
pub(super) struct LearnedMachine {
    /// Machine of the file, with the values that the logs show.
    pub(super) machine: Machine,
    /// The same machine with other values that are as likely.
    pub(super) likely: Vec<Machine>,
    /// Error that repeats beside the model.
    pub(super) error: PlaceError,
    pub(super) outcome: LearnedOutcome,
}

/// Program that the logs belong to.
pub(super) struct LoggedProgram<'a> {
    pub(super) machine: &'a Machine,
    pub(super) stages: Stages,
    pub(super) original: &'a [Step],
    pub(super) axes: usize,
    pub(super) watch: &'a dyn Watch,
}

impl LoggedProgram<'_> {
    /// Learns the machine from logs.
    ///
    /// # Errors
    /// The name of a log that cannot be used, and the reason.
    pub(super) fn learned(
        &self,
        logs: &[MeasuredLog],
    ) -> Result<LearnedMachine, (String, LearnError)> {
        let record = |log: &MeasuredLog| {
            let record = PartRecord::of(
                log,
                self.machine,
                self.stages,
                self.original,
                self.axes,
                self.watch,
            );
            record.map_err(|error| (log.name.clone(), error))
        };
        let records = logs.iter().map(record).collect::<Result<Vec<_>, _>>()?;
        let all = || {
            logs.iter()
                .map(|log| log.name.as_str())
                .collect::<Vec<_>>()
                .join(", ")
        };
        let fit =
            fit(self.machine, &records, self.axes, self.watch).map_err(|error| (all(), error))?;
        let outcomes = self
            .outcomes(&records, &fit)
            .map_err(|error| (all(), error))?;
        // A corrected part has less error than the noise of its log, so the largest error of all
        // logs counts.
        let error = |log: &LearnedLog| (log.rms_um.powi(2) - log.missed_um.powi(2)).max(0.0).sqrt();
        let error_um = outcomes.iter().map(error).fold(0.0, f64::max);
        if let Some(log) = outcomes
            .iter()
            .find(|log| log.missed_um > MOST_LEFT * error_um + MOST_LEFT_UM)
        {
            return Err((
                log.log.clone(),
                LearnError::TooNoisy {
                    rest_um: log.missed_um,
                    error_um,
                },
            ));
        }
        // The best record is the one with the smallest error: it is nearest to the next cut.
        let best = (0..records.len())
            .min_by(|&a, &b| records[a].rms_mm.total_cmp(&records[b].rms_mm))
            .unwrap_or(0);
        let (error, apart) = placed(&records, &fit, best);
        let rows = &records[best].cut.rows;
        let [repeats_um, rest_um] =
            [&error.error_mm, &apart].map(|error_mm| across_um(rows, error_mm));
        let outcome = LearnedOutcome {
            logs: outcomes,
            values: fit.values,
            repeats_um,
            rest_um,
            predicted: None,
        };
        Ok(LearnedMachine {
            machine: fit.machine,
            likely: fit.likely,
            error,
            outcome,
        })
    }

    fn outcomes(
        &self,
        records: &[PartRecord],
        fit: &ModelFit,
    ) -> Result<Vec<LearnedLog>, LearnError> {
        let steps = Box::new(self.original.iter().cloned().map(Ok));
        let mut reference = self
            .stages
            .reference(steps, self.machine)
            .map_err(LearnError::Limits)?;
        let end_s = reference.read_to_end_s();
        let file = deterministic(self.machine);
        let mut outcome = |n: usize, record: &PartRecord| {
            let first = record.cut.first;
            let start_s_mm = record.cut.rows.first().map_or(0.0, |row| row.s_mm);
            // Rests before and behind the cut do not count.
            let step_s = record.cut.sample_s;
            let moves = |k: &usize| {
                let sample = reference.at(*k as f64 * step_s);
                !sample.resting && sample.s_mm > start_s_mm
            };
            let mut moving = (0..(end_s / step_s) as usize).filter(moves);
            let begin = moving.next().unwrap_or(0);
            let planned_s = (moving.next_back().unwrap_or(begin) - begin) as f64 * step_s;
            let samples = record.cut.command_mm.len();
            let ratio = record.cut.sample_s / self.machine.period.servo_s;
            let model = followed(&file, record, samples, None);
            let late = fit.late_s[n] / record.cut.sample_s;
            let missed = |k: usize| {
                sub(
                    record.cut.actual_mm[k],
                    at(&model, (k as f64 + late) * ratio),
                )
            };
            let missed: Vec<Vector> = (first..samples).map(missed).collect();
            LearnedLog {
                log: record.name.clone(),
                program: record.program,
                off_um: 1e3 * record.off_mm,
                sample_time_s: record.cut.sample_s,
                time_s: record.time_s(),
                planned_s,
                rms_um: 1e3 * record.rms_mm,
                max_um: 1e3 * record.max_mm,
                model_missed_um: across_um(&record.cut.rows, &missed),
                missed_um: across_um(&record.cut.rows, &fit.left_mm[n][first..]),
            }
        };
        Ok(records
            .iter()
            .enumerate()
            .map(|(n, record)| outcome(n, record))
            .collect())
    }
}

/// Computes the RMS across the path of the vectors of the rows, where the tool cuts, um.
fn across_um(rows: &[Row], vectors_mm: &[Vector]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (row, vector) in rows.iter().zip(vectors_mm).filter(|(row, _)| row.cutting) {
        let along = dot(*vector, row.tangent);
        sum += dot(*vector, *vector) - along * along;
        count += 1.0;
    }
    1e3 * (f64::max(sum, 0.0) / f64::max(count, 1.0)).sqrt()
}

/// Lays the remainders of all records over the samples of the best record. Returns the error that
/// repeats, and the error of the best record that does not.
fn placed(records: &[PartRecord], fit: &ModelFit, best: usize) -> (PlaceError, Vec<Vector>) {
    let track = |record: &PartRecord| PathTrack {
        sample_s: record.cut.sample_s,
        s_mm: record.cut.rows.iter().map(|row| row.s_mm).collect(),
        command_mm: record.cut.rows.iter().map(|row| row.cmd_mm).collect(),
    };
    let here = track(&records[best]);
    let left = |n: usize| fit.left_mm[n][records[n].cut.first..].to_vec();
    let beside = |n: usize| {
        if n == best {
            return left(n);
        }
        PlaceError {
            track: track(&records[n]),
            error_mm: left(n),
        }
        .along(&here)
    };
    let all: Vec<Vec<Vector>> = (0..records.len()).map(beside).collect();
    let noise = noise_of(&fit.machine, &records[best], SEED).split_off(records[best].cut.first);
    let error_mm = repeating(&all, &noise);
    let apart = left(best)
        .iter()
        .zip(&error_mm)
        .map(|(left, repeats)| add_scaled(*left, -1.0, *repeats))
        .collect();
    (
        PlaceError {
            track: here,
            error_mm,
        },
        apart,
    )
}
