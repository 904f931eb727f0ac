//! Errors and warnings on stderr, and the exit codes that go with them.

use std::fmt;
use std::io::{self, IsTerminal};
use std::process::ExitCode;

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme, Report, ReportHandler};

/// The result is out of tolerance.
pub(crate) const OUT_OF_TOLERANCE: u8 = 1;
/// Something is wrong with what was asked for.
const ERROR: u8 = 2;
/// As shells have it for SIGINT.
pub(crate) const INTERRUPTED: u8 = 130;
/// Width of messages where there is no terminal to ask.
const WIDTH: usize = 120;

/// How miette shows reports: plain text where stderr is no terminal or `NO_COLOR` is set.
pub(crate) fn set_up() {
    let plain = !io::stderr().is_terminal() || std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    // The hook can be set once only, and this is where.
    let _ = miette::set_hook(Box::new(move |_| {
        let theme = if plain { GraphicalTheme::unicode_nocolor() } else { GraphicalTheme::unicode() };
        // Our messages name their cause themselves.
        let graphical =
            GraphicalReportHandler::new_themed(theme).with_width(WIDTH).with_links(false).without_cause_chain();
        Box::new(Hinting(graphical))
    }));
}

/// miette's reports, with `hint:` before a remedy where miette writes `help:`.
struct Hinting(GraphicalReportHandler);

impl ReportHandler for Hinting {
    fn debug(&self, diagnostic: &dyn Diagnostic, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = String::new();
        self.0.render_report(&mut text, diagnostic)?;
        for line in text.split_inclusive('\n') {
            // The label stands at the start of its line, perhaps behind a colour.
            match line.split_once("  help: ") {
                Some((before, rest)) if before.chars().all(|c| !c.is_alphabetic() || c == 'm') => {
                    write!(f, "{before}  hint: {}", rest.strip_prefix("hint: ").unwrap_or(rest))?;
                }
                _ => f.write_str(line)?,
            }
        }
        Ok(())
    }
}

/// Shows an error.
pub(crate) fn fail(report: &Report) -> ExitCode {
    eprintln!("{report:?}");
    ExitCode::from(ERROR)
}

/// Shows a warning.
pub(crate) fn warn(report: Report) {
    eprintln!("{report:?}");
}

/// What became of writing to stdout: a reader that went away had enough, which is no error.
pub(crate) fn shown(result: io::Result<()>) -> miette::Result<()> {
    match result {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(miette::miette!("cannot write to stdout: {error}"))
        }
        _ => Ok(()),
    }
}
