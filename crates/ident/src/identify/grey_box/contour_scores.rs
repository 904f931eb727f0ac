//! The contour error that predictions leave, where two axes move.
//!
//! ```text
//! eps = n . (p - c)      n normal of the commanded motion in the plane of the axes
//! ```

use super::axis_record::AxisRecord;
use super::found_axis::FoundAxis;
use crate::average::rms;

/// RMS of the contour error, and of what predictions miss of it, um.
#[derive(Debug, Clone, PartialEq)]
pub struct ContourScores {
    /// Axes of the plane, by place.
    pub plane: [usize; 2],
    /// Measured.
    pub measured_um: f64,
    /// Error of the free run of the grey box.
    pub grey_box_um: f64,
    /// Error of the free run of the best ARX.
    pub arx_um: f64,
}

/// Part of the highest speed of an axis above which it moves.
const MOVES: f64 = 0.01;
/// Samples that are needed.
const LEAST_SAMPLES: usize = 50;

impl ContourScores {
    /// Scores the first two axes that move together.
    pub(super) fn of(
        records: &[AxisRecord<'_>],
        axes: &[FoundAxis],
        scored: &[bool],
    ) -> Option<Self> {
        let speeds: Vec<Vec<f64>> = records.iter().map(AxisRecord::command_speed_mm_s).collect();
        let planes = (0..axes.len()).flat_map(|i| (i + 1..axes.len()).map(move |j| [i, j]));
        planes
            .filter_map(|plane| Self::in_plane(plane, records, axes, scored, &speeds))
            .next()
    }

    fn in_plane(
        plane: [usize; 2],
        records: &[AxisRecord<'_>],
        axes: &[FoundAxis],
        scored: &[bool],
        speeds: &[Vec<f64>],
    ) -> Option<Self> {
        let least = plane.map(|i| {
            MOVES
                * speeds[i]
                    .iter()
                    .fold(0.0_f64, |most, speed| most.max(speed.abs()))
        });
        let moves = |k: usize| (0..2).all(|i| speeds[plane[i]][k].abs() > least[i]);
        let samples: Vec<usize> = (0..scored.len())
            .filter(|&k| scored[k] && moves(k))
            .collect();
        if samples.len() < LEAST_SAMPLES {
            return None;
        }
        let contour = |k: usize, at: &dyn Fn(usize) -> Option<f64>| -> Option<f64> {
            let [u, v] = plane.map(|i| speeds[i][k]);
            let [x, y] = [at(plane[0])?, at(plane[1])?];
            Some((u * y - v * x) / libm::hypot(u, v))
        };
        let measured = |i: usize, k: usize| records[i].actual_mm[k] - records[i].command_mm[k];
        let missed = |of: &dyn Fn(usize, usize) -> Option<f64>| {
            let all = samples
                .iter()
                .filter_map(|&k| contour(k, &|i| Some(records[i].actual_mm[k] - of(i, k)?)));
            1e3 * rms(all)
        };
        Some(Self {
            plane,
            measured_um: 1e3
                * rms(samples
                    .iter()
                    .filter_map(|&k| contour(k, &|i| Some(measured(i, k))))),
            grey_box_um: missed(&|i, k| axes[i].scores.simulated_mm[k]),
            arx_um: missed(&|i, k| axes[i].scores.arx_mm[k]),
        })
    }
}
