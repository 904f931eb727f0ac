//! The spectrum of the contour error, in bounded memory: RMS error by frequency.
//!
//! ```text
//! rms(band)^2 = 1/L sum over the frequencies n of the band of I(n), twice but for the first and the last
//! ```
//!
//! I is the spectrum of [`feedwright_ident::spectrum`] over the rows that cut, L its segment: the
//! squares of all bands add up to the mean square of the error. In the plane the error is signed;
//! in space, where it has no sign, its three components are added up: the size of a vibration has
//! twice its frequency.

use std::io;

use feedwright_ident::SpectrumSegments;
use feedwright_plan::vector::sub;
use feedwright_sim::{Row, Sink};
use serde::Serialize;

/// Length of a segment, s: lines then have a width of some half a hertz.
const SEGMENT_S: f64 = 2.0;
/// A sequence of fewer samples has no spectrum.
const LEAST_SAMPLES: usize = 64;
/// A band is this part of its frequency wide, a twelfth of an octave, and no narrower than this
/// many frequencies.
const BAND_WIDTH: f64 = 1.059_463_094_359_295_3;
const LEAST_FREQUENCIES: usize = 3;

/// Contour error in a band of frequencies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SpectrumBand {
    /// Lower end of the band, Hz.
    pub(crate) from_hz: f64,
    /// Upper end of the band, Hz.
    pub(crate) to_hz: f64,
    /// RMS of the contour error in the band, µm.
    pub(crate) rms_um: f64,
}

/// Collector of the spectrum of the contour error.
#[derive(Debug, Clone)]
pub struct ErrorSpectrum {
    servo_s: f64,
    length: usize,
    segments: [SpectrumSegments; 3],
    /// Components of the error, mm, in as many of the sequences as the run has; the others are
    /// empty.
    errors_mm: [Vec<f64>; 3],
    cutting: Vec<bool>,
    /// Rows that are not in a segment yet.
    open: usize,
    seen: usize,
    last_s: Option<f64>,
    in_space: bool,
}

impl ErrorSpectrum {
    /// Creates the collector for a run with 2 or 3 `axes` and the servo period `servo_s`, s.
    pub fn new(axes: usize, servo_s: f64) -> Self {
        let length = ((SEGMENT_S / servo_s) as usize)
            .max(LEAST_SAMPLES)
            .next_power_of_two();
        Self {
            servo_s,
            length,
            segments: std::array::from_fn(|_| SpectrumSegments::new(length)),
            errors_mm: Default::default(),
            cutting: Vec::with_capacity(length),
            open: 0,
            seen: 0,
            last_s: None,
            in_space: axes > 2,
        }
    }

    fn channels(&self) -> usize {
        if self.in_space { 3 } else { 1 }
    }

    fn push(&mut self, error_mm: [f64; 3], cutting: bool) {
        for k in 0..self.channels() {
            self.errors_mm[k].push(error_mm[k]);
        }
        self.cutting.push(cutting);
        self.open += 1;
        self.seen += usize::from(cutting);
        if self.cutting.len() == self.length {
            self.close();
        }
    }

    /// Adds the full segment.
    fn close(&mut self) {
        for (segments, errors_mm) in self.segments.iter_mut().zip(&mut self.errors_mm) {
            if !errors_mm.is_empty() {
                segments.add(errors_mm, &self.cutting);
                errors_mm.drain(..segments.step());
            }
        }
        self.cutting.drain(..self.segments[0].step());
        self.open = 0;
    }

    /// Returns the bands from low to high; empty if too little was cut.
    pub fn bands(mut self) -> Vec<SpectrumBand> {
        if self.seen < LEAST_SAMPLES {
            return Vec::new();
        }
        if self.cutting.len() == self.open {
            self.shorten();
        }
        while self.open > 0 {
            self.push([0.0; 3], false);
        }
        let power = self.segments[..self.channels()]
            .iter()
            .map(|segments| segments.spectrum(self.seen).power);
        let sum = |mut sum: Vec<f64>, power: Vec<f64>| {
            sum.iter_mut()
                .zip(power)
                .for_each(|(sum, power)| *sum += power);
            sum
        };
        banded(
            &power.fold(vec![0.0; self.length / 2 + 1], sum),
            self.servo_s,
        )
    }

    /// Shortens the segments for a run that is shorter than a segment.
    fn shorten(&mut self) {
        let errors_mm = std::mem::take(&mut self.errors_mm);
        let cutting = std::mem::take(&mut self.cutting);
        self.length = 1 << cutting.len().ilog2();
        self.segments = std::array::from_fn(|_| SpectrumSegments::new(self.length));
        (self.open, self.seen) = (0, 0);
        for (i, &cutting) in cutting.iter().enumerate() {
            let error_mm = std::array::from_fn(|k| errors_mm[k].get(i).copied().unwrap_or(0.0));
            self.push(error_mm, cutting);
        }
    }
}

impl Sink for ErrorSpectrum {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        let error_mm = if self.in_space {
            sub(row.act_mm, row.foot_mm)
        } else {
            [row.contour_error_mm, 0.0, 0.0]
        };
        if !error_mm.iter().all(|x| x.is_finite()) {
            return Ok(());
        }
        // A rest that was left out is filled in up to one segment.
        let left_out = self.last_s.map_or(0.0, |last_s| {
            ((row.t_s - last_s) / self.servo_s).round() - 1.0
        });
        for _ in 0..(left_out as usize).min(self.length) {
            self.push([0.0; 3], false);
        }
        self.last_s = Some(row.t_s);
        self.push(error_mm, row.cutting);
        Ok(())
    }
}

/// Converts the power at frequencies n / (2 (len - 1)) turns per sample to bands, and mm to um.
fn banded(power: &[f64], servo_s: f64) -> Vec<SpectrumBand> {
    let last = power.len() - 1;
    let hz = |n: f64| 0.5 * n / last as f64 / servo_s;
    let mean_square =
        |n: usize| (if n == 0 || n == last { 0.5 } else { 1.0 }) * power[n] / last as f64;
    let (mut bands, mut first) = (Vec::new(), 0);
    while first <= last {
        let wide = (first as f64 * BAND_WIDTH).ceil() as usize;
        let next = wide.max(first + LEAST_FREQUENCIES).min(last + 1);
        let sum: f64 = (first..next).map(mean_square).sum();
        let edge = |n: usize| hz((n as f64 - 0.5).clamp(0.0, last as f64));
        bands.push(SpectrumBand {
            from_hz: edge(first),
            to_hz: edge(next),
            rms_um: 1e3 * sum.sqrt(),
        });
        first = next;
    }
    bands
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::row;
    use std::f64::consts::TAU;

    const SERVO_S: f64 = 1e-3;

    fn bands(axes: usize, rows: u32, error_um: impl Fn(f64) -> f64) -> Vec<SpectrumBand> {
        let mut spectrum = ErrorSpectrum::new(axes, SERVO_S);
        for k in 0..rows {
            let t_s = f64::from(k) * SERVO_S;
            let mm = 1e-3 * error_um(t_s);
            let act_mm = [0.6 * mm, 0.0, 0.8 * mm];
            let contour_error_mm = if axes == 3 { mm.abs() } else { mm };
            spectrum
                .row(&Row {
                    act_mm,
                    contour_error_mm,
                    ..row(t_s)
                })
                .unwrap();
        }
        spectrum.bands()
    }

    fn rms_um(bands: &[SpectrumBand]) -> f64 {
        bands
            .iter()
            .map(|band| band.rms_um * band.rms_um)
            .sum::<f64>()
            .sqrt()
    }

    /// A line in a band and its neighbours has the RMS of a sine, in the plane and in space; so has
    /// all of it, however long the run is.
    #[test]
    fn a_vibration_is_found_at_its_frequency_with_its_size() {
        for (axes, rows, hz) in [
            (2, 20_000, 43.0),
            (3, 20_000, 43.0),
            (2, 1757, 120.0),
            (2, 400, 80.0),
        ] {
            let found = bands(axes, rows, |t_s| 2.0 * libm::sin(TAU * hz * t_s));
            let near = |band: &&SpectrumBand| band.from_hz < 1.1 * hz && band.to_hz > 0.9 * hz;
            let line_um = rms_um(&found.iter().filter(near).copied().collect::<Vec<_>>());
            assert!(
                (line_um / 2.0_f64.sqrt() - 1.0).abs() < 0.01,
                "{axes} axes, {rows} rows: {line_um}"
            );
            assert!(
                (rms_um(&found) / 2.0_f64.sqrt() - 1.0).abs() < 0.01,
                "{axes} axes, {rows} rows: {found:?}"
            );
        }
    }

    #[test]
    fn bands_touch_and_end_at_half_the_sampling_rate() {
        let found = bands(2, 5000, |t_s| t_s);
        assert!(
            found
                .windows(2)
                .all(|pair| pair[0].to_hz == pair[1].from_hz),
            "{found:?}"
        );
        assert_eq!(
            (found[0].from_hz, found[found.len() - 1].to_hz),
            (0.0, 500.0)
        );
        assert!(found.len() < 120, "{}", found.len());
    }

    /// Rows that do not cut, and rests that were left out, do not count.
    #[test]
    fn rapids_and_rests_do_not_count() {
        let mut spectrum = ErrorSpectrum::new(2, SERVO_S);
        for k in 0..12_000 {
            let n = if k > 6000 { k + 9000 } else { k };
            let (t_s, cutting) = (f64::from(n) * SERVO_S, k % 3000 < 2000);
            let mm = if cutting {
                1e-3 * libm::sin(TAU * 50.0 * t_s)
            } else {
                7.0
            };
            spectrum
                .row(&Row {
                    contour_error_mm: mm,
                    cutting,
                    ..row(t_s)
                })
                .unwrap();
        }
        assert!((rms_um(&spectrum.bands()) * 2.0_f64.sqrt() - 1.0).abs() < 0.02);
    }

    #[test]
    fn too_little_has_none() {
        assert_eq!(bands(2, 63, |t_s| t_s), []);
    }
}
