//! Axes identified from a recording: the parameters of each axis, and the statistics of its noise.
//!
//! The drive settings are known. [`super::axis_parameters`] finds inertia and friction,
//! [`super::axis_statistics`] the noise. If the motion of an axis does not show them, nothing is
//! found for it.

use feedwright_control::{IdentifiedAxes, Part};
use feedwright_sim::{Known, Machine, map_in_parallel};

use super::Excitation;
use super::axis_parameters::{AxisEstimate, NotIdentified, identify_axis};
use super::axis_statistics::axis_statistics;
use super::recording::Recording;

/// Identified axes and how well they fit.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainedAxes<const N: usize> {
    /// The axes.
    pub axes: IdentifiedAxes<N>,
    /// Estimates of each axis, with standard errors.
    pub estimates: Vec<AxisEstimate>,
    /// RMS of what a free run leaves of the measured positions, um per axis.
    pub fit_um: f64,
    /// Knots that they were found from.
    pub samples: usize,
}

/// Recordings of a machine, each at its servo period.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisRecordings<const N: usize> {
    /// Recording with offsets, for the parameters: [`Excitation::axis_parameters`].
    pub(crate) parameters: Recording<N>,
    /// Recording without offsets, for the statistics: [`Excitation::statistics`].
    pub(crate) statistics: Recording<N>,
}

impl<const N: usize> AxisRecordings<N> {
    /// Records a simulated machine.
    pub fn of(machine: &Machine, seed: u64) -> Self {
        let (parameters, _) = Excitation::axis_parameters(machine).record(machine, seed);
        Self {
            parameters,
            statistics: Excitation::statistics(machine).record_in_one(machine, seed),
        }
    }

    /// Both as one.
    pub fn joined(&self) -> Recording<N> {
        let mut joined = self.parameters.clone();
        joined
            .stretches
            .extend_from_slice(&self.statistics.stretches);
        joined
    }
}

/// Finds the axes of a machine whose drives are set as it is known; they are to be used on one
/// whose drives may be set otherwise.
///
/// # Errors
/// A recording in which parameters do not show.
pub fn train_axes<const N: usize>(
    recordings: &AxisRecordings<N>,
    known: &Known,
    used_on: &Known,
) -> Result<TrainedAxes<N>, NotIdentified> {
    let estimate = |i: usize| identify_axis(&recordings.parameters, i, known);
    // All, and then the first axis that fails: not the one whose thread is first.
    let estimates = map_in_parallel(0..N, estimate)
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?;
    let assumed = |of: &Known| {
        of.with_axes(|i, axis| estimates.get(i).map_or(*axis, |found| found.assumed(axis)))
    };
    let statistics = axis_statistics(&recordings.statistics, &assumed(known));
    let here = assumed(used_on);
    let axes = IdentifiedAxes {
        periods: used_on.period.periods(),
        axes: std::array::from_fn(|i| here.axis(i).nominal.taking(&[Part::Noise], &statistics[i])),
    };
    // What no axis can be, a component in a servo thread would refuse.
    if !axes.are_possible(used_on.period.servo_s) {
        return Err(NotIdentified::NotExcited);
    }
    let square_um2: f64 = estimates
        .iter()
        .map(|found| found.left_um * found.left_um)
        .sum();
    let samples = [&recordings.parameters, &recordings.statistics];
    let samples = samples
        .iter()
        .flat_map(|recording| &recording.stretches)
        .map(Vec::len)
        .sum();
    Ok(TrainedAxes {
        axes,
        estimates,
        fit_um: (square_um2 / N as f64).sqrt(),
        samples,
    })
}
