//! The blocks N(P) to N(Q) that G70 to G73 refer to.
//!
//! For G71 to G73 they are read once without being cut: their motions are kept, their other words mean nothing. Then the tool is back where the
//! cycle began, the cycle cuts, and the program goes on behind block Q. G70 cuts the blocks as they are, goes back to where it began, and the
//! program goes on behind G70.

use super::super::block::Block;
use super::super::canon::{Canon, Motion, Plane, Shape};
use super::super::codes::spelled;
use super::super::diagnostic::{Fault, Read};
use super::super::flow::{Flow, cannot_read};
use super::super::lexer::{Cursor, END};
use super::super::source::{Line, Mark};
use super::super::state::{Interpreter, Modal, Position};
use super::super::travel::Speed;
use super::PLANE_WORDS;

/// Motions of a profile: they are kept in memory, and a drawing has far fewer.
const MOST_MOTIONS: usize = 100_000;

/// What a cycle does with its profile, mm.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Work {
    /// G70.
    Finish,
    /// G71, G72: passes of a depth; the allowance along X (radius) and Z moves the profile.
    Rough { is_facing: bool, depth_mm: f64, escape_mm: f64, allowance_mm: [f64; 2] },
    /// G73: the profile itself, moved.
    Pattern { shift_mm: [f64; 2], passes: u32, allowance_mm: [f64; 2] },
}

/// A cycle that asks for its profile.
#[derive(Debug)]
pub(crate) struct Wanted {
    /// First and last block.
    pub(super) numbers: [u64; 2],
    pub(super) work: Work,
    pub(super) code: u16,
    pub(super) block: Block,
    pub(super) line: u32,
    /// Where it began, machine coordinates, and its modes.
    pub(super) start: Position,
    pub(super) modal: Modal,
}

/// The profile under way.
#[derive(Debug)]
pub(crate) struct Capture {
    pub(super) wanted: Wanted,
    pub(super) motions: Vec<Motion>,
    /// Words of the first block: X and Z both let the profile have pockets.
    pub(super) first_words: u32,
    /// Line of the cycle, and where the program goes on, if not behind the profile.
    mark: Mark,
    back: Option<Mark>,
    /// What does not belong in a profile, by its line.
    fault: Option<(u32, &'static str)>,
}

impl Capture {
    pub(crate) const fn keeps(&self) -> bool {
        !matches!(self.wanted.work, Work::Finish)
    }

    /// Number of the last block.
    pub(crate) const fn last(&self) -> u64 {
        self.wanted.numbers[1]
    }

    /// Takes a motion; what else the blocks say belongs to G70.
    pub(super) fn keep(&mut self, step: Canon) {
        let Canon::Motion(motion) = step else { return };
        let line = motion.line;
        let fault = match &motion {
            _ if self.motions.len() >= MOST_MOTIONS => Some("the profile has more than 100000 motions"),
            Motion { others, .. } if !others.is_none() => Some("it moves other axes than X and Z"),
            Motion { start_mm, end_mm, .. } if start_mm[1] != end_mm[1] => {
                Some("it moves Y; only X and Z form a profile")
            }
            Motion { shape: Shape::Line | Shape::Arc { plane: Plane::Zx, turns: 1 | -1, .. }, .. } => None,
            _ => Some("a profile has straight lines and arcs of up to one turn in G18"),
        };
        match fault {
            Some(fault) if self.fault.is_none() => self.fault = Some((line, fault)),
            Some(_) => {}
            None => self.motions.push(motion),
        }
    }

    /// Refuses the profile; `line` is that of the block that does not fit.
    pub(super) fn refuse(&self, line: u32, message: &str) -> Box<Fault> {
        let place = if line == self.wanted.line { String::new() } else { format!("line {line}: ") };
        let message = format!("the profile of {} cannot be cut: {place}{message}", spelled(self.wanted.code));
        Fault::new("gcode::lathe", self.wanted.block.at(b'p'), message)
    }
}

impl Flow {
    /// Goes to the first block of the profile that a cycle wants.
    pub(crate) fn begin_own_profile(&mut self, wanted: Wanted, interpreter: &mut Interpreter) -> Read<()> {
        let [first, last] = wanted.numbers;
        let at = wanted.block.at(b'p');
        let missing = |letter: char, number: u64| {
            let message = format!("{letter}{number}: there is no block N{number} in this program");
            Fault::new("gcode::lathe", wanted.block.at(letter.to_ascii_lowercase() as u8), message)
                .hint("P and Q are the numbers N of the first and the last block of the profile")
        };
        let (mark, here) = (self.source_ref().line_start, self.source_ref().here());
        let found = self.find_blocks(first, &at)?;
        if let (Some(before), Some(behind)) = (found.before, found.behind) {
            let [one, other] = [before, behind].map(|mark| mark.lines_before + 1);
            let message = format!(
                "P{first} is on line {one} and on line {other}: which of them is meant differs between controls"
            );
            return Err(
                Fault::new("gcode::lathe", at, message).hint("give the blocks of every profile numbers of their own")
            );
        }
        let begin = found.behind.or(found.before).ok_or_else(|| missing('P', first))?;
        self.jump_to(begin, &at)?;
        let end = self.find_block(last, &at);
        self.jump_to(here, &at)?;
        let end = end?.ok_or_else(|| missing('Q', last))?;
        if end.offset < begin.offset {
            let message = format!(
                "Q{last} (line {}) stands before P{first} (line {})",
                end.lines_before + 1,
                begin.lines_before + 1
            );
            return Err(Fault::new("gcode::lathe", wanted.block.at(b'q'), message));
        }
        let is_finish = matches!(wanted.work, Work::Finish);
        let is_behind = begin.offset >= here.offset;
        if is_behind && !is_finish && self.next_code_line(&at)? != Some(begin.lines_before) {
            let message = format!(
                "there are blocks between {} and its profile, which begins with N{first}",
                spelled(wanted.code)
            );
            return Err(Fault::new("gcode::lathe", at, message).hint("the profile stands right behind its first cycle"));
        }
        self.jump_to(begin, &at)?;
        let back = (is_finish || !is_behind).then_some(here);
        interpreter.fanuc.capture =
            Some(Box::new(Capture { wanted, motions: Vec::new(), first_words: 0, mark, back, fault: None }));
        Ok(())
    }

    /// The last block of the profile has been read: carries the cycle out. Faults are those of the cycle's line.
    pub(crate) fn end_own_profile(&mut self, capture: &Capture, interpreter: &mut Interpreter) -> Read<()> {
        if let Some(back) = capture.back {
            self.jump_to(back, &capture.wanted.block.at(b'p'))?;
        }
        self.source().line_start = capture.mark;
        interpreter.cut_own_profile(capture)
    }

    /// Number of the line before the next one that is neither blank nor a comment; stays where it is.
    fn next_code_line(&mut self, at: &std::ops::Range<usize>) -> Read<Option<u32>> {
        let (here, line_start) = (self.source_ref().here(), self.source_ref().line_start);
        let found = loop {
            let range = match self.source().next_line().map_err(|error| cannot_read(at.clone(), &error))? {
                Line::End => break None,
                Line::TooLong(range) | Line::Text(range) => range,
            };
            let mut cursor = Cursor::new(self.source_ref().bytes(range));
            if !matches!(cursor.peek(), END | b'(' | b';') {
                break Some(self.source_ref().line - 1);
            }
        };
        self.jump_to(here, at)?;
        self.source().line_start = line_start;
        Ok(found)
    }
}

impl Interpreter {
    /// Remembers what the first block of a profile has, and refuses what no profile can have.
    pub(super) fn check_profile_block(&mut self, block: &Block) -> Read<()> {
        let Some(capture) = &mut self.fanuc.capture else { return Ok(()) };
        if capture.motions.is_empty() {
            capture.first_words |= block.set & PLANE_WORDS;
        }
        let Some(word) = block.m.iter().find(|word| matches!(word.number, 2 | 30 | 97 | 98 | 99)) else {
            return Ok(());
        };
        let message = format!("M{} stands inside the profile of {}", word.number, spelled(capture.wanted.code));
        Err(Fault::new("gcode::lathe", word.at(), message).hint("a profile has G0 to G3 alone, up to its block Q"))
    }

    /// Carries out a cycle whose profile has been read.
    fn cut_own_profile(&mut self, capture: &Capture) -> Read<()> {
        let wanted = &capture.wanted;
        self.line = wanted.line;
        if matches!(wanted.work, Work::Finish) {
            return self.go(&wanted.block, self.frame.to_program(&wanted.start), Speed::Rapid);
        }
        // Reading the profile has moved the reader, and not the tool.
        self.modal = wanted.modal.clone();
        self.here = wanted.start;
        self.at = self.frame.to_program(&self.here);
        if let Some((line, message)) = capture.fault {
            return Err(capture.refuse(line, message));
        }
        if capture.motions.len() < 2 {
            return Err(capture
                .refuse(wanted.line, "it has no motion behind the one that leads to it")
                .hint("the first block leads from the start of the cycle to the profile, the others are the profile"));
        }
        let cut = match wanted.work {
            Work::Pattern { shift_mm, passes, allowance_mm } => {
                self.cut_pattern(capture, shift_mm, passes, allowance_mm)
            }
            _ => self.rough_own_profile(capture),
        };
        self.at = self.frame.to_program(&self.here);
        cut
    }
}
