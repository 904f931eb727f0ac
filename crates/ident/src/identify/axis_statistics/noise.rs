//! Noise of the encoder, broadband torque and a line, from the spectrum of the innovations.
//!
//! ```text
//! S(f) = R |H_n|^2 + |H_t|^2 ( s^2 (1 - a^2) / |1 - a e^(-2 pi i f)|^2 + D^2 / 4 N(f - f0, v) )      a = exp(-Ts / T)
//! -ln L = w sum over f of ln S(f) + I(f) / S(f)
//! ```
//!
//! R variance of the encoder; s, T broadband torque and its correlation time; D, f0, v amplitude,
//! frequency and wandering of the line, N the density of a normal distribution, wider by the window
//! of the spectrum. Broadband torque and line are admitted one by one, where the likelihood grows
//! by more than [`ADMITTED`] and the recording shows more of them than what any model leaves.
//!
//! Source: Whittle (1953), Estimation and information in stationary time series; Wilks (1938) for
//! the ratio of likelihoods.

use std::f64::consts::TAU;

use super::innovation::LEAST_NOISE_RAD;
use super::search::least;
use crate::average::middle_of;
use crate::spectrum::{Phasor, Spectrum, power};

/// Growth of ln L beyond which a term is admitted: chance gives 9.2 for three variables once in
/// 10,000 times, and twice that lets the frequency be searched for.
const ADMITTED: f64 = 20.0;
/// Frequency below which the recording shows slow drift, Hz.
pub(super) const LEAST_HZ: f64 = 3.0;
/// Longest correlation time that is distinguished from drift, s.
const LONGEST_S: f64 = 0.05;
/// Shortest one, servo periods: below, it is white.
const SHORTEST_PERIODS: f64 = 0.2;
/// Most that a line wanders, part of its frequency: beyond, it is broadband.
const WIDEST: f64 = 0.15;
/// A line that is narrower than so much of what the window makes of it does not wander.
const RESOLVED: f64 = 1.0;
/// Part of the mean square of the innovations that no term explains: the window leaks, and friction
/// turns at other moments than expected. Terms that have no noise beside them would else be fitted
/// to that.
const LEFT_SHARE: f64 = 1e-2;
/// Frequencies whose mean is taken where the spectrum is smooth.
const GROUP: usize = 8;
/// Frequencies on each side whose median a line is above.
const BESIDE: usize = 60;

/// Noise of an axis, as the spectrum shows it.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct NoiseFit {
    /// Variance of the encoder, noise and steps, rad^2.
    pub(super) encoder_rad2: f64,
    /// RMS of the broadband torque, N m, and its correlation time, s.
    pub(super) torque_nm: f64,
    /// See above.
    pub(super) torque_s: f64,
    /// Amplitude of the line, N m.
    pub(super) line_nm: f64,
    /// Its frequency, and the standard deviation of that, Hz.
    pub(super) line_hz: f64,
    /// See above.
    pub(super) wander_hz: f64,
    /// Mean square of the innovations that no term explains, rad^2.
    pub(super) left_rad2: f64,
}

impl NoiseFit {
    /// Expected spectrum at a frequency, Hz, of responses whose power is given; `window_hz` widens
    /// the line.
    pub(super) fn at(
        &self,
        hz: f64,
        [load, encoder]: [f64; 2],
        servo_s: f64,
        window_hz: f64,
    ) -> f64 {
        let keep = libm::exp(-servo_s / self.torque_s.max(1e-9));
        let broad_nm2 = self.torque_nm * self.torque_nm * (1.0 - keep * keep)
            / (1.0 - 2.0 * keep * libm::cos(TAU * hz * servo_s) + keep * keep);
        let width_hz = libm::hypot(self.wander_hz, window_hz);
        let off = (hz - self.line_hz) / width_hz;
        // Beyond, it is nothing beside the rest.
        let line_nm2 = if off.abs() < 8.0 {
            0.25 * self.line_nm * self.line_nm * libm::exp(-0.5 * off * off)
                / (width_hz * servo_s * TAU.sqrt())
        } else {
            0.0
        };
        self.left_rad2 + self.encoder_rad2 * encoder + load * (broad_nm2 + line_nm2)
    }
}

/// The spectrum of an axis's innovations, and what loads and encoder make in it.
#[derive(Debug, Clone)]
pub(super) struct Seen {
    hz: Vec<f64>,
    power: Vec<f64>,
    responses: Vec<[f64; 2]>,
    /// Number of frequencies of the spectrum behind each value.
    counts: Vec<f64>,
    servo_s: f64,
    window_hz: f64,
    weight: f64,
    left_rad2: f64,
}

impl Seen {
    /// Prepares a spectrum for the fit. The responses cover as many samples as the segments of the
    /// spectrum.
    pub(super) fn new(
        spectrum: &Spectrum,
        [load, encoder]: &[Vec<Phasor>; 2],
        servo_s: f64,
    ) -> Self {
        let range = (0..spectrum.power.len()).filter(|&n| spectrum.at(n) / servo_s >= LEAST_HZ);
        let mean_rad2 = range.clone().map(|n| spectrum.power[n]).sum::<f64>()
            / range.clone().count().max(1) as f64;
        let left_rad2 = LEFT_SHARE * mean_rad2;
        // Each value gets the unexplained part and the least noise added, so that values far below
        // them have no effect.
        let least = |n: usize| left_rad2 + least_rad2() * power(encoder[n]);
        Self {
            hz: range.clone().map(|n| spectrum.at(n) / servo_s).collect(),
            power: range
                .clone()
                .map(|n| spectrum.power[n] + least(n))
                .collect(),
            counts: range.clone().map(|_| 1.0).collect(),
            responses: range.map(|n| [power(load[n]), power(encoder[n])]).collect(),
            servo_s,
            window_hz: spectrum.width / servo_s,
            weight: spectrum.weight_of_value,
            left_rad2,
        }
    }

    /// - ln L.
    fn cost(&self, noise: &NoiseFit) -> f64 {
        let at = |(&hz, &responses)| noise.at(hz, responses, self.servo_s, self.window_hz);
        let expected = self.hz.iter().zip(&self.responses).map(at);
        let terms = expected
            .zip(&self.power)
            .zip(&self.counts)
            .map(|((s, i), count)| count * (libm::log(s) + i / s));
        self.weight * terms.sum::<f64>()
    }

    /// The same with means over [`GROUP`] frequencies where no line at `hz` is.
    fn grouped(&self, hz: Option<f64>) -> Self {
        let mut grouped = Self {
            hz: vec![],
            power: vec![],
            responses: vec![],
            counts: vec![],
            ..self.clone()
        };
        let reach_hz = BESIDE as f64 * (self.hz[1] - self.hz[0]);
        let mut n = 0;
        while n < self.hz.len() {
            let near = hz.is_some_and(|hz| (self.hz[n] - hz).abs() < reach_hz);
            let range = n..if near {
                n + 1
            } else {
                (n + GROUP).min(self.hz.len())
            };
            let count = range.len() as f64;
            let mean = |value: &dyn Fn(usize) -> f64| range.clone().map(value).sum::<f64>() / count;
            grouped.hz.push(mean(&|n| self.hz[n]));
            grouped.power.push(mean(&|n| self.power[n]));
            grouped
                .responses
                .push([0, 1].map(|i| mean(&|n| self.responses[n][i])));
            grouped.counts.push(count);
            n = range.end;
        }
        grouped
    }

    /// Returns the most likely noise. A torque below `least_nm` is left out.
    pub(super) fn noise(&self, least_nm: f64) -> NoiseFit {
        let line = self.line();
        let seen = self.grouped(line.map(|line| line.line_hz));
        let white = seen.white();
        let broad = seen.broadband(white);
        let line_alone = line.map(|line| seen.refined(with_line(&line, &white), false));
        let line_beside = line.map(|line| seen.refined(with_line(&line, &broad.0), true));
        let mut found = (white, seen.cost(&white));
        // One term first, the better one, then both.
        for (noise, cost) in [Some(broad), line_alone, line_beside].into_iter().flatten() {
            let shown = noise.torque_nm == 0.0 || noise.torque_nm > least_nm;
            if shown
                && (noise.line_nm == 0.0 || noise.line_nm > least_nm)
                && cost < found.1 - ADMITTED
            {
                found = (noise, cost);
            }
        }
        let mut noise = found.0;
        if noise.wander_hz < RESOLVED * self.window_hz {
            noise.wander_hz = 0.0;
        }
        noise
    }

    /// Returns the noise of an encoder alone: by the median over the upper half of the frequencies.
    /// The median of an exponential distribution is ln 2 times its mean, and the median of many
    /// such values is near to it.
    fn white(&self) -> NoiseFit {
        let upper = self.power.len() / 2..;
        let mut shares: Vec<f64> = self.power[upper.clone()]
            .iter()
            .zip(&self.responses[upper])
            .map(|(i, [_, n])| i / n)
            .collect();
        let encoder_rad2 = middle_of(&mut shares).max(least_rad2());
        let start = NoiseFit {
            encoder_rad2,
            left_rad2: self.left_rad2,
            ..NoiseFit::default()
        };
        let made = |[r]: &[f64; 1]| NoiseFit {
            encoder_rad2: libm::exp(*r) + least_rad2(),
            ..start
        };
        let ([r], _) = least([libm::log(start.encoder_rad2)], [0.3], |at| {
            self.cost(&made(at))
        });
        made(&[r])
    }

    /// Encoder and broadband torque, and the cost.
    fn broadband(&self, white: NoiseFit) -> (NoiseFit, f64) {
        let mut excess: Vec<f64> = self
            .power
            .iter()
            .zip(&self.responses)
            .map(|(i, [load, _])| i / load)
            .collect();
        let torque_nm = middle_of(&mut excess).max(1e-30).sqrt();
        [0.001, 0.005, 0.02]
            .map(|torque_s| {
                self.refined(
                    NoiseFit {
                        torque_nm,
                        torque_s,
                        ..white
                    },
                    true,
                )
            })
            .into_iter()
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .unwrap_or((white, f64::INFINITY))
    }

    /// Returns the candidate for a line: the frequency that is furthest above its surroundings.
    fn line(&self) -> Option<NoiseFit> {
        let beside = |n: usize| {
            let mut around =
                self.power[n.saturating_sub(BESIDE)..(n + BESIDE).min(self.power.len())].to_vec();
            middle_of(&mut around)
        };
        let above = |n: usize| self.power[n] / beside(n);
        let n = (0..self.power.len()).max_by(|&a, &b| above(a).total_cmp(&above(b)))?;
        let (level, step_hz) = (beside(n), self.hz[1] - self.hz[0]);
        let range = n.saturating_sub(BESIDE / 2)..(n + BESIDE / 2).min(self.power.len());
        let nm2: f64 = range
            .map(|n| (self.power[n] - level).max(0.0) / self.responses[n][0])
            .sum();
        let line_nm = (4.0 * nm2 * step_hz * self.servo_s).sqrt();
        Some(NoiseFit {
            line_nm,
            line_hz: self.hz[n],
            wander_hz: 0.02 * self.hz[n],
            ..NoiseFit::default()
        })
    }

    /// The most likely near a start, and the cost.
    fn refined(&self, start: NoiseFit, broad: bool) -> (NoiseFit, f64) {
        let Self {
            servo_s, window_hz, ..
        } = *self;
        let made = |[r, s, t, d, f, v]: &[f64; 6]| NoiseFit {
            encoder_rad2: libm::exp(*r) + least_rad2(),
            torque_nm: if broad { libm::exp(*s) } else { 0.0 },
            torque_s: if broad { libm::exp(*t) } else { 0.0 },
            line_nm: if start.line_nm > 0.0 {
                libm::exp(*d)
            } else {
                0.0
            },
            line_hz: if start.line_nm > 0.0 {
                start.line_hz + window_hz * f
            } else {
                0.0
            },
            wander_hz: if start.line_nm > 0.0 {
                libm::exp(*v)
            } else {
                0.0
            },
            left_rad2: start.left_rad2,
        };
        let reach_hz = BESIDE as f64 * window_hz;
        let cost = |at: &[f64; 6]| {
            let noise = made(at);
            let is_within = (!broad
                || (SHORTEST_PERIODS * servo_s..=LONGEST_S).contains(&noise.torque_s))
                && (start.line_nm == 0.0
                    || noise.line_hz > LEAST_HZ
                        && (noise.line_hz - start.line_hz).abs() < reach_hz
                        && noise.wander_hz < WIDEST * noise.line_hz);
            if is_within {
                self.cost(&noise)
            } else {
                f64::INFINITY
            }
        };
        let log = |x: f64, least: f64| libm::log(x.max(least));
        let NoiseFit {
            encoder_rad2,
            torque_nm,
            torque_s,
            line_nm,
            wander_hz,
            ..
        } = start;
        let from = [
            libm::log(encoder_rad2),
            log(torque_nm, 1e-15),
            log(torque_s, servo_s),
            log(line_nm, 1e-15),
            0.0,
            log(wander_hz, 0.1 * window_hz),
        ];
        let (at, _) = least(from, [-1.0, 0.5, 0.5, 0.3, 1.0, -0.7], cost);
        // Once more from there: a simplex that has become flat finds no way out.
        let (at, value) = least(at, [0.3, -0.3, -0.3, -0.2, -0.5, 0.5], cost);
        (made(&at), value)
    }
}

/// A line beside other noise.
fn with_line(line: &NoiseFit, noise: &NoiseFit) -> NoiseFit {
    NoiseFit {
        line_nm: line.line_nm,
        line_hz: line.line_hz,
        wander_hz: line.wander_hz,
        ..*noise
    }
}

fn least_rad2() -> f64 {
    LEAST_NOISE_RAD * LEAST_NOISE_RAD
}
