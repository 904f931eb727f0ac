//! Straight motions, and what every motion shares: where it ends, and how fast it goes.

use super::block::Block;
use super::canon::{Canon, Motion, MotionKind, Others, Shape};
use super::codes::{AXIS_LETTERS, Group, bit};
use super::diagnostic::{Fault, Read, Short};
use super::settings::Dialect;
use super::state::{FeedMode, Interpreter, Position};

/// Seconds of a minute.
pub(super) const MINUTE_S: f64 = 60.0;

/// How fast a motion goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Speed {
    Rapid,
    /// By F.
    Programmed,
}

impl Speed {
    pub(super) const fn kind(self) -> MotionKind {
        match self {
            Self::Rapid => MotionKind::Rapid,
            Self::Programmed => MotionKind::Feed,
        }
    }
}

impl Interpreter {
    /// G0 and G1.
    pub(super) fn straight(&mut self, block: &Block, code: u16) -> Read<()> {
        let extruder_mm = self.extruder_word(block);
        if !block.has_axes() && extruder_mm == 0.0 {
            return Ok(());
        }
        let is_g53 = block.code(Group::NonModal).is_some_and(|word| word.number == 530);
        let target = if is_g53 { self.machine_target(block)? } else { self.target(block)? };
        // Printers move at F with G0 too; G53 of Fanuc is always a rapid.
        let is_feed = (code == 10 && !(is_g53 && self.dialect.is_fanuc()))
            || (self.dialect == Dialect::Printer && self.modal.feed > 0.0);
        self.straight_as(block, &target, is_feed, extruder_mm)
    }

    /// Straight to a point in program coordinates, beside it under cutter compensation.
    pub(super) fn straight_as(
        &mut self,
        block: &Block,
        target: &Position,
        is_feed: bool,
        extruder_mm: f64,
    ) -> Read<()> {
        if self.compensated_straight(block, target, is_feed)? {
            return Ok(());
        }
        let machine = self.frame.to_machine(target);
        let speed = if is_feed { Speed::Programmed } else { Speed::Rapid };
        let fed = self.line_to(block, machine, speed, extruder_mm);
        self.at = *target;
        if self.behind_fault {
            // Known again once a line names where it goes.
            self.behind_fault = self.modal.incremental
                || !(block.has(b'x') && block.has(if self.dialect.is_lathe() { b'z' } else { b'y' }));
        }
        fed
    }

    /// Moves straight to `machine`; the programmed position is the caller's business.
    #[inline]
    pub(super) fn line_to(&mut self, block: &Block, machine: Position, speed: Speed, extruder_mm: f64) -> Read<()> {
        let start = std::mem::replace(&mut self.here, machine);
        let others = others(&start, &machine, extruder_mm);
        if others.is_none() && start[..3] == machine[..3] {
            return Ok(());
        }
        if speed == Speed::Programmed && self.follows_surface() && extruder_mm == 0.0 {
            return self.line_at_surface_speed(block, &start);
        }
        let feed_mm_s = match speed {
            Speed::Rapid => 0.0,
            Speed::Programmed => {
                let feed = self.feed_for(block, distance(&start, &machine))?;
                if turns_only(&start, &machine) { feed / self.modal.feed_unit_mm } else { feed }
            }
        };
        self.push_motion(speed, &start, Shape::Line, feed_mm_s, others);
        Ok(())
    }

    /// Hands out the motion from `start` to the current position.
    #[inline]
    pub(super) fn push_motion(&mut self, speed: Speed, start: &Position, shape: Shape, feed_mm_s: f64, others: Others) {
        let kind = speed.kind();
        self.motions += 1;
        self.left_compensation = false;
        self.push(Canon::Motion(Motion {
            line: self.line,
            kind,
            start_mm: [start[0], start[1], start[2]],
            end_mm: [self.here[0], self.here[1], self.here[2]],
            shape,
            feed_mm_s,
            corner: self.modal.corner,
            others,
        }));
    }

    /// The feedrate of a motion of `length_mm`, mm/s.
    #[inline]
    pub(super) fn feed_for(&mut self, block: &Block, length_mm: f64) -> Read<f64> {
        let feed = self.modal.feed;
        match self.modal.feed_mode {
            FeedMode::PerMinute if feed > 0.0 => Ok(feed / MINUTE_S),
            FeedMode::Inverse if !block.has(b'f') => Err(Fault::new(
                "gcode::feed",
                block.whole(),
                "F is missing: with G93 (inverse time) every feed motion needs its own",
            )
            .hint("F2 does the motion in half a minute; G94 goes back to feed per minute")),
            // The machine's limits hold for whatever is faster; only it must be a number.
            FeedMode::Inverse if feed > 0.0 => Ok((length_mm * feed / MINUTE_S).min(f64::MAX)),
            FeedMode::PerRevolution if feed > 0.0 && self.spindle_rpm(&self.here) == 0.0 => Err(Fault::new(
                "gcode::feed",
                block.whole(),
                "with G95 (feed per revolution) the spindle needs a speed S above 0 rev/min",
            )
            .hint("write S and M3 before it, or G94 for feed per minute")),
            FeedMode::PerRevolution if feed > 0.0 => Ok((feed * self.spindle_rpm(&self.here) / MINUTE_S).min(f64::MAX)),
            // Printers start with a feed of their own.
            _ if self.dialect == Dialect::Printer => Ok(PRINTER_FEED_MM_S),
            _ => self.missing_feed(block),
        }
    }

    /// A feed motion without feed: an error once, for the rest follows from it.
    #[cold]
    fn missing_feed(&mut self, block: &Block) -> Read<f64> {
        if self.missing_feed_reported {
            return Ok(0.0);
        }
        self.missing_feed_reported = true;
        let at = if block.has(b'f') { block.at(b'f') } else { block.whole() };
        let message = if block.has(b'f') {
            "the feed F0 moves nothing: a feed motion needs F above 0"
        } else {
            "a feed motion, but no feed F was given so far"
        };
        Err(Fault::new("gcode::feed", at, message).hint("add F with the feed per minute to this line or one before it"))
    }

    /// Where the axis words lead, in program coordinates.
    #[inline]
    pub(super) fn target(&self, block: &Block) -> Read<Position> {
        let mut target = self.at;
        if block.set & (bit(b'@') | bit(b'^')) != 0 {
            self.polar_target(block, &mut target)?;
        }
        if self.fanuc.is_polar {
            self.own_polar(block, &mut target)?;
        }
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if let Some(value) = block.get(letter) {
                if axis < 2 && self.fanuc.is_polar {
                    continue;
                }
                if axis >= 6 && self.dialect.is_lathe() {
                    target[axis - 6] = self.stepped(block, letter, axis - 6, value)?;
                    continue;
                }
                if self.lathe.is_some() && matches!(letter, b'a' | b'c' | b'u' | b'w') {
                    continue;
                }
                let value = self.length(block, letter, axis, value)?;
                target[axis] = if self.modal.incremental { self.at[axis] + value } else { value };
            }
        }
        if self.lathe.is_some() {
            self.profile_steps(block, &mut target)?;
        }
        self.check_range(block, &target)?;
        Ok(target)
    }

    /// G53: the words are machine coordinates.
    fn machine_target(&self, block: &Block) -> Read<Position> {
        if self.modal.incremental {
            return Err(Fault::new(
                "gcode::g53",
                block.whole(),
                "G53 means machine coordinates, which G91 (distances) cannot give",
            )
            .hint("write G90 before it"));
        }
        // Behind G40 the tool stands beside the contour, and every motion starts from the contour.
        let mut machine = if self.left_compensation { self.frame.to_machine(&self.at) } else { self.here };
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if let Some(value) = block.get(letter) {
                machine[axis] = self.length(block, letter, axis, value)?;
            }
        }
        Ok(self.frame.to_program(&machine))
    }

    /// Value of an axis word in mm or degrees.
    #[inline]
    pub(super) fn length(&self, block: &Block, letter: u8, axis: usize, value: f64) -> Read<f64> {
        let scaled = match axis {
            3..=5 => value,
            0 if self.modal.diameter => 0.5 * value * self.modal.unit_mm,
            _ => value * self.modal.unit_mm,
        };
        if scaled.abs() > self.settings.coordinate_limit_mm {
            return Err(self.too_far(block, letter, scaled));
        }
        Ok(scaled)
    }

    #[cold]
    pub(super) fn too_far(&self, block: &Block, letter: u8, value: f64) -> Box<Fault> {
        let name = char::from(letter).to_ascii_uppercase();
        let limit = self.settings.coordinate_limit_mm;
        let unit = if matches!(letter, b'a' | b'b' | b'c') { "degrees" } else { "mm" };
        let message = format!("{name} = {} {unit} is beyond the limit of {limit} {unit}", Short(value));
        Fault::new("gcode::coordinate", block.at(letter), message).hint(if self.modal.unit_mm == 1.0 {
            "is a decimal point missing?"
        } else {
            "is a decimal point missing? G20 is active: lengths are inches"
        })
    }

    /// Many small steps must not creep beyond the limit either.
    fn check_range(&self, block: &Block, target: &Position) -> Read<()> {
        let limit = self.settings.coordinate_limit_mm;
        for axis in [0, 1, 2, 6, 7, 8] {
            if target[axis].abs() > limit {
                return Err(self.too_far(block, AXIS_LETTERS[axis], target[axis]));
            }
        }
        Ok(())
    }

    /// `@` radius and `^` angle about the origin of the XY plane.
    #[cold]
    fn polar_target(&self, block: &Block, target: &mut Position) -> Read<()> {
        let at = block.at_any(bit(b'@') | bit(b'^'));
        if block.set & (bit(b'x') | bit(b'y')) != 0 {
            return Err(Fault::new("gcode::polar", at, "polar coordinates @ and ^ exclude X and Y"));
        }
        let [first, second, _] = self.modal.plane.axes();
        let (old_radius, old_angle) = (self.at[0].hypot(self.at[1]), self.at[1].atan2(self.at[0]).to_degrees());
        if [first, second] != [0, 1] {
            return Err(Fault::new("gcode::polar", at, "polar coordinates need the XY plane G17"));
        }
        let radius = block.get(b'@').map(|radius| radius * self.modal.unit_mm);
        let angle = block.get(b'^');
        if angle.is_none() && old_radius == 0.0 {
            return Err(Fault::new("gcode::polar", at, "at the origin the angle ^ is needed"));
        }
        let (radius, angle) = if self.modal.incremental {
            (old_radius + radius.unwrap_or(0.0), old_angle + angle.unwrap_or(0.0))
        } else {
            (radius.unwrap_or(old_radius), angle.unwrap_or(old_angle))
        };
        let (sin, cos) = angle.to_radians().sin_cos();
        [target[0], target[1]] = [radius * cos, radius * sin];
        Ok(())
    }

    /// Filament that the line pushes, mm.
    #[inline]
    pub(super) fn extruder_word(&mut self, block: &Block) -> f64 {
        let Some(value) = block.get(b'e') else {
            return 0.0;
        };
        let value = value * self.modal.unit_mm;
        let pushed = if self.extruder_relative { value } else { value - self.extruder_mm };
        self.extruder_mm += pushed;
        pushed
    }
}

/// Feed of a printer before the first F, mm/s: what Marlin starts with (1500 mm/min).
pub(super) const PRINTER_FEED_MM_S: f64 = 25.0;

/// What moves besides X, Y and Z.
#[inline]
pub(super) fn others(start: &Position, end: &Position, extruder_mm: f64) -> Others {
    let axes = (start[3..] != end[3..]).then(|| {
        let six = |position: &Position| std::array::from_fn(|axis| position[axis + 3]);
        Box::new([six(start), six(end)])
    });
    Others { extruder_mm, axes }
}

/// Length that F refers to: of X Y Z if they move, else of U V W, else degrees of A B C.
pub(super) fn distance(start: &Position, end: &Position) -> f64 {
    let along = |axes: std::ops::Range<usize>| axes.map(|axis| (end[axis] - start[axis]).powi(2)).sum::<f64>().sqrt();
    [along(0..3), along(6..9), along(3..6)].into_iter().find(|&length| length > 0.0).unwrap_or(0.0)
}

/// Whether rotary axes are all that moves, so that F is in degrees.
fn turns_only(start: &Position, end: &Position) -> bool {
    start[..3] == end[..3] && start[6..] == end[6..] && start[3..6] != end[3..6]
}
