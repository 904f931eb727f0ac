//! Cutter compensation, G40-G42.1: the path of a tool of radius r that stays left (G41) or right
//! (G42) of the programmed contour.
//!
//! Lines move aside by r, arcs get the radius R - r or R + r. At an outer corner the tool rolls
//! round the corner on an arc of radius r; at an inner corner both motions end where their offset
//! curves meet. What is known of a motion's end only when the next one is read is held back. The
//! first motion ends beside its end point, the motion behind G40 leaves from there. All in machine
//! coordinates of the plane.

use crate::canon::{Canon, Motion, Plane, Shape};
use crate::geometry::plane::{
    PlaneArc, PlaneCurve, PlanePoint, SLACK_MM, add, cross, dot, left_of, length, minus, scaled,
    unit,
};
use crate::motion::feed::{Speed, others};
use crate::state::Interpreter;
use crate::state::carried_over::Compensation;
use crate::state::frame::Position;
use crate::text::block::{Block, Word};
use crate::text::codes::{Group, spelled};
use crate::text::diagnostic::{LineFault, Read};

/// Corners flatter than this, rad, are joined as they are where they cannot meet: up to r/800 into
/// the contour. LinuxCNC's limit.
const FLAT_WITHIN_RAD: f64 = 0.05;

/// A corner is smooth where joining the offset curves as they are takes less than this from the
/// contour, mm: a tenth of what a tool's distance may be off.
const SMOOTH_WITHIN_MM: f64 = 1e-7;

/// An entry may be shorter than the radius by rounding, mm.
const ENTRY_SLACK_MM: f64 = 1e-9;

impl Interpreter {
    /// G40, G41, G41.1, G42, G42.1.
    pub(crate) fn compensation_mode(&mut self, block: &Block) -> Read<()> {
        let Some(word) = block.code(Group::CutterCompensation) else {
            return if self.compensates() {
                self.check_compensated(block)
            } else {
                Ok(())
            };
        };
        if word.number == 401 {
            let message = "G40.1 is read as G40: it ends cutter compensation";
            self.output
                .warnings
                .push(*LineFault::new("gcode::compensation", word.at(), message));
        }
        if matches!(word.number, 400 | 401) {
            let was = self.carried.compensation.take();
            self.carried.left_compensation |=
                was.is_some_and(|was| was.last.is_some() && was.radius_mm > 0.0);
            self.release();
            return Ok(());
        }
        if self.compensates() {
            return Err(LineFault::new(
                "gcode::compensation",
                word.at(),
                "cutter compensation is already on",
            )
            .hint("end it with G40 first"));
        }
        if self.modal.plane == Plane::Yz {
            return Err(LineFault::new(
                "gcode::compensation",
                word.at(),
                "cutter compensation needs the plane G17 or G18, not G19",
            ));
        }
        let left = if word.number < 420 { 1.0 } else { -1.0 };
        let diameter = self.cutter_diameter(block, word)?;
        if self.lathe.is_some() {
            let message = format!(
                "{} inside the profile of a lathe cycle",
                spelled(word.number)
            );
            let fault = LineFault::new("gcode::compensation", word.at(), message);
            return Err(fault
                .hint("the profile is the part's; leave the radius of the tool to the cycle's D"));
        }
        // A negative diameter is the other side.
        let side = if diameter < 0.0 { -left } else { left };
        self.carried.compensation = Some(Compensation {
            side,
            radius_mm: 0.5 * diameter.abs(),
            last: None,
        });
        Ok(())
    }

    /// Diameter of the tool that G41 and G42 name, or of D of G41.1 and G42.1, mm.
    fn cutter_diameter(&self, block: &Block, word: Word) -> Read<f64> {
        if matches!(word.number, 411 | 421) {
            let diameter = block
                .get(b'd')
                .map(|diameter| diameter * self.modal.unit_mm);
            let message = || format!("{} needs the diameter D", spelled(word.number));
            return diameter
                .ok_or_else(|| LineFault::new("gcode::compensation", word.at(), message()));
        }
        let tool = if block.has(b'd') {
            self.integer(block, b'd', 0, 999_999)? as u32
        } else {
            self.tool.number
        };
        match self.settings.tools.get(tool) {
            Some(entry) => Ok(entry.diameter_mm),
            None if tool == 0 => Ok(0.0),
            None => {
                let at = if block.has(b'd') {
                    block.at(b'd')
                } else {
                    word.at()
                };
                let message =
                    format!("tool {tool} is not in the tool table: its radius is not known");
                Err(
                    LineFault::new("gcode::compensation", at, message).hint(format!(
                        "give a tool table with --tool-table, or write {}.1 D with the diameter",
                        spelled(word.number)
                    )),
                )
            }
        }
    }

    /// Codes that make no sense while the tool is beside the contour.
    fn check_compensated(&self, block: &Block) -> Read<()> {
        let forbidden = block
            .g
            .iter()
            .find(|word| matches!(word.number, 100 | 170..=190 | 280 | 300 | 520 | 530 | 540..=593 | 920..=923));
        match forbidden {
            Some(word) if !(matches!(word.number, 170 | 180) && self.is_plane(word.number)) => {
                Err(LineFault::new(
                    "gcode::compensation",
                    word.at(),
                    format!(
                        "{} cannot be used while cutter compensation is on",
                        spelled(word.number)
                    ),
                )
                .hint("end it with G40 first"))
            }
            _ => Ok(()),
        }
    }

    fn is_plane(&self, number: u16) -> bool {
        (number == 180) == (self.modal.plane == Plane::Zx)
    }

    /// A straight motion; false where compensation is off.
    pub(super) fn compensated_straight(
        &mut self,
        block: &Block,
        target: &Position,
        is_feed: bool,
    ) -> Read<bool> {
        let Some(compensation) = self.carried.compensation.clone() else {
            return Ok(false);
        };
        let speed = if is_feed {
            Speed::Programmed
        } else {
            Speed::Rapid
        };
        let [first, second, _] = self.modal.plane.axes();
        let goal = self.frame.to_machine(target);
        let (from, to) = (self.programmed_point(), [goal[first], goal[second]]);
        let from = if compensation.last.is_none() {
            [self.here[first], self.here[second]]
        } else {
            from
        };
        self.at = *target;
        let way = minus(to, from);
        let mut machine = goal;
        if length(way) == 0.0 && (compensation.last.is_some() || compensation.radius_mm == 0.0) {
            // Along the normal only: the tool stays where it is beside the contour.
            (machine[first], machine[second]) = (self.here[first], self.here[second]);
            self.line_to(block, machine, speed, 0.0)?;
            return Ok(true);
        }
        let along = unit(way);
        let aside = scaled(left_of(along), compensation.side * compensation.radius_mm);
        let end = add(to, aside);
        if compensation.last.is_none() {
            check_entry(block, length(way), compensation.radius_mm)?;
        }
        // An entry that leads into an inner corner ends as if its whole length had been beside the
        // contour.
        let mut start = add(from, aside);
        if compensation.last.is_some() {
            start = self.corner_to(
                block,
                &compensation,
                from,
                along,
                &PlaneCurve::Line { start, end },
                speed,
            )?;
        }
        (machine[first], machine[second]) = (end[0], end[1]);
        self.hold_motion(block, machine, speed, Shape::Line)?;
        self.set_last(PlaneCurve::Line { start, end }, along);
        Ok(true)
    }

    /// An arc; false where compensation is off.
    pub(super) fn compensated_arc(
        &mut self,
        block: &Block,
        target: &Position,
        round: PlaneArc,
    ) -> Read<bool> {
        let Some(compensation) = self.carried.compensation.clone() else {
            return Ok(false);
        };
        let plane = self.modal.plane;
        let [first, second, _] = plane.axes();
        let goal = self.frame.to_machine(target);
        let mut center = self.at;
        (center[first], center[second]) = (round.center[0], round.center[1]);
        let center = self.frame.to_machine(&center);
        let center = [center[first], center[second]];
        let (from, to) = (self.programmed_point(), [goal[first], goal[second]]);
        let turn = f64::from(round.turns.signum());
        let radius = length(minus(to, center));
        let offset_radius = radius - turn * compensation.side * compensation.radius_mm;
        if offset_radius <= 0.0 {
            let message = format!(
                "the arc's radius of {radius:.4} mm must exceed the tool's radius of {:.4} mm",
                compensation.radius_mm
            );
            return Err(LineFault::new(
                "gcode::compensation",
                block.whole(),
                message,
            ));
        }
        let end = add(center, scaled(minus(to, center), offset_radius / radius));
        let programmed = PlaneCurve::Arc {
            start: from,
            end: to,
            center,
            turn,
        };
        let end_along = programmed.direction(to);
        self.at = *target;
        let (start, center) = if compensation.last.is_none() && compensation.radius_mm > 0.0 {
            let here = [self.here[first], self.here[second]];
            let center = entry_center(here, to, end).ok_or_else(|| {
                LineFault::new(
                    "gcode::compensation",
                    block.whole(),
                    "the entry arc cannot reach the compensated end",
                )
            })?;
            (here, center)
        } else {
            let start = add(center, scaled(unit(minus(from, center)), offset_radius));
            let curve = PlaneCurve::Arc {
                start,
                end,
                center,
                turn,
            };
            let along = programmed.direction(from);
            (
                self.corner_to(block, &compensation, from, along, &curve, Speed::Programmed)?,
                center,
            )
        };
        let mut machine = goal;
        (machine[first], machine[second]) = (end[0], end[1]);
        let mut center_mm = [self.here[0], self.here[1], self.here[2]];
        (center_mm[first], center_mm[second]) = (center[0], center[1]);
        self.hold_motion(
            block,
            machine,
            Speed::Programmed,
            Shape::Arc {
                plane,
                center_mm,
                turns: round.turns,
            },
        )?;
        self.set_last(
            PlaneCurve::Arc {
                start,
                end,
                center,
                turn,
            },
            end_along,
        );
        Ok(true)
    }

    /// The programmed position in the plane, machine coordinates.
    fn programmed_point(&self) -> PlanePoint {
        let [first, second, _] = self.modal.plane.axes();
        let machine = self.frame.to_machine(&self.at);
        [machine[first], machine[second]]
    }

    fn set_last(&mut self, curve: PlaneCurve, along: PlanePoint) {
        if let Some(compensation) = &mut self.carried.compensation {
            compensation.last = Some((curve, along));
        }
    }

    /// Joins the held motion to `next`, which begins at the programmed `corner` in the direction
    /// `along`; returns where `next` begins on its own curve.
    fn corner_to(
        &mut self,
        block: &Block,
        compensation: &Compensation,
        corner: PlanePoint,
        along: PlanePoint,
        next: &PlaneCurve,
        speed: Speed,
    ) -> Read<PlanePoint> {
        let radius_mm = compensation.radius_mm;
        let Some((before, before_along)) = compensation.last.as_ref().filter(|_| radius_mm > 0.0)
        else {
            self.release();
            return Ok(next.start());
        };
        let angle =
            libm::atan2(cross(*before_along, along), dot(*before_along, along)) * compensation.side;
        let reverses = angle.abs() > std::f64::consts::PI - FLAT_WITHIN_RAD;
        // Back the way it came: which side is inner shows in how the curves bend beside each other.
        let is_inner = if reverses {
            compensation.side * (before.bend() + next.bend()) < 0.0
        } else {
            angle > 0.0
        };
        let is_flat = angle.abs() <= FLAT_WITHIN_RAD;
        let beside = add(
            corner,
            scaled(left_of(along), compensation.side * radius_mm),
        );
        let is_smooth = cut_mm(radius_mm, angle) < SMOOTH_WITHIN_MM
            && next.off_mm(before.end(), beside) < SMOOTH_WITHIN_MM;
        if is_smooth || (is_flat && !is_inner && speed == Speed::Rapid) {
            self.release();
            return Ok(next.start());
        }
        if !is_inner {
            self.release();
            self.roll(block, corner, beside, compensation, speed)?;
            return Ok(next.start());
        }
        let meeting = inner_meeting(before, next, corner, beside);
        // Unequal radii of an arc may let a flat corner meet far away, or nowhere.
        let meeting = meeting
            .filter(|meeting| !is_flat || length(minus(*meeting, beside)) <= radius_mm * angle);
        match meeting {
            Some(meeting) => {
                self.move_held_end(meeting);
                self.release();
                Ok(meeting)
            }
            None if is_flat => {
                self.warn_of_flat_corner(block, radius_mm, angle);
                self.release();
                Ok(next.start())
            }
            None => Err(does_not_fit(block, radius_mm)),
        }
    }

    /// Round an outer corner, to `beside` it. LinuxCNC's rapids go straight there; so do these, for
    /// it is what the machine does.
    fn roll(
        &mut self,
        block: &Block,
        corner: PlanePoint,
        beside: PlanePoint,
        compensation: &Compensation,
        speed: Speed,
    ) -> Read<()> {
        let [first, second, _] = self.modal.plane.axes();
        let mut machine = self.here;
        (machine[first], machine[second]) = (beside[0], beside[1]);
        let mut center_mm = [self.here[0], self.here[1], self.here[2]];
        let from = [self.here[first], self.here[second]];
        (center_mm[first], center_mm[second]) = (corner[0], corner[1]);
        let turns = if compensation.side > 0.0 { -1 } else { 1 };
        let shape = if speed == Speed::Rapid {
            let nearest_mm = length(minus(scaled(add(from, beside), 0.5), corner));
            let cut_mm = compensation.radius_mm - nearest_mm;
            let message = format!(
                "the rapid cuts the corner before it: the tool goes {cut_mm:.4} mm into the contour there"
            );
            let fault = LineFault::new("gcode::compensation", block.whole(), message);
            self.output.warnings.push(
                *fault.hint("round the corner with G1, or end compensation with G40 before G0"),
            );
            Shape::Line
        } else {
            Shape::Arc {
                plane: self.modal.plane,
                center_mm,
                turns,
            }
        };
        self.hold_motion(block, machine, speed, shape)?;
        self.release();
        Ok(())
    }

    #[cold]
    fn warn_of_flat_corner(&mut self, block: &Block, radius_mm: f64, angle: f64) {
        let cut_mm = cut_mm(radius_mm, angle);
        let message = format!(
            "the tool of radius {radius_mm:.4} mm does not fit between the motions here: it cuts {cut_mm:.6} mm into the contour"
        );
        let fault = LineFault::new("gcode::compensation", block.whole(), message);
        self.output
            .warnings
            .push(*fault.hint("a smaller tool, or longer motions"));
    }

    /// Ends the held motion, and what follows it along the normal, at another point of the plane.
    fn move_held_end(&mut self, point: PlanePoint) {
        let [first, second, _] = self.modal.plane.axes();
        let mut is_first = true;
        for step in &mut self.carried.held {
            let Canon::Motion(motion) = step else {
                continue;
            };
            if !is_first {
                (motion.start_mm[first], motion.start_mm[second]) = (point[0], point[1]);
            }
            (motion.end_mm[first], motion.end_mm[second]) = (point[0], point[1]);
            is_first = false;
        }
        (self.here[first], self.here[second]) = (point[0], point[1]);
    }

    /// Moves to `machine`, but keeps the motion back until its end is known.
    fn hold_motion(
        &mut self,
        block: &Block,
        machine: Position,
        speed: Speed,
        shape: Shape,
    ) -> Read<()> {
        let start = std::mem::replace(&mut self.here, machine);
        let mut motion = Motion {
            line: self.line,
            kind: speed.kind(),
            start_mm: [start[0], start[1], start[2]],
            end_mm: [machine[0], machine[1], machine[2]],
            shape,
            feed_mm_s: 0.0,
            corner: self.modal.corner,
            others: others(&start, &machine, 0.0),
        };
        if speed == Speed::Programmed {
            motion.feed_mm_s = self.feed_for(block, motion.length_mm())?;
        }
        self.output.motions += 1;
        self.carried.left_compensation = false;
        self.carried.held.push(Canon::Motion(motion));
        Ok(())
    }
}

fn check_entry(block: &Block, way: f64, radius: f64) -> Read<()> {
    if way >= radius - ENTRY_SLACK_MM {
        return Ok(());
    }
    let message = format!(
        "the entry into cutter compensation is {way:.4} mm long: it must be as long as the tool's radius of {radius:.4} mm"
    );
    Err(
        LineFault::new("gcode::compensation", block.whole(), message)
            .hint("begin the line with G41 or G42 farther from the contour"),
    )
}

/// Returns how far the end of one offset curve lies within the tool radius of the other curve,
/// where the contour turns by an angle: r (1 - cos), mm.
fn cut_mm(radius_mm: f64, angle: f64) -> f64 {
    2.0 * radius_mm * libm::sin(0.5 * angle).powi(2)
}

#[cold]
fn does_not_fit(block: &Block, radius_mm: f64) -> Box<LineFault> {
    let message = format!(
        "the tool of radius {radius_mm:.4} mm does not fit into the inner corner before this motion: it would cut into the contour"
    );
    LineFault::new("gcode::compensation", block.whole(), message)
        .hint("a smaller tool, a larger radius in the corner, or a longer motion")
}

/// Returns the point where the offset curves of an inner corner meet, if they do. `beside` is the
/// start of the second curve, beside the programmed corner.
///
/// An arc with unequal radii uses the radius at its end, so its offset circle does not pass through
/// `beside`. When a line leads into such an arc, LinuxCNC 2.9 moves the circle onto `beside`,
/// intersects it with the line, and moves the intersection back with the circle. The line then ends
/// off its own offset line, by up to the difference of the radii. All other pairs meet without this
/// shift. Source: tests of corners on LinuxCNC 2.9.
fn inner_meeting(
    before: &PlaneCurve,
    next: &PlaneCurve,
    corner: PlanePoint,
    beside: PlanePoint,
) -> Option<PlanePoint> {
    match (before, next) {
        (PlaneCurve::Line { .. }, PlaneCurve::Arc { start, .. }) => {
            let shift = minus(beside, *start);
            let meeting = before.meet(&next.moved(shift), corner)?;
            // An inner corner makes the line shorter: where it is longer than that, it has met the
            // far side of the circle.
            let longer_mm = before.way_to(meeting) - before.way_to(before.end());
            (longer_mm <= length(shift) + SLACK_MM).then(|| minus(meeting, shift))
        }
        _ => before.meet(next, corner),
    }
}

/// Centre of an entry arc: on the normal of the contour at its end, equally far from the start and
/// from the compensated end.
fn entry_center(start: PlanePoint, contour_end: PlanePoint, end: PlanePoint) -> Option<PlanePoint> {
    let normal = unit(minus(end, contour_end));
    let chord = minus(start, end);
    let along = dot(chord, normal);
    // |start - (end + t n)| = |t|
    let t = if along == 0.0 {
        return None;
    } else {
        dot(chord, chord) / (2.0 * along)
    };
    Some(add(end, scaled(normal, t)))
}
