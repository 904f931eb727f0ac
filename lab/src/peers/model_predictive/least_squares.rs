//! Recursive least squares with forgetting, held to a prior: the estimate of a tick.
//!
//! ```text
//! R(k) = lambda R(k-1) + phi phi'     q(k) = lambda q(k-1) + phi y     (R + d) theta = q + d mean
//! ```
//!
//! The classical recursion keeps the inverse of R, which grows without bound along directions that
//! nothing excites, and then leaps at the first excitation ("wind-up"). Here R is kept and the
//! prior d is added anew at each solution: along a direction that nothing excites the estimate goes
//! back to the prior, whatever the length of the run.
//!
//! Source: exponential forgetting in information form as in Ljung and Soederstroem (1983), section
//! 2.6; ridge as in Hoerl and Kennard (1970). P unknowns; the solution costs P^3/6 multiplications.

/// The sums over the past.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LeastSquares<const P: usize> {
    information: [[f64; P]; P],
    right: [f64; P],
}

impl<const P: usize> LeastSquares<P> {
    /// Nothing seen.
    pub(crate) const EMPTY: Self = Self {
        information: [[0.0; P]; P],
        right: [0.0; P],
    };

    /// Takes in that `phi` led to `y`; what was before counts `lambda` times. What is not finite is
    /// left out.
    #[inline]
    pub(crate) fn add(&mut self, lambda: f64, phi: &[f64; P], y: f64) {
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

    /// The estimate that fits best and lies near `mean`, where `weight` (above zero) says how much
    /// the prior counts.
    #[inline]
    pub(crate) fn estimate(&self, weight: f64, mean: &[f64; P]) -> [f64; P] {
        let mut a = self.information;
        let mut b = self.right;
        for r in 0..P {
            a[r][r] += weight;
            b[r] += weight * mean[r];
        }
        cholesky(&mut a, &mut b, P);
        b
    }
}

/// Rows that are worked with together: an entry of a matrix is then read and written once for all
/// of them.
pub(crate) const BLOCK: usize = 4;

/// Adds the products of factors and rows to as many entries as `sums` has: what solving costs, it
/// costs here.
#[inline]
pub(crate) fn add_products(sums: &mut [f64], factors: [f64; BLOCK], rows: [&[f64]; BLOCK]) {
    let [f0, f1, f2, f3] = factors;
    let number = sums.len();
    let [r0, r1, r2, r3] = rows.map(|row| &row[..number]);
    for i in 0..number {
        sums[i] += (f0 * r0[i] + f1 * r1[i]) + (f2 * r2[i] + f3 * r3[i]);
    }
}

/// Solves A x = b in place for the lower half of a symmetric positive A, of which the first `n`
/// rows count.
#[inline]
pub(crate) fn cholesky<const P: usize>(a: &mut [[f64; P]; P], b: &mut [f64; P], n: usize) {
    // A block of columns, then what it takes off all rows below at once. b goes along as one more
    // row, and is solved for half by it.
    let n = n.min(P);
    let mut columns = [[0.0; P]; BLOCK];
    let mut first = 0;
    while first < n {
        let end = (first + BLOCK).min(n);
        for k in first..end {
            let (above, below) = a.split_at_mut(k + 1);
            let row = &mut above[k];
            let rest = |entries: &[f64; P]| {
                (first..k).fold(entries[k], |sum, j| sum - entries[j] * row[j])
            };
            // The diagonal holds the reciprocal: one division a column.
            let pivot = 1.0 / libm::sqrt(rest(row));
            for below in below.iter_mut().take(n - k - 1) {
                below[k] = rest(below) * pivot;
            }
            b[k] = rest(b) * pivot;
            row[k] = pivot;
        }
        for r in end..n {
            for (column, entry) in columns.iter_mut().zip(a[r].iter().take(end).skip(first)) {
                column[r] = *entry;
            }
        }
        // Only the last block is not whole, and there is nothing below it.
        let take_off = |row: &mut [f64; P], last: usize| {
            let factors = core::array::from_fn(|i| row.get(first + i).map_or(0.0, |entry| -entry));
            add_products(
                &mut row[end..last],
                factors,
                columns.each_ref().map(|column| &column[end..last]),
            );
        };
        for r in end..n {
            take_off(&mut a[r], r + 1);
        }
        if end < n {
            take_off(b, n);
        }
        first = end;
    }
    back(a, b, n);
}

/// Solves A x = b in place once more, with what [`cholesky`] has left in `a`.
#[inline]
pub(crate) fn substitute<const P: usize>(a: &[[f64; P]; P], b: &mut [f64; P], n: usize) {
    let n = n.min(P);
    for k in 0..n {
        let sum = a[k][..k]
            .iter()
            .zip(&*b)
            .fold(b[k], |sum, (factor, known)| sum - factor * known);
        b[k] = sum * a[k][k];
    }
    back(a, b, n);
}

/// The second half of a solution, with the upper factor, which is the lower one's transpose.
#[inline]
fn back<const P: usize>(a: &[[f64; P]; P], b: &mut [f64; P], n: usize) {
    for k in (0..n).rev() {
        b[k] *= a[k][k];
        let (known, solved) = b.split_at_mut(k);
        for (entry, factor) in known.iter_mut().zip(&a[k]) {
            *entry -= solved[0] * factor;
        }
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
        assert!(
            (found[0] - 2.0).abs() < 1e-9 && (found[1] + 0.5).abs() < 1e-9,
            "{found:?}"
        );
    }

    #[test]
    fn what_is_solved_gives_the_right_side_whatever_the_number_of_rows() {
        const MOST: usize = 13;
        for n in 1..=MOST {
            let entry =
                |r: usize, c: usize| libm::cos((r * c) as f64) + if r == c { 13.0 } else { 0.0 };
            let mut a: [[f64; MOST]; MOST] =
                core::array::from_fn(|r| core::array::from_fn(|c| entry(r, c)));
            let right: [f64; MOST] = core::array::from_fn(|r| libm::sin(r as f64));
            let (mut x, mut again) = (right, right);
            cholesky(&mut a, &mut x, n);
            substitute(&a, &mut again, n);
            assert_eq!(
                x.map(|x| (x * 1e12).round()),
                again.map(|x| (x * 1e12).round())
            );
            for (r, right) in right.into_iter().enumerate() {
                let sum = (0..n).map(|c| entry(r, c) * x[c]).sum::<f64>();
                // What does not count is left alone.
                let expected = if r < n { sum } else { x[r] };
                assert!(
                    (expected - right).abs() < 1e-13,
                    "{n} {r}: {expected} {right}"
                );
            }
        }
    }

    #[test]
    fn stays_at_the_prior_where_nothing_is_excited_however_long() {
        let mut sums = LeastSquares::<2>::EMPTY;
        for i in 0..1_000_000 {
            // The two inputs move together: only their sum is known.
            sums.add(0.99, &[1.0, 1.0], 0.1 + 1e-3 * libm::sin(f64::from(i)));
        }
        let found = sums.estimate(1.0, &[0.0; 2]);
        assert!(
            (found[0] - found[1]).abs() < 1e-12 && (found[0] + found[1] - 0.1).abs() < 2e-3,
            "{found:?}"
        );
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
