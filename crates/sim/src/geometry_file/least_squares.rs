//! Rank-revealing least squares, which finds the unknowns that cannot be separated, and the F
//! distribution.
//!
//! Columns are orthogonalized one after the other (modified Gram-Schmidt, twice). A column of which
//! nearly nothing is left is dropped: its unknown cannot be separated from those before it. Source:
//! Bjorck (1996), Numerical methods for least squares problems.

/// Part of a column that has to remain for its unknown to count as identified. Below it, rounding
/// and small faults of the model decide the value.
const LEAST_LEFT: f64 = 1e-3;

/// A solution.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RankedLeastSquares {
    /// The unknowns; 0 where one was dropped.
    pub values: Vec<f64>,
    /// True for each unknown that was found.
    pub found: Vec<bool>,
    /// Inverse of the normal matrix: times the variance of a row the covariance of the unknowns.
    pub covariance: Vec<Vec<f64>>,
    /// Sum of the squares of what is left.
    pub left: f64,
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn without(from: &mut [f64], times: f64, of: &[f64]) {
    from.iter_mut()
        .zip(of)
        .for_each(|(from, of)| *from -= times * of);
}

impl RankedLeastSquares {
    /// Fits `right` by columns of the same length; the earlier ones have precedence.
    pub fn new(columns: &[Vec<f64>], right: &[f64]) -> Self {
        let count = columns.len();
        let mut basis: Vec<(usize, Vec<f64>)> = Vec::new();
        let mut factors = vec![vec![0.0; count]; count];
        for (i, column) in columns.iter().enumerate() {
            let (mut left, whole) = (column.clone(), dot(column, column).sqrt());
            for _ in 0..2 {
                for (k, unit) in &basis {
                    let part = dot(&left, unit);
                    factors[*k][i] += part;
                    without(&mut left, part, unit);
                }
            }
            let length = dot(&left, &left).sqrt();
            if length > LEAST_LEFT * whole {
                factors[i][i] = length;
                left.iter_mut().for_each(|value| *value /= length);
                basis.push((i, left));
            }
        }
        let mut rest = right.to_vec();
        let mut parts = vec![0.0; count];
        for (k, unit) in &basis {
            parts[*k] = dot(&rest, unit);
            without(&mut rest, parts[*k], unit);
        }
        let kept: Vec<usize> = basis.iter().map(|(k, _)| *k).collect();
        let inverse = inverse(&factors, &kept, count);
        let values = (0..count).map(|i| dot(&inverse[i], &parts)).collect();
        let covariance = (0..count)
            .map(|i| (0..count).map(|j| dot(&inverse[i], &inverse[j])).collect())
            .collect();
        let found = (0..count).map(|i| kept.contains(&i)).collect();
        Self {
            values,
            found,
            covariance,
            left: dot(&rest, &rest),
        }
    }

    /// Number of unknowns that were found.
    pub fn rank(&self) -> usize {
        self.found.iter().filter(|found| **found).count()
    }
}

/// Inverse of an upper triangle in the rows and columns that were kept.
fn inverse(factors: &[Vec<f64>], kept: &[usize], count: usize) -> Vec<Vec<f64>> {
    let mut inverse = vec![vec![0.0; count]; count];
    for (at, &column) in kept.iter().enumerate() {
        inverse[column][column] = 1.0 / factors[column][column];
        for &row in kept[..at].iter().rev() {
            let sum: f64 = kept
                .iter()
                .filter(|&&k| k > row && k <= column)
                .map(|&k| factors[row][k] * inverse[k][column])
                .sum();
            inverse[row][column] = -sum / factors[row][row];
        }
    }
    inverse
}

/// Probability that a quotient of variances with `over` and `under` degrees of freedom exceeds
/// `quotient` by chance.
pub fn f_exceeded(quotient: f64, over: f64, under: f64) -> f64 {
    let is_sensible = quotient > 0.0 && over > 0.0 && under > 0.0;
    if !is_sensible {
        return 1.0;
    }
    incomplete_beta(under / (under + over * quotient), 0.5 * under, 0.5 * over)
}

/// Regularized incomplete beta function; continued fraction of DLMF 8.17.22, evaluated by Lentz's
/// method.
fn incomplete_beta(x: f64, a: f64, b: f64) -> f64 {
    if x <= 0.0 || x >= 1.0 {
        return x.clamp(0.0, 1.0);
    }
    if x > (a + 1.0) / (a + b + 2.0) {
        return 1.0 - incomplete_beta(1.0 - x, b, a);
    }
    let logarithm = libm::lgamma(a + b) - libm::lgamma(a) - libm::lgamma(b)
        + a * libm::log(x)
        + b * libm::log1p(-x);
    const TINY: f64 = 1e-300;
    // More terms than sqrt(max(a, b)) of any table of this library.
    const MOST_TERMS: u32 = 2000;
    let nonzero = |value: f64| if value.abs() < TINY { TINY } else { value };
    let (mut c, mut d) = (1.0, 1.0 / nonzero(1.0 - (a + b) * x / (a + 1.0)));
    let mut fraction = d;
    for term in 1..MOST_TERMS {
        let m = f64::from(term);
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        let before = fraction;
        for factor in [even, odd] {
            d = 1.0 / nonzero(1.0 + factor * d);
            c = nonzero(1.0 + factor / c);
            fraction *= c * d;
        }
        if (fraction - before).abs() <= 1e-14 * fraction.abs() {
            break;
        }
    }
    libm::exp(logarithm) * fraction / a
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_and_a_column_that_repeats_another_is_dropped() {
        let [one, x, twice] = [
            [1.0, 1.0, 1.0, 1.0],
            [0.0, 1.0, 2.0, 3.0],
            [1.0, 3.0, 5.0, 7.0],
        ]
        .map(Vec::from);
        let fit = RankedLeastSquares::new(&[one, x, twice], &[1.0, 3.0, 5.0, 8.0]);
        // Closed form of a line: slope 2.3, intercept 0.8, squares left 0.3.
        assert!(
            (fit.values[0] - 0.8).abs() < 1e-12 && (fit.values[1] - 2.3).abs() < 1e-12,
            "{fit:?}"
        );
        assert!(
            (fit.left - 0.3).abs() < 1e-12 && (fit.covariance[1][1] - 0.2).abs() < 1e-12,
            "{fit:?}"
        );
        assert_eq!(
            (fit.found.clone(), fit.rank()),
            (vec![true, true, false], 2)
        );
    }

    /// F at the upper 5, 1 and 0.1 percent, as tables of statistics print it to three digits.
    #[test]
    fn the_f_distribution_agrees_with_tables() {
        for (quotient, over, under, part) in [
            (4.96, 1.0, 10.0, 0.05),
            (10.04, 1.0, 10.0, 0.01),
            (3.33, 5.0, 10.0, 0.05),
            (2.08, 10.0, 40.0, 0.05),
        ] {
            let found = f_exceeded(quotient, over, under);
            assert!(
                (found / part - 1.0).abs() < 0.05,
                "F = {quotient} with {over}, {under}: {found}, not {part}"
            );
        }
        assert_eq!(f_exceeded(0.0, 3.0, 10.0), 1.0);
        // With 2 and n degrees of freedom in closed form.
        let closed = libm::pow(1.0 + 2.0 * 7.0 / 600.0, -300.0);
        assert!((f_exceeded(7.0, 2.0, 600.0) / closed - 1.0).abs() < 1e-9);
    }
}
