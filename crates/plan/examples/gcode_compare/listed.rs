//! Differences from LinuxCNC that are intended: the rows of docs/gcode-differences.md that a random
//! program can meet.
//!
//! A row states the reported difference and the features of the program at that place, so that it
//! does not cover another difference nearby. `crates/plan/tests/oracle_linuxcnc_listed.rs` has a
//! program for every row.

use std::path::Path;

use crate::cut::cut_mm;
use crate::linuxcnc::{Theirs, Totals, compare, flat_lines, ours};

/// Result of the comparison for one program.
pub(crate) enum Verdict {
    /// LinuxCNC's module crashed or hung.
    Unknown,
    BothRefuse,
    Same,
    Differ(String),
}

/// Reads the program, and compares the result with LinuxCNC's.
pub(crate) fn judge(path: &Path, text: &str, theirs: &Theirs, totals: &mut Totals) -> Verdict {
    if !theirs.complete {
        return Verdict::Unknown;
    }
    let (motions, fault) = ours(path);
    let difference = match (&theirs.refused, fault) {
        (Some(_), Some(_)) => return Verdict::BothRefuse,
        (None, Some(fault)) => Some(format!("only we refuse: {fault}")),
        (Some(refused), None) => Some(format!("only they refuse: {refused}")),
        (None, None) => compare(text, &motions, theirs, totals),
    };
    difference.map_or(Verdict::Same, Verdict::Differ)
}

/// Returns the G- and M-codes of a line or a program, in order, without leading zeros.
pub(crate) fn codes_of(text: &str) -> Vec<String> {
    let upper = text.to_ascii_uppercase();
    let code = |(at, letter): (usize, &str)| {
        let number: String = upper[at + 1..]
            .chars()
            .take_while(|c| c.is_ascii_digit() || *c == '.')
            .collect();
        number
            .parse::<f64>()
            .ok()
            .map(|number| format!("{letter}{number}"))
    };
    upper.match_indices(['G', 'M']).filter_map(code).collect()
}

/// A difference and its program.
struct Case<'a> {
    text: &'a str,
    theirs: &'a Theirs,
    /// Lines of the program, in capitals.
    lines: Vec<String>,
    /// Index of the line of the difference, from 0.
    at: usize,
}

const PLANES: &[&str] = &["G17", "G18", "G19"];
const MOTIONS: &[&str] = &[
    "G0", "G1", "G2", "G3", "G5", "G5.1", "G5.2", "G5.3", "G33", "G33.1", "G38.2", "G38.3",
    "G38.4", "G38.5", "G70", "G71", "G71.1", "G71.2", "G72", "G72.1", "G72.2", "G73", "G74", "G76",
    "G80", "G81", "G82", "G83", "G84", "G85", "G86", "G87", "G88", "G89",
];

impl<'a> Case<'a> {
    /// Returns the case at the line that `difference` names. If LinuxCNC can read a line but not
    /// execute it, it names the line after it: `earlier` is then 1.
    fn new(text: &'a str, theirs: &'a Theirs, difference: &str, earlier: usize) -> Option<Self> {
        let number = difference.split_once("line ")?.1;
        let number: usize = number
            .chars()
            .take_while(char::is_ascii_digit)
            .collect::<String>()
            .parse()
            .ok()?;
        let lines: Vec<String> = text.lines().map(str::to_ascii_uppercase).collect();
        let at = number
            .checked_sub(1 + earlier)
            .filter(|at| *at < lines.len())?;
        Some(Self {
            text,
            theirs,
            lines,
            at,
        })
    }

    fn line(&self) -> &str {
        &self.lines[self.at]
    }

    /// Returns true if the line has one of the codes.
    fn has(&self, codes: &[&str]) -> bool {
        has(self.line(), codes)
    }

    /// Returns true if the line has a word with this letter; O-words do not count.
    fn has_word(&self, letter: char) -> bool {
        !self.line().starts_with('O') && self.line().contains(letter)
    }

    /// Returns the last of `codes` up to and including this line: the index of its line and the
    /// code in the spelling of [`codes_of`]. `None` if no line has one.
    fn last(&self, codes: &[&str]) -> Option<(usize, String)> {
        self.last_before(self.at + 1, codes)
    }

    fn last_before(&self, end: usize, codes: &[&str]) -> Option<(usize, String)> {
        let in_line = |at: usize| {
            codes_of(&self.lines[at])
                .into_iter()
                .rfind(|code| codes.contains(&code.as_str()))
        };
        (0..end).rev().find_map(|at| Some((at, in_line(at)?)))
    }

    fn is_active(&self, among: &[&str], codes: &[&str]) -> bool {
        self.last(among)
            .is_some_and(|(_, code)| codes.contains(&code.as_str()))
    }
}

fn has(line: &str, codes: &[&str]) -> bool {
    codes_of(line)
        .iter()
        .any(|code| codes.contains(&code.as_str()))
}

/// A row: start of the difference, a part of its text, test of the program, and row of the table.
struct Row {
    who: &'static str,
    says: &'static str,
    fits: fn(&Case) -> bool,
    what: &'static str,
}

const WE: &str = "only we refuse";
const THEY: &str = "only they refuse";
/// Depth above which a cut into the contour counts, mm: far above rounding.
const CUT_MM: f64 = 1e-3;
/// Both read the program, and a motion differs.
const MOTION: &str = "motion";

const fn row(
    who: &'static str,
    says: &'static str,
    fits: fn(&Case) -> bool,
    what: &'static str,
) -> Row {
    Row {
        who,
        says,
        fits,
        what,
    }
}

const ROWS: &[Row] = &[
    row(
        THEY,
        "Two m codes used from same modal group",
        free_pair,
        "M-codes on one line that LinuxCNC counts to one group",
    ),
    row(
        THEY,
        "L word with no G10",
        |case| case.has_word('L') && case.is_active(MOTIONS, &["G74"]),
        "L with G74",
    ),
    row(
        WE,
        "does not fit into the inner corner",
        |case| cut_mm(case.text, case.theirs, case.at as u32 + 1) > CUT_MM,
        "an inner corner where LinuxCNC cuts into the contour",
    ),
    row(
        WE,
        "does not fit into the inner corner",
        behind_entry,
        "an entry into compensation that meets the contour beyond its first motion",
    ),
    row(
        THEY,
        "cannot be reached by the tool without gouging",
        // LinuxCNC may hold a motion back, with another line in between: the flat corner is at this
        // line or at the line before.
        |case| (case.at..case.at + 2).any(|line| flat_lines(case.text).contains(&(line as u32))),
        "a flat corner of compensation that LinuxCNC refuses by rounding",
    ),
    row(
        WE,
        "G76 needs the plane G18",
        |case| case.has(&["G76"]),
        "G76 outside G18",
    ),
    row(
        WE,
        "inside the profile of a lathe cycle",
        |case| case.has(&["G41", "G41.1", "G42", "G42.1"]),
        "codes in the profile of a lathe cycle",
    ),
    row(
        WE,
        "cannot be used:",
        |case| case.has(&["G70", "G71", "G71.1", "G71.2", "G72", "G72.1", "G72.2"]),
        "codes in the profile of a lathe cycle",
    ),
    row(
        WE,
        "is empty",
        |case| case.has(&["G70", "G71", "G71.1", "G71.2", "G72", "G72.1", "G72.2"]),
        "an empty profile of a lathe cycle",
    ),
    row(
        THEY,
        "Cannot intersect parallel lines",
        |case| case.has(&["G70", "G71", "G71.1", "G71.2", "G72", "G72.1", "G72.2"]),
        "lines of a profile that go straight on",
    ),
    row(
        MOTION,
        "another",
        level_entry,
        "the side of D where a profile begins as deep as its cycle starts",
    ),
    row(
        WE,
        "the curve of G5.2 is not complete",
        |case| case.lines.iter().any(|line| has(line, &["G5.2"])),
        "a curve begun by G5.2 and left without G5.3",
    ),
    row(
        WE,
        "needs the XY plane G17",
        |case| case.has(&["G5.2", "G5.3"]) && !case.is_active(PLANES, &["G17"]),
        "G5.2 and G5.3 outside G17",
    ),
    row(
        WE,
        "no other words beside M98",
        |case| {
            case.line()
                .trim_start_matches(|c: char| c == 'N' || c.is_ascii_digit() || c == ' ')
                .starts_with("M98")
        },
        "words behind M98 on its line",
    ),
    row(
        WE,
        "needs its weight P",
        |case| case.has(&["G5.2"]) && !case.has_word('P'),
        "G5.2 without P",
    ),
    row(
        MOTION,
        "another",
        unit_under_offset,
        "G28, G30, G43.1, G49 and G53 under G43.1 in another unit",
    ),
    row(
        THEY,
        "zero feed rate",
        feed_forgotten,
        "G94 where it is active already",
    ),
    row(
        WE,
        "already has a word P",
        |case| case.is_active(MOTIONS, &["G5"]),
        "P twice on a line of G5",
    ),
    row(
        WE,
        "O9000 has no M99",
        |case| !case.lines.iter().any(|line| has(line, &["M99"])),
        "a subroutine without its M99",
    ),
    row(
        THEY,
        "Nested subroutine definition",
        |case| case.line().starts_with('O') && case.line().split_whitespace().count() == 1,
        "an O-word without its keyword in a subroutine",
    ),
    row(
        THEY,
        "no matching while/do label",
        |case| case.line().contains(" BREAK") || case.line().contains(" CONTINUE"),
        "break and continue in a repeat",
    ),
    row(
        MOTION,
        "theirs",
        |case| {
            let loops = [" REPEAT", " BREAK"];
            has_flow(case, " CONTINUE")
                && has_flow(case, " DO")
                && loops.iter().any(|word| has_flow(case, word))
        },
        "a repeat or a break behind a do that was continued",
    ),
    row(
        MOTION,
        "theirs",
        |case| has_flow(case, " BREAK") && has_flow(case, " DO"),
        "a do behind a while that was left by break",
    ),
    row(
        WE,
        "line",
        in_do_behind_break,
        "a later round of a do behind a break",
    ),
    row(
        THEY,
        "Unknown g code used",
        |case| case.has(&["G50"]),
        "G50 without words",
    ),
    row(
        THEY,
        "Unexpected character after O-word",
        |case| case.line().contains(" ELSEIF "),
        "words behind an elseif that is not carried out",
    ),
    row(
        MOTION,
        "another",
        |case| !case.is_active(PLANES, &["G17"]) && case.is_active(MOTIONS, &["G74", "G84"]),
        "G84 and G74 outside G17",
    ),
    row(
        WE,
        "must end elsewhere than it starts",
        |case| case.has_word('R'),
        "an arc with R to the place where it is, but for rounding",
    ),
    row(
        MOTION,
        "another",
        of_multiple,
        "MOD of a multiple, by rounding",
    ),
    row(
        MOTION,
        "another",
        value_of_definition,
        "the value of a subroutine that is only defined",
    ),
    row(
        MOTION,
        "another",
        turned_under_g92,
        "rotation of the active system under G92",
    ),
    row(
        MOTION,
        "off the spline",
        |case| {
            let begin = case.last_before(case.at, MOTIONS);
            begin.is_some_and(|(at, code)| {
                ["G2", "G3"].contains(&code.as_str()) && case.lines[at].contains('Z')
            })
        },
        "points of splines where LinuxCNC's preview has not noticed Z of an arc",
    ),
    row(
        WE,
        "no code such as G0 or G1",
        |case| case.is_active(MOTIONS, &["G5", "G5.1"]) && !case.has(&["G5", "G5.1"]),
        "axis words alone behind G5 and G5.1",
    ),
    row(
        THEY,
        "with L word, but plane",
        |case| case.has_word('L') && case.has(&["G41.1", "G42.1"]),
        "L with G41.1 and G42.1",
    ),
    row(
        THEY,
        "I J words not allowed with G10 L2",
        |case| case.has(&["G10"]),
        "I and J with G10 L2",
    ),
    row(
        THEY,
        "Unclosed comment",
        |case| case.line().contains("(OPEN"),
        "a comment that is open in a line that is not carried out",
    ),
    row(
        WE,
        "needs its word Q",
        |case| case.has(&["M67", "M68"]) && !case.has_word('Q'),
        "M67 and M68 without Q",
    ),
];

/// Returns true if any line has an O-word with this keyword. The line of the motion may be in a
/// subroutine before that line.
fn has_flow(case: &Case, keyword: &str) -> bool {
    case.lines
        .iter()
        .any(|line| line.starts_with('O') && line.contains(keyword))
}

/// Returns true if the line is in a do loop that LinuxCNC may have left: a break stands before the
/// end of the loop.
fn in_do_behind_break(case: &Case) -> bool {
    let ends_behind = |label: &str| {
        let end = case.lines[case.at..]
            .iter()
            .position(|line| line.starts_with(&format!("{label} WHILE")));
        end.is_some_and(|end| {
            case.lines[..case.at + end]
                .iter()
                .any(|line| line.contains(" BREAK"))
        })
    };
    case.lines[..case.at].iter().any(|line| {
        line.split_once(" DO")
            .is_some_and(|(label, _)| ends_behind(label))
    })
}

/// Returns true if the first motion of a profile has no word of the depth axis, so that it does not
/// go down from the start of its cycle with D.
fn level_entry(case: &Case) -> bool {
    let depth = if case.has(&["G71", "G71.1", "G71.2"]) {
        'X'
    } else {
        'Z'
    };
    let begin = case.lines.iter().position(|line| line.ends_with(" SUB"));
    let first = begin.and_then(|begin| {
        case.lines[begin..]
            .iter()
            .find(|line| line.contains(['X', 'Z']))
    });
    case.has(&["G71", "G71.1", "G71.2", "G72", "G72.1", "G72.2"])
        && case.has_word('D')
        && first.is_some_and(|line| !line.contains(depth))
}

/// Returns true if the line has M-codes of two groups of this reader that are one group in
/// LinuxCNC.
fn free_pair(case: &Case) -> bool {
    let codes = codes_of(case.line());
    let one_of = |group: &[&str]| codes.iter().any(|code| group.contains(&code.as_str()));
    one_of(&["M7"]) && one_of(&["M8"])
        || one_of(&["M70", "M71", "M72", "M73"]) && one_of(&["M3", "M4", "M5", "M19"])
        || one_of(&["M48", "M49"]) && one_of(&["M50", "M51", "M52", "M53"])
        || one_of(&["M5"]) && one_of(&["M19"])
}

/// Returns true if the line is the one after the entry into compensation.
fn behind_entry(case: &Case) -> bool {
    let Some((begin, _)) = case.last(&["G41", "G41.1", "G42", "G42.1"]) else {
        return false;
    };
    case.lines[begin..case.at]
        .iter()
        .filter(|line| line.contains(['X', 'Y']))
        .count()
        == 1
}

/// Returns true if G43.1 is followed by a change of the unit, and this by G28, G30, G53 or another
/// tool length.
fn unit_under_offset(case: &Case) -> bool {
    let leaving = ["G28", "G30", "G43", "G43.1", "G43.2", "G49", "G53"];
    let behind =
        |from: usize, codes: &[&str]| (from + 1..=case.at).find(|at| has(&case.lines[*at], codes));
    let unit = behind(0, &["G43.1"]).and_then(|offset| behind(offset, &["G20", "G21", "M72"]));
    unit.is_some_and(|unit| behind(unit, &leaving).is_some())
}

/// Returns true if G94 was written while it was active, and no F since.
fn feed_forgotten(case: &Case) -> bool {
    let modes = ["G93", "G94", "G95"];
    let Some((last, code)) = case.last(&modes) else {
        return false;
    };
    let before = case.last_before(last, &modes);
    code == "G94"
        && before.is_some_and(|(_, code)| code == "G94")
        && !case.lines[last..=case.at]
            .iter()
            .any(|line| line.contains('F'))
}

/// Returns true if MOD is in this line or in one of the two before it, whose values the motion
/// uses.
fn of_multiple(case: &Case) -> bool {
    case.lines[case.at.saturating_sub(2)..=case.at]
        .iter()
        .any(|line| line.contains(" MOD "))
}

/// Returns true if the value of a subroutine was used that is defined before and called nowhere.
fn value_of_definition(case: &Case) -> bool {
    let Some(used) = (0..=case.at).rfind(|at| case.lines[*at].contains("#<_VALUE>")) else {
        return false;
    };
    let label = |line: &String| {
        line.split_once(" ENDSUB [")
            .map(|(label, _)| label.to_owned())
    };
    let defined = case.lines[..used].iter().rev().find_map(label);
    defined.is_some_and(|label| {
        !case
            .lines
            .iter()
            .any(|line| line.starts_with(&format!("{label} CALL ")))
    })
}

/// Returns true if the active coordinate system was rotated while G92 or G52 was in effect.
fn turned_under_g92(case: &Case) -> bool {
    let shifts = ["G52", "G92", "G92.1", "G92.2", "G92.3"];
    (0..=case.at).any(|at| {
        let line = &case.lines[at];
        has(line, &["G10"])
            && line.contains("L2")
            && line.contains('R')
            && case
                .last_before(at, &shifts)
                .is_some_and(|(_, code)| !["G92.1", "G92.2"].contains(&code.as_str()))
    })
}

/// Returns the name of the row that a difference belongs to.
pub(crate) fn find(text: &str, theirs: &Theirs, difference: &str) -> Option<&'static str> {
    let fits = |row: &Row| {
        let earlier = if row.who == THEY { 0..2 } else { 0..1 };
        let mut cases = earlier.filter_map(|earlier| Case::new(text, theirs, difference, earlier));
        difference.starts_with(row.who)
            && difference.contains(row.says)
            && cases.any(|case| (row.fits)(&case))
    };
    ROWS.iter().find(|row| fits(row)).map(|row| row.what)
}

/// Returns the names of the rows.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    ROWS.iter().map(|row| row.what)
}
