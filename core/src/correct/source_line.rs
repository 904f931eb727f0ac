//! A line of a program as words, as far as its motion can be taken out of it.

/// A line whose motion is replaced.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct PartedLine {
    /// Its words, each a letter and a number as written.
    pub(super) words: Vec<(char, String)>,
    /// Its comments, brackets included.
    pub(super) comments: Vec<String>,
}

/// Words of a motion.
const OF_MOTION: &str = "NXYZIJKRF";

impl PartedLine {
    /// The words of a line; none where it has more than letters and numbers: expressions, parameters, O-words, a deleted block.
    pub(super) fn parse(line: &str) -> Option<Self> {
        let mut parsed = Self::default();
        let mut rest = line.trim();
        while let Some(first) = rest.chars().next() {
            if first == '(' {
                let end = rest.find(')')? + 1;
                parsed.comments.push(rest[..end].to_owned());
                rest = &rest[end..];
            } else if first == ';' {
                parsed.comments.push(format!("({})", rest[1..].trim().replace(['(', ')'], " ")));
                rest = "";
            } else if first.is_ascii_alphabetic() {
                let value = &rest[1..];
                let is_number = |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | ' ' | '\t');
                let end = value.find(|c: char| !is_number(c)).unwrap_or(value.len());
                let number: String = value[..end].chars().filter(|c| !c.is_whitespace()).collect();
                number.parse::<f64>().ok()?;
                parsed.words.push((first.to_ascii_uppercase(), number));
                rest = &value[end..];
            } else if first.is_whitespace() {
                rest = rest.trim_start();
            } else {
                return None;
            }
        }
        Some(parsed)
    }

    /// What stays of it when the motion is taken out, as text.
    pub(super) fn without_motion(&self) -> String {
        let stays = |(letter, number): &&(char, String)| {
            !(OF_MOTION.contains(*letter) || *letter == 'G' && Self::is_motion(number))
        };
        let words: Vec<&(char, String)> = self.words.iter().filter(stays).collect();
        // P alone is the number of turns of an arc.
        if words.iter().all(|(letter, _)| *letter == 'P') {
            return String::new();
        }
        words.iter().map(|(letter, number)| format!("{letter}{number}")).collect::<Vec<_>>().join(" ")
    }

    /// Whether it has a word of this letter.
    pub(super) fn has(&self, letters: &str) -> bool {
        self.words.iter().any(|(letter, _)| letters.contains(*letter))
    }

    /// Whether it says itself how it moves, or has a code that moves or sets otherwise.
    pub(super) fn has_code(&self) -> bool {
        self.words
            .iter()
            .any(|(letter, number)| *letter == 'G' && (Self::is_motion(number) || Self::takes_axes(number)))
    }

    fn is_motion(number: &str) -> bool {
        number.parse::<f64>().is_ok_and(|code| [0.0, 1.0, 2.0, 3.0].contains(&code))
    }

    /// Codes whose axis words are no motion, and motions other than lines and arcs.
    fn takes_axes(number: &str) -> bool {
        number.parse::<f64>().is_ok_and(|code| {
            [5.0, 5.1, 6.2, 10.0, 28.0, 30.0, 33.0, 52.0, 92.0].contains(&code)
                || (38.0..39.0).contains(&code)
                || (73.0..90.0).contains(&code)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_motion_is_taken_out_and_all_else_stays() {
        let line = PartedLine::parse("N10 G21G90 G1 x 10.5 Y-3 F500 S800 M3 (start)").unwrap();
        assert_eq!(line.without_motion(), "G21 G90 S800 M3");
        assert_eq!(line.comments, ["(start)"]);
        assert_eq!(PartedLine::parse("G2 X1 I1 P2").unwrap().without_motion(), "");
        assert!(PartedLine::parse("G28 Z0").unwrap().has_code());
        for refused in ["#1=5", "G1 X[1+2]", "/G1 X1", "o100 call", "G1 X#5", "%"] {
            assert_eq!(PartedLine::parse(refused), None, "{refused}");
        }
    }
}
