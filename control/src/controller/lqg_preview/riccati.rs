//! Gains of a Kalman filter and of a linear-quadratic regulator in their steady state, by iterating the discrete Riccati equation.
//!
//! ```text
//! filter:     K = P c / (c' P c + r)                     P <- A (P - K c' P) A' + Q
//! regulator:  G = (b' S A + n') / (b' S b + m)           S <- A' S A + W - G' (b' S A + n')
//! ```
//!
//! for x' = A x + b v, y = c' x with noise of covariance Q and variance r, and the cost x' W x + 2 x' n v + m v^2 of a period.
//! States that the input does not reach (a load, an oscillator) are no harm: their part of S grows, the gains do not contain it.
//!
//! Source: Anderson and Moore (1979), Optimal Filtering, section 4.4; Anderson and Moore (1990), Optimal Control: Linear Quadratic
//! Methods, section 2.4, and exercises for the cross term.

/// Most iterations: 20 s at a servo period of 1 ms, beyond which nothing is of use.
const ITERATIONS: u32 = 20_000;
/// Converged: no gain changes by a greater part of the largest.
const CONVERGED: f64 = 1e-13;
/// Iterations before that is looked at: nothing moves in the first ones where a noise needs several periods to be seen.
const LEAST_ITERATIONS: u32 = 200;

/// A matrix, by rows.
pub(super) type StateMatrix<const S: usize> = [[f64; S]; S];

/// `a b`.
pub(super) fn product<const S: usize>(a: &StateMatrix<S>, b: &StateMatrix<S>) -> StateMatrix<S> {
    let mut product = [[0.0; S]; S];
    for (row, a) in product.iter_mut().zip(a) {
        for (factor, b) in a.iter().zip(b) {
            if *factor != 0.0 {
                row.iter_mut().zip(b).for_each(|(sum, b)| *sum += factor * b);
            }
        }
    }
    product
}

/// `a'`.
pub(super) fn transposed<const S: usize>(a: &StateMatrix<S>) -> StateMatrix<S> {
    core::array::from_fn(|i| core::array::from_fn(|j| a[j][i]))
}

/// `a x`.
pub(super) fn applied<const S: usize>(a: &StateMatrix<S>, x: &[f64; S]) -> [f64; S] {
    a.map(|row| inner(&row, x))
}

/// `a' b`.
pub(super) fn inner<const S: usize>(a: &[f64; S], b: &[f64; S]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// `a + b`.
pub(super) fn sum<const S: usize>(a: &StateMatrix<S>, b: &StateMatrix<S>) -> StateMatrix<S> {
    core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] + b[i][j]))
}

/// Gains of the filter: how much of what is measured beyond the prediction is added to each state.
pub(super) fn filter<const S: usize>(
    a: &StateMatrix<S>,
    noise: &StateMatrix<S>,
    measured: &[f64; S],
    variance: f64,
) -> [f64; S] {
    let mut covariance = *noise;
    for (i, row) in covariance.iter_mut().enumerate() {
        row[i] += variance;
    }
    converged(|_| {
        let seen = applied(&covariance, measured);
        let gains = seen.map(|p| p / (inner(measured, &seen) + variance));
        let updated: StateMatrix<S> =
            core::array::from_fn(|i| core::array::from_fn(|j| covariance[i][j] - gains[i] * seen[j]));
        covariance = sum(&product(&product(a, &updated), &transposed(a)), noise);
        // Rounding turns it unsymmetric, and that grows.
        let mirrored = transposed(&covariance);
        covariance = sum(&covariance, &mirrored).map(|row| row.map(|p| 0.5 * p));
        gains
    })
}

/// What a servo period costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PeriodCost<const S: usize> {
    /// Of states.
    pub(super) states: StateMatrix<S>,
    /// Of a state and the input.
    pub(super) cross: [f64; S],
    /// Of the input.
    pub(super) input: f64,
}

/// Gains of the regulator: the input is less by so much for a unit of each state.
pub(super) fn regulator<const S: usize>(a: &StateMatrix<S>, b: &[f64; S], cost: &PeriodCost<S>) -> [f64; S] {
    let mut to_go = cost.states;
    converged(|_| {
        let of_input = applied(&to_go, b);
        let ahead = applied(&transposed(a), &of_input);
        let asked: [f64; S] = core::array::from_fn(|i| ahead[i] + cost.cross[i]);
        let gains = asked.map(|asked| asked / (inner(b, &of_input) + cost.input));
        let carried = product(&product(&transposed(a), &to_go), a);
        to_go = core::array::from_fn(|i| {
            core::array::from_fn(|j| {
                let gain = 0.5 * (gains[i] * asked[j] + asked[i] * gains[j]);
                0.5 * (carried[i][j] + carried[j][i]) + cost.states[i][j] - gain
            })
        });
        gains
    })
}

/// Iterates until the gains change no more.
fn converged<const S: usize>(mut step: impl FnMut(u32) -> [f64; S]) -> [f64; S] {
    let mut gains = step(0);
    for n in 1..ITERATIONS {
        let next = step(n);
        let largest = next.iter().fold(0.0_f64, |most, gain| most.max(gain.abs()));
        let change = next.iter().zip(&gains).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        gains = next;
        if n > LEAST_ITERATIONS && change <= CONVERGED * largest {
            break;
        }
    }
    gains
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scalar_filter_has_the_gain_of_its_quadratic_equation() {
        // p = a^2 p r / (p + r) + q: p^2 + p (r - a^2 r - q) - q r = 0, gain p / (p + r).
        for (a, q, r) in [(1.0, 0.1, 1.0), (0.9, 2.0, 0.5), (1.1, 0.01, 3.0_f64)] {
            let half: f64 = 0.5 * (r - a * a * r - q);
            let p = -half + libm::sqrt(half * half + q * r);
            let [gain] = filter(&[[a]], &[[q]], &[1.0], r);
            assert!((gain - p / (p + r)).abs() < 1e-12, "{a} {q} {r}: {gain}");
        }
    }

    #[test]
    fn a_scalar_regulator_has_the_gain_of_its_quadratic_equation() {
        // Dual to the filter: s = a^2 s m / (m + b^2 s) + w, gain a b s / (m + b^2 s).
        for (a, b, w, m) in [(1.0, 1.0, 0.1, 1.0), (0.9, 0.3, 2.0, 0.5), (1.1, 2.0, 0.01, 3.0_f64)] {
            let (b2, half): (f64, f64) = (b * b, 0.5 * (m - a * a * m - b * b * w));
            let s = (-half + libm::sqrt(half * half + b2 * w * m)) / b2;
            let [gain] = regulator(&[[a]], &[b], &PeriodCost { states: [[w]], cross: [0.0], input: m });
            assert!((gain - a * b * s / (m + b2 * s)).abs() < 1e-12, "{a} {b}: {gain}");
        }
    }

    #[test]
    fn a_load_that_the_input_does_not_reach_is_carried() {
        // x' = x + v - d: without a price for v it is v = d - x at once.
        let a = [[1.0, -1.0], [0.0, 1.0]];
        let cost = PeriodCost { states: [[1.0, 0.0], [0.0, 0.0]], cross: [0.0; 2], input: 1e-12 };
        let [of_x, of_load] = regulator(&a, &[1.0, 0.0], &cost);
        assert!((of_x - 1.0).abs() < 1e-9 && (of_load + 1.0).abs() < 1e-9, "{of_x} {of_load}");
    }

    #[test]
    fn a_double_integrator_has_the_known_filter() {
        // Alpha-beta filter of tracking: lambda = sigma_a T^2 / sigma_n gives alpha, beta in closed form (Kalata 1984).
        let (t, sigma_a, sigma_n) = (0.1_f64, 3.0_f64, 0.2_f64);
        let lambda = sigma_a * t * t / sigma_n;
        let r = (4.0 + lambda - libm::sqrt(8.0 * lambda + lambda * lambda)) / 4.0;
        let (alpha, beta) = (1.0 - r * r, 2.0 * (2.0 - (1.0 - r * r)) - 4.0 * r);
        let pushed = [0.5 * t * t * sigma_a, t * sigma_a];
        let noise = pushed.map(|a| pushed.map(|b| a * b));
        let [position, speed] = filter(&[[1.0, t], [0.0, 1.0]], &noise, &[1.0, 0.0], sigma_n * sigma_n);
        assert!((position - alpha).abs() < 1e-9 && (speed - beta / t).abs() < 1e-8, "{position} {alpha} {speed}");
    }
}
