//! Readings before and behind the fit: what the screw explains, bins of a ball bar, repeatability,
//! tables of targets.
//!
//! Source: ISO 230-2 (2014) for targets, runs and repeatability.

use std::f64::consts::TAU;

use feedwright_sim::{GeometryFile, MeasuredSet};

/// Part of the windup by which it may be wrong. Vibration carries the table over a part of its
/// friction, and winds the screw up by less: on `router` by 5 to 6 of 67 um.
pub(super) const WINDUP_UNCERTAINTY: f64 = 0.1;

/// Takes the lost motion by windup off the deviations of a set; its geometry is then without.
pub(super) fn take_off_windup(set: &mut MeasuredSet, axis: usize, windup_um: f64) {
    let mut windup = GeometryFile::default();
    windup.axes[axis].backlash_um = windup_um;
    let predicted: Vec<f64> = set
        .observations()
        .iter()
        .map(|seen| seen.predicted_um(&windup))
        .collect();
    let values = if set.kind == "grid" { 2 } else { 1 };
    for (row, predicted) in set.rows.iter_mut().zip(predicted.chunks(values)) {
        let first = row.len() - values;
        row[first..]
            .iter_mut()
            .zip(predicted)
            .for_each(|(value, predicted)| *value -= predicted);
    }
}

/// Parts of a turn of the screw that a bin of a ball bar reaches over at the most: the mean over
/// one loses 0.6 % of a pitch error.
const BINS_PER_TURN: f64 = 16.0;
/// Least bins of a circle.
const LEAST_BINS: f64 = 360.0;

/// Samples of a ball bar, averaged over narrow bins; other sets, and those with fewer samples, as
/// they are.
pub(super) fn binned(mut set: MeasuredSet, lead_mm: f64) -> MeasuredSet {
    if set.kind != "bar" {
        return set;
    }
    let bins = (TAU * set.radius_mm * BINS_PER_TURN / lead_mm)
        .max(LEAST_BINS)
        .ceil();
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for way in [1.0, -1.0] {
        let mut sums = vec![[0.0; 3]; bins as usize];
        for row in set.rows.iter().filter(|row| row[1] == way) {
            let angle_deg = row[0] - 360.0 * (row[0] / 360.0).floor();
            let sum = &mut sums[((angle_deg / 360.0 * bins) as usize).min(bins as usize - 1)];
            sum.iter_mut()
                .zip([1.0, angle_deg, row[2]])
                .for_each(|(sum, value)| *sum += value);
        }
        let digits = |value: f64, factor: f64| (value * factor).round() / factor;
        let mean = |[count, angle_deg, um]: &[f64; 3]| {
            vec![digits(angle_deg / count, 1e4), way, digits(um / count, 1e4)]
        };
        rows.extend(
            sums.iter()
                .filter(|sum| sum[0] > 0.0 && settled(sum[1] / sum[0], way))
                .map(mean),
        );
    }
    set.rows = rows;
    set
}

/// Angle behind a reversal of an axis in which friction turns around, degrees: what the tool does
/// there is no geometry.
const REVERSAL_DEG: f64 = 4.0;

/// Returns true if no axis has just reversed at an angle.
fn settled(angle_deg: f64, way: f64) -> bool {
    let behind_deg = way * angle_deg - 90.0 * (way * angle_deg / 90.0).floor();
    behind_deg > REVERSAL_DEG
}

/// Standard deviation of values at the same place in the same direction, um.
pub(super) fn repeatability_um(set: &MeasuredSet) -> Option<f64> {
    let last = set.rows.first()?.len().checked_sub(1)?;
    let mut rows: Vec<&Vec<f64>> = set.rows.iter().collect();
    rows.sort_by(|a, b| {
        a[..last]
            .iter()
            .zip(&b[..last])
            .map(|(a, b)| a.total_cmp(b))
            .find(|order| order.is_ne())
            .unwrap_or(std::cmp::Ordering::Equal)
    });
    let (mut squares, mut free) = (0.0, 0.0);
    for same in rows
        .chunk_by(|a, b| a[..last] == b[..last])
        .filter(|same| same.len() > 1)
    {
        let mean = same.iter().map(|row| row[last]).sum::<f64>() / same.len() as f64;
        squares += same
            .iter()
            .map(|row| (row[last] - mean) * (row[last] - mean))
            .sum::<f64>();
        free += same.len() as f64 - 1.0;
    }
    (free > 0.0).then(|| (squares / free).sqrt())
}

/// Mean of what is left at each target in each direction, and the quotient of its variance to that
/// of the runs, with the standard deviation of a mean. None where a target has fewer than two runs
/// in a direction.
pub(super) fn table_of(set: &MeasuredSet, left: &[f64]) -> Option<(Vec<[f64; 3]>, [f64; 2])> {
    let mut targets: Vec<f64> = set.rows.iter().map(|row| row[0]).collect();
    targets.sort_by(f64::total_cmp);
    targets.dedup();
    let (mut rows, mut between, mut within, mut runs) = (Vec::new(), 0.0, 0.0, f64::INFINITY);
    for at_mm in &targets {
        let mut row = [*at_mm, 0.0, 0.0];
        for (column, way) in [(1, 1.0), (2, -1.0)] {
            let here = |(of, _): &(&Vec<f64>, &f64)| of[0] == *at_mm && of[1] == way;
            let values: Vec<f64> = set
                .rows
                .iter()
                .zip(left)
                .filter(here)
                .map(|(_, left)| *left)
                .collect();
            let count = values.len() as f64;
            if count < 2.0 {
                return None;
            }
            let mean = values.iter().sum::<f64>() / count;
            within += values
                .iter()
                .map(|value| (value - mean) * (value - mean))
                .sum::<f64>();
            between += count * mean * mean;
            runs = runs.min(count);
            row[column] = (mean * 1e3).round() / 1e3 + 0.0;
        }
        rows.push(row);
    }
    let places = 2.0 * rows.len() as f64;
    let variance = within / (left.len() as f64 - places);
    (places > 3.0).then(|| {
        (
            rows,
            [
                between / (places - 3.0) / variance,
                (variance / runs).sqrt(),
            ],
        )
    })
}
