//! Cycle time of a program on a machine: the duration of its plan, by tool and kind of motion, the
//! limits that bind, and the largest violation of a limit.
//!
//! The plan is sampled as it is generated, every 0.1 ms; memory does not grow with the program.
//! `cycle_time/along.rs` records the limits that bind along the path.

pub mod along;

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use feedwright_gcode::ReadError;
use feedwright_gcode::canon::{Corner, EventKind};
use feedwright_plan::vector::{distance, dot, norm, sub};
use feedwright_plan::{
    AxisLimits, AxisMotion, Constraints, FeedMember, PathLimits, Phase, Piece, Plan, PlanSink,
    Planned, Plc, Steps, WHOLE_PROGRAM, feed_mm_s,
};
use serde::Serialize;

use crate::machine::{AXIS_NAMES, Machine};
use crate::pipeline::{RunError, Stages};
use crate::watch::{Cancelled, StageSteps, Watch};
use along::{BindingAlong, BindingStretch, LIMITS};

/// Time between two samples, s.
const SAMPLE_S: f64 = 1e-4;

/// Fraction of a limit from which it binds.
const BINDS: f64 = 0.999;

/// Fraction of the tolerance from which it binds: a planner reserves a part of it for effects that
/// it does not check.
const TOLERANCE_BINDS: f64 = 0.8;

/// Fraction of a speed cap, which is kept only approximately, from which it binds.
const CAP_BINDS: f64 = 0.98;

/// A cut below this fraction of the programmed feedrate is slow: chips get thin, and a tool that
/// only rubs wears.
const SLOW: f64 = 0.8;

/// Fractions of the axes' acceleration that LinuxCNC uses along the path, and across it where the
/// path turns.
const TANGENTIAL: f64 = 0.5;
const NORMAL: f64 = 0.866;

/// Index of the first of the limits along the path, in the order of [`limit_names`].
const OF_PATH: usize = LIMITS - 3;

/// The search for the nearest point covers this many tolerances of path to either side.
const WAY: f64 = 10.0;
/// Largest number of pieces that the search for the nearest point covers to either side.
const MOST_PIECES: usize = 64;

/// Time of one tool.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ToolTime {
    /// Its number; 0 before the first tool change.
    pub tool: u32,
    /// Time of motion and rests with the tool, s.
    pub time_s: f64,
}

/// Time of one line of the program.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LineTime {
    /// Number of the line.
    pub line: u32,
    /// Time of motion and rests that the line asks for, s, summed over all of its runs.
    pub time_s: f64,
    /// Time of rests alone, s.
    pub waiting_s: f64,
}

/// Results to compute beside the cycle time.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct CycleTimeOptions {
    /// Plans once more for the bound of the motion.
    pub bound: bool,
    /// Keeps the time of each line.
    pub lines: bool,
    /// Length of the path, mm, for the progress; 0 if it is not known.
    pub length_mm: f64,
}

/// A limit with the part of the moving time in which it binds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BindingShare {
    /// Name of the limit, such as `feedrate`, `x jerk`, `tolerance`.
    pub limit: String,
    /// Part of the moving time, 0 to 1; limits bind together, so parts do not add up to 1.
    pub share: f64,
}

/// Cycle time of a program, its parts, and the limits that bind.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct CycleTime {
    /// Name of the planner.
    pub planner: String,
    /// Motions of the program.
    pub blocks: u64,
    /// Total time, s.
    pub time_s: f64,
    /// Time at feedrates, s.
    pub cutting_s: f64,
    /// Time of rapids, s.
    pub rapid_s: f64,
    /// Time of dwells, tool changes and spindle starts, s.
    pub waiting_s: f64,
    /// Time of the motion alone, s, with each path from rest to rest planned as a whole, if
    /// requested.
    pub bound_s: Option<f64>,
    /// Largest ratio of a velocity, acceleration or jerk to its limit, or of the speed to the
    /// feedrate; none if axes have no limits.
    pub largest_violation: Option<f64>,
    /// Largest distance of the planned motion from the programmed path, um.
    pub largest_deviation_um: f64,
    /// Time of each tool, in the order of use.
    pub tools: Vec<ToolTime>,
    /// Part of the cutting time in which the planned speed is below 0.8 of the programmed feedrate.
    pub slow_share: f64,
    /// Limits that bind, the most frequent first; limits that never bind are left out.
    pub binding: Vec<BindingShare>,
    /// Time of each line in order, if requested.
    #[serde(skip)]
    pub lines: Vec<LineTime>,
    /// Limits that bind along the path.
    #[serde(skip)]
    pub along: BindingAlong,
}

/// Returns the names of limits, in the order in which they are counted everywhere.
pub fn limit_names() -> Vec<String> {
    let of_axis =
        |name: &str| ["velocity", "acceleration", "jerk"].map(|limit| format!("{name} {limit}"));
    let axes = AXIS_NAMES.iter().flat_map(|name| of_axis(name));
    let first = ["feedrate", "tolerance"].map(str::to_owned);
    let of_path = [
        "acceleration along the path",
        "acceleration across the path",
        "corners",
    ]
    .map(str::to_owned);
    first.into_iter().chain(axes).chain(of_path).collect()
}

/// Plans a program by the stages that suit a machine. It reads `steps` once, and once more for the
/// bound if `bound` is true.
///
/// # Errors
/// Fails if the program cannot be read, a motion has no path, a limit is not a valid number, or
/// `watch` cancels the work.
pub fn cycle_time<'p>(
    machine: &Machine,
    bound: bool,
    steps: impl FnMut() -> Result<Steps<'p>, ReadError>,
    watch: &dyn Watch,
) -> Result<CycleTime, RunError> {
    cycle_time_within(machine, &Constraints::from(machine), bound, steps, watch)
}

/// Computes the cycle time within other constraints than the constraints of the machine.
///
/// # Errors
/// The same as [`cycle_time`].
pub fn cycle_time_within<'p>(
    machine: &Machine,
    constraints: &Constraints,
    bound: bool,
    steps: impl FnMut() -> Result<Steps<'p>, ReadError>,
    watch: &dyn Watch,
) -> Result<CycleTime, RunError> {
    let options = CycleTimeOptions {
        bound,
        ..CycleTimeOptions::default()
    };
    cycle_time_by(
        Stages::of(machine),
        machine,
        constraints,
        options,
        steps,
        watch,
    )
}

/// Computes the cycle time with given stages and further options.
///
/// # Errors
/// The same as [`cycle_time`].
pub fn cycle_time_by<'p>(
    stages: Stages,
    machine: &Machine,
    constraints: &Constraints,
    options: CycleTimeOptions,
    mut steps: impl FnMut() -> Result<Steps<'p>, ReadError>,
    watch: &dyn Watch,
) -> Result<CycleTime, RunError> {
    let mut plan = Plan::new(steps()?, constraints, stages.planner, Plc::from(machine))?;
    let mut sampler = Sampler::new(constraints, stages.planner);
    sampler.lines = options.lines.then(Vec::new);
    let mut progress = (options.length_mm > 0.0).then(|| StageSteps::begin(watch, "planning"));
    for planned in plan.by_ref() {
        watch.check()?;
        sampler.take(&planned);
        if let Some(progress) = &mut progress {
            progress.reach(sampler.sample.to_mm / options.length_mm);
        }
    }
    if let Some(fault) = plan.fault() {
        return Err(fault.clone().into());
    }
    let mut result = sampler.finish();
    if options.bound && stages.planner.needs_axes {
        let mut time_s = 0.0;
        bound_of_motion(constraints, steps, |phase| {
            time_s += phase.duration_s;
            watch.check()
        })?;
        result.bound_s = Some(time_s);
    }
    Ok(result)
}

/// Plans each path from rest to rest as a whole, and hands out the phases of motion of each path
/// once it is planned. No plan can be much faster.
///
/// # Errors
/// The same as [`cycle_time`].
pub fn bound_of_motion<'p>(
    constraints: &Constraints,
    mut steps: impl FnMut() -> Result<Steps<'p>, ReadError>,
    mut moves: impl FnMut(&Phase) -> Result<(), Cancelled>,
) -> Result<(), RunError> {
    for planned in Plan::new(steps()?, constraints, &WHOLE_PROGRAM, Plc::default())? {
        if let Planned::Phase(phase @ Phase { rest: None, .. }) = &planned {
            moves(phase)?;
        }
    }
    Ok(())
}

/// Cycle time of the plan of a cut. It receives that plan as a [`PlanSink`], so the program is not
/// planned again.
#[derive(Debug)]
pub struct CycleTimeOfCut<'a>(Mutex<Sampler<'a>>);

impl<'a> CycleTimeOfCut<'a> {
    /// Creates the sink for a plan within constraints, by a planner.
    pub fn new(constraints: &'a Constraints, planner: &'static FeedMember) -> Self {
        Self(Mutex::new(Sampler::new(constraints, planner)))
    }

    /// Returns the cycle time of the plan, complete if the plan was handed out to its end.
    pub fn finish(self) -> CycleTime {
        self.0
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner)
            .finish()
    }
}

impl PlanSink for CycleTimeOfCut<'_> {
    fn planned(&self, planned: &Planned) {
        self.0
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take(planned);
    }
}

/// Values that hold on a piece.
#[derive(Clone, Copy)]
struct PiecePlace {
    /// Index of the piece among the pieces that are kept.
    index: usize,
    s_mm: f64,
    line: u32,
    /// Programmed feedrate F, if the piece cuts.
    programmed_mm_s: Option<f64>,
    feed_mm_s: f64,
    tolerance_mm: f64,
}

/// Samples a plan as it is generated.
#[derive(Debug)]
struct Sampler<'a> {
    constraints: &'a Constraints,
    planner: &'static FeedMember,
    result: CycleTime,
    pieces: VecDeque<Piece>,
    /// Number of the first piece that is kept.
    first: u64,
    /// The tool that the next M6 loads.
    selected: u32,
    /// Time in which each limit binds, in the order of [`limit_names`].
    bound_s: [f64; LIMITS],
    /// Time of each line, indexed by its number, if it is kept; `line` is 0 for a line without
    /// time.
    lines: Option<Vec<LineTime>>,
    /// Cutting time below [`SLOW`] of the programmed feedrate, s.
    slow_s: f64,
    /// The sample under way.
    sample: BindingStretch,
}

impl<'a> Sampler<'a> {
    fn new(constraints: &'a Constraints, planner: &'static FeedMember) -> Self {
        let result = CycleTime {
            planner: planner.name.to_owned(),
            tools: vec![ToolTime {
                tool: 0,
                time_s: 0.0,
            }],
            ..CycleTime::default()
        };
        Self {
            constraints,
            planner,
            result,
            pieces: VecDeque::new(),
            first: 0,
            selected: 0,
            bound_s: [0.0; LIMITS],
            lines: None,
            slow_s: 0.0,
            sample: BindingStretch::default(),
        }
    }

    fn take(&mut self, planned: &Planned) {
        match planned {
            Planned::Programmed(piece) => {
                self.result.blocks += 1;
                self.pieces.push_back(piece.clone());
            }
            Planned::Piece(_) => {}
            Planned::Event(event) => match &event.event.kind {
                EventKind::ToolSelect { tool } => self.selected = *tool,
                EventKind::MCode { code: 6, .. } => {
                    self.result.tools.push(ToolTime {
                        tool: self.selected,
                        time_s: 0.0,
                    });
                }
                _ => {}
            },
            Planned::Phase(phase) => self.phase(phase),
        }
    }

    fn phase(&mut self, phase: &Phase) {
        let duration_s = phase.duration_s;
        self.result.time_s += duration_s;
        if let Some(tool) = self.result.tools.last_mut() {
            tool.time_s += duration_s;
        }
        if let Some(line) = phase.rest {
            self.result.waiting_s += duration_s;
            self.line_takes(line, duration_s, duration_s);
            return;
        }
        while self.first + (MOST_PIECES as u64) < phase.piece && self.pieces.len() > 1 {
            self.pieces.pop_front();
            self.first += 1;
        }
        let index = (phase.piece - self.first) as usize;
        let Some(piece) = self.pieces.get(index) else {
            return;
        };
        if piece.cutting {
            self.result.cutting_s += duration_s;
        } else {
            self.result.rapid_s += duration_s;
        }
        let at = PiecePlace {
            index,
            s_mm: piece.s_mm,
            line: piece.line,
            programmed_mm_s: piece.cutting.then_some(piece.feed_mm_s),
            feed_mm_s: feed_mm_s(piece, self.constraints),
            tolerance_mm: self.tolerance_mm(piece),
        };
        self.line_takes(at.line, duration_s, 0.0);
        let count = (duration_s / SAMPLE_S).ceil().max(1.0);
        for i in 0..count as u32 {
            self.look_at(
                phase,
                at,
                duration_s * (f64::from(i) + 0.5) / count,
                duration_s / count,
            );
        }
        // Acceleration is linear over a phase: the extremes are at its ends.
        for motion in phase
            .motion
            .into_iter()
            .flat_map(|motion| [motion, motion.after(duration_s)])
        {
            self.axes(&motion, 0.0);
        }
    }

    /// Samples a moment of a phase; it represents the time `time_s`.
    fn look_at(&mut self, phase: &Phase, at: PiecePlace, t: f64, time_s: f64) {
        let PiecePlace {
            index,
            s_mm,
            line,
            programmed_mm_s,
            feed_mm_s,
            tolerance_mm,
        } = at;
        let to_mm = s_mm + phase.place_mm(t);
        let way_mm = phase.speed_mm_s(t) * time_s;
        self.sample = BindingStretch {
            duration_s: time_s,
            to_mm,
            way_mm,
            lines: [line, line],
            ..Default::default()
        };
        if let Some(motion) = phase.motion.map(|motion| motion.after(t)) {
            let speed_mm_s = norm(motion.velocity_mm_s);
            self.sample.way_mm = speed_mm_s * time_s;
            self.axes(&motion, time_s);
            self.violated(speed_mm_s / feed_mm_s);
            self.binds(0, speed_mm_s / feed_mm_s, BINDS, time_s);
            let away_mm = self.distance_mm(index, motion.position_mm, tolerance_mm);
            self.result.largest_deviation_um = self.result.largest_deviation_um.max(1e3 * away_mm);
            let cap_mm_s = self
                .constraints
                .speed_caps
                .as_ref()
                .map_or(f64::INFINITY, |caps| caps.at(to_mm));
            // A speed cap keeps the tool within the tolerance, so a speed at its cap counts as
            // bound by the tolerance.
            let used = if speed_mm_s >= CAP_BINDS * cap_mm_s {
                1.0
            } else {
                away_mm / tolerance_mm
            };
            self.binds(1, used, TOLERANCE_BINDS, time_s);
            if !self.planner.limits_jerk {
                let (along, across) = self.shares_of_acceleration(&motion);
                self.path(
                    [speed_mm_s / feed_mm_s, along / TANGENTIAL, across / NORMAL],
                    time_s,
                );
            }
        } else {
            let PathLimits {
                tangential_accel_mm_s2,
                normal_accel_mm_s2,
                ..
            } = self.constraints.path;
            let (speed_mm_s, accel_mm_s2) = (
                phase.speed_mm_s(t),
                phase.accel_mm_s2 + phase.jerk_mm_s3 * t,
            );
            let curvature_1_mm = self.pieces[index].curve.curvature(phase.place_mm(t));
            let feedrate = speed_mm_s / feed_mm_s;
            let across = speed_mm_s * speed_mm_s * curvature_1_mm / normal_accel_mm_s2;
            self.binds(0, feedrate, BINDS, time_s);
            self.path(
                [feedrate, accel_mm_s2.abs() / tangential_accel_mm_s2, across],
                time_s,
            );
        }
        if programmed_mm_s.is_some_and(|feed_mm_s| self.sample.way_mm < SLOW * feed_mm_s * time_s) {
            self.slow_s += time_s;
        }
        self.result.along.push(&self.sample);
    }

    /// Finds the binding limits of a planner with limits along and across the path, from the used
    /// shares of feedrate and of both limits. A motion is held down by a corner if it is slower
    /// than the feedrate, and neither its acceleration along the path nor across it reaches the
    /// limit.
    fn path(&mut self, [feedrate, along, across]: [f64; 3], time_s: f64) {
        self.binds(OF_PATH, along, BINDS, time_s);
        self.binds(OF_PATH + 1, across, BINDS, time_s);
        if feedrate.max(along).max(across) < BINDS {
            self.binds(OF_PATH + 2, 1.0, BINDS, time_s);
        }
    }

    /// Returns the acceleration along and across the motion, each relative to the axes' limits in
    /// its direction.
    fn shares_of_acceleration(&self, motion: &AxisMotion) -> (f64, f64) {
        let AxisMotion {
            velocity_mm_s,
            accel_mm_s2,
            ..
        } = motion;
        let speed_mm_s = norm(*velocity_mm_s);
        if speed_mm_s == 0.0 {
            return (0.0, 0.0);
        }
        let tangent = velocity_mm_s.map(|part| part / speed_mm_s);
        let along_mm_s2 = dot(*accel_mm_s2, tangent);
        let along = tangent.map(|part| along_mm_s2 * part);
        let used = |part: [f64; 3]| {
            let ratio = |(k, part_mm_s2): (usize, f64)| {
                self.constraints
                    .axis(k)
                    .map_or(0.0, |limits| part_mm_s2.abs() / limits.accel_mm_s2)
            };
            part.into_iter().enumerate().map(ratio).fold(0.0, f64::max)
        };
        (used(along), used(sub(*accel_mm_s2, along)))
    }

    fn line_takes(&mut self, line: u32, time_s: f64, waiting_s: f64) {
        if let Some(lines) = &mut self.lines {
            let index = line as usize;
            if lines.len() <= index {
                lines.resize(
                    index + 1,
                    LineTime {
                        line: 0,
                        time_s: 0.0,
                        waiting_s: 0.0,
                    },
                );
            }
            let of_line = &mut lines[index];
            of_line.line = line;
            of_line.time_s += time_s;
            of_line.waiting_s += waiting_s;
        }
    }

    fn tolerance_mm(&self, piece: &Piece) -> f64 {
        let machine_mm = self.constraints.path_tolerance_mm.unwrap_or(f64::INFINITY);
        match piece.corner {
            Corner::Continuous {
                tolerance_mm: Some(tolerance_mm),
                ..
            } => tolerance_mm,
            _ => machine_mm,
        }
    }

    fn violated(&mut self, ratio: f64) {
        self.result.largest_violation =
            Some(self.result.largest_violation.unwrap_or(0.0).max(ratio));
    }

    fn binds(&mut self, limit: usize, ratio: f64, least: f64, time_s: f64) {
        if ratio >= least {
            self.bound_s[limit] += time_s;
            self.sample.bound_s[limit] += time_s;
        }
    }

    fn axes(&mut self, motion: &AxisMotion, time_s: f64) {
        for k in 0..AXIS_NAMES.len() {
            let Some(AxisLimits {
                velocity_mm_s,
                accel_mm_s2,
                jerk_mm_s3,
            }) = self.constraints.axis(k)
            else {
                return;
            };
            let ratios = [
                motion.velocity_mm_s[k].abs() / velocity_mm_s,
                motion.accel_mm_s2[k].abs() / accel_mm_s2,
                motion.jerk_mm_s3[k].abs() / jerk_mm_s3,
            ];
            for (limit, ratio) in ratios.into_iter().enumerate() {
                self.violated(ratio);
                self.binds(2 + 3 * k + limit, ratio, BINDS, time_s);
            }
        }
    }

    /// Returns the distance of a point from the programmed path around a piece, mm.
    fn distance_mm(&self, index: usize, point_mm: [f64; 3], tolerance_mm: f64) -> f64 {
        let mut least = f64::INFINITY;
        let mut look = |piece: &Piece| {
            let s_mm = piece.curve.nearest(point_mm, 0.0, piece.length_mm);
            for s_mm in [0.0, s_mm, piece.length_mm] {
                least = least.min(distance(piece.curve.at(s_mm).position_mm, point_mm));
            }
        };
        for further in [1_isize, -1] {
            let mut way_mm = 0.0;
            let mut at = index as isize;
            for _ in 0..MOST_PIECES {
                let Some(piece) = usize::try_from(at).ok().and_then(|at| self.pieces.get(at))
                else {
                    break;
                };
                look(piece);
                if at != index as isize {
                    way_mm += piece.length_mm;
                }
                if way_mm > WAY * tolerance_mm {
                    break;
                }
                at += further;
            }
        }
        least
    }

    fn finish(self) -> CycleTime {
        let mut result = self.result;
        let moving_s = (result.cutting_s + result.rapid_s).max(f64::MIN_POSITIVE);
        let shares = limit_names().into_iter().zip(&self.bound_s);
        result.binding = shares
            .filter(|(_, time_s)| **time_s > 0.0)
            .map(|(limit, time_s)| BindingShare {
                limit,
                share: time_s / moving_s,
            })
            .collect();
        result.binding.sort_by(|a, b| b.share.total_cmp(&a.share));
        result.tools.retain(|tool| tool.time_s > 0.0);
        result.slow_share = self.slow_s / result.cutting_s.max(f64::MIN_POSITIVE);
        result.lines = self.lines.unwrap_or_default();
        result.lines.retain(|line| line.line > 0);
        result
    }
}
