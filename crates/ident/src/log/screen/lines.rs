//! Finds lines in the spectrum of torque and following error: parts that turn or vibrate while the
//! machine moves.
//!
//! ```text
//! P(f)    power of x(k) - x(k-1), mean over all segments
//! line    peak of P(f) above `ABOVE` times the median of its neighbors, where the acceleration
//!         of the command has no such peak
//! a       sqrt(2 sum of P over the line) / |1 - exp(-i 2 pi f T)|
//! ```
//!
//! The differences remove the slow parts of the signal, which would leak into all frequencies. The
//! amplitude a is the amplitude of the signal itself, not of its differences.

use std::f64::consts::PI;

use super::super::LogAxis;
use super::super::clock::Clock;
use super::super::finding::LogFinding;
use crate::spectrum::Spectrum;

/// Samples of a segment, at the most and at the least.
const SEGMENT: [usize; 2] = [256, 4096];
/// Samples that are looked at.
const SAMPLES: usize = 1 << 18;
/// Values on both sides whose median is the background.
const NEIGHBOURS: usize = 24;
/// Times the background from which on there is a line.
const ABOVE: f64 = 40.0;
/// Least part of the total power at which a line is reported.
const LEAST_PART: f64 = 0.02;
/// Least square of the amplitude, over the mean square of the following error, at which a line is
/// reported: a hundredth of its RMS.
const LEAST_SEEN: f64 = 1e-4;
/// Values below which motion itself is.
const FIRST: usize = 4;

/// The strongest line of the torque, or of the following error where there is no torque.
pub(super) fn of_axis(axis: &LogAxis, clock: &Clock) -> Vec<LogFinding> {
    // The longest stretch shows most.
    let Some(stretch) = clock.stretches.iter().max_by_key(|stretch| stretch.len()) else {
        return Vec::new();
    };
    let stretch = stretch.start..stretch.end.min(stretch.start + SAMPLES);
    let [least, most] = SEGMENT;
    let length = (stretch.len() / 8).max(1).next_power_of_two().min(most);
    if length < least {
        return Vec::new();
    }
    let command = &axis.command_mm[stretch.clone()];
    // The command's own motion is in everything: its acceleration.
    let motion = spectrum(&differences(&differences(command)), length);
    let error: Vec<f64> = command
        .iter()
        .zip(&axis.actual_mm[stretch.clone()])
        .map(|(c, a)| 1e3 * (c - a))
        .collect();
    let torque = axis.torque.as_ref().map(|torque| &torque[stretch]);
    let of = |values: &[f64]| {
        line(
            &spectrum(&differences(values), length),
            &motion,
            clock.sample_time_s,
        )
    };
    let mut found = Vec::new();
    if let Some((frequency_hz, amplitude)) = torque
        .filter(|t| t.iter().all(|v| v.is_finite()))
        .and_then(of)
    {
        found.push(LogFinding::TorqueLine {
            axis: axis.name.clone(),
            frequency_hz,
            amplitude,
            unit: axis.torque_unit,
        });
    }
    let mean_square = error.iter().map(|value| value * value).sum::<f64>() / error.len() as f64;
    let is_seen = |amplitude_um: f64| amplitude_um * amplitude_um > LEAST_SEEN * mean_square;
    if let Some((frequency_hz, amplitude_um)) = of(&error).filter(|line| is_seen(line.1)) {
        found.push(LogFinding::FollowingLine {
            axis: axis.name.clone(),
            frequency_hz,
            amplitude_um,
        });
    }
    found
}

fn differences(values: &[f64]) -> Vec<f64> {
    values.windows(2).map(|pair| pair[1] - pair[0]).collect()
}

fn spectrum(values: &[f64], length: usize) -> Spectrum {
    Spectrum::new(values, &vec![true; values.len()], length)
}

/// The median of the neighbours of a value.
fn background(power: &[f64], n: usize) -> f64 {
    let around = n.saturating_sub(NEIGHBOURS)..(n + NEIGHBOURS + 1).min(power.len());
    let mut values = power[around].to_vec();
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Frequency, Hz, and amplitude of the strongest line that the motion has not.
fn line(spectrum: &Spectrum, motion: &Spectrum, sample_time_s: f64) -> Option<(f64, f64)> {
    let power = &spectrum.power;
    let all: f64 = power.iter().sum();
    let stands_out = |power: &[f64], n: usize| power[n] > ABOVE * background(power, n);
    let peaks = (FIRST..power.len().saturating_sub(2))
        .filter(|&n| power[n] > power[n - 1] && power[n] >= power[n + 1]);
    let (n, sum) = peaks
        .filter(|&n| stands_out(power, n) && !stands_out(&motion.power, n))
        .map(|n| (n, power[n - 2..=n + 2].iter().sum::<f64>()))
        .max_by(|a, b| a.1.total_cmp(&b.1))?;
    if sum < LEAST_PART * all {
        return None;
    }
    // Between the values, where the parabola through their logarithms has its top: the window is
    // Gaussian.
    let [a, b, c] = [n - 1, n, n + 1].map(|n| libm::log(power[n].max(f64::MIN_POSITIVE)));
    let beside = if 2.0 * b > a + c {
        0.5 * (c - a) / (2.0 * b - a - c)
    } else {
        0.0
    };
    let turns = 0.5 * (n as f64 + beside) / (power.len() - 1) as f64;
    // A line of amplitude a has a^2 / 2 of mean square, spread over both halves of all frequencies.
    let mean_square = sum / (power.len() - 1) as f64;
    let gain = 2.0 * libm::sin(PI * turns);
    Some((turns / sample_time_s, (2.0 * mean_square).sqrt() / gain))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_with_its_frequency_and_amplitude() {
        let n = 20_000;
        let position = |k: usize| 20.0 * libm::sin(0.002 * k as f64);
        let moving: Vec<f64> = (0..n).map(position).collect();
        for (frequency_hz, amplitude) in [(25.0, 3.0), (118.3, 0.5)] {
            let mut noise = 1_u64;
            let signal: Vec<f64> = (0..n)
                .map(|k| {
                    noise = noise
                        .wrapping_mul(6364136223846793005)
                        .wrapping_add(1442695040888963407);
                    let hiss = (noise >> 40) as f64 / (1 << 24) as f64 - 0.5;
                    position(k)
                        + amplitude
                            * libm::sin(std::f64::consts::TAU * frequency_hz * 1e-3 * k as f64)
                        + 0.05 * hiss
                })
                .collect();
            let of = |values: &[f64]| spectrum(&differences(values), 4096);
            let motion = spectrum(&differences(&differences(&moving)), 4096);
            let (found_hz, found) = line(&of(&signal), &motion, 1e-3).unwrap();
            assert!(
                (found_hz - frequency_hz).abs() < 0.05,
                "{found_hz} Hz, {frequency_hz} were put in"
            );
            assert!(
                (found / amplitude - 1.0).abs() < 0.05,
                "{found}, {amplitude} was put in"
            );
        }
        let quiet = spectrum(&differences(&moving), 4096);
        assert_eq!(line(&quiet, &quiet, 1e-3), None);
    }
}
