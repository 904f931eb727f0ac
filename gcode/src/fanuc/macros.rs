//! Macros of Fanuc (custom macro B): `IF [..] GOTO 10`, `IF [..] THEN ..`, `WHILE [..] DO1` ... `END1`, `GOTO 10`, and calls by `G65 P9010 A1. B2.`.
//!
//! A variable without a value is vacant: `#1 EQ #0` asks for it, a word with it is left out, and in sums it is 0. Inside it is NaN, which no value
//! is otherwise. Loops are those of O-words, under the label `do1`, so that what ends them and what bounds them is the same.

use std::ops::Range;

use super::super::block::Block;
use super::super::canon::EventKind;
use super::super::diagnostic::{Fault, Read, Short};
use super::super::expression::{Evaluator, Operator, Values};
use super::super::flow::Flow;
use super::super::lexer::Cursor;
use super::super::owords::{Head, Keyword};
use super::super::parameters::{MACRO_LOCALS, Parameters};
use super::super::state::Interpreter;
use super::super::subroutines::Manner;

/// What a line of a macro asks for.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Statement {
    /// A condition that does not hold: the next line.
    Nothing,
    Goto(u64),
    /// `WHILE [..] DO1`, `DO1`.
    While(Head, bool),
    End(Head),
    /// `IF [..] THEN`: what stands from here on in the line.
    Then(usize),
    /// `DPRNT[..]` and its relatives: text for another device.
    Print,
}

/// Largest number of a loop; controls have three.
const MOST_LOOPS: f64 = 3.0;

/// Share of two values up to which Fanuc's macros count them as equal: rounding of a few sums.
const SAME_WITHIN: f64 = 1e-12;
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

/// Variables that are vacant when a program begins.
const VACANT: [Range<usize>; 3] = [1..34, 100..200, 500..1000];

/// The line at the cursor as a statement, if it is one.
pub(crate) fn statement<V: Values>(cursor: Cursor<'_>, values: &V) -> Read<Option<Statement>> {
    let start = cursor.at;
    let mut evaluator = Evaluator::new(cursor, values);
    let printed: [&[u8]; 4] = [b"dprnt", b"bprnt", b"popen", b"pclos"];
    if printed.iter().any(|word| evaluator.cursor.eat_word(word)) {
        return Ok(Some(Statement::Print));
    }
    if evaluator.cursor.eat_word(b"if") {
        return condition(&mut evaluator, start).map(Some);
    }
    let statement = if evaluator.cursor.eat_word(b"while") {
        let is_true = is_true(&mut evaluator)?;
        if !evaluator.cursor.eat_word(b"do") {
            let at = start..evaluator.cursor.at + 1;
            return Err(
                Fault::new("gcode::macro", at, "DO is missing behind WHILE [..]").hint("write WHILE [#1 LT 5] DO1")
            );
        }
        Statement::While(loop_head(&mut evaluator, start)?, is_true)
    } else if evaluator.cursor.eat_word(b"goto") {
        Statement::Goto(label(&mut evaluator, start)?)
    } else if evaluator.cursor.eat_word(b"do") {
        Statement::While(loop_head(&mut evaluator, start)?, true)
    } else if evaluator.cursor.eat_word(b"end") {
        Statement::End(loop_head(&mut evaluator, start)?)
    } else {
        return Ok(None);
    };
    super::super::owords::read_rest(&mut evaluator.cursor)?;
    Ok(Some(statement))
}

/// Whether a line that is passed over ends the loop with the label `do1`.
pub(crate) fn ends_loop(line: &[u8], label: &[u8]) -> Option<Head> {
    let number = label.strip_prefix(b"do")?;
    let mut cursor = Cursor::new(line);
    cursor.eat(b'/');
    if cursor.eat(b'n') {
        cursor.number().ok()?;
    }
    let start = cursor.at;
    let ends = cursor.eat_word(b"end") && cursor.eat_word(number) && !cursor.peek().is_ascii_digit();
    ends.then(|| Head { label: label.to_vec(), keyword: Keyword::EndWhile, at: start..cursor.at })
}

fn condition<V: Values>(evaluator: &mut Evaluator<'_, V>, start: usize) -> Read<Statement> {
    let is_true = is_true(evaluator)?;
    if evaluator.cursor.eat_word(b"goto") {
        let number = label(evaluator, start)?;
        super::super::owords::read_rest(&mut evaluator.cursor)?;
        return Ok(if is_true { Statement::Goto(number) } else { Statement::Nothing });
    }
    if evaluator.cursor.eat_word(b"then") {
        return Ok(if is_true { Statement::Then(evaluator.cursor.at) } else { Statement::Nothing });
    }
    let at = start..evaluator.cursor.at + 1;
    Err(Fault::new("gcode::macro", at, "neither GOTO nor THEN stands behind IF [..]")
        .hint("write IF [#1 GT 5] GOTO 10, or IF [#1 GT 5] THEN #2=0"))
}

fn is_true<V: Values>(evaluator: &mut Evaluator<'_, V>) -> Read<bool> {
    let value = evaluator.bracketed()?;
    Ok(!value.is_nan() && value != 0.0)
}

/// Number of a block.
fn label<V: Values>(evaluator: &mut Evaluator<'_, V>, start: usize) -> Read<u64> {
    let number = evaluator.value()?;
    let at = start..evaluator.cursor.at;
    if (1.0..1e9).contains(&number.round()) {
        return Ok(number.round() as u64);
    }
    let shown = if number.is_nan() { "a variable without a value".to_owned() } else { format!("{}", Short(number)) };
    Err(Fault::new("gcode::macro", at, format!("GOTO {shown}: that is no number of a block"))
        .hint("GOTO 10 goes on at the line that begins with N10"))
}

fn loop_head<V: Values>(evaluator: &mut Evaluator<'_, V>, start: usize) -> Read<Head> {
    let number = evaluator.cursor.number()?;
    let at = start..evaluator.cursor.at;
    if !(1.0..=MOST_LOOPS).contains(&number) || number.fract() != 0.0 {
        let message = format!("a loop DO{} does not exist: DO1 to DO3 do", Short(number));
        return Err(Fault::new("gcode::macro", at, message).hint("loops inside each other have different numbers"));
    }
    Ok(Head { label: format!("do{number}").into_bytes(), keyword: Keyword::While, at })
}

impl Flow {
    /// Carries a statement out; returns where the rest of the line is a block of its own.
    pub(crate) fn carry_out_statement(
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
                self.end_round(&Head { keyword: Keyword::EndWhile, ..head })?;
            }
            Statement::Print => {
                let range = at.clone();
                interpreter.event(EventKind::Message { text: self.text_of_line(range) });
            }
        }
        Ok(None)
    }

    /// Goes on at the block with a number.
    pub(crate) fn go_to_block(&mut self, number: u64, by: &str, at: &Range<usize>) -> Read<()> {
        let Some(mark) = self.find_block(number, at)? else {
            let message = format!("{by}{number}: there is no block N{number} in this program");
            return Err(Fault::new("gcode::macro", at.clone(), message)
                .hint("the line to go on at begins with N and that number"));
        };
        self.jump_to(mark, at)
    }

    /// `G65 P9010 L2 A1. B2.`.
    pub(crate) fn call_macro(&mut self, block: &Block, interpreter: &mut Interpreter) -> Read<()> {
        let at = block.at(b'p');
        let Some(number) = block.get(b'p').filter(|number| (1.0..1e9).contains(number)) else {
            return Err(Fault::new(
                "gcode::macro",
                block.whole(),
                "G65 calls a macro, but P with its number is missing",
            )
            .hint("write G65 P9010 A1. to call O9010 with #1 = 1"));
        };
        let times = if block.has(b'l') { interpreter.integer(block, b'l', 0, 9999)? } else { 1 };
        let mut arguments = [f64::NAN; MACRO_LOCALS];
        for (letter, variable) in ARGUMENTS {
            if let Some(value) = block.get(letter) {
                arguments[variable - 1] = value;
            }
        }
        if let Some(word) = block.m.first() {
            arguments[12] = f64::from(word.number);
        }
        self.call_with(number.round() as u64, times as u32, &at, interpreter, Some(Box::new(arguments)))
    }

    /// `M97 P100`: blocks of the same program as a subroutine.
    pub(crate) fn call_block(&mut self, block: &Block, at: &Range<usize>, interpreter: &mut Interpreter) -> Read<()> {
        let Some(number) = block.get(b'p').filter(|number| (1.0..1e9).contains(number)) else {
            return Err(Fault::new("gcode::m98", at.clone(), "M97 calls a block, but P with its number is missing")
                .hint("write M97 P100 to call the lines from N100 to M99"));
        };
        let times = if block.has(b'l') { interpreter.integer(block, b'l', 0, i64::from(u32::MAX))? } else { 1 };
        let number = number.round() as u64;
        let Some(mark) = self.find_block(number, at)? else {
            let message = format!("M97 P{number}: there is no block N{number} in this program");
            return Err(Fault::new("gcode::m98", at.clone(), message)
                .hint("the lines to call begin with N and that number and end with M99"));
        };
        if times == 0 {
            return Ok(());
        }
        let label = format!("N{number}").into_bytes();
        self.enter_lines(label, Manner::Fanuc, (self.current, mark), times as u32, at, interpreter)
    }
}

/// A variable of Fanuc without a value counts as 0 in sums.
pub(crate) const fn without_vacancy(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value }
}

impl Operator {
    /// As Fanuc's macros have it: a vacant variable equals only another, AND, OR and XOR join the bits of integers, and values are equal or not.
    pub(crate) fn apply_to_variables(self, left: f64, right: f64) -> Result<f64, String> {
        let truth = |value: bool| Ok(f64::from(u8::from(value)));
        let is_same =
            (left.is_nan() && right.is_nan()) || (left - right).abs() <= SAME_WITHIN * left.abs().max(right.abs());
        let [left, right] = [left, right].map(without_vacancy);
        let bits = |join: fn(i64, i64) -> i64| Ok(join(left.round() as i64, right.round() as i64) as f64);
        match self {
            Self::Equal => truth(is_same),
            Self::Unequal => truth(!is_same),
            Self::And => bits(|left, right| left & right),
            Self::Or => bits(|left, right| left | right),
            Self::Xor => bits(|left, right| left ^ right),
            _ => self.apply(left, right),
        }
    }
}

impl Parameters {
    /// Variables of macros begin without a value.
    pub(crate) fn empty_variables(&mut self) {
        for index in VACANT.into_iter().flatten() {
            self.set(index, f64::NAN);
        }
    }
}

impl Interpreter {
    /// Why a variable of the control cannot be read.
    pub(crate) fn refuses_variable(&self, index: usize) -> Option<String> {
        let is_known = matches!(index, 0..=33 | 100..=999 | 4001 | 4003 | 4006 | 4014 | 4109 | 4119 | 4120
            | 5001..=5003 | 5021..=5023 | 5041..=5043 | 5061..=5070 | 5201..=5400);
        (!is_known).then(|| format!("the variable #{index} is one of the control, whose value is not known here"))
    }

    /// Variables of the control: modes, positions.
    pub(crate) fn own_variable(&self, index: usize) -> Option<f64> {
        Some(match index {
            0 => f64::NAN,
            4001 => f64::from(self.modal.motion % super::OWN) / 10.0,
            4003 => {
                if self.modal.incremental {
                    91.0
                } else {
                    90.0
                }
            }
            4006 => {
                if self.modal.unit_mm == 1.0 {
                    21.0
                } else {
                    20.0
                }
            }
            4014 => 53.0 + self.frame.system as f64,
            4109 => self.modal.feed / self.modal.feed_unit_mm,
            4119 => self.modal.spindle_speed,
            4120 => f64::from(self.tool),
            5001..=5003 => self.shown_position(index - 5001),
            5041..=5043 => self.shown_position(index - 5041),
            5021..=5023 => {
                let factor = if index == 5021 && self.modal.diameter { 2.0 } else { 1.0 };
                factor * self.here[index - 5021] / self.modal.unit_mm
            }
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Numbers;

    impl Values for Numbers {
        fn numbered(&self, index: usize) -> f64 {
            if index == 0 { f64::NAN } else { index as f64 }
        }

        fn named(&self, _name: &[u8]) -> Option<f64> {
            None
        }

        fn is_fanuc(&self) -> bool {
            true
        }
    }

    fn read(text: &str) -> Option<Statement> {
        statement(Cursor::new(text.as_bytes()), &Numbers).unwrap()
    }

    #[test]
    fn statements_are_told_from_blocks() {
        assert_eq!(read("IF [#5 GT 4] GOTO 10"), Some(Statement::Goto(10)));
        assert_eq!(read("IF[#1EQ#0]GOTO10"), Some(Statement::Nothing));
        assert_eq!(read("GOTO#7 (on)"), Some(Statement::Goto(7)));
        assert!(matches!(read("WHILE [#1 LE 1] DO2"), Some(Statement::While(head, true)) if head.label == b"do2"));
        assert!(matches!(read("END 3"), Some(Statement::End(head)) if head.label == b"do3"));
        assert_eq!(read("IF [1 EQ 1] THEN #1=5"), Some(Statement::Then(16)));
        for block in ["G0 X5", "#1=5", "I5 F100", "D1", "", "E5"] {
            assert_eq!(read(block), None, "{block}");
        }
        assert!(ends_loop(b"N5 END1 (done)", b"do1").is_some());
        assert!(ends_loop(b"END12", b"do1").is_none());
    }
}
