//! One step of Gauss and Newton: the minimum of the linearised problem, by the normal equations.
//!
//! ```text
//! (G'G + W) du = -G'r - W u
//! ```
//!
//! Source: Gauss-Newton with a fixed number of steps a tick as in Diehl, Bock and Schloeder (2005).

use super::problem::Problem;
use super::{MOST_UNKNOWNS, Rates, Solver};
use crate::least_squares::{BLOCK, add_products, cholesky};
use crate::vector::add_scaled;

/// The normal equations of a tick. Kept between ticks so that none has to clear them: only the lower half is used, and of that
/// what the horizon needs.
#[derive(Debug, Clone)]
pub struct GaussNewton {
    matrix: [[f64; MOST_UNKNOWNS]; MOST_UNKNOWNS],
    right: [f64; MOST_UNKNOWNS],
}

impl Default for GaussNewton {
    fn default() -> Self {
        Self { matrix: [[0.0; MOST_UNKNOWNS]; MOST_UNKNOWNS], right: [0.0; MOST_UNKNOWNS] }
    }
}

impl<const N: usize> Solver<N> for GaussNewton {
    fn improve(&mut self, problem: &Problem<N>, rates: &mut Rates<N>) {
        let unknowns = problem.unknowns();
        for r in 0..unknowns {
            self.matrix[r][..=r].fill(0.0);
        }
        let gradient = problem.gradient(rates);
        for (right, gradient) in self.right.iter_mut().zip(gradient.as_flattened()) {
            *right = -gradient;
        }
        self.add_across(problem);
        self.add_along(problem);
        self.add_weights(problem);
        cholesky(&mut self.matrix, &mut self.right, unknowns);
        for (rate, change) in rates.as_flattened_mut()[..unknowns].iter_mut().zip(&self.right) {
            *rate += change;
        }
    }
}

impl GaussNewton {
    /// G'G of the errors across the path, a block of rows of G at a time.
    fn add_across<const N: usize>(&mut self, problem: &Problem<N>) {
        let mut rows = [[0.0; MOST_UNKNOWNS]; BLOCK];
        let number = problem.knots * (N - 1);
        for first in (0..number).step_by(BLOCK) {
            let mut last = 0;
            for (i, row) in rows.iter_mut().enumerate() {
                // Behind its entries a row of an earlier block has none either, and is zero.
                if first + i < number {
                    last = (first + i) / (N - 1);
                    problem.row(last, (first + i) % (N - 1), row);
                } else {
                    row.fill(0.0);
                }
            }
            for r in 0..(last + 1) * N {
                let factors = rows.each_ref().map(|row| row[r]);
                add_products(&mut self.matrix[r][..=r], factors, rows.each_ref().map(|row| &row[..=r]));
            }
        }
    }

    /// The part of the offset along the path at knot i is the same sum of rates for all j <= i: what knots from m on add is
    /// one small matrix.
    fn add_along<const N: usize>(&mut self, problem: &Problem<N>) {
        let gain = problem.settings.tangential_price * problem.knot_s;
        let mut square = [[0.0; N]; N];
        for knot in (0..problem.knots).rev() {
            let tangent = problem.directions[knot][N - 1];
            for a in 0..N {
                square[a] = add_scaled(square[a], gain * gain * tangent[a], tangent);
                let r = knot * N + a;
                for c in 0..=r {
                    self.matrix[r][c] += square[a][c % N];
                }
            }
        }
    }

    fn add_weights<const N: usize>(&mut self, problem: &Problem<N>) {
        let settings = &problem.settings;
        for r in 0..problem.unknowns() {
            self.matrix[r][r] += settings.rate_weight;
            if r >= N {
                self.matrix[r][r] += settings.change_weight;
                self.matrix[r - N][r - N] += settings.change_weight;
                self.matrix[r][r - N] -= settings.change_weight;
            }
        }
    }
}
