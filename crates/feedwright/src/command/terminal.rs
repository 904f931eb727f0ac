//! The terminal: how wide it is, and whether it shows colors.

use std::borrow::Cow;
use std::io::{self, IsTerminal};
use std::sync::OnceLock;

use clap::ValueEnum;
use feedwright_gcode::visible;

use crate::inches::in_inches;
use crate::report::PageUnits;

/// Width without a terminal, in columns.
const COLUMNS: usize = 80;
/// Longer lines are hard to read.
const MOST_COLUMNS: usize = 120;
/// Fewer are as good as none.
const LEAST_COLUMNS: usize = 40;

/// Setting of `--color`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorWhen {
    /// Color on a terminal, unless NO_COLOR is set or TERM is dumb
    #[default]
    Auto,
    /// Color everywhere, also in files and pipes
    Always,
    /// Never color
    Never,
}

/// Units of lengths and speeds that are printed.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum LengthUnits {
    /// mm, um, mm/min
    #[default]
    Metric,
    /// inches, thousandths of an inch, in/min
    Inch,
}

/// Value of `--units`.
static UNITS: OnceLock<LengthUnits> = OnceLock::new();

/// Takes what `--units` says.
pub(crate) fn set_units(units: LengthUnits) {
    // It is said once.
    let _ = UNITS.set(units);
}

/// Returns true if lengths are printed in inches.
pub(crate) fn is_inch() -> bool {
    UNITS.get() == Some(&LengthUnits::Inch)
}

/// Units of the page that is written.
pub(crate) fn page_units() -> PageUnits {
    if is_inch() {
        PageUnits::Inch
    } else {
        PageUnits::Metric
    }
}

/// Value of `--color`, set when the command line is read.
static COLOR: OnceLock<ColorWhen> = OnceLock::new();

/// Takes what `--color` says.
pub(crate) fn set_color(when: ColorWhen) {
    // It is said once.
    let _ = COLOR.set(when);
}

/// Returns true if messages on stderr are colored.
pub(crate) fn is_stderr_colored() -> bool {
    let wants_none = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    match COLOR.get().copied().unwrap_or_default() {
        ColorWhen::Auto => io::stderr().is_terminal() && !wants_none && !is_dumb(),
        ColorWhen::Always => true,
        ColorWhen::Never => false,
    }
}

/// Returns true if the terminal can only print: no colors, no cursor, no lines.
pub(crate) fn is_dumb() -> bool {
    std::env::var_os("TERM").is_some_and(|term| term == "dumb")
}

/// Returns true if stderr shows characters beyond ASCII. Files always do.
pub(crate) fn shows_unicode() -> bool {
    if is_dumb() {
        return false;
    }
    let named = ["LC_ALL", "LC_CTYPE", "LANG"]
        .iter()
        .filter_map(std::env::var_os)
        .find(|value| !value.is_empty());
    let is_utf8 = named.is_some_and(|name| {
        let name = name.to_string_lossy().to_ascii_lowercase();
        name.contains("utf-8") || name.contains("utf8")
    });
    is_utf8 || !io::stderr().is_terminal()
}

/// Columns of the terminal: the value of COLUMNS if it is a number, otherwise the actual width.
/// Returns 80 without a terminal or below [`LEAST_COLUMNS`].
pub(crate) fn columns() -> usize {
    let said = std::env::var("COLUMNS")
        .ok()
        .and_then(|columns| columns.parse().ok());
    let there = || terminal_size::terminal_size().map(|(width, _)| usize::from(width.0));
    let columns: usize = said.or_else(there).unwrap_or(COLUMNS);
    if columns < LEAST_COLUMNS {
        COLUMNS
    } else {
        columns
    }
}

/// Text that separates a library's reason from its remedy.
const REMEDY: &str = "\n  hint: ";

/// A message without what is hidden in it; the line of its remedy stays one.
pub(super) fn without_hidden(text: &str) -> String {
    text.split(REMEDY)
        .map(visible)
        .collect::<Vec<_>>()
        .join(REMEDY)
}

/// Columns of text that is read line by line.
pub(crate) fn text_columns() -> usize {
    columns().min(MOST_COLUMNS)
}

/// Wraps a text to the width of the terminal. Every line but the first begins with `indent` blanks.
/// A number and its unit stay together, and nothing is hidden.
pub fn wrapped(text: &str, indent: usize) -> String {
    let text = &with_units(&in_units(&without_hidden(text)));
    let blanks = " ".repeat(indent);
    let options = textwrap::Options::new(text_columns())
        .subsequent_indent(&blanks)
        .break_words(false)
        .word_splitter(textwrap::WordSplitter::NoHyphenation);
    textwrap::fill(text, options).replace(KEPT, " ")
}

/// Converts a text to the units of `--units`.
pub(crate) fn in_units(text: &str) -> Cow<'_, str> {
    if is_inch() {
        Cow::Owned(in_inches(text))
    } else {
        Cow::Borrowed(text)
    }
}

/// `text` with ASCII in place of the signs that the report uses.
pub(crate) fn ascii(text: &str) -> String {
    const SIGNS: [(char, &str); 7] = [
        ('µ', "u"),
        ('→', "->"),
        ('−', "-"),
        ('–', "-"),
        ('²', "2"),
        ('×', "x"),
        ('±', "+-"),
    ];
    SIGNS.iter().fold(text.to_owned(), |text, (sign, plain)| {
        text.replace(*sign, plain)
    })
}

/// Stands for a blank at which no line ends.
const KEPT: char = '\u{a0}';

fn with_units(text: &str) -> String {
    let mut kept = String::with_capacity(text.len());
    let mut before = ' ';
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let is_unit = c == ' '
            && before.is_ascii_digit()
            && rest
                .peek()
                .is_some_and(|c| c.is_ascii_alphabetic() || *c == '%');
        kept.push(if is_unit { KEPT } else { c });
        before = c;
    }
    kept.replace(&format!("{KEPT}N m"), &format!("{KEPT}N{KEPT}m"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_and_its_unit_stay_together() {
        let text = format!("{} 12.5 N m, +79 % and 3", "a".repeat(75));
        let lines = wrapped(&text, 2);
        assert!(lines.ends_with("a\n  12.5 N m, +79 % and 3"), "{lines}");
    }
}
