//! The receding-horizon inversion: one Gauss-Newton step on the offset rates of all knots of the horizon.
//!
//! With the rates u_j of the command's offset from the path as the unknowns, in all axes, the plan is rolled out through a
//! [`Model`] of the machine (the servo identifier), the contour error of every predicted tool position is exact geometry,
//! and
//!
//! ```text
//! J(u) = 1/2 sum_i |eps_i(u)|^2 + h^2/2 sum_i (t_i . o_i(u))^2 + w/2 sum_j |u_j|^2 + d/2 sum_j |u_j - u_{j-1}|^2
//! ```
//!
//! is minimised by one step of Gauss and Newton from last tick's plan, shifted. The derivative of eps_i to u_j is
//! n_i . R(i - j), where R(m) is the response of the tool, m knots later, to a feedrate of 1 for one knot, the same for all
//! knots of a tick. Along the path an offset only shifts the tool in time, but for corners, where it makes the command turn
//! earlier or later; h is its price, so that nothing drifts and no time is bought or sold.
//!
//! Source: the performance index is Lee, Cho and Jeon (2005), eq. 7, summed over a horizon; receding horizon as in Richalet
//! et al. (1978), Gauss-Newton with a fixed number of steps a tick as in Diehl, Bock and Schloeder (2005).
//!
//! Everything is of fixed size: at most [`MOST_KNOTS`] knots, N unknowns each.

use crate::contour_error::locate;
use crate::least_squares::cholesky;
use crate::vector::{add_scaled, dot, norm, reject, scale};
use crate::window::Window;

/// Most knots of a horizon.
pub const MOST_KNOTS: usize = 20;
/// Most axes.
const MOST_AXES: usize = 3;
/// Most unknowns.
const MOST_UNKNOWNS: usize = MOST_KNOTS * MOST_AXES;

/// The search for the nearest points starts where the tool is now and goes over to where the model has it in the long run,
/// s: a model that is wrong about the lag then misleads late in the horizon only.
const BELIEVED_AFTER_S: f64 = 0.1;

/// Settings of the inversion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Knots of the horizon; 1 to [`MOST_KNOTS`].
    pub knots: usize,
    /// w: weight of the offset rates, s^2. Smaller is sharper; below 1e-9 the least squares become singular, above
    /// 1e-4 nothing is corrected.
    pub rate_weight: f64,
    /// d: weight of the change of the offset rates from knot to knot, s^2.
    pub change_weight: f64,
    /// h: price of an offset along the path against a contour error of the same size; 0.001 to 1.
    pub tangential_price: f64,
    /// Largest offset rate of an axis, mm/s.
    pub rate_limit_mm_s: f64,
}

/// A plan: the offset rate of each knot of the horizon, mm/s.
#[derive(Debug, Clone)]
pub struct Plan<const N: usize> {
    rates: [[f64; N]; MOST_KNOTS],
    normal: Normal,
}

impl<const N: usize> Default for Plan<N> {
    fn default() -> Self {
        Self { rates: [[0.0; N]; MOST_KNOTS], normal: Normal::EMPTY }
    }
}

/// R(m) for all knots of a horizon: displacement of the tool, mm, m knots after a feedrate of 1 mm/s along an axis for
/// one knot, indexed by m, axis of the tool and axis of the feedrate.
pub type Response<const N: usize> = [[[f64; N]; N]; MOST_KNOTS];

/// What predicts the tool: a model of the machine, with its state at the current knot.
pub trait Model<const N: usize>: Clone {
    /// How far the tool is behind the command, s: where the search for the nearest points starts.
    fn lag_s(&self) -> f64;
    /// Moves on by one feed period; the tool at its end, mm.
    fn advance(&mut self, window: &Window<'_, N>, stretch: &Stretch<N>) -> [f64; N];
    /// R(m) of the first `knots` knots.
    fn response(&self, period_s: f64, knots: usize) -> Response<N>;
}

/// What is commanded in a feed period of the horizon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch<const N: usize> {
    /// Its number, from 0.
    pub knot: usize,
    /// Command at its start and end, mm.
    pub command_mm: [[f64; N]; 2],
    /// Offset from the path at its start and end, mm.
    pub offset_mm: [[f64; N]; 2],
}

/// The first step of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<const N: usize> {
    /// Offset at the next knot, mm.
    pub offset_mm: [f64; N],
    /// Largest change of an offset rate in this step, mm/s.
    pub change_mm_s: f64,
}

/// The predictions along a plan.
struct Rollout<const N: usize> {
    /// Rows of the least squares at each knot: directions in which the tool is off, and by how much, mm. The last is along
    /// the path, and of the offset.
    directions: [[[f64; N]; N]; MOST_KNOTS],
    off_mm: [[f64; N]; MOST_KNOTS],
}

impl<const N: usize> Plan<N> {
    /// Forgets the plan.
    pub fn reset(&mut self) {
        self.rates = [[0.0; N]; MOST_KNOTS];
    }

    /// Improves last tick's plan by one step and returns its first command: call once a feed period. The tool is `lag_s`
    /// behind the command now.
    pub fn improve<M: Model<N>>(
        &mut self,
        model: &M,
        window: &Window<'_, N>,
        lag_s: f64,
        settings: &Settings,
    ) -> Step<N> {
        self.shift(settings.knots.clamp(1, MOST_KNOTS));
        self.improve_again(model, window, lag_s, settings)
    }

    /// One more step on the plan of this feed period.
    pub fn improve_again<M: Model<N>>(
        &mut self,
        model: &M,
        window: &Window<'_, N>,
        lag_s: f64,
        settings: &Settings,
    ) -> Step<N> {
        let knots = settings.knots.clamp(1, MOST_KNOTS);
        let rollout = self.roll_out(model, window, lag_s, knots);
        let response = model.response(window.feed_period_s, knots);
        let change = self.normal.solve(&rollout, &response, &self.rates, window.feed_period_s, knots, settings);
        let limit = settings.rate_limit_mm_s;
        let mut largest_mm_s = 0.0_f64;
        for (knot, rate) in self.rates.iter_mut().take(knots).enumerate() {
            for (axis, rate) in rate.iter_mut().enumerate() {
                let improved = *rate + change[knot * N + axis];
                let improved = if improved.is_finite() { improved.clamp(-limit, limit) } else { 0.0 };
                largest_mm_s = largest_mm_s.max((improved - *rate).abs());
                *rate = improved;
            }
        }
        let offset_mm = add_scaled(window.offset_mm, window.feed_period_s, self.rates[0]);
        Step { offset_mm, change_mm_s: largest_mm_s }
    }

    /// Last tick's second step becomes the first; the last is held.
    fn shift(&mut self, knots: usize) {
        self.rates.copy_within(1..knots, 0);
        self.rates[knots - 1] = [0.0; N];
    }

    fn roll_out<M: Model<N>>(&self, model: &M, window: &Window<'_, N>, lag_s: f64, knots: usize) -> Rollout<N> {
        let period_s = window.feed_period_s;
        let mut rollout = Rollout { directions: [[[0.0; N]; N]; MOST_KNOTS], off_mm: [[0.0; N]; MOST_KNOTS] };
        let mut model = model.clone();
        let model_lag_s = model.lag_s();
        let mut offset_mm = window.offset_mm;
        let mut command_mm = add_scaled(window.now().position_mm, 1.0, offset_mm);
        for i in 0..knots {
            let knot = window.ahead(i + 1);
            let next_offset_mm = add_scaled(offset_mm, period_s, self.rates[i]);
            let next_mm = add_scaled(knot.position_mm, 1.0, next_offset_mm);
            let stretch =
                Stretch { knot: i, command_mm: [command_mm, next_mm], offset_mm: [offset_mm, next_offset_mm] };
            let tool_mm = model.advance(window, &stretch);
            (offset_mm, command_mm) = (next_offset_mm, next_mm);
            let ahead_s = (i + 1) as f64 * period_s;
            let behind_s = ahead_s - lag_s - (model_lag_s - lag_s) * (ahead_s / BELIEVED_AFTER_S).min(1.0);
            let contour = locate(window, tool_mm, libm::round(behind_s / window.servo_s()) as i32);
            let normals = normals_of(contour.tangent);
            for row in 0..N - 1 {
                rollout.directions[i][row] = normals[row];
                rollout.off_mm[i][row] = -dot(contour.vector_mm, normals[row]);
            }
            rollout.directions[i][N - 1] = knot.tangent;
            rollout.off_mm[i][N - 1] = dot(offset_mm, knot.tangent);
        }
        rollout
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

/// The least squares of a tick. Part of the plan, so that no tick has to clear it: only its lower half is used, and of that
/// what the horizon needs.
#[derive(Debug, Clone)]
struct Normal {
    matrix: [[f64; MOST_UNKNOWNS]; MOST_UNKNOWNS],
    right: [f64; MOST_UNKNOWNS],
}

impl Normal {
    const EMPTY: Self = Self { matrix: [[0.0; MOST_UNKNOWNS]; MOST_UNKNOWNS], right: [0.0; MOST_UNKNOWNS] };

    /// The step of Gauss and Newton: (G'G + W) du = -G' off - W u, by Cholesky's factorisation in place.
    fn solve<const N: usize>(
        &mut self,
        rollout: &Rollout<N>,
        response: &Response<N>,
        rates: &[[f64; N]; MOST_KNOTS],
        period_s: f64,
        knots: usize,
        settings: &Settings,
    ) -> &[f64; MOST_UNKNOWNS] {
        let unknowns = knots * N;
        for r in 0..unknowns {
            self.matrix[r][..=r].fill(0.0);
        }
        self.right[..unknowns].fill(0.0);
        self.add_across(rollout, response, knots);
        self.add_along(rollout, settings.tangential_price * period_s, settings.tangential_price, knots);
        self.add_weights(rates, knots, settings);
        cholesky(&mut self.matrix, &mut self.right, unknowns);
        &self.right
    }

    /// Row by row of G: the contour error at knot i feels the rates of knots 0..=i.
    fn add_across<const N: usize>(&mut self, rollout: &Rollout<N>, response: &Response<N>, knots: usize) {
        let mut row = [0.0; MOST_UNKNOWNS];
        for i in 0..knots {
            let width = (i + 1) * N;
            for d in 0..N - 1 {
                let direction = rollout.directions[i][d];
                for j in 0..=i {
                    for axis in 0..N {
                        let mut felt = 0.0;
                        for tool in 0..N {
                            felt += direction[tool] * response[i - j][tool][axis];
                        }
                        row[j * N + axis] = felt;
                    }
                }
                let off_mm = rollout.off_mm[i][d];
                for r in 0..width {
                    self.right[r] -= row[r] * off_mm;
                    let factor = row[r];
                    for (m, felt) in self.matrix[r][..=r].iter_mut().zip(&row[..=r]) {
                        *m += factor * felt;
                    }
                }
            }
        }
    }

    /// The part of the offset along the path at knot i is the same sum of rates for all j <= i: what knots from m on add is
    /// one small matrix.
    fn add_along<const N: usize>(&mut self, rollout: &Rollout<N>, gain: f64, price: f64, knots: usize) {
        let mut square = [[0.0; N]; N];
        let mut right = [0.0; N];
        for m in (0..knots).rev() {
            let (tangent, off_mm) = (rollout.directions[m][N - 1], rollout.off_mm[m][N - 1]);
            for a in 0..N {
                for b in 0..N {
                    square[a][b] += gain * gain * tangent[a] * tangent[b];
                }
                right[a] -= gain * tangent[a] * price * off_mm;
            }
            for a in 0..N {
                let r = m * N + a;
                self.right[r] += right[a];
                for c in 0..=r {
                    self.matrix[r][c] += square[a][c % N];
                }
            }
        }
    }

    fn add_weights<const N: usize>(&mut self, rates: &[[f64; N]; MOST_KNOTS], knots: usize, settings: &Settings) {
        let rate = |unknown: usize| rates[unknown / N][unknown % N];
        for r in 0..knots * N {
            self.matrix[r][r] += settings.rate_weight;
            self.right[r] -= settings.rate_weight * rate(r);
            if r >= N {
                let w = settings.change_weight;
                self.matrix[r][r] += w;
                self.matrix[r - N][r - N] += w;
                self.matrix[r][r - N] -= w;
                let change = w * (rate(r) - rate(r - N));
                self.right[r] -= change;
                self.right[r - N] += change;
            }
        }
    }
}
