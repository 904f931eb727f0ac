//! How certain the numbers of an axis are, where what is left is coloured.
//!
//! ```text
//! cov p = H^-1 (n / (n - 1) sum_blocks g g^T + P) H^-1,   H = S^T S,   g = S^T r over a block,   P priors' part of H
//! ```
//!
//! r what a free run leaves, S its derivatives. What is left of a real axis is correlated over
//! tenths of a second: a block of that length is one observation. Half an interval of 90 % is 1.645
//! standard errors, more where there are few blocks (Student's t).
//!
//! Source: Liang and Zeger (1986), Longitudinal data analysis using generalized linear models,
//! Biometrika 73(1).

use nalgebra::DMatrix;

use super::output_error::{OutputErrors, change, normal_equations};
use super::terms::{ModelTerm, TermValues};

/// Least length of a block, s, and the fewest blocks that are made of a record.
const BLOCK_S: f64 = 0.25;
const MOST_BLOCKS: usize = 120;
const LEAST_BLOCKS: usize = 8;
/// Part of a diagonal that is added to it: numbers that do the same to the position then share what
/// is left.
const RIDGE: f64 = 1e-10;

/// Half an interval of 90 % of a normal distribution, in standard errors.
pub(super) const HALF_INTERVAL: f64 = 1.645;

/// Standard errors of the terms, and the factor that makes half an interval of 90 % of them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StandardErrors {
    pub(super) errors: Vec<f64>,
    pub(super) factor: f64,
    /// Their covariance, over the changes that differences are made with.
    pub(super) covariance: DMatrix<f64>,
    /// These changes, in the units of the terms.
    changes: Vec<f64>,
}

impl StandardErrors {
    pub(super) fn of(errors: &OutputErrors<'_>, values: &TermValues, terms: &[ModelTerm]) -> Self {
        let left = errors.residuals(values);
        let samples = left.len() - errors.priors.len();
        let slopes = errors.slopes(values, terms);
        let n = terms.len();
        let (curvature, _) = normal_equations(&slopes, &left);
        let sizes: Vec<f64> = (0..n)
            .map(|i| {
                if curvature[(i, i)] > 0.0 {
                    curvature[(i, i)].sqrt()
                } else {
                    1.0
                }
            })
            .collect();
        let scaled = DMatrix::from_fn(n, n, |i, j| {
            curvature[(i, j)] / (sizes[i] * sizes[j]) + if i == j { RIDGE } else { 0.0 }
        });
        let changes: Vec<f64> = terms.iter().map(|term| change(values, *term)).collect();
        let Some(inverse) = scaled.cholesky().map(|cholesky| cholesky.inverse()) else {
            let covariance = DMatrix::from_diagonal_element(n, n, f64::INFINITY);
            return Self {
                errors: vec![f64::INFINITY; n],
                factor: HALF_INTERVAL,
                covariance,
                changes,
            };
        };
        let shortest = (BLOCK_S / errors.record.sample_s).ceil() as usize;
        let block = shortest
            .max(samples / MOST_BLOCKS)
            .min(samples / LEAST_BLOCKS)
            .max(1);
        let mut scatter = DMatrix::<f64>::zeros(n, n);
        let mut blocks = 0.0;
        for from in (0..samples).step_by(block) {
            let to = (from + block).min(samples);
            let g = DMatrix::from_fn(n, 1, |i, _| {
                slopes[i][from..to]
                    .iter()
                    .zip(&left[from..to])
                    .map(|(s, r)| s * r)
                    .sum::<f64>()
                    / sizes[i]
            });
            scatter += &g * g.transpose();
            blocks += 1.0;
        }
        scatter *= blocks / (blocks - 1.0_f64).max(1.0);
        // What was known before is as certain as its spread says.
        scatter += DMatrix::from_fn(n, n, |i, j| {
            slopes[i][samples..]
                .iter()
                .zip(&slopes[j][samples..])
                .map(|(a, b)| a * b)
                .sum::<f64>()
                / (sizes[i] * sizes[j])
        });
        let covariance = &inverse * scatter * &inverse;
        // What a number that moves nothing is, nobody can say.
        let moves = |i: usize| curvature[(i, i)] > 0.0;
        let size = |i: usize| covariance[(i, i)].max(0.0).sqrt() / sizes[i] * changes[i];
        let error = |i: usize| if moves(i) { size(i) } else { f64::INFINITY };
        let errors = (0..n).map(error).collect();
        let covariance = DMatrix::from_fn(n, n, |i, j| covariance[(i, j)] / (sizes[i] * sizes[j]));
        Self {
            errors,
            factor: student(blocks - 1.0),
            covariance,
            changes,
        }
    }

    /// A root of the covariance in the units of the terms, row by row, widened so that its diagonal
    /// has the intervals of 90 % of a normal distribution; none where a term moves nothing.
    pub(super) fn root(&self) -> Option<Vec<Vec<f64>>> {
        let root = self.covariance.clone().cholesky()?.l();
        let wider = self.factor / HALF_INTERVAL;
        let row = |i: usize| {
            (0..=i)
                .map(|j| wider * self.changes[i] * root[(i, j)])
                .collect()
        };
        self.errors
            .iter()
            .all(|error| error.is_finite())
            .then(|| (0..self.changes.len()).map(row).collect())
    }
}

/// The 95 % quantile of Student's distribution by Cornish and Fisher's expansion.
fn student(freedom: f64) -> f64 {
    let (z, f) = (1.644_853_626_951_472_f64, freedom.max(2.0));
    let (z3, z5, z7) = (z.powi(3), z.powi(5), z.powi(7));
    let third = (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / (384.0 * f.powi(3));
    z + (z3 + z) / (4.0 * f) + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / (96.0 * f * f) + third
}

#[cfg(test)]
mod tests {
    use super::student;

    #[test]
    fn quantiles_of_students_distribution_are_those_of_tables() {
        for (freedom, wanted) in [(5.0, 2.015), (10.0, 1.812), (30.0, 1.697), (120.0, 1.658)] {
            assert!(
                (student(freedom) - wanted).abs() < 0.006,
                "{freedom}: {}",
                student(freedom)
            );
        }
    }
}
