//! Zero phase error tracking control: the closed position loop of each axis, inverted as far as it
//! can be, in each servo period.
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
//! The zero -epsilon / delta of a sampled mass lies near -1: its inverse rings at half the sampling
//! frequency. A and B+ are cancelled; of B- only the phase is, by its mirror image B-(z), which
//! looks one period ahead:
//!
//! ```text
//! c(k) = A(z^-1) B-(z) / (B+(z^-1) B-(1)^2)  r(k+1)
//! ```
//!
//! so that x / r = |B-|^2 / B-(1)^2 is real at every frequency and 1 at standstill.
//!
//! A drive that has more than a P speed loop (integral, feedforward of its own, delays, torque
//! filter) has a loop of higher order, with several zeros and a delay of d periods: whoever makes
//! the filter of it gives A B-, with the zeros of B- mirrored, and B+ ([`Filter::of_loop`]).
//!
//! ```text
//! x / c = z^-d B+ B- / A          c(k) = A(z^-1) B-(z) / (B+(z^-1) B-(1)^2)  r(k+d)
//! ```
//!
//! Source: Tomizuka (1987), "Zero phase error tracking algorithm for digital control".
//!
//! Departures: none in the filter. The Coulomb friction is not linear, and the model leaves it out.

use feedwright_control::Window;
use feedwright_control::vector::add_scaled;

use feedwright_control::{
    Command, Controller, MAX_PREVIEW, Measured, Parameter, Schedule, preview,
};

use super::deciding;

/// One axis between two servo periods: the effect of its speed and of the reference speed that is
/// held.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SampledAxis {
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

/// Most weights of the reference: 40 periods of delay, and the order of a loop and of its mirrored
/// zeros.
pub(super) const MAX_WEIGHTS: usize = 64;
/// Most zeros that are cancelled: three of a sampled drive with integral and filter, one of a part
/// of a period of delay, two of feedforward.
pub(super) const MAX_CANCELLED: usize = 6;

pub(super) const LAG_SCALE: Parameter = Parameter::number(
    "lag_scale",
    1.0,
    [0.01, 10.0],
    Some([0.1, 1.5]),
    EXACT_REASON,
);
pub(super) const INERTIA_SCALE: Parameter = Parameter::number(
    "inertia_scale",
    1.0,
    [0.01, 10.0],
    Some([0.2, 3.0]),
    EXACT_REASON,
);
const EXACT_REASON: &str =
    "1 is what the exact model calls for; another makes up for a model that is not exact";

/// The filter of one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Filter {
    /// Weights of the reference at k + ahead, and of as many before as `taps` says; their sum is 1.
    weights: [f64; MAX_WEIGHTS],
    ahead: u32,
    taps: usize,
    /// Weights of the previous commands, 1 - B+, and the weight that remains for the reference,
    /// B+(1). For a plain P speed loop these are q and 1 - q.
    feedback: [f64; MAX_CANCELLED],
    direct: f64,
}

impl Filter {
    /// Creates the filter for an axis with a plain P speed loop, with a servo period of `servo_s`.
    pub(super) fn new(axis: &SampledAxis, servo_s: f64) -> Self {
        let ([alpha, beta, gamma_s, d], kd) = (axis.coefficients(), axis.kd);
        let e = gamma_s * beta - alpha * d;
        let gain = axis.kp_1_s + kd / servo_s;
        let pole = kd / (servo_s * gain);
        let a = [
            1.0,
            gain * d - 1.0 - alpha,
            alpha + gain * (e - pole * d),
            -gain * pole * e,
        ];
        let sum = (d + e) * (a[0] + a[1] + a[2] + a[3]);
        let of_reference = [
            e * a[0],
            d * a[0] + e * a[1],
            d * a[1] + e * a[2],
            d * a[2] + e * a[3],
            d * a[3],
        ];
        let mut weights = [0.0; MAX_WEIGHTS];
        let each = weights.iter_mut().zip(of_reference);
        each.for_each(|(to, weight)| *to = weight / sum);
        let mut feedback = [0.0; MAX_CANCELLED];
        feedback[0] = pole;
        Self {
            weights,
            ahead: 2,
            taps: of_reference.len(),
            feedback,
            direct: 1.0 - pole,
        }
    }

    /// Makes the filter of any loop. `of_reference` is A B- with the zeros of B- mirrored, on any
    /// scale; its first coefficient weights the reference `ahead` periods ahead. `cancelled` is B+,
    /// which begins with 1.
    ///
    /// Returns `None` if there are too many coefficients, if one is not finite, if `of_reference`
    /// sums to zero, or if `cancelled` is empty.
    pub(super) fn of_loop(of_reference: &[f64], ahead: u32, cancelled: &[f64]) -> Option<Self> {
        let (_, before) = cancelled.split_first()?;
        let (sum, direct): (f64, f64) = (of_reference.iter().sum(), cancelled.iter().sum());
        let mut all = of_reference.iter().chain(cancelled);
        let finite = sum.abs() > 0.0 && all.all(|value| (value / sum).is_finite());
        if !finite || of_reference.len() > MAX_WEIGHTS || before.len() > MAX_CANCELLED {
            return None;
        }
        let (mut weights, mut feedback) = ([0.0; MAX_WEIGHTS], [0.0; MAX_CANCELLED]);
        for (to, weight) in weights.iter_mut().zip(of_reference) {
            *to = weight / sum;
        }
        for (to, value) in feedback.iter_mut().zip(before) {
            *to = -value;
        }
        Some(Self {
            weights,
            ahead,
            taps: of_reference.len(),
            feedback,
            direct,
        })
    }

    /// Weights of the reference, the first one the furthest ahead.
    pub(super) fn weights(&self) -> &[f64] {
        self.weights.get(..self.taps).unwrap_or_default()
    }

    /// Returns the offset of the command from the reference, mm. `commanded_mm` yields the previous
    /// commands, the last one first. `at_mm(n)` is the reference n periods after the command.
    /// Computing with offsets from the reference keeps rest at rest to the bit.
    #[inline]
    fn offset_mm(
        &self,
        commanded_mm: impl Iterator<Item = f64>,
        at_mm: impl Fn(f64) -> f64,
    ) -> f64 {
        let here_mm = at_mm(0.0);
        let after = |tap: usize| f64::from(self.ahead) - tap as f64;
        let by_weight = |(tap, weight): (usize, &f64)| weight * (at_mm(after(tap)) - here_mm);
        let filtered: f64 = self.weights().iter().enumerate().map(by_weight).sum();
        let feedback = self.feedback.iter().zip(commanded_mm);
        let fed_back = feedback.map(|(part, command_mm)| part * (command_mm - here_mm));
        fed_back.sum::<f64>() + self.direct * filtered
    }
}

/// Zero phase error tracking control; remembers the commands of the last periods.
#[derive(Debug, Clone)]
pub(super) struct ZeroPhase<const N: usize> {
    filters: [Filter; N],
    preview: u32,
    /// The last commands, the newest first, mm; none at the start.
    commanded_mm: Option<[[f64; N]; MAX_CANCELLED]>,
}

impl<const N: usize> ZeroPhase<N> {
    /// Creates the controller from these filters, for loops that lag by up to `lag_s`.
    pub(super) fn new(filters: [Filter; N], lag_s: f64, servo_s: f64) -> Self {
        // The plain filter looks two periods ahead, which is within the differences that every
        // preview has.
        let more = filters.iter().map(|filter| filter.ahead).fold(2, u32::max) - 2;
        let preview = (preview(lag_s, servo_s) + more).min(MAX_PREVIEW as u32);
        Self {
            filters,
            preview,
            commanded_mm: None,
        }
    }
}

impl SampledAxis {
    /// Alpha, beta, gamma and delta.
    pub(super) fn coefficients(&self) -> [f64; 4] {
        [self.alpha, self.beta, self.gamma_s, self.delta_s]
    }

    /// The lags of the position loop and of the speed loop, s; the second is J / (kv + B).
    pub(super) fn lag_s(&self) -> f64 {
        1.0 / self.kp_1_s + self.gamma_s / (1.0 - self.alpha)
    }
}

impl<const N: usize> Controller<N> for ZeroPhase<N> {
    fn schedule(&self) -> Schedule {
        deciding(1, self.preview)
    }

    fn reset(&mut self) {
        self.commanded_mm = None;
    }

    /// Forgets the previous commands if the position is lost: the command then goes back to the
    /// path by itself.
    fn observe(&mut self, _: &Window<'_, N>, measured: Option<&Measured<N>>) {
        if measured.is_none() {
            self.reset();
        }
    }

    /// The command of the next servo period, k.
    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let next_s = window.tau_s + window.feed_period_s;
        let command_mm = add_scaled(window.offset_mm, 1.0, window.now().position_mm);
        let commanded_mm = self.commanded_mm.get_or_insert([command_mm; MAX_CANCELLED]);
        commanded_mm.copy_within(..MAX_CANCELLED - 1, 1);
        let [newest_mm, ..] = commanded_mm;
        *newest_mm = command_mm;
        let offset_mm = core::array::from_fn(|i| {
            let at = |ahead: f64| window.preview.at(next_s + ahead * window.servo_s());
            let at_mm = |ahead: f64| at(ahead).position_mm[i];
            self.filters[i].offset_mm(commanded_mm.iter().map(|command_mm| command_mm[i]), at_mm)
        });
        Command::straight(1.0, offset_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::fixture::{commands, sampled};
    use feedwright_control::{Knot, KnotSource};

    const SERVO_S: f64 = 0.001;
    const AMPLITUDE_MM: f64 = 0.1;

    /// 20 mm/s and a tenth of a millimetre at `rad_s` across it.
    struct Wave {
        rad_s: f64,
    }

    impl KnotSource<2> for Wave {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            let t_s = tau_s.max(0.0);
            let y = AMPLITUDE_MM * libm::sin(self.rad_s * t_s);
            Knot {
                position_mm: [20.0 * t_s, y],
                tangent: [1.0, 0.0],
                feed_mm_s: 20.0,
                cutting: true,
            }
        }
    }

    /// Drives two linear axes for a second; calls `each` with the time and the tool at the end of
    /// each servo period.
    fn drive(kd: f64, rad_s: f64, mut each: impl FnMut(f64, [f64; 2])) {
        let model = sampled(kd);
        let filters = [Filter::new(&model, SERVO_S); 2];
        let mut controller = ZeroPhase::new(filters, model.lag_s(), SERVO_S);
        let (mut tool_mm, mut speed, mut last_mm) = ([0.0; 2], [0.0; 2], [0.0; 2]);
        let path = &mut Wave { rad_s };
        commands(path, &mut controller, SERVO_S, |n, command_mm| {
            for i in 0..2 {
                let error_mm = command_mm[i] - tool_mm[i];
                let change_mm_s = (error_mm - last_mm[i]) / SERVO_S;
                let reference = model.kp_1_s * error_mm + model.kd * change_mm_s;
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
                // A sine and a cosine, fitted to the last half second by least squares: it need not
                // hold whole periods.
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
                let [alpha, beta, gamma_s, d] = sampled(kd).coefficients();
                let e = gamma_s * beta - alpha * d;
                let zero = d * d + e * e + 2.0 * d * e * libm::cos(rad_s * SERVO_S);
                let gain = zero / ((d + e) * (d + e));
                let here = format!("{rad_s} rad/s, kd {kd}: {in_phase} {quadrature}");
                assert!((in_phase / AMPLITUDE_MM - gain).abs() < 1e-6, "{here}");
                assert!((quadrature / AMPLITUDE_MM).abs() < 1e-6, "{here}");
            }
        }
    }

    #[test]
    fn a_ramp_is_followed_exactly() {
        drive(0.0, 0.0, |t_s, tool_mm| {
            let [x_mm, _] = tool_mm;
            let is_there = (x_mm - 20.0 * t_s).abs() < 1e-9;
            assert!(t_s <= 0.9 || is_there, "{t_s} s: {x_mm} mm");
        });
    }
}
