//! Axes identified from a recording: what each is, by its law, and the statistics of its noise.
//!
//! What a drive is set to is known; [`super::axis_parameters`] finds inertia and friction. Of an axis that does not move so that they show,
//! nothing is found.

use feedwright_control::axis::knowledge::AxisKnowledge;
use feedwright_control::model::IdentifiedAxes;

use super::axis_parameters::{DriveSettings, NotIdentified, identify};
use super::recording::Recording;
use crate::machine::Known;

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

/// Finds the axes of a machine whose drives are set as it is known.
///
/// # Errors
/// A recording in which parameters do not show.
pub fn train<const N: usize>(recording: &Recording<N>, known: &Known) -> Result<TrainedAxes<N>, NotIdentified> {
    let mut axes = [AxisKnowledge::NOTHING; N];
    let mut square_um2 = 0.0;
    for (i, identified) in axes.iter_mut().enumerate() {
        let axis = known.axis(i);
        let settings = DriveSettings::of(axis, &known.period);
        let found = identify(recording, i, &settings)?;
        square_um2 += found.left_um * found.left_um / N as f64;
        let believed = found.parameters.believed(axis, &settings);
        let statistics = interim(&believed);
        *identified = believed.with_statistics(known.period.periods(), statistics);
    }
    let samples = recording.stretches.iter().map(Vec::len).sum();
    let axes = IdentifiedAxes { mechanics_s: known.period.mechanics_s, axes };
    Ok(TrainedAxes { axes, fit_um: square_um2.sqrt(), samples })
}

/// Until the recording is asked for them: usual ones.
fn interim(axis: &crate::machine::KnownAxis) -> feedwright_control::axis::statistics::AxisStatistics {
    let rad = axis.nominal.rad_per_mm * 1e-3;
    feedwright_control::axis::statistics::AxisStatistics {
        encoder_noise_rad: 0.1 * rad,
        torque_noise_nm: 0.005 * axis.nominal.torque_limit_nm,
        torque_noise_s: 0.005,
        ..Default::default()
    }
}
