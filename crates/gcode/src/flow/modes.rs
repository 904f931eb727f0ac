//! Modes, feed, spindle and tool words of a block, in the order that RS-274 fixes.

use crate::canon::{Corner, EventKind, Plane};
use crate::dialects::fanuc;
use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::state::modal::{FeedMode, INCH_MM};
use crate::text::block::{Block, Word};
use crate::text::codes::fanuc::OWN;
use crate::text::codes::{self, Group};
use crate::text::diagnostic::{LineFault, Read, Short};

/// Dwell in whole seconds from which on it may be meant in milliseconds: 0.1 s is a usual dwell,
/// 100 s is not.
const LONG_DWELL_S: f64 = 100.0;

impl Interpreter {
    pub(super) fn feed_mode(&mut self, block: &Block) -> Read<()> {
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
    pub(super) fn feed_word(&mut self, block: &Block) -> Read<()> {
        let Some(feed) = block.get(b'f') else {
            return Ok(());
        };
        if feed < 0.0 {
            return Err(LineFault::new(
                "gcode::feed",
                block.at(b'f'),
                format!("feed F{} is negative; the smallest is 0", Short(feed)),
            ));
        }
        // F comes before G20 and G21 of the same line: it still has the old unit.
        self.modal.feed_unit_mm = if self.modal.feed_mode == FeedMode::Inverse {
            1.0
        } else {
            self.modal.unit_mm
        };
        self.modal.feed = (feed * self.modal.feed_unit_mm).min(f64::MAX);
        if self.dialect.is_lathe() {
            self.check_lathe_feed(block);
        }
        Ok(())
    }

    pub(super) fn spindle_words(&mut self, block: &Block) -> Read<()> {
        // -1 is all spindles; there is one.
        if block.has(b'$') && !matches!(self.integer(block, b'$', -1, 100)?, -1 | 0) {
            let message = format!(
                "spindle ${} does not exist: the first spindle is $0, and only it is read",
                Short(block.get(b'$').unwrap_or_default())
            );
            return Err(LineFault::new("gcode::spindle", block.at(b'$'), message));
        }
        let Some(speed) = block.get(b's') else {
            return Ok(());
        };
        if self.dialect == Dialect::Printer {
            return Ok(()); // Temperatures, seconds of G4, servo angles: S belongs to another code of the line.
        }
        if speed < 0.0 {
            return Err(LineFault::new(
                "gcode::spindle",
                block.at(b's'),
                format!(
                    "spindle speed S{} is negative; the smallest is 0 rev/min",
                    Short(speed)
                ),
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

    pub(super) fn tool_words(&mut self, block: &Block) -> Read<()> {
        if block.has(b't') && self.dialect.is_lathe() {
            return self.turret(block);
        }
        if block.has(b't') {
            let tool = self.integer(block, b't', 0, 999_999)?;
            self.tool.next = tool as u32;
            self.event(EventKind::ToolSelect {
                tool: self.tool.next,
            });
        }
        Ok(())
    }

    /// Modes that a G-code of the line changes.
    pub(super) fn modes(&mut self, block: &Block) -> Read<()> {
        if block.g.is_empty() {
            return Ok(());
        }
        if let Some(word) = block.code(Group::NonModal)
            && word.number % OWN == 40
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
        match block.code(Group::CutterCompensation) {
            Some(word) if word.number >= OWN => self.nose_compensation(word),
            _ => self.compensation_mode(block)?,
        }
        self.scaling(block)?;
        self.tool_length(block)?;
        self.coordinate_system(block)?;
        if let Some(word) = block.code(Group::Corner) {
            self.modal.corner = self.corner(block, word)?;
        }
        if let Some(word) = block.code(Group::Distance) {
            self.modal.incremental = word.number == 910;
            self.extruder.is_relative = self.modal.incremental;
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
                    return Err(LineFault::new(
                        "gcode::range",
                        block.at(b'p'),
                        "the tolerance P of G64 is negative; the smallest is 0",
                    ));
                }
                let merge = block.get(b'q').map(|q| q * self.modal.unit_mm);
                Corner::Continuous {
                    tolerance_mm: tolerance.filter(|&p| p > 0.0),
                    merge_mm: merge.filter(|&q| q >= 0.0),
                }
            }
        })
    }

    /// G50 alone ends scaling on some controls, which nothing here begins; with words it means
    /// something else.
    fn scaling(&mut self, block: &Block) -> Read<()> {
        let Some(word) = block.code(Group::Scaling) else {
            return Ok(());
        };
        if block.has_axes() || block.has(b's') {
            let message =
                "G50 with words is a scale, a speed or a shift on other controls, and is not read";
            return Err(LineFault::new("gcode::unsupported", word.at(), message)
                .hint("scale the part in the CAM system; on a lathe, D of G96 bounds the speed of the spindle"));
        }
        let message = "G50 is left out: it ends scaling on other controls (Tormach), and LinuxCNC does not know it";
        self.output
            .warnings
            .push(*LineFault::new("gcode::unsupported", word.at(), message));
        Ok(())
    }

    /// A time that looks as if it were in the milliseconds of Fanuc, in a program whose control is
    /// guessed.
    fn check_seconds(&mut self, block: &Block, seconds: f64) {
        let is_guessed = self.dialect == Dialect::LinuxCnc && self.settings.dialect.is_none();
        if is_guessed && seconds >= LONG_DWELL_S && seconds.fract() == 0.0 {
            let shown = Short(seconds);
            let message = format!(
                "the dwell P{shown} is read as {shown} s; Fanuc and others count milliseconds"
            );
            let fault = LineFault::new("gcode::dwell", block.at(b'p'), message);
            self.output
                .warnings
                .push(*fault.hint("--dialect linuxcnc or fanuc says whose program it is"));
        }
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
                return Err(
                    LineFault::new("gcode::dwell", word.at(), "the dwell G4 has no time").hint(
                        if self.dialect.is_fanuc() {
                            "write G4 X or U with seconds, or P with milliseconds"
                        } else {
                            "write G4 P with seconds"
                        },
                    ),
                );
            }
        };
        if seconds < 0.0 {
            return Err(LineFault::new(
                "gcode::dwell",
                block.at_any(
                    codes::bit(b'p') | codes::bit(b's') | codes::bit(b'x') | codes::bit(b'u'),
                ),
                format!(
                    "the dwell of {} s is negative; the smallest is 0 s",
                    Short(seconds)
                ),
            ));
        }
        self.check_seconds(block, seconds);
        self.event(EventKind::Dwell { seconds });
        Ok(())
    }

    /// G96 with its highest speed, G97.
    fn spindle_mode(&mut self, block: &Block) -> Read<()> {
        if let Some(word) = block.code(Group::SpindleMode) {
            if block.get(b'd').is_some_and(|most| most < 0.0) {
                return Err(LineFault::new(
                    "gcode::spindle",
                    block.at(b'd'),
                    "the highest spindle speed D must not be negative",
                ));
            }
            if word.number == 960 && !block.has(b's') && self.dialect == Dialect::LinuxCnc {
                return Err(LineFault::new(
                    "gcode::spindle",
                    word.at(),
                    "G96 (constant surface speed) needs the speed S on its line",
                )
                .hint("write G96 S100 with metres per minute, in G20 feet per minute"));
            }
            if self.dialect.is_fanuc() {
                self.own_spindle_mode(block, word)?;
            }
            let highest = block.get(b'd').unwrap_or(self.highest_rpm());
            self.modal.constant_surface = (word.number == 960).then_some(highest);
        }
        Ok(())
    }
}
