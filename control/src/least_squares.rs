//! Recursive least squares with forgetting, held to a prior: the estimate of a tick.
//!
//! ```text
//! R(k) = lambda R(k-1) + phi phi'     q(k) = lambda q(k-1) + phi y     (R + d) theta = q + d mean
//! ```
//!
//! The classical recursion keeps the inverse of R, which grows without bound along directions that nothing excites, and
//! then leaps at the first excitation ("wind-up"). Here R is kept and the prior d is added anew at each solution: along a
//! direction that nothing excites the estimate goes back to the prior, whatever the length of the run.
//!
//! Source: exponential forgetting in information form as in Ljung and Soederstroem (1983), section 2.6; ridge as in Hoerl
//! and Kennard (1970). P unknowns; the solution costs P^3/6 multiplications.

/// The sums over the past.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LeastSquares<const P: usize> {
    information: [[f64; P]; P],
    right: [f64; P],
}

impl<const P: usize> LeastSquares<P> {
    /// Nothing seen.
    pub const EMPTY: Self = Self { information: [[0.0; P]; P], right: [0.0; P] };

    /// Takes in that `phi` led to `y`; what was before counts `lambda` times. What is not finite is left out.
    #[inline]
    pub fn add(&mut self, lambda: f64, phi: &[f64; P], y: f64) {
        let mut sum = y;
        for x in phi {
            sum += x;
        }
        if !sum.is_finite() {
            return;
        }
        for r in 0..P {
            for c in 0..=r {
                self.information[r][c] = lambda * self.information[r][c] + phi[r] * phi[c];
            }
            self.right[r] = lambda * self.right[r] + phi[r] * y;
        }
    }

    /// The estimate that fits best and lies near `mean`, where `weight` (above zero) says how much the prior counts.
    #[inline]
    pub fn estimate(&self, weight: f64, mean: &[f64; P]) -> [f64; P] {
        let mut prior = [[0.0; P]; P];
        for r in 0..P {
            prior[r][r] = weight;
        }
        self.estimate_held(&prior, mean)
    }

    /// As [`Self::estimate`], with a weight for every direction: a symmetric positive matrix.
    #[inline]
    pub fn estimate_held(&self, prior: &[[f64; P]; P], mean: &[f64; P]) -> [f64; P] {
        let mut a = self.information;
        let mut b = self.right;
        for r in 0..P {
            for c in 0..P {
                a[r][c] += prior[r][c];
                b[r] += prior[r][c] * mean[c];
            }
        }
        cholesky(&mut a, &mut b, P);
        b
    }
}

/// Solves A x = b in place for the lower half of a symmetric positive A, of which the first `n` rows count.
#[inline]
pub fn cholesky<const P: usize>(a: &mut [[f64; P]; P], b: &mut [f64; P], n: usize) {
    // Column by column, each taken from all rows below at once: sums along a row, which the processor does side by side.
    let mut column = [0.0; P];
    for k in 0..n {
        // The diagonal holds the reciprocal: one division a column.
        let pivot = 1.0 / libm::sqrt(a[k][k]);
        a[k][k] = pivot;
        for r in k + 1..n {
            a[r][k] *= pivot;
            column[r] = a[r][k];
        }
        for r in k + 1..n {
            let factor = column[r];
            for (m, other) in a[r][k + 1..=r].iter_mut().zip(&column[k + 1..=r]) {
                *m -= factor * other;
            }
        }
    }
    for r in 0..n {
        let mut sum = b[r];
        for k in 0..r {
            sum -= a[r][k] * b[k];
        }
        b[r] = sum * a[r][r];
    }
    for r in (0..n).rev() {
        let mut sum = b[r];
        for k in r + 1..n {
            sum -= a[k][r] * b[k];
        }
        b[r] = sum * a[r][r];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_parameters_of_a_line_of_data() {
        let mut sums = LeastSquares::<2>::EMPTY;
        for i in 0..100 {
            let phi = [libm::sin(0.3 * f64::from(i)), libm::cos(0.7 * f64::from(i))];
            sums.add(1.0, &phi, 2.0 * phi[0] - 0.5 * phi[1]);
        }
        let found = sums.estimate(1e-9, &[0.0; 2]);
        assert!((found[0] - 2.0).abs() < 1e-9 && (found[1] + 0.5).abs() < 1e-9, "{found:?}");
    }

    #[test]
    fn stays_at_the_prior_where_nothing_is_excited_however_long() {
        let mut sums = LeastSquares::<2>::EMPTY;
        for i in 0..1_000_000 {
            // The two inputs move together: only their sum is known.
            sums.add(0.99, &[1.0, 1.0], 0.1 + 1e-3 * libm::sin(f64::from(i)));
        }
        let found = sums.estimate(1.0, &[0.0; 2]);
        assert!((found[0] - found[1]).abs() < 1e-12 && (found[0] + found[1] - 0.1).abs() < 2e-3, "{found:?}");
    }

    #[test]
    fn leaves_out_what_is_not_a_number() {
        let mut sums = LeastSquares::<1>::EMPTY;
        sums.add(0.9, &[1.0], 2.0);
        let before = sums;
        sums.add(0.9, &[f64::NAN], 1.0);
        sums.add(0.9, &[1.0], f64::INFINITY);
        assert_eq!(sums, before);
    }
}
