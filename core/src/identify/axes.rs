//! Axes identified from a recording: what each is, by its law, and the statistics of its noise.
//!
//! What a drive is set to is known; [`super::axis_parameters`] finds inertia and friction, [`super::axis_statistics`] the noise. Of an axis that does not move so that they show,
//! nothing is found.

use feedwright_control::model::IdentifiedAxes;

use super::Excitation;
use super::axis_parameters::{DriveSettings, NotIdentified, identify};
use super::axis_statistics::axis_statistics;
use super::recording::Recording;
use crate::machine::{Known, Machine};

/// Identified axes and how well they fit.
#[derive(Debug, Clone, PartialEq)]
pub struct TrainedAxes<const N: usize> {
    /// The axes.
    pub axes: IdentifiedAxes<N>,
    /// RMS of what a free run leaves of the measured positions, um per axis.
    pub fit_um: f64,
    /// Knots that they were found from.
    pub samples: usize,
}

/// What a machine showed, each at its servo period.
#[derive(Debug, Clone, PartialEq)]
pub struct AxisRecordings<const N: usize> {
    /// With offsets, for the law: [`Excitation::axis_parameters`].
    pub parameters: Recording<N>,
    /// Without, for the statistics: [`Excitation::statistics`].
    pub statistics: Recording<N>,
}

impl<const N: usize> AxisRecordings<N> {
    /// Of a simulated machine.
    pub fn of(machine: &Machine, seed: u64) -> Self {
        let (parameters, _) = Excitation::axis_parameters(machine).record(machine, seed);
        Self { parameters, statistics: Excitation::statistics(machine).record_in_one(machine, seed) }
    }

    /// Both as one.
    pub fn joined(&self) -> Recording<N> {
        let mut joined = self.parameters.clone();
        joined.stretches.extend_from_slice(&self.statistics.stretches);
        joined
    }
}

/// Finds the axes of a machine whose drives are set as it is known.
///
/// # Errors
/// A recording in which parameters do not show.
pub fn train<const N: usize>(recordings: &AxisRecordings<N>, known: &Known) -> Result<TrainedAxes<N>, NotIdentified> {
    let found = |i: usize| {
        let axis = known.axis(i);
        let settings = DriveSettings::of(axis, &known.period);
        identify(&recordings.parameters, i, &settings).map(|found| (found.parameters.believed(axis, &settings), found))
    };
    let found = (0..N).map(found).collect::<Result<Vec<_>, _>>()?;
    let believed = known.with_axes(|i, axis| found.get(i).map_or(*axis, |(believed, _)| *believed));
    let statistics = axis_statistics(&recordings.statistics, &believed);
    let axes = std::array::from_fn(|i| believed.axis(i).with_statistics(known.period.periods(), statistics[i]));
    let square_um2: f64 = found.iter().map(|(_, found)| found.left_um * found.left_um).sum();
    Ok(TrainedAxes {
        axes: IdentifiedAxes { mechanics_s: known.period.mechanics_s, axes },
        fit_um: (square_um2 / N as f64).sqrt(),
        samples: recordings.joined().stretches.iter().map(Vec::len).sum(),
    })
}
