//! What a tick has to solve: the predictions along a plan, and their derivative.
//!
//! Linearised about the plan, with G the derivative of the errors to all rates, r the errors themselves and W the weights,
//!
//! ```text
//! J(u + du) = 1/2 |r + G du|^2 + 1/2 (u + du)' W (u + du)
//! ```

use super::{Felt, MOST_KNOTS, MOST_UNKNOWNS, Model, Rates, Settings, Stretch};
use crate::contour_error::locate;
use crate::vector::{add_scaled, dot, norm, reject, scale};
use crate::window::Window;

/// The search for the nearest points starts where the tool is now and goes over to where the model has it in the long run,
/// s: a model that is wrong about the lag then misleads late in the horizon only. It reaches as far to both sides as the tool
/// lags: where the command stops, so much of the path is run in the last of the lag.
const BELIEVED_AFTER_S: f64 = 0.1;

/// The problem of a tick.
#[derive(Debug, Clone)]
pub struct Problem<const N: usize> {
    /// Knots of the horizon.
    pub knots: usize,
    /// Time of a knot, s.
    pub knot_s: f64,
    /// Directions in which the tool is off at the end of each knot, N - 1 normals of the path; the last is along the path,
    /// and of the offset.
    pub directions: [[[f64; N]; N]; MOST_KNOTS],
    /// By how much, mm.
    pub off_mm: [[f64; N]; MOST_KNOTS],
    /// Derivative of the tool to the rates, s.
    pub felt: [Felt<N>; MOST_KNOTS],
    /// The settings.
    pub settings: Settings,
}

impl<const N: usize> Problem<N> {
    /// Rolls a plan out through a model. The tool is `lag_s` behind the command now.
    pub fn new<M: Model<N>>(
        model: &M,
        window: &Window<'_, N>,
        lag_s: f64,
        rates: &Rates<N>,
        periods: usize,
        settings: &Settings,
    ) -> Self {
        let period_s = window.feed_period_s;
        let knots = settings.knots.clamp(1, MOST_KNOTS);
        let mut problem = Self {
            knots,
            knot_s: periods as f64 * period_s,
            directions: [[[0.0; N]; N]; MOST_KNOTS],
            off_mm: [[0.0; N]; MOST_KNOTS],
            felt: [[[0.0; N]; MOST_KNOTS]; MOST_KNOTS],
            settings: *settings,
        };
        let mut model = model.clone();
        let model_lag_s = model.lag_s();
        let mut stretch = Stretch {
            period: 0,
            periods_per_knot: periods,
            command_mm: [add_scaled(window.now().position_mm, 1.0, window.offset_mm); 2],
            offset_mm: [window.offset_mm; 2],
        };
        for knot in 0..knots {
            let mut tool_mm = [0.0; N];
            let mut ahead = window.now();
            for _ in 0..periods {
                ahead = window.ahead(stretch.period + 1);
                let offset_mm = add_scaled(stretch.offset_mm[1], period_s, rates[knot]);
                stretch.offset_mm = [stretch.offset_mm[1], offset_mm];
                stretch.command_mm = [stretch.command_mm[1], add_scaled(ahead.position_mm, 1.0, offset_mm)];
                tool_mm = model.advance(window, &stretch, &mut problem.felt[knot]);
                stretch.period += 1;
            }
            let ahead_s = stretch.period as f64 * period_s;
            let behind_s = ahead_s - lag_s - (model_lag_s - lag_s) * (ahead_s / BELIEVED_AFTER_S).min(1.0);
            let reach = (lag_s.max(model_lag_s) / window.servo_s()) as i32;
            let contour = locate(window, tool_mm, libm::round(behind_s / window.servo_s()) as i32, reach);
            let normals = normals_of(contour.tangent);
            for row in 0..N - 1 {
                problem.directions[knot][row] = normals[row];
                problem.off_mm[knot][row] = -dot(contour.vector_mm, normals[row]);
            }
            problem.directions[knot][N - 1] = ahead.tangent;
            problem.off_mm[knot][N - 1] = dot(stretch.offset_mm[1], ahead.tangent);
        }
        problem
    }

    /// Unknowns.
    pub fn unknowns(&self) -> usize {
        self.knots * N
    }

    /// The row of G that belongs to a direction of a knot: the contour error there feels the rates of the knots so far. The
    /// number of its entries is `(knot + 1) * N`.
    #[inline]
    pub fn row(&self, knot: usize, direction: usize, row: &mut [f64; MOST_UNKNOWNS]) {
        let direction = self.directions[knot][direction];
        for j in 0..=knot {
            for axis in 0..N {
                row[j * N + axis] = direction[axis] * self.felt[knot][j][axis];
            }
        }
    }

    /// By how much the tool and the offset are off after a change of the rates, linearised, mm.
    pub fn off_after_mm(&self, change: &Rates<N>) -> [[f64; N]; MOST_KNOTS] {
        let mut off_mm = self.off_mm;
        let mut offset_mm = [0.0; N];
        for knot in 0..self.knots {
            let mut tool_mm = [0.0; N];
            for (felt, change) in self.felt[knot].iter().zip(change).take(knot + 1) {
                for axis in 0..N {
                    tool_mm[axis] += felt[axis] * change[axis];
                }
            }
            offset_mm = add_scaled(offset_mm, self.knot_s, change[knot]);
            for d in 0..N {
                let moved_mm = if d < N - 1 { tool_mm } else { offset_mm };
                off_mm[knot][d] += dot(self.directions[knot][d], moved_mm);
            }
        }
        off_mm
    }

    /// dJ/du at the plan.
    pub fn gradient(&self, rates: &Rates<N>) -> Rates<N> {
        self.gradient_at(rates, &self.off_mm)
    }

    /// dJ/du of the linearised problem at these rates, where the tool and the offset are off by `off_mm`.
    pub fn gradient_at(&self, rates: &Rates<N>, off_mm: &[[f64; N]; MOST_KNOTS]) -> Rates<N> {
        let mut gradient = self.weighted(rates);
        let mut row = [0.0; MOST_UNKNOWNS];
        let price = self.settings.tangential_price;
        for knot in 0..self.knots {
            for d in 0..N - 1 {
                self.row(knot, d, &mut row);
                for (g, felt) in gradient.as_flattened_mut().iter_mut().zip(&row[..(knot + 1) * N]) {
                    *g += felt * off_mm[knot][d];
                }
            }
            let along = price * price * self.knot_s * off_mm[knot][N - 1];
            for j in 0..=knot {
                gradient[j] = add_scaled(gradient[j], along, self.directions[knot][N - 1]);
            }
        }
        gradient
    }

    /// W u.
    fn weighted(&self, rates: &Rates<N>) -> Rates<N> {
        let Settings { rate_weight, change_weight, .. } = self.settings;
        let mut weighted = [[0.0; N]; MOST_KNOTS];
        for knot in 0..self.knots {
            weighted[knot] = add_scaled(weighted[knot], rate_weight, rates[knot]);
            if knot > 0 {
                let change = add_scaled(rates[knot], -1.0, rates[knot - 1]);
                weighted[knot] = add_scaled(weighted[knot], change_weight, change);
                weighted[knot - 1] = add_scaled(weighted[knot - 1], -change_weight, change);
            }
        }
        weighted
    }
}

/// The normals of a tangent: the left one in the plane; in space the one nearest to an axis, and the one across both. The
/// last row is not used.
fn normals_of<const N: usize>(tangent: [f64; N]) -> [[f64; N]; N] {
    let mut normals = [[0.0; N]; N];
    if N == 2 {
        (normals[0][0], normals[0][1]) = (-tangent[1], tangent[0]);
        return normals;
    }
    // The axis that the path runs least along.
    let least = (0..N).fold(0, |best, i| if tangent[i].abs() < tangent[best].abs() { i } else { best });
    let mut axis = [0.0; N];
    axis[least] = 1.0;
    let first = reject(axis, tangent);
    let first = scale(1.0 / norm(first), first);
    normals[0] = first;
    normals[1] = core::array::from_fn(|i| {
        let (j, k) = ((i + 1) % N, (i + 2) % N);
        tangent[j] * first[k] - tangent[k] * first[j]
    });
    normals
}
