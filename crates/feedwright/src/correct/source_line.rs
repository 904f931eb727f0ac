//! A line of a program as words, so that its motion can be taken out.

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
/// Words that belong to a motion if a line has no other code: turns of an arc, tangents, weights
/// and the order of a curve.
const ALONE_OF_MOTION: &str = "PQLD";
/// Codes of motions that may be replaced, and those of them that collect a curve over lines.
const MOTIONS: [f64; 9] = [0.0, 1.0, 2.0, 3.0, 5.0, 5.1, 5.2, 5.3, 6.2];
const COLLECTING: [f64; 2] = [5.2, 6.2];

impl PartedLine {
    /// Parses the words of a line; none if it has more than letters and numbers: expressions,
    /// parameters, O-words, a deleted block.
    pub(super) fn parse(line: &str) -> Option<Self> {
        let mut parsed = Self::default();
        let mut rest = line.trim();
        while let Some(first) = rest.chars().next() {
            if first == '(' {
                let end = rest.find(')')? + 1;
                parsed.comments.push(rest[..end].to_owned());
                rest = &rest[end..];
            } else if first == ';' {
                parsed
                    .comments
                    .push(format!("({})", rest[1..].trim().replace(['(', ')'], " ")));
                rest = "";
            } else if first.is_ascii_alphabetic() {
                let value = &rest[1..];
                let is_number =
                    |c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | ' ' | '\t');
                let end = value.find(|c: char| !is_number(c)).unwrap_or(value.len());
                let number: String = value[..end]
                    .chars()
                    .filter(|c| !c.is_whitespace())
                    .collect();
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

    /// Returns the rest of the line without the motion, as text.
    pub(super) fn without_motion(&self) -> String {
        let stays = |(letter, number): &&(char, String)| {
            !(OF_MOTION.contains(*letter) || *letter == 'G' && Self::is_motion(number))
        };
        let words: Vec<&(char, String)> = self.words.iter().filter(stays).collect();
        if words
            .iter()
            .all(|(letter, _)| ALONE_OF_MOTION.contains(*letter))
        {
            return String::new();
        }
        words
            .iter()
            .map(|(letter, number)| format!("{letter}{number}"))
            .collect::<Vec<_>>()
            .join(" ")
    }

    /// Returns true if the line has a word of any of these letters.
    pub(super) fn has(&self, letters: &str) -> bool {
        self.words
            .iter()
            .any(|(letter, _)| letters.contains(*letter))
    }

    /// Returns true if the line has its own motion code, or a code that moves or sets in another
    /// way.
    pub(super) fn has_code(&self) -> bool {
        self.words.iter().any(|(letter, number)| {
            *letter == 'G' && (Self::is_motion(number) || Self::takes_axes(number))
        })
    }

    /// Returns the words that define what coordinates mean, as text; none if the line has no such
    /// words. Offsets and rotations come with all of their words, other codes alone.
    pub(super) fn frame_words(&self) -> Option<String> {
        let codes = |wanted: fn(f64) -> bool| {
            let is = move |(letter, number): &&(char, String)| {
                *letter == 'G' && number.parse::<f64>().is_ok_and(wanted)
            };
            self.words
                .iter()
                .filter(is)
                .map(|(letter, number)| format!("{letter}{number}"))
                .collect::<Vec<_>>()
        };
        let with_axes = codes(|code| [10.0, 52.0, 68.0, 92.0, 92.1, 92.2, 92.3].contains(&code));
        let alone = codes(|code| {
            (54.0..60.0).contains(&code) || (43.0..50.0).contains(&code) || code == 69.0
        });
        let of_code = |(letter, number): &(char, String)| match letter {
            'G' | 'N' | 'F' | 'S' | 'T' | 'M' => None,
            'H' => Some(format!("H{number}")),
            _ if with_axes.is_empty() => None,
            _ => Some(format!("{letter}{number}")),
        };
        let words = self.words.iter().filter_map(of_code);
        let all: Vec<String> = with_axes
            .iter()
            .chain(&alone)
            .cloned()
            .chain(words)
            .collect();
        (!with_axes.is_empty() || !alone.is_empty()).then(|| all.join(" "))
    }

    /// Returns true if the line begins or continues a curve that a later line completes.
    pub(super) fn collects_curve(&self) -> bool {
        self.words.iter().any(|(letter, number)| {
            *letter == 'G' && number.parse().is_ok_and(|code| COLLECTING.contains(&code))
        })
    }

    fn is_motion(number: &str) -> bool {
        number
            .parse::<f64>()
            .is_ok_and(|code| MOTIONS.contains(&code))
    }

    /// Codes whose axis words are no motion, and motions that may not be replaced.
    fn takes_axes(number: &str) -> bool {
        number.parse::<f64>().is_ok_and(|code| {
            [10.0, 28.0, 30.0, 33.0, 52.0, 92.0].contains(&code)
                || (38.0..39.0).contains(&code)
                || (73.0..90.0).contains(&code)
        })
    }
}

/// Returns true if a line has words of a macro language: O-words, statements, parameters or
/// expressions. `O1000` alone is a program number.
pub(super) fn has_macros(line: &str) -> bool {
    let words = line.split([';']).next().unwrap_or_default();
    let mut depth = 0;
    let bare: String = words
        .chars()
        .filter(|&c| {
            depth += i32::from(c == '(');
            let shown = depth == 0;
            depth -= i32::from(c == ')');
            shown
        })
        .collect();
    let bare = bare.trim().to_ascii_lowercase();
    let bare = bare.trim_start_matches('/').trim_start();
    let is_number = |text: &str| text.trim().chars().all(|c| c.is_ascii_digit());
    let words = bare.strip_prefix('n').map_or(bare, |rest| {
        rest.trim_start_matches(|c: char| c.is_ascii_digit() || c == ' ')
    });
    let has_o_word = words.strip_prefix('o').is_some_and(|rest| !is_number(rest));
    has_o_word || bare.contains(['#', '[']) || calls_or_jumps(words)
}

/// Returns true if the words contain M97 to M99, G65 or GOTO.
fn calls_or_jumps(words: &str) -> bool {
    let compact: String = words.chars().filter(|c| !c.is_whitespace()).collect();
    let has_code = |code: &str| {
        compact.match_indices(code).any(|(at, _)| {
            !compact[at + code.len()..].starts_with(|c: char| c.is_ascii_digit() || c == '.')
        })
    };
    ["m97", "m98", "m99", "g65"]
        .iter()
        .any(|code| has_code(code))
        || compact.contains("goto")
}

/// Adds one word to a line, after its words.
pub(super) fn with_word(line: &str, word: &str) -> String {
    let words = line.find(['(', ';']).unwrap_or(line.len());
    let (before, behind) = line.split_at(words);
    let gap = if behind.is_empty() { "" } else { " " };
    format!("{} {word}{gap}{behind}", before.trim_end())
}

/// Replaces `G4` and its time by other words of a dwell. A line that has more than letters and
/// numbers, or no `G4`, stays as it is.
pub(super) fn with_dwell(line: &str, dwell: &str) -> String {
    let Some(parsed) = PartedLine::parse(line) else {
        return line.to_owned();
    };
    let is_code = |(letter, number): &(char, String)| {
        *letter == 'G' && number.parse::<f64>().is_ok_and(|code| code == 4.0)
    };
    let Some(at) = parsed.words.iter().position(is_code) else {
        return line.to_owned();
    };
    let is_time = |letter: char| "PXU".contains(letter) || letter == 'S' && !parsed.has("PXU");
    let mut words = Vec::new();
    for (n, (letter, number)) in parsed.words.iter().enumerate() {
        if n == at {
            words.push(dwell.to_owned());
        } else if !is_time(*letter) {
            words.push(format!("{letter}{number}"));
        }
    }
    words.extend(parsed.comments);
    words.join(" ")
}

/// Replaces each F word of a line; comments stay.
pub(super) fn with_feed(line: &str, feed: &str) -> String {
    let (mut text, mut rest) = (String::new(), line);
    while let Some(first) = rest.chars().next() {
        let end = match first {
            '(' => rest.find(')').map_or(rest.len(), |end| end + 1),
            ';' => rest.len(),
            'f' | 'F' => {
                let value = rest[1..].trim_start();
                let is_number = |c: char| c.is_ascii_digit() || c == '.';
                let digits = value.find(|c: char| !is_number(c)).unwrap_or(value.len());
                if digits > 0 {
                    text.push('F');
                    text.push_str(feed);
                    rest = &value[digits..];
                    continue;
                }
                1
            }
            _ => first.len_utf8(),
        };
        text.push_str(&rest[..end]);
        rest = &rest[end..];
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_motion_is_taken_out_and_all_else_stays() {
        let line = PartedLine::parse("N10 G21G90 G1 x 10.5 Y-3 F500 S800 M3 (start)").unwrap();
        assert_eq!(line.without_motion(), "G21 G90 S800 M3");
        assert_eq!(line.comments, ["(start)"]);
        for gone in [
            "G2 X1 I1 P2",
            "G5.2 P1 L4",
            "X20 Y20 P1",
            "G5 X1 Y1 I0 J1 P0 Q-1",
            "G6.2 X1 R1 K0 P4 Q1",
        ] {
            assert_eq!(
                PartedLine::parse(gone).unwrap().without_motion(),
                "",
                "{gone}"
            );
        }
        assert!(PartedLine::parse("G28 Z0").unwrap().has_code());
        for refused in ["#1=5", "G1 X[1+2]", "/G1 X1", "o100 call", "G1 X#5", "%"] {
            assert_eq!(PartedLine::parse(refused), None, "{refused}");
        }
    }

    #[test]
    fn words_of_a_macro_language_are_seen_and_comments_are_not() {
        for line in [
            "o100 sub",
            "N5 o<part> call",
            "#1=5",
            "G1 X[1+2]",
            "M98 P100",
            "n10 g65 p9000",
            "M99",
            "IF [#1 GT 2] GOTO 5",
        ] {
            assert!(has_macros(line), "{line}");
        }
        for line in [
            "O1000",
            "G1 X5 (o100 call #1)",
            "M9",
            "G1 X1 ; [",
            "%",
            "",
            "N10 G54 M8",
        ] {
            assert!(!has_macros(line), "{line}");
        }
    }

    #[test]
    fn a_feed_is_replaced_and_comments_stay() {
        assert_eq!(
            with_feed("N1 G1 X1 F 300.5 (F3) Y2 ; F1", "50.0"),
            "N1 G1 X1 F50.0 (F3) Y2 ; F1"
        );
        assert_eq!(with_feed("g1x1f300", "50.0"), "g1x1F50.0");
        assert_eq!(with_feed("G1 F#1", "50.0"), "G1 F#1");
        assert_eq!(
            with_dwell("N5 G04 X2.5 M8 (chips)", "G4 P2.5"),
            "N5 G4 P2.5 M8 (chips)"
        );
        assert_eq!(with_dwell("G4 S2", "G4 P2.0"), "G4 P2.0");
        assert_eq!(with_dwell("G4 P[1+1]", "G4 P2.0"), "G4 P[1+1]");
        assert_eq!(with_word("G1 X1 (to)", "F50.0"), "G1 X1 F50.0 (to)");
        assert_eq!(with_word("X1", "F50.0"), "X1 F50.0");
        let frame = |line: &str| PartedLine::parse(line).unwrap().frame_words();
        assert_eq!(frame("N5 G0 G55 X1 Y2").as_deref(), Some("G55"));
        assert_eq!(frame("G43 H2 Z5 M3").as_deref(), Some("G43 H2"));
        assert_eq!(
            frame("G10 L2 P1 X5 (here)").as_deref(),
            Some("G10 L2 P1 X5")
        );
        assert_eq!(frame("G1 X5"), None);
    }
}
