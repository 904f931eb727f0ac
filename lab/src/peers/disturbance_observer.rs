//! The disturbance observer: friction and cutting force are estimated from what the nominal servo
//! does not explain, by an observer whose poles are placed, and taken out of the command behind
//! velocity and acceleration feedforward.
//!
//! The observer of [`super::disturbance_rejection`] gets the characteristic polynomial `(z - p)^3`,
//! `p = exp(-2 pi f Ts)`, by the gains, with `r = 1 - p`, `a = 1 - alpha`:
//!
//! ```text
//! l1 = 3 r - a     l3 = r^3 / (gamma beta + delta a)     l2 = (3 r^2 - a l1 - delta l3) / gamma
//! ```
//!
//! Symbols: f bandwidth of the observer, Hz; Ts servo period, s; alpha to delta those of
//! [`SampledAxis`].
//!
//! Source: Ohnishi (1987), "A new servo method in mechatronics".

use feedwright_control::Parameter;

use super::zero_phase::SampledAxis;

/// Bandwidth, Hz: above, encoder noise gets into the command, and the delay of a servo period makes
/// the loop swing; below, friction lasts longer at every reversal (circle of 10 mm at 50 mm/s on
/// tnv40, um RMS: 10 Hz 1.8, 25 Hz 1.1, 40 Hz 0.8).
pub(super) const BANDWIDTH: Parameter = Parameter::number(
    "bandwidth_hz",
    40.0,
    [0.0, 1000.0],
    Some([1.0, 1000.0]),
    "of the observer: low is late at every reversal, high hands on the noise of the encoder; from 500 on the observer \
     follows what it measures, and hardly changes",
);

/// Gains of the observer of an axis, for a bandwidth and a servo period of `servo_s`.
pub(super) fn gains(axis: &SampledAxis, bandwidth_hz: f64, servo_s: f64) -> [f64; 3] {
    let [alpha, beta, gamma_s, delta_s] = axis.coefficients();
    let r = 1.0 - libm::exp(-core::f64::consts::TAU * bandwidth_hz * servo_s);
    let a = 1.0 - alpha;
    let l1 = 3.0 * r - a;
    let l3 = r * r * r / (gamma_s * beta + delta_s * a);
    let l2 = (3.0 * r * r - a * l1 - delta_s * l3) / gamma_s;
    [l1, l2, l3]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::disturbance_rejection::tests as rejection;

    const SERVO_S: f64 = 0.001;

    #[test]
    fn a_constant_disturbance_is_found_and_taken_out() {
        rejection::a_constant_disturbance_is_found_and_taken_out(|axis| {
            gains(axis, BANDWIDTH.default, SERVO_S)
        });
    }

    #[test]
    fn the_errors_of_the_observer_decay_with_its_poles() {
        // (z - p)^3 in s = z - 1, from the matrix A - L C.
        let model = rejection::axis(0.0);
        let [l1, l2, l3] = gains(&model, 30.0, SERVO_S);
        let p = libm::exp(-core::f64::consts::TAU * 30.0 * SERVO_S);
        for z in [p, 0.0, 1.0, 1.7] {
            let [alpha, beta, gamma_s, delta_s] = model.coefficients();
            let m0 = [z - 1.0 + l1, -gamma_s, -delta_s];
            let [m1, m2] = [[l2, z - alpha, -beta], [l3, 0.0, z - 1.0]];
            let minor = |i: usize, j: usize| m1[i] * m2[j] - m1[j] * m2[i];
            let determinant = m0[0] * minor(1, 2) - m0[1] * minor(0, 2) + m0[2] * minor(0, 1);
            let expected = (z - p) * (z - p) * (z - p);
            assert!((determinant - expected).abs() < 1e-12, "{z}: {determinant}");
        }
    }
}
