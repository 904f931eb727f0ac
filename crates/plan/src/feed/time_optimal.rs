//! Least time within the tolerance of the programmed path: speed and path are chosen together,
//! under the velocity, acceleration and jerk of each axis.
//!
//! The path from one rest to the next is planned in windows. A window has `mesh` nodes on the
//! programmed path, a few milliseconds of motion apart; its least time (`interior_point`) ends at
//! rest. The first part of a window is committed, the next window begins there. What of a window
//! was not committed is kept: where the next window comes to no solution, or its solution leaves
//! the tube, the motion goes on along it, and so at worst comes to rest on the path; from there it
//! goes on straight from rest to rest.
//!
//! Look-ahead: the time in which the slowest axis stops, and 0.5 s.
//!
//! | File | What |
//! |---|---|
//! | `corner_deviation.rs` | how far a corner is cut: tolerance of a block, and where the tool stops |
//! | `steps.rs` | steps of constant jerk per axis, and the place on the path that each stands for |
//! | `track.rs` | the path from rest to rest, and an estimate of the speed on it |
//! | `mesh.rs` | nodes on it |
//! | `window.rs` | a window as an optimisation problem |
//! | `riccati.rs` | its Newton steps |
//! | `barrier.rs` | its bounds |
//! | `interior_point.rs` | its solution |
//! | `settle.rs` | axes that the path leaves where they are |
//! | `solved.rs` | from a mesh to a window, and from its solution to steps |
//! | `between_nodes.rs` | what the motion exceeds between nodes |
//! | `rest_to_rest.rs` | straight, in closed form |

mod corner_deviation;
mod steps;
mod track;
mod mesh;
mod window;
mod riccati;
mod barrier;
mod interior_point;
mod settle;
mod solved;
mod between_nodes;
mod rest_to_rest;
use std::collections::VecDeque;

use feedwright_gcode::canon::Corner;

use super::{AxisMotion, FeedPlanner, Span, feed_mm_s};
use crate::constraints::{AxisLimits, Constraints};
use crate::path::Piece;
use crate::vector::{angle, dot, norm, sub};
use corner_deviation::{corner_deviation_mm, stops_at};
use interior_point::SolverSettings;
use mesh::{Mesh, MeshNode, MeshStart};
use rest_to_rest::straight;
use solved::MeshProblem;
use steps::{AxisCaps, PlannedStep, place_after, place_powers, time_of_place};
use track::Track;

/// Look-ahead beyond the time to stop, s.
const BEYOND_S: f64 = 0.5;

/// Part of a window that is committed.
const COMMITTED: f64 = 0.6;

/// Part of the usual commit that is taken from the previous window if a window has no solution. The
/// next window then begins elsewhere, and still at speed.
const GOING_ON: f64 = 0.25;

/// Step of time, in times `(tolerance / jerk)^(1/3)`: within it jerk leads away from a chord by
/// less than a hundredth of the tolerance.
const STEP: f64 = 0.35;

/// Shortest and longest step of time, s.
const STEPS_S: [f64; 2] = [2e-4, 5e-3];

/// Least length of a step at the feedrate, as a part of the tolerance. At low feedrates steps
/// therefore take longer.
const LEAST_WAY: f64 = 0.1;

/// Fewest and most steps of a window.
const WINDOW: [usize; 2] = [64, 600];

/// A window of fewer steps than this has shorter ones: from rest to rest it takes seven.
const FEWEST: usize = 24;

/// Part of a tolerance that a node's offset may use: the rest is for what lies between nodes.
const RADIUS_PART: f64 = 0.9;

/// Parts of the tolerance that a window is looked for in, in turn. What is as small as the
/// tolerance, an arc of its radius or a spike of its length, may come to no solution in the whole
/// of it, and does in a narrower one.
const TOLERANCE_PARTS: [f64; 4] = [1.0, 0.5, 0.25, 0.1];

/// Part of the time that an offset at the edge of the tube costs; it falls with the square of the
/// offset. So the tolerance is used only where it saves time. With 0.02, 13 programs within 10 um
/// take 0 to 0.36 % longer, 0.1 % in the median; at 0.1 up to 0.6 %. At 0 smooth curves use the
/// whole tube for nothing.
const OFFSET_COST: f64 = 0.02;

/// Largest number of rounds in which a window is solved. After each one, whatever it exceeded is
/// tightened.
const ROUNDS: usize = 5;

/// Tolerance violation accepted in the last round, mm.
const LAST_OVER_MM: f64 = 5e-5;

/// Feedrate violation accepted in the last round, as a part of the feedrate.
const LAST_OVER: f64 = 1e-9;

/// First guesses, tried in turn: a motion and the first barrier. The motion is the motion of the
/// nodes, or with `Some(f)` a motion along the chords that is `f` times slower. The first guess is
/// for nodes whose motion was a solution.
const GUESSES: [(Option<f64>, f64); 4] = [
    (None, 0.01),
    (None, 0.1),
    (Some(1.3), 0.1),
    (Some(2.0), 1.0),
];

/// Nodes keep this part of the feedrate away from it, for rounding; where the speed rises by more
/// between two nodes, the window is solved again with more.
const FEED_MARGIN: f64 = 1e-7;

/// The barrier at the end: 1e-5 of the time, and as near to the feedrate.
const LAST_MU: f64 = 4e-6;

/// Extent to which the first guess of a window follows the known motion. `UntilBraking` follows it
/// until it brakes for its rest; from there an estimate goes on at speed. Where that has no
/// solution, as with tolerances of 1 um, `AlmostToRest` follows it down to the last of its speed.
/// That guess is feasible.
#[derive(Debug, Clone, Copy)]
enum Followed {
    UntilBraking,
    AlmostToRest,
}

/// Steps before a rest that are not followed: they come nowhere.
const NEARLY_AT_REST: f64 = 20.0;

/// Counts of the work done, for benchmarks and tests.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct PlanCounts {
    /// Windows that were committed.
    pub windows: u64,
    /// Solutions that were looked for.
    pub(crate) solutions: u64,
    /// Solutions that failed.
    pub failed: u64,
    /// Windows in whose place the motion went on along the one before.
    pub(crate) went_on: u64,
    /// Straight motions from rest to rest in place of a window.
    pub(crate) straight: u64,
    /// Newton steps of all solutions.
    pub(crate) iterations: u64,
}

/// See the module's page.
#[derive(Debug)]
pub struct TimeOptimal {
    constraints: Constraints,
    caps: AxisCaps,
    track: Track,
    /// Pieces so far.
    pieces: u64,
    /// End of the last piece: its tangent and corner.
    last: Option<([f64; 3], Corner)>,
    /// Smallest tolerance and largest feedrate of the track.
    tolerance_mm: f64,
    feed_mm_s: f64,
    /// Up to where steps are committed, and what the axes do there.
    from: MeshStart,
    /// Steps behind that, to rest.
    tail: Vec<PlannedStep>,
    ready: VecDeque<Span>,
    counts: PlanCounts,
    /// Windows reach from rest to rest.
    whole: bool,
    /// The tolerance is held at nodes only.
    at_nodes: bool,
}

impl TimeOptimal {
    /// Creates the planner at rest before the first piece. An axis without limits of its own takes
    /// those of the last axis that has some.
    pub fn new(constraints: &Constraints) -> Self {
        let limits = |k: usize| constraints.axis(k).unwrap_or(AxisLimits::NONE);
        Self {
            constraints: constraints.clone(),
            caps: AxisCaps {
                axes: [limits(0), limits(1), limits(2)],
            },
            track: Track::new(constraints.speed_caps.clone()),
            pieces: 0,
            last: None,
            tolerance_mm: f64::INFINITY,
            feed_mm_s: 0.0,
            from: MeshStart {
                s_mm: 0.0,
                motion: AxisMotion::REST,
            },
            tail: Vec::new(),
            ready: VecDeque::new(),
            counts: PlanCounts::default(),
            whole: false,
            at_nodes: false,
        }
    }

    /// The bound that plans are measured by: the whole path from rest to rest as one window, with
    /// the tolerance held at its nodes only. Memory and latency grow with the program.
    pub(crate) fn whole(constraints: &Constraints) -> Self {
        Self {
            at_nodes: true,
            ..Self::whole_within(constraints)
        }
    }

    /// The same within the tolerance everywhere, as far as that comes to a solution: what streaming
    /// costs shows beside it.
    pub fn whole_within(constraints: &Constraints) -> Self {
        Self {
            whole: true,
            ..Self::new(constraints)
        }
    }

    /// Returns the counts so far.
    pub const fn counts(&self) -> PlanCounts {
        self.counts
    }

    fn step_s(&self) -> f64 {
        let jerk = self
            .caps
            .axes
            .iter()
            .map(|limits| limits.jerk_mm_s3)
            .fold(0.0, f64::max);
        let step_s = STEP * libm::cbrt(self.tolerance_mm / jerk);
        step_s
            .clamp(STEPS_S[0], STEPS_S[1])
            .max(LEAST_WAY * self.tolerance_mm / self.feed_mm_s)
    }

    /// Steps of a window.
    fn window(&self) -> usize {
        if self.whole {
            return usize::MAX / 2;
        }
        let horizon_s = self.caps.stop_s(self.feed_mm_s) + BEYOND_S;
        ((horizon_s / self.step_s()).ceil() as usize).clamp(WINDOW[0], WINDOW[1])
    }

    /// The tool rests behind what is known.
    fn end_track(&mut self) {
        self.track.ended = true;
        self.track.look(&self.caps);
    }

    /// The next track begins, where everything of this one is planned.
    fn begin_track(&mut self) {
        self.track = Track::new(self.constraints.speed_caps.clone());
        self.tail.clear();
        (self.tolerance_mm, self.feed_mm_s) = (f64::INFINITY, 0.0);
    }

    /// Returns true if enough of the path is known for the next window.
    fn is_due(&self) -> bool {
        if self.track.ended {
            return self.from.s_mm < self.track.end_mm;
        }
        !self.track.is_empty()
            && self.track.ahead_s(self.from.s_mm) > self.window() as f64 * self.step_s()
    }

    /// Plans what is due.
    fn plan_due(&mut self) {
        while self.is_due() {
            self.plan_window();
        }
    }

    /// Commits the next part of the motion.
    fn plan_window(&mut self) {
        let only = self
            .track
            .only()
            .filter(|_| self.track.ended && self.from.s_mm == 0.0);
        if let Some(piece) = only.filter(|piece| piece.curve.is_straight()) {
            let (length_mm, feed_mm_s) =
                (piece.length_mm, self.track.least_mm_s(0.0, piece.length_mm));
            let to_mm = piece.curve.at(length_mm).position_mm;
            let steps = straight(
                self.from.motion.position_mm,
                to_mm,
                [0.0, length_mm],
                feed_mm_s,
                &self.caps,
            );
            self.hand_out(&steps);
            self.from.s_mm = self.track.end_mm;
            return;
        }
        let rests = self.tail.is_empty();
        let left_mm = self.track.end_mm - self.from.s_mm;
        if rests && self.track.ended && left_mm < 2.0 * self.tolerance_mm {
            self.go_straight();
            return;
        }
        if let Some((steps, ends)) = self.solve_window() {
            self.counts.windows += 1;
            self.tail = steps;
            self.commit(1.0, ends);
        } else if rests {
            self.go_straight();
        } else {
            self.counts.went_on += 1;
            self.commit(GOING_ON, false);
        }
    }

    /// The steps of the next window, and whether they lead to the end of the track: within the
    /// tolerance, or from a narrower tube on to wider ones, each from the solution of the one
    /// before.
    fn solve_window(&mut self) -> Option<(Vec<PlannedStep>, bool)> {
        let (narrow, mut found) = TOLERANCE_PARTS
            .iter()
            .enumerate()
            .find_map(|(i, &part)| Some((i, self.solve_within(part)?)))?;
        for &part in TOLERANCE_PARTS[..narrow].iter().rev() {
            let step_s = self.step_s() * libm::cbrt(part);
            match self.solve_behind(&found.0, part, step_s, Followed::UntilBraking) {
                Some(wider) => found = wider,
                None => break,
            }
        }
        Some(found)
    }

    /// The steps of the next window within a part of the tolerance, and whether they lead to the
    /// end of the track.
    fn solve_within(&mut self, part: f64) -> Option<(Vec<PlannedStep>, bool)> {
        let mut step_s = self.step_s() * libm::cbrt(part);
        if !self.tail.is_empty() {
            let tail = self.tail.clone();
            let found = self.solve_behind(&tail, part, step_s, Followed::UntilBraking);
            return found
                .or_else(|| self.solve_behind(&tail, part, step_s, Followed::AlmostToRest));
        }
        // From rest nothing is known of the times of nodes but an estimate: the solution for it
        // gives better ones.
        let (nodes, _) = self.mesh(&[], part, step_s, Followed::UntilBraking);
        if nodes.len() <= FEWEST {
            step_s *= nodes.len() as f64 / (2 * FEWEST) as f64;
        }
        let (nodes, ends) = self.mesh(&[], part, step_s, Followed::UntilBraking);
        let first = self.solution(
            &nodes,
            &vec![1.0; nodes.len() - 1],
            ends,
            step_s,
            &GUESSES[1..],
        )?;
        let time_s: f64 = first.iter().map(|step| step.duration_s).sum();
        if ends {
            step_s = step_s.min(time_s / FEWEST as f64);
        }
        self.solve_behind(&first, part, step_s, Followed::UntilBraking)
    }

    fn mesh(
        &self,
        known: &[PlannedStep],
        part: f64,
        step_s: f64,
        followed: Followed,
    ) -> (Vec<MeshNode>, bool) {
        let most = self.window();
        let most = if self.track.ended {
            most + most / 4
        } else {
            most
        };
        let radius_part = if self.at_nodes {
            part
        } else {
            part * RADIUS_PART
        };
        let mut mesh = Mesh::new(
            &self.track,
            &self.caps,
            step_s,
            most,
            radius_part,
            self.from,
        );
        let time_s: f64 = known.iter().map(|step| step.duration_s).sum();
        let ends = self.track.ended
            && known
                .last()
                .is_some_and(|step| step.to_mm >= self.track.end_mm);
        let fastest = known
            .iter()
            .map(|step| norm(step.motion.velocity_mm_s))
            .fold(0.0, f64::max);
        let until_s = match followed {
            _ if ends => time_s - 2.0 * step_s,
            Followed::UntilBraking => time_s - 1.2 * self.caps.stop_s(fastest),
            Followed::AlmostToRest => time_s - NEARLY_AT_REST * step_s,
        };
        mesh.follow(known, until_s);
        let ends = mesh.estimate();
        (mesh.nodes, ends)
    }

    /// Solves a window whose nodes follow the times of the known steps, until nothing is exceeded.
    fn solve_behind(
        &mut self,
        known: &[PlannedStep],
        part: f64,
        step_s: f64,
        followed: Followed,
    ) -> Option<(Vec<PlannedStep>, bool)> {
        let (mut nodes, ends) = self.mesh(known, part, step_s, followed);
        let mut feed_parts = vec![1.0 - FEED_MARGIN; nodes.len() - 1];
        for round in 0..ROUNDS {
            let guesses = if round == 0 {
                &GUESSES[1..]
            } else {
                &GUESSES[..]
            };
            let steps = self.solution(&nodes, &feed_parts, ends, step_s, guesses)?;
            if self.at_nodes {
                return Some((steps, ends));
            }
            // The solver's rounding over steps of a fraction of a microsecond, in a window that
            // hardly moves.
            if steps.iter().any(|step| !self.caps.keeps_jerk(step)) {
                return None;
            }
            let soon = if ends { steps.len() } else { self.soon(&steps) };
            let mut excesses = between_nodes::excesses(&self.track, &self.caps, &steps, soon);
            if round + 1 == ROUNDS {
                excesses.retain(|excess| {
                    excess.tube_mm > LAST_OVER_MM
                        || excess.feed_part < 1.0 - LAST_OVER
                        || excess.axes_mm_s.is_finite()
                });
            }
            if excesses.is_empty() {
                return Some((steps, ends));
            }
            (nodes, feed_parts) = between_nodes::tightened(
                &nodes,
                &feed_parts,
                &steps,
                &excesses,
                step_s,
                &self.track,
            );
        }
        None
    }

    fn solution(
        &mut self,
        nodes: &[MeshNode],
        feed_parts: &[f64],
        ends: bool,
        step_s: f64,
        guesses: &[(Option<f64>, f64)],
    ) -> Option<Vec<PlannedStep>> {
        for &(slower, first_mu) in guesses {
            let settings = SolverSettings {
                first_mu,
                last_mu: LAST_MU,
                most_iterations: self.most_iterations(),
            };
            let (track, caps, tolerance_mm) = (&self.track, &self.caps, self.tolerance_mm);
            let offset_cost = if self.at_nodes { 0.0 } else { OFFSET_COST };
            let problem = MeshProblem {
                track,
                caps,
                nodes,
                step_s,
                tolerance_mm,
                feed_parts,
                ends,
                offset_cost,
                slower,
                settings,
            };
            self.counts.solutions += 1;
            if let Some((steps, iterations)) = problem.solve() {
                self.counts.iterations += u64::from(iterations);
                return Some(steps);
            }
            self.counts.failed += 1;
        }
        None
    }

    /// Returns the number of steps that may be committed before another window is solved. For the
    /// other steps, the tube at the nodes is enough.
    fn soon(&self, steps: &[PlannedStep]) -> usize {
        let until_s = 2.0 * self.committed_s(steps);
        let mut time_s = 0.0;
        let soon = steps.iter().take_while(|step| {
            time_s += step.duration_s;
            time_s < until_s
        });
        soon.count() + 1
    }

    /// Returns the time of a window that is committed, s; less if the window came out shorter than
    /// estimated.
    fn committed_s(&self, steps: &[PlannedStep]) -> f64 {
        let time_s: f64 = steps.iter().map(|step| step.duration_s).sum();
        COMMITTED * time_s.min(self.window() as f64 * self.step_s())
    }

    const fn most_iterations(&self) -> u32 {
        if self.whole { 600 } else { 200 }
    }

    /// Hands out a part of what a window commits, or all of the tail.
    fn commit(&mut self, part: f64, all: bool) {
        let until_s = (part * self.committed_s(&self.tail)).max(self.step_s());
        let mut count = 0;
        let mut time_s = 0.0;
        while count < self.tail.len() && (all || time_s < until_s) {
            time_s += self.tail[count].duration_s;
            count += 1;
        }
        let steps: Vec<PlannedStep> = self.tail.drain(..count).collect();
        self.hand_out(&steps);
        if let Some(last) = steps.last() {
            let mut motion = AxisMotion {
                jerk_mm_s3: [0.0; 3],
                ..last.motion.after(last.duration_s)
            };
            if self.tail.is_empty() {
                motion = AxisMotion {
                    position_mm: motion.position_mm,
                    ..AxisMotion::REST
                };
            }
            self.from = MeshStart {
                s_mm: last.to_mm,
                motion,
            };
        }
        self.track.forget_before(self.from.s_mm);
    }

    /// Moves straight from rest to rest, to a place of the path as far as the tolerance allows.
    fn go_straight(&mut self) {
        self.counts.straight += 1;
        let MeshStart { s_mm, motion } = self.from;
        let start_mm = motion.position_mm;
        let mut way_mm = self.track.end_mm - s_mm;
        let mut to_mm = self.track.at(s_mm + way_mm).position_mm;
        while way_mm > 1e-3 * self.tolerance_mm
            && !self.is_within(start_mm, to_mm, [s_mm, s_mm + way_mm])
        {
            way_mm *= 0.5;
            to_mm = self.track.at(s_mm + way_mm).position_mm;
        }
        // At an end that is not the end of the track the rest is by chance as good as anywhere.
        let end_mm = if s_mm + way_mm > s_mm {
            s_mm + way_mm
        } else {
            self.track.end_mm
        };
        let feed_mm_s = self.track.least_mm_s(s_mm, end_mm);
        let steps = straight(start_mm, to_mm, [s_mm, end_mm], feed_mm_s, &self.caps);
        self.hand_out(&steps);
        self.from = MeshStart {
            s_mm: end_mm,
            motion: AxisMotion {
                position_mm: to_mm,
                ..AxisMotion::REST
            },
        };
        self.track.forget_before(end_mm);
    }

    /// Returns true if a straight line and a part of the path stay within the tolerance of each
    /// other, checked at close points.
    fn is_within(&self, from_mm: [f64; 3], to_mm: [f64; 3], [lo_mm, hi_mm]: [f64; 2]) -> bool {
        let most_mm = 0.95 * self.tolerance_mm;
        let chord = sub(to_mm, from_mm);
        let square = dot(chord, chord).max(1e-24);
        let from_chord = |point: [f64; 3]| {
            let along = (dot(sub(point, from_mm), chord) / square).clamp(0.0, 1.0);
            norm(std::array::from_fn::<f64, 3, _>(|k| {
                from_mm[k] + along * chord[k] - point[k]
            }))
        };
        let parts = (1..64).map(|m| f64::from(m) / 64.0);
        let joints = self
            .track
            .between(lo_mm, hi_mm)
            .filter(|piece| piece.s_mm > lo_mm)
            .map(|piece| piece.s_mm);
        parts
            .clone()
            .map(|part| lo_mm + part * (hi_mm - lo_mm))
            .chain(joints)
            .all(|s_mm| from_chord(self.track.at(s_mm).position_mm) <= most_mm)
            && parts
                .map(|part| std::array::from_fn(|k| from_mm[k] + part * chord[k]))
                .all(|point| self.track.distance(point, lo_mm, hi_mm) <= most_mm)
    }

    /// Steps as spans: one for each piece that a step passes.
    fn hand_out(&mut self, steps: &[PlannedStep]) {
        for step in steps {
            let tangents = [step.from_mm, step.to_mm].map(|s_mm| self.track.at(s_mm).tangent);
            let powers = place_powers(step, tangents[0], tangents[1]);
            let mut from_s = 0.0;
            for piece in self.track.between(step.from_mm, step.to_mm) {
                let end_mm = piece.s_mm + piece.length_mm;
                let until_s = if end_mm < step.to_mm {
                    time_of_place(&powers, end_mm, step.duration_s)
                } else {
                    step.duration_s
                };
                if until_s > from_s {
                    self.ready.push_back(Span {
                        piece: piece.number,
                        from_mm: (place_after(&powers, from_s) - piece.s_mm)
                            .max(0.0)
                            .min(piece.length_mm),
                        duration_s: until_s - from_s,
                        speed_mm_s: powers[1]
                            + from_s * (2.0 * powers[2] + from_s * 3.0 * powers[3]),
                        accel_mm_s2: 2.0 * powers[2] + 6.0 * powers[3] * from_s,
                        jerk_mm_s3: 6.0 * powers[3],
                        motion: Some(step.motion.after(from_s)),
                    });
                    from_s = until_s;
                }
            }
        }
    }
}

impl FeedPlanner for TimeOptimal {
    fn push(&mut self, piece: &Piece, from_rest: bool) {
        let begin = piece.curve.at(0.0);
        let rests = from_rest
            || self
                .last
                .is_none_or(|(tangent, corner)| stops_at(corner, angle(tangent, begin.tangent)));
        // What is due is planned before more is known, however calls are spread.
        self.plan_due();
        if rests && !self.track.is_empty() {
            self.end_track();
            self.plan_due();
            self.begin_track();
        }
        if self.track.is_empty() {
            let motion = AxisMotion {
                position_mm: begin.position_mm,
                ..AxisMotion::REST
            };
            self.from = MeshStart { s_mm: 0.0, motion };
        }
        let feed_mm_s = feed_mm_s(piece, &self.constraints);
        let tolerance_mm = corner_deviation_mm(piece.corner, self.constraints.path_tolerance_mm);
        self.track.push(self.pieces, piece, feed_mm_s, tolerance_mm);
        self.pieces += 1;
        self.last = Some((piece.curve.at(piece.length_mm).tangent, piece.corner));
        self.tolerance_mm = self.tolerance_mm.min(tolerance_mm);
        self.feed_mm_s = self.feed_mm_s.max(feed_mm_s);
        self.track.look(&self.caps);
    }

    fn finish(&mut self) {
        self.plan_due();
        if !self.track.is_empty() {
            self.end_track();
        }
    }

    fn pop(&mut self) -> Option<Span> {
        while self.ready.is_empty() && self.is_due() {
            self.plan_window();
        }
        self.ready.pop_front()
    }
}
