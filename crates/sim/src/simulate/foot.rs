//! How far along the path the tool has come: progress that never goes back and never skips.
//!
//! The contour error of a servo period is the distance of the tool `x` to its *foot*, a point of
//! the path at arc length `f`. With `d(s) = |P(s) - x|`, `m` the way of the tool in this servo
//! period, `S` the furthest foot so far and `r(t)` the arc length of the reference:
//!
//! 1. The foot lies at `lo = max(S - b, r(t - W) - e)` or beyond: a tool does not go back by more
//!    than it vibrates, `b`, and a loop that follows has come to where the reference was `W = 5 /
//!    Kp + delay` ago, but for the rest `e` that a loop of first order then has left.
//! 2. From `lo` on the tool *reaches* all `s` up to the first with `d(s) > h min(d over lo..s) +
//!    m`: beyond, the path leaves the tool. `f` is the nearest point reached, no later than
//!    [`LEAD_S`] ahead of the reference.
//! 3. Beyond stands a hill: a corner that the tool rounds. Of what follows, no later than
//!    [`HILL_LEAD_S`] ahead, the first stretch that comes nearer than the foot is reached over it,
//!    if the tool does not move along its own (to within 8 degrees) and moves more along that one.
//!
//! Where the tool takes a right angle or less, 2 alone lets it pass: midway `d = h / sqrt(2)` of
//! the corner's distance. On a spike, or a line there and back, the tool stays on its way out until
//! it moves back. A leg that happens to be near is not reached, since the path to it leaves the
//! tool; and a tool that remains on a leg that it has passed is measured to the end of that leg,
//! and `W` later to what it should have cut since.

use std::collections::VecDeque;

use feedwright_plan::vector::{Vector, distance, dot, sub};

use crate::machine::Machine;
use crate::reference::{Foot, Reference};

/// Time constants after which a loop of first order has followed.
const SETTLED_TIME_CONSTANTS: f64 = 5.0;
/// Largest lead of the tool over the reference, in plan time, s.
const LEAD_S: f64 = 0.05;
/// Largest lead over the reference of a stretch that is reached over a hill, s. A tool rounds a
/// corner when the reference has come to it, not before. Of spikes side by side, the next but one
/// is not reached.
const HILL_LEAD_S: f64 = 0.005;
/// Largest distance that vibration and settling take the tool back, mm: a usual in-position width.
const BACK_MM: f64 = 0.01;
/// Largest factor by which the path on the way may be further away than the nearest point; at a
/// right angle it is sqrt(2).
const HILL: f64 = 1.5;
/// Cosine of the angle within which the tool moves along its own stretch: there is nothing to look
/// for beyond.
const ALONG: f64 = 0.99;
/// The least way of a servo period, mm: a tool at rest still looks past what an encoder cannot
/// resolve.
const MIN_WAY_MM: f64 = 1e-4;
/// Distances that differ by less are equal, mm: of two laps over each other the first counts.
const TIE_MM: f64 = 1e-9;
/// Steps over the whole stretch, at most.
const MAX_STEPS: f64 = 512.0;

/// Returns the time after the reference within which a following tool has reached a point of the
/// path, s.
pub fn settled_s(machine: &Machine) -> f64 {
    let slowest_1_s = machine.slowest_kp_1_s();
    let delay_s = machine
        .axes
        .iter()
        .map(|axis| {
            axis.command_delay_s + axis.drive_delay_s + axis.measurement_delay_s + axis.jitter_s
        })
        .fold(0.0, f64::max);
    SETTLED_TIME_CONSTANTS / slowest_1_s + delay_s
}

/// [`settled_s`] in servo periods.
pub(super) fn settled_periods(machine: &Machine) -> usize {
    (settled_s(machine) / machine.period.servo_s).ceil() as usize
}

/// Follows the foot of the tool along the path, over a run.
pub(super) struct FootTracker {
    /// Arc lengths of the reference over the last [`settled_s`], oldest first.
    passed_mm: VecDeque<f64>,
    periods: usize,
    /// Rest of a rapid that a first-order loop still has to go after [`settled_s`].
    left_mm: f64,
    furthest_mm: f64,
    tool_mm: Vector,
}

/// Tool motion in a servo period, and the path that is searched.
struct FootSearch<'a, 'p> {
    reference: &'a mut Reference<'p>,
    tool_mm: Vector,
    moved_mm: Vector,
    way_mm: f64,
    /// The shortest step along the path.
    least_mm: f64,
}

impl FootTracker {
    /// Starts at rest at the start of the path.
    pub(super) fn new(machine: &Machine, start_mm: Vector) -> Self {
        let slowest_1_s = machine.slowest_kp_1_s();
        Self {
            passed_mm: VecDeque::new(),
            periods: settled_periods(machine),
            left_mm: libm::exp(-SETTLED_TIME_CONSTANTS) * machine.limits.rapid_mm_s / slowest_1_s,
            furthest_mm: 0.0,
            tool_mm: start_mm,
        }
    }

    /// The foot of the tool, where it is at the end of a servo period that begins with the
    /// reference at `tau_s`, at `s_mm`.
    pub(super) fn foot(
        &mut self,
        reference: &mut Reference<'_>,
        tau_s: f64,
        s_mm: f64,
        tool_mm: Vector,
    ) -> Foot {
        self.passed_mm.push_back(s_mm);
        let settled_mm = if self.passed_mm.len() > self.periods {
            self.passed_mm.pop_front()
        } else {
            None
        };
        let lo_mm = (self.furthest_mm - BACK_MM)
            .max(settled_mm.unwrap_or(0.0) - self.left_mm)
            .max(0.0);
        let hi_mm = reference.at(tau_s + LEAD_S).s_mm.max(lo_mm);
        let hill_mm = reference.at(tau_s + HILL_LEAD_S).s_mm.max(lo_mm);
        let moved_mm = sub(tool_mm, self.tool_mm);
        let way_mm = distance(tool_mm, self.tool_mm).max(MIN_WAY_MM);
        let least_mm = (0.25 * way_mm).max((hi_mm - lo_mm) / MAX_STEPS);
        let mut search = FootSearch {
            reference,
            tool_mm,
            moved_mm,
            way_mm,
            least_mm,
        };
        let (mut foot, end_mm) = search.reach(lo_mm, hi_mm);
        if let Some(beyond) = search.over_the_hill(&foot, end_mm, hill_mm) {
            foot = beyond;
        }
        self.furthest_mm = self.furthest_mm.max(foot.s_mm);
        self.tool_mm = tool_mm;
        foot
    }
}

impl FootSearch<'_, '_> {
    /// The nearest point that the tool reaches from `from_mm` on, and where the path leaves the
    /// tool.
    fn reach(&mut self, from_mm: f64, hi_mm: f64) -> (Foot, f64) {
        let mut here = self.reference.at_length(self.tool_mm, from_mm);
        let mut best = here;
        while here.s_mm < hi_mm {
            let room_mm = HILL * best.distance_mm + self.way_mm - here.distance_mm;
            if room_mm < 0.0 {
                return (best, here.s_mm);
            }
            // No nearer than this, the path cannot leave the tool.
            let to_mm = (here.s_mm + room_mm.max(self.least_mm)).min(hi_mm);
            let nearest = self.reference.nearest_along(self.tool_mm, here.s_mm, to_mm);
            if nearest.distance_mm < best.distance_mm - TIE_MM {
                best = nearest;
                here = nearest;
            } else {
                here = self.reference.at_length(self.tool_mm, to_mm);
                here.s_mm = to_mm;
            }
        }
        (best, hi_mm)
    }

    /// The first stretch from `from_mm` to `hi_mm` that is nearer than `foot`, where the tool moves
    /// along it.
    fn over_the_hill(&mut self, foot: &Foot, from_mm: f64, hi_mm: f64) -> Option<Foot> {
        let along = |foot: &Foot, moved_mm: Vector| dot(moved_mm, foot.tangent);
        let own_mm = along(foot, self.moved_mm);
        if own_mm > ALONG * self.way_mm {
            return None;
        }
        let nearer_mm = foot.distance_mm - TIE_MM;
        let mut at_mm = from_mm;
        while at_mm < hi_mm && nearer_mm > 0.0 {
            let away_mm =
                self.reference.at_length(self.tool_mm, at_mm).distance_mm - foot.distance_mm;
            let next_mm = (at_mm + away_mm.max(self.least_mm)).min(hi_mm);
            if away_mm < self.least_mm {
                let nearest = self.reference.nearest_along(self.tool_mm, at_mm, next_mm);
                if nearest.distance_mm < nearer_mm {
                    let (beyond, _) = self.reach(nearest.s_mm, hi_mm);
                    return (along(&beyond, self.moved_mm) > own_mm).then_some(beyond);
                }
            }
            at_mm = next_mm;
        }
        None
    }
}

#[cfg(test)]
mod tests;
