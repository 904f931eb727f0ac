//! Noise of the command: the acceleration of the command at constant speed, by the noise of the
//! measurement and of the loads.
//!
//! ```text
//! x' = (A - B K) x + D nu          x the estimate of the regulated axis when its command acts, nu the innovations
//! P = f (A - B K) P (A - B K)' f + D S D'
//! a^2 = d P d' / Ts^4,   d x = o - 2 o1 + o2
//! ```
//!
//! The innovations of a filter with the right model are white, with the variance S = R / (1 - k1); k1
//! is the gain of the angle. f forgets over [`REMEMBERED`] periods: an estimated load is a random
//! walk, and has no variance of its own.
//!
//! Source: Anderson and Moore (1990), Optimal Control: Linear Quadratic Methods, section 8.1, for the
//! separation of filter and regulator; Åström and Wittenmark (1997), Computer-Controlled Systems,
//! section 10.3, for the variance.

use super::riccati::{StateMatrix, applied, inner, product, sum, transposed};

/// Servo periods over which the innovations are summed.
const REMEMBERED: f64 = 1000.0;
/// Doublings of that sum: 16 times as many periods.
const DOUBLINGS: u32 = 14;

/// Returns the RMS of the second difference of the command, in units of the state, for a loop with
/// this transition, this entry of the innovations, and this row of the second difference.
pub(super) fn second_difference<const S: usize>(
    closed: &StateMatrix<S>,
    enters: &[f64; S],
    difference: &[f64; S],
    innovation: f64,
) -> f64 {
    let mut covariance: StateMatrix<S> =
        core::array::from_fn(|i| core::array::from_fn(|j| innovation * enters[i] * enters[j]));
    let mut carries = closed.map(|row| row.map(|a| (1.0 - 1.0 / REMEMBERED) * a));
    for _ in 0..DOUBLINGS {
        let carried = product(&product(&carries, &covariance), &transposed(&carries));
        covariance = sum(&covariance, &carried);
        carries = product(&carries, &carries);
    }
    libm::sqrt(inner(difference, &applied(&covariance, difference)).max(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_first_order_loop_has_the_variance_of_its_series() {
        // x' = 0.8 x + nu: the variance is 1 / (1 - 0.64), but for what is forgotten.
        let found = second_difference(&[[0.8]], &[1.0], &[1.0], 1.0);
        assert!((found * found * 0.36 - 1.0).abs() < 5e-3, "{found}");
    }
}
