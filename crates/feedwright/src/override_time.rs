//! The time of a program with a feed override, and its stop by a feed hold: moves along the plan of
//! the program by [`TimeScaling`](feedwright_plan::TimeScaling).

use std::collections::VecDeque;

use feedwright_plan::{
    AxisLimits, Constraints, Plan, Planned, Plc, PublishedPlan, ScaledStep, ScalingLimits, Steps,
    TimeScaling, shortest_stop_mm,
};
use feedwright_sim::{Machine, RunError, Stages, Watch};
use serde::Serialize;

/// Period in which the rate changes, s, up to an override of 1. At a low, rising speed, a change of
/// slope that is held for a millisecond uses little of the jerk limit at its start.
const PERIOD_S: f64 = 2.5e-4;
/// Period in which the rate changes, s, above an override of 1. The way back to a rate that can be
/// held must then reach further ahead than the same number of short periods does.
const PERIOD_ABOVE_S: f64 = 1e-3;

/// Number of intervals of a step at whose ends limits are checked.
const MOMENTS: u32 = 8;

/// Inputs of an operator.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct OperatorRequest {
    /// Override of feeds, 1 for none, up to [`MOST_OVERRIDE`](feedwright_plan::MOST_OVERRIDE).
    pub(crate) override_of_feeds: f64,
    /// Time at which the feed hold is pressed, s.
    pub(crate) hold_at_s: Option<f64>,
}

/// A stop by feed hold.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct HoldStop {
    /// Time at which the feed hold was pressed, s.
    pub(crate) at_s: f64,
    /// Time from the feed hold until the tool rests, s.
    pub(crate) stops_in_s: f64,
    /// Way of the tool along the path until it rests, mm.
    pub(crate) way_mm: f64,
    /// Least possible way with the limits of each axis by itself, mm.
    pub(crate) least_mm: f64,
    /// Position at rest, mm.
    pub(crate) position_mm: [f64; 3],
}

/// Result of moving along a plan.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct OverrideTime {
    /// Time until the program ends or the tool rests after the hold, s.
    pub(crate) time_s: f64,
    /// Time of the whole plan without override and hold, s.
    pub(crate) plan_s: f64,
    /// Largest ratio of a velocity, acceleration or jerk to its limit.
    pub(crate) largest_violation: f64,
    /// The stop, if a hold was requested before the end.
    pub(crate) hold: Option<HoldStop>,
}

/// Plans a program, and moves along the plan. None if the planner does not provide the motion of
/// the axes.
///
/// # Errors
/// Fails if the program cannot be planned, a limit is not a valid number, or `watch` cancels the
/// work.
pub(crate) fn override_time(
    machine: &Machine,
    stages: Stages,
    steps: Steps<'_>,
    request: OperatorRequest,
    watch: &dyn Watch,
) -> Result<Option<OverrideTime>, RunError> {
    let constraints = Constraints::from(machine);
    let mut plan = Plan::new(steps, &constraints, stages.planner, Plc::from(machine))?;
    let mut published = PublishedPlan::new();
    // For each piece that phases may still belong to, whether it cuts, and the number of the first
    // such piece.
    let (mut cutting, mut first) = (VecDeque::new(), 0);
    for planned in plan.by_ref() {
        watch.check()?;
        match planned {
            Planned::Piece(planned) => cutting.push_back(planned.piece.cutting),
            Planned::Phase(phase) => {
                while first < phase.piece && cutting.len() > 1 {
                    cutting.pop_front();
                    first += 1;
                }
                if !published.push(&phase, cutting.front().copied().unwrap_or(true)) {
                    return Ok(None);
                }
            }
            Planned::Programmed(_) | Planned::Event(_) => {}
        }
    }
    if let Some(fault) = plan.fault() {
        return Err(fault.clone().into());
    }
    let limits = |k: usize| constraints.axis(k).unwrap_or(AxisLimits::NONE);
    let limits = ScalingLimits {
        axes: [limits(0), limits(1), limits(2)],
        speed_mm_s: constraints.path.max_feed_mm_s,
        period_s: if request.override_of_feeds > 1.0 {
            PERIOD_ABOVE_S
        } else {
            PERIOD_S
        },
    };
    moved_along(&published, limits, request, watch).map(Some)
}

fn moved_along(
    plan: &PublishedPlan,
    limits: ScalingLimits,
    request: OperatorRequest,
    watch: &dyn Watch,
) -> Result<OverrideTime, RunError> {
    let mut scaling = TimeScaling::new(plan, limits);
    let mut result = OverrideTime {
        time_s: 0.0,
        plan_s: plan.end_s(),
        largest_violation: 0.0,
        hold: None,
    };
    // Plan time and time at which the hold was pressed.
    let mut pressed: Option<(f64, f64)> = None;
    while !scaling.has_ended() {
        watch.check()?;
        let hold = request.hold_at_s.is_some_and(|at_s| result.time_s >= at_s);
        let now = scaling.now();
        if hold && pressed.is_none() {
            pressed = Some((now.tau_s, result.time_s));
        }
        let rests = now.rate == 0.0 && now.slope_1_s == 0.0;
        if let Some((tau_s, at_s)) = pressed.filter(|_| rests || scaling.rests()) {
            result.hold = Some(HoldStop {
                at_s,
                stops_in_s: result.time_s - at_s,
                way_mm: plan.length_mm(tau_s, now.tau_s),
                least_mm: shortest_stop_mm(plan, &limits.axes, tau_s),
                position_mm: plan.at(now.tau_s).position_mm,
            });
            break;
        }
        if request.override_of_feeds <= 0.0 && rests && result.time_s > 0.0 {
            // The tool stays there until the operator turns the override up.
            result.time_s = f64::INFINITY;
            break;
        }
        let step = scaling.step(request.override_of_feeds, hold);
        result.time_s += step.duration_s;
        result.largest_violation = result
            .largest_violation
            .max(use_of_limits(plan, &limits, &step));
    }
    Ok(result)
}

/// Returns the largest ratio of velocity, acceleration or jerk of an axis in a step to its limit.
fn use_of_limits(plan: &PublishedPlan, limits: &ScalingLimits, step: &ScaledStep) -> f64 {
    let ratios = (0..=MOMENTS).flat_map(|m| {
        let motion = step.motion(plan, step.duration_s * f64::from(m) / f64::from(MOMENTS));
        limits.axes.iter().enumerate().map(move |(k, axis)| {
            let v = motion.velocity_mm_s[k].abs() / axis.velocity_mm_s;
            let a = motion.accel_mm_s2[k].abs() / axis.accel_mm_s2;
            v.max(a).max(motion.jerk_mm_s3[k].abs() / axis.jerk_mm_s3)
        })
    });
    ratios.fold(0.0, f64::max)
}
