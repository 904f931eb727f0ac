//! How a text table is written: what stands between its columns, which sign its decimal point is,
//! what its columns are called.

use std::cmp::Ordering;

use super::names::{Quantity, is_known_unit, understand};
use super::scopes::{ScopeChannel, ScopeHeader};
use super::{LogFormat, decimal};

/// Notation of a text table.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct TableDialect {
    /// Character between columns; a space is any number of spaces and tabs.
    pub(super) delimiter: u8,
    /// Decimal point.
    pub(super) point: u8,
    /// Columns.
    pub(super) columns: usize,
    /// Names of the columns, where there are any.
    pub(super) names: Vec<String>,
    /// Their units, where they have a line of their own.
    pub(super) units: Vec<String>,
    /// Line of the first row, from 1.
    pub(super) first_line: u64,
    /// Time between rows, s, where a line before them says so.
    pub(super) sample_time_s: Option<f64>,
    /// Line before the rows that states the unit of the positions, from 1, and the unit.
    pub(super) position_unit: Option<(u64, String)>,
    /// True where names and numbers alternate in the rows, as `halscope` wrote them before LinuxCNC
    /// 2.9.
    pub(super) names_in_rows: bool,
    /// The scope that wrote the table, and what its header says of each column; none of any other
    /// table.
    pub(super) scope: Option<(LogFormat, Vec<ScopeChannel>)>,
}

/// Lines that are looked at.
const LINES: usize = 400;
/// Possible delimiters of columns, the likelier first; where two do equally well, the first is
/// used.
const DELIMITERS: [u8; 5] = [b'\t', b';', b',', b'|', b' '];

/// First words of a `halscope` file, in lower case.
const SAMPLING_PERIOD: &str = "sampling period is";

/// The word with which `halsampler` says that samples were lost.
pub(super) const OVERRUN: &[u8] = b"overrun";

/// Kind of a line that is no row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum LineKind {
    Blank,
    Comment,
    Overrun,
    Other,
}

impl LineKind {
    pub(super) fn of(line: &[u8], delimiter: u8) -> Self {
        let line = line.trim_ascii_start();
        match line {
            [] => Self::Blank,
            [b'#' | b'%' | b'!', ..] | [b'/', b'/', ..] => Self::Comment,
            [b';', ..] if delimiter != b';' => Self::Comment,
            _ if line.starts_with(OVERRUN) => Self::Overrun,
            _ => Self::Other,
        }
    }
}

/// Fields of a line.
pub(super) fn fields(line: &[u8], delimiter: u8) -> impl Iterator<Item = &[u8]> {
    // One of the two is empty.
    let (blank, other) = if delimiter == b' ' {
        (line, None)
    } else {
        ([].as_slice(), Some(line))
    };
    let blank = blank
        .split(|byte| byte.is_ascii_whitespace())
        .filter(|field| !field.is_empty());
    let other = other
        .into_iter()
        .flat_map(move |line| line.split(move |&byte| byte == delimiter));
    blank.chain(other)
}

impl TableDialect {
    /// The dialect of a text by its first lines; none where they hold no rows of numbers.
    pub(super) fn of(head: &[u8]) -> Option<Self> {
        let head = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head);
        let whole = head
            .iter()
            .rposition(|&byte| byte == b'\n')
            .map_or(head, |end| &head[..end]);
        let lines: Vec<&[u8]> = whole
            .split(|&byte| byte == b'\n')
            .take(LINES)
            .map(|line| line.strip_suffix(b"\r").unwrap_or(line))
            .collect();
        let mut best: Option<(usize, Self)> = None;
        for delimiter in DELIMITERS {
            for point in [b'.', b','] {
                if delimiter == point {
                    continue;
                }
                if let Some((score, dialect)) = Self::with(&lines, delimiter, point)
                    && best.as_ref().is_none_or(|(most, _)| score > *most)
                {
                    best = Some((score, dialect));
                }
            }
        }
        best.map(|(_, dialect)| dialect)
    }

    /// The dialect of an export with this header. Its decimal point is the one by which more of the
    /// first rows are numbers.
    pub(super) fn of_scope(header: ScopeHeader, head: &[u8]) -> Self {
        let ScopeHeader {
            format,
            delimiter,
            channels,
            first_line,
            sample_time_s,
        } = header;
        let numbers = |point: u8| -> usize {
            let rows = head
                .split(|&byte| byte == b'\n')
                .skip(first_line as usize - 1)
                .take(LINES);
            rows.map(|row| count(row.strip_suffix(b"\r").unwrap_or(row), delimiter, point).1)
                .sum()
        };
        let has_comma = delimiter != b',' && numbers(b',') > numbers(b'.');
        Self {
            delimiter,
            point: if has_comma { b',' } else { b'.' },
            columns: channels.len(),
            names: channels
                .iter()
                .map(|channel| channel.name.clone())
                .collect(),
            units: channels
                .iter()
                .map(|channel| channel.unit.clone())
                .collect(),
            first_line,
            sample_time_s,
            position_unit: None,
            names_in_rows: false,
            scope: Some((format, channels)),
        }
    }

    /// The dialect with this delimiter and point, and how many numbers it finds.
    fn with(lines: &[&[u8]], delimiter: u8, point: u8) -> Option<(usize, Self)> {
        // Fields and numbers of each line; comments have none.
        let counts: Vec<(usize, usize)> = lines
            .iter()
            .map(|line| match LineKind::of(line, delimiter) {
                LineKind::Other => count(line, delimiter, point),
                _ => (0, 0),
            })
            .collect();
        let is_row = |&(fields, numbers): &(usize, usize)| numbers >= 2 && 2 * numbers >= fields;
        let columns = usual(
            counts
                .iter()
                .filter(|count| is_row(count))
                .map(|count| count.0),
        )?;
        let rows = || {
            counts
                .iter()
                .enumerate()
                .filter(|(_, count)| count.0 == columns && is_row(count))
        };
        let score: usize = rows().map(|(_, count)| count.1).sum();
        let (first, _) = rows().next()?;
        let before = &lines[..first];
        let (mut names, units) = header(before, delimiter, columns);
        let labels = labels(lines[first], delimiter, point);
        let names_in_rows = !labels.is_empty();
        if names_in_rows {
            names = labels;
        }
        let sample_time_s = before
            .iter()
            .find_map(|line| sample_time_s(&String::from_utf8_lossy(line)));
        let position_unit = before.iter().zip(1..).find_map(|(line, number)| {
            Some((
                number,
                stated(&String::from_utf8_lossy(line), &["unit", "position_unit"])?,
            ))
        });
        let first_line = first as u64 + 1;
        let dialect = Self {
            delimiter,
            point,
            columns,
            names,
            units,
            first_line,
            sample_time_s,
            position_unit,
            names_in_rows,
            scope: None,
        };
        Some((score, dialect))
    }
}

/// Fields of a line, and how many are numbers.
fn count(line: &[u8], delimiter: u8, point: u8) -> (usize, usize) {
    let (mut all, mut numbers) = (0, 0);
    for field in fields(line, delimiter) {
        all += 1;
        // An empty field says nothing of the dialect.
        numbers += usize::from(
            !decimal::trimmed(field).is_empty() && decimal::parse(field, point).is_some(),
        );
    }
    (all, numbers)
}

/// Names in a row of names and numbers by turns, each for the number behind it; none in any other
/// row.
fn labels(row: &[u8], delimiter: u8, point: u8) -> Vec<String> {
    let mut names = Vec::new();
    for (number, field) in fields(row, delimiter).enumerate() {
        let is_number = decimal::parse(field, point).is_some_and(f64::is_finite);
        if is_number != (number % 2 == 1) {
            return Vec::new();
        }
        match names.last() {
            Some(label) if is_number => names.push(String::clone(label)),
            _ => names.push(String::from_utf8_lossy(field).into_owned()),
        }
    }
    // The column of the number keeps the name; the column of the name itself stays unnamed.
    for pair in names.chunks_exact_mut(2) {
        pair[0].clear();
    }
    if names.len() % 2 == 0 {
        names
    } else {
        Vec::new()
    }
}

/// Time between samples, s, in a line such as `# Sampling period is 1000000 ns` or `# sample_time_s
/// = 0.001`.
fn sample_time_s(line: &str) -> Option<f64> {
    let number = |text: &str| text.split_whitespace().next()?.parse::<f64>().ok();
    let text = line.trim_start_matches(BEFORE_TEXT).to_lowercase();
    let value = match text.strip_prefix(SAMPLING_PERIOD) {
        Some(rest) => 1e-9 * number(rest)?,
        None => number(&stated(line, &["sample_time_s", "period_s"])?)?,
    };
    Some(value).filter(|value| value.is_finite() && *value > 0.0)
}

/// Signs in front of the text of a comment.
const BEFORE_TEXT: [char; 6] = ['#', '%', '!', '/', ';', ' '];

/// Returns the value that a line such as `# unit = inch` states for one of these names, in lower
/// case.
fn stated(line: &str, names: &[&str]) -> Option<String> {
    let text = line.trim_start_matches(BEFORE_TEXT).to_lowercase();
    let (name, value) = text.split_once('=')?;
    names
        .contains(&name.trim())
        .then(|| value.trim().to_owned())
}

/// The most frequent number.
fn usual(counts: impl Iterator<Item = usize>) -> Option<usize> {
    let mut seen = std::collections::BTreeMap::new();
    for count in counts {
        *seen.entry(count).or_insert(0_usize) += 1;
    }
    seen.into_iter()
        .max_by_key(|&(_, times)| times)
        .map(|(count, _)| count)
}

/// Names and units of the columns in the lines before the first row: the last lines with as many
/// fields, perhaps behind a comment sign.
fn header(before: &[&[u8]], delimiter: u8, columns: usize) -> (Vec<String>, Vec<String>) {
    let mut found = before.iter().rev().filter_map(|line| {
        let line = match LineKind::of(line, delimiter) {
            LineKind::Comment => {
                let text = line.trim_ascii_start();
                &text[text
                    .iter()
                    .position(|byte| !b"#%!/; ".contains(byte))
                    .unwrap_or(text.len())..]
            }
            LineKind::Other => line,
            LineKind::Blank | LineKind::Overrun => return None,
        };
        let mut words: Vec<String> = fields(line, delimiter)
            .map(|field| String::from_utf8_lossy(decimal::trimmed(field)).into_owned())
            .collect();
        // The pins of a sampler, without the counter that `halsampler -t` puts in front.
        if words.len() + 1 == columns
            && words.iter().all(|word| word.contains('.'))
            && delimiter == b' '
        {
            words.insert(0, "n".to_owned());
        }
        let is_header =
            words.len() == columns && words.iter().any(|word| word.contains(char::is_alphabetic));
        is_header.then_some(words)
    });
    let (last, above) = (found.next().unwrap_or_default(), found.next());
    match above {
        Some(names) if are_units(&last, &names) => (names, last),
        _ => (last, Vec::new()),
    }
}

/// Returns true if words below others are their units: they say less about the columns, and are
/// short, in brackets, or known.
fn are_units(words: &[String], above: &[String]) -> bool {
    let bare = |word: &str| word.trim_matches(['[', ']', '(', ')', ' ']).to_owned();
    let is_short = |word: &String| bare(word).chars().count() <= 4 || bare(word).len() < word.len();
    let (is_known, are_short) = (
        words.iter().any(|word| is_known_unit(&bare(word))),
        words.iter().all(is_short),
    );
    let says = |words: &[String]| {
        let is_role = |word: &&String| {
            !matches!(
                understand(word).quantity,
                Quantity::Other | Quantity::Velocity
            )
        };
        words.iter().filter(is_role).count()
    };
    match says(words).cmp(&says(above)) {
        Ordering::Less => is_known || are_short,
        Ordering::Equal => is_known && are_short,
        Ordering::Greater => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dialect(text: &str) -> TableDialect {
        TableDialect::of(text.as_bytes()).unwrap_or_else(|| panic!("no dialect: {text}"))
    }

    #[test]
    fn delimiters_and_points_are_distinguished() {
        for (text, delimiter, point, columns) in [
            ("0\t1\t2\n1\t2\t3\n", b'\t', b'.', 3),
            ("0,1,2\n1,2.5,3\n", b',', b'.', 3),
            ("0, 1, 2\n1, 2.5, 3\n", b',', b'.', 3),
            ("0;1,5;2\n1;2,5;3\n", b';', b',', 3),
            ("0\t1,5\n1\t2,5\n", b'\t', b',', 2),
            ("0 1.5  2\n 1 2.5 3\n", b' ', b'.', 3),
            ("0 1,5 2\n1 2,5 3\n", b' ', b',', 3),
            ("0|1|2\n1|2|3\n", b'|', b'.', 3),
            ("\u{feff}0;1\r\n1;2\r\n", b';', b'.', 2),
            ("0,1,,a\n1,2,,b\n", b',', b'.', 4),
        ] {
            let found = dialect(text);
            assert_eq!(
                (found.delimiter, found.point, found.columns),
                (delimiter, point, columns),
                "{text:?}"
            );
            assert_eq!((found.first_line, found.names.len()), (1, 0), "{text:?}");
        }
        for text in ["", "\n\n", "a b c\n", "1\n2\n3\n", "# 1 2 3\n"] {
            assert_eq!(TableDialect::of(text.as_bytes()), None, "{text:?}");
        }
    }

    #[test]
    fn names_stand_above_the_rows_with_units_and_comments_or_without() {
        let named = dialect("recorded by hand\nn,x,xfb\n0,1,2\n1,2,3\n");
        assert_eq!(
            (named.names, named.first_line),
            (["n", "x", "xfb"].map(str::to_owned).to_vec(), 3)
        );
        let with_units = dialect("t;x cmd;x act\n[s];[mm];[mm]\n0;1,0;2\n1;2,5;3\n");
        assert_eq!(with_units.names[1], "x cmd");
        assert_eq!(with_units.units, ["[s]", "[mm]", "[mm]"]);
        let pins =
            dialect("# unit = inch\n# joint.0.motor-pos-cmd joint.0.motor-pos-fb\n7 1 2\n8 2 3\n");
        assert_eq!(
            pins.names,
            ["n", "joint.0.motor-pos-cmd", "joint.0.motor-pos-fb"]
        );
        assert_eq!(pins.position_unit, Some((1, "inch".to_owned())));
        let commented = dialect("# sample_time_s = 0.001\n# n x.cmd x.act\n0 1 2\n1 2 3\n");
        assert_eq!(commented.names, ["n", "x.cmd", "x.act"]);
        assert_eq!(commented.sample_time_s, Some(0.001));
    }

    #[test]
    fn rows_of_names_and_numbers_are_taken_apart() {
        let found = dialect(
            "Sampling period is 2000000 nSec \n\nx-cmd +1.5 x-fb +1.4 \nx-cmd +1.6 x-fb +1.5 \n",
        );
        assert_eq!(found.names, ["", "x-cmd", "", "x-fb"]);
        assert!(found.names_in_rows);
        assert_eq!((found.sample_time_s, found.columns), (Some(0.002), 4));
    }
}
