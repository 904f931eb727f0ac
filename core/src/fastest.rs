//! Least time within a tolerance of the tool: speed is held down only where the simulated tool would leave it.
//!
//! The tolerance of the tool is shared between the planned path and the error of the servo and its controller. The program is planned
//! and cut; where the tool was further away than it may be, the speed there is capped, where it was nearer than it may be, a cap is
//! raised; then planned and cut again. A contour error grows about with the square of the speed, so a cap changes by the root of what
//! is missing. The fastest plan whose cut stayed within the tolerance is taken.

use std::collections::VecDeque;
use std::io;
use std::sync::Arc;

use feedwright_control::Controller;
use thiserror::Error;

use crate::constraints::Constraints;
use crate::constraints::speed_caps::SpeedCaps;
use crate::cycle_time::{CycleTime, cycle_time_within};
use crate::gcode::ReadError;
use crate::gcode::canon::Corner;
use crate::machine::Machine;
use crate::path::{Step, Steps};
use crate::pipeline::{Run, RunError};
use crate::trace::{Outcome, Row, Sink};
use crate::vector::distance;
use crate::watch::Watch;

/// Distance of caps along the path, mm.
const SPACING_MM: f64 = 0.1;

/// Part of the tolerance that is aimed at.
const AIM: f64 = 0.995;

/// How often the program is planned and cut, and after how many cuts within the tolerance without a gain it is enough.
const ROUNDS: u32 = 24;
const NO_GAIN: u32 = 3;

/// A gain of less than this part of the time is none.
const LEAST_GAIN: f64 = 1e-3;

/// From this round on caps are lowered only.
const ONLY_LOWER: u32 = 18;

/// Part of the tolerance that the path has at first, where the controller errs little, and where it errs much.
const FIRST_SHARE: f64 = 0.9;
const LARGE_SHARE: f64 = 0.03;

/// A controller errs little where the first cut is within so many tolerances.
const LITTLE: f64 = 1.6;

/// Where no cut was within the tolerance yet, and in so many none came nearer by this part, none will.
const NO_NEARER: u32 = 3;
const NEARER: f64 = 0.05;

/// A cap is lowered by no more than this factor at once, and raised by no more than that.
const LOWERED: f64 = 0.5;
const RAISED: f64 = 1.25;

/// What a cap is raised by is damped by this power.
const DAMPED: f64 = 0.7;

/// Lowest cap: where the tool is too far away at this speed, speed is not what takes it there, mm/s.
const LOWEST_MM_S: f64 = 0.2;

/// Rows that are kept to find the place of the tool's foot.
const KEPT: usize = 1000;

/// A plan within the tolerance.
#[derive(Debug, Clone)]
pub struct FastestPlan {
    /// The machine with the tolerance of the path.
    pub machine: Machine,
    /// Bounds on the speed.
    pub caps: Arc<SpeedCaps>,
    /// Largest distance of the tool from the path, um.
    pub largest_um: f64,
    /// What the plan takes and what binds; its bound is that of the path alone, with the whole tolerance.
    pub cycle: CycleTime,
    /// How often it was planned and cut.
    pub rounds: u32,
}

/// Why there is none.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum FastestError {
    /// Not planned axis by axis.
    #[error(
        "the least time within a tolerance is planned axis by axis, and the axes of {machine} have no limits of their own"
    )]
    #[diagnostic(help("give each axis max_velocity_mm_s, max_accel_mm_s2 and max_jerk_mm_s3"))]
    NoLimits {
        /// Name of the machine.
        machine: String,
    },
    /// The tool is too far away however slow it is.
    #[error("line {line}: the tool is {error_um:.2} um away, and {tolerance_um} um are allowed; {reason}")]
    Impossible {
        /// Where it is furthest away.
        line: u32,
        /// How far, um.
        error_um: f64,
        /// What is allowed, um.
        tolerance_um: f64,
        /// Why.
        reason: &'static str,
    },
    /// A run did not come to its end.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Run(#[from] RunError),
}

/// Finds the fastest plan of a program that a controller cuts within a tolerance on a machine; `laps` as in [`Run::laps`].
///
/// # Errors
/// See [`FastestError`].
pub fn fastest<'p, const N: usize>(
    machine: &Machine,
    tolerance_um: f64,
    mut steps: impl FnMut() -> Result<Steps<'p>, ReadError>,
    controller: &mut dyn Controller<N>,
    laps: u32,
    watch: &dyn Watch,
) -> Result<FastestPlan, FastestError> {
    let within = |share: f64| with_path_tolerance(machine, share * tolerance_um);
    if !within(1.0).has_axis_limits() {
        return Err(FastestError::NoLimits { machine: machine.name.clone() });
    }
    let (mut share, mut caps) = (FIRST_SHARE, Arc::new(SpeedCaps::none(SPACING_MM)));
    let mut found = FastestRun { best: None, since: 0, nearest_um: f64::INFINITY, no_nearer: 0 };
    let (mut rounds, mut worst, mut diverged) = (0, (0.0, 0), false);
    while rounds < ROUNDS && found.since < NO_GAIN && found.no_nearer < NO_NEARER {
        watch.check().map_err(RunError::from)?;
        rounds += 1;
        let planned = within(share);
        let mut spots = Spots::default();
        let path_um = share * tolerance_um;
        let run = Run::on(&planned).capped(Some(&caps)).laps(laps).watched(watch).cut(
            || Ok(with_tolerance(steps()?, 1e-3 * path_um)),
            controller,
            &mut [&mut spots],
        )?;
        diverged = run.outcome != Outcome::Completed;
        let (error_um, line) = spots.worst();
        worst = (error_um, line);
        if diverged {
            break;
        }
        found.take_in([spots.time_s, error_um, share], &caps, tolerance_um);
        if error_um <= tolerance_um && caps.caps_mm_s.iter().all(|cap| cap.is_infinite()) {
            break;
        }
        if rounds == 1 {
            share = share_of_path(error_um / tolerance_um);
        } else {
            caps = Arc::new(spots.corrected(&caps, 1e-3 * tolerance_um, rounds >= ONLY_LOWER));
        }
    }
    let Some(([_, largest_um, share], caps)) = found.best else {
        let (error_um, line) = worst;
        return Err(FastestError::Impossible { line, error_um, tolerance_um, reason: reason(diverged, &caps) });
    };
    let planned = within(share);
    let constraints = Constraints { speed_caps: Some(caps.clone()), ..Constraints::from(&planned) };
    let mut cycle_of = |machine: &Machine, constraints: &Constraints, share: f64, bound: bool| {
        let path_mm = 1e-3 * share * tolerance_um;
        cycle_time_within(machine, constraints, bound, || Ok(with_tolerance(steps()?, path_mm)), watch)
    };
    let mut cycle = cycle_of(&planned, &constraints, share, false)?;
    let whole = within(1.0);
    cycle.bound_s = cycle_of(&whole, &Constraints::from(&whole), 1.0, true)?.bound_s;
    Ok(FastestPlan { machine: planned, caps, largest_um, cycle, rounds })
}

/// What rounds have found so far.
struct FastestRun {
    /// Time, s, largest error, um, share of the path, and caps of the fastest that is within the tolerance.
    best: Option<([f64; 3], Arc<SpeedCaps>)>,
    /// Rounds since it has become faster.
    since: u32,
    /// Before there is one: the least of the largest errors, um, and rounds since it has become less.
    nearest_um: f64,
    no_nearer: u32,
}

impl FastestRun {
    /// A round with this time, s, largest error, um, and share of the path.
    fn take_in(&mut self, round: [f64; 3], caps: &Arc<SpeedCaps>, tolerance_um: f64) {
        let [time_s, error_um, _] = round;
        if error_um <= tolerance_um {
            let faster_than = |part: f64| self.best.as_ref().is_none_or(|([best_s, ..], _)| time_s < part * best_s);
            self.since = if faster_than(1.0 - LEAST_GAIN) { 0 } else { self.since + 1 };
            if faster_than(1.0) {
                self.best = Some((round, caps.clone()));
            }
        }
        self.no_nearer =
            if self.best.is_some() || error_um < (1.0 - NEARER) * self.nearest_um { 0 } else { self.no_nearer + 1 };
        self.nearest_um = self.nearest_um.min(error_um);
    }
}

fn with_path_tolerance(machine: &Machine, tolerance_um: f64) -> Machine {
    let mut machine = machine.clone();
    machine.limits.path_tolerance_um = Some(tolerance_um);
    machine
}

/// Share of the tolerance that is the path's, where the tool was so many times the tolerance away with [`FIRST_SHARE`]: what the path leaves to the
/// servo is what the servo was seen to need.
fn share_of_path(error: f64) -> f64 {
    let servo = error - FIRST_SHARE;
    let share = if error < LITTLE { (1.0 - 1.1 * servo.max(0.0)).max(LARGE_SHARE) } else { LARGE_SHARE };
    share.min(FIRST_SHARE)
}

/// Why there is no plan.
fn reason(diverged: bool, caps: &SpeedCaps) -> &'static str {
    if diverged {
        "the servo loop is unstable"
    } else if caps.caps_mm_s.iter().any(|&cap| cap <= LOWEST_MM_S) {
        "that is no matter of speed: noise, friction or geometry takes it there"
    } else {
        "lower speeds brought it no nearer"
    }
}

/// The same path with another tolerance where it is not to be kept exactly.
pub fn with_tolerance<'p>(steps: Steps<'p>, tolerance_mm: f64) -> Steps<'p> {
    Box::new(steps.map(move |step| {
        step.map(|step| match step {
            Step::Piece(mut piece) => {
                if matches!(piece.corner, Corner::Continuous { .. }) {
                    piece.corner = Corner::Continuous { tolerance_mm: Some(tolerance_mm), merge_mm: None };
                }
                Step::Piece(piece)
            }
            other => other,
        })
    }))
}

/// What a cut was like around a place of the path.
#[derive(Debug, Clone, Copy, Default)]
struct Spot {
    /// Largest contour error, mm.
    error_mm: f64,
    line: u32,
    /// Sum of the planned speeds, and their number.
    speeds_mm_s: f64,
    count: u32,
}

/// Sorts what rows say by places of the path.
#[derive(Debug, Default)]
struct Spots {
    spots: Vec<Spot>,
    /// Places of the command that the tool may still be at.
    behind: VecDeque<(f64, [f64; 3])>,
    time_s: f64,
}

impl Spots {
    fn spot(&mut self, s_mm: f64) -> &mut Spot {
        let i = (s_mm / SPACING_MM).round().max(0.0) as usize;
        if i >= self.spots.len() {
            self.spots.resize(i + 1, Spot::default());
        }
        &mut self.spots[i]
    }

    fn worst(&self) -> (f64, u32) {
        let worst = self.spots.iter().max_by(|a, b| a.error_mm.total_cmp(&b.error_mm));
        worst.map_or((0.0, 0), |spot| (1e3 * spot.error_mm, spot.line))
    }

    /// Caps for the next round.
    fn corrected(&self, caps: &SpeedCaps, tolerance_mm: f64, only_lower: bool) -> SpeedCaps {
        let n = self.spots.len();
        let aim_mm = AIM * tolerance_mm;
        let old = |i: usize| caps.caps_mm_s.get(i).copied().unwrap_or(f64::INFINITY);
        let mut next: Vec<f64> = (0..n).map(old).collect();
        for (i, spot) in self.spots.iter().enumerate() {
            if spot.error_mm <= 0.0 {
                continue;
            }
            let factor = (aim_mm / spot.error_mm).sqrt();
            if factor < 1.0 {
                let near = &self.spots[i.saturating_sub(1)..(i + 2).min(n)];
                let (sum, count) =
                    near.iter().fold((0.0, 0), |(sum, count), spot| (sum + spot.speeds_mm_s, count + spot.count));
                if count == 0 {
                    continue;
                }
                let now_mm_s = (sum / f64::from(count)).min(old(i));
                let lower_mm_s = (now_mm_s * factor.max(LOWERED)).max(LOWEST_MM_S);
                for cap in &mut next[i.saturating_sub(1)..(i + 2).min(n)] {
                    *cap = cap.min(lower_mm_s);
                }
            }
        }
        for i in 0..n {
            let spot = self.spots[i];
            let near = &self.spots[i.saturating_sub(1)..(i + 2).min(n)];
            let error_mm = near.iter().map(|spot| spot.error_mm).fold(0.0, f64::max);
            if !only_lower && spot.error_mm > 0.0 && error_mm < aim_mm && next[i].is_finite() {
                next[i] *= (aim_mm / error_mm).sqrt().min(RAISED).powf(DAMPED);
            }
        }
        SpeedCaps { spacing_mm: SPACING_MM, caps_mm_s: next }
    }
}

impl Sink for Spots {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        self.time_s = row.t_s;
        let planned = self.spot(row.s_mm);
        planned.speeds_mm_s += row.feed_plan_mm_s;
        planned.count += 1;
        self.behind.push_back((row.s_mm, row.path_mm));
        if self.behind.len() > KEPT {
            self.behind.pop_front();
        }
        while let [here, next] = [0, 1].map(|i| self.behind.get(i))
            && let (Some(here), Some(next)) = (here, next)
            && distance(next.1, row.foot_mm) <= distance(here.1, row.foot_mm)
        {
            self.behind.pop_front();
        }
        let Some(&(s_mm, _)) = self.behind.front() else {
            return Ok(());
        };
        if row.cutting {
            let (error_mm, line) = (row.contour_error_mm.abs(), row.line);
            let spot = self.spot(s_mm);
            if error_mm > spot.error_mm {
                (spot.error_mm, spot.line) = (error_mm, line);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn caps_are_lowered_where_the_tool_is_too_far_away_and_raised_where_it_is_near() {
        let spot = |error_mm: f64| Spot { error_mm, line: 1, speeds_mm_s: 40.0, count: 2 };
        let mut spots = Spots { spots: vec![spot(0.01 * AIM); 9], ..Spots::default() };
        spots.spots[4] = spot(0.02 * AIM);
        let lower = spots.corrected(&SpeedCaps::none(SPACING_MM), 0.01, false);
        let lowered_mm_s = 20.0 * 0.5_f64.sqrt();
        for (i, cap) in lower.caps_mm_s.iter().enumerate() {
            let expected = if (3..=5).contains(&i) { lowered_mm_s } else { f64::INFINITY };
            assert!(cap.to_bits() == expected.to_bits() || (cap - expected).abs() < 1e-9, "{i}: {cap}");
        }
        spots.spots.iter_mut().for_each(|spot| spot.error_mm = 0.005 * AIM);
        let raised = spots.corrected(&lower, 0.01, false);
        assert!(raised.caps_mm_s[4] > 1.1 * lowered_mm_s && raised.caps_mm_s[4] < RAISED * lowered_mm_s);
        assert_eq!(spots.corrected(&lower, 0.01, true), lower);
    }
}
