//! Speeds of least time at evenly spaced places of a path. Errors that are linear in the squares of
//! the speeds stay within the allowed errors.
//!
//! ```text
//! min sum_i 2 d / (v_i + v_(i+1))  +  P sum_i h_i max(0, |e_i| / aim_i - 1)^2  +  W sum_i h_i (q_i / q0_i - 1)^2
//! e_i = e0_i + sum_j s_ij (q_j - q0_j)        q = v^2
//! ```
//!
//! where d is the spacing and h_i the time of a place in the last cut. The problem is convex in q;
//! the solver is Newton's method with a matrix of two off-diagonals. The last term keeps the speeds
//! near those at which the errors were measured.

use super::error_model::{ErrorModel, at};

/// P. At the optimum, a relative change of an error is worth `1 / 2` of it in time, so the allowed
/// error is exceeded by the fraction `1 / 4P`.
const EXCESS_WEIGHT: f64 = 100.0;

/// Least W at a place whose speed is held down by something other than these bounds: a higher bound
/// would have no effect there.
const HELD: f64 = 2.0;

/// Largest number of Newton steps, the least gain of one, s, and the largest number of times that a
/// step is halved.
const STEPS: u32 = 60;
const LEAST_GAIN_S: f64 = 1e-9;
const HALVED: u32 = 20;

/// A step reduces a squared speed to no less than this fraction of itself.
const LEAST_PART: f64 = 0.3;

/// Off-diagonals of the matrix.
const BAND: usize = 2;

/// The optimization problem.
#[derive(Debug)]
pub(super) struct SpeedProfile<'a> {
    pub(super) spacing_mm: f64,
    /// Squares of the speeds of the cut, (mm/s)^2, and their lower limit.
    pub(super) squares: &'a [f64],
    pub(super) least_square: f64,
    pub(super) model: &'a ErrorModel,
    /// Allowed errors, mm.
    pub(super) aims_mm: &'a [f64],
    /// True where something other than these bounds limits the speed.
    pub(super) held: &'a [bool],
    /// W.
    pub(super) near: f64,
}

impl SpeedProfile<'_> {
    /// Returns the squares of the speeds of least time.
    pub(super) fn solve(&self) -> Vec<f64> {
        let mut q: Vec<f64> = self
            .squares
            .iter()
            .map(|&square| square.max(self.least_square))
            .collect();
        let mut cost_s = self.cost_s(&q);
        for _ in 0..STEPS {
            let (mut matrix, mut step) = self.newton(&q);
            matrix.solve(&mut step);
            let largest = q.iter().zip(&step).filter(|(_, d)| **d < 0.0);
            let mut part = largest.fold(1.0_f64, |part, (q, d)| {
                part.min((1.0 - LEAST_PART) * q / -d)
            });
            let mut gain_s = 0.0;
            for _ in 0..HALVED {
                let next: Vec<f64> = q
                    .iter()
                    .zip(&step)
                    .map(|(q, d)| (q + part * d).max(self.least_square))
                    .collect();
                let next_s = self.cost_s(&next);
                if next_s < cost_s {
                    gain_s = cost_s - next_s;
                    (q, cost_s) = (next, next_s);
                    break;
                }
                part *= 0.5;
            }
            if gain_s < LEAST_GAIN_S {
                break;
            }
        }
        q
    }

    fn base(&self, i: usize) -> f64 {
        self.squares[i].max(self.least_square)
    }

    /// Returns the time that a place represents, s.
    fn time_s(&self, i: usize) -> f64 {
        self.spacing_mm / self.base(i).sqrt()
    }

    fn near(&self, i: usize, q: f64) -> f64 {
        if self.held[i] && q > self.base(i) {
            self.near.max(HELD)
        } else {
            self.near
        }
    }

    /// Returns the fraction by which an error exceeds the allowed error, with the sign of the
    /// error.
    fn beyond(&self, i: usize, q: &[f64]) -> f64 {
        let change = &self.model.changes[i];
        let error_mm = self.model.errors_mm[i] + at(change, i, q) - at(change, i, self.squares);
        (error_mm.abs() / self.aims_mm[i] - 1.0)
            .max(0.0)
            .copysign(error_mm)
    }

    fn cost_s(&self, q: &[f64]) -> f64 {
        let speeds: Vec<f64> = q.iter().map(|q| q.sqrt()).collect();
        let time_s: f64 = speeds
            .windows(2)
            .map(|pair| 2.0 * self.spacing_mm / (pair[0] + pair[1]))
            .sum();
        let penalties: f64 = (0..q.len())
            .map(|i| {
                let (beyond, moved) = (self.beyond(i, q), q[i] / self.base(i) - 1.0);
                self.time_s(i)
                    * (EXCESS_WEIGHT * beyond * beyond + self.near(i, q[i]) * moved * moved)
            })
            .sum();
        time_s + penalties
    }

    /// Returns the matrix and the right side of a Newton step.
    fn newton(&self, q: &[f64]) -> (BandMatrix, Vec<f64>) {
        let n = q.len();
        let (mut matrix, mut right) = (
            BandMatrix {
                rows: vec![[0.0; BAND + 1]; n],
            },
            vec![0.0; n],
        );
        for i in 0..n - 1 {
            self.add_time(i, q, &mut matrix, &mut right);
        }
        for i in 0..n {
            self.add_error(i, q, &mut matrix, &mut right);
            let (base, weight) = (self.base(i), 2.0 * self.time_s(i) * self.near(i, q[i]));
            right[i] -= weight * (q[i] / base - 1.0) / base;
            matrix.rows[i][0] += weight / (base * base);
        }
        // Places at rest stay at rest.
        for i in (0..n).filter(|&i| self.squares[i] <= self.least_square) {
            matrix.isolate(i);
            right[i] = 0.0;
        }
        (matrix, right)
    }

    /// Adds `2 d / (v + w)` with its derivatives by `v^2` and `w^2`.
    fn add_time(&self, i: usize, q: &[f64], matrix: &mut BandMatrix, right: &mut [f64]) {
        let [v, w] = [q[i].sqrt(), q[i + 1].sqrt()];
        let sum = v + w;
        let slope = self.spacing_mm / (sum * sum);
        right[i] += slope / v;
        right[i + 1] += slope / w;
        let bend = |v: f64| slope / (sum * v * v) + 0.5 * slope / (v * v * v);
        matrix.rows[i][0] += bend(v);
        matrix.rows[i + 1][0] += bend(w);
        matrix.rows[i][1] += slope / (sum * v * w);
    }

    fn add_error(&self, i: usize, q: &[f64], matrix: &mut BandMatrix, right: &mut [f64]) {
        let beyond = self.beyond(i, q);
        if beyond == 0.0 {
            return;
        }
        let weight = 2.0 * EXCESS_WEIGHT * self.time_s(i) / self.aims_mm[i];
        let change = &self.model.changes[i];
        let at = |part: usize| (i + part).saturating_sub(1).min(q.len() - 1);
        for first in 0..3 {
            right[at(first)] -= weight * beyond * change[first];
            for second in 0..3 {
                let (row, column) = (at(first), at(second));
                if column >= row {
                    matrix.rows[row][column - row] +=
                        weight / self.aims_mm[i] * change[first] * change[second];
                }
            }
        }
    }
}

/// A symmetric matrix: the diagonal of each row and the elements to its right.
#[derive(Debug)]
struct BandMatrix {
    rows: Vec<[f64; BAND + 1]>,
}

impl BandMatrix {
    /// Sets row `i` and its column to the row and the column of the identity matrix.
    fn isolate(&mut self, i: usize) {
        self.rows[i] = [1.0, 0.0, 0.0];
        for before in 1..=BAND.min(i) {
            self.rows[i - before][before] = 0.0;
        }
    }

    /// Solves for a right side, by elimination; the matrix is positive definite.
    fn solve(&mut self, right: &mut [f64]) {
        let n = right.len();
        for i in 0..n {
            let row = self.rows[i];
            for k in 1..=BAND.min(n - 1 - i) {
                let factor = row[k] / row[0];
                for m in k..=BAND {
                    self.rows[i + k][m - k] -= factor * row[m];
                }
                right[i + k] -= factor * right[i];
            }
        }
        for i in (0..n).rev() {
            let row = self.rows[i];
            let known: f64 = (1..=BAND.min(n - 1 - i))
                .map(|k| row[k] * right[i + k])
                .sum();
            right[i] = (right[i] - known) / row[0];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An error of `c v^2 / r` on a circle: the speed is `(aim r / c)^(1/2)` wherever a place is
    /// not near a rest.
    #[test]
    fn on_a_circle_the_speed_is_that_at_which_the_error_is_what_is_allowed() {
        let (n, curvature_1_mm, lag_s2, aim_mm) = (200, 0.1, 1e-4, 0.01);
        let change = lag_s2 * curvature_1_mm;
        let squares = vec![40.0 * 40.0; n];
        let model = ErrorModel {
            errors_mm: squares.iter().map(|q| change * q).collect(),
            changes: vec![[0.0, change, 0.0]; n],
        };
        let aims_mm = vec![aim_mm; n];
        let held = vec![false; n];
        let profile = SpeedProfile {
            spacing_mm: 0.1,
            squares: &squares,
            least_square: 1e-2,
            model: &model,
            aims_mm: &aims_mm,
            held: &held,
            near: 0.02,
        };
        for square in profile.solve() {
            let error_mm = change * square;
            assert!((error_mm / aim_mm - 1.0).abs() < 0.01, "{error_mm}");
        }
    }

    #[test]
    fn a_band_matrix_is_solved_as_its_whole_is() {
        let rows = vec![
            [4.0, 1.0, 0.5],
            [5.0, -1.0, 0.2],
            [3.0, 0.4, 0.0],
            [6.0, 0.0, 0.0],
        ];
        let whole = [
            [4.0, 1.0, 0.5, 0.0],
            [1.0, 5.0, -1.0, 0.2],
            [0.5, -1.0, 3.0, 0.4],
            [0.0, 0.2, 0.4, 6.0],
        ];
        let x = [1.0, -2.0, 3.0, 0.5];
        let mut right: Vec<f64> = whole
            .iter()
            .map(|row| row.iter().zip(x).map(|(a, b)| a * b).sum())
            .collect();
        BandMatrix { rows }.solve(&mut right);
        assert!(
            right.iter().zip(x).all(|(a, b)| (a - b).abs() < 1e-12),
            "{right:?}"
        );
    }
}
