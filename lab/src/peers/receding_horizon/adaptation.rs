//! Adaptation of the servo identifier while cutting. Each axis has a trained and an adapted model.
//! The one that predicted the last third of a second better over all axes together is used for
//! every axis.
//!
//! ```text
//! trained:  y(k) = r(k)                           y(k) = e(k+1) - e(k) - N(I(k))
//! adapted:  y(k) = delta' phi(k) + r(k)           phi: the inputs of the axis itself,
//!                                                      and the output of its hidden nodes
//! ```
//!
//! Each model has its own [`super::residual`]. [`super::least_squares`] fits delta to y and phi,
//! both filtered by the autoregression of the trained model's residual (generalized least squares).
//! Without the filter, a vibration would pass for a change of the machine. The [`Spread`] of
//! machines of a kind gives the prior of delta. Its mean is the mean delta of the other axes times
//! [`AdaptationSettings::axis_coupling`] and starts at zero. Heavier or weaker machines differ
//! along a few directions only, and a few knots are enough to identify delta along these. Along
//! directions without excitation (on a straight line all inputs stand still) delta returns to zero,
//! the trained model, however long the line is.
//!
//! Source: generalized least squares, Clarke (1967); a prior that is the covariance of a
//! population, Lindley and Smith (1972); switching between models by their recent predictions,
//! Narendra and Balakrishnan (1997).

use feedwright_control::{INPUTS, Inputs, ServoIdentifier, ServoModel, Spread, UNKNOWNS};

use super::least_squares::{LeastSquares, inverse};
use super::residual::{self, DisturbanceForecast, LAGS, Residual};

/// The other model is believed where its mean square innovation is below this part of the present one's: no change of mind
/// over noise.
const CLEARLY_BETTER: f64 = 0.5;

/// Settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AdaptationSettings {
    /// Part of the past that still counts one knot later, for the machine; 0.9 to 1.
    pub forgetting: f64,
    /// Innovations of this size are noise, mm.
    pub noise_mm: f64,
    /// Standard deviation of a machine in any direction, on top of the spread of its kind, mm for
    /// an input of 1.
    pub beyond_mm: f64,
    /// Part by which the mean squares that the models are judged by follow each innovation; 0.001 to 0.1.
    pub variance_gain: f64,
    /// As [`Self::variance_gain`], for how much the predictions are trusted; smaller remembers a surprise for longer.
    pub long_variance_gain: f64,
    /// Part of the square of a surprise that is feared at once; 0 to 1.
    pub peak_gain: f64,
    /// How much an axis that has not moved yet is taken to be like the others; 0 (not at all) to 0.99.
    pub axis_coupling: f64,
    /// Prediction of what the models miss.
    pub residual: residual::ResidualSettings,
}

impl AdaptationSettings {
    /// Values that serve.
    pub const DEFAULT: Self = Self {
        forgetting: 0.998,
        noise_mm: 3e-4,
        beyond_mm: 3e-3,
        variance_gain: 0.01,
        long_variance_gain: 0.002,
        peak_gain: 0.3,
        axis_coupling: 0.9,
        residual: residual::ResidualSettings::DEFAULT,
    };
}

/// The identifier as it is now, and what it follows.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Adaptation<const N: usize, D = ServoIdentifier<N>> {
    trained: D,
    /// Information of the prior of each axis, relative to the information of one sample.
    prior: Spread<N>,
    now: D,
    axes: [AxisAdaptation; N],
    /// Mean squares of the innovations of both models lately, over all axes, mm2.
    square_mm2: [f64; 2],
    /// As these, of the model that was believed, over a longer time.
    long_square_mm2: f64,
    /// Whether the adapted model is believed.
    adapted: bool,
    settings: AdaptationSettings,
}

/// Both models of an axis: trained and adapted.
#[derive(Debug, Clone, Copy, PartialEq)]
struct AxisAdaptation {
    sums: LeastSquares<UNKNOWNS>,
    change: [f64; UNKNOWNS],
    /// The last phi and y, newest first, for the filter.
    past_inputs: [[f64; UNKNOWNS]; LAGS],
    past_missed_mm: [f64; LAGS],
    residuals: [Residual; 2],
}

/// One sample of an axis.
struct AxisSample {
    inputs: [f64; UNKNOWNS],
    missed_mm: f64,
}

impl<const N: usize, D: ServoModel<N>> Adaptation<N, D> {
    /// From an identifier that is trained on a machine, and how others of its kind differ.
    pub(crate) fn new(trained: D, spread: &Spread<N>, settings: AdaptationSettings) -> Self {
        Self::fresh(trained, spread.map(|spread| information(&spread, &settings)), settings)
    }

    fn fresh(trained: D, prior: Spread<N>, settings: AdaptationSettings) -> Self {
        Self {
            now: trained.clone(),
            trained,
            prior,
            axes: [AxisAdaptation::new(&settings); N],
            square_mm2: [0.0; 2],
            long_square_mm2: 0.0,
            adapted: false,
            settings,
        }
    }

    /// As it is now.
    #[inline]
    pub(crate) fn net(&self) -> &D {
        &self.now
    }

    /// What it is expected to miss.
    #[inline]
    pub(crate) fn residual(&self) -> [DisturbanceForecast; N] {
        core::array::from_fn(|axis| self.axes[axis].residuals[self.active()].forecast())
    }

    /// Of the two models, trained and adapted, the one that is believed.
    #[inline]
    fn active(&self) -> usize {
        usize::from(self.adapted)
    }

    /// RMS of the innovations lately, mm: how good the predictions are.
    #[inline]
    pub(crate) fn innovation_mm(&self) -> f64 {
        libm::sqrt(self.square_mm2[self.active()].max(self.long_square_mm2))
    }

    /// Back to what was trained.
    pub(crate) fn reset(&mut self) {
        *self = Self::fresh(self.trained.clone(), self.prior, self.settings);
    }

    /// Takes in that these inputs led to this growth of the following error, mm.
    #[inline]
    pub(crate) fn learn(&mut self, inputs: &Inputs<N>, grown_mm: [f64; N]) {
        let linear_mm = self.trained.predict_linear(inputs);
        let hidden_mm = self.trained.predict_rest(inputs);
        let mut missed_mm = [0.0; N];
        for axis in 0..N {
            missed_mm[axis] = grown_mm[axis] - linear_mm[axis] - hidden_mm[axis];
            if !missed_mm[axis].is_finite() {
                return;
            }
        }
        let mut squares = [0.0; 2];
        for axis in 0..N {
            let mean = self.others(axis);
            let mut sample = AxisSample { inputs: [hidden_mm[axis]; UNKNOWNS], missed_mm: missed_mm[axis] };
            sample.inputs[..INPUTS].copy_from_slice(&inputs[axis]);
            let innovations_mm = self.axes[axis].learn(&sample, &self.prior[axis], &mean, &self.settings);
            for model in 0..2 {
                squares[model] += innovations_mm[model] * innovations_mm[model];
            }
        }
        self.judge(squares);
        self.take_over();
    }

    /// What the other axes have changed by: an axis that has not moved yet is taken to differ from the trained as they do.
    /// A little less, so that all of them go back to the trained where nothing moves.
    fn others(&self, axis: usize) -> [f64; UNKNOWNS] {
        let mut sum = [0.0; UNKNOWNS];
        for (other, model) in self.axes.iter().enumerate() {
            for (sum, change) in sum.iter_mut().zip(model.change) {
                *sum += if other == axis { 0.0 } else { change };
            }
        }
        sum.map(|change| change * self.settings.axis_coupling / (N.max(2) - 1) as f64)
    }

    fn judge(&mut self, squares: [f64; 2]) {
        let AdaptationSettings { variance_gain, long_variance_gain, peak_gain, .. } = self.settings;
        for model in 0..2 {
            self.square_mm2[model] += variance_gain * (squares[model] - self.square_mm2[model]);
        }
        let surprise = squares[self.active()];
        self.long_square_mm2 += long_variance_gain * (surprise - self.long_square_mm2);
        self.long_square_mm2 = self.long_square_mm2.max(peak_gain * surprise);
        let (active_mm2, other_mm2) = (self.square_mm2[self.active()], self.square_mm2[1 - self.active()]);
        if other_mm2 < CLEARLY_BETTER * active_mm2 {
            self.adapted = !self.adapted;
        }
    }

    /// The believed model becomes the present.
    fn take_over(&mut self) {
        for axis in 0..N {
            let change = if self.adapted { self.axes[axis].change } else { [0.0; UNKNOWNS] };
            self.now.change(&self.trained, axis, &change);
        }
    }
}

impl AxisAdaptation {
    fn new(settings: &AdaptationSettings) -> Self {
        Self {
            sums: LeastSquares::EMPTY,
            change: [0.0; UNKNOWNS],
            past_inputs: [[0.0; UNKNOWNS]; LAGS],
            past_missed_mm: [0.0; LAGS],
            residuals: [Residual::new(settings.residual); 2],
        }
    }

    /// One more sample; returns the innovations of both models, mm.
    fn learn(
        &mut self,
        sample: &AxisSample,
        prior: &[[f64; UNKNOWNS]; UNKNOWNS],
        mean: &[f64; UNKNOWNS],
        settings: &AdaptationSettings,
    ) -> [f64; 2] {
        let explained_mm: f64 = self.change.iter().zip(&sample.inputs).map(|(change, input)| change * input).sum();
        let residuals_mm = [sample.missed_mm, sample.missed_mm - explained_mm];
        let innovations_mm = [0, 1].map(|model: usize| residuals_mm[model] - self.residuals[model].expected_mm());
        let filtered = self.filtered(sample);
        let weight = self.residuals[0].push(residuals_mm[0]);
        self.residuals[1].push(residuals_mm[1]);
        let root = libm::sqrt(weight);
        self.sums.add(settings.forgetting, &filtered.inputs.map(|x| root * x), root * filtered.missed_mm);
        let change = self.sums.estimate_held(prior, mean);
        if change.iter().sum::<f64>().is_finite() {
            self.change = change;
        }
        innovations_mm
    }

    /// The sample less what the autoregression of the trained model's residual makes of those before it.
    fn filtered(&mut self, sample: &AxisSample) -> AxisSample {
        let filter = self.residuals[0].coefficients();
        let mut filtered = AxisSample { ..*sample };
        for lag in 0..LAGS {
            filtered.missed_mm -= filter[lag] * self.past_missed_mm[lag];
            for input in 0..UNKNOWNS {
                filtered.inputs[input] -= filter[lag] * self.past_inputs[lag][input];
            }
        }
        self.past_inputs.copy_within(0..LAGS - 1, 1);
        self.past_missed_mm.copy_within(0..LAGS - 1, 1);
        (self.past_inputs[0], self.past_missed_mm[0]) = (sample.inputs, sample.missed_mm);
        filtered
    }
}

/// The information of a prior with this spread, against the noise of a sample: its inverse.
fn information(spread: &[[f64; UNKNOWNS]; UNKNOWNS], settings: &AdaptationSettings) -> [[f64; UNKNOWNS]; UNKNOWNS] {
    let mut covariance = *spread;
    for (r, row) in covariance.iter_mut().enumerate() {
        row[r] += settings.beyond_mm * settings.beyond_mm;
    }
    inverse(&covariance, settings.noise_mm * settings.noise_mm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use feedwright_control::Identifier;

    /// A linear servo of two axes.
    fn servo(gain: f64) -> ServoIdentifier<2> {
        let mut net = ServoIdentifier::NULL;
        for axis in 0..2 {
            net.linear[axis][axis] = [0.1, 0.03, 0.0, -0.12 * gain, 0.02 * gain];
        }
        net
    }

    /// Others differ by the gain, which moves the two inputs of the error together.
    fn spread() -> Spread<2> {
        let mut products = [[0.0; UNKNOWNS]; UNKNOWNS];
        let along = [0.0, 0.0, 0.0, -0.12, 0.02, 0.0];
        for (row, a) in products.iter_mut().zip(along) {
            row.iter_mut().zip(along).for_each(|(product, b)| *product = 0.25 * a * b);
        }
        [products; 2]
    }

    /// Inputs that excite everything in an axis, or stand still.
    fn inputs(k: u32, moving: [bool; 2]) -> Inputs<2> {
        let wave = |i: usize, axis: usize| libm::sin(f64::from(k) * (0.3 + 0.17 * i as f64) + axis as f64);
        core::array::from_fn(|axis| core::array::from_fn(|i| if moving[axis] { wave(i, axis) } else { 0.0 }))
    }

    /// Knots of a machine of this gain.
    fn cut(adaptation: &mut Adaptation<2>, gain: f64, knots: u32, moving: [bool; 2]) {
        let machine = servo(gain);
        for k in 0..knots {
            let inputs = inputs(k, moving);
            adaptation.learn(&inputs, machine.predict(&inputs));
        }
    }

    fn missed_mm(adaptation: &Adaptation<2>, gain: f64) -> f64 {
        let inputs = inputs(1000, [true; 2]);
        let [is, should] = [adaptation.net().predict(&inputs), servo(gain).predict(&inputs)];
        (is[0] - should[0]).abs().max((is[1] - should[1]).abs())
    }

    #[test]
    fn on_the_machine_that_was_trained_nothing_changes() {
        let mut adaptation = Adaptation::new(servo(1.0), &spread(), AdaptationSettings::DEFAULT);
        cut(&mut adaptation, 1.0, 500, [true; 2]);
        assert_eq!(adaptation.net(), &servo(1.0));
        assert_eq!(adaptation.innovation_mm(), 0.0);
    }

    #[test]
    fn another_machine_of_its_kind_is_known_within_a_second_and_forgotten_by_a_reset() {
        let mut adaptation = Adaptation::new(servo(1.0), &spread(), AdaptationSettings::DEFAULT);
        let before_mm = missed_mm(&adaptation, 1.7);
        cut(&mut adaptation, 1.7, 300, [true; 2]);
        assert!(missed_mm(&adaptation, 1.7) < 0.02 * before_mm, "{} {before_mm}", missed_mm(&adaptation, 1.7));
        assert!(adaptation.innovation_mm() < before_mm);
        adaptation.reset();
        assert_eq!(adaptation.net(), &servo(1.0));
    }

    #[test]
    fn an_axis_that_has_not_moved_is_taken_to_differ_as_the_other_does() {
        let mut adaptation = Adaptation::new(servo(1.0), &spread(), AdaptationSettings::DEFAULT);
        cut(&mut adaptation, 1.7, 300, [true, false]);
        let change = |axis: usize| adaptation.net().linear[axis][axis][3] - servo(1.0).linear[axis][axis][3];
        assert!((change(0) + 0.12 * 0.7).abs() < 0.01, "{}", change(0));
        let part = change(1) / change(0);
        assert!((part - AdaptationSettings::DEFAULT.axis_coupling).abs() < 0.05, "{part}");
    }

    #[test]
    fn what_is_no_number_teaches_nothing() {
        let mut adaptation = Adaptation::new(servo(1.0), &spread(), AdaptationSettings::DEFAULT);
        cut(&mut adaptation, 1.7, 300, [true; 2]);
        let before = adaptation.clone();
        for bad in [f64::NAN, f64::INFINITY] {
            adaptation.learn(&inputs(7, [true; 2]), [bad, 0.0]);
        }
        assert_eq!(adaptation, before);
    }
}
