//! Feed override and feed hold on a published plan: they change how fast plan time runs, never the
//! path.
//!
//! A plan says where the axes are at plan time `tau`: `p(tau)`. With the rate `r = dtau/dt` the
//! axes have
//!
//! `v = p' r`, `a = p'' r^2 + p' r'`, `j = p''' r^3 + 3 p'' r r' + p' r''`,
//!
//! and with a rate that stays as it is, at 1 or below, everything is within the limits that the
//! plan keeps. In each period `r''` is chosen: the one that leads to the override the fastest, of
//! those from which a way is known to a rate that can stay. Its first period is always a choice, so
//! that the axes are never led to where a limit cannot be kept. A plan in least time has a limit at
//! its end at any moment: how soon the rate can fall depends on which.
//!
//! | File | What |
//! |---|---|
//! | `published.rs` | a plan over its time |
//! | `landing.rs` | ways to a rate that can stay |
//! | `braking.rs` | the shortest way in which an axis stops |

mod published;
mod landing;
mod braking;

pub use braking::shortest_stop_mm;
pub use published::PublishedPlan;

use super::AxisMotion;
use crate::constraints::AxisLimits;
use crate::vector::norm;
use landing::{Landing, bounded, keeps, landing, landing_anywhere, landing_within, step};

/// Largest override.
pub const MOST_OVERRIDE: f64 = 2.0;

/// More than any change of the slope, 1/s2.
const MOST_BEND_1_S2: f64 = 1e12;

/// Velocity and acceleration below which an axis counts as still.
const STILL_MM_S: f64 = 1e-9;
const STILL_MM_S2: f64 = 1e-3;

/// Rates are the same up to this.
const ROUNDING: f64 = 1e-9;

/// Most periods of a way to an override above 1 that ends without a slope.
const SETTLING: u32 = 16;

/// Number of times that the interval between a feasible and an infeasible choice is halved.
const HALVINGS: u32 = 6;

/// Limits, and the period in which the rate changes.
#[derive(Debug, Clone, Copy)]
pub struct ScalingLimits {
    /// Limits of each axis.
    pub axes: [AxisLimits; 3],
    /// Largest speed along the path, mm/s.
    pub speed_mm_s: f64,
    /// Period, s.
    pub period_s: f64,
}

/// Plan time, and the rate at which it runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ScaledTime {
    /// Plan time, s.
    pub tau_s: f64,
    /// Rate, plan time by time.
    pub rate: f64,
    /// Change of the rate, 1/s.
    pub slope_1_s: f64,
}

impl ScaledTime {
    /// Returns the state after a time at a constant change of the slope, 1/s2.
    #[inline]
    pub(crate) fn after(&self, t: f64, bend_1_s2: f64) -> Self {
        let Self {
            tau_s,
            rate,
            slope_1_s,
        } = *self;
        Self {
            tau_s: tau_s + t * (rate + t * (0.5 * slope_1_s + t * bend_1_s2 / 6.0)),
            rate: rate + t * (slope_1_s + 0.5 * t * bend_1_s2),
            slope_1_s: slope_1_s + t * bend_1_s2,
        }
    }

    /// Returns the motion of the axes at this rate where the plan has the motion `planned`.
    #[inline]
    pub(crate) fn motion(&self, planned: &AxisMotion, bend_1_s2: f64) -> AxisMotion {
        let (r, s) = (self.rate, self.slope_1_s);
        let AxisMotion {
            position_mm,
            velocity_mm_s: v,
            accel_mm_s2: a,
            jerk_mm_s3: j,
        } = *planned;
        AxisMotion {
            position_mm,
            velocity_mm_s: std::array::from_fn(|k| v[k] * r),
            accel_mm_s2: std::array::from_fn(|k| a[k] * r * r + v[k] * s),
            jerk_mm_s3: std::array::from_fn(|k| {
                j[k] * r * r * r + 3.0 * a[k] * r * s + v[k] * bend_1_s2
            }),
        }
    }
}

/// A time in which the slope changes evenly, within one span of the plan.
#[derive(Debug, Clone, Copy)]
pub struct ScaledStep {
    /// State at the start of the step.
    pub from: ScaledTime,
    /// Change of the slope, 1/s2.
    pub(crate) bend_1_s2: f64,
    /// Duration, s: a period or less.
    pub duration_s: f64,
    /// Number of the span.
    span: usize,
}

impl ScaledStep {
    /// Returns the state after a time.
    #[inline]
    pub fn after(&self, t: f64) -> ScaledTime {
        self.from.after(t, self.bend_1_s2)
    }

    /// Returns the motion of the axes after a time.
    pub fn motion(&self, plan: &PublishedPlan, t: f64) -> AxisMotion {
        let now = self.after(t);
        now.motion(&plan.in_span(self.span, now.tau_s), self.bend_1_s2)
    }
}

/// A plan that is being moved along.
#[derive(Debug)]
pub struct TimeScaling<'a> {
    plan: &'a PublishedPlan,
    limits: ScalingLimits,
    now: ScaledTime,
    /// The way to a rate that can stay, from now on.
    safe: Landing,
}

impl<'a> TimeScaling<'a> {
    /// Creates the scaling at the beginning of a plan, at rest.
    pub fn new(plan: &'a PublishedPlan, limits: ScalingLimits) -> Self {
        let now = ScaledTime {
            tau_s: 0.0,
            rate: 0.0,
            slope_1_s: 0.0,
        };
        Self {
            plan,
            limits,
            now,
            safe: Landing::default(),
        }
    }

    /// Creates the scaling at a moment of the plan, at the rate 1.
    pub fn from_moment(plan: &'a PublishedPlan, limits: ScalingLimits, tau_s: f64) -> Self {
        let now = ScaledTime {
            tau_s,
            rate: 1.0,
            slope_1_s: 0.0,
        };
        Self {
            now,
            ..Self::new(plan, limits)
        }
    }

    /// Returns the current plan time and rate.
    pub const fn now(&self) -> ScaledTime {
        self.now
    }

    /// Returns true if the plan rests here, whatever the rate.
    pub fn rests(&self) -> bool {
        let AxisMotion {
            velocity_mm_s,
            accel_mm_s2,
            ..
        } = self.plan.at(self.now.tau_s);
        norm(velocity_mm_s) < STILL_MM_S && norm(accel_mm_s2) < STILL_MM_S2
    }

    /// Returns true if the plan has ended.
    pub fn has_ended(&self) -> bool {
        self.now.tau_s >= self.plan.end_s()
    }

    /// Goes on for a step towards an override of feeds, 0 to [`MOST_OVERRIDE`]; a hold is one of 0
    /// that holds for rapids too.
    pub fn step(&mut self, override_of_feeds: f64, hold: bool) -> ScaledStep {
        let span = self.plan.span_at(self.now.tau_s);
        let wanted = if hold {
            0.0
        } else if span.cutting {
            override_of_feeds.clamp(0.0, MOST_OVERRIDE)
        } else {
            1.0
        };
        if span.is_rest || self.rests() {
            // At rest nothing keeps the rate from being any.
            let rate = if span.is_rest && !hold {
                1.0
            } else {
                wanted.min(1.0)
            };
            self.now = ScaledTime {
                rate,
                slope_1_s: 0.0,
                ..self.now
            };
            self.safe = Landing::default();
        }
        let next = self.choice(if span.is_rest && !hold { 1.0 } else { wanted });
        self.now = next.after(next.duration_s);
        if self.safe.is_over() {
            // What is left of a way is rounding.
            self.now = ScaledTime {
                rate: self.safe.rate(self.now.rate),
                slope_1_s: 0.0,
                ..self.now
            };
        }
        next
    }

    /// The next step; the way behind it is kept.
    fn choice(&mut self, wanted: f64) -> ScaledStep {
        let way = wanted - self.now.rate;
        if way == 0.0 && self.now.slope_1_s == 0.0 && self.now.rate <= 1.0 {
            self.safe = Landing::default();
            return step(self.plan, &self.limits, &self.now, 0.0);
        }
        let towards = if way < 0.0 || (way == 0.0 && self.now.slope_1_s > 0.0) {
            -1.0
        } else {
            1.0
        };
        if self.safe.is_over() && self.now.rate <= 1.0 && wanted <= 1.0 {
            // Where nothing faster is found, straight to what is wanted.
            self.safe = landing(self.plan, &self.limits, &self.now, wanted, 1.0 + ROUNDING)
                .unwrap_or_default();
        }
        // Where the override was lowered on the way up, the rate is above it for a while: no higher
        // than it was going to be.
        let most = wanted.max(1.0).max(self.now.rate).max(self.safe.highest()) + ROUNDING;
        if wanted > 1.0
            && let Some((step, behind)) = self.settling(wanted, towards, most)
        {
            self.safe = behind;
            return step;
        }
        let safe = self.safe.steps.pop_front();
        let mut good = safe.unwrap_or_else(|| step(self.plan, &self.limits, &self.now, 0.0));
        let mut bad = bounded(
            self.plan,
            &self.limits,
            &self.now,
            towards * MOST_BEND_1_S2,
            good.bend_1_s2,
        );
        if (bad - good.bend_1_s2) * towards > 0.0 {
            let mut bend = bad;
            for _ in 0..HALVINGS {
                let tried = step(self.plan, &self.limits, &self.now, bend);
                if let Some(found) = self.way_behind(&tried, wanted, towards, most) {
                    (good, self.safe) = (tried, found);
                } else {
                    bad = bend;
                }
                bend = 0.5 * (good.bend_1_s2 + bad);
            }
        }
        good
    }

    /// The first step of a way of few periods to an override above 1, without a slope there, and
    /// the way behind that step: near the override the fastest change would go up and down from
    /// period to period.
    fn settling(&self, wanted: f64, towards: f64, most: f64) -> Option<(ScaledStep, Landing)> {
        let way = landing_within(self.plan, &self.limits, &self.now, wanted, most, SETTLING)?;
        let first = way
            .steps
            .front()
            .copied()
            .unwrap_or_else(|| step(self.plan, &self.limits, &self.now, 0.0));
        Some((first, self.way_behind(&first, wanted, towards, most)?))
    }

    /// The way from behind a step to a rate that can stay, that does not pass the one that is
    /// wanted and rises to no more than `most`.
    fn way_behind(
        &self,
        tried: &ScaledStep,
        wanted: f64,
        towards: f64,
        most: f64,
    ) -> Option<Landing> {
        if !keeps(self.plan, &self.limits, tried) {
            return None;
        }
        let next = tried.after(tried.duration_s);
        if next.rate < 0.0 || next.rate > most || (wanted - next.rate) * towards < 0.0 {
            return None;
        }
        if wanted <= 1.0 {
            let found = landing_anywhere(self.plan, &self.limits, &next, wanted, towards, most);
            return found.or_else(|| landing(self.plan, &self.limits, &next, wanted, most));
        }
        // Above 1 no rate can stay but 1.
        landing(self.plan, &self.limits, &next, 1.0, most)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Step of a central difference, s, and its allowed error: the square of the step times higher
    /// derivatives below 1000.
    const H_S: f64 = 1e-3;
    const OFF: f64 = 1e-3;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_time_and_another_are_both_together(
            (rate, slope_1_s, bend_1_s2) in (0.0..2.0_f64, -3.0..3.0_f64, -9.0..9.0_f64),
            (a_s, b_s) in (0.0..1.0_f64, 0.0..1.0_f64),
        ) {
            let from = ScaledTime { tau_s: 0.3, rate, slope_1_s };
            let at_once = from.after(a_s + b_s, bend_1_s2);
            let in_turn = from.after(a_s, bend_1_s2).after(b_s, bend_1_s2);
            let parts = |time: ScaledTime| [time.tau_s, time.rate, time.slope_1_s];
            for (one, other) in parts(at_once).into_iter().zip(parts(in_turn)) {
                prop_assert!((one - other).abs() < 1e-12, "{at_once:?} and {in_turn:?}");
            }
        }

        #[test]
        fn axes_do_what_the_derivatives_of_their_position_by_time_say(
            (rate, slope_1_s, bend_1_s2) in (0.2..1.5_f64, -2.0..2.0_f64, -5.0..5.0_f64),
            (v, a, j) in (-2.0..2.0_f64, -2.0..2.0_f64, -2.0..2.0_f64),
        ) {
            let [velocity_mm_s, accel_mm_s2, jerk_mm_s3] = [v, a, j].map(|number| [number, -number, 0.5 * number]);
            let planned = AxisMotion { position_mm: [1.0, 2.0, 3.0], velocity_mm_s, accel_mm_s2, jerk_mm_s3 };
            let from = ScaledTime { tau_s: 0.0, rate, slope_1_s };
            let moved = from.motion(&planned, bend_1_s2);
            for k in 0..3 {
                let p = |n: f64| planned.after(from.after(n * H_S, bend_1_s2).tau_s).position_mm[k];
                let derivatives = [
                    (moved.velocity_mm_s[k], (p(1.0) - p(-1.0)) / (2.0 * H_S)),
                    (moved.accel_mm_s2[k], (p(1.0) - 2.0 * p(0.0) + p(-1.0)) / H_S.powi(2)),
                    (moved.jerk_mm_s3[k], (p(2.0) - 2.0 * p(1.0) + 2.0 * p(-1.0) - p(-2.0)) / (2.0 * H_S.powi(3))),
                ];
                for (is, should) in derivatives {
                    prop_assert!((is - should).abs() < OFF, "{is} in place of {should}: {moved:?}");
                }
            }
        }
    }
}
