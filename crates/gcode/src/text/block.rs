//! One line of a program as words with values, before it is carried out.

pub(crate) mod corner;

use std::ops::Range;

use crate::text::block::corner::CornerWord;
use crate::text::characters::not_ascii;
use crate::text::codes::fanuc::{CodeSet, LATHE_OWN, OWN, SYSTEM_A};
use crate::text::codes::{self, AXES, GROUPS, Group, bit, letter, slot};
use crate::text::diagnostic::{LineFault, Read, Short};
use crate::text::expression::{Evaluator, INTEGER_WITHIN, ParameterSource, Target};
use crate::text::foreign;
use crate::text::lexer::{Cursor, END, NO_EXPONENT, shown};

/// Letters, `@`, `^` and `$`.
const LETTERS: usize = 29;
/// Distance from a tenth at which a G-code still is that tenth: expressions such as `G[54+0.1]` do
/// not come out exactly.
const TENTH_WITHIN: f64 = 1e-3;

/// A G- or M-code on the line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Word {
    /// Ten times the G-code, or the M-code.
    pub(crate) number: u16,
    start: u32,
    end: u32,
}

impl Word {
    pub(crate) fn at(&self) -> Range<usize> {
        self.start as usize..self.end as usize
    }
}

/// The words of a line. Used again for every line, so that reading a line allocates nothing.
#[derive(Debug, Clone)]
pub(crate) struct Block {
    /// Bit set of the letters that the line has; G, M, N and O do not count.
    pub(crate) set: u32,
    value: [f64; LETTERS],
    place: [(u32, u32); LETTERS],
    /// G-codes in written order.
    pub(crate) g: Vec<Word>,
    group: [Option<Word>; GROUPS],
    /// M-codes in written order.
    pub(crate) m: Vec<Word>,
    /// Assignments in written order; they take effect after the line.
    pub(crate) assignments: Vec<(Target, f64)>,
    /// Text of the last comment, without its brackets.
    pub(crate) comment: Option<Range<usize>>,
    /// True where a letter may stand without a value if it only names an axis.
    bare_words: bool,
    /// True where decimal points are recorded; `pointed` has the letters whose numbers have one.
    points: bool,
    pub(crate) pointed: u32,
    /// The letters whose values are computed.
    pub(crate) computed: u32,
    codes: CodeSet,
    /// True where a word E follows a number without a blank, as an exponent does.
    pub(crate) exponent: bool,
    /// `,R` or `,C` of Fanuc.
    pub(crate) corner: Option<CornerWord>,
    /// End of the line's text outside comments.
    pub(super) end: usize,
}

/// Ways to read a line that depend on the dialect.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Style {
    /// Printers: `*` begins a checksum, and some letters stand alone.
    pub(crate) printer: bool,
    /// Fanuc and its relatives: a decimal point makes milliseconds seconds.
    pub(crate) points: bool,
    pub(crate) codes: CodeSet,
}

impl Block {
    pub(crate) fn new() -> Self {
        Self {
            set: 0,
            value: [0.0; LETTERS],
            place: [(0, 0); LETTERS],
            g: Vec::new(),
            group: [None; GROUPS],
            m: Vec::new(),
            assignments: Vec::new(),
            comment: None,
            bare_words: false,
            points: false,
            pointed: 0,
            computed: 0,
            codes: CodeSet::Rs274,
            exponent: false,
            corner: None,
            end: 0,
        }
    }

    /// Forgets the last line.
    #[inline]
    pub(crate) fn clear(&mut self) {
        self.set = 0;
        self.pointed = 0;
        self.computed = 0;
        self.exponent = false;
        self.corner = None;
        if !self.g.is_empty() {
            self.g.clear();
            self.group = [None; GROUPS];
        }
        self.m.clear();
        self.assignments.clear();
        self.comment = None;
    }

    /// Value of a letter (lower case) if the line has it.
    #[inline]
    pub(crate) fn get(&self, letter: u8) -> Option<f64> {
        (self.set & bit(letter) != 0).then(|| self.value[slot(letter)])
    }

    /// Gives the line a word in place of those that it has of the letter, in the same place where
    /// there is one.
    pub(crate) const fn put(&mut self, letter: u8, value: f64) {
        self.set |= bit(letter);
        self.value[slot(letter)] = value;
    }

    /// Takes a word away.
    pub(crate) const fn remove(&mut self, letter: u8) {
        self.set &= !bit(letter);
    }

    /// Returns true if the line has the letter.
    #[inline]
    pub(crate) const fn has(&self, letter: u8) -> bool {
        self.set & bit(letter) != 0
    }

    /// Returns true if the number of a letter is written with a decimal point. It is known only
    /// with [`Style::points`].
    pub(crate) const fn has_point(&self, letter: u8) -> bool {
        self.pointed & bit(letter) != 0
    }

    /// Returns the byte range of the word of a letter.
    pub(crate) fn at(&self, letter: u8) -> Range<usize> {
        let (start, end) = self.place[slot(letter)];
        start as usize..end as usize
    }

    /// Returns the byte range of the first word of a set of letters.
    pub(crate) fn at_any(&self, letters: u32) -> Range<usize> {
        let first = (0..LETTERS)
            .filter(|slot| self.set & letters & (1 << slot) != 0)
            .min_by_key(|&slot| self.place[slot].0);
        first.map_or(self.whole(), |slot| {
            self.place[slot].0 as usize..self.place[slot].1 as usize
        })
    }

    /// All words of the line.
    pub(crate) const fn whole(&self) -> Range<usize> {
        0..self.end
    }

    /// Returns true if the line has a word of an axis.
    #[inline]
    pub(crate) const fn has_axes(&self) -> bool {
        self.set & AXES != 0
    }

    /// The G-code of a group.
    #[inline]
    pub(crate) const fn code(&self, group: Group) -> Option<Word> {
        self.group[group as usize]
    }

    /// Returns true if the line has G10, or a code that activates a coordinate system or a tool
    /// length.
    pub(crate) fn names_offsets(&self) -> bool {
        let writes = self
            .code(Group::NonModal)
            .is_some_and(|word| word.number % OWN == 100);
        writes || self.code(Group::Coordinates).is_some() || self.code(Group::ToolLength).is_some()
    }

    /// Reads the words from the cursor to the end of the line.
    pub(crate) fn read<V: ParameterSource>(
        &mut self,
        cursor: Cursor<'_>,
        values: &V,
        style: Style,
    ) -> Read<()> {
        let mut evaluator = Evaluator::new(cursor, values);
        self.end = evaluator.cursor.at;
        self.bare_words = style.printer;
        self.points = style.points;
        self.codes = style.codes;
        loop {
            let byte = evaluator.cursor.peek();
            let start = evaluator.cursor.at;
            match byte {
                END => return Ok(()),
                b'g' => self.read_g(&mut evaluator, start)?,
                b'm' => self.read_m(&mut evaluator, start)?,
                b'n' | b'o' => return Err(misplaced(byte, start)),
                b'a'..=b'z' | b'@' | b'^' => self.read_word(&mut evaluator, byte, start)?,
                b'(' => self.comment = Some(read_comment(&mut evaluator.cursor)?),
                b';' => {
                    self.comment = Some(start + 1..evaluator.cursor.bytes.len());
                    evaluator.cursor.finish();
                    return Ok(());
                }
                b'$' if evaluator.cursor.is_spindle() => {
                    self.read_word(&mut evaluator, byte, start)?;
                }
                b'#' => self.read_assignment(&mut evaluator, start)?,
                b',' if style.codes != CodeSet::Rs274 => self.read_corner(&mut evaluator, start)?,
                b'*' if style.printer => return Ok(()),
                _ => return Err(strange(evaluator.cursor.bytes, start)),
            }
            if byte != b'(' {
                self.end = evaluator.cursor.at;
            }
        }
    }

    /// Printers write `G28 X Y` and `M84 E`: a letter that only names an axis.
    #[inline]
    fn names_axes(&self) -> bool {
        !self.m.is_empty() || self.g.iter().any(|word| word.number == 280)
    }

    #[cold]
    fn is_bare(cursor: &mut Cursor<'_>) -> bool {
        matches!(cursor.peek(), b'a'..=b'z' | b';' | b'*' | END)
    }

    #[inline]
    fn read_word<V: ParameterSource>(
        &mut self,
        evaluator: &mut Evaluator<'_, V>,
        byte: u8,
        start: usize,
    ) -> Read<()> {
        self.exponent |= byte == b'e' && evaluator.cursor.is_exponent();
        evaluator.cursor.bump();
        let value = if self.bare_words && self.names_axes() && Self::is_bare(&mut evaluator.cursor)
        {
            0.0
        } else {
            evaluator.value()?
        };
        let slot = slot(byte);
        let place = (start as u32, evaluator.cursor.at as u32);
        if value.is_nan() {
            return Ok(()); // A variable without a value: Fanuc leaves the word out.
        }
        if self.set & (1 << slot) != 0 {
            let message = format!("the line already has a word {}", letter(slot));
            let hint = if byte == b'e' && self.exponent {
                NO_EXPONENT
            } else {
                "split the line in two"
            };
            return Err(
                LineFault::new("gcode::repeated", start..evaluator.cursor.at, message).hint(hint),
            );
        }
        self.set |= 1 << slot;
        self.value[slot] = value;
        self.place[slot] = place;
        if self.points {
            let written = &evaluator.cursor.bytes[start..evaluator.cursor.at];
            self.pointed |= u32::from(written.contains(&b'.')) << slot;
            self.computed |= u32::from(written.contains(&b'#') || written.contains(&b'[')) << slot;
        }
        Ok(())
    }

    #[inline]
    fn read_g<V: ParameterSource>(
        &mut self,
        evaluator: &mut Evaluator<'_, V>,
        start: usize,
    ) -> Read<()> {
        evaluator.cursor.bump();
        let value = evaluator.value()?;
        let end = evaluator.cursor.at;
        // A cast is much faster than rounding, and below 0 nothing is a code.
        let tenths = (value * 10.0 + 0.5) as u32 as f64;
        let is_tenth =
            (value * 10.0 - tenths).abs() < TENTH_WITHIN && (0.0..10_000.0).contains(&tenths);
        let Some(code) = is_tenth.then(|| self.codes.find(tenths as u16)).flatten() else {
            return Err(unknown_g(value, evaluator.cursor.bytes, start..end));
        };
        let word = Word {
            number: code.number,
            start: start as u32,
            end: end as u32,
        };
        if let Some(other) = self.group[code.group as usize].replace(word) {
            if (code.number == 800) != (other.number == 800) {
                // `G80 G0 X5`: the motion ends the cycle by itself.
                self.group[code.group as usize] =
                    Some(if code.number == 800 { other } else { word });
                self.g.push(word);
                return Ok(());
            }
            let message = format!(
                "{} and {} exclude each other on one line",
                codes::spelled(other.number),
                codes::spelled(code.number)
            );
            let is_mode = [other.number, code.number]
                .iter()
                .any(|&number| number >= LATHE_OWN);
            let hint = if is_mode {
                SYSTEM_A
            } else {
                "write them on two lines"
            };
            return Err(LineFault::new("gcode::modal_group", start..end, message).hint(hint));
        }
        self.g.push(word);
        Ok(())
    }

    fn read_m<V: ParameterSource>(
        &mut self,
        evaluator: &mut Evaluator<'_, V>,
        start: usize,
    ) -> Read<()> {
        evaluator.cursor.bump();
        let value = evaluator.value()?;
        let end = evaluator.cursor.at;
        let number = value.round();
        if (value - number).abs() > INTEGER_WITHIN || !(0.0..=9999.0).contains(&number) {
            return Err(LineFault::new(
                "gcode::m_code",
                start..end,
                format!(
                    "M{} is no M-code: the number must be an integer from 0 to 9999",
                    Short(value)
                ),
            ));
        }
        self.m.push(Word {
            number: number as u16,
            start: start as u32,
            end: end as u32,
        });
        Ok(())
    }

    fn read_assignment<V: ParameterSource>(
        &mut self,
        evaluator: &mut Evaluator<'_, V>,
        start: usize,
    ) -> Read<()> {
        let target = evaluator.target()?;
        if !evaluator.cursor.eat(b'=') {
            let at = evaluator.cursor.at;
            return Err(LineFault::new(
                "gcode::assignment",
                start..at,
                "a parameter here must be assigned to: `=` is missing",
            ));
        }
        let value = if evaluator.is_fanuc() {
            evaluator.joined()?
        } else {
            evaluator.value()?
        };
        self.assignments.push((target, value));
        Ok(())
    }
}

/// Words of all lines of a program, read and not carried out: what the benches compare the reader
/// with. Parameters are 0, and lines that are no words (O-words, `%`, mistakes) count nothing.
#[doc(hidden)]
pub fn count_words(text: &[u8]) -> usize {
    struct Zeros;
    impl ParameterSource for Zeros {
        fn numbered(&self, _index: usize) -> f64 {
            0.0
        }
        fn named(&self, _name: &[u8]) -> Option<f64> {
            Some(0.0)
        }
    }
    let mut block = Block::new();
    let words_of = |line: &[u8]| {
        let mut cursor = Cursor::new(line);
        if cursor.eat(b'n') && cursor.number().is_err() {
            return 0;
        }
        block.clear();
        let read = block.read(cursor, &Zeros, Style::default());
        if read.is_ok() {
            block.set.count_ones() as usize + block.g.len() + block.m.len()
        } else {
            0
        }
    };
    text.split(|&byte| byte == b'\n').map(words_of).sum()
}

/// Reads `( text )`; returns the place of the text.
pub(crate) fn read_comment(cursor: &mut Cursor<'_>) -> Read<Range<usize>> {
    let start = cursor.at;
    let inside = &cursor.bytes[start + 1..];
    match memchr::memchr2(b'(', b')', inside) {
        Some(length) if inside[length] == b')' => {
            cursor.at = start + length + 2;
            Ok(start + 1..start + 1 + length)
        }
        Some(length) => {
            let at = start + 1 + length;
            Err(LineFault::new(
                "gcode::comment",
                at..at + 1,
                "a comment begins inside a comment",
            )
            .hint("close the first comment with `)` before the second `(`"))
        }
        None => Err(LineFault::new(
            "gcode::comment",
            start..cursor.bytes.len(),
            "the comment is not closed: `)` is missing",
        )
        .hint("close it on the same line, or begin it with `;`")),
    }
}

#[cold]
fn misplaced(byte: u8, start: usize) -> Box<LineFault> {
    let what = if byte == b'n' {
        "the line number N"
    } else {
        "an O-word"
    };
    let fault = LineFault::new(
        "gcode::misplaced",
        start..start + 1,
        format!("{what} must stand at the beginning of the line"),
    );
    if byte == b'o' {
        fault.hint("the letter O is no zero: write 0 in numbers")
    } else {
        fault
    }
}

#[cold]
fn unknown_g(value: f64, bytes: &[u8], at: Range<usize>) -> Box<LineFault> {
    let tenths = (value * 10.0).round();
    let spelled = if (value * 10.0 - tenths).abs() < TENTH_WITHIN {
        format!("G{}", Short(tenths / 10.0))
    } else {
        format!("G{}", Short(value))
    };
    // `G1 10`: digits, a blank, digits.
    let has_gap = bytes[at.clone()]
        .windows(3)
        .any(|w| w[0].is_ascii_digit() && w[1] == b' ' && w[2].is_ascii_digit());
    if let Some((what, hint)) = foreign::what(tenths).filter(|_| !has_gap) {
        return LineFault::new(
            "gcode::unsupported",
            at,
            format!("{spelled} ({what}, on other controls) is not read"),
        )
        .hint(hint);
    }
    // Read with the codes of Fanuc or Haas.
    if !has_gap
        && (0.0..1000.0).contains(&tenths)
        && codes::find(tenths as u16).is_some_and(|row| f64::from(row.number) == tenths)
    {
        let message = format!(
            "{spelled} is a G-code of LinuxCNC, and none of Fanuc and Haas that this reader knows"
        );
        return LineFault::new("gcode::unknown_g", at, message)
            .hint("--dialect linuxcnc reads a program for LinuxCNC");
    }
    let fault = LineFault::new(
        "gcode::unknown_g",
        at,
        format!("{spelled} is not a G-code that this reader knows"),
    );
    if has_gap {
        fault.hint("blanks inside numbers mean nothing: is a letter missing behind the blank?")
    } else {
        fault.hint(format!("the nearest known: {}", codes::nearest(value)))
    }
}

/// A byte that has no meaning here.
#[cold]
fn strange(bytes: &[u8], start: usize) -> Box<LineFault> {
    let byte = bytes[start];
    if byte.is_ascii() {
        let next = bytes[start + 1..]
            .trim_ascii_start()
            .first()
            .map(u8::to_ascii_uppercase);
        if let (b',', Some(next @ (b'R' | b'C' | b'A'))) = (byte, next) {
            let what = match next {
                b'R' => "rounds the corner at the end of the line",
                b'C' => "cuts a chamfer at the end of the line",
                _ => "gives the angle of the line",
            };
            let message = format!(
                "`,{}` {what} on other controls and is not read",
                char::from(next)
            );
            return LineFault::new("gcode::unsupported", start..start + 1, message)
                .hint("write the corner as a motion of its own, with its end point");
        }
        let fault = LineFault::new(
            "gcode::character",
            start..start + 1,
            format!("`{}` has no meaning here", shown(byte)),
        );
        return match byte {
            b'/' => fault.hint("a `/` that deletes the line stands first on it"),
            b')' => fault.hint("the comment that ends here has no `(`"),
            b'=' => fault.hint("only a parameter is assigned to: #1=5; words have no `=`"),
            b'+' | b'-' | b'*' if start > 0 => {
                fault.hint("a calculation stands in brackets: #1=[5+3], X[2*#1]")
            }
            b'[' => fault.hint("a bracket stands behind a letter or a function"),
            b',' => fault.hint("a decimal point is a point: write 1.5, not 1,5"),
            b']' => fault.hint("the bracket that ends here has no `[`"),
            b'0'..=b'9' if bytes[..start].trim_ascii() == b"/" => {
                fault.hint("levels of `/` are Fanuc's; LinuxCNC has one, without a number")
            }
            0 => fault.hint("the file holds bytes that are no text"),
            _ => fault,
        };
    }
    not_ascii(bytes, start)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::text::expression::NoParameters;

    fn read(text: &str) -> Read<Block> {
        let mut block = Block::new();
        block
            .read(
                Cursor::new(text.as_bytes()),
                &NoParameters,
                Style::default(),
            )
            .map(|()| block)
    }

    #[test]
    fn words_may_stand_in_any_order_and_spacing() {
        let block = read("g 1 x1.5(note)Y-[1+1] f 1 0 0 ; rest").unwrap();
        assert_eq!(
            (
                block.get(b'x'),
                block.get(b'y'),
                block.get(b'f'),
                block.get(b'z')
            ),
            (Some(1.5), Some(-2.0), Some(100.0), None)
        );
        assert_eq!(block.code(Group::Motion).unwrap().number, 10);
        assert_eq!(block.comment, Some(31..36));
        assert_eq!(block.at(b'x'), 4..8);
    }

    #[test]
    fn words_are_counted_without_being_carried_out() {
        assert_eq!(
            count_words(b"N10 G1 X1 Y[2*#3] F100 (a)\nM3 S100\nX$\n\n%"),
            6
        );
    }

    #[test]
    fn faults_have_their_place() {
        let fault = |text: &str| read(text).map(|_| ()).unwrap_err();
        assert_eq!(fault("G1 X1 X2").at, 6..8);
        assert_eq!(fault("G0 G1").at, 3..5);
        assert_eq!(fault("G1.7 X2").at, 0..4);
        assert_eq!(fault("G1.7 X2").hint.unwrap(), "the nearest known: G2");
        assert_eq!(fault("X1 (open").at, 3..8);
        assert_eq!(
            fault("X1 é").message,
            "`é` has no meaning outside a comment"
        );
        assert_eq!(fault("X1 $").at, 3..4);
        assert!(fault("X").message.contains("end of the line"));
        assert!(
            fault("X1 Qb")
                .message
                .contains("neither a number nor a function")
        );
    }
}
