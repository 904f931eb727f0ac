//! Splits the error of the records into the part that repeats and the part that does not.
//!
//! A sequence is split into bands: the differences of moving averages over 1, 3, 7, 15, ...
//! samples. In each band and axis, the part that repeats is the mean of the records times the
//! weight of Wiener (1949),
//!
//! ```text
//! w = max(0, 1 - N / P),
//! ```
//!
//! where `P` is the mean square of the mean, and `N` is the mean square of the part of the mean
//! that does not repeat. With several records, the differences from their mean show `N`. One record
//! does not show it: `N` is then twice the disturbance and noise of the machine file, because they
//! scatter from cut to cut, and at least half of `P`.

use feedwright_plan::vector::{Vector, add_scaled, sub};

/// Number of bands: the last one has all slower parts.
const BANDS: u32 = 9;
/// Smallest part of one record that counts as not repeating.
const NOT_REPEATED: f64 = 0.5;
/// Power of disturbance and noise in one record, relative to the machine file.
const SCATTER: f64 = 2.0;

/// Computes a moving average over `reach` samples to both sides, twice; a sequence continues with
/// its end values.
fn averaged(values: &[Vector], reach: usize) -> Vec<Vector> {
    let once = |values: &[Vector]| -> Vec<Vector> {
        let last = values.len() as isize - 1;
        let value = |n: isize| values[n.clamp(0, last) as usize];
        let reach = reach as isize;
        let width = (2 * reach + 1) as f64;
        let mut sum = (-reach..=reach).fold([0.0; 3], |sum, n| add_scaled(sum, 1.0, value(n)));
        (0..=last)
            .map(|n| {
                let mean = sum.map(|sum| sum / width);
                sum = sub(add_scaled(sum, 1.0, value(n + reach + 1)), value(n - reach));
                mean
            })
            .collect()
    };
    if values.is_empty() {
        Vec::new()
    } else {
        once(&once(values))
    }
}

/// Splits a sequence into bands, fast ones first; their sum is the sequence.
fn bands(values: &[Vector]) -> Vec<Vec<Vector>> {
    let mut rest = values.to_vec();
    let mut bands = Vec::new();
    for band in 0..BANDS - 1 {
        let slower = averaged(&rest, 1 << band);
        bands.push(
            rest.iter()
                .zip(&slower)
                .map(|(value, slow)| sub(*value, *slow))
                .collect(),
        );
        rest = slower;
    }
    bands.push(rest);
    bands
}

fn mean_square(values: &[Vector], axis: usize) -> f64 {
    values
        .iter()
        .map(|value| value[axis] * value[axis])
        .sum::<f64>()
        / values.len().max(1) as f64
}

/// Returns the repeating part of records that correspond sample by sample. `noise` is a sample of
/// the part that does not repeat according to the machine file.
pub(super) fn repeating(records: &[Vec<Vector>], noise: &[Vector]) -> Vec<Vector> {
    let count = records.len() as f64;
    let samples = records.iter().map(Vec::len).min().unwrap_or(0);
    let mean: Vec<Vector> = (0..samples)
        .map(|k| {
            records.iter().fold([0.0; 3], |sum, record| {
                add_scaled(sum, 1.0 / count, record[k])
            })
        })
        .collect();
    let apart = |record: &Vec<Vector>| -> Vec<Vec<Vector>> {
        bands(
            &record
                .iter()
                .zip(&mean)
                .map(|(value, mean)| sub(*value, *mean))
                .collect::<Vec<_>>(),
        )
    };
    let apart: Vec<Vec<Vec<Vector>>> = if records.len() > 1 {
        records.iter().map(apart).collect()
    } else {
        Vec::new()
    };
    let noise = bands(noise);
    let mut found = vec![[0.0; 3]; samples];
    for (b, band) in bands(&mean).iter().enumerate() {
        for axis in 0..3 {
            let power = mean_square(band, axis);
            let random = if apart.is_empty() {
                (SCATTER * mean_square(&noise[b], axis)).max(NOT_REPEATED * power)
            } else {
                apart
                    .iter()
                    .map(|record| mean_square(&record[b], axis))
                    .sum::<f64>()
                    / (count - 1.0)
                    / count
            };
            let weight = if power > 0.0 {
                (1.0 - random / power).max(0.0)
            } else {
                0.0
            };
            found
                .iter_mut()
                .zip(band)
                .for_each(|(found, value)| found[axis] += weight * value[axis]);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(k: usize) -> f64 {
        2.0 * libm::sin(k as f64 / 40.0)
    }

    /// A disturbance of another phase in each cut, as large.
    fn random(k: usize, phase: f64) -> f64 {
        2.0 * libm::sin(k as f64 / 11.0 + phase)
    }

    fn record(phase: f64) -> Vec<Vector> {
        (0..4000)
            .map(|k| [signal(k) + random(k, phase), signal(k), 0.0])
            .collect()
    }

    fn off(found: &[Vector], axis: usize) -> f64 {
        let inner = 400..3600;
        let square = |k: usize| (found[k][axis] - signal(k)).powi(2);
        (inner.clone().map(square).sum::<f64>() / inner.len() as f64).sqrt()
    }

    #[test]
    fn bands_add_up_to_the_sequence() {
        let values = record(0.3);
        let all = bands(&values);
        let sum = |k: usize| all.iter().map(|band| band[k][0]).sum::<f64>();
        assert!((0..4000).all(|k| (sum(k) - values[k][0]).abs() < 1e-12));
    }

    #[test]
    fn what_repeats_in_two_records_is_kept_and_a_disturbance_of_another_phase_is_not() {
        let quiet = vec![[0.0; 3]; 4000];
        let found = repeating(&[record(0.0), record(2.0)], &quiet);
        // Without a disturbance all is kept, and with one the error is less than with the mean of
        // both.
        assert!(off(&found, 1) < 0.01, "{}", off(&found, 1));
        let mean: Vec<Vector> = record(0.0)
            .iter()
            .zip(&record(2.0))
            .map(|(a, b)| [0.5 * (a[0] + b[0]), 0.0, 0.0])
            .collect();
        assert!(
            off(&found, 0) < 0.75 * off(&mean, 0),
            "{} {}",
            off(&found, 0),
            off(&mean, 0)
        );
    }

    #[test]
    fn of_one_record_no_more_than_half_is_kept_and_nothing_that_the_machine_file_calls_noise() {
        let quiet = vec![[0.0; 3]; 4000];
        let found = repeating(&[record(0.0)], &quiet);
        let kept = |found: &[Vector], axis: usize| {
            (mean_square(found, axis) / mean_square(&record(0.0), axis)).sqrt()
        };
        assert!((kept(&found, 1) - 0.5).abs() < 0.01, "{}", kept(&found, 1));
        let noise: Vec<Vector> = (0..4000)
            .map(|k| [signal(k) + random(k, 0.0), 2.0 * signal(k), 0.0])
            .collect();
        assert!(kept(&repeating(&[record(0.0)], &noise), 0) < 0.01);
    }
}
