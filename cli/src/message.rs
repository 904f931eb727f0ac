//! Errors and warnings on stderr, and the exit codes that go with them.

use std::io::IsTerminal;
use std::process::ExitCode;

use miette::{GraphicalReportHandler, GraphicalTheme, Report};

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
    let plain = !std::io::stderr().is_terminal() || std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
    // The hook can be set once only, and this is where.
    let _ = miette::set_hook(Box::new(move |_| {
        let theme = if plain { GraphicalTheme::unicode_nocolor() } else { GraphicalTheme::unicode() };
        Box::new(GraphicalReportHandler::new_themed(theme).with_width(WIDTH).with_links(false))
    }));
}

/// Shows an error; a reader of stdout that went away is none.
pub(crate) fn fail(report: &Report) -> ExitCode {
    let broken_pipe = report
        .chain()
        .filter_map(|cause| cause.downcast_ref::<std::io::Error>())
        .any(|cause| cause.kind() == std::io::ErrorKind::BrokenPipe);
    if !broken_pipe {
        eprintln!("{report:?}");
    }
    ExitCode::from(ERROR)
}

/// Shows a warning.
pub(crate) fn warn(report: Report) {
    eprintln!("{report:?}");
}
