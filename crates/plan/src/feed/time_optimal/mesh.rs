//! Nodes on the programmed path, a step of time apart: by the solution of the window before as far
//! as it goes on, then by an estimate.

use super::steps::{AxisCaps, PlannedStep, place_after, place_powers, time_of_place};
use super::track::{Track, TrackPlace};
use crate::feed::AxisMotion;
use crate::vector::{distance, norm, scale};

/// Part of the acceleration that the estimate uses.
const ACCEL_PART: f64 = 0.75;

/// Nodes that are near to the start of a window, whose state is given.
pub(super) const NEAR_START: usize = 8;

/// Number of planned steps after a given start that keep their nodes: the motion planned there
/// stays exactly feasible.
const ALIGNED: usize = 16;

/// Relative amount by which a node's offset may exceed the offset planned in the window before.
const PLANNED_SLACK: f64 = 1e-3;

/// A joint at most this far ahead, in steps, takes the place of the next node.
const JOINT_AHEAD: f64 = 1.3;

/// A node with a first guess of what the axes do there.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeshNode {
    pub(super) s_mm: f64,
    /// Duration of the step that leads to the node.
    pub(super) duration_s: f64,
    pub(super) motion: AxisMotion,
    pub(super) radius_mm: f64,
    /// True where the motion was planned before.
    pub(super) followed: bool,
}

/// State in which a mesh begins.
#[derive(Debug, Clone, Copy)]
pub(super) struct MeshStart {
    pub(super) s_mm: f64,
    pub(super) motion: AxisMotion,
}

/// The mesh under way.
pub(super) struct Mesh<'a> {
    track: &'a Track,
    caps: &'a AxisCaps,
    step_s: f64,
    most: usize,
    radius_part: f64,
    pub(super) nodes: Vec<MeshNode>,
}

impl<'a> Mesh<'a> {
    /// Creates a mesh with its first node. Offsets of the other nodes may use `radius_part` of the
    /// tolerance: the rest is for what lies between nodes.
    pub(super) fn new(
        track: &'a Track,
        caps: &'a AxisCaps,
        step_s: f64,
        most: usize,
        radius_part: f64,
        start: MeshStart,
    ) -> Self {
        let MeshStart { s_mm, motion } = start;
        let nodes = vec![MeshNode {
            s_mm,
            duration_s: 0.0,
            motion,
            radius_mm: 0.0,
            followed: true,
        }];
        Self {
            track,
            caps,
            step_s,
            most,
            radius_part,
            nodes,
        }
    }

    fn last_mm(&self) -> f64 {
        self.nodes.last().map_or(0.0, |node| node.s_mm)
    }

    fn is_full(&self) -> bool {
        self.nodes.len() > self.most
    }

    fn push(&mut self, s_mm: f64, duration_s: f64, motion: AxisMotion, followed: bool) {
        let mut radius_mm = self.radius_part * self.track.piece(s_mm).tolerance_mm;
        // What was planned may use the whole tolerance between its nodes; it stays possible. An
        // estimate lies on the path.
        let planned_mm = distance(motion.position_mm, self.track.at(s_mm).position_mm);
        radius_mm = radius_mm.max((1.0 + PLANNED_SLACK) * planned_mm);
        self.nodes.push(MeshNode {
            s_mm,
            duration_s,
            motion,
            radius_mm,
            followed,
        });
    }

    /// Follows steps for a time.
    pub(super) fn follow(&mut self, steps: &[PlannedStep], until_s: f64) {
        let (mut begins_s, mut last_s) = (0.0, 0.0);
        for (i, step) in steps.iter().enumerate() {
            if i < ALIGNED && begins_s + step.duration_s < until_s && step.to_mm > self.last_mm() {
                self.push(
                    step.to_mm,
                    step.duration_s,
                    step.motion.after(step.duration_s),
                    true,
                );
                begins_s += step.duration_s;
                last_s = begins_s;
                continue;
            }
            let powers = place_powers(
                step,
                self.track.at(step.from_mm).tangent,
                self.track.at(step.to_mm).tangent,
            );
            loop {
                if self.is_full() || last_s + self.step_s > until_s {
                    return;
                }
                let mut next_s = last_s + self.step_s;
                let after = |t_s: f64| place_after(&powers, (t_s - begins_s).min(step.duration_s));
                // A joint within this step, up to a little beyond the next node.
                let ahead_mm = after(last_s + JOINT_AHEAD * self.step_s);
                let joint = self.track.joint(self.last_mm(), ahead_mm);
                if let Some(joint_mm) = joint {
                    next_s = begins_s + time_of_place(&powers, joint_mm, step.duration_s);
                }
                if next_s > begins_s + step.duration_s || next_s <= last_s {
                    break;
                }
                let s_mm = joint.unwrap_or_else(|| after(next_s));
                if s_mm <= self.last_mm() {
                    break;
                }
                self.push(
                    s_mm,
                    next_s - last_s,
                    step.motion.after(next_s - begins_s),
                    true,
                );
                last_s = next_s;
            }
            begins_s += step.duration_s;
        }
    }

    /// Goes on by an estimate of the speed, to the last place known or until the mesh is full;
    /// answers whether it came to the end.
    pub(super) fn estimate(&mut self) -> bool {
        let Some(from) = self.nodes.last().copied() else {
            return false;
        };
        let places: Vec<TrackPlace> = self.track.places(from.s_mm).copied().collect();
        let first_mm_s = norm(from.motion.velocity_mm_s);
        let speeds = self.speeds(&places, first_mm_s);
        let n = places.len();
        let end_mm = places.last().map_or(0.0, |place| place.s_mm);
        let (mut s_mm, mut i) = (from.s_mm, 0);
        while s_mm < end_mm && !self.is_full() {
            while i + 1 < n && places[i + 1].s_mm <= s_mm {
                i += 1;
            }
            let next = (i + 1).min(n - 1);
            let part = (s_mm - places[i].s_mm) / (places[next].s_mm - places[i].s_mm).max(1e-12);
            let squares = [speeds[i] * speeds[i], speeds[next] * speeds[next]];
            let here = (squares[0] + part.clamp(0.0, 1.0) * (squares[1] - squares[0]))
                .max(0.0)
                .sqrt();
            let least = self.least_mm_s(places[i].tangent);
            let mut speed = here.max(least);
            // No step over a slow place.
            for at in next..n {
                if places[at].s_mm >= s_mm + speed * self.step_s {
                    break;
                }
                speed = speed.min((0.5 * (speeds[at] + here)).max(least));
            }
            let mut next_mm = (s_mm + speed * self.step_s).min(end_mm);
            if let Some(joint_mm) = self
                .track
                .joint(s_mm, s_mm + JOINT_AHEAD * (next_mm - s_mm))
            {
                next_mm = joint_mm.min(end_mm);
            }
            let at = self.track.at(next_mm);
            let motion = AxisMotion {
                position_mm: at.position_mm,
                velocity_mm_s: scale(speed, at.tangent),
                ..AxisMotion::REST
            };
            self.push(next_mm, (next_mm - s_mm) / speed, motion, false);
            s_mm = next_mm;
        }
        self.track.ended && s_mm >= end_mm
    }

    /// The speed that a step from rest comes to.
    fn least_mm_s(&self, tangent: [f64; 3]) -> f64 {
        0.5 * self.caps.along(tangent, |limits| limits.jerk_mm_s3) * self.step_s * self.step_s
    }

    /// Speeds at places, from a speed at the first to rest at the last, without exceeding the
    /// bounds of the places.
    fn speeds(&self, places: &[TrackPlace], first_mm_s: f64) -> Vec<f64> {
        let after = |speed: f64, way_mm: f64, place: &TrackPlace| {
            let accel = ACCEL_PART * self.caps.along(place.tangent, |limits| limits.accel_mm_s2);
            let jerk = self.caps.along(place.tangent, |limits| limits.jerk_mm_s3);
            let speed = speed.max(self.least_mm_s(place.tangent));
            (speed * speed + 2.0 * accel.min((jerk * speed).sqrt()) * way_mm).sqrt()
        };
        let mut speeds: Vec<f64> = places.iter().map(|place| place.cap_mm_s).collect();
        let n = speeds.len();
        speeds[0] = first_mm_s;
        speeds[n - 1] = 0.0;
        for i in 1..n {
            let most = after(
                speeds[i - 1],
                places[i].s_mm - places[i - 1].s_mm,
                &places[i],
            );
            speeds[i] = speeds[i].min(most);
        }
        for i in (0..n - 1).rev() {
            let most = after(
                speeds[i + 1],
                places[i + 1].s_mm - places[i].s_mm,
                &places[i],
            );
            speeds[i] = speeds[i].min(most);
        }
        speeds
    }
}
