//! The response of the contour error to the speed of the plan.
//!
//! A servo loop that follows is `x = r(t - T) + C a(t - T) + ..`, with the acceleration a of the
//! plan. The lag T acts along the path and makes no contour error, so the error across the path is
//! `u' C a` with the direction u from the path to the tool. C has one number for each axis, `1 /
//! 2k^2 - 1 / ak` for a position loop of bandwidth k around a speed loop of bandwidth a; these
//! numbers are fitted to a cut. Since `a = t (v^2)' / 2 + t' v^2`, the error is linear in the
//! squares of the speeds at three places. Effects that the model does not include, friction or a
//! controller, are assumed to grow with the square of the speed.

use feedwright_plan::vector::{dot, scale};
use nalgebra::{Matrix3, Vector3};

use super::cut_places::CutPlace;
use super::path_grid::PathGrid;

/// Weight of the assumption that all axes are alike: this fraction of the total information. Axes
/// then differ only as far as the data show it.
const ALIKE: f64 = 1e-3;

/// Smallest square of a speed that is used as a divisor, (mm/s)^2.
const LEAST_SQUARE: f64 = 1e-2;

/// An error below this has no direction, mm.
const LEAST_MM: f64 = 1e-9;

/// Error at each place, and its change with the speeds.
#[derive(Debug)]
pub(super) struct ErrorModel {
    /// Contour errors, mm.
    pub(super) errors_mm: Vec<f64>,
    /// Change of each error with the square of the speed at the place before, at the place itself
    /// and at the place after, mm/(mm/s)^2.
    pub(super) changes: Vec<[f64; 3]>,
}

impl ErrorModel {
    /// Fits the model to a cut, with errors that respond as steeply as `steepness`
    /// ([`super::steepness`]).
    pub(super) fn of(grid: &PathGrid, places: &[CutPlace], steepness: f64) -> Self {
        let squares: Vec<f64> = places
            .iter()
            .map(|place| place.speed_mm_s * place.speed_mm_s)
            .collect();
        let lag_s2 = lag_of_axes(grid, places, &squares);
        let mut changes = Vec::with_capacity(places.len());
        for (i, place) in places.iter().enumerate() {
            let parts = parts_of(grid, i, place).map(|of_axes| dot(of_axes, lag_s2));
            let modelled_mm = at(&parts, i, &squares);
            let mut change = parts;
            change[1] += (place.error_mm - modelled_mm) / squares[i].max(LEAST_SQUARE);
            changes.push(change.map(|part| steepness * part));
        }
        Self {
            errors_mm: places.iter().map(|place| place.error_mm).collect(),
            changes,
        }
    }
}

/// Returns `u_k a_k` of each axis k, as factors on the squares of three speeds, with the direction
/// u of the error.
fn parts_of(grid: &PathGrid, i: usize, place: &CutPlace) -> [[f64; 3]; 3] {
    let direction = scale(1.0 / place.error_mm.max(LEAST_MM), place.away_mm);
    grid.acceleration(i)
        .map(|accel| std::array::from_fn(|k| direction[k] * accel[k]))
}

/// Returns the sum of factors times values at the place before, at the place itself, and after it.
/// Places beyond the ends count as the ends.
pub(super) fn at(factors: &[f64; 3], i: usize, values: &[f64]) -> f64 {
    let last = values.len() - 1;
    factors[0] * values[i.saturating_sub(1)]
        + factors[1] * values[i]
        + factors[2] * values[(i + 1).min(last)]
}

/// Fits C of each axis, by least squares.
fn lag_of_axes(grid: &PathGrid, places: &[CutPlace], squares: &[f64]) -> [f64; 3] {
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for (i, place) in places
        .iter()
        .enumerate()
        .filter(|(_, place)| place.error_mm > 0.0)
    {
        let parts = parts_of(grid, i, place);
        let of_axis = |k: usize| at(&parts.map(|part| part[k]), i, squares);
        let row = Vector3::new(of_axis(0), of_axis(1), of_axis(2));
        matrix += row * row.transpose();
        right += place.error_mm * row;
    }
    // Deviations from the common value have a cost: c = m (1, 1, 1) + d, with a weight on d.
    let information = ALIKE * matrix.trace();
    let ones = Vector3::repeat(1.0);
    let apart = Matrix3::identity() - ones * ones.transpose() / 3.0;
    let regularized = matrix + information * apart;
    regularized
        .lu()
        .solve(&right)
        .map_or([0.0; 3], |found| [found.x, found.y, found.z])
}
