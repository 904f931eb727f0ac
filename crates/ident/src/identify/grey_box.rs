//! Grey box: identifies a model of each axis of a real machine from recorded commanded and actual
//! positions.
//!
//! The drive is unknown. The identification fits the model of [`feedwright_control::axis`], divided
//! by the inertia, by output error over free runs: the model gets the commands and nothing else.
//! Terms are admitted one by one, by samples that were not fitted. Samples that served neither
//! purpose score the prediction error, next to linear models and the assumption that the error
//! stays constant.
//!
//! | File | What |
//! |---|---|
//! | `grey_box/axis_record.rs` | what was recorded of an axis |
//! | `grey_box/sample_split.rs` | which samples are fitted, and which are kept to judge by |
//! | `grey_box/terms.rs` | the numbers that positions determine |
//! | `grey_box/axis_run.rs` | free runs |
//! | `grey_box/known_value.rs`, `grey_box/priors.rs` | what is known before the record |
//! | `grey_box/output_error.rs` | least squares over free runs |
//! | `grey_box/admission.rs` | which terms there are |
//! | `grey_box/command_delay.rs` | by how many servo periods the position loop has commands late |
//! | `grey_box/standard_errors.rs` | intervals where what is left is coloured |
//! | `grey_box/unseen_motion.rs` | what a record leaves open |
//! | `grey_box/torque_column.rs` | what a torque column adds |
//! | `grey_box/linear_arx.rs`, `grey_box/start_filter.rs`, `grey_box/free_run_scores.rs` | how far predictions miss |
//! | `grey_box/residual_noise.rs` | what free runs leave, as a load |
//! | `grey_box/place_waves.rs` | interpolation error of the encoder and cogging |
//! | `grey_box/gain_changes.rs` | what other gains would bring |
//! | `grey_box/search_bound.rs` | values that end where their search ends |
//! | `grey_box/found_axis.rs`, `grey_box/verdict.rs` | what was found, and what to say of it |

pub(crate) mod axis_record;
pub(crate) mod sample_split;
pub(crate) mod terms;
pub(crate) mod known_value;
pub(crate) mod axis_facts;
mod priors;
mod axis_run;
mod output_error;
mod standard_errors;
mod admission;
pub(crate) mod unseen_motion;
pub(crate) mod torque_column;
pub(crate) mod linear_arx;
mod start_filter;
pub(crate) mod free_run_scores;
pub(crate) mod residual_noise;
pub(crate) mod place_waves;
pub(crate) mod gain_changes;
pub(crate) mod search_bound;
pub(crate) mod found_axis;
mod command_delay;
mod model_fit;
pub(crate) mod contour_scores;
pub(crate) mod verdict;

use std::ops::Range;

use thiserror::Error;

use crate::log::Log;
use axis_facts::AxisFacts;
use axis_record::AxisRecord;
use contour_scores::ContourScores;
use found_axis::FoundAxis;
use sample_split::SampleSplit;

/// Inputs of an identification besides the record.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GreyBoxOptions {
    /// Times that are fitted and times that are scored, s of the record. `None`: blocks of motion
    /// alternate.
    pub times_s: Option<[Range<f64>; 2]>,
    /// Known facts of each axis, in the order of the records. Nothing is known of an axis that is
    /// missing here.
    pub facts: Vec<AxisFacts>,
}

/// Result of the identification of a machine.
#[derive(Debug, Clone, PartialEq)]
pub struct FoundMachine {
    /// Its axes, in the order of the records.
    pub axes: Vec<FoundAxis>,
    /// Fitted samples and scored samples.
    pub split: SampleSplit,
    /// The contour error, where two axes move.
    pub contour: Option<ContourScores>,
    /// Time between two samples, s.
    pub sample_s: f64,
}

/// Why nothing was found.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum NotFound {
    /// No axis.
    #[error("the log has no axis with a commanded and an actual position")]
    NoAxis,
    /// Too little is left to fit or to judge by.
    #[error(
        "{part} has {found} samples, and {LEAST_SAMPLES} are needed\n  hint: the log goes from {from_s:.3} to {to_s:.3} s; give times within, or record for longer"
    )]
    TooFew {
        /// `--fit` or `--score`.
        part: &'static str,
        /// Samples that there are.
        found: usize,
        /// Beginning of the record, s.
        from_s: f64,
        /// Its end, s.
        to_s: f64,
    },
    /// An axis does not move where it is fitted.
    #[error(
        "axis {axis} does not move in what is to be fitted\n  hint: record both directions at several speeds, or give other times with --fit"
    )]
    AtRest {
        /// Its name.
        axis: String,
    },
    /// Ended from outside.
    #[error("interrupted")]
    Ended,
    /// No model fits.
    #[error(
        "no model of a servo axis fits axis {axis}: the best leaves {left_um:.1} um RMS of a following error of {following_um:.1} um\n  hint: check with --columns that command and actual position belong to this axis"
    )]
    NoModel {
        /// Its name.
        axis: String,
        /// RMS that is left, um.
        left_um: f64,
        /// RMS of the following error, um.
        following_um: f64,
    },
}

/// Samples that a fit or a score needs.
const LEAST_SAMPLES: usize = 100;

/// Mechanics periods in a servo period of the machine that is made of a record.
pub const SERVO_MECHANICS: u32 = axis_run::MECHANICS_PER_SERVO;

/// Servo period of that machine, s.
pub fn servo_period_s(sample_s: f64) -> f64 {
    axis_run::periods(sample_s).0.servo_s
}

/// Part of the work until it is known whether position loops have commands late.
const WITHOUT_DELAY: f64 = 0.6;

/// Identifies the axes of a log. `progress` receives the completed part of the work, 0 to 1, and
/// returns whether to go on.
///
/// # Errors
/// Fails if a record does not determine the model of an axis, or if `progress` ends the run.
pub fn identify_machine(
    log: &Log,
    options: &GreyBoxOptions,
    mut progress: impl FnMut(f64) -> bool,
) -> Result<FoundMachine, NotFound> {
    if log.axes.is_empty() {
        return Err(NotFound::NoAxis);
    }
    let (time_s, sample_s) = (&log.time_s[..], log.sample_time_s);
    let records = &AxisRecord::of(log)[..];
    let split = match &options.times_s {
        Some([fit, score]) => SampleSplit::by_times(records, time_s, fit.clone(), score.clone()),
        None => SampleSplit::by_motion(records),
    };
    let ends = [time_s.first(), time_s.last()].map(|time_s| time_s.copied().unwrap_or(0.0));
    for (part, counts) in [("--fit", &split.fit), ("--score", &split.score)] {
        let found = counts.iter().filter(|counts| **counts).count();
        if found < LEAST_SAMPLES {
            return Err(NotFound::TooFew {
                part,
                found,
                from_s: ends[0],
                to_s: ends[1],
            });
        }
    }
    let mut find = |facts: &[AxisFacts], from: f64, to: f64| -> Result<Vec<FoundAxis>, NotFound> {
        let axis = |(i, record): (usize, &AxisRecord<'_>)| {
            let facts = facts.get(i).copied().unwrap_or_default();
            let torque = log.axes[i].torque.as_deref();
            let done = |part: f64| from + (to - from) * (i as f64 + part) / records.len() as f64;
            model_fit::find(record, torque, &split, facts, &mut |part| {
                progress(done(part))
            })
        };
        records.iter().enumerate().map(axis).collect()
    };
    let mut axes = find(&options.facts, 0.0, WITHOUT_DELAY)?;
    if let Some(facts) = command_delay::shown(records, &axes, &split.fit) {
        // Terms were admitted without the delay: others may be there with it.
        let delayed = find(&facts, WITHOUT_DELAY, 1.0)?;
        let left = |axes: &[FoundAxis]| axes.iter().map(|axis| libm::log(axis.fit_um)).sum::<f64>();
        if left(&delayed) < left(&axes) {
            let stated = axes.iter().map(|axis| axis.facts).collect::<Vec<_>>();
            axes = delayed
                .into_iter()
                .zip(stated)
                .map(|(axis, facts)| FoundAxis { facts, ..axis })
                .collect();
            axes.iter_mut().for_each(|axis| {
                axis.at_bounds
                    .extend(command_delay::at_bound(axis, sample_s));
            });
        }
    }
    for (axis, record) in axes.iter_mut().zip(records) {
        axis.waves = axis.waves_in(record);
    }
    let contour = ContourScores::of(records, &axes, &split.score);
    Ok(FoundMachine {
        axes,
        split,
        contour,
        sample_s,
    })
}
