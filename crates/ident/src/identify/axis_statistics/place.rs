//! What repeats with place: interpolation error of the encoder, and cogging, from the innovations.
//!
//! ```text
//! score(n)  = sum of a(k) exp(i n theta(k)),   a = adjoint of H applied to e / S        all candidates at once
//! r         = counts * (H applied to cos, sin of n theta)                                a candidate itself
//! gain of 2 ln L = p' G^-1 p,   p = <r, e>,  G = <r, r>,   <u, v> = sum over f of conj(U) V / S / samples
//! ```
//!
//! S is the spectrum that noise makes, so that the gain has a chi-squared distribution with two
//! degrees of freedom where there is nothing; the best of many candidates is admitted beyond
//! [`CHANCE`].
//!
//! Source: Rao (1948) for the score; Kay (1993), Fundamentals of Statistical Signal Processing:
//! Estimation Theory, chapter 4, for the linear model in coloured noise, and its frequency domain;
//! Lomb (1976) for a period in samples that are not evenly spaced.

use std::f64::consts::TAU;

use super::innovation::Innovations;
use super::noise::{LEAST_HZ, NoiseFit};
use crate::spectrum::{
    Phasor, conjugate, power, times, transform, transform_back, transformed, turned,
};

/// Probability that a term is admitted although it is absent.
const CHANCE: f64 = 1e-6;
/// Fewest lines of cogging in a turn that are looked for: the poles and slots of a motor make six or
/// more, and what friction leaves at each stroke looks like fewer.
const LEAST_PER_REV: u32 = 4;
/// Most lines of cogging in a turn that are looked for: four times the 50 teeth of a stepper.
const MOST_PER_REV: u32 = 200;
/// Factor of the gain that a wave needs where steps are the only noise of the encoder. Rounding of a
/// constant speed makes lines in time, and they look like waves over the place: of 60 in 2 ln L on
/// `coarse`, where chance gives 42.
const STEPS_STRICTNESS: f64 = 5.0;
/// Most lines of cogging in a turn where the turn may be another: 200 lines on half the lead.
const MOST_PER_WAY: u32 = 400;
/// Growth of 2 ln L by which lines that are no whole number are more likely: one variable more.
const MORE_LIKELY: f64 = 20.0;
/// Signal periods that are looked for, rad at the motor: 1 um and 0.2 mm of travel on a lead of 10
/// mm.
const SIGNAL_RAD: [f64; 2] = [TAU * 1e-4, TAU * 0.02];
/// Most places into which a way is divided to look for a signal period.
const MOST_PLACES: usize = 1 << 20;
/// Best candidates of the scan that are tried themselves.
const TRIED: usize = 2;

/// A sine over the angle of the motor: a cos(n theta) + b sin(n theta).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Wave {
    /// Turns of the sine in a radian, times 2 pi.
    pub(super) per_rad: f64,
    pub(super) cos: f64,
    pub(super) sin: f64,
}

impl Wave {
    /// Amplitude.
    pub(super) fn amplitude(&self) -> f64 {
        libm::hypot(self.cos, self.sin)
    }

    /// Phase of A sin(n theta + phase), rad.
    pub(super) fn phase_rad(&self) -> f64 {
        libm::atan2(self.cos, self.sin)
    }
}

/// The innovations of an axis and how they weigh.
pub(super) struct Weighed<'a> {
    innovations: &'a Innovations,
    length: usize,
    /// Responses to a load and to the encoder.
    responses: &'a [Vec<Phasor>; 2],
    /// 1 / S.
    weights: Vec<f64>,
    /// Factor of the gain that a wave needs.
    strictness: f64,
}

/// Input through which a wave acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Through {
    /// Torque of the motor.
    Motor,
    /// Reading of the encoder.
    Encoder,
}

impl<'a> Weighed<'a> {
    /// Weighs innovations by the spectrum of a noise. `is_steps` states that the encoder has no noise
    /// but the rounding to its steps. The responses cover `length` samples, a power
    /// of two above the number of innovations.
    pub(super) fn new(
        innovations: &'a Innovations,
        responses: &'a [Vec<Phasor>; 2],
        noise: &NoiseFit,
        servo_s: f64,
        is_steps: bool,
    ) -> Self {
        let length = responses[0].len();
        let [load, encoder] = responses;
        let weight = |n: usize| {
            let hz = n.min(length - n) as f64 / (length as f64 * servo_s);
            // A line is as wide as it is while it is watched.
            let s = noise.at(
                hz,
                [power(load[n]), power(encoder[n])],
                servo_s,
                0.02 * LEAST_HZ,
            );
            if hz < LEAST_HZ { 0.0 } else { 1.0 / s }
        };
        Self {
            innovations,
            length,
            responses,
            weights: (0..length).map(weight).collect(),
            strictness: if is_steps { STEPS_STRICTNESS } else { 1.0 },
        }
    }

    /// Returns the cogging, if it shows, and the gain in 2 ln L: by `known` lines in a turn, or by
    /// any number of them. A whole number goes before others that are hardly more likely.
    pub(super) fn cogging(&self, least_nm: f64, known: Option<f64>) -> Option<(Wave, f64)> {
        if let Some(lines) = known {
            return self.best(Through::Motor, vec![(lines, 0.0)], 1.0, least_nm);
        }
        let adjoint = self.adjoint(Through::Motor);
        let middles: Vec<f64> = self.middles().collect();
        let information = self.information(&middles);
        let least_information = f64::MIN_POSITIVE;
        let informations: Vec<f64> = (0..=MOST_PER_WAY)
            .map(|n| information(f64::from(n)).max(least_information))
            .collect();
        let whole = self.whole_lines(&adjoint, &middles, &informations, least_nm);
        let any = self.any_lines(&adjoint, &middles, &informations, least_nm);
        match (whole, any) {
            (Some(whole), Some(any)) if any.1 < whole.1 + MORE_LIKELY => Some(whole),
            (whole, any) => any.or(whole),
        }
    }

    /// Returns the cogging by whole lines in a turn.
    fn whole_lines(
        &self,
        adjoint: &[f64],
        middles: &[f64],
        informations: &[f64],
        least_nm: f64,
    ) -> Option<(Wave, f64)> {
        let steps: Vec<Phasor> = middles.iter().map(|&angle_rad| turned(angle_rad)).collect();
        let mut turns: Vec<Phasor> = vec![[1.0, 0.0]; steps.len()];
        let mut candidates: Vec<(f64, f64)> = Vec::new();
        for (n, information) in (1..=MOST_PER_REV).zip(&informations[1..]) {
            let mut score = [0.0; 2];
            for ((turn, step), a) in turns.iter_mut().zip(&steps).zip(adjoint) {
                *turn = times(*turn, *step);
                score[0] += a * turn[0];
                score[1] += a * turn[1];
            }
            if n >= LEAST_PER_REV {
                candidates.push((f64::from(n), power(score) / information));
            }
        }
        self.best(
            Through::Motor,
            candidates,
            f64::from(MOST_PER_REV),
            least_nm,
        )
    }

    /// Returns the cogging of a motor whose turn is another than the axis model says: by any number
    /// of lines.
    fn any_lines(
        &self,
        adjoint: &[f64],
        middles: &[f64],
        informations: &[f64],
        least_nm: f64,
    ) -> Option<(Wave, f64)> {
        let most = f64::from(MOST_PER_WAY);
        let (unit, scores) = scan(middles, adjoint, TAU / most)?;
        let last = ((most / unit) as usize).min(scores.len() / 3);
        let range = (f64::from(LEAST_PER_REV) / unit).ceil() as usize..last;
        let candidates: Vec<(f64, f64)> = range
            .clone()
            .map(|n| {
                let lines = n as f64 * unit;
                let (before, part) = (lines as usize, lines.fract());
                let [a, b] =
                    [before, before + 1].map(|n| informations[n.min(informations.len() - 1)]);
                (lines, power(scores[n]) / (a + part * (b - a)))
            })
            .collect();
        let tried = best_of(candidates, TRIED)
            .into_iter()
            .map(|(lines, gain)| (self.finest(middles, adjoint, lines, unit), gain))
            .collect();
        self.best(Through::Motor, tried, range.len() as f64, least_nm)
    }

    /// Returns the interpolation error of an encoder with this step, and the gain in 2 ln L, like
    /// [`Self::cogging`].
    pub(super) fn interpolation(
        &self,
        step_rad: f64,
        least_rad: f64,
        known: Option<f64>,
    ) -> Option<(Wave, f64)> {
        if let Some(per_rad) = known {
            return self.best(Through::Encoder, vec![(per_rad, 0.0)], 1.0, least_rad);
        }
        let adjoint = self.adjoint(Through::Encoder);
        let angles = &self.innovations.angle_rad;
        let [shortest, longest] = SIGNAL_RAD;
        // The steps themselves repeat with place, too.
        let shortest = shortest.max(4.0 * step_rad);
        let (unit, scores) = scan(angles, &adjoint, shortest)?;
        let range = (TAU / longest / unit) as usize
            ..((TAU / shortest / unit) as usize).min(scores.len() / 3);
        let candidates: Vec<(f64, f64)> = range
            .clone()
            .map(|n| (n as f64 * unit, power(scores[n])))
            .collect();
        let fine = |per_rad: f64| self.finest(angles, &adjoint, per_rad, unit);
        let tried = best_of(candidates, TRIED)
            .into_iter()
            .map(|(per_rad, gain)| (fine(per_rad), gain))
            .collect();
        self.best(Through::Encoder, tried, range.len() as f64, least_rad)
    }

    /// The frequency near one at which the score is greatest, by golden section.
    fn finest(&self, angles: &[f64], adjoint: &[f64], per_rad: f64, unit: f64) -> f64 {
        let score = |per_rad: f64| {
            let add = |sum: Phasor, (angle, a): (&f64, &f64)| {
                let [cos, sin] = turned(per_rad * angle);
                [sum[0] + a * cos, sum[1] + a * sin]
            };
            power(angles.iter().zip(adjoint).fold([0.0; 2], add))
        };
        let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
        let (mut low, mut high) = (per_rad - unit, per_rad + unit);
        let (mut a, mut b) = (high - golden * (high - low), low + golden * (high - low));
        let (mut of_a, mut of_b) = (score(a), score(b));
        // To a thousandth of the width of the peak.
        for _ in 0..15 {
            if of_a > of_b {
                (high, b, of_b) = (b, a, of_a);
                a = high - golden * (high - low);
                of_a = score(a);
            } else {
                (low, a, of_a) = (a, b, of_b);
                b = low + golden * (high - low);
                of_b = score(b);
            }
        }
        0.5 * (low + high)
    }

    /// The best candidate itself, where it is beyond chance and above `least`.
    fn best(
        &self,
        through: Through,
        candidates: Vec<(f64, f64)>,
        looked_at: f64,
        least: f64,
    ) -> Option<(Wave, f64)> {
        let least_gain = self.strictness * 2.0 * libm::log(looked_at / CHANCE);
        let error = self.innovations_transformed();
        best_of(candidates, TRIED)
            .into_iter()
            .filter_map(|(per_rad, _)| self.fitted(&error, &[(through, per_rad)]))
            .max_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, gain)| *gain > least_gain)
            .and_then(|(waves, gain)| Some((*waves.first()?, gain)))
            .filter(|(wave, _)| wave.amplitude() > least)
    }

    /// The same waves with the amplitudes that are most likely together.
    pub(super) fn amplitudes(&self, waves: &[(Through, Wave)]) -> Vec<(Through, Wave)> {
        let kinds: Vec<(Through, f64)> = waves
            .iter()
            .map(|(through, wave)| (*through, wave.per_rad))
            .collect();
        let fitted = self
            .fitted(&self.innovations_transformed(), &kinds)
            .map(|(waves, _)| waves)
            .unwrap_or_default();
        kinds
            .into_iter()
            .map(|(through, _)| through)
            .zip(fitted)
            .collect()
    }

    /// Innovations without what these waves make of them.
    pub(super) fn without(&self, waves: &[(Through, Wave)]) -> Innovations {
        let mut left = self.innovations.clone();
        for (through, wave) in waves {
            let [cos, sin] = self.regressors(*through, wave.per_rad);
            let made = cos
                .iter()
                .zip(&sin)
                .map(|(c, s)| wave.cos * c + wave.sin * s);
            left.error_rad
                .iter_mut()
                .zip(made)
                .for_each(|(error, made)| *error -= made);
        }
        left
    }

    /// Fits waves, and returns them with the gain in 2 ln L. `None` if the data do not separate
    /// them.
    fn fitted(&self, error: &[Phasor], waves: &[(Through, f64)]) -> Option<(Vec<Wave>, f64)> {
        let columns: Vec<Vec<Phasor>> = waves
            .iter()
            .flat_map(|&(through, per_rad)| self.regressors(through, per_rad))
            .map(|column| self.transformed(&column))
            .collect();
        let inner = |u: &[Phasor], v: &[Phasor]| {
            let product = |((u, v), w): ((&Phasor, &Phasor), &f64)| w * (u[0] * v[0] + u[1] * v[1]);
            u.iter().zip(v).zip(&self.weights).map(product).sum::<f64>() / self.length as f64
        };
        let scores: Vec<f64> = columns.iter().map(|column| inner(column, error)).collect();
        let mut system: Vec<Vec<f64>> = columns
            .iter()
            .map(|u| columns.iter().map(|v| inner(u, v)).collect())
            .collect();
        let solved = solved(&mut system, &scores)?;
        let gain = solved.iter().zip(&scores).map(|(x, p)| x * p).sum();
        let wave = |(&(_, per_rad), pair): (&(Through, f64), &[f64])| Wave {
            per_rad,
            cos: pair[0],
            sin: pair[1],
        };
        Some((waves.iter().zip(solved.chunks(2)).map(wave).collect(), gain))
    }

    /// Returns the response of the innovations to the cosine and the sine of an angle.
    fn regressors(&self, through: Through, per_rad: f64) -> [Vec<f64>; 2] {
        let length = self.length;
        let mut values: Vec<Phasor> = match through {
            Through::Encoder => self
                .innovations
                .angle_rad
                .iter()
                .map(|&x| turned(per_rad * x))
                .collect(),
            Through::Motor => {
                // The mean over a servo period at constant speed; a torque of the motor is no load.
                let spans = self
                    .innovations
                    .angle_rad
                    .windows(2)
                    .map(|pair| 0.5 * per_rad * (pair[1] - pair[0]));
                let mean = |(middle, half): (f64, f64)| {
                    let share = if half.abs() < 1e-4 {
                        1.0
                    } else {
                        libm::sin(half) / half
                    };
                    turned(per_rad * middle).map(|x| -share * x)
                };
                self.middles().zip(spans).map(mean).collect()
            }
        };
        values.resize(length, [0.0; 2]);
        transform(&mut values);
        let response = self.response(through);
        values
            .iter_mut()
            .zip(response)
            .for_each(|(value, h)| *value = times(*value, *h));
        transform_back(&mut values);
        let counts = &self.innovations.counts;
        // The response is real: real and imaginary part stay apart.
        [0, 1].map(|part| {
            values
                .iter()
                .zip(counts)
                .map(|(v, &counts)| if counts { v[part] } else { 0.0 })
                .collect()
        })
    }

    /// Angles in the middle of the servo periods.
    fn middles(&self) -> impl Iterator<Item = f64> + '_ {
        self.innovations
            .angle_rad
            .windows(2)
            .map(|pair| 0.5 * (pair[0] + pair[1]))
    }

    fn response(&self, through: Through) -> &[Phasor] {
        let [load, encoder] = self.responses;
        match through {
            Through::Motor => load,
            Through::Encoder => encoder,
        }
    }

    fn transformed(&self, values: &[f64]) -> Vec<Phasor> {
        transformed(values, self.length)
    }

    fn innovations_transformed(&self) -> Vec<Phasor> {
        let counted = self
            .innovations
            .error_rad
            .iter()
            .zip(&self.innovations.counts);
        let counted: Vec<f64> = counted
            .map(|(&error, &counts)| if counts { error } else { 0.0 })
            .collect();
        self.transformed(&counted)
    }

    /// Projects the innovations onto a reading or a torque at each sample.
    fn adjoint(&self, through: Through) -> Vec<f64> {
        let mut values = self.innovations_transformed();
        for ((value, h), weight) in values
            .iter_mut()
            .zip(self.response(through))
            .zip(&self.weights)
        {
            *value = times(*value, conjugate(*h)).map(|x| x * weight);
        }
        transform_back(&mut values);
        values.iter().map(|value| value[0]).collect()
    }

    /// Approximates the information about a wave of the motor: each servo period counts as if it
    /// had the frequency of its speed for a long time.
    fn information(&self, middles: &[f64]) -> impl Fn(f64) -> f64 {
        let load = self.response(Through::Motor);
        let of: Vec<f64> = load
            .iter()
            .zip(&self.weights)
            .map(|(h, weight)| power(*h) * weight)
            .collect();
        let steps: Vec<f64> = middles
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) / TAU * of.len() as f64)
            .collect();
        let length = of.len() as f64;
        move |per_rad: f64| {
            let at = |step: &f64| of[(step * per_rad).rem_euclid(length) as usize % of.len()];
            // Every eighth step represents all of them.
            8.0 * steps.iter().step_by(8).map(at).sum::<f64>()
        }
    }
}

/// Returns the scores of waves over these angles whose numbers of turns in a radian, times 2 pi, are
/// multiples of a unit, and that unit: up to waves of the period `shortest_rad` and somewhat beyond.
/// `None` if the angles are all the same.
fn scan(angles: &[f64], adjoint: &[f64], shortest_rad: f64) -> Option<(f64, Vec<Phasor>)> {
    let ends = angles
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &x| {
            [a.min(x), b.max(x)]
        });
    let way_rad = ends[1] - ends[0];
    if way_rad.is_nan() || way_rad <= 0.0 {
        return None;
    }
    // Four places in the shortest period, and half as much again beyond the way: the peak is never
    // between two frequencies.
    let places = ((4.0 * 1.5 * way_rad / shortest_rad) as usize)
        .next_power_of_two()
        .min(MOST_PLACES);
    let place_rad = 1.5 * way_rad / places as f64;
    let mut binned = vec![[0.0; 2]; places];
    for (angle_rad, a) in angles.iter().zip(adjoint) {
        binned[(((angle_rad - ends[0]) / place_rad) as usize).min(places - 1)][0] += a;
    }
    transform(&mut binned);
    Some((TAU / (place_rad * places as f64), binned))
}

/// Returns the local maxima with the greatest gain.
fn best_of(mut candidates: Vec<(f64, f64)>, most: usize) -> Vec<(f64, f64)> {
    let peaks: Vec<bool> = (0..candidates.len())
        .map(|n| {
            let gain = |n: usize| candidates.get(n).map_or(0.0, |candidate| candidate.1);
            gain(n) >= gain(n + 1) && (n == 0 || gain(n) >= gain(n - 1))
        })
        .collect();
    let mut peak = peaks.iter();
    candidates.retain(|_| peak.next() == Some(&true));
    candidates.sort_by(|a, b| b.1.total_cmp(&a.1));
    candidates.truncate(most);
    candidates
}

/// Solution of a symmetric positive system, by Cholesky's method; none where it is not positive.
fn solved(system: &mut [Vec<f64>], right: &[f64]) -> Option<Vec<f64>> {
    let size = right.len();
    for j in 0..size {
        let (before, row) = system.split_at_mut(j);
        let row = row.first_mut()?;
        for (i, other) in before.iter().enumerate() {
            let sum: f64 = (0..i).map(|k| row[k] * other[k]).sum();
            row[i] = (row[i] - sum) / other[i];
        }
        let square = row[j] - row[..j].iter().map(|x| x * x).sum::<f64>();
        // A column that is one of the others but for rounding.
        if square.is_nan() || square <= 1e-9 * row[j] {
            return None;
        }
        row[j] = square.sqrt();
    }
    let mut x = right.to_vec();
    for i in 0..size {
        let sum: f64 = (0..i).map(|k| system[i][k] * x[k]).sum();
        x[i] = (x[i] - sum) / system[i][i];
    }
    for i in (0..size).rev() {
        let sum: f64 = (i + 1..size).map(|k| system[k][i] * x[k]).sum();
        x[i] = (x[i] - sum) / system[i][i];
    }
    Some(x)
}
