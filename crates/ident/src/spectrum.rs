//! Fourier transform, and the spectrum of a sequence with gaps.
//!
//! ```text
//! X(f) = sum of x(k) exp(-2 pi i f k)                                   f in turns a sample
//! I(f) = mean over segments of |sum of g m x exp(..)|^2 / sum of (g m)^2    g window, m 1 where x counts and 0 where it does not
//! ```
//!
//! The window is Gaussian, cut off at four standard deviations: a line of Gaussian shape stays
//! Gaussian behind it, and what leaks lies 70 dB below.
//!
//! Source: Cooley and Tukey (1965), An algorithm for the machine calculation of complex Fourier
//! series; Welch (1967), The use of fast Fourier transform for the estimation of power spectra;
//! Harris (1978) for the window.

use std::f64::consts::{PI, TAU};

/// A complex number: real and imaginary part.
pub(crate) type Phasor = [f64; 2];

/// Product.
#[inline]
pub(crate) fn times([a, b]: Phasor, [c, d]: Phasor) -> Phasor {
    [a * c - b * d, a * d + b * c]
}

/// Conjugate.
#[inline]
pub(crate) fn conjugate([a, b]: Phasor) -> Phasor {
    [a, -b]
}

/// Square of the modulus.
#[inline]
pub(crate) fn power([a, b]: Phasor) -> f64 {
    a * a + b * b
}

/// e^(i x).
#[inline]
pub(crate) fn turned(angle_rad: f64) -> Phasor {
    let (sin, cos) = libm::sincos(angle_rad);
    [cos, sin]
}

/// Transform of a sequence whose length is a power of two, in place.
pub(crate) fn transform(values: &mut [Phasor]) {
    let length = values.len();
    debug_assert!(length.is_power_of_two(), "{length}");
    if length < 2 {
        return;
    }
    let shift = usize::BITS - length.trailing_zeros();
    for i in 0..length {
        let j = i.reverse_bits() >> shift;
        if i < j {
            values.swap(i, j);
        }
    }
    let turns: Vec<Phasor> = (0..length / 2)
        .map(|k| turned(-TAU * k as f64 / length as f64))
        .collect();
    let mut half = 1;
    while half < length {
        let stride = length / (2 * half);
        for block in values.chunks_exact_mut(2 * half) {
            let (low, high) = block.split_at_mut(half);
            for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                let turned = times(*b, turns[k * stride]);
                *b = [a[0] - turned[0], a[1] - turned[1]];
                *a = [a[0] + turned[0], a[1] + turned[1]];
            }
        }
        half *= 2;
    }
}

/// Its inverse.
pub(crate) fn transform_back(values: &mut [Phasor]) {
    values
        .iter_mut()
        .for_each(|value| *value = conjugate(*value));
    transform(values);
    let scale = 1.0 / values.len() as f64;
    values
        .iter_mut()
        .for_each(|[a, b]| (*a, *b) = (*a * scale, -*b * scale));
}

/// Transform of real numbers, with zeros behind them up to a length.
pub(crate) fn transformed(values: &[f64], length: usize) -> Vec<Phasor> {
    let mut padded: Vec<Phasor> = values.iter().map(|&value| [value, 0.0]).collect();
    padded.resize(length, [0.0; 2]);
    transform(&mut padded);
    padded
}

/// The spectrum of a sequence from frequency zero to half a turn a sample.
#[derive(Debug, Clone)]
pub struct Spectrum {
    /// Mean square in a sample, were it white: at frequencies n / (2 (len - 1)).
    pub power: Vec<f64>,
    /// Number of independent values behind each value of `power`.
    pub(crate) weight_of_value: f64,
    /// Standard deviation to which the window widens a line, turns a sample.
    pub(crate) width: f64,
}

/// Standard deviations of the window in half a segment.
const WINDOW_DEVIATIONS: f64 = 4.0;
/// Length of a segment over the distance between the starts of consecutive segments. Their windows
/// then overlap at 0.6 of their height.
const SEGMENT_PARTS: usize = 4;

/// Segments of a sequence as they come, and the spectrum of those so far.
#[derive(Debug, Clone)]
pub struct SpectrumSegments {
    window: Vec<f64>,
    /// Standard deviation of the window, samples.
    deviation: f64,
    sum: Vec<f64>,
    weight: f64,
}

impl SpectrumSegments {
    /// None yet; `length` of each is a power of two.
    pub fn new(length: usize) -> Self {
        let middle = 0.5 * length as f64;
        let deviation = middle / WINDOW_DEVIATIONS;
        let gauss = |k: usize| libm::exp(-0.5 * ((k as f64 + 0.5 - middle) / deviation).powi(2));
        Self {
            window: (0..length).map(gauss).collect(),
            deviation,
            sum: vec![0.0; length / 2 + 1],
            weight: 0.0,
        }
    }

    /// Distance between the starts of consecutive segments, samples.
    pub fn step(&self) -> usize {
        self.window.len() / SEGMENT_PARTS
    }

    /// Adds a segment.
    pub fn add(&mut self, values: &[f64], counts: &[bool]) {
        let mut segment: Vec<Phasor> = values
            .iter()
            .zip(counts)
            .zip(&self.window)
            .map(|((value, &counts), g)| if counts { [value * g, 0.0] } else { [0.0; 2] })
            .collect();
        self.weight += counts
            .iter()
            .zip(&self.window)
            .filter(|&(&counts, _)| counts)
            .map(|(_, g)| g * g)
            .sum::<f64>();
        transform(&mut segment);
        self.sum
            .iter_mut()
            .zip(&segment)
            .for_each(|(sum, value)| *sum += power(*value));
    }

    /// The spectrum, of a sequence in which `seen` values count.
    pub fn spectrum(&self, seen: usize) -> Spectrum {
        Spectrum {
            power: self
                .sum
                .iter()
                .map(|p| p / self.weight.max(f64::MIN_POSITIVE))
                .collect(),
            weight_of_value: seen as f64 / self.window.len() as f64,
            width: 1.0 / (2.0 * PI * self.deviation * 2.0_f64.sqrt()),
        }
    }
}

impl Spectrum {
    /// Computes the spectrum of the values that count, over segments of a length that is a power of
    /// two.
    pub fn new(values: &[f64], counts: &[bool], length: usize) -> Self {
        let mut segments = SpectrumSegments::new(length);
        let mut start = 0;
        while start + length <= values.len() {
            segments.add(
                &values[start..start + length],
                &counts[start..start + length],
            );
            start += segments.step();
        }
        segments.spectrum(counts.iter().filter(|&&counts| counts).count())
    }

    /// Frequency of a value, turns a sample.
    pub fn at(&self, n: usize) -> f64 {
        0.5 * n as f64 / (self.power.len() - 1) as f64
    }
}
