//! G71 (passes along Z) and G72 (passes along X): straight passes down to the profile, then along
//! it.
//!
//! The allowance U W moves the profile and the start of the cycle. Pass n starts from the moved
//! start C and cuts up to the profile, at n times the depth of cut. There the tool retracts at 45
//! degrees by R and returns in a rapid. After the last pass the tool cuts along the moved profile
//! and returns to the start of the cycle.
//!
//! A profile that comes down again has pockets. It needs X and Z in its first block (type II), and
//! the cycle cuts the pockets level by level.
//!
//! Coordinates as in the cycles of LinuxCNC, `motion/lathe/cycle_plane.rs`.

use crate::canon::{Motion, MotionKind};
use crate::geometry::plane::{PlaneCurve, PlanePoint, SLACK_MM, add, length, minus, sweep};
use crate::motion::feed::Speed;
use crate::motion::lathe::cycle_plane::{CyclePlane, clear};
use crate::motion::lathe::pockets::{falls, falls_through, first_at, parted_at_tops};
use crate::state::Interpreter;
use crate::state::capture::{Capture, ProfileWork};
use crate::text::codes::{bit, spelled};
use crate::text::diagnostic::{LineFault, Read};

/// Passes of one cycle: more is a mistake in the depth of a pass.
const MAX_PASSES: f64 = 10_000.0;
/// A profile comes down, or turns back, where it does so by more, mm: coordinates of three decimals
/// turn the ends of arcs by as little.
const MIN_TURN_MM: f64 = 1e-3;

/// A cycle with its profile, moved by the allowance.
struct Roughing<'a> {
    capture: &'a Capture,
    plane: CyclePlane,
    /// Start of the passes.
    start: PlanePoint,
    curves: Vec<PlaneCurve>,
    depth_mm: f64,
    escape_mm: f64,
    /// Speed of the first block of the profile.
    infeed: Speed,
}

impl<'a> Roughing<'a> {
    fn new(capture: &'a Capture) -> Read<Self> {
        let ProfileWork::Rough {
            is_facing,
            depth_mm,
            escape_mm,
            allowance_mm,
        } = capture.wanted.work
        else {
            return Err(capture.refuse(capture.wanted.line, "it belongs to neither G71 nor G72"));
        };
        let axes = if is_facing { [0, 2] } else { [2, 0] };
        let (entry, rest) = capture
            .motions
            .split_first()
            .ok_or_else(|| capture.refuse(capture.wanted.line, "it is empty"))?;
        let along =
            |motion: &Motion, n: usize| clear(motion.end_mm[axes[n]] - motion.start_mm[axes[n]]);
        let start_mm = [
            capture.wanted.start[0],
            capture.wanted.start[1],
            capture.wanted.start[2],
        ];
        let last = rest.last().unwrap_or(entry);
        let infeed = clear(start_mm[axes[1]] - entry.end_mm[axes[1]]);
        let outward = infeed
            .or_else(|| clear(last.end_mm[axes[1]] - entry.end_mm[axes[1]]))
            .unwrap_or(1.0);
        let plane = CyclePlane {
            axes,
            signs: [
                rest.iter()
                    .find_map(|motion| along(motion, 0))
                    .unwrap_or(-1.0),
                outward,
            ],
        };
        let by_axis = [allowance_mm[0], 0.0, allowance_mm[1]];
        let shift = plane.of(by_axis);
        let curves: Vec<PlaneCurve> = rest
            .iter()
            .map(|motion| plane.curve(motion).moved(shift))
            .collect();
        let roughing = Self {
            capture,
            plane,
            start: add(plane.of(start_mm), shift),
            curves: parted_at_tops(curves),
            depth_mm,
            escape_mm,
            infeed: if entry.kind == MotionKind::Rapid {
                Speed::Rapid
            } else {
                Speed::Programmed
            },
        };
        roughing.check(rest, shift)?;
        Ok(roughing)
    }

    /// Fails if the profile has a motion that no pass of this kind can cut.
    fn check(&self, motions: &[Motion], shift: PlanePoint) -> Read<()> {
        let name = ["X", "Y", "Z"][self.plane.axes[0]];
        let depth = ["X", "Y", "Z"][self.plane.axes[1]];
        let has_pockets = [[b'x', b'u'], [b'z', b'w']]
            .iter()
            .all(|words| self.capture.first_words & (bit(words[0]) | bit(words[1])) != 0);
        for motion in motions {
            let curve = self.plane.curve(motion).moved(shift);
            if goes_back_mm(&curve) > MIN_TURN_MM {
                let message = format!(
                    "{name} turns back: an undercut cannot be reached by passes along {name}"
                );
                return Err(self
                    .capture
                    .refuse(motion.line, &message)
                    .hint(format!("behind the first block, {name} goes one way")));
            }
            if comes_down(&curve) && !has_pockets {
                let message = format!(
                    "{depth} turns back: the first block has not both X and Z, so the control expects no pocket"
                );
                return Err(self
                    .capture
                    .refuse(motion.line, &message)
                    .hint("with W0 on the first block the profile may have pockets (type II)"));
            }
        }
        if self.start[0] > self.entry()[0] + SLACK_MM {
            let message =
                format!("the cycle starts behind the beginning of its profile along {name}");
            return Err(self
                .capture
                .refuse(self.capture.wanted.line, &message)
                .hint("start it before the part"));
        }
        Ok(())
    }

    pub(super) fn entry(&self) -> PlanePoint {
        self.curves.first().map_or(self.start, PlaneCurve::start)
    }

    fn lowest(&self) -> f64 {
        self.curves
            .iter()
            .map(lowest_of)
            .fold(self.entry()[1], f64::min)
    }

    /// Returns the stretches along the passes in which the profile lies below a level: start and
    /// end of each.
    fn open_at(&self, level: f64) -> Vec<[f64; 2]> {
        let mut open = (self.entry()[1] < level - SLACK_MM).then_some(self.start[0]);
        let mut found = Vec::new();
        for curve in &self.curves {
            let mut rest = *curve;
            if open.is_none()
                && let Some(begin) = falls_through(curve, level)
            {
                open = Some(begin[0]);
                rest.set_start(begin);
                if rest.chord() <= SLACK_MM {
                    continue;
                }
            }
            if let Some(begin) = open
                && let Some((_, end)) = first_at(&[rest], level)
                && !(falls(&rest) && rest.end()[1] < level - SLACK_MM)
            {
                found.push([begin, end]);
                open = None;
            }
        }
        if let (Some(begin), Some(last)) = (open, self.curves.last()) {
            found.push([begin, last.end()[0]]);
        }
        found.retain(|[begin, end]| end - begin > SLACK_MM);
        found
    }
}

/// The lowest point of a curve.
fn lowest_of(curve: &PlaneCurve) -> f64 {
    match *curve {
        PlaneCurve::Arc {
            start,
            end,
            center,
            turn,
        } if turn > 0.0 && start[0] < center[0] && end[0] > center[0] => {
            center[1] - length(minus(start, center))
        }
        _ => curve.end()[1],
    }
}

/// Returns the distance that a curve goes back along the passes, mm; infinity for an arc well
/// beyond half a turn.
fn goes_back_mm(curve: &PlaneCurve) -> f64 {
    let straight = (curve.start()[0] - curve.end()[0]).max(0.0);
    let PlaneCurve::Arc {
        start,
        end,
        center,
        turn,
    } = *curve
    else {
        return straight;
    };
    // Both ends of a half circle may lie a little beyond it, and no more.
    if sweep(start, end, center, turn) > 1.1 * std::f64::consts::PI {
        return f64::INFINITY;
    }
    let radius = length(minus(start, center));
    let before = if curve.direction(start)[0] < 0.0 {
        start[0] - (center[0] - radius)
    } else {
        0.0
    };
    let behind = if curve.direction(end)[0] < 0.0 {
        center[0] + radius - end[0]
    } else {
        0.0
    };
    straight.max(before).max(behind)
}

/// Returns true if a curve goes down anywhere by more than `MIN_TURN_MM`.
fn comes_down(curve: &PlaneCurve) -> bool {
    parted_at_tops(vec![*curve])
        .iter()
        .any(|part| part.start()[1] - lowest_of(part) > MIN_TURN_MM)
}

impl Interpreter {
    pub(super) fn rough_own_profile(&mut self, capture: &Capture) -> Read<()> {
        let roughing = Roughing::new(capture)?;
        self.warn_of_allowance(&roughing);
        let (start, depth) = (roughing.start, roughing.depth_mm);
        let passes = ((start[1] - roughing.lowest() - SLACK_MM) / depth).ceil() - 1.0;
        if passes > MAX_PASSES {
            let message = format!(
                "the depth of a pass of {depth} mm makes {passes} passes; the limit is {MAX_PASSES}"
            );
            return Err(
                LineFault::new("gcode::lathe", capture.wanted.block.at(b'p'), message)
                    .hint("make the depth of a pass larger"),
            );
        }
        self.rough_line(&roughing, start, Speed::Rapid)?;
        let mut pass = 1.0;
        while pass <= passes {
            self.rough_level(&roughing, start[1] - pass * depth)?;
            pass += 1.0;
        }
        let here = roughing
            .plane
            .of([self.here[0], self.here[1], self.here[2]]);
        self.rough_line(&roughing, [here[0], start[1]], Speed::Rapid)?;
        self.rough_line(&roughing, roughing.entry(), roughing.infeed)?;
        for curve in &roughing.curves {
            self.rough_curve_of(&roughing, curve)?;
        }
        if roughing.curves.iter().any(comes_down) {
            let end = roughing.curves.last().map_or(start, PlaneCurve::end);
            self.rough_line(&roughing, [end[0], start[1].max(end[1])], Speed::Rapid)?;
        }
        self.line_to(
            &capture.wanted.block,
            capture.wanted.start,
            Speed::Rapid,
            0.0,
        )
    }

    /// The passes at one level: the first from the start of the cycle, those of pockets from above
    /// them.
    fn rough_level(&mut self, roughing: &Roughing<'_>, level: f64) -> Read<()> {
        let start = roughing.start;
        for [begin, end] in roughing.open_at(level) {
            let from_start = begin <= start[0];
            if from_start {
                self.rough_line(roughing, [start[0], level], roughing.infeed)?;
            } else {
                let here = roughing
                    .plane
                    .of([self.here[0], self.here[1], self.here[2]]);
                self.rough_line(roughing, [here[0], start[1]], Speed::Rapid)?;
                self.rough_line(roughing, [begin, start[1]], Speed::Rapid)?;
                self.rough_line(
                    roughing,
                    [begin, (level + roughing.depth_mm).min(start[1])],
                    Speed::Rapid,
                )?;
                self.rough_line(roughing, [begin, level], Speed::Programmed)?;
            }
            self.rough_line(roughing, [end, level], Speed::Programmed)?;
            let off = roughing.escape_mm.min(end - begin);
            self.rough_line(roughing, [end - off, level + off], Speed::Rapid)?;
            if from_start {
                self.rough_line(roughing, [start[0], level + off], Speed::Rapid)?;
            } else {
                self.rough_line(roughing, [end - off, start[1]], Speed::Rapid)?;
                self.rough_line(roughing, start, Speed::Rapid)?;
            }
        }
        Ok(())
    }

    fn warn_of_allowance(&mut self, roughing: &Roughing<'_>) {
        let ProfileWork::Rough { allowance_mm, .. } = roughing.capture.wanted.work else {
            return;
        };
        let shift = roughing.plane.of([allowance_mm[0], 0.0, allowance_mm[1]]);
        let (letter, block) = match shift {
            [along, _] if along > SLACK_MM => {
                (roughing.plane.axes[0], &roughing.capture.wanted.block)
            }
            [_, out] if out < -SLACK_MM => (roughing.plane.axes[1], &roughing.capture.wanted.block),
            _ => return,
        };
        let letter = if letter == 0 { b'u' } else { b'w' };
        let name = char::from(letter).to_ascii_uppercase();
        let message = format!(
            "{name} of {} moves the profile into the part",
            spelled(roughing.capture.wanted.code)
        );
        self.output.warnings.push(
            *LineFault::new("gcode::lathe", block.at(letter), message)
                .hint("the allowance is left standing with the other sign"),
        );
    }

    fn rough_line(&mut self, roughing: &Roughing<'_>, point: PlanePoint, speed: Speed) -> Read<()> {
        let wanted = &roughing.capture.wanted;
        self.pass_line(&wanted.block, &wanted.start, roughing.plane, point, speed)
    }

    fn rough_curve_of(&mut self, roughing: &Roughing<'_>, curve: &PlaneCurve) -> Read<()> {
        let wanted = &roughing.capture.wanted;
        self.pass_curve(&wanted.block, &wanted.start, roughing.plane, curve)
    }
}
