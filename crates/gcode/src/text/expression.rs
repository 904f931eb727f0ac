//! Values of words: numbers, parameters, functions and bracketed expressions, evaluated while they
//! are read.
//!
//! Grammar (binding tightest first; operators of one row from left to right):
//!
//! ```text
//! value      = number | '#' index | '[' expression ']' | ('+'|'-') value | function '[' expression ']'
//! function   = abs acos asin atan[..]/[..] cos exists exp fix fup ln round sin sqrt tan      (angles in degrees)
//! operators  = **   then * / mod   then + -   then eq ne gt ge lt le   then and or xor
//! index      = value | '<' name '>'
//! ```
//!
//! Rules: T. R. Kramer, F. M. Proctor, E. Messina, The NIST RS274NGC Interpreter - Version 3,
//! NISTIR 6556 (2000), section 3.3, with the named parameters and comparisons that LinuxCNC added.

mod operators;

use crate::text::characters::not_ascii;
use crate::text::diagnostic::{LineFault, Read, Short};
use crate::text::expression::operators::{OPERATORS, Operator, apply_function, without_vacancy};
use crate::text::lexer::{Cursor, END, NO_EXPONENT, shown};

/// Brackets, signs and `#` inside each other. Each level costs stack; no written program has more
/// than a dozen.
const MAX_DEPTH: u32 = 200;
/// An index or number this close to an integer is that integer, as in LinuxCNC.
pub(crate) const INTEGER_WITHIN: f64 = 1e-4;

/// Source of parameter values.
pub(crate) trait ParameterSource {
    /// Value of `#index`, `index` from 1 to 5601.
    fn numbered(&self, index: usize) -> f64;
    /// Value of `#<name>`, lower case without blanks.
    fn named(&self, name: &[u8]) -> Option<f64>;
    /// Returns true if expressions follow the rules of Fanuc macros.
    fn is_fanuc(&self) -> bool {
        false
    }
    /// Why `#index` cannot be read, if it cannot.
    fn refused(&self, _index: usize) -> Option<String> {
        None
    }
}

/// A program without parameters: numbered ones are 0, and no name is known.
pub(crate) struct NoParameters;

impl ParameterSource for NoParameters {
    fn numbered(&self, _index: usize) -> f64 {
        0.0
    }

    fn named(&self, _name: &[u8]) -> Option<f64> {
        None
    }
}

/// Parameter that `#` refers to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Target {
    /// A number.
    Numbered(usize),
    /// A name, lower case without blanks.
    Named(Vec<u8>),
}

/// Reads values at a cursor.
#[derive(Debug)]
pub(crate) struct Evaluator<'a, V> {
    pub(crate) cursor: Cursor<'a>,
    values: &'a V,
    depth: u32,
}

/// Functions of one argument; `atan` and `exists` have a syntax of their own.
const FUNCTIONS: [&[u8]; 14] = [
    b"abs", b"acos", b"asin", b"atan", b"cos", b"exists", b"exp", b"fix", b"fup", b"ln", b"round",
    b"sin", b"sqrt", b"tan",
];

/// Hint for the comparison signs of other languages.
const COMPARISONS: &str = "comparisons are spelled out: EQ, NE, GT, GE, LT, LE, as in [#1 EQ 5]";

/// Words of Fanuc macros and of other languages, which programs for them hold in place of O-words.
const MACRO_KEYWORDS: [&str; 8] = ["if", "while", "goto", "end", "endif", "else", "for", "do"];

impl<'a, V: ParameterSource> Evaluator<'a, V> {
    pub(crate) const fn new(cursor: Cursor<'a>, values: &'a V) -> Self {
        Self {
            cursor,
            values,
            depth: 0,
        }
    }

    /// A value.
    #[inline]
    pub(crate) fn value(&mut self) -> Read<f64> {
        let first = self.cursor.peek();
        if first.is_ascii_digit() || first == b'.' {
            self.cursor.number()
        } else {
            self.other_value(first)
        }
    }

    fn other_value(&mut self, first: u8) -> Read<f64> {
        let start = self.cursor.at;
        match first {
            b'[' => self.bracketed(),
            b'#' => {
                let target = self.target()?;
                self.parameter(&target, start)
            }
            b'+' | b'-' => {
                let mut ahead = self.cursor.clone();
                ahead.bump();
                let next = ahead.peek();
                if next.is_ascii_digit() || next == b'.' {
                    return self.cursor.number();
                }
                self.cursor.bump();
                let value = self.deeper(start, Self::value)?;
                Ok(if first == b'-' { -value } else { value })
            }
            b'a'..=b'z' => self.function(),
            _ => self.cursor.number(),
        }
    }

    /// Returns true if values follow the rules of Fanuc macros.
    pub(super) fn is_fanuc(&self) -> bool {
        self.values.is_fanuc()
    }

    /// Values joined by operators without brackets, as Fanuc has them behind `=`.
    pub(super) fn joined(&mut self) -> Read<f64> {
        self.expression(1)
    }

    /// `[ expression ]`.
    pub(crate) fn bracketed(&mut self) -> Read<f64> {
        let start = self.cursor.at;
        if !self.cursor.eat(b'[') {
            let found = self.cursor.raw();
            let message = format!("`[` is missing: {} stands in its place", text_of(found));
            let fault = LineFault::new("gcode::bracket", start..start + 1, message);
            return Err(if found == b'(' {
                fault.hint("arguments and calculations stand in [ ]: sin[30]; ( ) is a comment")
            } else {
                fault
            });
        }
        let value = self.deeper(start, |evaluator| evaluator.expression(1))?;
        if !self.cursor.eat(b']') {
            let (found, at) = (self.cursor.raw(), self.cursor.at);
            let message = format!(
                "`]` or an operator is missing: {} stands in its place",
                text_of(found)
            );
            let fault = LineFault::new("gcode::bracket", at..at + 1, message);
            if !found.is_ascii() {
                return Err(not_ascii(self.cursor.bytes, at));
            }
            return Err(fault.hint(match found {
                _ if self.cursor.is_exponent() => NO_EXPONENT,
                b'=' | b'<' | b'>' | b'!' => COMPARISONS,
                b'&' | b'|' => "logic is spelled out: AND, OR, XOR",
                b'%' => "the remainder is MOD",
                b'^' => "a power is **",
                _ => "every `[` needs its `]`",
            }));
        }
        Ok(value)
    }

    /// Values joined by operators that bind at least as tightly as `weakest`.
    fn expression(&mut self, weakest: u8) -> Read<f64> {
        let start = self.cursor.at;
        let mut left = self.value()?;
        while let Some((operator, strength, after)) = self.operator_ahead() {
            if strength < weakest {
                break;
            }
            self.cursor.at = after;
            let right = self.deeper(start, |evaluator| evaluator.expression(strength + 1))?;
            let applied = if self.values.is_fanuc() {
                operator.apply_to_variables(left, right)
            } else {
                operator.apply(left, right)
            };
            left = applied.map_err(|message| {
                LineFault::new("gcode::expression", start..self.cursor.at, message)
            })?;
            if !left.is_finite() {
                return Err(not_finite(start..self.cursor.at));
            }
        }
        Ok(left)
    }

    fn operator_ahead(&mut self) -> Option<(Operator, u8, usize)> {
        if matches!(self.cursor.peek(), b']' | END) {
            return None;
        }
        let mut ahead = self.cursor.clone();
        OPERATORS
            .iter()
            .find(|(spelling, ..)| ahead.eat_word(spelling))
            .map(|&(_, operator, strength)| (operator, strength, ahead.at))
    }

    fn function(&mut self) -> Read<f64> {
        let start = self.cursor.at;
        let Some(name) = FUNCTIONS
            .into_iter()
            .find(|name| self.cursor.eat_word(name))
        else {
            return Err(self.unknown_function(start));
        };
        if name == b"exists" {
            return self.exists();
        }
        let argument = without_vacancy(self.bracketed()?);
        let value = if name == b"atan" && self.values.is_fanuc() && self.cursor.peek() != b'/' {
            libm::atan(argument).to_degrees()
        } else if name == b"atan" {
            if !self.cursor.eat(b'/') {
                let message = "atan needs two arguments: a `/` and a second bracket are missing";
                return Err(
                    LineFault::new("gcode::expression", start..self.cursor.at, message)
                        .hint("write atan[y]/[x]"),
                );
            }
            libm::atan2(argument, self.bracketed()?).to_degrees()
        } else {
            apply_function(name, argument).map_err(|message| {
                LineFault::new("gcode::expression", start..self.cursor.at, message)
            })?
        };
        if value.is_finite() {
            Ok(value)
        } else {
            Err(not_finite(start..self.cursor.at))
        }
    }

    #[cold]
    fn unknown_function(&mut self, start: usize) -> Box<LineFault> {
        let letters: Vec<u8> = self
            .cursor
            .rest()
            .iter()
            .copied()
            .take_while(u8::is_ascii_alphabetic)
            .take(12)
            .collect();
        let name = String::from_utf8_lossy(&letters).into_owned();
        let fault = LineFault::new(
            "gcode::number",
            start..start + letters.len(),
            format!("a value is missing: `{name}` is neither a number nor a function"),
        );
        let nearest = FUNCTIONS
            .iter()
            .map(|known| String::from_utf8_lossy(known))
            .find(|known| {
                letters.len() > 1 && strsim::levenshtein(known, &name.to_ascii_lowercase()) <= 1
            });
        // The letter before the value belongs to the word that the user wrote: W and `hile`.
        let before = start.checked_sub(1).map_or(b' ', |before| {
            self.cursor.bytes[before].to_ascii_lowercase()
        });
        let keyword = format!("{}{}", char::from(before), name.to_ascii_lowercase());
        match nearest {
            _ if before == b'#' => fault.hint(format!("names of parameters stand in angle brackets: #<{name}>")),
            _ if MACRO_KEYWORDS.contains(&&keyword[..]) => {
                fault.hint("loops and branches begin with an O-word, as in `o1 while [#1 LT 5]`; --dialect fanuc reads those of Fanuc macros")
            }
            _ if name.starts_with(['o', 'O']) => fault.hint("the letter O is no zero: write 0"),
            _ if name.starts_with(['l', 'I', 'i']) => fault.hint("the letters l and I are no one: write 1"),
            Some(known) => fault.hint(format!("did you mean `{known}[...]`?")),
            None => fault,
        }
    }

    /// `exists[#<name>]`: 1 or 0. Of numbers those exist that a program may use.
    fn exists(&mut self) -> Read<f64> {
        let start = self.cursor.at;
        if self.cursor.eat(b'[') && self.cursor.eat(b'#') {
            let exists = if self.cursor.eat(b'<') {
                let name = self.name(start)?;
                self.values.named(&name).is_some()
            } else {
                let number = self.parameter_number(start)?;
                self.has_parameter(number)
            };
            if self.cursor.eat(b']') {
                return Ok(f64::from(u8::from(exists)));
            }
        }
        Err(LineFault::new(
            "gcode::expression",
            start..self.cursor.at + 1,
            "exists takes a parameter",
        )
        .hint("write exists[#<name>]"))
    }

    /// Reads the parameter that the `#` under the cursor refers to.
    pub(super) fn target(&mut self) -> Read<Target> {
        let start = self.cursor.at;
        self.cursor.bump();
        if self.cursor.eat(b'<') {
            return Ok(Target::Named(self.name(start)?));
        }
        let number = self.parameter_number(start)?;
        if !self.has_parameter(number) {
            let message = format!(
                "parameter #{} does not exist: the numbers go from 1 to {}",
                Short(number),
                PARAMETERS - 1
            );
            return Err(LineFault::new(
                "gcode::parameter",
                start..self.cursor.at,
                message,
            ));
        }
        Ok(Target::Numbered(number as usize))
    }

    /// Reads the whole number behind a `#`. A parameter with this number need not exist.
    fn parameter_number(&mut self, start: usize) -> Read<f64> {
        let index = self.deeper(start, Self::value)?;
        let rounded = index.round();
        if (index - rounded).abs() > INTEGER_WITHIN {
            let message = format!("parameter number {} is not an integer", Short(index));
            return Err(LineFault::new(
                "gcode::parameter",
                start..self.cursor.at,
                message,
            ));
        }
        Ok(rounded)
    }

    fn has_parameter(&self, number: f64) -> bool {
        let first = if self.values.is_fanuc() { 0.0 } else { 1.0 };
        (first..PARAMETERS as f64).contains(&number)
    }

    /// The name up to `>`, lower case without blanks.
    pub(crate) fn name(&mut self, start: usize) -> Read<Vec<u8>> {
        let mut name = Vec::new();
        loop {
            match self.cursor.peek() {
                b'>' => break,
                END => {
                    return Err(LineFault::new(
                        "gcode::parameter",
                        start..self.cursor.at,
                        "the name is not closed: `>` is missing",
                    ));
                }
                byte => name.push(byte),
            }
            self.cursor.bump();
        }
        self.cursor.bump();
        if name.is_empty() {
            Err(LineFault::new(
                "gcode::parameter",
                start..self.cursor.at,
                "the name is empty",
            ))
        } else {
            Ok(name)
        }
    }

    fn parameter(&self, target: &Target, start: usize) -> Read<f64> {
        match target {
            Target::Numbered(index) => match self.values.refused(*index) {
                Some(message) => Err(LineFault::new("gcode::parameter", start..self.cursor.at, message)
                    .hint("give it to the program as a number")),
                None => Ok(self.values.numbered(*index)),
            },
            Target::Named(name) => self.values.named(name).ok_or_else(|| {
                let name = String::from_utf8_lossy(name);
                LineFault::new(
                    "gcode::parameter",
                    start..self.cursor.at,
                    format!("parameter #<{name}> has no value here"),
                )
                .hint("assign it first; names without a leading underscore are local to their subroutine")
            }),
        }
    }

    fn deeper<T>(&mut self, start: usize, read: impl FnOnce(&mut Self) -> Read<T>) -> Read<T> {
        if self.depth == MAX_DEPTH {
            let message = format!("more than {MAX_DEPTH} brackets, signs or # inside each other");
            return Err(LineFault::new(
                "gcode::depth",
                start..self.cursor.at + 1,
                message,
            ));
        }
        self.depth += 1;
        let result = read(self);
        self.depth -= 1;
        result
    }
}

#[cold]
fn not_finite(at: std::ops::Range<usize>) -> Box<LineFault> {
    LineFault::new("gcode::expression", at, "the result is not a finite number")
}

fn text_of(byte: u8) -> String {
    if byte == END {
        "the end of the line".to_owned()
    } else {
        format!("`{}`", shown(byte))
    }
}

/// One more than the highest numbered parameter.
pub(crate) const PARAMETERS: usize = 5602;

#[cfg(test)]
mod tests {
    use super::*;

    struct Fixed;

    impl ParameterSource for Fixed {
        fn numbered(&self, index: usize) -> f64 {
            index as f64 * 10.0
        }

        fn named(&self, name: &[u8]) -> Option<f64> {
            (name == b"known").then_some(4.0)
        }
    }

    fn value(text: &str) -> f64 {
        Evaluator::new(Cursor::new(text.as_bytes()), &Fixed)
            .value()
            .unwrap()
    }

    fn message(text: &str) -> String {
        Evaluator::new(Cursor::new(text.as_bytes()), &Fixed)
            .value()
            .unwrap_err()
            .message
    }

    #[test]
    fn operators_bind_as_in_rs274() {
        assert_eq!(value("[2 + 3 * 2 ** 2 mod 5]"), 4.0);
        assert_eq!(value("[2 ** 3 ** 2]"), 64.0);
        assert_eq!(value("[10 - 2 - 3]"), 5.0);
        assert_eq!(value("[1 + 1 EQ 2 AND 3 GT 2]"), 1.0);
        assert_eq!(value("[-7 MOD 3]"), 2.0);
        assert_eq!(value("[1 EQ 1.00005]"), 1.0);
    }

    #[test]
    fn functions_are_in_degrees() {
        assert!((value("sin[30]") - 0.5).abs() < 1e-15);
        assert_eq!(value("atan[1]/[-1]"), 135.0);
        assert_eq!(value("fix[-2.3]"), -3.0);
        assert_eq!(value("fup[-2.3]"), -2.0);
        assert_eq!(value("round[-2.5]"), -3.0);
        assert_eq!(value("EXISTS[#<known>] "), 1.0);
        assert_eq!(value("exists[#<un known>]"), 0.0);
        assert_eq!(value("exists[#1]"), 1.0);
    }

    #[test]
    fn parameters_and_signs_nest() {
        assert_eq!(value("#3"), 30.0);
        assert_eq!(value("##3"), 300.0);
        assert_eq!(value("#[1+2]"), 30.0);
        assert_eq!(value("-[#<kNoWn> * 2]"), -8.0);
        assert_eq!(value("- -5"), 5.0);
        assert_eq!(value("-#2"), -20.0);
    }

    #[test]
    fn impossible_values_are_explained() {
        assert!(message("[1/0]").contains("divided by zero"));
        assert!(message("sqrt[-1]").contains("zero or positive"));
        assert!(message("#5602").contains("does not exist"));
        assert!(message("#1.5").contains("not an integer"));
        assert!(message("#<foo>").contains("no value"));
        assert!(message("[10**400]").contains("finite"));
        assert!(message("[1+2").contains("`]`"));
        assert!(message(&"[".repeat(100_000)).contains("more than 200"));
        assert!(message(&"-".repeat(100_000)).contains("more than 200"));
    }
}
