//! From a mesh to a window, and from its solution to steps.

use super::interior_point::{SolverSettings, solve};
use super::mesh::MeshNode;
use super::settle::settle;
use super::steps::{AxisCaps, PlannedStep};
use super::track::Track;
use super::window::{WindowProblem, WindowUnits, WindowUnknowns};
use crate::feed::AxisMotion;
use crate::vector::{angle, norm, scale, sub};

/// An axis that moves no further than this within a window counts as still, mm: a thousandth of
/// what any encoder resolves.
const STILL_MM: f64 = 1e-9;

/// Pieces so near to a step belong to it, mm.
const AT_MM: f64 = 1e-9;

/// The part by which the first control velocity may exceed the velocity that is given.
const GIVEN_PART: f64 = 1e-7;

/// Part of a previously planned turn that is assumed. A motion that turns less than assumed would
/// exceed the feedrate between its nodes.
const FOLLOWED_TURN: f64 = 0.98;

/// The part by which a speed may exceed the one that was planned before, where that is above a cap.
const PLANNED_PART: f64 = 1e-3;

/// The least cosine of half a turn: sharper corners are passed slowly whatever is allowed.
const LEAST_COS: f64 = 0.9;

/// A mesh that is to be solved.
pub(super) struct MeshProblem<'a> {
    pub(super) track: &'a Track,
    pub(super) caps: &'a AxisCaps,
    pub(super) nodes: &'a [MeshNode],
    pub(super) step_s: f64,
    pub(super) tolerance_mm: f64,
    /// Factor on the feedrate of each step.
    pub(super) feed_parts: &'a [f64],
    pub(super) ends: bool,
    /// See [`WindowProblem::offset_cost`].
    pub(super) offset_cost: f64,
    /// Factor by which the first guess, a motion along the chords, is slower. With `None`, the
    /// first guess is the motion of the nodes.
    pub(super) slower: Option<f64>,
    pub(super) settings: SolverSettings,
}

impl MeshProblem<'_> {
    /// Steps of least time; none where the method comes to none.
    pub(super) fn solve(&self) -> Option<(Vec<PlannedStep>, u32)> {
        let centers: Vec<[f64; 3]> = self
            .nodes
            .iter()
            .map(|node| self.track.at(node.s_mm).position_mm)
            .collect();
        let first = &self.nodes.first()?.motion;
        let moves = |k: usize| {
            let from = centers[0][k];
            centers
                .iter()
                .any(|center| (center[k] - from).abs() > STILL_MM)
                || (first.position_mm[k] - from).abs() > STILL_MM
                || first.velocity_mm_s[k] != 0.0
                || first.accel_mm_s2[k] != 0.0
        };
        let axes: Vec<usize> = (0..3).filter(|&k| moves(k)).collect();
        match axes[..] {
            [k] => self.of_axes::<1, 3, 2>([k], &centers),
            [k, l] => self.of_axes::<2, 6, 3>([k, l], &centers),
            [k, l, m] => self.of_axes::<3, 9, 4>([k, l, m], &centers),
            _ => None,
        }
    }

    fn of_axes<const D: usize, const N: usize, const M: usize>(
        &self,
        axes: [usize; D],
        centers: &[[f64; 3]],
    ) -> Option<(Vec<PlannedStep>, u32)> {
        let units = WindowUnits {
            step_s: self.step_s,
            offset_mm: self.tolerance_mm,
            velocity_mm_s: axes.map(|k| self.caps.axes[k].velocity_mm_s),
            accel_mm_s2: axes.map(|k| self.caps.axes[k].accel_mm_s2),
            jerk_mm_s3: axes.map(|k| self.caps.axes[k].jerk_mm_s3),
        };
        let state = |i: usize| {
            let mut x = [0.0; N];
            let motion = self.guessed(i, centers);
            for (d, &k) in axes.iter().enumerate() {
                x[3 * d] = (motion.position_mm[k] - centers[i][k]) / units.offset_mm;
                x[3 * d + 1] = motion.velocity_mm_s[k] / units.velocity_mm_s[d];
                x[3 * d + 2] = motion.accel_mm_s2[k] / units.accel_mm_s2[d];
            }
            x
        };
        let n = self.nodes.len() - 1;
        let x: Vec<[f64; N]> = (0..=n).map(state).collect();
        let u = (0..n).map(|i| {
            let h_s = self.nodes[i + 1].duration_s;
            let mut u = [0.0; M];
            u[D] = h_s / units.step_s * self.slower.unwrap_or(1.0);
            for (d, &k) in axes.iter().enumerate() {
                let change = self.guessed(i + 1, centers).accel_mm_s2[k]
                    - self.guessed(i, centers).accel_mm_s2[k];
                u[d] = change / h_s / units.jerk_mm_s3[d];
            }
            u
        });
        let u = u.collect();
        let problem = WindowProblem {
            units,
            way: (0..n)
                .map(|i| {
                    std::array::from_fn(|d| {
                        (centers[i + 1][axes[d]] - centers[i][axes[d]]) / units.offset_mm
                    })
                })
                .collect(),
            radius: self
                .nodes
                .iter()
                .map(|node| node.radius_mm / units.offset_mm)
                .collect(),
            feed_mm_s: (0..n).map(|i| self.feed_mm_s(i)).collect(),
            offset_cost: self.offset_cost,
            first: x[0],
            exact_end: self.ends,
        };
        let (mut solution, iterations) = solve(&problem, WindowUnknowns { x, u }, self.settings)?;
        problem.roll_out(&mut solution);
        settle(&problem, &mut solution);
        Some((
            self.steps_of(&problem, &solution, axes, centers),
            iterations,
        ))
    }

    /// Returns the motion of the axes at a node of the first guess.
    fn guessed(&self, i: usize, centers: &[[f64; 3]]) -> AxisMotion {
        let node = &self.nodes[i];
        let Some(slower) = self.slower.filter(|_| i > 0) else {
            return node.motion;
        };
        let way = sub(centers[(i + 1).min(self.nodes.len() - 1)], centers[i - 1]);
        let speed_mm_s = (node.s_mm - self.nodes[i - 1].s_mm) / node.duration_s / slower;
        let velocity_mm_s = scale(speed_mm_s / norm(way).max(STILL_MM), way);
        AxisMotion {
            position_mm: centers[i],
            velocity_mm_s,
            ..AxisMotion::REST
        }
    }

    /// Returns the largest control velocity of a step, mm/s: the feedrate, the smallest one where
    /// pieces meet. It is higher where the path turns, because the polygon of control velocities of
    /// a steady circle lies around that circle. A control velocity that is given stays possible.
    fn feed_mm_s(&self, i: usize) -> f64 {
        let [from, to] = [&self.nodes[i], &self.nodes[i + 1]];
        let feeds = self
            .track
            .between(from.s_mm - AT_MM, to.s_mm + AT_MM)
            .map(|piece| piece.feed_mm_s);
        let feed_mm_s = feeds.fold(f64::INFINITY, f64::min) * self.feed_parts[i];
        let cap_mm_s = self
            .track
            .cap_mm_s(from.s_mm)
            .min(self.track.cap_mm_s(to.s_mm));
        // What was planned under a cap stays possible beside it: caps hold roughly, feedrates
        // exactly.
        let planned_mm_s = norm(from.motion.velocity_mm_s).max(norm(to.motion.velocity_mm_s));
        let cap_mm_s = if from.followed {
            cap_mm_s.max((1.0 + PLANNED_PART) * planned_mm_s)
        } else {
            cap_mm_s
        };
        let around_mm_s = feed_mm_s.min(cap_mm_s) / self.turn_cos(i);
        if i > 0 {
            return around_mm_s;
        }
        let given_mm_s = norm(from.motion.velocity_mm_s);
        around_mm_s.max((1.0 + GIVEN_PART) * given_mm_s)
    }

    /// Cosine of half the angle by which the velocity turns within a step: on a curve by its
    /// tangents, elsewhere by what was planned before; 1 where nothing was, and the speed then
    /// stays below the feedrate by as much as the motion turns.
    fn turn_cos(&self, i: usize) -> f64 {
        let [from, to] = [&self.nodes[i], &self.nodes[i + 1]];
        let piece = self.track.piece(from.s_mm);
        let directions = if piece.s_mm + piece.length_mm >= to.s_mm {
            [from, to].map(|node| {
                piece
                    .curve
                    .at((node.s_mm - piece.s_mm).max(0.0).min(piece.length_mm))
                    .tangent
            })
        } else {
            [[0.0; 3]; 2]
        };
        let turn = if directions[0] != directions[1] {
            angle(directions[0], directions[1])
        } else if from.followed && to.followed {
            FOLLOWED_TURN * angle(from.motion.velocity_mm_s, to.motion.velocity_mm_s)
        } else {
            0.0
        };
        libm::cos(0.5 * turn).max(LEAST_COS)
    }

    fn steps_of<const D: usize, const N: usize, const M: usize>(
        &self,
        problem: &WindowProblem<D, N>,
        solution: &WindowUnknowns<N, M>,
        axes: [usize; D],
        centers: &[[f64; 3]],
    ) -> Vec<PlannedStep> {
        let units = &problem.units;
        let mut steps = Vec::with_capacity(solution.u.len());
        for (i, u) in solution.u.iter().enumerate() {
            let mut motion = AxisMotion {
                position_mm: centers[i],
                ..AxisMotion::REST
            };
            let x = &solution.x[i];
            for (d, &k) in axes.iter().enumerate() {
                motion.position_mm[k] += x[3 * d] * units.offset_mm;
                motion.velocity_mm_s[k] = x[3 * d + 1] * units.velocity_mm_s[d];
                motion.accel_mm_s2[k] = x[3 * d + 2] * units.accel_mm_s2[d];
                motion.jerk_mm_s3[k] = u[d] * units.jerk_mm_s3[d];
            }
            if i == 0 {
                motion = AxisMotion {
                    jerk_mm_s3: motion.jerk_mm_s3,
                    ..self.nodes[0].motion
                };
            }
            let (from_mm, to_mm) = (self.nodes[i].s_mm, self.nodes[i + 1].s_mm);
            steps.push(PlannedStep {
                from_mm,
                to_mm,
                duration_s: u[D] * units.step_s,
                motion,
            });
        }
        steps
    }
}
