//! Solves the problem of one tick exactly, as a linear-quadratic problem over time, by the Riccati
//! recursion.
//!
//! ```text
//! x(k+1) = A(k) x(k) + B(k) da(k)     x = e(k), e(k-1), F(k-1), F(k-2), o, v of each axis,
//!                                     as changes from the plan
//! F(k) = v(k) + T/2 da(k)     o(k+1) = o(k) + T v(k) + T^2/2 da(k)     v(k+1) = v(k) + T da(k)
//! V(k, x) = 1/2 x'P x + p'x           cost to go from knot k on
//! ```
//!
//! The backward pass adds the cost of the errors at the end of each knot. It passes the sum through
//! the dynamics and eliminates the optimal da. The forward pass computes each da from x. The work
//! grows linearly with the number of knots; the dense solution grows with its cube. The recursion
//! needs only the slopes of each knot, not the sensitivity of the tool to every earlier knot.
//!
//! A knot lasts one feed period, there are no limits, and every knot cuts.
//!
//! Source: Rao, Wright and Rawlings (1998), "Application of interior-point methods to model
//! predictive control", section 3.

use feedwright_control::{FEED_SCALE_MM_S, INPUTS};
use feedwright_lab::{Accelerations, END_WEIGHT, HorizonProblem, MAX_KNOTS};

use super::material::{Material, difference};
use super::model::Slopes;

/// Places of an axis in a vector: its state, and its input.
const PLACES: usize = 7;
const E: usize = 0;
const E_BEFORE: usize = 1;
const F: usize = 2;
const F_BEFORE: usize = 3;
const OFFSET: usize = 4;
const SPEED: usize = 5;
const INPUT: usize = 6;
/// Places of three axes.
const MAX_PLACES: usize = 3 * PLACES;

type Vector = [f64; MAX_PLACES];

/// Both solutions are exact but for rounding, which the condition of the equations makes larger: it
/// comes to 1.4e-9.
pub(crate) const AGREEMENT: f64 = 3e-9;

/// Returns the difference of the recursion and Gauss-Newton, as a share of the largest
/// acceleration.
pub(crate) fn apart_from_gauss_newton<const N: usize>(material: &Material<N>) -> f64 {
    let (problem, slopes) = material.roll_out();
    let recursion = material.after(&Riccati::default().solve(&problem, &slopes, &material.plan));
    difference(&material.improved(&problem), &recursion)
}

/// Gains and offsets that the recursion keeps from the backward pass for the forward pass: da = K x
/// + k.
pub(crate) struct Riccati<const N: usize> {
    gains: [[Vector; N]; MAX_KNOTS],
    offsets: [[f64; N]; MAX_KNOTS],
}

impl<const N: usize> Default for Riccati<N> {
    fn default() -> Self {
        Self {
            gains: [[[0.0; MAX_PLACES]; N]; MAX_KNOTS],
            offsets: [[0.0; N]; MAX_KNOTS],
        }
    }
}

impl<const N: usize> Riccati<N> {
    /// The change of the plan that solves the problem linearised about it, mm/s^2.
    pub(crate) fn solve(
        &mut self,
        problem: &HorizonProblem<N>,
        slopes: &Slopes<N>,
        plan: &Accelerations<N>,
    ) -> Accelerations<N> {
        self.back(problem, slopes, plan);
        self.forth(problem, slopes)
    }

    fn back(&mut self, problem: &HorizonProblem<N>, slopes: &Slopes<N>, plan: &Accelerations<N>) {
        let places = N * PLACES;
        let (mut square, mut line) = ([[0.0; MAX_PLACES]; MAX_PLACES], [0.0; MAX_PLACES]);
        for knot in (0..problem.knots).rev() {
            pay_errors(problem, knot, &mut square, &mut line);
            let step = PlanStep::new(&slopes[knot], problem.knot_s);
            // [A B]'P [A B], from one side, then from the other: P is symmetric.
            square[..places]
                .iter_mut()
                .for_each(|row| *row = step.pull(row));
            let mut turned = [[0.0; MAX_PLACES]; MAX_PLACES];
            for (place, row) in turned[..places].iter_mut().enumerate() {
                let column =
                    core::array::from_fn(|r| if r < places { square[r][place] } else { 0.0 });
                *row = step.pull(&column);
            }
            square = turned;
            line = step.pull(&line);
            pay_accelerations(problem, knot, plan, &mut square, &mut line);
            self.take_out(knot, &mut square, &mut line);
        }
    }

    /// Takes the input out: what is left belongs to the state, and the input follows from it.
    fn take_out(&mut self, knot: usize, square: &mut [Vector; MAX_PLACES], line: &mut Vector) {
        for axis in (0..N).rev() {
            let input = axis * PLACES + INPUT;
            let row = square[input];
            let reciprocal = 1.0 / row[input];
            let gain = row.map(|entry| -entry * reciprocal);
            let offset = -line[input] * reciprocal;
            for (place, factor) in gain[..N * PLACES].iter().enumerate() {
                line[place] += row[place] * offset;
                for (entry, other) in square[place][..N * PLACES].iter_mut().zip(&row) {
                    *entry += factor * other;
                }
            }
            // The inputs of the axes before this one come first on the way forth.
            (self.gains[knot][axis], self.offsets[knot][axis]) = (gain, offset);
            for place in 0..N * PLACES {
                (square[place][input], square[input][place]) = (0.0, 0.0);
            }
            line[input] = 0.0;
        }
    }

    fn forth(&self, problem: &HorizonProblem<N>, slopes: &Slopes<N>) -> Accelerations<N> {
        let mut changes = [[0.0; N]; MAX_KNOTS];
        let mut state = [0.0; MAX_PLACES];
        for knot in 0..problem.knots {
            for axis in 0..N {
                let input = axis * PLACES + INPUT;
                state[input] = 0.0;
                let gain = &self.gains[knot][axis];
                let moved: f64 = gain.iter().zip(&state).map(|(gain, x)| gain * x).sum();
                state[input] = moved + self.offsets[knot][axis];
                changes[knot][axis] = state[input];
            }
            state = PlanStep::new(&slopes[knot], problem.knot_s).push(&state);
        }
        changes
    }
}

/// Adds the cost of the errors and of the offset's speed at the end of a knot.
fn pay_errors<const N: usize>(
    problem: &HorizonProblem<N>,
    knot: usize,
    square: &mut [Vector; MAX_PLACES],
    line: &mut Vector,
) {
    let end = &problem.ends[knot];
    for (d, direction) in end.directions.iter().enumerate() {
        let weight = problem.error_weight(knot, d).powi(2);
        // The tool is at o - e.
        let ways = |axis: usize| {
            [
                (axis * PLACES + OFFSET, direction[axis]),
                (axis * PLACES + E, -direction[axis]),
            ]
        };
        for (r, way) in (0..N).flat_map(ways) {
            line[r] += weight * way * end.off_mm[d];
            for (c, other) in (0..N).flat_map(ways) {
                square[r][c] += weight * way * other;
            }
        }
    }
    let rate_weight = problem.settings.rate_weight;
    for axis in 0..N {
        let speed = axis * PLACES + SPEED;
        square[speed][speed] += rate_weight;
        line[speed] += rate_weight * end.offset_mm_s[axis];
    }
    if knot + 1 == problem.knots {
        pay_end(problem, square, line);
    }
}

/// Adds the cost of the offset behind the last knot: o + lag v.
fn pay_end<const N: usize>(
    problem: &HorizonProblem<N>,
    square: &mut [Vector; MAX_PLACES],
    line: &mut Vector,
) {
    let end = &problem.ends[problem.knots - 1];
    let weight = END_WEIGHT * END_WEIGHT;
    for axis in 0..N {
        let ways = [
            (axis * PLACES + OFFSET, 1.0),
            (axis * PLACES + SPEED, problem.lag_s),
        ];
        let behind_mm = end.offset_mm[axis] + problem.lag_s * end.offset_mm_s[axis];
        for (r, way) in ways {
            line[r] += weight * way * behind_mm;
            for (c, other) in ways {
                square[r][c] += weight * way * other;
            }
        }
    }
}

/// Adds the cost of the change of speed over a knot.
fn pay_accelerations<const N: usize>(
    problem: &HorizonProblem<N>,
    knot: usize,
    plan: &Accelerations<N>,
    square: &mut [Vector; MAX_PLACES],
    line: &mut Vector,
) {
    let weight = problem.settings.change_weight * problem.knot_s.powi(2);
    for axis in 0..N {
        let input = axis * PLACES + INPUT;
        square[input][input] += weight;
        line[input] += weight * plan[knot][axis];
    }
}

/// A(k) and B(k): one feed period of every axis, lengths in mm, speeds in mm/s, accelerations in
/// mm/s^2.
struct PlanStep<const N: usize> {
    /// Coefficients of F(k), F(k-1), F(k-2), e(k), e(k-1) in e(k+1).
    of: [[f64; INPUTS]; N],
    period_s: f64,
}

impl<const N: usize> PlanStep<N> {
    fn new(slopes: &[[f64; INPUTS]; N], period_s: f64) -> Self {
        let of = slopes.map(|[f0, f1, f2, e0, e1]| {
            let [f0, f1, f2] = [f0, f1, f2].map(|slope| slope / FEED_SCALE_MM_S);
            [f0, f1, f2, 1.0 + e0, e1]
        });
        Self { of, period_s }
    }

    /// `[A B]' v`.
    #[inline]
    fn pull(&self, v: &Vector) -> Vector {
        let mut pulled = [0.0; MAX_PLACES];
        for axis in 0..N {
            let [f0, f1, f2, e0, e1] = self.of[axis];
            let at = axis * PLACES;
            pulled[at + E] = e0 * v[at + E] + v[at + E_BEFORE];
            pulled[at + E_BEFORE] = e1 * v[at + E];
            pulled[at + F] = f1 * v[at + E] + v[at + F_BEFORE];
            pulled[at + F_BEFORE] = f2 * v[at + E];
            pulled[at + OFFSET] = v[at + OFFSET];
            let of_feed = f0 * v[at + E] + v[at + F] + self.period_s * v[at + OFFSET];
            pulled[at + SPEED] = of_feed + v[at + SPEED];
            pulled[at + INPUT] = 0.5 * self.period_s * of_feed + self.period_s * v[at + SPEED];
        }
        pulled
    }

    /// `A x + B da`.
    #[inline]
    fn push(&self, x: &Vector) -> Vector {
        let mut pushed = [0.0; MAX_PLACES];
        for axis in 0..N {
            let [f0, f1, f2, e0, e1] = self.of[axis];
            let at = axis * PLACES;
            let feed = x[at + SPEED] + 0.5 * self.period_s * x[at + INPUT];
            let inputs = [
                feed,
                x[at + F],
                x[at + F_BEFORE],
                x[at + E],
                x[at + E_BEFORE],
            ];
            pushed[at + E] = [f0, f1, f2, e0, e1]
                .iter()
                .zip(inputs)
                .map(|(of, x)| of * x)
                .sum();
            pushed[at + E_BEFORE] = x[at + E];
            pushed[at + F] = feed;
            pushed[at + F_BEFORE] = x[at + F];
            pushed[at + OFFSET] = x[at + OFFSET] + self.period_s * feed;
            pushed[at + SPEED] = x[at + SPEED] + self.period_s * x[at + INPUT];
        }
        pushed
    }
}
