//! Carries out one block: first its modes, in the order that RS-274 fixes, then its motion, then
//! its stop.
//!
//! Order: NISTIR 6556, table 8: feed mode, F, S, T, tool change, spindle, coolant, overrides,
//! dwell, plane, units, compensation, tool length, coordinate system, path control, distance modes,
//! return level, offsets, motion, stop.

use crate::canon::EventKind;
use crate::dialects::fanuc;
use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::state::modal::FeedMode;
use crate::text::block::Block;
use crate::text::codes::fanuc::{LATHE_OWN, OWN};
use crate::text::codes::{self, Group, spelled};
use crate::text::diagnostic::{LineFault, Read};

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
        let taken = block
            .code(Group::NonModal)
            .is_some_and(|word| USES_AXES.contains(&word.number))
            || block
                .code(Group::ToolLength)
                .is_some_and(|word| matches!(word.number, 431 | 432))
            || (self.dialect.is_fanuc() && fanuc::uses_axes(block));
        let is_center = matches!(self.modal.motion, 20 | 30)
            && block.set & codes::ARC_CENTER != 0
            && block.code(Group::NonModal).is_none();
        let is_g53 = block
            .code(Group::NonModal)
            .is_some_and(|word| word.number == 530);
        if is_g53 && self.dialect.is_fanuc() && block.has_axes() {
            return Some(0); // It moves by itself.
        }
        (!taken
            && (block.has_axes()
                || is_center
                || (self.dialect == Dialect::Printer && block.has(b'e'))))
        .then_some(self.modal.motion)
    }

    fn motion(&mut self, block: &Block) -> Read<()> {
        let motion = self.active_motion(block);
        self.check_words(block, motion)?;
        let Some(code) = motion else { return Ok(()) };
        if let Some(word) = block.code(Group::Motion) {
            // `G80 G28 Z0`: G28 takes the axis words. Fanuc: in `G0 G28 Z0` too, and G0 is only
            // remembered.
            let taken = block
                .code(Group::NonModal)
                .is_some_and(|other| USES_AXES.contains(&other.number))
                || (self.dialect.is_fanuc() && fanuc::uses_axes(block));
            if taken && (code == 800 || self.dialect.is_fanuc()) {
                self.modal.motion = code;
                return Ok(());
            }
            if let Some(other) = block
                .code(Group::NonModal)
                .filter(|other| USES_AXES.contains(&other.number) && block.has_axes())
            {
                let message = format!(
                    "{} and {} would both use the axis words",
                    spelled(word.number),
                    spelled(other.number)
                );
                return Err(LineFault::new("gcode::modal_group", other.at(), message)
                    .hint("write them on two lines"));
            }
            self.modal.motion = code;
        }
        if block
            .code(Group::NonModal)
            .is_some_and(|word| word.number == 530)
            && !matches!(code, 0 | 10)
        {
            return Err(LineFault::new(
                "gcode::g53",
                block.whole(),
                format!("G53 goes with G0 or G1, not with {}", spelled(code)),
            ));
        }
        if !matches!(code % OWN, 730 | 740 | 810..=890) {
            self.end_cycles();
        }
        if code < LATHE_OWN && self.dialect.is_lathe() {
            self.end_turning();
        }
        if self.carried.collected.is_some() && !matches!(code, 52 | 53 | 62) {
            self.check_no_curve(block)?;
        }
        if code != 50 {
            self.carried.bezier_end = None;
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
                0 | 1 | 60 => self.event(EventKind::MCode {
                    code: word.number,
                    p: None,
                    q: None,
                }),
                2 | 30 => {
                    self.event(EventKind::MCode {
                        code: word.number,
                        p: None,
                        q: None,
                    });
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

    /// Carries out a motion code other than G0-G3 and G80.
    fn special_motion(&mut self, block: &Block, code: u16) -> Read<()> {
        if self.compensates() && !matches!(code, 50..=53) {
            let message = format!("{} cannot run with cutter compensation", spelled(code));
            return Err(
                LineFault::new("gcode::compensation", block.whole(), message)
                    .hint("end it with G40 first"),
            );
        }
        match code {
            50 | 51 => self.bezier(block, code),
            52 => self.nurbs_point(block),
            53 => self.nurbs_end(block),
            62 => self.nurbs_with_knots(block),
            OWN.. => self.own_motion(block, code),
            330 | 331 => self.synchronized(block, code),
            382..=385 => self.probe(block),
            730 | 740 | 810..=890 => self.cycle(block, code),
            760 => self.thread(block),
            _ => self.lathe_cycle(block, code),
        }
    }

    /// A line was refused: takes the mode and the position that it was meant to leave, so that what
    /// follows is judged by itself.
    #[cold]
    pub(super) fn assume(&mut self, block: &Block) {
        self.behind_fault |= block.has_axes() || !block.g.is_empty();
        if let Some(word) = block.code(Group::Motion).filter(|word| word.number <= 30) {
            self.modal.motion = word.number;
        }
        let moves = matches!(self.modal.motion, 0..=30) && block.has_axes() && !self.compensates();
        if let Some(target) = self
            .target(block)
            .ok()
            .filter(|_| moves && self.lathe.is_none())
        {
            self.at = target;
            self.here = self.frame.to_machine(&target);
        }
    }
}
