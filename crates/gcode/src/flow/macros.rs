//! Macros of Fanuc: jumps, loops, and calls by `G65 P9010 A1. B2.`.
//!
//! Loops are those of O-words, under the label `do1`, so that what ends them and what bounds them
//! is the same.

use std::ops::Range;

use crate::canon::EventKind;
use crate::flow::owords::{Head, Keyword};
use crate::flow::program::{Flow, SubroutineKind};
use crate::flow::statements::Statement;
use crate::state::Interpreter;
use crate::state::parameters::MACRO_LOCALS;
use crate::text::block::Block;
use crate::text::diagnostic::{LineFault, Read};

/// Letters of the arguments of G65 and the variables that they become, `#1` to `#26`.
const ARGUMENTS: [(u8, usize); 21] = [
    (b'a', 1),
    (b'b', 2),
    (b'c', 3),
    (b'i', 4),
    (b'j', 5),
    (b'k', 6),
    (b'd', 7),
    (b'e', 8),
    (b'f', 9),
    (b'h', 11),
    (b'm', 13),
    (b'q', 17),
    (b'r', 18),
    (b's', 19),
    (b't', 20),
    (b'u', 21),
    (b'v', 22),
    (b'w', 23),
    (b'x', 24),
    (b'y', 25),
    (b'z', 26),
];

impl Flow {
    /// Carries a statement out; returns where the rest of the line is a block of its own.
    pub(super) fn carry_out_statement(
        &mut self,
        statement: Statement,
        at: &Range<usize>,
        interpreter: &mut Interpreter,
    ) -> Read<Option<usize>> {
        match statement {
            Statement::Nothing => {}
            Statement::Then(rest) => return Ok(Some(rest)),
            Statement::Goto(number) => self.go_to_block(number, "GOTO ", at)?,
            Statement::While(head, true) => self.begin_loop(&head, 0)?,
            Statement::While(head, false) => {
                let line = self.source_ref().line;
                self.pass_loop(&head, line);
            }
            Statement::End(head) => {
                self.end_round(&Head {
                    keyword: Keyword::EndWhile,
                    ..head
                })?;
            }
            Statement::Print => {
                let range = at.clone();
                interpreter.event(EventKind::Message {
                    text: self.text_of_line(range),
                });
            }
        }
        Ok(None)
    }

    /// Goes on at the block with a number.
    pub(super) fn go_to_block(&mut self, number: u64, by: &str, at: &Range<usize>) -> Read<()> {
        let Some(mark) = self.find_block(number, at)? else {
            let message = format!("{by}{number}: there is no block N{number} in this program");
            return Err(LineFault::new("gcode::macro", at.clone(), message)
                .hint("the line to go on at begins with N and that number"));
        };
        self.jump_to(mark, at)
    }

    /// `G65 P9010 L2 A1. B2.`.
    pub(super) fn call_macro(&mut self, block: &Block, interpreter: &mut Interpreter) -> Read<()> {
        let at = block.at(b'p');
        let Some(number) = block.get(b'p').filter(|number| (1.0..1e9).contains(number)) else {
            return Err(LineFault::new(
                "gcode::macro",
                block.whole(),
                "G65 calls a macro, but P with its number is missing",
            )
            .hint("write G65 P9010 A1. to call O9010 with #1 = 1"));
        };
        let times = if block.has(b'l') {
            interpreter.integer(block, b'l', 0, 9999)?
        } else {
            1
        };
        let mut arguments = [f64::NAN; MACRO_LOCALS];
        for (letter, variable) in ARGUMENTS {
            if let Some(value) = block.get(letter) {
                arguments[variable - 1] = value;
            }
        }
        if let Some(word) = block.m.first() {
            arguments[12] = f64::from(word.number);
        }
        self.call_with(
            number.round() as u64,
            times as u32,
            &at,
            interpreter,
            Some(Box::new(arguments)),
        )
    }

    /// `M97 P100`: blocks of the same program as a subroutine.
    pub(super) fn call_block(
        &mut self,
        block: &Block,
        at: &Range<usize>,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        let Some(number) = block.get(b'p').filter(|number| (1.0..1e9).contains(number)) else {
            return Err(LineFault::new(
                "gcode::m98",
                at.clone(),
                "M97 calls a block, but P with its number is missing",
            )
            .hint("write M97 P100 to call the lines from N100 to M99"));
        };
        let times = if block.has(b'l') {
            interpreter.integer(block, b'l', 0, i64::from(u32::MAX))?
        } else {
            1
        };
        let number = number.round() as u64;
        let Some(mark) = self.find_block(number, at)? else {
            let message = format!("M97 P{number}: there is no block N{number} in this program");
            return Err(LineFault::new("gcode::m98", at.clone(), message)
                .hint("the lines to call begin with N and that number and end with M99"));
        };
        if times == 0 {
            return Ok(());
        }
        let label = format!("N{number}").into_bytes();
        self.enter_lines(
            label,
            SubroutineKind::Fanuc,
            (self.current, mark),
            times as u32,
            at,
            interpreter,
        )
    }

    /// A line of the source under way as text.
    fn text_of_line(&self, range: Range<usize>) -> String {
        String::from_utf8_lossy(self.source_ref().bytes(range).trim_ascii()).into_owned()
    }
}
