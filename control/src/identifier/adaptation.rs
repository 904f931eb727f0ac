//! Adaptation of the servo identifier while cutting: of two models of each axis, the one that has foreseen the last second
//! better is believed.
//!
//! ```text
//! trained:  y(k) = r(k)                           y(k) = e(k+1) - e(k) - N(I(k))
//! adapted:  y(k) = delta' phi(k) + r(k)           phi: the inputs of the axis itself
//! ```
//!
//! Both have a [`super::residual`] of their own. delta is fitted by [`crate::least_squares`] to y and phi filtered by the
//! autoregression of the trained model's residual (generalised least squares): unfiltered, a vibration would pass for a
//! change of the machine. Along what nothing excites (on a straight line all inputs stand still) delta goes back to zero,
//! what was identified, whatever the length of the line.
//!
//! Source: generalised least squares, Clarke (1967); switching between models by their recent predictions, Narendra and
//! Balakrishnan (1997).

use super::residual::{self, LAGS, Residual};
use super::servo::ServoIdentifier;
use super::{INPUTS, Inputs};
use crate::least_squares::LeastSquares;

/// The other model is believed where its mean square innovation is below this part of the present one's: no change of mind
/// over noise.
const CLEARLY_BETTER: f64 = 0.8;

/// Settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Part of the past that still counts one knot later, for the machine; 0.9 to 1.
    pub forgetting: f64,
    /// Innovations of this size are noise, mm.
    pub noise_mm: f64,
    /// By how much the linear connection of a machine may well differ from the identified, mm for an input of 1.
    pub spread_mm: f64,
    /// Part by which the mean squares that the models are judged by follow each innovation; 0.001 to 0.1.
    pub judging: f64,
    /// As [`Self::judging`], for how much the predictions are trusted; smaller remembers a surprise for longer.
    pub caution: f64,
    /// Innovations that are feared before any was seen, mm: a machine is met with caution.
    pub doubt_mm: f64,
    /// How much an axis that has not moved yet is taken to be like the others; 0 (not at all) to 0.99.
    pub alike: f64,
    /// Prediction of what the models miss.
    pub residual: residual::Settings,
}

impl Settings {
    /// Values that serve.
    pub const DEFAULT: Self = Self {
        forgetting: 0.995,
        noise_mm: 1e-2,
        spread_mm: 0.2,
        judging: 0.01,
        caution: 0.002,
        doubt_mm: 0.0,
        alike: 0.9,
        residual: residual::Settings::DEFAULT,
    };
}

/// The identifier as it is now, and what it follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Adaptation<const N: usize> {
    trained: ServoIdentifier<N>,
    now: ServoIdentifier<N>,
    axes: [Axis; N],
    /// Mean squares of the innovations of both models lately, over all axes, mm2.
    square_mm2: [f64; 2],
    /// As these, of the model that was believed, over a longer time.
    long_square_mm2: f64,
    believed: usize,
    settings: Settings,
}

/// Both models of an axis: trained and adapted.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axis {
    sums: LeastSquares<INPUTS>,
    change: [f64; INPUTS],
    /// The last inputs and misses, newest first, for the filter.
    past_inputs: [[f64; INPUTS]; LAGS],
    past_missed_mm: [f64; LAGS],
    residuals: [Residual; 2],
}

impl<const N: usize> Adaptation<N> {
    /// From an identifier that is trained on a machine.
    pub fn new(trained: ServoIdentifier<N>, settings: Settings) -> Self {
        Self {
            now: trained.clone(),
            trained,
            axes: [Axis::new(&settings); N],
            square_mm2: [0.0; 2],
            long_square_mm2: settings.doubt_mm * settings.doubt_mm,
            believed: 0,
            settings,
        }
    }

    /// As it is now.
    #[inline]
    pub fn net(&self) -> &ServoIdentifier<N> {
        &self.now
    }

    /// What it is expected to miss.
    #[inline]
    pub fn residual(&self) -> [Residual; N] {
        core::array::from_fn(|axis| self.axes[axis].residuals[self.believed])
    }

    /// RMS of the innovations lately, mm: how good the predictions are.
    #[inline]
    pub fn innovation_mm(&self) -> f64 {
        libm::sqrt(self.square_mm2[self.believed].max(self.long_square_mm2))
    }

    /// Back to what was trained.
    pub fn reset(&mut self) {
        self.now.clone_from(&self.trained);
        self.axes = [Axis::new(&self.settings); N];
        self.square_mm2 = [0.0; 2];
        self.long_square_mm2 = self.settings.doubt_mm * self.settings.doubt_mm;
        self.believed = 0;
    }

    /// Takes in that these inputs led to this growth of the following error, mm.
    #[inline]
    pub fn learn(&mut self, inputs: &Inputs<N>, grown_mm: [f64; N]) {
        let foreseen_mm = self.trained.predict(inputs);
        let mut missed_mm = [0.0; N];
        for axis in 0..N {
            missed_mm[axis] = grown_mm[axis] - foreseen_mm[axis];
            if !missed_mm[axis].is_finite() {
                return;
            }
        }
        let mut squares = [0.0; 2];
        for axis in 0..N {
            let mean = self.others(axis);
            let innovations_mm = self.axes[axis].learn(&inputs[axis], missed_mm[axis], &mean, &self.settings);
            for model in 0..2 {
                squares[model] += innovations_mm[model] * innovations_mm[model];
            }
        }
        self.judge(squares);
        for axis in 0..N {
            for input in 0..INPUTS {
                let change = if self.believed == 1 { self.axes[axis].change[input] } else { 0.0 };
                self.now.linear[axis][axis][input] = self.trained.linear[axis][axis][input] + change;
            }
        }
    }

    /// What the other axes have changed by: an axis that has not moved yet is taken to differ from the trained as they do.
    /// A little less, so that all of them go back to the trained where nothing moves.
    fn others(&self, axis: usize) -> [f64; INPUTS] {
        let mut sum = [0.0; INPUTS];
        for (other, model) in self.axes.iter().enumerate() {
            for input in 0..INPUTS {
                sum[input] += if other == axis { 0.0 } else { model.change[input] };
            }
        }
        sum.map(|change| change * self.settings.alike / (N.max(2) - 1) as f64)
    }

    fn judge(&mut self, squares: [f64; 2]) {
        for model in 0..2 {
            self.square_mm2[model] += self.settings.judging * (squares[model] - self.square_mm2[model]);
        }
        self.long_square_mm2 += self.settings.caution * (squares[self.believed] - self.long_square_mm2);
        let other = 1 - self.believed;
        if self.square_mm2[other] < CLEARLY_BETTER * self.square_mm2[self.believed] {
            self.believed = other;
        }
    }
}

impl Axis {
    fn new(settings: &Settings) -> Self {
        Self {
            sums: LeastSquares::EMPTY,
            change: [0.0; INPUTS],
            past_inputs: [[0.0; INPUTS]; LAGS],
            past_missed_mm: [0.0; LAGS],
            residuals: [Residual::new(settings.residual); 2],
        }
    }

    /// One more sample; returns the innovations of both models, mm.
    fn learn(&mut self, inputs: &[f64; INPUTS], missed_mm: f64, mean: &[f64; INPUTS], settings: &Settings) -> [f64; 2] {
        let mut explained_mm = 0.0;
        for input in 0..INPUTS {
            explained_mm += self.change[input] * inputs[input];
        }
        let residuals_mm = [missed_mm, missed_mm - explained_mm];
        let innovations_mm = [0, 1].map(|model: usize| residuals_mm[model] - self.residuals[model].expected_mm());
        let filter = *self.residuals[0].coefficients();
        let weight = self.residuals[0].push(residuals_mm[0]);
        self.residuals[1].push(residuals_mm[1]);
        self.fit(inputs, missed_mm, &filter, libm::sqrt(weight), mean, settings);
        innovations_mm
    }

    /// One more sample for the adapted model, filtered.
    fn fit(
        &mut self,
        inputs: &[f64; INPUTS],
        missed_mm: f64,
        filter: &[f64; LAGS],
        root: f64,
        mean: &[f64; INPUTS],
        settings: &Settings,
    ) {
        let mut phi = *inputs;
        let mut y_mm = missed_mm;
        for lag in 0..LAGS {
            y_mm -= filter[lag] * self.past_missed_mm[lag];
            for input in 0..INPUTS {
                phi[input] -= filter[lag] * self.past_inputs[lag][input];
            }
        }
        self.sums.add(settings.forgetting, &phi.map(|x| root * x), root * y_mm);
        let share = settings.noise_mm / settings.spread_mm;
        let change = self.sums.estimate(share * share, mean);
        if change.iter().sum::<f64>().is_finite() {
            self.change = change;
        }
        self.past_inputs.copy_within(0..LAGS - 1, 1);
        self.past_missed_mm.copy_within(0..LAGS - 1, 1);
        (self.past_inputs[0], self.past_missed_mm[0]) = (*inputs, missed_mm);
    }
}
