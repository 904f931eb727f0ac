//! The H-infinity filter of position, speed and disturbance of each axis, and with it the axis
//! controller of Tsai and others.
//!
//! The observer of [`super::disturbance_rejection`] gets the gains that bound the error of the
//! disturbance in the worst case: over all drifts, torques and encoder errors, its energy is at
//! most gamma^2 times theirs, each divided by its size in [`AxisNoise`].
//!
//! ```text
//! P(k+1) = A M A' + Q     M = (P^-1 + c c' / s^2 - d d' / (gamma q)^2)^-1     L = A M c / s^2
//! ```
//!
//! with A, Q, q and s of [`super::kalman_disturbance`], c = (1, 0, 0) and d = (0, 0, 1). The least
//! gamma for which M stays positive is found by bisection; the filter runs at a multiple of it.
//! Without bound on gamma it is the Kalman filter.
//!
//! Source: Shaked and Theodor (1992), "H-infinity optimal estimation: a tutorial"; Simon (2006),
//! "Optimal state estimation", for the filter. Tsai and others (1995), "DSP-based motion control by
//! H-infinity axis-controller and fuzzy adaptive feedrate", for the controller.
//!
//! The paper of 1995 was not available. Known of it: an H-infinity controller of each axis and a
//! fuzzy adaptive feedrate work together. Reconstructed here: the axis controller. The drive keeps
//! its loops and takes positions, so the H-infinity part is the worst-case estimate of friction and
//! load, which is removed from the command behind feedforward of velocity and acceleration.
use feedwright_control::{Command, Controller, Measured, Parameter, Schedule, Window};

use super::disturbance_rejection::DisturbanceRejection;
use super::fuzzy_feedrate::FuzzyFeedrate;
use super::kalman_disturbance::{AxisNoise, minus_product, predicted};
use super::zero_phase::SampledAxis;

/// Iterations of the Riccati equation: a pole of 10 rad/s has after 4 s, at a servo period of 1 ms,
/// left e^-80 of its error.
const ITERATIONS: u32 = 4_000;
/// Halvings of the interval of `ln gamma`, from no bound that matters to none that holds.
const HALVINGS: u32 = 30;
const GAMMAS: [f64; 2] = [1e-3, 1e6];

/// Gamma as a multiple of the least.
pub(super) const GAMMA_RATIO: Parameter = Parameter::number(
    "gamma_ratio",
    1.5,
    [1.01, 100.0],
    Some([1.01, 20.0]),
    "worst case that is allowed, as a multiple of the least possible: near 1 the observer is fast and noisy, a large one is Kalman's",
);

/// Gains of the filter in its steady state, at a multiple of the least gamma; above 1.
pub(super) fn gains(axis: &SampledAxis, noise: &AxisNoise, gamma_ratio: f64) -> [f64; 3] {
    let [mut low, mut high] = GAMMAS.map(libm::log);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        let holds = gains_at(axis, noise, libm::exp(middle)).is_some();
        *(if holds { &mut high } else { &mut low }) = middle;
    }
    gains_at(axis, noise, gamma_ratio * libm::exp(high)).unwrap_or_default()
}

/// Gains at a gamma; none where the worst case has no bound.
fn gains_at(axis: &SampledAxis, noise: &AxisNoise, gamma: f64) -> Option<[f64; 3]> {
    let variance = noise.encoder_mm * noise.encoder_mm;
    let of_disturbance = gamma * gamma * noise.drift_mm_s * noise.drift_mm_s;
    let mut covariance = [[variance, 0.0, 0.0], [0.0; 3], [0.0; 3]];
    let mut gains = [0.0; 3];
    for _ in 0..ITERATIONS {
        let [of_position, ..] = covariance;
        let filtered = of_position.map(|p| p / (of_position[0] + variance));
        let measured = minus_product(covariance, filtered, of_position);
        let [.., of_d] = measured;
        let left = of_disturbance - of_d[2];
        if left <= 0.0 {
            return None;
        }
        let worst = minus_product(measured, of_d.map(|p| -p / left), of_d);
        let [of_position, ..] = worst;
        let next;
        (gains, next) = predicted(axis, noise, of_position.map(|p| p / variance), worst);
        covariance = next;
    }
    Some(gains)
}

/// H-infinity axis control with a fuzzy adaptive feedrate.
#[derive(Debug, Clone)]
pub(super) struct FuzzyHInfinity<const N: usize> {
    axes: DisturbanceRejection<N>,
    fuzzy: FuzzyFeedrate,
    /// Servo periods until the rules are asked again, and what they said last.
    wait: u32,
    rate: f64,
}

impl<const N: usize> FuzzyHInfinity<N> {
    /// Combines the two parts.
    pub(super) fn new(axes: DisturbanceRejection<N>, fuzzy: FuzzyFeedrate) -> Self {
        Self {
            axes,
            fuzzy,
            wait: 0,
            rate: 1.0,
        }
    }
}

impl<const N: usize> Controller<N> for FuzzyHInfinity<N> {
    fn schedule(&self) -> Schedule {
        self.axes.schedule()
    }

    fn reset(&mut self) {
        self.axes.reset();
        Controller::<N>::reset(&mut self.fuzzy);
        (self.wait, self.rate) = (0, 1.0);
    }

    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        self.axes.observe(window, measured);
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let periods = Controller::<N>::schedule(&self.fuzzy).servo_periods.max(1);
        if self.wait == 0 {
            let rules = Window {
                feed_period_s: f64::from(periods) * window.feed_period_s,
                ..*window
            };
            (self.wait, self.rate) = (periods, self.fuzzy.command(&rules, measured).rate);
        }
        self.wait -= 1;
        self.axes.command_at(window, self.rate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::disturbance_rejection::tests as rejection;
    use crate::peers::kalman_disturbance;

    #[test]
    fn a_constant_disturbance_is_found_and_taken_out() {
        rejection::a_constant_disturbance_is_found_and_taken_out(|axis| {
            gains(axis, &AxisNoise::DEFAULT, GAMMA_RATIO.default)
        });
    }

    #[test]
    fn without_a_bound_on_the_worst_case_it_is_the_kalman_filter() {
        let (axis, noise) = (rejection::axis(0.0), AxisNoise::DEFAULT);
        let found = gains_at(&axis, &noise, 1e6).unwrap();
        let expected = kalman_disturbance::gains(&axis, &noise);
        for (found, expected) in found.iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-6, "{found} {expected}");
        }
    }

    /// Largest gain from a source to the error of the disturbance, each over its size, at any
    /// frequency.
    fn worst_gain(axis: &SampledAxis, noise: &AxisNoise, gains: [f64; 3]) -> f64 {
        let [alpha, beta, gamma_s, delta_s] = axis.coefficients();
        let [l1, l2, l3] = gains;
        let sources = [
            [0.0, 0.0, noise.drift_mm_s],
            [noise.torque_mm_s * delta_s, noise.torque_mm_s * beta, 0.0],
            gains.map(|gain| -gain * noise.encoder_mm),
        ];
        let system = |z: nalgebra::Complex<f64>| {
            let real = nalgebra::Complex::from;
            nalgebra::Matrix3::from_row_slice(
                &[
                    [z - (1.0 - l1), real(-gamma_s), real(-delta_s)],
                    [real(l2), z - alpha, real(-beta)],
                    [real(l3), real(0.0), z - 1.0],
                ]
                .concat(),
            )
        };
        let at = |angle: f64| {
            let z = nalgebra::Complex::new(libm::cos(angle), libm::sin(angle));
            let inverse = system(z).try_inverse().unwrap();
            let squares = sources.iter().map(|source| {
                let source = nalgebra::Vector3::from(source.map(nalgebra::Complex::from));
                (inverse * source)[2].norm_sqr()
            });
            libm::sqrt(squares.sum())
        };
        let gain = |n: u32| at(libm::pow(10.0, -4.0 + 4.497 * f64::from(n) / 3000.0));
        (1..3000).map(gain).fold(0.0, f64::max) / noise.drift_mm_s
    }

    #[test]
    fn the_worst_case_is_within_its_bound_and_below_the_kalman_filter() {
        let (axis, noise) = (rejection::axis(0.0), AxisNoise::DEFAULT);
        let kalman = worst_gain(&axis, &noise, kalman_disturbance::gains(&axis, &noise));
        let worst = worst_gain(&axis, &noise, gains(&axis, &noise, 1.05));
        println!("worst gain {worst}, of the Kalman filter {kalman}");
        assert!(worst < kalman, "{worst} {kalman}");
        for gamma in [2.0 * worst, 4.0 * worst] {
            let gains = gains_at(&axis, &noise, gamma).unwrap();
            let worst = worst_gain(&axis, &noise, gains);
            assert!(worst <= gamma, "{worst} {gamma}");
        }
    }
}
