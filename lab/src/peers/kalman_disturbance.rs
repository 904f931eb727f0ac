//! Kalman filter of position, speed and disturbance of each axis: the estimated disturbance is
//! removed from the command behind feedforward of velocity, acceleration and friction.
//!
//! The observer of [`super::disturbance_rejection`] gets the gains that minimize its errors if the
//! disturbance wanders by `q` per servo period, the torque has white noise `t`, both as reference
//! speeds, and the encoder has noise `s`:
//!
//! ```text
//! P = A (P - K P_x) A' + Q     K = P_x' / (P_xx + s^2)     L = A K     Q = t^2 b b' + q^2 d d'
//! A = [ 1 gamma delta;  0 alpha beta;  0 0 1 ]     b = (delta, beta, 0)     d = (0, 0, 1)
//! ```
//!
//! with P the covariance of the prediction and P_x its first row. The gains depend on the ratios of
//! q, t and s alone.
//!
//! Symbols: q, t mm/s; s mm; alpha to delta those of [`SampledAxis`].
//!
//! Source: Erkorkmaz and Altintas (2001), "High speed CNC system design. Part III: high speed
//! tracking and contouring control of feed drives": position, speed and disturbance from a Kalman
//! filter, disturbance cancelled, dynamics of the loop and expected friction compensated ahead.
//!
//! Departures: theirs is the loop, closed over the estimates by pole placement; here the drive has
//! a loop of its own, and takes positions. The dynamics are compensated by `feedforward`, and the
//! friction is smoothed Coulomb friction.

use feedwright_control::Parameter;

use super::zero_phase::SampledAxis;

/// Iterations of the Riccati equation. The error falls by the square of the slowest pole each time:
/// a pole of 1 rad/s, slower than any useful one, has left e^-40 of it after 20 s, at a servo
/// period of 1 ms.
const ITERATIONS: u32 = 20_000;

/// Assumed unknowns of an axis, as standard deviations for each servo period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct AxisNoise {
    /// Change of the disturbance, as reference speed, mm/s; above 0.
    pub drift_mm_s: f64,
    /// White part of the torque, mm/s of reference speed.
    pub torque_mm_s: f64,
    /// Noise of the measured position, mm; above 0.
    pub encoder_mm: f64,
}

impl AxisNoise {
    /// An encoder of 1 um, whose error is spread evenly over its step, a drift with which a
    /// reversal is found in a few servo periods, and next to no white torque: circle of 10 mm at 50
    /// mm/s, um RMS by the drift, on tnv40 0.05 0.35, 0.2 0.24, 1 0.17, 5 0.12, with encoder steps
    /// and a late drive (`coarse`) 0.2 0.33, 1 0.28.
    pub(super) const DEFAULT: Self = Self {
        drift_mm_s: 1.0,
        torque_mm_s: 0.01,
        encoder_mm: 0.29e-3,
    };
}

// Only the ratios of the three noises count: in servo periods and against an encoder of 1 um.
pub(super) const DRIFT: Parameter = Parameter::number(
    "drift_mm_s",
    AxisNoise::DEFAULT.drift_mm_s,
    [1e-6, 1e4],
    Some([1e-3, 1e4]),
    "change of the disturbance: a small one is late at every reversal, a large one hands on the noise of the encoder; from 100 on \
     the filter follows what it measures, and hardly changes",
);
pub(super) const TORQUE_NOISE: Parameter = Parameter::number(
    "torque_noise_mm_s",
    AxisNoise::DEFAULT.torque_mm_s,
    [0.0, 100.0],
    Some([1e-4, 10.0]),
    "white part of the torque: what is put down to it is no disturbance",
);

/// Gains of the filter in its steady state.
pub(super) fn gains(axis: &SampledAxis, noise: &AxisNoise) -> [f64; 3] {
    let encoder = noise.encoder_mm * noise.encoder_mm;
    let drift = noise.drift_mm_s * noise.drift_mm_s;
    // From any positive covariance the same is reached.
    let mut covariance = [[encoder, 0.0, 0.0], [0.0, drift, 0.0], [0.0, 0.0, drift]];
    let mut gains = [0.0; 3];
    for _ in 0..ITERATIONS {
        let [of_position, ..] = covariance;
        let filtered = of_position.map(|p| p / (of_position[0] + encoder));
        (gains, covariance) = predicted(
            axis,
            noise,
            filtered,
            minus_product(covariance, filtered, of_position),
        );
    }
    gains
}

/// A correction and a covariance after one more servo period: `A k` and `A P A' + Q`.
pub(super) fn predicted(
    axis: &SampledAxis,
    noise: &AxisNoise,
    correction: [f64; 3],
    covariance: [[f64; 3]; 3],
) -> ([f64; 3], [[f64; 3]; 3]) {
    let SampledAxis {
        alpha,
        beta,
        gamma_s,
        delta_s,
        ..
    } = *axis;
    let through = |[x, w, d]: [f64; 3]| [x + gamma_s * w + delta_s * d, alpha * w + beta * d, d];
    let [drift, torque] = [noise.drift_mm_s, noise.torque_mm_s].map(|sigma| sigma * sigma);
    let added = [
        [torque * delta_s * delta_s, torque * delta_s * beta, 0.0],
        [torque * delta_s * beta, torque * beta * beta, 0.0],
        [0.0, 0.0, drift],
    ];
    (
        through(correction),
        plus(
            transposed(transposed(covariance.map(through)).map(through)),
            added,
        ),
    )
}

/// `m - a b'`.
pub(super) fn minus_product(m: [[f64; 3]; 3], a: [f64; 3], b: [f64; 3]) -> [[f64; 3]; 3] {
    core::array::from_fn(|i| core::array::from_fn(|j| m[i][j] - a[i] * b[j]))
}

fn plus(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] + b[i][j]))
}

fn transposed(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    core::array::from_fn(|i| core::array::from_fn(|j| m[j][i]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::disturbance_rejection::tests as rejection;

    const SERVO_S: f64 = 0.001;

    #[test]
    fn a_constant_disturbance_is_found_and_taken_out() {
        rejection::a_constant_disturbance_is_found_and_taken_out(|axis| {
            gains(axis, &AxisNoise::DEFAULT)
        });
    }

    #[test]
    fn of_a_mass_the_poles_lie_as_those_of_butterworth() {
        // Three integrators from the drift to the position, sampled fast: s^3 + 2 w s^2 + 2 w^2 s +
        // w^3, w^3 = b q / (s Ts^2).
        let b = 0.2;
        let axis = SampledAxis {
            alpha: 1.0,
            beta: b,
            gamma_s: SERVO_S,
            delta_s: 0.5 * b * SERVO_S,
            kp_1_s: 50.0,
            kd: 0.0,
        };
        let rad_s: f64 = 2.0;
        let encoder_mm = 1e-3;
        let drift_mm_s = rad_s.powi(3) * encoder_mm * SERVO_S * SERVO_S / b;
        let noise = AxisNoise {
            drift_mm_s,
            torque_mm_s: 0.0,
            encoder_mm,
        };
        let [l1, l2, l3] = gains(&axis, &noise);
        let found = [l1 / SERVO_S, l2 / SERVO_S, l3 * b / (SERVO_S * SERVO_S)];
        let expected = [2.0 * rad_s, 2.0 * rad_s * rad_s, rad_s.powi(3)];
        for (found, expected) in found.iter().zip(expected) {
            // Sampling is off by w Ts, 0.2 %, in each.
            assert!(
                (found / expected - 1.0).abs() < 0.01,
                "{found}, not {expected}"
            );
        }
    }

    /// Variances of the errors of position, speed and disturbance under any gains: P = (A - L C) P
    /// (A - L C)' + Q + L s^2 L'.
    fn variances(axis: &SampledAxis, noise: &AxisNoise, gains: [f64; 3]) -> [f64; 3] {
        let [alpha, beta, gamma_s, delta_s] = axis.coefficients();
        let [l1, l2, l3] = gains;
        let position = [1.0 - l1, gamma_s, delta_s];
        let step = [position, [-l2, alpha, beta], [-l3, 0.0, 1.0]];
        let sources = [
            [noise.torque_mm_s * delta_s, noise.torque_mm_s * beta, 0.0],
            [0.0, 0.0, noise.drift_mm_s],
            gains.map(|gain| gain * noise.encoder_mm),
        ];
        // The errors that each source makes, summed over all that comes after it.
        let mut sum = [0.0; 3];
        for source in sources {
            let mut error = source;
            for _ in 0..4000 {
                sum = core::array::from_fn(|i| sum[i] + error[i] * error[i]);
                error = step.map(|row| row[0] * error[0] + row[1] * error[1] + row[2] * error[2]);
            }
        }
        sum
    }

    #[test]
    fn no_other_gains_make_the_errors_smaller() {
        let (axis, noise) = (rejection::axis(0.0), AxisNoise::DEFAULT);
        let best = gains(&axis, &noise);
        let least = variances(&axis, &noise, best);
        for changed in 0..3 {
            for factor in [0.9, 0.99, 1.01, 1.1] {
                let mut other = best;
                other[changed] *= factor;
                let variances = variances(&axis, &noise, other);
                let is_larger = (0..3).all(|i| variances[i] > least[i] * (1.0 + 1e-9));
                assert!(is_larger, "{changed} {factor}: {variances:?} {least:?}");
            }
        }
    }
}
