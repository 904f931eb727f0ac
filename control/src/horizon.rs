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
//! is made smaller by a [`Solver`], from last tick's plan, shifted. Along the path an offset only shifts the tool in time,
//! but for corners, where it makes the command turn earlier or later; h is its price, so that nothing drifts and no time is
//! bought or sold.
//!
//! A knot of the plan is one feed period long, or several on a machine that lags far behind: the horizon has to reach
//! beyond the lag, whatever the machine, and takes no more unknowns for it.
//!
//! Source: the performance index is Lee, Cho and Jeon (2005), eq. 7, summed over a horizon; receding horizon as in Richalet
//! et al. (1978), knots of several periods as in move blocking (Cagienard et al. 2007).
//!
//! Everything is of fixed size: at most [`MOST_KNOTS`] knots, N unknowns each.

pub mod problem;
pub mod gauss_newton;
pub mod gradient;

use crate::vector::add_scaled;
use crate::window::Window;
use gauss_newton::GaussNewton;
use problem::Problem;

/// Most knots of a horizon.
pub const MOST_KNOTS: usize = 20;
/// Most feed periods of a knot.
pub const MOST_PERIODS: usize = 4;
/// Most axes.
const MOST_AXES: usize = 3;
/// Most unknowns.
const MOST_UNKNOWNS: usize = MOST_KNOTS * MOST_AXES;

/// Settings of the inversion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Knots of the horizon; 1 to [`MOST_KNOTS`].
    pub knots: usize,
    /// w: weight of the offset rates, s^2. Smaller is sharper; below 1e-10 the plan rings from knot to knot, above 1e-4
    /// nothing is corrected.
    pub rate_weight: f64,
    /// d: weight of the change of the offset rates from knot to knot, s^2.
    pub change_weight: f64,
    /// h: price of an offset along the path against a contour error of the same size; 0.001 to 1.
    pub tangential_price: f64,
    /// Largest offset rate of an axis, mm/s. Far above what a plan asks for: a loop that runs into it swings.
    pub rate_limit_mm_s: f64,
}

/// The offset rates of a plan, knot by knot, mm/s.
pub type Rates<const N: usize> = [[f64; N]; MOST_KNOTS];

/// What the tool feels at the end of a knot: its displacement in each axis, mm, for an offset rate of 1 mm/s of that axis in
/// each of the knots so far, s.
pub type Felt<const N: usize> = [[f64; N]; MOST_KNOTS];

/// What predicts the tool: a model of the machine, with its state at the current knot.
pub trait Model<const N: usize>: Clone {
    /// How far the tool is behind the command in the long run, s.
    fn lag_s(&self) -> f64;
    /// Moves on by one feed period; the tool at its end, mm. `felt` takes the derivative to the rates of the knots so far,
    /// axis by axis: what one axis feels of another is left out.
    fn advance(&mut self, window: &Window<'_, N>, stretch: &Stretch<N>, felt: &mut Felt<N>) -> [f64; N];
}

/// What is commanded in a feed period of the horizon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch<const N: usize> {
    /// Its number, from 0.
    pub period: usize,
    /// Feed periods of a knot.
    pub periods_per_knot: usize,
    /// Command at its start and end, mm.
    pub command_mm: [[f64; N]; 2],
    /// Offset from the path at its start and end, mm.
    pub offset_mm: [[f64; N]; 2],
}

impl<const N: usize> Stretch<N> {
    /// The next feed period, with this offset at its end.
    pub fn next(window: &Window<'_, N>, offset_mm: [f64; N]) -> Self {
        let offset_mm = [window.offset_mm, offset_mm];
        let path_mm = [window.now().position_mm, window.ahead(1).position_mm];
        let command_mm = [0, 1].map(|end| add_scaled(path_mm[end], 1.0, offset_mm[end]));
        Self { period: 0, periods_per_knot: 1, command_mm, offset_mm }
    }

    /// The knot that this feed period is in.
    #[inline]
    pub fn knot(&self) -> usize {
        self.period / self.periods_per_knot
    }

    /// The feed periods of a knot, this one's or an earlier, that lie before this one.
    #[inline]
    pub fn elapsed(&self, knot: usize) -> usize {
        (self.period - knot * self.periods_per_knot).min(self.periods_per_knot)
    }

    /// Whether the feed period `back` before this one is in a knot.
    #[inline]
    pub fn was_in(&self, knot: usize, back: usize) -> bool {
        back <= self.period && (self.period - back) / self.periods_per_knot == knot
    }
}

/// What makes J smaller. It keeps nothing from tick to tick that the next depends on.
pub trait Solver<const N: usize>: Default {
    /// Changes the rates of a plan whose problem is this.
    fn improve(&mut self, problem: &Problem<N>, rates: &mut Rates<N>);
}

/// A plan: the offset rate of each knot of the horizon, mm/s.
#[derive(Debug, Clone)]
pub struct Plan<const N: usize, S = GaussNewton> {
    rates: Rates<N>,
    periods: usize,
    solver: S,
}

/// The first step of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step<const N: usize> {
    /// Offset at the next feed period, mm.
    pub offset_mm: [f64; N],
    /// Largest change of an offset rate in this step, mm/s.
    pub change_mm_s: f64,
}

impl<const N: usize, S: Solver<N>> Default for Plan<N, S> {
    fn default() -> Self {
        Self { rates: [[0.0; N]; MOST_KNOTS], periods: 1, solver: S::default() }
    }
}

impl<const N: usize, S: Solver<N>> Plan<N, S> {
    /// Forgets the plan.
    pub fn reset(&mut self) {
        self.rates = [[0.0; N]; MOST_KNOTS];
        self.periods = 1;
    }

    /// Goes over to the next tick: what was planned for it comes first. From here on a knot has `periods` feed periods, 1
    /// to [`MOST_PERIODS`].
    pub fn shift(&mut self, periods: usize, settings: &Settings) {
        let knots = settings.knots.clamp(1, MOST_KNOTS);
        let planned = self.rates;
        let last = self.periods;
        self.periods = periods.clamp(1, MOST_PERIODS);
        for (knot, rate) in self.rates.iter_mut().enumerate() {
            // The mean of what was planned for its feed periods; beyond the horizon nothing was.
            let mut sum = [0.0; N];
            for period in knot * self.periods..(knot + 1) * self.periods {
                let before = (period + 1) / last;
                if before < knots {
                    sum = add_scaled(sum, 1.0 / self.periods as f64, planned[before]);
                }
            }
            *rate = sum;
        }
    }

    /// Improves the plan by one step of the solver and returns its first command. The tool is `lag_s` behind the command
    /// now.
    pub fn improve<M: Model<N>>(
        &mut self,
        model: &M,
        window: &Window<'_, N>,
        lag_s: f64,
        settings: &Settings,
    ) -> Step<N> {
        let knots = settings.knots.clamp(1, MOST_KNOTS);
        let problem = Problem::new(model, window, lag_s, &self.rates, self.periods, settings);
        let before = self.rates;
        self.solver.improve(&problem, &mut self.rates);
        let limit = settings.rate_limit_mm_s;
        let mut change_mm_s = 0.0_f64;
        for (rate, before) in self.rates.as_flattened_mut()[..knots * N].iter_mut().zip(before.as_flattened()) {
            *rate = if rate.is_finite() { rate.clamp(-limit, limit) } else { 0.0 };
            change_mm_s = change_mm_s.max((*rate - before).abs());
        }
        Step { offset_mm: add_scaled(window.offset_mm, window.feed_period_s, self.rates[0]), change_mm_s }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: Settings =
        Settings { knots: 4, rate_weight: 1e-9, change_weight: 0.0, tangential_price: 0.1, rate_limit_mm_s: 10.0 };

    fn plan(rates: [f64; 4]) -> Plan<1> {
        let mut plan = Plan::default();
        for (knot, rate) in rates.into_iter().enumerate() {
            plan.rates[knot] = [rate];
        }
        plan
    }

    fn rates(plan: &Plan<1>) -> [f64; 4] {
        core::array::from_fn(|knot| plan.rates[knot][0])
    }

    #[test]
    fn a_shifted_plan_begins_with_its_second_knot() {
        let mut plan = plan([1.0, 2.0, 3.0, 4.0]);
        plan.shift(1, &SETTINGS);
        assert_eq!(rates(&plan), [2.0, 3.0, 4.0, 0.0]);
    }

    #[test]
    fn longer_knots_take_the_mean_of_what_was_planned_for_them_and_go_on_by_a_part() {
        let mut plan = plan([1.0, 2.0, 3.0, 4.0]);
        plan.shift(2, &SETTINGS);
        assert_eq!(rates(&plan), [2.5, 2.0, 0.0, 0.0]);
        plan.shift(2, &SETTINGS);
        assert_eq!(rates(&plan), [2.25, 1.0, 0.0, 0.0]);
        plan.shift(1, &SETTINGS);
        assert_eq!(rates(&plan), [2.25, 1.0, 1.0, 0.0]);
    }
}
