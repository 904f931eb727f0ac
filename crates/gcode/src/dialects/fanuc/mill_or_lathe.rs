//! Whether a program for Fanuc or Haas is one for a mill or for a lathe: the same words cut
//! different parts.
//!
//! Signs are looked for line by line, in G-code system A. A certain one has no meaning on the other
//! machine, a likely one has hardly any. Certain signs decide; without one, the machine with more
//! kinds of likely signs; signs of both that weigh the same decide nothing.

use crate::text::codes::{AXES, bit};

/// Text that shows the machine, and its line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Sign {
    /// Line of the program, from 1.
    pub(crate) line: u32,
    pub(crate) what: &'static str,
    is_certain: bool,
}

/// Signs found at the beginning of a program.
#[derive(Debug, Default)]
pub(crate) struct Evidence {
    lathe: Vec<Sign>,
    mill: Vec<Sign>,
    /// An X that nothing says the meaning of: where it stands.
    pub(crate) x_line: Option<u32>,
    has_tool_change: bool,
    /// A code that lathes of LinuxCNC have and those of system A do not.
    has_linuxcnc: bool,
}

/// The machine that a program is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum MillOrLathe {
    Lathe(Sign),
    Mill(Sign),
    /// Signs of both: the first of the lathe and the first of the mill.
    Both(Sign, Sign),
    /// No sign.
    Unknown,
}

/// Feeds below these, per minute, are feeds per revolution: mm and inches in a program that does
/// not say which; inches.
const SLOW: [f64; 2] = [1.0, 0.06];

const LATHE_TOOL: &str = "a tool with its offset, as in T0101, and no M6";

impl Evidence {
    /// Looks through the beginning of a program.
    pub(crate) fn find(head: &[u8]) -> Self {
        let mut evidence = Self::default();
        let mut is_inch = false;
        for (number, line) in (1..).zip(head.split(|&byte| byte == b'\n')) {
            let words = LineWords::of(line);
            is_inch |= words.has_g(200);
            evidence.lathe_signs(&words, number, is_inch);
            evidence.mill_signs(&words, number);
            evidence.has_tool_change |= words.m.contains(&6);
            // G7, G8, G33, G33.1, G64, G95.
            evidence.has_linuxcnc |= words.has_any_g(&[70, 80, 330, 331, 640, 950]);
            if words.has(b"x") && evidence.x_line.is_none() {
                evidence.x_line = Some(number);
            }
        }
        if evidence.has_tool_change {
            evidence.lathe.retain(|sign| sign.what != LATHE_TOOL);
        }
        evidence
    }

    /// Returns a sign that only a lathe program of Fanuc or Haas can have, not even one of
    /// LinuxCNC.
    pub(crate) fn certain_lathe(&self) -> Option<Sign> {
        // U may be an axis there, and G32 something else.
        let others = ["G28", "G32"];
        self.lathe
            .iter()
            .copied()
            .find(|sign| sign.is_certain && !others.iter().any(|code| sign.what.starts_with(code)))
    }

    /// Returns the first sign of a Fanuc or Haas lathe. `None` with fewer than two kinds of them,
    /// or with any sign of a mill or of LinuxCNC.
    pub(crate) fn likely_lathe(&self) -> Option<Sign> {
        let is_likely = self.lathe.len() > 1 && self.mill.is_empty() && !self.has_linuxcnc;
        self.lathe.first().copied().filter(|_| is_likely)
    }

    /// The machine.
    pub(crate) fn mill_or_lathe(&self) -> MillOrLathe {
        let certain = |signs: &[Sign]| signs.iter().copied().find(|sign| sign.is_certain);
        match (certain(&self.lathe), certain(&self.mill)) {
            (Some(lathe), Some(mill)) => return MillOrLathe::Both(lathe, mill),
            (Some(lathe), None) => return MillOrLathe::Lathe(lathe),
            (None, Some(mill)) => return MillOrLathe::Mill(mill),
            (None, None) => {}
        }
        match (self.lathe.first(), self.mill.first()) {
            (None, None) => MillOrLathe::Unknown,
            (Some(&lathe), None) => MillOrLathe::Lathe(lathe),
            (None, Some(&mill)) => MillOrLathe::Mill(mill),
            (Some(&lathe), Some(&mill)) => match self.lathe.len().cmp(&self.mill.len()) {
                std::cmp::Ordering::Greater => MillOrLathe::Lathe(lathe),
                std::cmp::Ordering::Less => MillOrLathe::Mill(mill),
                std::cmp::Ordering::Equal => MillOrLathe::Both(lathe, mill),
            },
        }
    }

    /// The first signs of both machines where none is certain and the number of kinds decided.
    pub(crate) fn conflict(&self) -> Option<(Sign, Sign)> {
        let is_certain = self
            .lathe
            .iter()
            .chain(&self.mill)
            .any(|sign| sign.is_certain);
        if is_certain {
            None
        } else {
            self.lathe.first().copied().zip(self.mill.first().copied())
        }
    }

    /// Adds a sign, once of each kind.
    fn add(signs: &mut Vec<Sign>, line: u32, what: &'static str, is_certain: bool) {
        if !signs.iter().any(|sign| sign.what == what) {
            signs.push(Sign {
                line,
                what,
                is_certain,
            });
        }
    }

    fn lathe_signs(&mut self, words: &LineWords, line: u32, is_inch: bool) {
        let mut add = |what, is_certain| Self::add(&mut self.lathe, line, what, is_certain);
        let has_axes = words.letters & AXES != 0;
        let is_pair = words.has(b"p") && words.has(b"q") && !words.has(b"r") && !words.has(b"z");
        let is_first =
            (words.has(b"u") || words.has(b"w")) && words.has(b"r") && !words.has_any(b"xyz");
        if words.has_g(500) && words.has(b"s") {
            add("G50 S, the highest spindle speed", true);
        }
        if (words.has_any_g(&[710, 720, 730]) && (is_pair || is_first))
            || (words.has_g(700) && is_pair && !has_axes)
        {
            add(
                "G70 to G73 with P and Q or with U and R, a roughing cycle",
                !words.has_g(700),
            );
        }
        if (words.has_any_g(&[740, 750]) && words.has(b"r") && !has_axes)
            || (words.has_g(760) && words.has(b"p") && words.has(b"q") && !has_axes)
        {
            add(
                "G74, G75 or G76 in two blocks, a grooving or threading cycle",
                true,
            );
        }
        if words.has_g(920) && words.has(b"f") && words.has_any(b"xu") {
            add("G92 with F, a threading cycle", true);
        }
        if words.has_g(320) && words.has(b"f") {
            add("G32, a thread", true);
        }
        if words.has_any_g(&[280, 300]) && words.has(b"u") {
            add("G28 U, the way to the reference point", true);
        }
        let is_macro = words.has_any_g(&[650, 660, 661]);
        if words.has_any(b"uw")
            && !is_macro
            && !words.has_any_g(&[700, 710, 720, 730, 740, 750, 760])
        {
            add("U or W, distances along X and Z", false);
        }
        if words.has_g(960) {
            add("G96, a surface speed", false);
        }
        if words.lathe_tool && !words.m.contains(&6) {
            add(LATHE_TOOL, false);
        }
        if words.has_g(990) && words.has(b"f") && !words.has_cycle() {
            add("G99 with F, a feed per revolution", false);
        }
        let alone = !words.has_any_g(&[0, 10, 20, 30]) && !words.has(b"y");
        if words.has_g(900)
            && words.has_any(b"xu")
            && words.has_any(b"zw")
            && words.has(b"f")
            && alone
        {
            add("G90 with X, Z and F, a turning cycle", false);
        }
        if words.has_g(940) && words.has_any(b"xu") && words.has_any(b"zw") && alone {
            add("G94 with X and Z, a facing cycle", false);
        }
        let slow = SLOW[usize::from(is_inch)];
        if words.feed.is_some_and(|feed| feed > 0.0 && feed < slow)
            && !words.has_any_g(&[930, 950])
            && !is_macro
        {
            add("F so small that it is a feed per revolution", false);
        }
    }

    fn mill_signs(&mut self, words: &LineWords, line: u32) {
        let mut add = |what, is_certain| Self::add(&mut self.mill, line, what, is_certain);
        if words.has_g(430) {
            add("G43, a tool length", true);
        }
        if words.has_cycle() && words.has(b"x") && words.has(b"y") {
            add("a drilling cycle with X and Y", true);
        }
        if words.has_any_g(&[410, 420]) && words.has(b"d") {
            add("G41 D or G42 D, cutter compensation", true);
        }
        let has_axes = words.has_any(b"xzuw");
        if words.has_any_g(&[900, 910])
            && (!has_axes
                || words.has(b"y")
                || words.has_g(910)
                || words.has_any_g(&[0, 10, 20, 30, 280]))
        {
            add("G90 or G91 as a mode", false);
        }
        if words.has(b"y") && !words.has_any_g(&[650, 660, 661]) {
            add("Y", false);
        }
        if words.m.contains(&6) {
            add("M6, a tool change", false);
        }
        if words.has_g(170) {
            add("G17, the XY plane", false);
        }
    }
}

/// Words of a line as far as they are signs of a machine.
#[derive(Debug, Default)]
struct LineWords {
    /// Ten times the codes.
    g: Vec<u32>,
    m: Vec<u32>,
    letters: u32,
    feed: Option<f64>,
    /// True where a T word has three or four digits: the tool number, then the offset number.
    lathe_tool: bool,
}

impl LineWords {
    pub(super) fn of(line: &[u8]) -> Self {
        let mut words = Self::default();
        let mut at = 0;
        let is_statement = ["IF", "WHILE", "GOTO", "END", "DO", "#"]
            .iter()
            .any(|start| {
                let code = line.trim_ascii_start();
                code.get(..start.len())
                    .is_some_and(|code| code.eq_ignore_ascii_case(start.as_bytes()))
            });
        while let Some(&byte) = line.get(at).filter(|_| !is_statement) {
            at += 1;
            match byte.to_ascii_lowercase() {
                b';' => break,
                b'(' => {
                    at += line[at..]
                        .iter()
                        .position(|&byte| byte == b')')
                        .unwrap_or(line.len() - at);
                }
                letter @ b'a'..=b'z' => {
                    let rest = line[at..].trim_ascii_start();
                    let length = rest
                        .iter()
                        .take_while(|byte| matches!(byte, b'0'..=b'9' | b'.' | b'-' | b'+'))
                        .count();
                    words.add(letter, &rest[..length]);
                    at = line.len() - rest.len() + length;
                }
                _ => {}
            }
        }
        words
    }

    fn add(&mut self, letter: u8, number: &[u8]) {
        let value = std::str::from_utf8(number)
            .ok()
            .and_then(|text| text.parse::<f64>().ok());
        match (letter, value) {
            (b'g', Some(value)) => self.g.push((value * 10.0).round() as u32),
            (b'm', Some(value)) => self.m.push(value.round() as u32),
            (b't', _) => {
                self.lathe_tool |=
                    matches!(number.len(), 3 | 4) && number.iter().all(u8::is_ascii_digit);
            }
            (b'g' | b'm' | b'n' | b'o', _) => {}
            (_, value) => {
                self.letters |= bit(letter);
                if letter == b'f' {
                    self.feed = value;
                }
            }
        }
    }

    const fn has(&self, letter: &[u8; 1]) -> bool {
        self.letters & bit(letter[0]) != 0
    }

    fn has_any(&self, letters: &[u8]) -> bool {
        letters
            .iter()
            .any(|&letter| self.letters & bit(letter) != 0)
    }

    fn has_g(&self, code: u32) -> bool {
        self.g.contains(&code)
    }

    fn has_any_g(&self, codes: &[u32]) -> bool {
        codes.iter().any(|&code| self.has_g(code))
    }

    fn has_cycle(&self) -> bool {
        self.g
            .iter()
            .any(|code| matches!(code, 730 | 740 | 760 | 810..=890))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kind(text: &str) -> &'static str {
        match Evidence::find(text.as_bytes()).mill_or_lathe() {
            MillOrLathe::Lathe(_) => "lathe",
            MillOrLathe::Mill(_) => "mill",
            MillOrLathe::Both(..) => "both",
            MillOrLathe::Unknown => "unknown",
        }
    }

    #[test]
    fn one_line_may_be_enough() {
        for line in [
            "G50 S2500",
            "G71 U2. R0.5",
            "N10G71P100Q200U.4W.1F.25",
            "G72 W1. R.5",
            "G73 U3. W3. R3",
            "G74 R1.",
            "G76 P020060 Q100 R0.05",
            "G92 X29.4 Z-30. F1.5",
            "G32 Z-30. F1.5",
            "G28 U0 W0",
            "T0101",
            "G96 S180 M3",
            "G99 G1 Z-5. F0.25",
            "G1 U-2. W-5.",
            "G90 X48. Z-30. F0.2",
            "G94 X0 Z-1.",
            "G1 Z-30. F.2",
        ] {
            assert_eq!(
                kind(&format!("O0001 (PART)\n{line}\nM30\n")),
                "lathe",
                "{line}"
            );
        }
        for line in [
            "G43 H1 Z50.",
            "G81 X10. Y10. Z-5. R2. F100",
            "G41 D1 X5.",
            "G90",
            "G91 G28 Z0",
            "T1 M6",
            "G17",
            "Y5.",
        ] {
            assert_eq!(kind(&format!("O0001\n{line}\nM30\n")), "mill", "{line}");
        }
        for line in ["G0 X5. Z5.", "(G50 S1)", "IF [#24 EQ #0] GOTO 5", "T1"] {
            assert_eq!(kind(&format!("O0001\n{line}\nM30\n")), "unknown", "{line}");
        }
    }

    #[test]
    fn certain_signs_decide_and_then_their_number() {
        assert_eq!(kind("G50 S2500\nG1 X5. Y5."), "lathe");
        assert_eq!(kind("G50 S2500\nG43 H1"), "both");
        assert_eq!(kind("T0101\nG96 S200\nG0 X5. Y2."), "lathe");
        assert_eq!(kind("T0101 M6\nG90 G54 G0 X5. Y2."), "mill");
        assert_eq!(kind("T0101\nG90 G54 G0 X5. Z2."), "both");
        assert_eq!(kind("G90 G17\nG0 X5. Y2.\nG1 W-5. F100"), "mill");
    }
}
