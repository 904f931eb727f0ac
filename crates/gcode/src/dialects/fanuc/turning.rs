//! Cycles of one block: G90 turns along Z, G94 faces along X, G92 cuts a thread; each begins and
//! ends where the tool is. G32 is one thread.
//!
//! G90 and G92: rapid along X to the start of the cut, cut to X Z, back along X, rapid along Z.
//! G94: the same with X and Z exchanged. R (I, K of older controls and Haas) is the taper: how far
//! the start of the cut lies from its end, along X as a radius, along Z for G94. X, Z and R stay
//! for the blocks that follow.

use crate::canon::EventKind;
use crate::dialects::fanuc::words::PLANE_WORDS;
use crate::motion::feed::Speed;
use crate::state::Interpreter;
use crate::state::fanuc::TurningWords;
use crate::state::frame::Position;
use crate::text::block::Block;
use crate::text::codes::fanuc::OWN;
use crate::text::codes::spelled;
use crate::text::diagnostic::{LineFault, Read};

impl Interpreter {
    pub(super) fn turning_cycle(&mut self, block: &Block, code: u16) -> Read<()> {
        if block.set & PLANE_WORDS == 0 {
            return Ok(()); // G92 S, or the mode alone.
        }
        let end = self.turning_words(block, code)?;
        let taper_mm = self.fanuc.turning.taper_mm;
        let start = self.at;
        let name = code % OWN;
        // The axes of the infeed and of the cut.
        let [infeed, along] = if name == 940 { [2, 0] } else { [0, 2] };
        let mut begin = start;
        begin[infeed] = end[infeed] + taper_mm;
        let mut out = end;
        out[infeed] = start[infeed];
        if begin[along] == end[along] {
            let axis = ["X", "Y", "Z"][along];
            let message = format!(
                "{} cuts nothing: it ends at the {axis} where it begins",
                spelled(code)
            );
            return Err(LineFault::new("gcode::lathe", block.whole(), message)
                .hint("it begins where the tool is; as modes, G90 and G91 belong to other G-code systems than A"));
        }
        self.go(block, begin, Speed::Rapid)?;
        if name == 920 {
            self.check_thread(block, code)?;
            if self.warn_once("gcode::run_out") {
                let message = "how a thread of G92 runs out is a parameter of the control: it is read as a right angle at its end";
                self.output.warnings.push(*LineFault::new(
                    "gcode::run_out",
                    block.whole(),
                    message,
                ));
            }
            self.cut_thread(block, end)?;
            self.go(block, out, Speed::Rapid)?;
        } else {
            self.go(block, end, Speed::Programmed)?;
            self.go(block, out, Speed::Programmed)?;
        }
        self.go(block, start, Speed::Rapid)
    }

    /// Takes the words of a block to those that stay; returns where the cut ends.
    fn turning_words(&mut self, block: &Block, code: u16) -> Read<Position> {
        let mut kept = self.fanuc.turning;
        if kept.code != code {
            kept = TurningWords {
                code,
                ..TurningWords::default()
            };
        }
        for (axis, place, step) in [(0, b'x', b'u'), (2, b'z', b'w')] {
            if let Some(value) = block.get(place) {
                (kept.place_mm[axis], kept.step_mm[axis]) =
                    (Some(self.length(block, place, axis, value)?), None);
            } else if let Some(value) = block.get(step) {
                (kept.place_mm[axis], kept.step_mm[axis]) =
                    (None, Some(self.length(block, step, axis, value)?));
            }
        }
        for letter in [b'r', b'i', b'k'] {
            if let Some(value) = self.distance_word(block, letter)? {
                kept.taper_mm = value;
            }
        }
        self.fanuc.turning = kept;
        let mut end = self.at;
        for axis in [0, 2] {
            let step = kept.step_mm[axis].map(|step| self.at[axis] + step);
            match kept.place_mm[axis].or(step) {
                Some(place) => end[axis] = place,
                None => {
                    let name = ["X or U", "", "Z or W"][axis];
                    return Err(LineFault::new(
                        "gcode::lathe",
                        block.whole(),
                        format!("{name} is missing for {}", spelled(code)),
                    )
                    .hint(
                        "the first block of a cycle has both; the next ones need only what changes",
                    ));
                }
            }
        }
        Ok(end)
    }

    /// G32: a thread from here to X Z; F is its lead.
    pub(super) fn lathe_thread(&mut self, block: &Block) -> Read<()> {
        self.check_thread(block, OWN + 320)?;
        let target = self.target(block)?;
        self.cut_thread(block, target)
    }

    /// A thread needs a lead and a spindle that turns.
    pub(super) fn check_thread(&self, block: &Block, code: u16) -> Read<()> {
        self.check_spindle(block, code)?;
        if self.modal.feed <= 0.0 {
            let message = format!("F (lead of the thread) is missing for {}", spelled(code));
            return Err(LineFault::new("gcode::thread", block.whole(), message)
                .hint("write F1.5 for 1.5 mm per revolution"));
        }
        Ok(())
    }

    /// Cuts along with the spindle; the lead counts along the axis that moves farther.
    fn cut_thread(&mut self, block: &Block, target: Position) -> Read<()> {
        let way = [0, 2].map(|axis| (target[axis] - self.at[axis]).abs());
        let longer = way[0].max(way[1]);
        if longer == 0.0 {
            return Ok(());
        }
        let lead_mm = self.modal.feed * libm::hypot(way[0], way[1]) / longer;
        self.event(EventKind::SpindleSync {
            pitch_mm: Some(self.modal.feed),
        });
        self.paced(block, target, lead_mm)?;
        self.event(EventKind::SpindleSync { pitch_mm: None });
        Ok(())
    }
}
