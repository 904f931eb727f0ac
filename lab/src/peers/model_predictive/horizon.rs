//! The horizon: the accelerations of the offset in all its knots, improved by one Gauss-Newton step
//! after another.
//!
//! The command is the path and an offset o from it. With the accelerations a_j of the offset in
//! each knot as the unknowns, in all axes, the plan is rolled out through a [`Predictor`] of the
//! machine. Each predicted tool position p_i is referred to the point of the path of *its own plan
//! time less the lag of the machine*,
//!
//! ```text
//! r_i = P*(tau_i - lag)     eps_i = (1 - t_i t_i')(p_i - r_i)     theta_i = t_i'(p_i - r_i)
//!
//! J(a) = 1/2 sum_i (|eps_i|^2 + h^2 theta_i^2) + q/2 sum_j |o_j|^2 + w/2 sum_j |v_j|^2 + d/2 sum_j |v_j - v_{j-1}|^2
//!        + e/2 |o_last + lag v_last|^2
//! v_j = v_0 + T sum_{m<=j} a_m     |a_j| <= A in each axis
//! ```
//!
//! and J is made smaller by [`GaussNewton`], from last tick's plan, shifted. A tool that lags
//! behind its time, or leads, cuts nothing wrong, so theta counts little (h is small). It still
//! counts, so that no tool stays on a stretch of the path that is over; with the nearest point as
//! the reference it could.
//!
//! The plan must do no harm. These terms limit it:
//!
//! - q, the weight of the offset itself, where it cannot undo the whole error, at the start,
//!   where drives are at their limit ([`restraint`]): the plan then corrects only a part.
//! - e, at the end of the horizon: nothing beyond it is predicted, and the offset is to be on its
//!   way back.
//!
//! The limits of the plan are those of the machine file: what the plan asks for is carried out as
//! it is. Speed and deviation of the offset, and what the drives can accelerate, cost much beyond
//! their limits ([`problem`]).
//!
//! On a rapid motion nothing is cut: there the offset is to move the tool as little as the cuts
//! about it allow.
//!
//! A knot of the plan is one feed period long.
//!
//! Source: the performance index is Lee, Cho and Jeon (2005), eq. 7, summed over a horizon;
//! receding horizon as in Richalet et al. (1978), contour and lag error with weights of their own
//! as in Lam, Manzie and Good (2010).
//!
//! Everything is of fixed size: at most [`MAX_KNOTS`] knots, N unknowns each.

pub(crate) mod restraint;
pub(crate) mod problem;
pub(crate) mod interior_point;
pub(crate) mod gauss_newton;

use feedwright_control::Window;
use feedwright_control::vector::{add_scaled, bounded, fourth_power, scale, sub};

use feedwright_sim::Known;
use gauss_newton::GaussNewton;
use problem::HorizonProblem;
use restraint::Restraint;

/// Most knots of a horizon.
pub const MAX_KNOTS: usize = 20;
/// Most axes; fewer than two have no path to leave. [`HorizonProblem::new`] does not compile for
/// others: the normals of the path are those of a plane or of space, and there is no room for more
/// unknowns.
pub(crate) const MAX_AXES: usize = 3;
/// Most unknowns.
pub(crate) const MAX_UNKNOWNS: usize = MAX_KNOTS * MAX_AXES;

/// Speed of the path, mm/s, below which an error along it is about to become an error across it: at
/// rest it leads beyond the end.
const RESTING_MM_S: f64 = 0.5;

/// Least reach of the horizon, as a multiple of the lag of the machine: later commands hardly move
/// the tool that is predicted now.
pub(crate) const LAGS_AHEAD: f64 = 3.6;

/// Part of the largest deviation that a plan uses: the rest is for what it misses, before the
/// safety layer acts.
const PLANNED_DEVIATION: f64 = 0.9;

/// Knots at the end of the horizon by which the tool has to be back at its time. Behind the horizon
/// nothing is foreseen: a tool that is late or fast there when the path turns swings from one side
/// of it to the other.
const LAST_KNOTS: usize = 5;

/// Settings of the inversion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HorizonSettings<const N: usize> {
    /// Knots of the horizon; 1 to [`MAX_KNOTS`].
    pub knots: usize,
    /// w: weight of the speed of the offset, s^2. Smaller is sharper; below 1e-10 the plan rings
    /// from knot to knot, above 1e-4 nothing is corrected.
    pub rate_weight: f64,
    /// d: weight of the change of that speed from knot to knot, s^2.
    pub change_weight: f64,
    /// q_0: weight of the offset. 0 is sharpest, 10 leaves hardly any correction.
    pub offset_weight: f64,
    /// h: weight of an error along the path against one across it: small, it leaves room at a
    /// corner, large, it keeps the tool from staying behind. 0.001 to 1.
    pub tangential_weight: f64,
    /// h of the last knots at the least.
    pub last_weight: f64,
    /// Weight of a tool that is further from its time than without the offset; about points where
    /// the path turns back, more.
    pub late_weight: f64,
    /// Limits that the plan keeps.
    pub limits: CorrectionLimits<N>,
}

/// Limits of the correction, that is of the offset of the command from the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CorrectionLimits<const N: usize> {
    /// A: acceleration of the offset of each axis, mm/s^2. Never exceeded.
    pub acceleration_mm_s2: [f64; N],
    /// Speed of the offset of an axis, mm/s.
    pub speed_mm_s: f64,
    /// Length of the offset, mm.
    pub deviation_mm: f64,
    /// Acceleration of the tool in each axis at the torque limit of its drive, mm/s^2.
    pub drive_mm_s2: [f64; N],
}

impl<const N: usize> CorrectionLimits<N> {
    /// None.
    pub const NONE: Self = Self {
        acceleration_mm_s2: [f64::INFINITY; N],
        speed_mm_s: f64::INFINITY,
        deviation_mm: f64::INFINITY,
        drive_mm_s2: [f64::INFINITY; N],
    };

    /// Returns the limits that a machine sets for a correction.
    pub fn of(known: &Known) -> Self {
        Self {
            acceleration_mm_s2: core::array::from_fn(|i| known.axis(i).correction_accel_mm_s2),
            speed_mm_s: known.limits.rapid_mm_s,
            deviation_mm: PLANNED_DEVIATION * known.limits.max_deviation_mm,
            drive_mm_s2: core::array::from_fn(|i| known.axis(i).drive_mm_s2()),
        }
    }
}

/// The accelerations of a plan, knot by knot, mm/s^2.
pub type Accelerations<const N: usize> = [[f64; N]; MAX_KNOTS];

/// Response of the tool at the end of a knot: its displacement in each axis, mm, for an
/// acceleration of the offset of 1 mm/s^2 in that axis in each of the knots so far, s^2.
pub type Sensitivity<const N: usize> = [[f64; N]; MAX_KNOTS];

/// Model of the machine that predicts the tool, with its state at the current knot.
pub trait Predictor<const N: usize>: Clone {
    /// Returns the lag of the tool behind the command in the long run, s.
    fn lag_s(&self) -> f64;

    /// Returns the time that the tool takes to follow an offset, s: its lag, unless the drive feeds
    /// part of the path forward and so lags less behind the path than behind an offset.
    fn response_s(&self) -> f64 {
        self.lag_s()
    }
    /// Advances by one feed period and returns the tool position at its end, mm. Writes to
    /// `sensitivity` its derivative with respect to the accelerations of the knots so far, axis by
    /// axis. Coupling between axes is neglected.
    fn advance(
        &mut self,
        window: &Window<'_, N>,
        stretch: &CommandedPeriod<N>,
        sensitivity: &mut Sensitivity<N>,
    ) -> [f64; N];
}

/// Command in a feed period of the horizon.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommandedPeriod<const N: usize> {
    /// Number of the period, from 0, equal to the number of its knot.
    pub period: usize,
    /// Its length, s.
    pub period_s: f64,
    /// Command at its start and end, mm.
    pub command_mm: [[f64; N]; 2],
    /// Offset from the path at its start and end, mm.
    pub offset_mm: [[f64; N]; 2],
    /// Speed of the offset at its start and end, mm/s.
    pub offset_mm_s: [[f64; N]; 2],
}

impl<const N: usize> CommandedPeriod<N> {
    /// Starts before the first feed period, at the present command.
    pub fn now(window: &Window<'_, N>) -> Self {
        Self {
            period: usize::MAX,
            period_s: window.feed_period_s,
            command_mm: [add_scaled(window.now().position_mm, 1.0, window.offset_mm); 2],
            offset_mm: [window.offset_mm; 2],
            offset_mm_s: [window.offset_mm_s; 2],
        }
    }

    /// Goes on by one feed period in which the offset accelerates by so much.
    #[inline]
    pub fn go_on(&mut self, window: &Window<'_, N>, acceleration_mm_s2: [f64; N]) {
        let period_s = self.period_s;
        self.period = self.period.wrapping_add(1);
        let [_, from_mm] = self.offset_mm;
        let [_, from_mm_s] = self.offset_mm_s;
        let to_mm_s = add_scaled(from_mm_s, period_s, acceleration_mm_s2);
        let to_mm = add_scaled(
            add_scaled(from_mm, 0.5 * period_s, from_mm_s),
            0.5 * period_s,
            to_mm_s,
        );
        self.offset_mm = [from_mm, to_mm];
        self.offset_mm_s = [from_mm_s, to_mm_s];
        let path_mm = window.ahead(self.period + 1).position_mm;
        self.command_mm = [self.command_mm[1], add_scaled(path_mm, 1.0, to_mm)];
    }

    /// Returns the bend of the offset's course, mm: see [`feedwright_control::Command`].
    #[inline]
    pub fn bend_mm(&self) -> [f64; N] {
        scale(
            0.5 * self.period_s,
            sub(self.offset_mm_s[1], self.offset_mm_s[0]),
        )
    }

    /// Returns the displacement of the offset by an acceleration of 1 mm/s^2 in a knot after `part`
    /// of this feed period, s^2.
    #[inline]
    pub fn moved_s2(&self, knot: usize, part: f64) -> f64 {
        let since = self.period as f64 + part - knot as f64;
        let within = bounded(since, 0.0, 1.0);
        within * (since.max(0.0) - 0.5 * within) * self.period_s * self.period_s
    }
}

/// A plan: the acceleration of the offset in each knot of the horizon, mm/s^2.
#[derive(Debug, Clone)]
pub(crate) struct OffsetPlan<const N: usize> {
    accelerations_mm_s2: Accelerations<N>,
    restraint: Restraint,
    solver: GaussNewton,
}

/// The first step of a plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PlanStep<const N: usize> {
    /// Acceleration of the offset in the next feed period, mm/s^2.
    pub acceleration_mm_s2: [f64; N],
    /// Largest change of an acceleration by the solver, mm/s^2.
    pub change_mm_s2: f64,
}

impl<const N: usize> Default for OffsetPlan<N> {
    fn default() -> Self {
        Self {
            accelerations_mm_s2: [[0.0; N]; MAX_KNOTS],
            restraint: Restraint::START,
            solver: GaussNewton::default(),
        }
    }
}

impl<const N: usize> OffsetPlan<N> {
    /// Forgets the plan.
    pub(crate) fn reset(&mut self) {
        self.accelerations_mm_s2 = [[0.0; N]; MAX_KNOTS];
        self.restraint = Restraint::START;
    }

    /// Goes over to the next tick: what was planned for it comes first, and nothing is planned for
    /// the last knot.
    pub(crate) fn shift(&mut self, settings: &HorizonSettings<N>) {
        let knots = settings.knots();
        let planned = self.accelerations_mm_s2;
        let limits = &settings.limits.acceleration_mm_s2;
        for (knot, acceleration) in self.accelerations_mm_s2.iter_mut().enumerate() {
            let next = if knot + 1 < knots {
                planned[knot + 1]
            } else {
                [0.0; N]
            };
            *acceleration =
                core::array::from_fn(|axis| bounded(next[axis], -limits[axis], limits[axis]));
        }
    }

    /// Improves the plan by one step of the solver and returns what comes first.
    pub(crate) fn improve<M: Predictor<N>>(
        &mut self,
        model: &M,
        window: &Window<'_, N>,
        settings: &HorizonSettings<N>,
    ) -> PlanStep<N> {
        let horizon_s = settings.knots() as f64 * window.feed_period_s;
        let settings = self
            .restraint
            .on(settings, model.response_s().max(horizon_s / LAGS_AHEAD));
        let problem = HorizonProblem::new(model, window, &self.accelerations_mm_s2, &settings);
        self.restraint.take_in(
            problem.need_mm(),
            problem.contour_mm2(),
            problem.drive_share(),
        );
        let before = self.accelerations_mm_s2;
        self.solver.improve(&problem, &mut self.accelerations_mm_s2);
        let mut change_mm_s2 = 0.0_f64;
        let finite = self
            .accelerations_mm_s2
            .as_flattened()
            .iter()
            .all(|a| a.is_finite());
        if !finite {
            self.accelerations_mm_s2 = [[0.0; N]; MAX_KNOTS];
        }
        for (now, before) in self.accelerations_mm_s2.iter().zip(&before) {
            for change in sub(*now, *before) {
                change_mm_s2 = change_mm_s2.max(change.abs());
            }
        }
        PlanStep {
            acceleration_mm_s2: self.accelerations_mm_s2[0],
            change_mm_s2,
        }
    }
}

impl<const N: usize> HorizonSettings<N> {
    /// Values that serve every shape and machine tried.
    pub const DEFAULT: Self = Self {
        knots: 20,
        rate_weight: 3e-10,
        change_weight: 1e-10,
        offset_weight: 0.0,
        tangential_weight: 0.006,
        last_weight: 0.05,
        late_weight: 0.0,
        limits: CorrectionLimits::NONE,
    };

    /// Settings for tests.
    #[cfg(test)]
    pub(crate) const EXAMPLE: Self = Self {
        knots: 4,
        rate_weight: 1e-9,
        change_weight: 0.0,
        offset_weight: 0.0,
        tangential_weight: 0.1,
        last_weight: 0.3,
        late_weight: 0.0,
        limits: CorrectionLimits::NONE,
    };

    /// h at the end of a knot, where the path runs at `feed_mm_s`.
    #[inline]
    pub fn weight_along(&self, knot: usize, feed_mm_s: f64) -> f64 {
        let running = self.tangential_weight;
        let weight = running + (1.0 - running) / (1.0 + fourth_power(feed_mm_s / RESTING_MM_S));
        if knot + LAST_KNOTS >= self.knots() {
            weight.max(self.last_weight)
        } else {
            weight
        }
    }

    /// Number of knots of the horizon, limited to 1 to [`MAX_KNOTS`].
    #[inline]
    pub fn knots(&self) -> usize {
        self.knots.clamp(1, MAX_KNOTS)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(accelerations: [f64; 4]) -> OffsetPlan<1> {
        let mut plan = OffsetPlan::default();
        for (knot, acceleration) in accelerations.into_iter().enumerate() {
            plan.accelerations_mm_s2[knot] = [acceleration];
        }
        plan
    }

    fn accelerations(plan: &OffsetPlan<1>) -> [f64; 4] {
        core::array::from_fn(|knot| plan.accelerations_mm_s2[knot][0])
    }

    #[test]
    fn a_shifted_plan_begins_with_its_second_knot() {
        let mut plan = plan([1.0, 2.0, 3.0, 4.0]);
        plan.shift(&HorizonSettings::EXAMPLE);
        assert_eq!(accelerations(&plan), [2.0, 3.0, 4.0, 0.0]);
    }

    #[test]
    fn an_acceleration_moves_the_offset_by_its_closed_form() {
        let (offset_mm, offset_mm_s) = ([[0.0]; 2], [[0.0]; 2]);
        let stretch = CommandedPeriod::<1> {
            period: 5,
            period_s: 0.003,
            command_mm: [[0.0]; 2],
            offset_mm,
            offset_mm_s,
        };
        // In the third knot, from 6 ms to 9 ms; now it is 16.5 ms.
        let moved = 0.003 * (0.003 / 2.0 + 0.0075);
        assert!((stretch.moved_s2(2, 0.5) - moved).abs() < 1e-15);
        assert_eq!(stretch.moved_s2(6, 0.5), 0.0);
    }
}
