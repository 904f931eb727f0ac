//! Carries out one block: first its modes, in the order that RS-274 fixes, then its motion, then its stop.
//!
//! Order: NISTIR 6556, table 8: feed mode, F, S, T, tool change, spindle, coolant, overrides, dwell, plane, units, compensation,
//! tool length, coordinate system, path control, distance modes, return level, offsets, motion, stop.

use super::block::{Block, Word};
use super::canon::{Corner, EventKind, Plane};
use super::codes::{self, ALWAYS, Group};
use super::diagnostic::{Fault, Read, Short};
use super::expression::INTEGER_WITHIN;
use super::fanuc;
use super::lexer::NO_EXPONENT;
use super::settings::Dialect;
use super::state::{FeedMode, INCH_MM, Interpreter};

/// Non-modal codes that use the axis words of their line.
const USES_AXES: [u16; 5] = [100, 280, 300, 520, 920];

impl Interpreter {
    /// Carries out `block`.
    pub(super) fn execute(&mut self, block: &Block) -> Read<()> {
        // Hot path: a line with axis words, perhaps G0 or G1, and nothing that changes a mode.
        let is_plain = match block.g[..] {
            [] => true,
            [word] => matches!(word.number, 0 | 10),
            _ => false,
        };
        if is_plain
            && block.m.is_empty()
            && block.set & !(codes::AXES | codes::bit(b'f') | codes::bit(b'e')) == 0
            && self.modal.feed_mode == FeedMode::PerMinute
        {
            self.feed_word(block)?;
            return self.motion(block);
        }
        self.feed_mode(block)?;
        self.feed_word(block)?;
        self.spindle_words(block)?;
        self.tool_words(block)?;
        self.machine_codes(block)?;
        self.modes(block)?;
        self.non_modal(block)?;
        self.motion(block)?;
        self.stop(block)
    }

    /// The motion code that the block carries out, if it moves.
    fn active_motion(&self, block: &Block) -> Option<u16> {
        if let Some(word) = block.code(Group::Motion) {
            return Some(word.number);
        }
        // Printers: `M201 X500` sets a limit and moves nothing.
        if self.dialect == Dialect::Printer && !block.m.is_empty() {
            return None;
        }
        let taken = block.code(Group::NonModal).is_some_and(|word| USES_AXES.contains(&word.number))
            || block.code(Group::ToolLength).is_some_and(|word| matches!(word.number, 431 | 432))
            || (self.dialect.is_fanuc() && fanuc::uses_axes(block));
        let is_center = matches!(self.modal.motion, 20 | 30)
            && block.set & codes::ARC_CENTER != 0
            && block.code(Group::NonModal).is_none();
        let is_g53 = block.code(Group::NonModal).is_some_and(|word| word.number == 530);
        if is_g53 && self.dialect.is_fanuc() && block.has_axes() {
            return Some(0); // It moves by itself.
        }
        (!taken && (block.has_axes() || is_center || (self.dialect == Dialect::Printer && block.has(b'e'))))
            .then_some(self.modal.motion)
    }

    /// Refuses words that no code of the line gives a meaning to.
    fn check_words(&self, block: &Block, motion: Option<u16>) -> Read<()> {
        if let Some(code @ 700..=722) = motion {
            self.check_lathe_words(block, code)?;
        }
        let mut known = ALWAYS;
        if self.dialect == Dialect::Printer {
            known |= codes::bit(b'e');
        }
        for word in &block.g {
            known |= codes::find(word.number).map_or(0, |code| code.letters);
        }
        for word in &block.m {
            known |= self.m_letters(word.number);
        }
        if block.has(b's') {
            known |= codes::bit(b'$');
        }
        if let Some(code) = motion.and_then(codes::find) {
            known |= code.letters;
        }
        let unknown = block.set & !known;
        if unknown == 0 {
            return Ok(());
        }
        let slot = unknown.trailing_zeros() as usize;
        let at = block.at_any(unknown);
        let word = codes::letter(slot);
        if unknown & codes::AXES != 0 {
            return Err(self.axes_without_motion(block, motion));
        }
        let with = motion.map_or_else(|| "this line".to_owned(), codes::spelled);
        let fault = Fault::new("gcode::unused_word", at, format!("{word} has no meaning with {with}"));
        Err(match word {
            'E' if block.exponent => fault.hint(NO_EXPONENT),
            'E' => fault.hint("E pushes filament on 3D printers: choose the printer's dialect for its programs"),
            'K' if matches!(motion, Some(810..=890)) => {
                fault.hint("K is how often Fanuc repeats a cycle: LinuxCNC's word is L, or choose --dialect fanuc")
            }
            'I' | 'J' | 'K' => fault.hint("I, J and K are the centre of an arc: write G2 or G3 on this line"),
            'R' if matches!(motion, Some(0 | 10)) => {
                fault.hint("R is the radius of an arc (G2, G3) or a height of a cycle (G81 to G89)")
            }
            _ => fault,
        })
    }

    #[cold]
    fn axes_without_motion(&self, block: &Block, motion: Option<u16>) -> Box<Fault> {
        let at = block.at_any(codes::AXES);
        if motion == Some(800) && block.code(Group::Motion).is_some() {
            return Fault::new("gcode::no_motion_mode", at, "G80 ends motion modes and takes no axis words")
                .hint("write G0 or G1 with them on the next line");
        }
        Fault::new("gcode::no_motion_mode", at, "axis words, but no code such as G0 or G1 says how to move")
            .hint("write G0, G1, G2 or G3 on this line or one before it")
    }

    fn feed_mode(&mut self, block: &Block) -> Read<()> {
        if let Some(word) = block.code(Group::FeedMode) {
            let mode = match word.number {
                930 => FeedMode::Inverse,
                950 => FeedMode::PerRevolution,
                _ => FeedMode::PerMinute,
            };
            if mode != self.modal.feed_mode {
                self.modal.feed_mode = mode;
                // The old F had another meaning.
                self.modal.feed = 0.0;
            }
        }
        Ok(())
    }

    #[inline]
    fn feed_word(&mut self, block: &Block) -> Read<()> {
        let Some(feed) = block.get(b'f') else {
            return Ok(());
        };
        if feed < 0.0 {
            return Err(Fault::new(
                "gcode::feed",
                block.at(b'f'),
                format!("feed F{} is negative; the smallest is 0", Short(feed)),
            ));
        }
        // F comes before G20 and G21 of the same line: it still has the old unit.
        self.modal.feed_unit_mm = if self.modal.feed_mode == FeedMode::Inverse { 1.0 } else { self.modal.unit_mm };
        self.modal.feed = (feed * self.modal.feed_unit_mm).min(f64::MAX);
        if self.dialect.is_lathe() {
            self.check_lathe_feed(block);
        }
        Ok(())
    }

    fn spindle_words(&mut self, block: &Block) -> Read<()> {
        // -1 is all spindles; there is one.
        if block.has(b'$') && !matches!(self.integer(block, b'$', -1, 100)?, -1 | 0) {
            let message = format!(
                "spindle ${} does not exist: the first spindle is $0, and only it is read",
                Short(block.get(b'$').unwrap_or_default())
            );
            return Err(Fault::new("gcode::spindle", block.at(b'$'), message));
        }
        let Some(speed) = block.get(b's') else {
            return Ok(());
        };
        if self.dialect == Dialect::Printer {
            return Ok(()); // Temperatures, seconds of G4, servo angles: S belongs to another code of the line.
        }
        if speed < 0.0 {
            return Err(Fault::new(
                "gcode::spindle",
                block.at(b's'),
                format!("spindle speed S{} is negative; the smallest is 0 rev/min", Short(speed)),
            ));
        }
        if self.dialect.is_fanuc() && fanuc::bounds_spindle(block) {
            return self.bound_spindle(block, speed);
        }
        self.modal.spindle_speed = speed;
        // G96 and G97 on this line are carried out later, and mean this S.
        let is_surface = match block.code(Group::SpindleMode) {
            Some(word) => word.number == 960,
            None => self.modal.constant_surface.is_some(),
        };
        if !is_surface {
            self.event(EventKind::SpindleSpeed { rpm: speed });
        }
        Ok(())
    }

    fn tool_words(&mut self, block: &Block) -> Read<()> {
        if block.has(b't') && self.dialect.is_lathe() {
            return self.turret(block);
        }
        if block.has(b't') {
            let tool = self.integer(block, b't', 0, 999_999)?;
            self.next_tool = tool as u32;
            self.event(EventKind::ToolSelect { tool: self.next_tool });
        }
        Ok(())
    }

    /// A word that must hold an integer within limits.
    pub(super) fn integer(&self, block: &Block, letter: u8, low: i64, high: i64) -> Read<i64> {
        let value = block.get(letter).unwrap_or(0.0);
        let name = codes::letter(codes::slot(letter));
        let at = block.at(letter);
        if (value - value.round()).abs() > INTEGER_WITHIN {
            return Err(Fault::new("gcode::integer", at, format!("{name}{} is not an integer", Short(value))));
        }
        let rounded = value.round() as i64;
        if !(low..=high).contains(&rounded) {
            return Err(Fault::new(
                "gcode::range",
                at,
                format!("{name}{} is out of range: {low} to {high}", Short(value.round())),
            ));
        }
        Ok(rounded)
    }

    /// Modes that a G-code of the line changes.
    fn modes(&mut self, block: &Block) -> Read<()> {
        if block.g.is_empty() {
            return Ok(());
        }
        if let Some(word) = block.code(Group::NonModal)
            && word.number % fanuc::OWN == 40
        {
            self.dwell(block, word)?;
        }
        if let Some(word) = block.code(Group::Plane) {
            self.modal.plane = match word.number {
                180 => Plane::Zx,
                190 => Plane::Yz,
                _ => Plane::Xy,
            };
        }
        if let Some(word) = block.code(Group::Units) {
            self.modal.unit_mm = if word.number == 200 { INCH_MM } else { 1.0 };
        }
        if let Some(word) = block.code(Group::Diameter) {
            self.modal.diameter = word.number == 70;
        }
        self.compensation_mode(block)?;
        self.tool_length(block)?;
        self.coordinate_system(block)?;
        if let Some(word) = block.code(Group::Corner) {
            self.modal.corner = self.corner(block, word)?;
        }
        if let Some(word) = block.code(Group::Distance) {
            self.modal.incremental = word.number == 910;
            self.extruder_relative = self.modal.incremental;
        }
        if let Some(word) = block.code(Group::ArcDistance) {
            self.modal.arc_absolute = word.number == 901;
        }
        if let Some(word) = block.code(Group::Return) {
            self.modal.retract_to_r = word.number == 990;
        }
        if self.dialect.is_fanuc() {
            self.own_modes(block)?;
        }
        self.spindle_mode(block)
    }

    fn corner(&self, block: &Block, word: Word) -> Read<Corner> {
        Ok(match word.number {
            610 => Corner::ExactPath,
            611 => Corner::ExactStop,
            _ => {
                let tolerance = block.get(b'p').map(|p| p * self.modal.unit_mm);
                if tolerance.is_some_and(|p| p < 0.0) {
                    return Err(Fault::new(
                        "gcode::range",
                        block.at(b'p'),
                        "the tolerance P of G64 is negative; the smallest is 0",
                    ));
                }
                Corner::Continuous { tolerance_mm: tolerance.filter(|&p| p > 0.0) }
            }
        })
    }

    fn dwell(&mut self, block: &Block, word: Word) -> Read<()> {
        let printer = self.dialect == Dialect::Printer;
        let seconds = match (block.get(b'p'), block.get(b's')) {
            (_, Some(seconds)) if printer => seconds,
            (Some(milliseconds), _) if printer => milliseconds * 1e-3,
            (Some(time), _) => self.seconds(block, time),
            (None, _) if self.dialect.is_fanuc() && (block.has(b'x') || block.has(b'u')) => {
                block.get(b'x').or(block.get(b'u')).unwrap_or(0.0)
            }
            (None, _) if printer => 0.0,
            (None, _) => {
                return Err(Fault::new("gcode::dwell", word.at(), "the dwell G4 has no time").hint(
                    if self.dialect.is_fanuc() {
                        "write G4 X or U with seconds, or P with milliseconds"
                    } else {
                        "write G4 P with seconds"
                    },
                ));
            }
        };
        if seconds < 0.0 {
            return Err(Fault::new(
                "gcode::dwell",
                block.at_any(codes::bit(b'p') | codes::bit(b's') | codes::bit(b'x') | codes::bit(b'u')),
                format!("the dwell of {} s is negative; the smallest is 0 s", Short(seconds)),
            ));
        }
        self.event(EventKind::Dwell { seconds });
        Ok(())
    }

    /// Seconds of the time P of a dwell. Fanuc and Haas count milliseconds where it has no decimal point.
    pub(super) const fn seconds(&self, block: &Block, time: f64) -> f64 {
        if self.dialect.is_fanuc() && !block.has_point(b'p') { time * 1e-3 } else { time }
    }

    fn motion(&mut self, block: &Block) -> Read<()> {
        let motion = self.active_motion(block);
        self.check_words(block, motion)?;
        let Some(code) = motion else { return Ok(()) };
        if let Some(word) = block.code(Group::Motion) {
            // `G80 G28 Z0`: G28 takes the axis words. Fanuc: in `G0 G28 Z0` too, and G0 is only remembered.
            let taken = block.code(Group::NonModal).is_some_and(|other| USES_AXES.contains(&other.number))
                || (self.dialect.is_fanuc() && fanuc::uses_axes(block));
            if taken && (code == 800 || self.dialect.is_fanuc()) {
                self.modal.motion = code;
                return Ok(());
            }
            if let Some(other) =
                block.code(Group::NonModal).filter(|other| USES_AXES.contains(&other.number) && block.has_axes())
            {
                let message = format!(
                    "{} and {} would both use the axis words",
                    codes::spelled(word.number),
                    codes::spelled(other.number)
                );
                return Err(Fault::new("gcode::modal_group", other.at(), message).hint("write them on two lines"));
            }
            self.modal.motion = code;
        }
        if block.code(Group::NonModal).is_some_and(|word| word.number == 530) && !matches!(code, 0 | 10) {
            return Err(Fault::new(
                "gcode::g53",
                block.whole(),
                format!("G53 goes with G0 or G1, not with {}", codes::spelled(code)),
            ));
        }
        if !matches!(code % fanuc::OWN, 730 | 740 | 810..=890) {
            self.end_cycles();
        }
        if code < fanuc::LATHE_OWN && self.dialect.is_lathe() {
            self.end_turning();
        }
        if self.collected.is_some() && !matches!(code, 52 | 53 | 62) {
            self.check_no_curve(block)?;
        }
        if code != 50 {
            self.last_bezier_end = None;
        }
        if self.lathe.is_some() {
            self.corner_word(block)?;
        }
        match code {
            0 | 10 | 20 | 30 if self.has_own_corner(block) => self.own_corner(block, code),
            0 | 10 => self.straight(block, code),
            20 | 30 => self.arc(block, code == 30),
            800 if block.has_axes() => Err(self.axes_without_motion(block, motion)),
            800 => Ok(()),
            _ => self.special_motion(block, code),
        }
    }

    fn stop(&mut self, block: &Block) -> Read<()> {
        for word in &block.m {
            match word.number {
                0 | 1 | 60 => self.event(EventKind::MCode { code: word.number, p: None, q: None }),
                2 | 30 => {
                    self.event(EventKind::MCode { code: word.number, p: None, q: None });
                    let open = self.lathe.is_some();
                    self.end_program();
                    self.check_profile_end(open, word.at())?;
                    self.check_no_curve(block)?;
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// Hands out the end of the program.
    pub(super) fn end_program(&mut self) {
        if !self.ended {
            self.ended = true;
            self.lathe = None;
            self.compensation = None;
            self.release();
            self.event(EventKind::ProgramEnd);
        }
    }
}
