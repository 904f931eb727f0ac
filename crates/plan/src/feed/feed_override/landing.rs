//! Ways to a rate that can stay: over a number of periods the change of the slope goes linearly,
//! which is the least of it in the mean square that leads from one rate and slope to another rate
//! and no slope.

use super::published::PublishedPlan;
use super::{ScaledStep, ScaledTime, ScalingLimits};
use crate::feed::AxisMotion;
use crate::vector::norm;
use std::collections::VecDeque;

/// Periods that are tried, the shortest way first.
const PERIODS: [u32; 14] = [2, 3, 4, 6, 8, 11, 16, 22, 32, 45, 64, 90, 128, 180];

/// The part by which a limit may be exceeded: a plan in least time is at its limits, and without it
/// no rate could change at all.
const OVER: f64 = 5e-4;

/// Part by which a way may plan to exceed a limit. The rest of `OVER` is for what lies between the
/// moments that are checked.
const AIMED_OVER: f64 = 2.5e-4;

/// Longest way, steps.
const MOST_STEPS: u32 = 300;

/// A step that is no longer than this ends its period, s: the rest of the period is dropped.
const SHORTEST_S: f64 = 1e-10;

/// Number of times that the change of the slope is recomputed about the previous one to keep a
/// limit.
const AGAIN: u32 = 4;

/// A step changes the rate by no more than this beside its slope.
const MOST_CHANGE: f64 = 5e-3;

/// No change of the slope is more than this by the square of a period.
const MOST_BEND: f64 = 1.0;

/// Iterations for the end of a step.
const NEWTON: u32 = 6;

/// A slope of the rate below this counts as zero, 1/s.
const NO_SLOPE_1_S: f64 = 1e-9;

/// Moments of a step at which limits are looked at, and the last of them before its end: at the end
/// of a plan the axes rest already.
const MOMENTS: u32 = 8;
const BEFORE_END: f64 = 0.999;

/// A way: its steps, and the rate behind it.
#[derive(Debug, Clone, Default)]
pub(super) struct Landing {
    pub(super) steps: VecDeque<ScaledStep>,
    /// Rate at the end, if it was chosen; `None` takes the rate that results.
    rate: Option<f64>,
}

impl Landing {
    /// Returns true if the way has ended: the rate is one that can stay.
    pub(super) fn is_over(&self) -> bool {
        self.steps.is_empty()
    }

    /// The highest rate on it.
    pub(super) fn highest(&self) -> f64 {
        self.steps
            .iter()
            .map(|step| step.after(step.duration_s).rate)
            .fold(0.0, f64::max)
    }

    /// The rate that can stay, where a way has ended with `found`.
    pub(super) fn rate(&self, found: f64) -> f64 {
        self.rate.unwrap_or(found).max(0.0)
    }
}

/// A step with that change of the slope: a period, or up to where the jerk of the plan changes, or
/// less where the rate changes so fast that limits could be exceeded between the moments that are
/// looked at.
pub(super) fn step(
    plan: &PublishedPlan,
    limits: &ScalingLimits,
    from: &ScaledTime,
    bend_1_s2: f64,
) -> ScaledStep {
    let (span, end_s) = plan.ahead(from.tau_s);
    let mut duration_s = limits
        .period_s
        .min((2.0 * MOST_CHANGE / bend_1_s2.abs()).sqrt());
    if from.after(duration_s, bend_1_s2).tau_s > end_s {
        // Plan time rises all along, or the step is refused: Newton's method from the mean rate.
        duration_s = ((end_s - from.tau_s) / from.rate.max(1e-6)).min(duration_s);
        for _ in 0..NEWTON {
            let now = from.after(duration_s, bend_1_s2);
            let next_s = duration_s - (now.tau_s - end_s) / now.rate.max(1e-6);
            duration_s = next_s.clamp(0.0, limits.period_s);
        }
    }
    ScaledStep {
        from: *from,
        bend_1_s2,
        duration_s,
        span,
    }
}

/// The change of the slope nearest to a wanted one that keeps jerks at both ends of a step and
/// accelerations at its second one. They are nearly linear in it: it is looked for again about what
/// was found.
pub(super) fn bounded(
    plan: &PublishedPlan,
    limits: &ScalingLimits,
    from: &ScaledTime,
    wanted: f64,
    first: f64,
) -> f64 {
    (0..AGAIN).fold(first, |about, _| {
        let [least, most] = interval(plan, limits, from, about);
        wanted.min(most).max(least)
    })
}

/// The interval of what is kept, linear about a change of the slope; where none is, its ends are
/// the wrong way round.
fn interval(
    plan: &PublishedPlan,
    limits: &ScalingLimits,
    from: &ScaledTime,
    about: f64,
) -> [f64; 2] {
    let ScaledStep {
        duration_s: t,
        span,
        ..
    } = step(plan, limits, from, about);
    let most_bend = MOST_BEND / (limits.period_s * limits.period_s);
    let mut found = [-most_bend, most_bend];
    let mut bound = |value: f64, by_bend: f64, most: f64| {
        if by_bend.abs() > 1e-9 {
            let fixed = value - by_bend * about;
            let (a, b) = ((-most - fixed) / by_bend, (most - fixed) / by_bend);
            found = [found[0].max(a.min(b)), found[1].min(a.max(b))];
        }
    };
    for t in [0.0, t] {
        let now = from.after(t, about);
        let (r, s) = (now.rate, now.slope_1_s);
        let (r_by_bend, s_by_bend) = (0.5 * t * t, t);
        let planned = plan.in_span(span, now.tau_s);
        let motion = now.motion(&planned, about);
        let AxisMotion {
            velocity_mm_s: v,
            accel_mm_s2: a,
            jerk_mm_s3: j,
            ..
        } = planned;
        for (k, axis) in limits.axes.iter().enumerate() {
            let by_bend = v[k]
                + 3.0 * a[k] * (r_by_bend * s + r * s_by_bend)
                + 3.0 * j[k] * r * r * r_by_bend;
            bound(
                motion.jerk_mm_s3[k],
                by_bend,
                (1.0 + AIMED_OVER) * axis.jerk_mm_s3,
            );
            let by_bend = 2.0 * a[k] * r * r_by_bend + v[k] * s_by_bend;
            bound(
                motion.accel_mm_s2[k],
                by_bend,
                (1.0 + AIMED_OVER) * axis.accel_mm_s2,
            );
        }
    }
    found
}

/// Returns true if a step keeps all limits.
pub(super) fn keeps(plan: &PublishedPlan, limits: &ScalingLimits, step: &ScaledStep) -> bool {
    // Plan time does not run back, between moments either: the rate is a parabola.
    let lowest_s = -step.from.slope_1_s / step.bend_1_s2;
    if step.bend_1_s2 > 0.0
        && (0.0..step.duration_s).contains(&lowest_s)
        && step.after(lowest_s).rate < -1e-12
    {
        return false;
    }
    let parts = (0..=MOMENTS).map(|m| f64::from(m) / f64::from(MOMENTS));
    parts.chain([BEFORE_END]).all(|part| {
        let now = step.after(step.duration_s * part);
        if now.rate < -1e-12 {
            return false;
        }
        let planned = plan.in_span(step.span, now.tau_s);
        let motion = now.motion(&planned, step.bend_1_s2);
        let axes = limits.axes.iter().enumerate().all(|(k, axis)| {
            motion.velocity_mm_s[k].abs() <= (1.0 + OVER) * axis.velocity_mm_s
                && motion.accel_mm_s2[k].abs() <= (1.0 + OVER) * axis.accel_mm_s2
                && motion.jerk_mm_s3[k].abs() <= (1.0 + OVER) * axis.jerk_mm_s3
        });
        // A plan that is faster, a rapid, is not slowed down for the speed along the path.
        axes && norm(motion.velocity_mm_s)
            <= limits.speed_mm_s.max(norm(planned.velocity_mm_s)) * (1.0 + OVER)
    })
}

/// A way to a rate, the shortest of those that are tried, on which the rate rises to no more than
/// `most`. Its periods are equal: where the jerk of the plan changes within one, it ends there and
/// the next one begins.
pub(super) fn landing(
    plan: &PublishedPlan,
    limits: &ScalingLimits,
    from: &ScaledTime,
    rate: f64,
    most: f64,
) -> Option<Landing> {
    landing_within(plan, limits, from, rate, most, u32::MAX)
}

/// The same in a number of periods at most.
pub(super) fn landing_within(
    plan: &PublishedPlan,
    limits: &ScalingLimits,
    from: &ScaledTime,
    rate: f64,
    most: f64,
    periods: u32,
) -> Option<Landing> {
    let t = limits.period_s;
    if from.slope_1_s == 0.0 && from.rate == rate {
        return Some(Landing {
            steps: VecDeque::new(),
            rate: Some(rate),
        });
    }
    PERIODS
        .iter()
        .take_while(|&&n| n <= periods)
        .find_map(|&n| {
            // Sum of the bends: -slope / T; their moment about the end: what is missing of the
            // rate.
            let count = f64::from(n);
            let mean = -from.slope_1_s / (t * count);
            let missing = (rate - from.rate - from.slope_1_s * t * count) / (t * t);
            let growth =
                (missing - mean * count * count / 2.0) * -12.0 / (count * (count * count - 1.0));
            let (mut steps, mut now) = (VecDeque::new(), *from);
            for i in 0..n {
                let bend = mean + growth * (f64::from(i) - 0.5 * (count - 1.0));
                let mut left_s = t;
                while left_s > 0.0 {
                    let mut part = step(plan, limits, &now, bend);
                    part.duration_s = part.duration_s.min(left_s);
                    if !keeps(plan, limits, &part) {
                        return None;
                    }
                    left_s = if part.duration_s > SHORTEST_S {
                        left_s - part.duration_s
                    } else {
                        0.0
                    };
                    now = part.after(part.duration_s);
                    steps.push_back(part);
                    if now.rate > most {
                        return None;
                    }
                }
            }
            Some(Landing {
                steps,
                rate: Some(rate),
            })
        })
}

/// The way to a rate without slope, from 0 to 1, that takes the slope away as fast as limits let
/// it, without passing the rate that is wanted and without rising to more than `most`.
pub(super) fn landing_anywhere(
    plan: &PublishedPlan,
    limits: &ScalingLimits,
    from: &ScaledTime,
    wanted: f64,
    towards: f64,
    most: f64,
) -> Option<Landing> {
    let (mut steps, mut now) = (VecDeque::new(), *from);
    for _ in 0..MOST_STEPS {
        if now.slope_1_s.abs() < NO_SLOPE_1_S {
            return (now.rate <= 1.0).then_some(Landing { steps, rate: None });
        }
        let whole_s = step(plan, limits, &now, 0.0).duration_s;
        let bend = bounded(plan, limits, &now, -now.slope_1_s / whole_s, 0.0);
        let mut next = step(plan, limits, &now, bend);
        if -now.slope_1_s * bend > 0.0 {
            next.duration_s = next.duration_s.min(-now.slope_1_s / bend);
        }
        if !keeps(plan, limits, &next) {
            return None;
        }
        now = next.after(next.duration_s);
        steps.push_back(next);
        if now.rate < 0.0 || now.rate > most || (wanted - now.rate) * towards < 0.0 {
            return None;
        }
    }
    None
}
