//! Errors and warnings on stderr, and the exit codes that go with them.

use std::io;
use std::process::ExitCode;

use feedwright_sim::{Machine, Stages};
use miette::{GraphicalReportHandler, GraphicalTheme, Report, Result, ThemeCharacters, ThemeStyles, miette};

use crate::command::terminal::{is_stderr_colored, shows_unicode, text_columns, wrapped};

/// The result is out of tolerance.
pub const OUT_OF_TOLERANCE: u8 = 1;
/// What was checked has mistakes.
pub(crate) const MISTAKES: u8 = 1;
/// Something is wrong with what was asked for.
pub(crate) const ERROR: u8 = 2;
/// As shells have it for SIGINT.
pub(crate) const INTERRUPTED: u8 = 130;

/// Shows an error.
pub(crate) fn fail(report: &Report) -> ExitCode {
    show(report);
    ExitCode::from(ERROR)
}

/// Tells that an interrupt ended the work.
pub(crate) fn interrupted() -> ExitCode {
    eprintln!("{}", feedwright_sim::Cancelled);
    ExitCode::from(INTERRUPTED)
}

/// The exit code after something was printed on stdout. A reader that went away (`| head`) has seen enough: no error.
pub fn printed(result: io::Result<()>, code: ExitCode) -> Result<ExitCode> {
    match result {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(miette!("cannot write to the standard output: {error}"))
        }
        _ => Ok(code),
    }
}

/// Tells something that is no warning.
pub fn remark(text: &str) {
    eprintln!("{}", wrapped(text, 2));
}

/// Tells which limits of the axes are assumed, where a planner needs some that the machine file does not have.
pub(crate) fn tell_assumed_limits(machine: &Machine, stages: Stages) {
    if let Some(text) = machine.assumed_axis_limits().filter(|_| stages.planner.needs_axes) {
        remark(&text);
    }
}

/// Shows a warning.
pub(crate) fn warn(report: Report) {
    show(&report);
}

/// Shows an error of something that is checked: it is no error of the command.
pub(crate) fn tell(report: &Report) {
    show(report);
}

/// Plain text where stderr shows no colours, ASCII where it shows no more. Causes that the message tells already are not told twice.
fn show(report: &Report) {
    let characters = if shows_unicode() { ThemeCharacters::unicode() } else { ThemeCharacters::ascii() };
    let styles = if is_stderr_colored() { ThemeStyles::ansi() } else { ThemeStyles::none() };
    let theme = GraphicalTheme { characters, styles };
    let mut handler = GraphicalReportHandler::new_themed(theme)
        .with_width(text_columns())
        .with_links(false)
        .with_word_splitter(textwrap::WordSplitter::NoHyphenation);
    let message = report.to_string();
    if report.chain().skip(1).all(|cause| message.contains(&cause.to_string())) {
        handler = handler.without_cause_chain();
    }
    let mut text = String::new();
    match handler.render_report(&mut text, report.as_ref()) {
        Ok(()) => eprintln!("{}", with_hints(text.trim_end())),
        Err(_) => eprintln!("error: {message}"),
    }
}

/// miette labels a remedy `help:` without a way to choose; ours are hints.
fn with_hints(text: &str) -> String {
    let label = |line: &str| match line.split_once("  help: ") {
        // The label stands at the start of its line, perhaps behind a colour; program text may contain anything.
        Some((before, rest)) if before.trim().is_empty() || before.starts_with('\u{1b}') => {
            format!("{before}  hint: {}", rest.strip_prefix("hint: ").unwrap_or(rest))
        }
        _ => line.to_owned(),
    };
    text.lines().map(label).collect::<Vec<_>>().join("\n")
}
