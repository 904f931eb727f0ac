//! Gains of a Kalman filter and of a linear-quadratic regulator in their steady state, by doubling
//! the horizon of the discrete Riccati equation.
//!
//! ```text
//! X = A' X (I + G X)^-1 A + H         regulator: G = b b' / m, H = W; filter: A' for A, G = c c' / r, H = Q
//! W = I + G_k H_k
//! A_k+1 = A_k W^-1 A_k      G_k+1 = G_k + A_k W^-1 G_k A_k'      H_k+1 = H_k + A_k' H_k W^-1 A_k
//! regulator:  G = (b' X A + n') / (b' X b + m)        filter:  K = X c / (c' X c + r)
//! ```
//!
//! for x' = A x + b v, y = c' x with noise of covariance Q and variance r, and the cost x' W x + 2
//! x' n v + m v^2 of a period; n is eliminated first, by v = u - n' x / m. H_k is the solution over
//! 2^k periods. States that the input does not reach (a load, an oscillator) do no harm: their part
//! of X grows, but the gains do not contain it.
//!
//! Source: Anderson (1978), "Second-order convergent algorithms for the steady-state Riccati
//! equation", Int. J. Control 28(2); Anderson and Moore (1979), Optimal Filtering, section 4.4;
//! Anderson and Moore (1990), Optimal Control: Linear Quadratic Methods, section 2.4, and exercises
//! for the cross term.

/// Largest number of doublings: a million periods; a longer horizon changes nothing.
const DOUBLINGS: u32 = 20;
/// Convergence: no gain changes by a greater part of the largest one.
const CONVERGED: f64 = 1e-12;
/// Smallest number of doublings before that is checked: nothing changes in the first ones where a
/// noise needs several periods to be seen.
const LEAST_DOUBLINGS: u32 = 8;

/// A matrix, by rows.
pub(super) type StateMatrix<const S: usize> = [[f64; S]; S];

/// Returns `a b`.
pub(super) fn product<const S: usize>(a: &StateMatrix<S>, b: &StateMatrix<S>) -> StateMatrix<S> {
    let mut product = [[0.0; S]; S];
    for (row, a) in product.iter_mut().zip(a) {
        for (factor, b) in a.iter().zip(b) {
            if *factor != 0.0 {
                row.iter_mut()
                    .zip(b)
                    .for_each(|(sum, b)| *sum += factor * b);
            }
        }
    }
    product
}

/// Returns `a'`.
pub(super) fn transposed<const S: usize>(a: &StateMatrix<S>) -> StateMatrix<S> {
    core::array::from_fn(|i| core::array::from_fn(|j| a[j][i]))
}

/// Returns `a x`.
pub(super) fn applied<const S: usize>(a: &StateMatrix<S>, x: &[f64; S]) -> [f64; S] {
    a.map(|row| inner(&row, x))
}

/// Returns `a' b`.
pub(super) fn inner<const S: usize>(a: &[f64; S], b: &[f64; S]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Returns `a + b`.
pub(super) fn sum<const S: usize>(a: &StateMatrix<S>, b: &StateMatrix<S>) -> StateMatrix<S> {
    core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] + b[i][j]))
}

/// Returns the gains of the filter: the correction of each state for a unit of the innovation.
pub(super) fn filter<const S: usize>(
    a: &StateMatrix<S>,
    noise: &StateMatrix<S>,
    measured: &[f64; S],
    variance: f64,
) -> [f64; S] {
    let seen = measured.map(|row| measured.map(|column| row * column / variance));
    doubled(transposed(a), seen, *noise, |covariance| {
        let seen = applied(covariance, measured);
        seen.map(|p| p / (inner(measured, &seen) + variance))
    })
}

/// Cost of a servo period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PeriodCost<const S: usize> {
    /// Cost of the states.
    pub(super) states: StateMatrix<S>,
    /// Cost of each state times the input.
    pub(super) cross: [f64; S],
    /// Cost of the input.
    pub(super) input: f64,
}

/// Returns the gains of the regulator: the reduction of the input for a unit of each state.
pub(super) fn regulator<const S: usize>(
    a: &StateMatrix<S>,
    b: &[f64; S],
    cost: &PeriodCost<S>,
) -> [f64; S] {
    let PeriodCost {
        states,
        cross,
        input,
    } = cost;
    let without: StateMatrix<S> =
        core::array::from_fn(|i| core::array::from_fn(|j| a[i][j] - b[i] * cross[j] / input));
    let left: StateMatrix<S> = core::array::from_fn(|i| {
        core::array::from_fn(|j| states[i][j] - cross[i] * cross[j] / input)
    });
    let reached = b.map(|row| b.map(|column| row * column / input));
    doubled(without, reached, left, |to_go| {
        let of_input = applied(to_go, b);
        let ahead = applied(&transposed(a), &of_input);
        let asked: [f64; S] = core::array::from_fn(|i| ahead[i] + cross[i]);
        asked.map(|asked| asked / (inner(b, &of_input) + input))
    })
}

/// Doubles the horizon until the gains of its solution no longer change.
fn doubled<const S: usize>(
    mut a: StateMatrix<S>,
    mut g: StateMatrix<S>,
    mut h: StateMatrix<S>,
    gains_by: impl Fn(&StateMatrix<S>) -> [f64; S],
) -> [f64; S] {
    let mut gains = gains_by(&h);
    for n in 0..DOUBLINGS {
        let turned = transposed(&a);
        let mut w = product(&g, &h);
        for (i, row) in w.iter_mut().enumerate() {
            row[i] += 1.0;
        }
        let (of_a, of_g) = (solved(&w, &a), solved(&w, &g));
        g = symmetric(&sum(&g, &product(&product(&a, &of_g), &turned)));
        h = symmetric(&sum(&h, &product(&turned, &product(&h, &of_a))));
        a = product(&a, &of_a);
        let next = gains_by(&h);
        let largest = next.iter().fold(0.0_f64, |most, gain| most.max(gain.abs()));
        let change = next
            .iter()
            .zip(&gains)
            .fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
        gains = next;
        if n > LEAST_DOUBLINGS && change <= CONVERGED * largest {
            break;
        }
    }
    gains
}

/// Restores the symmetry: rounding removes it, and the difference grows.
fn symmetric<const S: usize>(a: &StateMatrix<S>) -> StateMatrix<S> {
    sum(a, &transposed(a)).map(|row| row.map(|a| 0.5 * a))
}

/// Returns `w^-1 a`, by elimination with the largest pivot of each column.
fn solved<const S: usize>(w: &StateMatrix<S>, a: &StateMatrix<S>) -> StateMatrix<S> {
    let (mut w, mut x) = (*w, *a);
    for i in 0..S {
        let pivot = (i..S).fold(i, |best, row| {
            if w[row][i].abs() > w[best][i].abs() {
                row
            } else {
                best
            }
        });
        w.swap(i, pivot);
        x.swap(i, pivot);
        for row in 0..S {
            let factor = w[row][i] / w[i][i];
            if row != i && factor != 0.0 {
                let (pivot_w, pivot_x) = (w[i], x[i]);
                w[row]
                    .iter_mut()
                    .zip(&pivot_w)
                    .for_each(|(w, pivot)| *w -= factor * pivot);
                x[row]
                    .iter_mut()
                    .zip(&pivot_x)
                    .for_each(|(x, pivot)| *x -= factor * pivot);
            }
        }
    }
    core::array::from_fn(|i| x[i].map(|x| x / w[i][i]))
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
        for (a, b, w, m) in [
            (1.0, 1.0, 0.1, 1.0),
            (0.9, 0.3, 2.0, 0.5),
            (1.1, 2.0, 0.01, 3.0_f64),
        ] {
            let (b2, half): (f64, f64) = (b * b, 0.5 * (m - a * a * m - b * b * w));
            let s = (-half + libm::sqrt(half * half + b2 * w * m)) / b2;
            let [gain] = regulator(
                &[[a]],
                &[b],
                &PeriodCost {
                    states: [[w]],
                    cross: [0.0],
                    input: m,
                },
            );
            assert!(
                (gain - a * b * s / (m + b2 * s)).abs() < 1e-12,
                "{a} {b}: {gain}"
            );
        }
    }

    #[test]
    fn a_load_that_the_input_does_not_reach_is_carried() {
        // x' = x + v - d: without a weight on v it is v = d - x at once.
        let a = [[1.0, -1.0], [0.0, 1.0]];
        let cost = PeriodCost {
            states: [[1.0, 0.0], [0.0, 0.0]],
            cross: [0.0; 2],
            input: 1e-12,
        };
        let [of_x, of_load] = regulator(&a, &[1.0, 0.0], &cost);
        assert!(
            (of_x - 1.0).abs() < 1e-9 && (of_load + 1.0).abs() < 1e-9,
            "{of_x} {of_load}"
        );
    }

    #[test]
    fn a_double_integrator_has_the_known_filter() {
        // Alpha-beta filter of tracking: lambda = sigma_a T^2 / sigma_n gives alpha, beta in closed
        // form (Kalata 1984).
        let (t, sigma_a, sigma_n) = (0.1_f64, 3.0_f64, 0.2_f64);
        let lambda = sigma_a * t * t / sigma_n;
        let r = (4.0 + lambda - libm::sqrt(8.0 * lambda + lambda * lambda)) / 4.0;
        let (alpha, beta) = (1.0 - r * r, 2.0 * (2.0 - (1.0 - r * r)) - 4.0 * r);
        let pushed = [0.5 * t * t * sigma_a, t * sigma_a];
        let noise = pushed.map(|a| pushed.map(|b| a * b));
        let [position, speed] = filter(
            &[[1.0, t], [0.0, 1.0]],
            &noise,
            &[1.0, 0.0],
            sigma_n * sigma_n,
        );
        assert!(
            (position - alpha).abs() < 1e-9 && (speed - beta / t).abs() < 1e-8,
            "{position} {alpha} {speed}"
        );
    }
}
