//! Prediction of the model's errors from its earlier errors: friction of the day, cutting force, a
//! vibration.
//!
//! ```text
//! r(k) = sum_j a_j r(k-1-j) + innovation        j = 0 .. P-1, each axis for itself
//! ```
//!
//! where r(k) is the measured growth of the following error less the predicted. An autoregression
//! of order three predicts a constant and a sine of any frequency without error; more lags average
//! noise out. The coefficients are fitted while cutting, to the last half second, and held to a
//! prior that is exponential smoothing: residuals that are small, or without pattern, are smoothed.
//! An innovation far beyond the usual (friction that turns) counts less, as in Huber (1964).
//!
//! Source: autoregressive disturbance models as in Ljung and Soederstroem (1983), section 3.6.

use feedwright_control::vector::bounded;

use super::least_squares::LeastSquares;

/// P: lags.
const LAGS: usize = 6;
/// Innovations beyond this many times the usual count less.
const USUAL: f64 = 3.0;
/// Part by which the usual size follows each innovation.
const USUAL_GAIN: f64 = 0.02;

/// Settings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ResidualSettings {
    /// Gain of the exponential smoothing that is the prior; 0 (takes in nothing) to 1.
    gain: f64,
    /// Part of the past that still counts one knot later; 0.9 to 1.
    forgetting: f64,
    /// Residuals of this size carry no pattern worth learning, mm.
    noise_mm: f64,
}

impl ResidualSettings {
    /// Values that serve.
    pub(super) const DEFAULT: Self = Self {
        gain: 0.3,
        forgetting: 0.99,
        noise_mm: 2e-5,
    };
}

/// The residuals to come of one axis, as far as the past foretells them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct DisturbanceForecast {
    /// The last residuals, newest first, mm.
    past_mm: [f64; LAGS],
    coefficients: [f64; LAGS],
    /// Largest residual lately, mm: no prediction goes beyond.
    largest_mm: f64,
}

impl DisturbanceForecast {
    #[inline]
    fn expected_mm(&self) -> f64 {
        bounded(
            weighted(&self.coefficients, &self.past_mm),
            -self.largest_mm,
            self.largest_mm,
        )
    }

    /// The next residual, mm; each call goes on by one knot.
    #[inline]
    pub(super) fn next_mm(&mut self) -> f64 {
        let next_mm = self.expected_mm();
        self.shift(next_mm);
        next_mm
    }

    fn shift(&mut self, newest_mm: f64) {
        self.past_mm.copy_within(0..LAGS - 1, 1);
        self.past_mm[0] = newest_mm;
    }
}

/// Residuals of one axis and the model of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Residual {
    forecast: DisturbanceForecast,
    sums: LeastSquares<LAGS>,
    prior: [f64; LAGS],
    usual_mm: f64,
    settings: ResidualSettings,
}

impl Residual {
    /// Nothing missed yet.
    pub(super) fn new(settings: ResidualSettings) -> Self {
        let prior = smoothing(settings.gain);
        Self {
            forecast: DisturbanceForecast {
                past_mm: [0.0; LAGS],
                coefficients: prior,
                largest_mm: 0.0,
            },
            sums: LeastSquares::EMPTY,
            prior,
            usual_mm: 0.0,
            settings,
        }
    }

    /// Returns the expected next residual, mm.
    #[inline]
    pub(super) fn expected_mm(&self) -> f64 {
        self.forecast.expected_mm()
    }

    /// Returns the forecast of the residuals from here on.
    #[inline]
    pub(super) fn forecast(&self) -> DisturbanceForecast {
        self.forecast
    }

    /// Takes in the residual of a knot, mm.
    #[inline]
    pub(super) fn push(&mut self, residual_mm: f64) {
        let ResidualSettings {
            forgetting,
            noise_mm,
            ..
        } = self.settings;
        let past_mm = self.forecast.past_mm;
        let innovation_mm = (residual_mm - self.expected_mm()).abs();
        let limit_mm = USUAL * self.usual_mm + noise_mm;
        let weight = if innovation_mm > limit_mm {
            limit_mm / innovation_mm
        } else {
            1.0
        };
        self.usual_mm += USUAL_GAIN * (innovation_mm.min(limit_mm) - self.usual_mm);
        let surprise_mm = residual_mm - weighted(&self.prior, &past_mm);
        let root = libm::sqrt(weight);
        self.sums
            .add(forgetting, &past_mm.map(|r| root * r), root * surprise_mm);
        let change = self.sums.estimate(
            noise_mm * noise_mm / (1.0 - forgetting).max(1e-6),
            &[0.0; LAGS],
        );
        self.forecast.coefficients = core::array::from_fn(|j| self.prior[j] + change[j]);
        self.forecast.shift(residual_mm);
        self.forecast.largest_mm = (forgetting * self.forecast.largest_mm).max(residual_mm.abs());
    }
}

/// The weights of exponential smoothing over the lags, normalised.
fn smoothing(gain: f64) -> [f64; LAGS] {
    let mut weights = [0.0; LAGS];
    let (mut weight, mut sum) = (1.0, 0.0);
    for w in &mut weights {
        *w = weight;
        sum += weight;
        weight *= 1.0 - gain;
    }
    weights.map(|w| w / sum)
}

#[inline]
fn weighted(coefficients: &[f64; LAGS], past: &[f64; LAGS]) -> f64 {
    let mut sum = 0.0;
    for j in 0..LAGS {
        sum += coefficients[j] * past[j];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Knots of 5 ms.
    fn vibration(k: i32) -> f64 {
        1e-3 * (0.4 + libm::sin(core::f64::consts::TAU * 25.0 * 0.005 * f64::from(k) + 0.3))
    }

    #[test]
    fn a_vibration_about_a_constant_is_foreseen_over_a_whole_horizon() {
        let mut residual = Residual::new(ResidualSettings::DEFAULT);
        for k in 0..400 {
            residual.push(vibration(k));
        }
        let mut forecast = residual.forecast();
        for k in 400..410 {
            let next = forecast.next_mm();
            assert!(
                (next - vibration(k)).abs() < 1e-4,
                "{k}: {next} {}",
                vibration(k)
            );
        }
    }

    #[test]
    fn a_tremble_below_the_noise_is_smoothed() {
        let mut residual = Residual::new(ResidualSettings::DEFAULT);
        for k in 0..1000 {
            residual.push(if k % 2 == 0 { 1e-6 } else { -1e-6 });
        }
        assert!(residual.expected_mm().abs() < 5e-7);
    }

    #[test]
    fn no_prediction_exceeds_what_was_seen() {
        let mut residual = Residual::new(ResidualSettings::DEFAULT);
        for k in 0..60 {
            // A growing residual has an unstable autoregression.
            residual.push(1e-6 * libm::exp(0.2 * f64::from(k)));
        }
        let largest = 1e-6 * libm::exp(0.2 * 59.0);
        let mut forecast = residual.forecast();
        for _ in 0..100 {
            assert!(forecast.next_mm().abs() <= largest * (1.0 + 1e-12));
        }
    }
}
