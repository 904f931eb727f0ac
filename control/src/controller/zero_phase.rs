//! Zero phase error tracking control: the closed position loop of each axis, inverted as far as it can be, in each servo
//! period.
//!
//! With the reference speed held for a servo period, an axis is `w(k+1) = alpha w + beta w_ref`,
//! `x(k+1) = x + gamma w + delta w_ref`, and the closed loop from command c to position x
//!
//! ```text
//! x / c = z^-1 B+ B- / A       B- = delta + epsilon z^-1,  epsilon = gamma beta - alpha delta
//! B+ = Kc (1 - q z^-1)         Kc = kp + kd / Ts,  q = kd / (Ts Kc)
//! A  = (1 - z^-1)(1 - alpha z^-1) + z^-1 B+ B-
//! ```
//!
//! The zero -epsilon / delta of a sampled mass lies near -1: its inverse rings at half the sampling frequency. A and B+
//! are cancelled; of B- only the phase is, by its mirror image B-(z), which looks one period ahead:
//!
//! ```text
//! c(k) = A(z^-1) B-(z) / (B+(z^-1) B-(1)^2)  r(k+1)
//! ```
//!
//! so that x / r = |B-|^2 / B-(1)^2 is real at every frequency and 1 at standstill.
//!
//! Source: Tomizuka (1987), "Zero phase error tracking algorithm for digital control".
//!
//! Departures: none in the filter. The Coulomb friction is not linear, and the model leaves it out. So it does what a drive has beside
//! a P speed loop: integral, feedforward of its own, delays and torque filter; on a machine with these it inverts another loop.

use super::feedforward::preview;
use super::{Command, Controller, Measured, Schedule};
use crate::window::Window;

/// One axis between two servo periods: the effect of its speed and of the reference speed that is held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampledAxis {
    /// Speed left of a unit of speed.
    pub alpha: f64,
    /// Speed taken up from a unit of reference speed.
    pub beta: f64,
    /// Travel from a unit of speed, s.
    pub gamma_s: f64,
    /// Travel from a unit of reference speed, s.
    pub delta_s: f64,
    /// Proportional gain of the position loop, 1/s.
    pub kp_1_s: f64,
    /// Its derivative gain, dimensionless.
    pub kd: f64,
}

/// The filter of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filter {
    /// Weights of the reference at k+2, k+1, k, k-1 and k-2; their sum is 1.
    weights: [f64; 5],
    /// q: the zero of the position loop, cancelled.
    pole: f64,
}

impl Filter {
    /// For an axis with a servo period of `servo_s`.
    pub fn new(axis: &SampledAxis, servo_s: f64) -> Self {
        let SampledAxis { alpha, beta, gamma_s, delta_s: d, kp_1_s, kd } = *axis;
        let e = gamma_s * beta - alpha * d;
        let gain = kp_1_s + kd / servo_s;
        let pole = kd / (servo_s * gain);
        let a = [1.0, gain * d - 1.0 - alpha, alpha + gain * (e - pole * d), -gain * pole * e];
        let sum = (d + e) * (a[0] + a[1] + a[2] + a[3]);
        let weights = [e * a[0], d * a[0] + e * a[1], d * a[1] + e * a[2], d * a[2] + e * a[3], d * a[3]];
        Self { weights: weights.map(|weight| weight / sum), pole }
    }
}

/// Zero phase error tracking control; keeps nothing between ticks.
#[derive(Debug, Clone)]
pub struct ZeroPhase<const N: usize> {
    filters: [Filter; N],
    preview: u32,
}

impl<const N: usize> ZeroPhase<N> {
    /// For these axes and a servo period of `servo_s`.
    pub fn new(axes: &[SampledAxis; N], servo_s: f64) -> Self {
        // The lags of the position loop and of the speed loop; the second is J / (kv + B).
        let lag_s = axes.iter().map(|axis| 1.0 / axis.kp_1_s + axis.gamma_s / (1.0 - axis.alpha));
        Self {
            preview: preview(lag_s.fold(0.0, f64::max), servo_s),
            filters: core::array::from_fn(|i| Filter::new(&axes[i], servo_s)),
        }
    }
}

impl<const N: usize> Controller<N> for ZeroPhase<N> {
    fn schedule(&self) -> Schedule {
        Schedule { servo_periods: 1, preview: self.preview }
    }

    fn reset(&mut self) {}

    /// The command of the next servo period, k; offsets from its reference keep rest at rest to the bit.
    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let next_s = window.tau_s + window.feed_period_s;
        let reference = [2.0, 1.0, 0.0, -1.0, -2.0]
            .map(|ahead: f64| window.preview.at(next_s + ahead * window.servo_s()).position_mm);
        let now_mm = window.now().position_mm;
        let offset_mm = core::array::from_fn(|i| {
            let Filter { weights, pole } = &self.filters[i];
            let here_mm = reference[2][i];
            let filtered: f64 = weights.iter().zip(&reference).map(|(weight, r)| weight * (r[i] - here_mm)).sum();
            pole * (window.offset_mm[i] + now_mm[i] - here_mm) + (1.0 - pole) * filtered
        });
        Command::straight(1.0, offset_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::controller::feedforward::tests::commands;
    use crate::window::{Knot, KnotSource};

    const SERVO_S: f64 = 0.001;
    const AMPLITUDE_MM: f64 = 0.1;

    /// A first-order speed loop of 200 rad/s, held exactly.
    fn axis(kd: f64) -> SampledAxis {
        let alpha = libm::exp(-200.0 * SERVO_S);
        let gamma_s = (1.0 - alpha) / 200.0;
        SampledAxis { alpha, beta: 1.0 - alpha, gamma_s, delta_s: SERVO_S - gamma_s, kp_1_s: 50.0, kd }
    }

    /// 20 mm/s and a tenth of a millimetre at `rad_s` across it.
    struct Wave {
        rad_s: f64,
    }

    impl KnotSource<2> for Wave {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            let t_s = tau_s.max(0.0);
            let y = AMPLITUDE_MM * libm::sin(self.rad_s * t_s);
            Knot { position_mm: [20.0 * t_s, y], tangent: [1.0, 0.0], feed_mm_s: 20.0, cutting: true }
        }
    }

    /// Drives two linear axes for a second; calls `each` with the time and the tool at the end of each servo period.
    fn drive(kd: f64, rad_s: f64, mut each: impl FnMut(f64, [f64; 2])) {
        let model = axis(kd);
        let mut controller = ZeroPhase::new(&[model; 2], SERVO_S);
        let (mut tool_mm, mut speed, mut last_mm) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        commands(&mut Wave { rad_s }, &mut controller, SERVO_S, |n, command_mm| {
            for i in 0..2 {
                let error_mm = command_mm[i] - tool_mm[i];
                let reference = model.kp_1_s * error_mm + model.kd * (error_mm - last_mm[i]) / SERVO_S;
                last_mm[i] = error_mm;
                tool_mm[i] += model.gamma_s * speed[i] + model.delta_s * reference;
                speed[i] = model.alpha * speed[i] + model.beta * reference;
            }
            each((n + 1) as f64 * SERVO_S, tool_mm);
        });
    }

    #[test]
    fn the_loop_has_no_phase_and_the_gain_of_the_zero() {
        for kd in [0.0, 0.05] {
            for rad_s in [10.0, 60.0, 300.0] {
                // A sine and a cosine, fitted to the last half second by least squares: it need not hold whole periods.
                let (mut ss, mut sc, mut cc, mut ys, mut yc) = (0.0, 0.0, 0.0, 0.0, 0.0);
                drive(kd, rad_s, |t_s, tool_mm| {
                    if t_s > 0.5 {
                        let (s, c) = (libm::sin(rad_s * t_s), libm::cos(rad_s * t_s));
                        ss += s * s;
                        sc += s * c;
                        cc += c * c;
                        ys += tool_mm[1] * s;
                        yc += tool_mm[1] * c;
                    }
                });
                let det = ss * cc - sc * sc;
                let (in_phase, quadrature) = ((ys * cc - yc * sc) / det, (yc * ss - ys * sc) / det);
                let SampledAxis { alpha, beta, gamma_s, delta_s, .. } = axis(kd);
                let epsilon = gamma_s * beta - alpha * delta_s;
                let zero = delta_s * delta_s + epsilon * epsilon + 2.0 * delta_s * epsilon * libm::cos(rad_s * SERVO_S);
                let gain = zero / ((delta_s + epsilon) * (delta_s + epsilon));
                assert!((in_phase / AMPLITUDE_MM - gain).abs() < 1e-6, "{rad_s} rad/s, kd {kd}: {in_phase}");
                assert!((quadrature / AMPLITUDE_MM).abs() < 1e-6, "{rad_s} rad/s, kd {kd}: {quadrature}");
            }
        }
    }

    #[test]
    fn a_ramp_is_followed_exactly() {
        drive(0.0, 0.0, |t_s, tool_mm| {
            if t_s > 0.9 {
                assert!((tool_mm[0] - 20.0 * t_s).abs() < 1e-9, "{t_s} s: {} mm", tool_mm[0]);
            }
        });
    }
}
