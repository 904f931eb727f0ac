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
        residual: residual::Settings::DEFAULT,
    };
}

/// The identifier as it is now, and what it follows.
#[derive(Debug, Clone, PartialEq)]
pub struct Adaptation<const N: usize> {
    trained: ServoIdentifier<N>,
    now: ServoIdentifier<N>,
    axes: [Axis; N],
    settings: Settings,
}

/// Both models of an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Axis {
    sums: LeastSquares<INPUTS>,
    change: [f64; INPUTS],
    /// The last inputs and misses, newest first, for the filter.
    past_inputs: [[f64; INPUTS]; LAGS],
    past_missed_mm: [f64; LAGS],
    models: [Model; 2],
    believed: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Model {
    residual: Residual,
    /// Mean square of its innovations lately, mm2.
    square_mm2: f64,
}

impl<const N: usize> Adaptation<N> {
    /// From an identifier that is trained on a machine.
    pub fn new(trained: ServoIdentifier<N>, settings: Settings) -> Self {
        Self { now: trained.clone(), trained, axes: [Axis::new(&settings); N], settings }
    }

    /// As it is now.
    #[inline]
    pub fn net(&self) -> &ServoIdentifier<N> {
        &self.now
    }

    /// What it is expected to miss.
    #[inline]
    pub fn residual(&self) -> [Residual; N] {
        core::array::from_fn(|axis| self.axes[axis].believed().residual)
    }

    /// RMS of the innovations lately, mm: how good the predictions are.
    #[inline]
    pub fn innovation_mm(&self) -> f64 {
        let mut sum = 0.0;
        for axis in &self.axes {
            sum += axis.believed().square_mm2;
        }
        libm::sqrt(sum)
    }

    /// Back to what was trained.
    pub fn reset(&mut self) {
        self.now.clone_from(&self.trained);
        self.axes = [Axis::new(&self.settings); N];
    }

    /// Takes in that these inputs led to this growth of the following error, mm.
    #[inline]
    pub fn learn(&mut self, inputs: &Inputs<N>, grown_mm: [f64; N]) {
        let foreseen_mm = self.trained.predict(inputs);
        for axis in 0..N {
            let missed_mm = grown_mm[axis] - foreseen_mm[axis];
            if !missed_mm.is_finite() {
                continue;
            }
            let change = self.axes[axis].learn(&inputs[axis], missed_mm, &self.settings);
            for input in 0..INPUTS {
                self.now.linear[axis][axis][input] = self.trained.linear[axis][axis][input] + change[input];
            }
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
            models: [Model { residual: Residual::new(settings.residual), square_mm2: 0.0 }; 2],
            believed: 0,
        }
    }

    fn believed(&self) -> &Model {
        &self.models[self.believed]
    }

    /// The change of the linear connection that is believed.
    fn learn(&mut self, inputs: &[f64; INPUTS], missed_mm: f64, settings: &Settings) -> [f64; INPUTS] {
        let mut explained_mm = 0.0;
        for input in 0..INPUTS {
            explained_mm += self.change[input] * inputs[input];
        }
        for (model, residual_mm) in self.models.iter_mut().zip([missed_mm, missed_mm - explained_mm]) {
            let innovation_mm = residual_mm - model.residual.expected_mm();
            model.square_mm2 += settings.judging * (innovation_mm * innovation_mm - model.square_mm2);
        }
        let coefficients = *self.models[0].residual.coefficients();
        let weight = self.models[0].residual.push(missed_mm);
        self.models[1].residual.push(missed_mm - explained_mm);
        self.fit(inputs, missed_mm, &coefficients, libm::sqrt(weight), settings);
        let other = 1 - self.believed;
        if self.models[other].square_mm2 < CLEARLY_BETTER * self.models[self.believed].square_mm2 {
            self.believed = other;
        }
        if self.believed == 1 { self.change } else { [0.0; INPUTS] }
    }

    /// One more sample for the adapted model, filtered.
    fn fit(&mut self, inputs: &[f64; INPUTS], missed_mm: f64, filter: &[f64; LAGS], root: f64, settings: &Settings) {
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
        let change = self.sums.estimate(&[share * share; INPUTS]);
        if change.iter().sum::<f64>().is_finite() {
            self.change = change;
        }
        self.past_inputs.copy_within(0..LAGS - 1, 1);
        self.past_missed_mm.copy_within(0..LAGS - 1, 1);
        (self.past_inputs[0], self.past_missed_mm[0]) = (*inputs, missed_mm);
    }
}
