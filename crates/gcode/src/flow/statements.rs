//! Statements of Fanuc's macros (custom macro B): `IF [..] GOTO 10`, `IF [..] THEN ..`, `WHILE [..]
//! DO1` ... `END1`, `GOTO 10`, read from a line.
//!
//! A variable without a value is vacant: `#1 EQ #0` asks for it, a word with it is left out, and in
//! sums it is 0. Inside it is NaN, which no value is otherwise.

use crate::flow::owords::{Head, Keyword, read_rest};
use crate::text::diagnostic::{LineFault, Read, Short};
use crate::text::expression::{Evaluator, ParameterSource};
use crate::text::lexer::Cursor;

/// Statement of a macro line.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Statement {
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
const MAX_LOOPS: f64 = 3.0;

/// The line at the cursor as a statement, if it is one.
pub(super) fn statement<V: ParameterSource>(
    cursor: Cursor<'_>,
    values: &V,
) -> Read<Option<Statement>> {
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
                LineFault::new("gcode::macro", at, "DO is missing behind WHILE [..]")
                    .hint("write WHILE [#1 LT 5] DO1"),
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
    read_rest(&mut evaluator.cursor)?;
    Ok(Some(statement))
}

/// Returns the end of the loop with the label `do1` if this skipped line is one.
pub(super) fn ends_loop(line: &[u8], label: &[u8]) -> Option<Head> {
    let number = label.strip_prefix(b"do")?;
    let mut cursor = Cursor::new(line);
    cursor.eat(b'/');
    if cursor.eat(b'n') {
        cursor.number().ok()?;
    }
    let start = cursor.at;
    let ends =
        cursor.eat_word(b"end") && cursor.eat_word(number) && !cursor.peek().is_ascii_digit();
    ends.then(|| Head {
        label: label.to_vec(),
        keyword: Keyword::EndWhile,
        at: start..cursor.at,
    })
}

fn condition<V: ParameterSource>(
    evaluator: &mut Evaluator<'_, V>,
    start: usize,
) -> Read<Statement> {
    let is_true = is_true(evaluator)?;
    if evaluator.cursor.eat_word(b"goto") {
        let number = label(evaluator, start)?;
        read_rest(&mut evaluator.cursor)?;
        return Ok(if is_true {
            Statement::Goto(number)
        } else {
            Statement::Nothing
        });
    }
    if evaluator.cursor.eat_word(b"then") {
        return Ok(if is_true {
            Statement::Then(evaluator.cursor.at)
        } else {
            Statement::Nothing
        });
    }
    let at = start..evaluator.cursor.at + 1;
    Err(LineFault::new(
        "gcode::macro",
        at,
        "neither GOTO nor THEN stands behind IF [..]",
    )
    .hint("write IF [#1 GT 5] GOTO 10, or IF [#1 GT 5] THEN #2=0"))
}

pub(super) fn is_true<V: ParameterSource>(evaluator: &mut Evaluator<'_, V>) -> Read<bool> {
    let value = evaluator.bracketed()?;
    Ok(!value.is_nan() && value != 0.0)
}

/// Number of a block.
pub(super) fn label<V: ParameterSource>(
    evaluator: &mut Evaluator<'_, V>,
    start: usize,
) -> Read<u64> {
    let number = evaluator.value()?;
    let at = start..evaluator.cursor.at;
    if (1.0..1e9).contains(&number.round()) {
        return Ok(number.round() as u64);
    }
    let shown = if number.is_nan() {
        "a variable without a value".to_owned()
    } else {
        format!("{}", Short(number))
    };
    Err(LineFault::new(
        "gcode::macro",
        at,
        format!("GOTO {shown}: that is no number of a block"),
    )
    .hint("GOTO 10 goes on at the line that begins with N10"))
}

fn loop_head<V: ParameterSource>(evaluator: &mut Evaluator<'_, V>, start: usize) -> Read<Head> {
    let number = evaluator.cursor.number()?;
    let at = start..evaluator.cursor.at;
    if !(1.0..=MAX_LOOPS).contains(&number) || number.fract() != 0.0 {
        let message = format!("a loop DO{} does not exist: DO1 to DO3 do", Short(number));
        return Err(LineFault::new("gcode::macro", at, message)
            .hint("loops inside each other have different numbers"));
    }
    Ok(Head {
        label: format!("do{number}").into_bytes(),
        keyword: Keyword::While,
        at,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Numbers;

    impl ParameterSource for Numbers {
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
    fn statements_are_distinguished_from_blocks() {
        assert_eq!(read("IF [#5 GT 4] GOTO 10"), Some(Statement::Goto(10)));
        assert_eq!(read("IF[#1EQ#0]GOTO10"), Some(Statement::Nothing));
        assert_eq!(read("GOTO#7 (on)"), Some(Statement::Goto(7)));
        assert!(
            matches!(read("WHILE [#1 LE 1] DO2"), Some(Statement::While(head, true)) if head.label == b"do2")
        );
        assert!(matches!(read("END 3"), Some(Statement::End(head)) if head.label == b"do3"));
        assert_eq!(read("IF [1 EQ 1] THEN #1=5"), Some(Statement::Then(16)));
        for block in ["G0 X5", "#1=5", "I5 F100", "D1", "", "E5"] {
            assert_eq!(read(block), None, "{block}");
        }
        assert!(ends_loop(b"N5 END1 (done)", b"do1").is_some());
        assert!(ends_loop(b"END12", b"do1").is_none());
    }
}
