//! M-codes: those with a meaning to the interpreter change its state, all become events in program
//! order.

use crate::canon::EventKind;
use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::state::parameters::INPUT;
use crate::text::block::{Block, Word};
use crate::text::codes::bit;
use crate::text::diagnostic::{LineFault, Read};

/// M-codes of one group exclude each other on a line.
const GROUPS: [&[u16]; 8] = [
    &[0, 1, 2, 30, 60],
    &[6, 61],
    &[3, 4, 5],
    &[3, 4, 19],
    &[7, 9],
    &[8, 9],
    &[48, 49],
    &[70, 71, 72, 73],
];

/// LinuxCNC drops what stands behind M98 and refuses what stands before it or behind M99; Fanuc
/// carries the line out, then jumps.
fn check_jump(block: &Block, jump: &Word) -> Read<()> {
    let begin = match jump.number {
        98 => 0,
        99 => jump.at().end,
        _ => return Ok(()),
    };
    let own = if jump.number == 98 {
        bit(b'p') | bit(b'l')
    } else {
        bit(b'p')
    };
    let codes = block.g.iter().chain(&block.m).map(Word::at);
    let letters = (b'a'..=b'z').filter(|letter| block.has(*letter) && own & bit(*letter) == 0);
    let mut places = codes.chain(letters.map(|letter| block.at(letter)));
    let Some(at) = places.find(|at| at.start >= begin && *at != jump.at()) else {
        return Ok(());
    };
    let message = format!("LinuxCNC reads no other words beside M{}", jump.number);
    Err(LineFault::new("gcode::m98", at, message).hint("write them on a line of their own"))
}

impl Interpreter {
    /// Letters that an M-code takes.
    pub(super) fn m_letters(&self, number: u16) -> u32 {
        if self.dialect == Dialect::Printer {
            return u32::MAX; // Every firmware has words of its own.
        }
        match number {
            3..=5 => bit(b'$'),
            19 => bit(b'r') | bit(b'q') | bit(b'p') | bit(b'$'),
            51 => bit(b'p') | bit(b'$'),
            50..=53 | 62..=65 => bit(b'p'),
            61 => bit(b'q'),
            66 => bit(b'p') | bit(b'e') | bit(b'l') | bit(b'q'),
            67 | 68 => bit(b'e') | bit(b'q'),
            97 if self.dialect.is_fanuc() => bit(b'p') | bit(b'l'),
            98 => bit(b'p') | bit(b'l'),
            99 => bit(b'p'),
            100..=199 => bit(b'p') | bit(b'q'),
            _ if self.dialect.is_fanuc() => bit(b'p') | bit(b'q') | bit(b'r'),
            _ => 0,
        }
    }

    /// Carries out the M-codes except stops, in RS-274's order: tool, spindle, coolant, overrides,
    /// the rest.
    pub(super) fn machine_codes(&mut self, block: &Block) -> Read<()> {
        if block.m.is_empty() {
            return Ok(());
        }
        self.check_machine_codes(block)?;
        for wanted in 0..4 {
            for word in &block.m {
                if order(word.number) == wanted {
                    self.machine_code(block, word.number)?;
                }
            }
        }
        Ok(())
    }

    fn check_machine_codes(&self, block: &Block) -> Read<()> {
        for (n, word) in block.m.iter().enumerate() {
            let clash = block.m[..n].iter().find(|other| {
                other.number == word.number
                    || GROUPS
                        .iter()
                        .any(|group| group.contains(&other.number) && group.contains(&word.number))
            });
            if let Some(other) = clash {
                let message = format!(
                    "M{} and M{} exclude each other on one line",
                    other.number, word.number
                );
                return Err(LineFault::new("gcode::modal_group", word.at(), message)
                    .hint("write them on two lines"));
            }
            if self.dialect.is_fanuc()
                && let Some((what, hint)) = jump(word.number)
            {
                let message = format!("M{} {what}, which is not read", word.number);
                return Err(LineFault::new("gcode::unsupported", word.at(), message).hint(hint));
            }
            if self.dialect == Dialect::LinuxCnc {
                check_jump(block, word)?;
            }
            let known = matches!(word.number, 0..=9 | 19 | 30 | 48..=53 | 60..=68 | 70..=73 | 98 | 99 | 100..=199);
            if !known && self.dialect == Dialect::LinuxCnc {
                return Err(LineFault::new(
                    "gcode::unknown_m",
                    word.at(),
                    format!("M{} is not an M-code that LinuxCNC knows", word.number),
                )
                .hint("user M-codes go from M100 to M199; another control's program needs another --dialect"));
            }
        }
        Ok(())
    }

    /// Words that an M-code cannot do without.
    fn check_words_of(&self, block: &Block, number: u16) -> Read<()> {
        if self.dialect != Dialect::LinuxCnc {
            return Ok(());
        }
        let needed: &[u8] = match number {
            61 => b"q",
            62..=65 => b"p",
            67 | 68 => b"eq",
            _ => b"",
        };
        for &letter in needed {
            if !block.has(letter) {
                let name = char::from(letter).to_ascii_uppercase();
                return Err(LineFault::new(
                    "gcode::m_code",
                    block.whole(),
                    format!("M{number} needs its word {name}"),
                ));
            }
        }
        if number != 66 {
            return Ok(());
        }
        if block.has(b'p') == block.has(b'e') {
            return Err(LineFault::new(
                "gcode::m_code",
                block.whole(),
                "M66 waits for a digital input P or an analog input E: exactly one of them",
            ));
        }
        let mode = if block.has(b'l') {
            self.integer(block, b'l', 0, 4)?
        } else {
            0
        };
        if mode != 0 && block.get(b'q').unwrap_or(0.0) <= 0.0 {
            return Err(LineFault::new(
                "gcode::m_code",
                block.whole(),
                format!("M66 L{mode} waits and needs a time limit Q above 0 s"),
            ));
        }
        if mode != 0 && block.has(b'e') {
            return Err(LineFault::new(
                "gcode::m_code",
                block.at(b'e'),
                "M66 reads an analog input at once: only L0 goes with E",
            ));
        }
        Ok(())
    }

    fn machine_code(&mut self, block: &Block, number: u16) -> Read<()> {
        self.check_words_of(block, number)?;
        let modal = &mut self.modal;
        match number {
            97 if self.dialect.is_fanuc() => return Ok(()),
            0 | 1 | 2 | 30 | 60 | 98 | 99 => return Ok(()), // Stops come last, calls are flow.
            3 => modal.spindle_turns = 1,
            4 => modal.spindle_turns = -1,
            // M19 orients the spindle, which stands still then.
            5 | 19 => modal.spindle_turns = 0,
            7 => modal.mist = true,
            8 => modal.flood = true,
            9 => (modal.mist, modal.flood) = (false, false),
            48 => (modal.feed_override, modal.speed_override) = (true, true),
            49 => (modal.feed_override, modal.speed_override) = (false, false),
            50 => modal.feed_override = block.get(b'p') != Some(0.0),
            51 => modal.speed_override = block.get(b'p') != Some(0.0),
            52 => modal.adaptive_feed = block.get(b'p') != Some(0.0),
            53 => modal.feed_hold = block.get(b'p') != Some(0.0),
            6 => self.load_tool(self.tool.next),
            61 => {
                let tool = self.integer(block, b'q', 0, 999_999)?;
                self.load_tool(tool as u32);
            }
            // No input is connected: it reads as low, as on a machine at rest.
            66 => self.parameters.set(INPUT, 0.0),
            70 => self.save_modes(false),
            71 => self.forget_modes(),
            72 => self.restore_modes(block)?,
            73 => self.save_modes(true),
            82 if self.dialect == Dialect::Printer => self.extruder.is_relative = false,
            83 if self.dialect == Dialect::Printer => self.extruder.is_relative = true,
            _ => {}
        }
        self.event(EventKind::MCode {
            code: number,
            p: block.get(b'p'),
            q: block.get(b'q'),
        });
        Ok(())
    }
}

/// M-codes of Fanuc and Haas that go on at another line: what they do, and what helps.
const fn jump(number: u16) -> Option<(&'static str, &'static str)> {
    const AS_SUBROUTINE: &str =
        "put the lines behind M30, O1000 before and M99 behind them, and call them by M98 P1000";
    match number {
        96 => Some((
            "jumps where an input is off",
            "write the lines that the machine will carry out",
        )),
        198 => Some(("calls a program on another device", AS_SUBROUTINE)),
        _ => None,
    }
}

/// Returns the rank of an M-code among those of its line: lower ranks act first.
pub(super) const fn order(number: u16) -> u8 {
    match number {
        6 | 61 => 0,
        3..=5 | 19 => 1,
        7..=9 => 2,
        _ => 3,
    }
}
