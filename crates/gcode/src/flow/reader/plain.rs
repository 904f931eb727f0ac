//! The lines that long programs consist of, G0 or G1 with X, Y, Z, E and F as short decimals, read
//! straight into a motion.
//!
//! Such a line needs little of what [`Block`](crate::text::block::Block) and `execute` do for any
//! line. Where no other mode has a say it becomes the same motion, to the last bit, with the same
//! arithmetic in the same order; whatever is out of the ordinary in the line or in the modes leaves
//! everything as it was, and the line goes the long way.

use crate::canon::{AuxiliaryAxes, Motion, Shape};
use crate::flow::reader::{Percent, Reader};
use crate::motion::feed::{MINUTE_S, PRINTER_FEED_MM_S, Speed};
use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::state::modal::FeedMode;
use crate::text::lexer::{EXACT_POWERS, is_blank};
use crate::text::source::MAX_LINE_BYTES;

/// Digits that a short decimal has at most: 10^15 is below 2^53, so that the mantissa is exact.
const MAX_DIGITS: usize = 15;

/// Places of the words in [`PlainWords`].
const X: usize = 0;
const Y: usize = 1;
const Z: usize = 2;
const E: usize = 3;
const F: usize = 4;

/// The words of a line.
#[derive(Debug, Default, PartialEq)]
struct PlainWords {
    /// Ten times the G-code.
    code: Option<u16>,
    /// Bit set of the words that the line has.
    set: u32,
    value: [f64; 5],
    /// Bytes up to the line's end.
    length: usize,
}

impl Reader {
    /// Carries out the next line if it is a plain one that moves.
    #[inline]
    pub(super) fn plain_line(&mut self) -> Option<Motion> {
        let Self {
            flow, interpreter, ..
        } = self;
        if self.percent == Percent::NotSeen || flow.is_skipping() || !interpreter.is_plain() {
            return None;
        }
        let source = flow.source();
        let words = PlainWords::read(source.unread())?;
        let motion = interpreter.plain_motion(&words, source.line.saturating_add(1))?;
        source.pass_line(words.length);
        self.lines += 1;
        self.motions_seen = interpreter.output.motions;
        self.idle_lines = 1;
        Some(motion)
    }
}

impl PlainWords {
    /// Reads the line that `bytes` begin with; nothing where it is no plain one or does not end in
    /// them.
    #[inline]
    fn read(bytes: &[u8]) -> Option<Self> {
        let mut words = Self::default();
        let mut at = 0;
        loop {
            let byte = *bytes.get(at)?;
            at += 1;
            let place = match byte {
                b'X' | b'x' => X,
                b'Y' | b'y' => Y,
                b'Z' | b'z' => Z,
                b'E' | b'e' => E,
                b'F' | b'f' => F,
                b'G' | b'g' if words.code.is_none() => {
                    words.code = Some(straight_code(bytes, &mut at)?);
                    continue;
                }
                b'N' | b'n' if at == 1 => {
                    at += digits(&bytes[at..])?;
                    continue;
                }
                b'\n' => break,
                _ if is_blank(byte) => continue,
                _ => return None,
            };
            if words.set & (1 << place) != 0 {
                return None;
            }
            words.set |= 1 << place;
            words.value[place] = short_decimal(bytes, &mut at)?;
        }
        words.length = at - 1;
        (words.length <= MAX_LINE_BYTES).then_some(words)
    }

    #[inline]
    const fn has(&self, place: usize) -> bool {
        self.set & (1 << place) != 0
    }

    #[inline]
    pub(super) const fn names_axes(&self) -> bool {
        self.set & (1 << X | 1 << Y | 1 << Z) != 0
    }
}

/// Ten times the code of G0 or G1, behind the letter.
#[inline]
fn straight_code(bytes: &[u8], at: &mut usize) -> Option<u16> {
    *at += usize::from(matches!(bytes.get(*at..*at + 2)?, [b'0', b'0' | b'1']));
    let code = match bytes.get(*at..*at + 2)? {
        [_, b'0'..=b'9' | b'.'] => return None,
        [b'0', _] => 0,
        [b'1', _] => 10,
        _ => return None,
    };
    *at += 1;
    Some(code)
}

/// Returns the number of leading digits, if it is from 1 to `MAX_DIGITS`.
pub(super) fn digits(bytes: &[u8]) -> Option<usize> {
    let count = bytes
        .iter()
        .take_while(|byte| byte.is_ascii_digit())
        .count();
    (1..=MAX_DIGITS).contains(&count).then_some(count)
}

/// A decimal of few digits without blanks: an exact integer divided by an exact power of ten, as
/// the lexer reads it.
#[inline]
fn short_decimal(bytes: &[u8], at: &mut usize) -> Option<f64> {
    let sign = *bytes.get(*at)?;
    *at += usize::from(matches!(sign, b'-' | b'+'));
    let start = *at;
    let mut mantissa = 0;
    take_digits(bytes, at, &mut mantissa);
    let mut digits = *at - start;
    let mut decimals = 0;
    if bytes.get(*at) == Some(&b'.') {
        *at += 1;
        let point = *at;
        take_digits(bytes, at, &mut mantissa);
        decimals = *at - point;
        digits += decimals;
    }
    if !(1..=MAX_DIGITS).contains(&digits) {
        return None;
    }
    let value = mantissa as f64 / EXACT_POWERS[decimals];
    Some(if sign == b'-' { -value } else { value })
}

#[inline]
fn take_digits(bytes: &[u8], at: &mut usize, mantissa: &mut u64) {
    while let Some(digit) = bytes
        .get(*at)
        .map(|byte| byte.wrapping_sub(b'0'))
        .filter(|&digit| digit < 10)
    {
        *mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        *at += 1;
    }
}

impl Interpreter {
    /// Returns true if a straight motion goes only to the target in its words and nothing waits for
    /// it.
    #[inline]
    fn is_plain(&self) -> bool {
        self.modal.feed_mode == FeedMode::PerMinute
            && self.output.motions < self.settings.max_motions
            && self.carried.held.is_empty()
            && self.carried.compensation.is_none()
            && self.carried.collected.is_none()
            && self.lathe.is_none()
            && !self.behind_fault
            && !self.dialect.is_fanuc()
    }

    /// The motion of a plain line, where it has one; everything that can be wrong with it comes
    /// before the first change.
    #[inline]
    fn plain_motion(&mut self, words: &PlainWords, line: u32) -> Option<Motion> {
        let is_printer = self.dialect == Dialect::Printer;
        let code = words.code.unwrap_or(self.modal.motion);
        if !matches!(code, 0 | 10) || (words.has(E) && !is_printer) {
            return None;
        }
        let unit_mm = self.modal.unit_mm;
        let feed = if words.has(F) {
            (words.value[F] * unit_mm).min(f64::MAX)
        } else {
            self.modal.feed
        };
        let speed = if code == 10 || (is_printer && feed > 0.0) {
            Speed::Programmed
        } else {
            Speed::Rapid
        };
        let feed_mm_s = match speed {
            Speed::Rapid => 0.0,
            Speed::Programmed if feed > 0.0 => feed / MINUTE_S,
            Speed::Programmed if is_printer => PRINTER_FEED_MM_S,
            Speed::Programmed => return None,
        };
        let pushed_mm = match words.value[E] * unit_mm {
            _ if !words.has(E) => 0.0,
            value if self.extruder.is_relative => value,
            value => value - self.extruder.at_mm,
        };
        let start = self.here;
        let target = self.plain_target(words)?;
        let machine = self.frame.to_machine(&target);
        // A line that names no axis does not go anywhere, not even by the rounding of its offsets.
        let moves = (words.names_axes() && start[..3] != machine[..3]) || pushed_mm != 0.0;
        if !moves || start[3..] != machine[3..] || words.value[F] < 0.0 {
            return None;
        }
        if words.has(F) {
            (self.modal.feed, self.modal.feed_unit_mm) = (feed, unit_mm);
        }
        if words.has(E) {
            self.extruder.at_mm += pushed_mm;
        }
        self.modal.motion = code;
        self.end_cycles();
        self.carried.bezier_end = None;
        self.carried.left_compensation = false;
        (self.at, self.here) = (target, machine);
        self.output.motions += 1;
        self.line = line;
        Some(Motion {
            line,
            kind: speed.kind(),
            start_mm: [start[0], start[1], start[2]],
            end_mm: [machine[0], machine[1], machine[2]],
            shape: Shape::Line,
            feed_mm_s,
            corner: self.modal.corner,
            others: AuxiliaryAxes {
                extruder_mm: pushed_mm,
                axes: None,
            },
        })
    }

    /// Returns the target of X, Y and Z in program coordinates, or `None` if it is beyond the
    /// limit.
    #[inline]
    fn plain_target(&self, words: &PlainWords) -> Option<[f64; 9]> {
        let limit_mm = self.settings.coordinate_limit_mm;
        let mut target = self.at;
        for axis in [X, Y, Z] {
            if words.has(axis) {
                let value = words.value[axis];
                let is_diameter = axis == X && self.modal.diameter;
                let length_mm = if is_diameter { 0.5 * value } else { value } * self.modal.unit_mm;
                if length_mm.abs() > limit_mm {
                    return None;
                }
                target[axis] = if self.modal.incremental {
                    self.at[axis] + length_mm
                } else {
                    length_mm
                };
            }
        }
        let is_near = [0, 1, 2, 6, 7, 8]
            .into_iter()
            .all(|axis| target[axis].abs() <= limit_mm);
        is_near.then_some(target)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Option<PlainWords> {
        PlainWords::read(text.as_bytes())
    }

    #[test]
    fn a_plain_line_is_read_whole() {
        let words = read("N12 g01X1.5 Y-.25\tF 6\n");
        assert_eq!(words, None, "a blank before a number");
        let words = read("N12 g01X1.5 Y-.25\tF600\r\nG1").unwrap();
        assert_eq!(
            (words.code, words.set, words.length),
            (Some(10), 0b10011, 23)
        );
        assert_eq!(
            (words.value[X], words.value[Y], words.value[F]),
            (1.5, -0.25, 600.0)
        );
    }

    #[test]
    fn other_lines_go_the_long_way() {
        let others = [
            "G1 X1",
            "G2 X1\n",
            "G1.1 X1\n",
            "G10 X1\n",
            "G1 1 X1\n",
            "G1 X1 X2\n",
            "G1 X1 2\n",
            "G1 X1.2.3\n",
            "G1 X\n",
            "G1 X.\n",
            "G1 X--1\n",
            "G1 X#1\n",
            "G1 X[1]\n",
            "G1 X1 (a)\n",
            "G1 X1;a\n",
            "G1 X1*7\n",
            "/G1 X1\n",
            "%\n",
            "G1 G1 X1\n",
            "G1 X1 N5\n",
            "M3\n",
            "G1 A1\n",
            "G1 X1234567890123456\n",
            "N G1 X1\n",
            "N1.5 G1 X1\n",
            "G-0 X1\n",
            " N5 G1 X1\n",
            "G",
        ];
        for line in others {
            assert_eq!(read(line), None, "{line}");
        }
    }

    #[test]
    fn short_decimals_are_rounded_correctly() {
        for text in [
            "0.1",
            "123.456",
            ".5",
            "7.",
            "999999999999999",
            "0.00000000000001",
            "1234567.89012345",
            "000001.5",
        ] {
            assert_eq!(
                short_decimal(format!("{text} ").as_bytes(), &mut 0).unwrap(),
                text.parse::<f64>().unwrap(),
                "{text}"
            );
        }
    }
}
