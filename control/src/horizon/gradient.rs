//! Gradient with momentum: the paper's way, over a horizon. Kept as the measure of [`super::gauss_newton`].
//!
//! ```text
//! v <- mu v - D^-1 dJ/du / knots      u <- u + v      D: the blocks of G'G + W, one for each knot
//! ```
//!
//! One step size for all rates does not serve: along the path J curves by the square of the price alone, a millionth of what
//! it does across, and an offset stays where a corner has left it. With D each knot has the step that is right for it alone.
//! For all together it is too long by their number at most, since x'Ax <= knots sum_k x_k'A_kk x_k where A is positive.
//!
//! The velocity starts from rest in each tick. Kept from tick to tick, it makes the loop swing.
//!
//! Source: gradient steps on the performance index as in Lee, Cho and Jeon (2005), eq. 8; momentum, Polyak (1964); scaling by
//! the diagonal blocks, Jacobi's method.

use super::problem::Problem;
use super::{MOST_KNOTS, Rates, Solver};
use crate::least_squares::inverse;
use crate::vector::{add_scaled, dot, scale};

/// mu. At 0.6 twenty steps get less far; at 0.9 five steps that are longer by 0.4 make the loop swing, at 0.8 they do not.
const MOMENTUM: f64 = 0.8;

/// So many steps of the gradient at a time, on the problem linearised once.
#[derive(Debug, Clone, Copy, Default)]
pub struct Gradient<const STEPS: usize = 1>;

impl<const N: usize, const STEPS: usize> Solver<N> for Gradient<STEPS> {
    fn improve(&mut self, problem: &Problem<N>, rates: &mut Rates<N>) {
        let inverse = inverse_blocks(problem);
        let step = 1.0 / problem.knots as f64;
        let (mut velocity, mut change) = ([[0.0; N]; MOST_KNOTS], [[0.0; N]; MOST_KNOTS]);
        let mut off_mm = problem.off_mm;
        for taken in 0..STEPS {
            if taken > 0 {
                off_mm = problem.off_after_mm(&change);
            }
            let gradient = problem.gradient_at(rates, &off_mm);
            for knot in 0..problem.knots {
                let scaled = inverse[knot].map(|row| dot(row, gradient[knot]));
                velocity[knot] = add_scaled(scale(MOMENTUM, velocity[knot]), -step, scaled);
                change[knot] = add_scaled(change[knot], 1.0, velocity[knot]);
                rates[knot] = add_scaled(rates[knot], 1.0, velocity[knot]);
            }
        }
    }
}

/// D^-1. A block is what J curves where the rates of its knot alone change.
fn inverse_blocks<const N: usize>(problem: &Problem<N>) -> [[[f64; N]; N]; MOST_KNOTS] {
    let mut blocks = [[[0.0; N]; N]; MOST_KNOTS];
    let settings = &problem.settings;
    let gain = settings.tangential_price * problem.knot_s;
    let mut along = [[0.0; N]; N];
    for knot in (0..problem.knots).rev() {
        for direction in &problem.directions[knot][..N - 1] {
            for (block, felt) in blocks.iter_mut().zip(&problem.felt[knot]).take(knot + 1) {
                let row: [f64; N] = core::array::from_fn(|axis| direction[axis] * felt[axis]);
                for a in 0..N {
                    block[a] = add_scaled(block[a], row[a], row);
                }
            }
        }
        // The offset along the path is the same sum of rates for all knots so far, and no later knot adds to this block.
        let tangent = problem.directions[knot][N - 1];
        for a in 0..N {
            along[a] = add_scaled(along[a], gain * gain * tangent[a], tangent);
            blocks[knot][a] = add_scaled(blocks[knot][a], 1.0, along[a]);
            blocks[knot][a][a] += settings.rate_weight + 2.0 * settings.change_weight;
        }
    }
    for block in &mut blocks[..problem.knots] {
        *block = inverse(block, 1.0);
    }
    blocks
}
