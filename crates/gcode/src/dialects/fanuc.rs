//! What Fanuc and Haas mean by words that LinuxCNC reads otherwise.
//!
//! `mill_or_lathe` distinguishes programs for a lathe from programs for a mill, and
//! `text/codes/fanuc.rs` holds the G-codes that only Fanuc and Haas have. Lathe programs are read
//! in G-code system A: X, U and the position are diameters, U and W are distances, F is a feed per
//! revolution (G99) unless G98 makes it one per minute. `turning` has the cycles of one block,
//! `repetitive` those of two (G70 to G76), `profile` the blocks P to Q that they refer to.

pub(super) mod mill_or_lathe;
mod words;
mod increment;
mod coordinates;
mod corners;
mod drilling;
mod turning;
mod threading;
mod grooving;
mod pattern;
mod roughing;
mod profile;
mod repetitive;

use crate::canon::EventKind;
use crate::state::Interpreter;
use crate::state::fanuc::TurningWords;
use crate::state::modal::FeedMode;
use crate::text::block::{Block, Word};
use crate::text::codes::fanuc::{LATHE_OWN, OWN, SYSTEM_A, row};
use crate::text::codes::{AXES, Group, bit, spelled};
use crate::text::diagnostic::{LineFault, Read, Short};

/// Returns true if a code of the line other than a motion uses its axis words.
pub(crate) fn uses_axes(block: &Block) -> bool {
    block.g.iter().any(|word| {
        word.number >= OWN
            && row(word.number).is_some_and(|row| {
                row.group != Group::Motion && (row.letters & AXES != 0 || word.number == OWN + 650)
            })
    })
}

/// Returns true if a line bounds the spindle speed: G50 S, or G92 S of mills and of G-code systems
/// B and C.
pub(crate) fn bounds_spindle(block: &Block) -> bool {
    block.has(b's')
        && block
            .code(Group::NonModal)
            .is_some_and(|word| matches!(word.number, 920) || word.number % OWN == 500)
}

impl Interpreter {
    /// Prepares a line before it is carried out.
    pub(crate) fn prepare(&mut self, block: &mut Block) -> Read<()> {
        self.count_increments(block);
        self.fanuc.resolved = None;
        if self.fanuc.pending.is_some() {
            self.finish_corner(block)?;
        }
        if self.dialect.is_lathe() {
            self.prepare_lathe(block)?;
            self.check_lathe_chamfer(block)?;
        }
        if self.fanuc.capture.is_some() {
            self.check_profile_block(block)?;
        }
        Ok(())
    }

    fn prepare_lathe(&self, block: &mut Block) -> Read<()> {
        let steps = block.set & (bit(b'u') | bit(b'v') | bit(b'w'));
        if let Some(word) = block
            .code(Group::NonModal)
            .filter(|word| matches!(word.number, 100 | 520 | 530))
            && steps != 0
        {
            let message = format!("U, V and W are not read with {}", spelled(word.number));
            return Err(
                LineFault::new("gcode::unsupported", block.at_any(steps), message)
                    .hint("write X, Y and Z"),
            );
        }
        let cycle = block
            .code(Group::Motion)
            .filter(|word| matches!(word.number % OWN, 900 | 920 | 940));
        if let Some(word) = cycle.filter(|word| word.number >= LATHE_OWN && !block.has_axes()) {
            let code = spelled(word.number);
            let message = format!(
                "{code} without X and Z: in G-code system A it is a cycle, and other systems are not read"
            );
            return Err(LineFault::new("gcode::system_a", word.at(), message).hint(SYSTEM_A));
        }
        let home = block
            .code(Group::NonModal)
            .is_some_and(|word| matches!(word.number, 280 | 300));
        if home {
            // The way to the reference point goes over a point that U and W give as distances.
            for (step, letter, axis) in [(b'u', b'x', 0), (b'w', b'z', 2)] {
                if let Some(value) = block.get(step).filter(|_| !block.has(letter)) {
                    block.put(letter, self.shown_position(axis) + value);
                    block.remove(step);
                }
            }
        }
        Ok(())
    }

    /// Another motion than a turning cycle forgets its words.
    pub(crate) fn end_turning(&mut self) {
        self.fanuc.turning = TurningWords::default();
    }

    /// A feed per revolution that no lathe cuts with is one per minute.
    pub(crate) fn check_lathe_feed(&mut self, block: &Block) {
        if self.modal.feed_mode == FeedMode::PerRevolution
            && self.modal.feed >= LARGE_FEED_MM
            && self.warn_once("gcode::feed")
        {
            let message = format!(
                "the feed is {} mm per revolution (G99, as a lathe begins)",
                Short(self.modal.feed)
            );
            let warning = LineFault::new("gcode::feed", block.at(b'f'), message);
            self.output
                .warnings
                .push(*warning.hint("G98 makes F a feed per minute"));
        }
    }

    /// Bound of the spindle speed (G50 S).
    pub(crate) fn bound_spindle(&mut self, block: &Block, rpm: f64) -> Read<()> {
        if rpm <= 0.0 {
            return Err(LineFault::new(
                "gcode::spindle",
                block.at(b's'),
                "a bound of 0 rev/min stops the spindle",
            )
            .hint("write the highest speed, as in G50 S2500"));
        }
        self.fanuc.highest_rpm = Some(rpm);
        if let Some(highest) = &mut self.modal.constant_surface {
            *highest = rpm;
        }
        Ok(())
    }

    /// S of G96 and G97 on Fanuc: each is remembered, and G97 alone goes on as fast as the spindle
    /// turns.
    pub(crate) fn own_spindle_mode(&mut self, block: &Block, word: Word) -> Read<()> {
        if word.number == 960 {
            let surface = block.get(b's').or(self.fanuc.surface_speed);
            let Some(surface) = surface else {
                return Err(LineFault::new(
                    "gcode::spindle",
                    word.at(),
                    "G96 has no surface speed S",
                )
                .hint("write G96 S180 for 180 m/min"));
            };
            self.modal.spindle_speed = surface;
            self.fanuc.surface_speed = Some(surface);
        } else if self.modal.constant_surface.is_some() && !block.has(b's') {
            self.modal.spindle_speed = self.spindle_rpm(&self.here);
            self.event(EventKind::SpindleSpeed {
                rpm: self.modal.spindle_speed,
            });
        }
        Ok(())
    }

    /// The highest spindle speed of G96, rev/min.
    pub(crate) fn highest_rpm(&self) -> f64 {
        self.fanuc.highest_rpm.unwrap_or(f64::INFINITY)
    }

    /// T of a lathe turns the turret: `T0101` is tool 1 with offset 1.
    pub(crate) fn turret(&mut self, block: &Block) -> Read<()> {
        let number = self.integer(block, b't', 0, 999_999)?;
        let tool = if number > 9999 {
            number / 1000
        } else {
            number / 100
        } as u32;
        // T0 and T0100 take the offset away, and T1 puts offset 1 to the tool that is there.
        if tool != 0 && tool != self.tool.number {
            self.tool.next = tool;
            self.event(EventKind::ToolSelect { tool });
            self.load_tool(tool);
            self.event(EventKind::MCode {
                code: 6,
                p: None,
                q: None,
            });
        }
        Ok(())
    }

    /// G41 and G42 of a lathe: what is cut is the programmed contour, whatever the radius of the
    /// tool's nose.
    pub(crate) fn nose_compensation(&mut self, word: Word) {
        if self.warn_once("gcode::nose_radius") {
            let message = format!(
                "{}: the tool's nose radius is in the control; the path that is read is the programmed contour, which the nose then cuts",
                spelled(word.number)
            );
            self.output
                .warnings
                .push(*LineFault::new("gcode::nose_radius", word.at(), message));
        }
    }

    /// Non-modal codes that Fanuc and Haas have for themselves.
    pub(crate) fn own_non_modal(&mut self, block: &Block, word: Word) -> Read<()> {
        match word.number % OWN {
            500 if word.number >= LATHE_OWN => self.shift_by_g50(block),
            500 if block.has_axes() => {
                Err(LineFault::new("gcode::unsupported", word.at(), "G50 with axis words is not read")
                    .hint("G50 alone ends scaling; on a lathe (--dialect fanuc-lathe) G50 X Z names the position"))
            }
            700..=760 if word.number >= LATHE_OWN => self.repetitive_cycle(block, word),
            _ => Ok(()),
        }
    }

    /// G50 of a lathe: X and Z name the position, U and W shift what it is called; S was read
    /// before.
    fn shift_by_g50(&mut self, block: &Block) -> Read<()> {
        for (letter, step, axis) in [(b'x', b'u', 0), (b'z', b'w', 2)] {
            if let Some(value) = block.get(letter) {
                self.frame.g92[axis] += self.at[axis] - self.length(block, letter, axis, value)?;
            } else if let Some(value) = block.get(step) {
                self.frame.g92[axis] -= self.length(block, step, axis, value)?;
            }
        }
        self.offsets_changed();
        Ok(())
    }

    /// Motion codes that Fanuc and Haas have for themselves.
    pub(crate) fn own_motion(&mut self, block: &Block, code: u16) -> Read<()> {
        match (code % OWN, code >= LATHE_OWN) {
            (320, true) => self.lathe_thread(block),
            (900 | 920 | 940, true) => self.turning_cycle(block, code),
            _ => self.drilling_cycle(block, code),
        }
    }
}

/// More is a feed per minute or a slip; coarse threads stay below.
const LARGE_FEED_MM: f64 = 20.0;
