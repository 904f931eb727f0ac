//! O-words: the lines that steer the flow of a program, read into labels, keywords and arguments.

use crate::state::parameters::LOCALS;
use crate::text::block::read_comment;
use crate::text::diagnostic::{LineFault, Read, Short};
use crate::text::expression::{Evaluator, INTEGER_WITHIN, ParameterSource};
use crate::text::lexer::{Cursor, END};

/// Keyword of an O-word.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Keyword {
    Sub,
    EndSub,
    Call,
    Return,
    If,
    ElseIf,
    Else,
    EndIf,
    While,
    EndWhile,
    Do,
    Repeat,
    EndRepeat,
    Break,
    Continue,
    /// `O1234` alone: a program or a subroutine as Fanuc has them.
    Number,
}

/// Spellings; a word stands before its own beginning.
const KEYWORDS: [(&[u8], Keyword); 15] = [
    (b"sub", Keyword::Sub),
    (b"endsub", Keyword::EndSub),
    (b"call", Keyword::Call),
    (b"return", Keyword::Return),
    (b"if", Keyword::If),
    (b"elseif", Keyword::ElseIf),
    (b"else", Keyword::Else),
    (b"endif", Keyword::EndIf),
    (b"while", Keyword::While),
    (b"endwhile", Keyword::EndWhile),
    (b"do", Keyword::Do),
    (b"repeat", Keyword::Repeat),
    (b"endrepeat", Keyword::EndRepeat),
    (b"break", Keyword::Break),
    (b"continue", Keyword::Continue),
];

impl Keyword {
    /// Returns the keyword as it is written.
    pub(super) fn spelled(self) -> String {
        let row = KEYWORDS.iter().find(|row| row.1 == self);
        row.map_or_else(String::new, |row| {
            String::from_utf8_lossy(row.0).into_owned()
        })
    }
}

/// An O-word without its arguments.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Head {
    /// Digits or a name, lower case without blanks.
    pub(super) label: Vec<u8>,
    pub(super) keyword: Keyword,
    /// Byte range of the O-word in its line.
    pub(super) at: std::ops::Range<usize>,
}

impl Head {
    /// The label as a message shows it.
    pub(super) fn shown(&self) -> String {
        shown(&self.label)
    }
}

/// A label as a message shows it.
pub(super) fn shown(label: &[u8]) -> String {
    let text = String::from_utf8_lossy(label);
    if label.iter().all(u8::is_ascii_digit) {
        format!("O{text}")
    } else {
        format!("O<{text}>")
    }
}

/// Arguments of an O-word.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arguments {
    pub(super) values: [f64; LOCALS],
    pub(super) count: usize,
}

/// Reads the O-word under the cursor up to its arguments.
pub(super) fn read_head<V: ParameterSource>(evaluator: &mut Evaluator<'_, V>) -> Read<Head> {
    let start = evaluator.cursor.at;
    let label = read_label(evaluator)?;
    let keyword = read_keyword(&mut evaluator.cursor, &label, start)?;
    Ok(Head {
        label,
        keyword,
        at: start..evaluator.cursor.at,
    })
}

/// Reads O and the label behind it.
pub(super) fn read_label<V: ParameterSource>(evaluator: &mut Evaluator<'_, V>) -> Read<Vec<u8>> {
    let start = evaluator.cursor.at;
    evaluator.cursor.bump();
    Ok(if evaluator.cursor.eat(b'<') {
        evaluator.name(start)?
    } else {
        let value = evaluator.value()?;
        let rounded = value.round();
        if (value - rounded).abs() > INTEGER_WITHIN || !(0.0..1e15).contains(&rounded) {
            let message = format!("the label O{} is not a whole number", Short(value));
            return Err(LineFault::new(
                "gcode::o_word",
                start..evaluator.cursor.at,
                message,
            ));
        }
        format!("{}", rounded as u64).into_bytes()
    })
}

/// Reads the keyword behind the label of an O-word that begins at `start`.
pub(super) fn read_keyword(cursor: &mut Cursor<'_>, label: &[u8], start: usize) -> Read<Keyword> {
    if matches!(cursor.peek(), END | b'(' | b';' | b'%') {
        return Ok(Keyword::Number);
    }
    // The longest spelling that fits: `else` also begins `elseif`, `sub` ends `endsub`.
    let found = KEYWORDS
        .iter()
        .filter(|row| cursor.clone().eat_word(row.0))
        .max_by_key(|row| row.0.len());
    let Some((spelling, keyword)) = found else {
        let at = start..cursor.at + 1;
        return Err(LineFault::new("gcode::o_word", at, format!("{} is followed by no keyword", shown(label)))
            .hint("sub, endsub, call, return, if, elseif, else, endif, while, endwhile, do, repeat, endrepeat, break or continue"));
    };
    cursor.eat_word(spelling);
    Ok(*keyword)
}

/// Reads bracketed arguments up to the end of the line or a comment.
pub(super) fn read_arguments<V: ParameterSource>(
    evaluator: &mut Evaluator<'_, V>,
    head: &Head,
) -> Read<Arguments> {
    let mut arguments = Arguments {
        values: [0.0; LOCALS],
        count: 0,
    };
    loop {
        match evaluator.cursor.peek() {
            b'[' => {}
            b'(' => {
                read_comment(&mut evaluator.cursor)?;
                continue;
            }
            _ => break,
        }
        if arguments.count == LOCALS {
            let at = evaluator.cursor.at;
            return Err(LineFault::new(
                "gcode::o_word",
                at..at + 1,
                format!("more than {LOCALS} arguments"),
            ));
        }
        arguments.values[arguments.count] = evaluator.bracketed()?;
        arguments.count += 1;
    }
    let most = match head.keyword {
        Keyword::Call => LOCALS,
        Keyword::If
        | Keyword::ElseIf
        | Keyword::While
        | Keyword::Repeat
        | Keyword::Return
        | Keyword::EndSub => 1,
        _ => 0,
    };
    let needs_one = matches!(
        head.keyword,
        Keyword::If | Keyword::ElseIf | Keyword::While | Keyword::Repeat
    );
    if arguments.count > most || (needs_one && arguments.count == 0) {
        let wanted = if needs_one {
            "exactly one argument in brackets"
        } else if most == 1 {
            "at most one argument"
        } else {
            "no arguments"
        };
        return Err(LineFault::new(
            "gcode::o_word",
            head.at.clone(),
            format!("{} takes {wanted}", head.keyword.spelled()),
        ));
    }
    Ok(arguments)
}

/// Reads the rest of the line behind the O-word. Fails if it holds anything but comments.
pub(super) fn read_rest(cursor: &mut Cursor<'_>) -> Read<()> {
    loop {
        let start = cursor.at;
        match cursor.peek() {
            END | b';' => return Ok(()),
            b'(' => {
                read_comment(cursor)?;
            }
            _ => {
                return Err(LineFault::new(
                    "gcode::o_word",
                    start..start + 1,
                    "nothing but a comment may follow an O-word on its line",
                ));
            }
        }
    }
}

/// Returns true if the line is an O-word. Moves the cursor past the line number.
pub(super) fn at_o_word(cursor: &mut Cursor<'_>) -> bool {
    if cursor.peek() == b'/' {
        cursor.bump();
    }
    if cursor.eat(b'n') && cursor.number().is_err() {
        return false;
    }
    matches!(cursor.peek(), b'o' | b':')
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Nothing;

    impl ParameterSource for Nothing {
        fn numbered(&self, index: usize) -> f64 {
            index as f64
        }

        fn named(&self, _name: &[u8]) -> Option<f64> {
            None
        }
    }

    fn head(text: &str) -> (String, Keyword) {
        let head = read_head(&mut Evaluator::new(Cursor::new(text.as_bytes()), &Nothing)).unwrap();
        (head.shown(), head.keyword)
    }

    #[test]
    fn labels_and_keywords() {
        assert_eq!(head("o100 sub"), ("O100".into(), Keyword::Sub));
        assert_eq!(
            head("O < My Sub > CALL [1]"),
            ("O<mysub>".into(), Keyword::Call)
        );
        assert_eq!(
            head("o#[100+1] else if [1]"),
            ("O101".into(), Keyword::ElseIf)
        );
        assert_eq!(head("o1else(note)"), ("O1".into(), Keyword::Else));
        assert_eq!(head("O0002 (PART)"), ("O2".into(), Keyword::Number));
        assert_eq!(head("o1do"), ("O1".into(), Keyword::Do));
    }
}
