//! Steps of a measured position, and positions written with too few digits.

use feedwright_sim::to_four_digits;

use super::super::LogAxis;
use super::super::error::{Refusal, RefusalReason};

/// Changes that are looked at, at the most.
const CHANGES: usize = 100_000;
/// Part of the changes that are whole steps, where there are steps.
const WHOLE: f64 = 0.99;
/// Largest distance of a change from a whole number of steps: text rounds.
const NEAR: f64 = 0.05;
/// Most steps in a change: with more, any number is near a whole one.
const MAX_STEPS: f64 = 1e6;
/// Digits with which a position is too coarse.
const DIGITS: i32 = 3;
/// Step from which on few digits are too few, mm: a tenth of what the worst machines are off by.
const COARSE_MM: f64 = 0.01;

/// Sizes of the changes from sample to sample that are not zero, in order.
fn changes(values: &[f64]) -> Vec<f64> {
    let stride = values.len().div_ceil(CHANGES).max(1);
    let pairs = values.windows(2).step_by(stride);
    let mut changes: Vec<f64> = pairs
        .map(|pair| (pair[1] - pair[0]).abs())
        .filter(|change| *change > 1e-12)
        .collect();
    changes.sort_by(f64::total_cmp);
    changes
}

/// The step of a position, mm: the smallest change, where all others are whole multiples of it; 0
/// where they are not.
pub(super) fn step(values: &[f64]) -> f64 {
    let changes = changes(values);
    let Some(&least) = changes.first() else {
        return 0.0;
    };
    // Rounding makes the smallest change uncertain; the mean of those near it is more accurate.
    let small: Vec<f64> = changes
        .iter()
        .copied()
        .take_while(|change| *change < (1.0 + NEAR) * least)
        .collect();
    let step = small.iter().sum::<f64>() / small.len() as f64;
    let whole = changes.iter().filter(|change| {
        let steps = *change / step;
        steps < MAX_STEPS && (steps - steps.round()).abs() < NEAR
    });
    let found = whole.count() as f64 >= WHOLE * changes.len() as f64;
    // As it would be written.
    if found {
        format!("{step:.5e}").parse().unwrap_or(step)
    } else {
        0.0
    }
}

/// Positions with so few digits that the step grows with the position.
pub(super) fn too_coarse(axis: &LogAxis) -> Option<Refusal> {
    let values = &axis.actual_mm;
    let rounded = |value: f64| {
        let scale = 10_f64.powi(DIGITS - 1 - libm::log10(value.abs()).floor() as i32);
        let scaled = value * scale;
        (scaled - scaled.round()).abs() < 1e-6
    };
    let has_few_digits = values.iter().all(|&value| value == 0.0 || rounded(value));
    let largest_mm = values
        .iter()
        .fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let step_mm =
        10_f64.powi(libm::log10(largest_mm.max(f64::MIN_POSITIVE)).floor() as i32 - (DIGITS - 1));
    // An encoder with coarse steps over a short way has few digits, too; but the same step
    // everywhere.
    let smallest = changes(values).first().copied().unwrap_or(0.0);
    let grows = smallest < 0.5 * step_mm || step_mm >= 1.0;
    (has_few_digits && step_mm > COARSE_MM && grows).then(|| {
        let message = format!(
            "the positions of {} have three significant digits: at {} mm they come in steps of {} mm, a hundred times the errors that matter",
            axis.name,
            to_four_digits(largest_mm),
            to_four_digits(step_mm)
        );
        Refusal::new(RefusalReason::TooCoarse, message, "record positions with all digits, at least to 0.001 mm")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_found_where_there_are_any() {
        let smooth: Vec<f64> = (0..5000)
            .map(|k| 10.0 * libm::sin(0.003 * f64::from(k)))
            .collect();
        assert_eq!(step(&smooth), 0.0);
        for size in [0.01, 0.001, 25.4 / 4096.0, 1e-4] {
            let coarse: Vec<f64> = smooth
                .iter()
                .map(|value| (value / size).round() * size)
                .collect();
            assert!(
                (step(&coarse) / size - 1.0).abs() < 1e-4,
                "{size}: {}",
                step(&coarse)
            );
        }
        let text: Vec<f64> = smooth
            .iter()
            .map(|value| format!("{value:.3}").parse().unwrap())
            .collect();
        assert_eq!(step(&text), 0.001);
        assert_eq!(step(&[1.0; 10]), 0.0);
    }
}
