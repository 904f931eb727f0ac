//! What a free run leaves, as a load on the axis that moves it as much, and is correlated as long.
//!
//! ```text
//! S(w) = |G(jw)|^2 2 a s^2 / (a^2 + w^2)      G = 1 / (p^2 + d p + Kp Kv / J + (Kv p + Kp Kv) / (J Ti p))      a = 1 / correlation time
//! ```
//!
//! G is the position for a load over the inertia; without an integral part its last term is not
//! there. The correlation time is that with which S has the correlation of the residual over the
//! lag of the position loop, the load s that with which it has its mean square. Noise of the
//! encoder is white, and taken out of both.
//!
//! Source: the load as an Ornstein-Uhlenbeck process, Uhlenbeck and Ornstein (1930); position loops
//! as in `crates/control/src/axis.rs`.

use super::axis_record::AxisRecord;
use super::terms::{ModelTerm, TermValues};

/// A load that makes of a free run what was measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ResidualNoise {
    /// RMS of the load over the inertia, mm/s2.
    pub load_mm_s2: f64,
    /// Its correlation time, s.
    pub correlation_s: f64,
    /// RMS of what it stands for, um.
    pub left_um: f64,
}

/// Correlation times that are tried, s: from, to, and how many.
const CORRELATIONS_S: [f64; 2] = [5e-4, 2.0];
const CORRELATIONS: usize = 60;
/// Frequencies of the sums, rad/s: from, to, and how many.
const FREQUENCIES_RAD_S: [f64; 2] = [1e-2, 2e4];
const FREQUENCIES: usize = 1500;
/// Fewest pairs of samples from which a correlation is computed.
const LEAST_PAIRS: usize = 100;

impl ResidualNoise {
    /// Finds the load behind the residuals of whole runs; `None` where they are no more than the
    /// noise of the encoder, whose mean square is given, mm2.
    pub(super) fn of(
        record: &AxisRecord<'_>,
        values: &TermValues,
        simulated_mm: &[Option<f64>],
        encoder_mm2: f64,
    ) -> Option<Self> {
        let left = |k: usize| {
            simulated_mm
                .get(k)
                .copied()
                .flatten()
                .map(|simulated| record.actual_mm[k] - simulated)
        };
        let lag_s = 1.0 / values.kp_1_s();
        let lag = ((lag_s / record.sample_s).round() as usize).max(1);
        let (mut square, mut product, mut all, mut pairs) = (0.0, 0.0, 0_usize, 0_usize);
        for stretch in record.stretches {
            for k in stretch.clone() {
                let Some(now) = left(k) else { continue };
                (square, all) = (square + now * now, all + 1);
                if let Some(later) = left(k + lag).filter(|_| k + lag < stretch.end) {
                    (product, pairs) = (product + now * later, pairs + 1);
                }
            }
        }
        if pairs < LEAST_PAIRS {
            return None;
        }
        let square = square / all as f64 - encoder_mm2;
        if square <= 0.0 {
            return None;
        }
        let wanted = product / pairs as f64 / square;
        let lag_s = lag as f64 * record.sample_s;
        let (mut closest, mut found) = (f64::INFINITY, None);
        for correlation_s in spaced(CORRELATIONS_S, CORRELATIONS) {
            let [gain_s4, correlation] = moved(values, correlation_s, lag_s);
            let off = (correlation - wanted).abs();
            if off < closest {
                (closest, found) = (off, Some((correlation_s, gain_s4)));
            }
        }
        let (correlation_s, gain_s4) = found.filter(|found| found.1 > 0.0)?;
        let load_mm_s2 = (square / gain_s4).sqrt();
        Some(Self {
            load_mm_s2,
            correlation_s,
            left_um: 1e3 * square.sqrt(),
        })
    }
}

/// Mean square of the position under a load whose mean square is one, s4, and the correlation of
/// the position over a lag.
fn moved(values: &TermValues, correlation_s: f64, lag_s: f64) -> [f64; 2] {
    let (loop_gain, damping) = (
        values.get(ModelTerm::LoopGain),
        values.get(ModelTerm::Damping),
    );
    let (inverse_s, integral) = (1.0 / correlation_s, values.get(ModelTerm::Integral));
    let speed_gain = values.speed_gain_1_s();
    // p^2 + d p + Kp Kv / J + (Kv / J p + Kp Kv / J) / (Ti p), squared.
    let stiffness = |w: f64| {
        let real = loop_gain - w * w + speed_gain * integral;
        let imaginary = damping * w - loop_gain * integral / w;
        real * real + imaginary * imaginary
    };
    let step = libm::log(FREQUENCIES_RAD_S[1] / FREQUENCIES_RAD_S[0]) / (FREQUENCIES - 1) as f64;
    let (mut all, mut later) = (0.0, 0.0);
    for w in spaced(FREQUENCIES_RAD_S, FREQUENCIES) {
        let load = 2.0 * inverse_s / (inverse_s * inverse_s + w * w) / std::f64::consts::PI;
        // dw = w d(ln w).
        let power = load / stiffness(w) * w * step;
        all += power;
        later += power * libm::cos(w * lag_s);
    }
    [all, later / all]
}

/// Values that grow evenly in their logarithm.
fn spaced([from, to]: [f64; 2], count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| from * libm::pow(to / from, i as f64 / (count - 1) as f64))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::identify::grey_box::terms::TERMS;

    #[test]
    fn a_load_moves_a_proportional_loop_as_lyapunovs_equation_has_it() {
        let (a, d) = (9700.0, 194.0);
        let values = TermValues([0.0; TERMS])
            .with(ModelTerm::LoopGain, a)
            .with(ModelTerm::Damping, d);
        for correlation_s in [0.001, 0.01, 0.3] {
            let r = 1.0 / correlation_s;
            let wanted = (d + r) / (a * d * (a + d * r + r * r));
            let [found, _] = moved(&values, correlation_s, 0.01);
            assert!(
                (found / wanted - 1.0).abs() < 0.01,
                "{correlation_s} s: {found} instead of {wanted}"
            );
        }
    }

    #[test]
    fn a_load_that_lasts_is_taken_back_by_an_integral_part() {
        let plain = TermValues([0.0; TERMS])
            .with(ModelTerm::LoopGain, 9700.0)
            .with(ModelTerm::Damping, 194.0);
        let [with, without] = [plain.with(ModelTerm::Integral, 50.0), plain]
            .map(|values| moved(&values, 1.0, 0.01)[0]);
        assert!(with < 0.1 * without, "{with} {without}");
    }
}
