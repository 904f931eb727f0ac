//! The profile in the cycle's own plane.
//!
//! Coordinates as in `cycle_plane`. A profile runs towards a growing first coordinate, so the stock
//! lies on its left.

use crate::canon::Motion;
use crate::geometry::plane::{PlaneCurve, PlanePoint, SLACK_MM, sweep};
use crate::motion::feed::Speed;
use crate::motion::lathe::cycle_plane::{CyclePlane, clear};
use crate::state::Interpreter;
use crate::state::lathe::LatheCycle;
use crate::text::codes::spelled;
use crate::text::diagnostic::{LineFault, Read};

/// Start of the cycle, end of the entry, and the curves behind it.
#[derive(Debug, Clone)]
pub(super) struct Profile {
    pub(super) plane: CyclePlane,
    pub(super) start: PlanePoint,
    pub(super) curves: Vec<PlaneCurve>,
}

impl Profile {
    /// The profile of a cycle; refuses one that goes back along the passes.
    pub(super) fn new(lathe: &LatheCycle) -> Read<Self> {
        match lathe.code {
            // Finishing has no passes: the profile is one of G71 or of G72.
            700 => Self::along(lathe, [2, 0])
                .or_else(|fault| Self::along(lathe, [0, 2]).map_err(|_| fault)),
            720.. => Self::along(lathe, [0, 2]),
            _ => Self::along(lathe, [2, 0]),
        }
    }

    pub(super) fn along(lathe: &LatheCycle, axes: [usize; 2]) -> Read<Self> {
        let along =
            |motion: &Motion, axis: usize| motion.end_mm[axes[axis]] - motion.start_mm[axes[axis]];
        // As LinuxCNC: towards the chuck or the axis, where the profile itself does not say.
        let ahead = lathe
            .motions
            .iter()
            .skip(1)
            .find_map(|motion| clear(along(motion, 0)));
        let start_mm = axes.map(|axis| lathe.start[axis]);
        let entry_mm = lathe
            .motions
            .first()
            .map_or(start_mm, |motion| axes.map(|axis| motion.end_mm[axis]));
        let last_mm = lathe
            .motions
            .last()
            .map_or(entry_mm[1], |motion| motion.end_mm[axes[1]]);
        let plane = CyclePlane {
            axes,
            signs: [
                ahead.unwrap_or(-1.0),
                lathe.stock_side([start_mm[1], entry_mm[1], last_mm], axes[1])?,
            ],
        };
        let curves: Vec<PlaneCurve> = lathe
            .motions
            .iter()
            .map(|motion| plane.curve(motion))
            .collect();
        for (curve, motion) in curves.iter().zip(&lathe.motions).skip(1) {
            if goes_back(curve) {
                return Err(lathe.turns_back(motion.line, plane.axes[0]));
            }
        }
        let curves = lathe.cut_corners(curves)?;
        let [first, rest @ ..] = curves.as_slice() else {
            return Ok(Self {
                plane,
                start: [0.0; 2],
                curves,
            });
        };
        if matches!(first, PlaneCurve::Arc { .. }) {
            return Err(lathe.refuse(
                lathe.motions[0].line,
                "the first motion leads to the profile and must be straight",
            ));
        }
        // An entry that would lead back is begun above its end.
        let start = plane.of([lathe.start[0], lathe.start[1], lathe.start[2]]);
        let start = [start[0].min(first.end()[0]), start[1]];
        Ok(Self {
            plane,
            start,
            curves: rest.to_vec(),
        })
    }

    /// Returns the end point of the entry.
    pub(super) fn entry(&self) -> PlanePoint {
        self.curves.first().map_or(self.start, PlaneCurve::start)
    }
}

/// Returns true if a curve goes against the passes anywhere.
pub(super) fn goes_back(curve: &PlaneCurve) -> bool {
    if curve.end()[0] < curve.start()[0] - SLACK_MM {
        return true;
    }
    match *curve {
        PlaneCurve::Line { .. } => false,
        // An arc that does not lies on one half of its circle; the rounding of ends and centres
        // turns the tangent by very little.
        PlaneCurve::Arc {
            start,
            end,
            center,
            turn,
        } => {
            let slack = 1e-6;
            [start, end]
                .iter()
                .any(|&at| curve.direction(at)[0] < -slack)
                || sweep(start, end, center, turn) > std::f64::consts::PI + slack
        }
    }
}

impl LatheCycle {
    pub(super) fn refuse(&self, line: u32, message: &str) -> Box<LineFault> {
        let place = if line == self.line {
            String::new()
        } else {
            format!("line {line}: ")
        };
        let message = format!(
            "the profile of {} cannot be cut: {place}{message}",
            spelled(self.code)
        );
        LineFault::new("gcode::lathe", self.block.at(b'q'), message)
    }

    /// Returns the side of the profile's entry on which the stock lies: 1 above, -1 below. The
    /// start of the cycle decides, or the end of the profile if the start is as deep as the entry.
    /// Fails if the two disagree, except for finishing (G70).
    fn stock_side(&self, [start_mm, entry_mm, last_mm]: [f64; 3], axis: usize) -> Read<f64> {
        let [to_start, to_last] = [start_mm, last_mm].map(|mm| clear(mm - entry_mm));
        // Finishing (G70) needs the side for its distances only. LinuxCNC uses the start's side.
        if self.code != 700
            && to_start
                .zip(to_last)
                .is_some_and(|(start, last)| start != last)
        {
            let name = ["X", "Y", "Z"][axis];
            let message = format!(
                "it ends on the other side of its beginning than the cycle starts ({name} of the start {start_mm:.4} mm, \
                 of the beginning {entry_mm:.4} mm, of the end {last_mm:.4} mm): on which side is the stock?"
            );
            return Err(self
                .refuse(self.line, &message)
                .hint("let the profile end on the side where the cycle starts"));
        }
        Ok(to_start.or(to_last).unwrap_or(1.0))
    }

    fn turns_back(&self, line: u32, axis: usize) -> Box<LineFault> {
        let name = ["X", "Y", "Z"][axis];
        self.refuse(line, &format!("{name} turns back: an undercut cannot be reached by passes along {name}"))
            .hint(format!("behind the first motion of the profile, {name} goes one way; a pocket has walls that do"))
    }
}

impl Interpreter {
    /// Moves straight to a point of the cycle's plane.
    pub(super) fn lathe_line(
        &mut self,
        lathe: &LatheCycle,
        plane: CyclePlane,
        point: PlanePoint,
        speed: Speed,
    ) -> Read<()> {
        self.pass_line(&lathe.block, &lathe.start, plane, point, speed)
    }

    /// Cuts along a curve.
    pub(super) fn lathe_curve(
        &mut self,
        lathe: &LatheCycle,
        plane: CyclePlane,
        curve: &PlaneCurve,
    ) -> Read<()> {
        self.pass_curve(&lathe.block, &lathe.start, plane, curve)
    }

    /// Cuts along curves.
    pub(super) fn lathe_cut(&mut self, lathe: &LatheCycle, profile: &Profile) -> Read<()> {
        profile
            .curves
            .iter()
            .try_for_each(|curve| self.lathe_curve(lathe, profile.plane, curve))
    }

    /// Returns the speed of the entry to the profile: rapid if the entry goes into the cut,
    /// programmed if it follows the surface.
    pub(super) fn lathe_entry_speed(profile: &Profile) -> Speed {
        if profile.entry()[1] < profile.start[1] - SLACK_MM {
            Speed::Rapid
        } else {
            Speed::Programmed
        }
    }
}
