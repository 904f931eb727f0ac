//! The receding-horizon inversion: one Gauss-Newton step on the offset rates of all knots of the horizon.
//!
//! With the rates u_j of the command's offset across the path as the unknowns (one normal in the plane, two in space),
//! the plan is rolled out through a [`Model`] of the machine (the servo identifier), the contour error of every predicted tool position is exact
//! geometry, and
//!
//! ```text
//! J(u) = 1/2 sum_i |eps_i(u)|^2 + w/2 sum_j |u_j|^2 + d/2 sum_j |u_j - u_{j-1}|^2
//! ```
//!
//! is minimised by one step of Gauss and Newton from last tick's plan, shifted. The derivative of eps_i to u_j is
//! n_i . R(i - j) n_j, where R(m) is the response of the tool, m knots later, to a feedrate of 1 for one knot: the
//! same for all knots of a tick. The tangential direction belongs to the feed.
//!
//! Source: the performance index is Lee, Cho and Jeon (2005), eq. 7, summed over a horizon; receding horizon as in Richalet
//! et al. (1978), Gauss-Newton with a fixed number of steps a tick as in Diehl, Bock and Schloeder (2005).
//!
//! Everything is of fixed size: at most [`MOST_KNOTS`] knots, N - 1 unknowns each.

use crate::contour_error::locate;
use crate::least_squares::cholesky;
use crate::vector::{add_scaled, dot, norm, reject, scale};
use crate::window::Window;

/// Most knots of a horizon.
pub const MOST_KNOTS: usize = 20;
/// Most normals of a path: one in the plane, two in space.
const MOST_NORMALS: usize = 2;
/// Most unknowns.
const MOST_UNKNOWNS: usize = MOST_KNOTS * MOST_NORMALS;

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
    /// Largest offset rate, mm/s.
    pub rate_limit_mm_s: f64,
}

/// A plan: the offset rate of each knot of the horizon, on the normals of that knot.
#[derive(Debug, Clone)]
pub struct Plan<const N: usize> {
    rates: [f64; MOST_UNKNOWNS],
    /// The first normal of the current knot: carried along the path, so that it turns as little as it can.
    normal: [f64; N],
}

impl<const N: usize> Default for Plan<N> {
    fn default() -> Self {
        Self { rates: [0.0; MOST_UNKNOWNS], normal: [0.0; N] }
    }
}

/// R(m) for all knots of a horizon: displacement of the tool, mm, m knots after a feedrate of 1 mm/s along an axis for
/// one knot: [m][tool][feed].
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

/// Normals of a knot; the second is zero in the plane.
type Normals<const N: usize> = [[f64; N]; MOST_NORMALS];

/// The predictions along a plan.
struct Rollout<const N: usize> {
    /// Components of the contour error across the path, tool minus path, mm: [knot][normal].
    error: [[f64; MOST_NORMALS]; MOST_KNOTS],
    /// Normals at the nearest points.
    at_foot: [Normals<N>; MOST_KNOTS],
    /// Normals along which the offset moves in each step.
    at_knot: [Normals<N>; MOST_KNOTS],
}

impl<const N: usize> Plan<N> {
    /// Forgets the plan.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Improves last tick's plan by one step and returns its first command: call once a feed period.
    pub fn improve<M: Model<N>>(&mut self, model: &M, window: &Window<'_, N>, settings: &Settings) -> Step<N> {
        self.shift(settings.knots.clamp(1, MOST_KNOTS));
        self.improve_again(model, window, settings)
    }

    /// One more step on the plan of this feed period.
    pub fn improve_again<M: Model<N>>(&mut self, model: &M, window: &Window<'_, N>, settings: &Settings) -> Step<N> {
        let knots = settings.knots.clamp(1, MOST_KNOTS);
        let rollout = self.roll_out(model, window, knots);
        let response = model.response(window.feed_period_s, knots);
        let change = solve::<N>(&rollout, &response, &self.rates, knots, settings);
        let limit = settings.rate_limit_mm_s;
        let mut largest_mm_s = 0.0_f64;
        for (rate, change) in self.rates.iter_mut().zip(change).take(knots * normals::<N>()) {
            let improved = *rate + change;
            let improved = if improved.is_finite() { improved.clamp(-limit, limit) } else { 0.0 };
            largest_mm_s = largest_mm_s.max((improved - *rate).abs());
            *rate = improved;
        }
        let offset_mm = self.moved(window.offset_mm, &rollout.at_knot[0], 0, window.feed_period_s);
        self.normal = rollout.at_knot[0][0];
        Step { offset_mm, change_mm_s: largest_mm_s }
    }

    /// Last tick's second step becomes the first; the last is held.
    fn shift(&mut self, knots: usize) {
        let n = normals::<N>();
        self.rates.copy_within(n..knots * n, 0);
        for normal in 0..n {
            self.rates[(knots - 1) * n + normal] = 0.0;
        }
    }

    /// The offset after one step of the plan, mm.
    fn moved(&self, offset_mm: [f64; N], along: &Normals<N>, knot: usize, period_s: f64) -> [f64; N] {
        let n = normals::<N>();
        (0..n).fold(offset_mm, |o, normal| add_scaled(o, period_s * self.rates[knot * n + normal], along[normal]))
    }

    fn roll_out<M: Model<N>>(&self, model: &M, window: &Window<'_, N>, knots: usize) -> Rollout<N> {
        let period_s = window.feed_period_s;
        let mut rollout = Rollout {
            error: [[0.0; MOST_NORMALS]; MOST_KNOTS],
            at_foot: [[[0.0; N]; MOST_NORMALS]; MOST_KNOTS],
            at_knot: [[[0.0; N]; MOST_NORMALS]; MOST_KNOTS],
        };
        let mut model = model.clone();
        let mut offset_mm = window.offset_mm;
        let mut command_mm = add_scaled(window.now().position_mm, 1.0, offset_mm);
        let mut normal = self.normal;
        for i in 0..knots {
            let knot = window.ahead(i + 1);
            rollout.at_knot[i] = normals_of(knot.tangent, normal);
            normal = rollout.at_knot[i][0];
            let next_offset_mm = self.moved(offset_mm, &rollout.at_knot[i], i, period_s);
            let next_mm = add_scaled(knot.position_mm, 1.0, next_offset_mm);
            let stretch =
                Stretch { knot: i, command_mm: [command_mm, next_mm], offset_mm: [offset_mm, next_offset_mm] };
            let tool_mm = model.advance(window, &stretch);
            (offset_mm, command_mm) = (next_offset_mm, next_mm);
            let behind_s = (i + 1) as f64 * period_s - model.lag_s();
            let contour = locate(window, tool_mm, libm::round(behind_s / window.servo_s()) as i32);
            rollout.at_foot[i] = normals_of(contour.tangent, normal);
            rollout.error[i] = core::array::from_fn(|d| -dot(contour.vector_mm, rollout.at_foot[i][d]));
        }
        rollout
    }
}

/// Normals of a path in N axes.
const fn normals<const N: usize>() -> usize {
    if N == 2 { 1 } else { MOST_NORMALS }
}

/// The normals of a tangent: the left one in the plane; in space the one nearest to `hint`, and the one across both.
fn normals_of<const N: usize>(tangent: [f64; N], hint: [f64; N]) -> Normals<N> {
    let mut first = [0.0; N];
    if N == 2 {
        (first[0], first[1]) = (-tangent[1], tangent[0]);
        return [first, [0.0; N]];
    }
    first = reject(hint, tangent);
    let mut length = norm(first);
    if length < 0.1 {
        // No hint, or along the path: the axis that the path runs least along.
        let least = (0..N).fold(0, |best, i| if tangent[i].abs() < tangent[best].abs() { i } else { best });
        let mut axis = [0.0; N];
        axis[least] = 1.0;
        first = reject(axis, tangent);
        length = norm(first);
    }
    first = scale(1.0 / length, first);
    let second = core::array::from_fn(|i| {
        let (j, k) = ((i + 1) % N, (i + 2) % N);
        tangent[j] * first[k] - tangent[k] * first[j]
    });
    [first, second]
}

/// The step of Gauss and Newton: (G'G + W) du = -G' eps - W u, by Cholesky's factorisation in place.
fn solve<const N: usize>(
    rollout: &Rollout<N>,
    response: &Response<N>,
    rates: &[f64; MOST_UNKNOWNS],
    knots: usize,
    settings: &Settings,
) -> [f64; MOST_UNKNOWNS] {
    let n = normals::<N>();
    let unknowns = knots * n;
    let mut matrix = [[0.0; MOST_UNKNOWNS]; MOST_UNKNOWNS];
    let mut right = [0.0; MOST_UNKNOWNS];
    // Row by row of G: the error of knot i on one normal feels the rates of knots 0..=i.
    for i in 0..knots {
        for d in 0..n {
            let mut row = [0.0; MOST_UNKNOWNS];
            for j in 0..=i {
                let felt: [f64; N] = core::array::from_fn(|a| {
                    (0..N).map(|tool| rollout.at_foot[i][d][tool] * response[i - j][tool][a]).sum()
                });
                for c in 0..n {
                    row[j * n + c] = dot(felt, rollout.at_knot[j][c]);
                }
            }
            let width = (i + 1) * n;
            for r in 0..width {
                right[r] -= row[r] * rollout.error[i][d];
                for c in 0..=r {
                    matrix[r][c] += row[r] * row[c];
                }
            }
        }
    }
    for r in 0..unknowns {
        matrix[r][r] += settings.rate_weight;
        right[r] -= settings.rate_weight * rates[r];
        if r >= n {
            let w = settings.change_weight;
            matrix[r][r] += w;
            matrix[r - n][r - n] += w;
            matrix[r][r - n] -= w;
            let change = w * (rates[r] - rates[r - n]);
            right[r] -= change;
            right[r - n] += change;
        }
    }
    cholesky(&mut matrix, &mut right, unknowns);
    right
}
