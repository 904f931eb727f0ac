//! Least squares of what free runs leave of the actual position, and of what was known before.
//!
//! ```text
//! minimise  V(p) = sum_k ((y(k) - y_s(k; c, p)) / s)^2 + sum_i ((g_i(p) - m_i) / d_i)^2      k over the samples that count
//! (S^T S + l diag(S^T S)) dp = S^T r,   S = -dr / dp by differences
//! ```
//!
//! y is the actual position, c are the commands, and y_s is a free run on the commands alone from
//! the beginning of each stretch. s is the RMS residual of the last fit, times the square root of
//! its correlation length in samples where priors are weighed. g, m and d are from
//! [`super::priors`]. What is noise of the encoder or of the load does not depend on the command,
//! and leaves the minimum where it is (see [`super::super::axis_parameters`]).
//!
//! All frequencies have the same weight. Weighting by the inverse spectrum of the residual is more
//! efficient where the model is complete, and worse where it is not: on the bench EMPS a whitening
//! filter of 40 lags gave 3.5 um in place of 1.6.
//!
//! Source: Levenberg (1944), Marquardt (1963) for the damped step; Geyer (1992), Practical Markov
//! chain Monte Carlo, for the sum of correlations; the output error as in
//! [`super::super::axis_parameters`].

use feedwright_sim::map_in_parallel;
use nalgebra::{DMatrix, DVector};

use super::axis_record::AxisRecord;
use super::axis_run::{AxisRun, Commands};
use super::priors::Prior;
use super::terms::{ModelTerm, TermValues};

/// A record, which of its samples count, and what was known before.
#[derive(Debug, Clone, Copy)]
pub(super) struct OutputErrors<'a> {
    pub(super) record: &'a AxisRecord<'a>,
    pub(super) counts: &'a [bool],
    /// Standard deviation that residuals are taken in, mm.
    pub(super) deviation_mm: f64,
    pub(super) priors: &'a [Prior],
}

/// The least that was found.
#[derive(Debug, Clone)]
pub(super) struct Fitted {
    pub(super) values: TermValues,
    /// Sum of the squares of its residuals.
    pub(super) cost: f64,
}

/// Damping at the start, after a step that helped, after one that did not; given up at the last.
const DAMPING: f64 = 1e-2;
const DAMPING_AFTER: [f64; 2] = [0.2, 6.0];
const DAMPING_MOST: f64 = 1e5;
/// A gain or a time is changed by no more than this in one step, up or down.
const LARGEST_FACTOR: f64 = 2.5;
/// Part of V below which a step gains nothing: where the fit is to be the last, and where it only
/// chooses.
pub(super) const DONE: f64 = 1e-6;
pub(super) const NEARLY_DONE: f64 = 1e-4;
/// Free runs that take turns on a processor.
const ABREAST: usize = 4;

impl OutputErrors<'_> {
    /// Scales the residuals by the RMS residual of these values.
    pub(super) fn scaled_by(self, values: &TermValues) -> Self {
        Self {
            deviation_mm: self.rms_mm(values).max(f64::MIN_POSITIVE),
            ..self
        }
    }

    /// Scales the residuals so that as many samples as the residual of these values is correlated
    /// over count as one. Prior knowledge then has its proper weight.
    pub(super) fn weighed_by(self, values: &TermValues) -> Self {
        let left = self.left_mm(values);
        let deviation_mm =
            root_mean_square(&left) * correlated_samples(&left, self.record.sample_s).sqrt();
        Self {
            deviation_mm: deviation_mm.max(f64::MIN_POSITIVE),
            ..self
        }
    }

    /// Returns the residuals of free runs at the samples that count, mm.
    pub(super) fn left_mm(&self, values: &TermValues) -> Vec<f64> {
        let [left] = self.left_abreast_mm(&[values]);
        left
    }

    fn left_abreast_mm<const L: usize>(&self, values: &[&TermValues; L]) -> [Vec<f64>; L] {
        let runs = values.map(|values| AxisRun::new(values, self.record.sample_s));
        let runs = runs.each_ref();
        let mut left = [const { vec![] }; L];
        for stretch in self.record.stretches {
            let Some(last) = stretch.clone().rev().find(|&k| self.counts[k]) else {
                continue;
            };
            let commands = Commands::new(&self.record.command_mm[stretch.clone()]);
            let [mm, mm_s] = self.record.start(stretch, stretch.start);
            let mut states = runs.map(|run| run.state(&commands, 0, mm, mm_s));
            for k in stretch.start..=last {
                if self.counts[k] {
                    let actual_mm = self.record.actual_mm[k];
                    left.iter_mut()
                        .zip(&states)
                        .for_each(|(left, state)| left.push(actual_mm - state.position_mm()));
                }
                AxisRun::step_abreast(&runs, &commands, k - stretch.start, &mut states);
            }
        }
        left
    }

    /// RMS of it, mm; infinite where the run is lost.
    pub(super) fn rms_mm(&self, values: &TermValues) -> f64 {
        root_mean_square(&self.left_mm(values))
    }

    /// Returns the residuals of free runs in standard deviations, followed by a row for each prior.
    pub(super) fn residuals(&self, values: &TermValues) -> Vec<f64> {
        self.scaled(self.left_mm(values), values)
    }

    /// The same of several.
    fn residuals_of(&self, values: &[TermValues]) -> Vec<Vec<f64>> {
        self.all_left_mm(values)
            .into_iter()
            .zip(values)
            .map(|(left, values)| self.scaled(left, values))
            .collect()
    }

    /// RMS of what free runs by several leave, mm.
    pub(super) fn all_rms_mm(&self, values: &[TermValues]) -> Vec<f64> {
        self.all_left_mm(values)
            .iter()
            .map(|left| root_mean_square(left))
            .collect()
    }

    fn all_left_mm(&self, values: &[TermValues]) -> Vec<Vec<f64>> {
        let abreast = |values: &[TermValues]| match values {
            [a, b, c, d] => self.left_abreast_mm(&[a, b, c, d]).into(),
            [a, b, c] => {
                let [a, b, c, _] = self.left_abreast_mm(&[a, b, c, c]);
                vec![a, b, c]
            }
            [a, b] => self.left_abreast_mm(&[a, b]).into(),
            _ => values
                .iter()
                .map(|values| self.left_mm(values))
                .collect::<Vec<_>>(),
        };
        map_in_parallel(values.chunks(ABREAST), abreast)
            .into_iter()
            .flatten()
            .collect()
    }

    fn scaled(&self, mut left_mm: Vec<f64>, values: &TermValues) -> Vec<f64> {
        left_mm
            .iter_mut()
            .for_each(|left| *left /= self.deviation_mm);
        left_mm.extend(self.priors.iter().map(|prior| prior.residual(values)));
        left_mm
    }

    /// Derivatives of the residuals by differences to both sides, a column for each term, over the
    /// change that it was made with.
    pub(super) fn slopes(&self, values: &TermValues, terms: &[ModelTerm]) -> Vec<Vec<f64>> {
        let sides = |&term: &ModelTerm| {
            let (value, by) = (values.get(term), change(values, term));
            [value + by, value - by].map(|at| values.with(term, at))
        };
        let places: Vec<TermValues> = terms.iter().flat_map(sides).collect();
        let residuals = self.residuals_of(&places);
        let slope = |i: usize, term: ModelTerm| {
            let apart =
                (places[2 * i].get(term) - places[2 * i + 1].get(term)) / change(values, term);
            difference(&residuals[2 * i + 1], &residuals[2 * i], apart)
        };
        terms
            .iter()
            .enumerate()
            .map(|(i, &term)| slope(i, term))
            .collect()
    }

    /// The same by differences to one side, from residuals that are known: enough for a step that
    /// is not the last.
    fn rough_slopes(
        &self,
        values: &TermValues,
        residuals: &[f64],
        terms: &[ModelTerm],
    ) -> Vec<Vec<f64>> {
        let place = |&term: &ModelTerm| {
            let (value, by) = (values.get(term), ONE_SIDED * change(values, term));
            let above = values.with(term, value + by);
            if above.get(term) > value {
                above
            } else {
                values.with(term, value - by)
            }
        };
        let places: Vec<TermValues> = terms.iter().map(place).collect();
        let slope = |(&term, (place, at_place)): (&ModelTerm, (&TermValues, &Vec<f64>))| {
            let apart = ONE_SIDED * (place.get(term) - values.get(term))
                / (ONE_SIDED * change(values, term));
            difference(residuals, at_place, apart)
        };
        terms
            .iter()
            .zip(places.iter().zip(&self.residuals_of(&places)))
            .map(slope)
            .collect()
    }

    /// One step of all terms from a start, with slopes that are known of the first of them.
    pub(super) fn one_step(
        &self,
        start: &TermValues,
        terms: &[ModelTerm],
        known: &[Vec<f64>],
    ) -> Fitted {
        let left = self.residuals(start);
        let mut slopes = known.to_vec();
        slopes.extend(self.rough_slopes(start, &left, &terms[known.len()..]));
        let (curvature, gradient) = normal_equations(&slopes, &left);
        let before = Fitted {
            values: *start,
            cost: square(&left),
        };
        let after = [DAMPING, 1.0]
            .map(|damping| stepped(start, terms, &curvature, &gradient, damping))
            .map(|values| Fitted {
                values,
                cost: square(&self.residuals(&values)),
            });
        after.into_iter().fold(
            before,
            |best, next| if next.cost < best.cost { next } else { best },
        )
    }

    /// Searches the least squares from a start over these terms. Ends after `steps` steps, or when
    /// one gains less than the part `done` of V.
    pub(super) fn least(
        &self,
        start: &TermValues,
        terms: &[ModelTerm],
        steps: usize,
        done: f64,
    ) -> Fitted {
        let mut at = *start;
        let mut left = self.residuals(&at);
        let (mut cost, mut damping) = (square(&left), DAMPING);
        for _ in 0..steps {
            let is_last = done <= DONE;
            let slopes = if is_last {
                self.slopes(&at, terms)
            } else {
                self.rough_slopes(&at, &left, terms)
            };
            let (curvature, gradient) = normal_equations(&slopes, &left);
            let before = cost;
            while damping < DAMPING_MOST {
                let next = stepped(&at, terms, &curvature, &gradient, damping);
                let next_left = self.residuals(&next);
                let next_cost = square(&next_left);
                if next_cost < cost {
                    (at, left, cost) = (next, next_left, next_cost);
                    damping = (damping * DAMPING_AFTER[0]).max(1e-9);
                    break;
                }
                damping *= DAMPING_AFTER[1];
            }
            if damping >= DAMPING_MOST || (before - cost).abs() < done * before {
                break;
            }
        }
        Fitted { values: at, cost }
    }
}

/// Correlation length of a residual in samples: 1 + 2 sum of its autocorrelations, up to the first
/// that is not positive.
fn correlated_samples(left: &[f64], sample_s: f64) -> f64 {
    let covariance = |lag: usize| {
        left.iter()
            .zip(&left[lag.min(left.len())..])
            .map(|(a, b)| a * b)
            .sum::<f64>()
    };
    let variance = covariance(0);
    if !(variance.is_finite() && variance > 0.0) {
        return 1.0;
    }
    let longest = ((CORRELATED_S / sample_s) as usize).min(left.len() / 4);
    let correlations = (1..=longest).map(|lag| covariance(lag) / variance);
    1.0 + 2.0
        * correlations
            .take_while(|correlation| *correlation > 0.0)
            .sum::<f64>()
}

/// A residual is taken to be correlated over no more than this, s.
const CORRELATED_S: f64 = 0.25;

/// Part of a change that a difference to one side is made with: its error grows with it, and
/// misleads where numbers trade places.
const ONE_SIDED: f64 = 0.1;

/// Returns the decrease of the residuals from one place to another, divided by the change between
/// them.
fn difference(from: &[f64], to: &[f64], apart: f64) -> Vec<f64> {
    // At an end of its range a number that nothing moves has no slope.
    let per = if apart == 0.0 { 0.0 } else { 1.0 / apart };
    from.iter()
        .zip(to)
        .map(|(from, to)| (from - to) * per)
        .collect()
}

/// Returns the change of a number for a difference.
pub(super) fn change(values: &TermValues, term: ModelTerm) -> f64 {
    let [part, least] = term.row().change;
    (part * values.get(term).abs()).max(least)
}

/// S^T S and S^T r.
pub(super) fn normal_equations(slopes: &[Vec<f64>], left: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
    let n = slopes.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let rows: Vec<Vec<f64>> = map_in_parallel(0..n, |i| {
        (0..=i).map(|j| dot(&slopes[i], &slopes[j])).collect()
    });
    let curvature = DMatrix::from_fn(n, n, |i, j| rows[i.max(j)][i.min(j)]);
    (curvature, DVector::from_fn(n, |i, _| dot(&slopes[i], left)))
}

/// Returns the values after a damped step. A number at an end of its range stays there if it would
/// otherwise move beyond it; the others take the step.
fn stepped(
    at: &TermValues,
    terms: &[ModelTerm],
    curvature: &DMatrix<f64>,
    gradient: &DVector<f64>,
    damping: f64,
) -> TermValues {
    let mut held = vec![false; terms.len()];
    loop {
        let mut damped = curvature.clone();
        let mut towards = gradient.clone();
        for i in 0..terms.len() {
            let diagonal = curvature[(i, i)];
            damped[(i, i)] += damping * diagonal + f64::MIN_POSITIVE;
            if held[i] || diagonal <= 0.0 {
                damped.row_mut(i).fill(0.0);
                damped.column_mut(i).fill(0.0);
                damped[(i, i)] = 1.0;
                towards[i] = 0.0;
            }
        }
        let Some(cholesky) = damped.cholesky() else {
            return *at;
        };
        let step = cholesky.solve(&towards);
        let mut is_new = false;
        for (i, &term) in terms.iter().enumerate() {
            let wanted = at.get(term) + step[i] * change(at, term);
            if !held[i] && step[i] != 0.0 && at.get(term) == at.with(term, wanted).get(term) {
                (held[i], is_new) = (true, true);
            }
        }
        if is_new {
            continue;
        }
        return terms.iter().enumerate().fold(*at, |next, (i, &term)| {
            let value = at.get(term);
            let wanted = value + step[i] * change(at, term);
            let is_size = matches!(
                term,
                ModelTerm::LoopGain
                    | ModelTerm::Damping
                    | ModelTerm::SpeedLimit
                    | ModelTerm::AccelerationLimit
                    | ModelTerm::StribeckSpeed
            );
            let bounded = if is_size {
                wanted.clamp(value / LARGEST_FACTOR, value * LARGEST_FACTOR)
            } else {
                wanted
            };
            next.with(term, bounded)
        });
    }
}

/// Sum of squares; infinite where one is not a number.
pub(super) fn square(left: &[f64]) -> f64 {
    let sum: f64 = left.iter().map(|left| left * left).sum();
    if sum.is_finite() { sum } else { f64::INFINITY }
}

fn root_mean_square(left: &[f64]) -> f64 {
    (square(left) / left.len().max(1) as f64).sqrt()
}
