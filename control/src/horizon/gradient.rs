//! Projected gradient with momentum: the paper's way, over a horizon. Slower than [`super::gauss_newton`] at the same
//! accuracy; kept as its measure.
//!
//! ```text
//! v <- mu v - dJ/du / L      u <- u + v      L: bound of the curvature
//! ```
//!
//! Source: gradient steps on the performance index as in Lee, Cho and Jeon (2005), eq. 8; momentum, Polyak (1964).

use super::problem::Problem;
use super::{MOST_KNOTS, MOST_UNKNOWNS, Rates, Solver};
use crate::vector::{add_scaled, scale};

/// mu.
const MOMENTUM: f64 = 0.8;

/// So many steps of the gradient at a time, on the problem linearised once.
#[derive(Debug, Clone)]
pub struct Gradient<const N: usize, const STEPS: usize = 1> {
    velocity: Rates<N>,
}

impl<const N: usize, const STEPS: usize> Default for Gradient<N, STEPS> {
    fn default() -> Self {
        Self { velocity: [[0.0; N]; MOST_KNOTS] }
    }
}

impl<const N: usize, const STEPS: usize> Solver<N> for Gradient<N, STEPS> {
    fn improve(&mut self, problem: &Problem<N>, rates: &mut Rates<N>) {
        let step = 1.0 / curvature(problem);
        let mut change = [[0.0; N]; MOST_KNOTS];
        let mut off_mm = problem.off_mm;
        for taken in 0..STEPS {
            if taken > 0 {
                off_mm = problem.off_after_mm(&change);
            }
            let gradient = problem.gradient_at(rates, &off_mm);
            for knot in 0..problem.knots {
                self.velocity[knot] = add_scaled(scale(MOMENTUM, self.velocity[knot]), -step, gradient[knot]);
                change[knot] = add_scaled(change[knot], 1.0, self.velocity[knot]);
                rates[knot] = add_scaled(rates[knot], 1.0, self.velocity[knot]);
            }
        }
    }

    fn reset(&mut self) {
        *self = Self::default();
    }

    /// A velocity belongs to its knot.
    fn shift(&mut self) {
        self.velocity.copy_within(1.., 0);
        self.velocity[MOST_KNOTS - 1] = [0.0; N];
    }
}

/// No less than the largest eigenvalue of G'G + W: the largest sum of a row of |G'G|, and the most that the weights have.
fn curvature<const N: usize>(problem: &Problem<N>) -> f64 {
    let mut sums = [0.0; MOST_UNKNOWNS];
    let mut row = [0.0; MOST_UNKNOWNS];
    for knot in 0..problem.knots {
        let width = (knot + 1) * N;
        for direction in 0..N - 1 {
            problem.row(knot, direction, &mut row);
            let all: f64 = row[..width].iter().map(|felt| felt.abs()).sum();
            for (sum, felt) in sums.iter_mut().zip(&row[..width]) {
                *sum += felt.abs() * all;
            }
        }
    }
    let knots = problem.knots as f64;
    let along = problem.settings.tangential_price * problem.knot_s;
    let across = sums.iter().fold(0.0_f64, |most, sum| most.max(*sum));
    // The largest eigenvalue of a second difference is below 4.
    across + along * along * knots * knots + problem.settings.rate_weight + 4.0 * problem.settings.change_weight
}
