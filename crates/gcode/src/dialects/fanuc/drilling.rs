//! Drilling cycles G73 to G89 as far as words differ: repeats by K, no P, pecks that grow smaller,
//! taps that start the spindle, and lathes.
//!
//! A lathe drills along Z, and goes back to where it began. R is how far the hole begins from there
//! on Fanuc, and a coordinate on Haas.

use crate::canon::Plane;
use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::state::carried_over::Pecks;
use crate::text::block::Block;
use crate::text::codes::fanuc::{LATHE_OWN, OWN};
use crate::text::diagnostic::{LineFault, Read, Short};

impl Interpreter {
    pub(super) fn drilling_cycle(&mut self, block: &Block, code: u16) -> Read<()> {
        let base = code % OWN;
        let mut block = block.clone();
        self.fanuc.pecks = if base == 830 {
            self.smaller_pecks(&mut block)?
        } else {
            None
        };
        if block.has(b'k') {
            let repeats = block.get(b'k').unwrap_or(1.0);
            block.remove(b'k');
            block.put(b'l', repeats);
        }
        if matches!(base, 820 | 860 | 880 | 890)
            && !block.has(b'p')
            && self.carried.cycle.code() != base
        {
            block.put(b'p', 0.0);
        }
        if matches!(base, 740 | 840) {
            // The control starts the spindle as the tap needs it (M29, and on Haas without it).
            let wanted = if base == 840 { 1 } else { -1 };
            if self.modal.spindle_turns != wanted {
                self.spindle(wanted);
            }
        }
        if code < LATHE_OWN {
            return self.cycle(&block, base);
        }
        self.drill_on_lathe(&mut block, base)
    }

    fn drill_on_lathe(&mut self, block: &mut Block, base: u16) -> Read<()> {
        let unit = self.modal.unit_mm;
        let begin = self.at[2] / unit;
        // Without Q there are no pecks.
        let is_new = !matches!(self.carried.cycle.code(), 820 | 830) || base != 830;
        let base =
            if base == 830 && !block.has(b'q') && (is_new || self.carried.cycle.code() == 820) {
                820
            } else {
                base
            };
        if base == 820 && !block.has(b'p') && self.carried.cycle.code() != base {
            block.put(b'p', 0.0);
        }
        let is_first = self.carried.cycle.code() != base;
        if block.has(b'r') || is_first {
            let is_distance = self.dialect == Dialect::FanucLathe;
            let word = block.get(b'r');
            if word.is_some()
                && !matches!(
                    self.settings.dialect,
                    Some(Dialect::FanucLathe | Dialect::HaasLathe)
                )
            {
                self.warn_of_level(block, is_distance);
            }
            block.put(
                b'r',
                match word {
                    Some(level) if is_distance => begin + level,
                    Some(level) => level,
                    None => begin,
                },
            );
        }
        if let Some(step) = block.get(b'w') {
            let level = block.get(b'r').unwrap_or(begin);
            block.put(b'z', level + step);
            block.remove(b'w');
        }
        let plane = std::mem::replace(&mut self.modal.plane, Plane::Xy);
        let drilled = self.cycle(block, base);
        self.modal.plane = plane;
        drilled
    }

    fn warn_of_level(&mut self, block: &Block, is_distance: bool) {
        if self.warn_once("gcode::drilling_level") {
            let how = if is_distance {
                "a distance from where the tool is, as on Fanuc"
            } else {
                "a coordinate, as on Haas"
            };
            let message = format!("R of a drilling cycle is read as {how}");
            let warning = LineFault::new("gcode::drilling_level", block.at(b'r'), message);
            self.output
                .warnings
                .push(*warning.hint("--dialect fanuc-lathe or haas-lathe says which"));
        }
    }

    /// I, J and K of G83; K alone is the number of holes.
    fn smaller_pecks(&self, block: &mut Block) -> Read<Option<Pecks>> {
        if !block.has(b'i') {
            return Ok(None);
        }
        let word =
            |letter: u8| -> Read<f64> { Ok(self.not_negative(block, letter)?.unwrap_or(0.0)) };
        let pecks = Pecks {
            first_mm: word(b'i')?,
            less_mm: word(b'j')?,
            least_mm: word(b'k')?,
        };
        if pecks.first_mm <= 0.0 || pecks.least_mm <= 0.0 {
            let message = format!(
                "the pecks of G83 with I and K must be above 0: I is {} mm, K {} mm",
                Short(pecks.first_mm),
                Short(pecks.least_mm)
            );
            return Err(LineFault::new("gcode::cycle", block.at(b'i'), message)
                .hint("I is the first peck, J how much smaller each is than the one before, K the smallest"));
        }
        let first = block.get(b'i').unwrap_or(0.0);
        block.put(b'q', first);
        for letter in [b'i', b'j', b'k'] {
            block.remove(letter);
        }
        Ok(Some(pecks))
    }
}
