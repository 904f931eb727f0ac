//! One step of Gauss and Newton: the minimum of the linearised problem within the limits of the accelerations.
//!
//! ```text
//! minimise 1/2 da'(G'G + W) da + (G'r + W a)'da     -A <= a + da <= A
//! ```
//!
//! Source: Gauss-Newton with a fixed number of steps a tick as in Diehl, Bock and Schloeder (2005).

use super::interior_point::Quadratic;
use super::problem::{Problem, Row};
use super::{Accelerations, MOST_KNOTS, MOST_UNKNOWNS, Solver};
use crate::least_squares::BLOCK;
use crate::vector::add_scaled;

/// The normal equations of a tick. Kept between ticks so that none has to clear what it does not use.
#[derive(Debug, Clone, Default)]
pub struct GaussNewton {
    quadratic: Quadratic,
}

impl<const N: usize> Solver<N> for GaussNewton {
    fn improve(&mut self, problem: &Problem<N>, accelerations_mm_s2: &mut Accelerations<N>) {
        let unknowns = problem.unknowns();
        self.quadratic.clear(unknowns);
        self.add_errors(problem);
        self.add_speeds(problem, accelerations_mm_s2);
        let limits = &problem.settings.limits.acceleration_mm_s2;
        let (mut least, mut most) = ([0.0; MOST_UNKNOWNS], [0.0; MOST_UNKNOWNS]);
        for (i, now) in accelerations_mm_s2.as_flattened()[..unknowns].iter().enumerate() {
            (least[i], most[i]) = (-limits[i % N] - now, limits[i % N] - now);
        }
        let change = self.quadratic.minimum(&least, &most);
        for (i, now) in accelerations_mm_s2.as_flattened_mut()[..unknowns].iter_mut().enumerate() {
            *now += change[i];
        }
    }
}

impl GaussNewton {
    /// G'G and G'r, a block of rows of G at a time.
    fn add_errors<const N: usize>(&mut self, problem: &Problem<N>) {
        let mut rows: [Row; BLOCK] = [[0.0; MOST_UNKNOWNS]; BLOCK];
        let mut errors = [0.0; BLOCK];
        let (mut held, mut entries) = (0, 0);
        problem.rows(|knot, error, fill| {
            // Behind its entries a row of an earlier block has none either, and is zero: rows come in the order of the knots.
            fill(&mut rows[held]);
            errors[held] = error;
            entries = (knot + 1) * N;
            held += 1;
            if held == BLOCK {
                self.quadratic.add_rows(&rows, &errors, entries);
                held = 0;
            }
        });
        if held > 0 {
            for (row, error) in rows.iter_mut().zip(&mut errors).skip(held) {
                row.fill(0.0);
                *error = 0.0;
            }
            self.quadratic.add_rows(&rows, &errors, entries);
        }
    }

    /// W: the speed v_j of the offset after knot j is the same sum of accelerations for all m <= j.
    fn add_speeds<const N: usize>(&mut self, problem: &Problem<N>, accelerations_mm_s2: &Accelerations<N>) {
        let (knots, knot_s) = (problem.knots, problem.knot_s);
        let change = problem.settings.change_weight * knot_s * knot_s;
        let rate = problem.settings.rate_weight * knot_s;
        let mut sum_mm_s = [[0.0; N]; MOST_KNOTS];
        for knot in (0..knots).rev() {
            let later = if knot + 1 < knots { sum_mm_s[knot + 1] } else { [0.0; N] };
            sum_mm_s[knot] = add_scaled(later, 1.0, problem.ends[knot].offset_mm_s);
        }
        for r in 0..knots {
            let further = rate * knot_s * (knots - r) as f64;
            for axis in 0..N {
                let slope = rate * sum_mm_s[r][axis] + change * accelerations_mm_s2[r][axis];
                self.quadratic.add_gradient(r * N + axis, slope);
                self.quadratic.add(r * N + axis, r * N + axis, change);
                for c in 0..=r {
                    self.quadratic.add(r * N + axis, c * N + axis, further);
                }
            }
        }
    }
}
