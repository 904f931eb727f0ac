//! Errors and warnings on stderr, and the exit codes that go with them.

use std::fmt;
use std::io;
use std::process::ExitCode;

use feedwright_sim::{Machine, Stages};
use miette::{
    Diagnostic, GraphicalReportHandler, GraphicalTheme, Report, Result, ThemeCharacters,
    ThemeStyles, miette,
};

use crate::command::folded::folded_report;
use crate::command::terminal::{
    is_stderr_colored, shows_unicode, text_columns, without_hidden, wrapped,
};

/// The result is out of tolerance.
pub const OUT_OF_TOLERANCE: u8 = 1;
/// Exit code if a checked file has mistakes.
pub(crate) const MISTAKES: u8 = 1;
/// Exit code if the command fails with an error.
pub(crate) const ERROR: u8 = 2;
/// Exit code of an interrupt, as shells define it for SIGINT.
pub(crate) const INTERRUPTED: u8 = 130;

/// Shows an error.
pub(crate) fn fail(report: &Report) -> ExitCode {
    show(folded_report(report).as_ref().unwrap_or(report));
    ExitCode::from(ERROR)
}

/// Reports that an interrupt ended the work.
pub(crate) fn interrupted() -> ExitCode {
    eprintln!("{}", feedwright_sim::Cancelled);
    ExitCode::from(INTERRUPTED)
}

/// The exit code after something was printed on stdout. A reader that went away (`| head`) has seen
/// enough: no error.
pub fn printed(result: io::Result<()>, code: ExitCode) -> Result<ExitCode> {
    match result {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(miette!("cannot write to the standard output: {error}"))
        }
        _ => Ok(code),
    }
}

/// Prints a remark, which is not a warning.
pub fn remark(text: &str) {
    eprintln!("{}", wrapped(text, 2));
}

/// Reports the axis limits that are assumed because the planner needs limits that the machine file
/// does not have.
pub(crate) fn report_assumed_limits(machine: &Machine, stages: Stages) {
    if let Some(text) = machine
        .assumed_axis_limits()
        .filter(|_| stages.planner.needs_axes)
    {
        remark(&text);
    }
}

/// Shows a warning.
pub(crate) fn warn(report: Report) {
    show(&report);
}

/// Prints plain text where stderr shows no colors, and ASCII where it shows no more. Leaves out
/// causes that the message already contains.
pub(crate) fn show(report: &Report) {
    let characters = if shows_unicode() {
        ThemeCharacters::unicode()
    } else {
        ThemeCharacters::ascii()
    };
    let styles = if is_stderr_colored() {
        ThemeStyles::ansi()
    } else {
        ThemeStyles::none()
    };
    let theme = GraphicalTheme { characters, styles };
    let mut handler = GraphicalReportHandler::new_themed(theme)
        .with_width(text_columns())
        .with_links(false)
        .with_word_splitter(textwrap::WordSplitter::NoHyphenation);
    let message = report.to_string();
    if report
        .chain()
        .skip(1)
        .all(|cause| message.contains(&cause.to_string()))
    {
        handler = handler.without_cause_chain();
    }
    let mut text = String::new();
    match handler.render_report(&mut text, &VisibleReport::of(report.as_ref())) {
        Ok(()) => eprintln!("{}", with_hints(text.trim_end())),
        Err(_) => eprintln!("error: {}", without_hidden(&message)),
    }
}

/// A report without what is hidden in its texts; excerpts of files are made so by who reads them.
#[derive(Debug)]
struct VisibleReport<'a> {
    of: &'a dyn Diagnostic,
    cause: Option<Box<VisibleCause>>,
    related: Vec<Self>,
    inner: Option<Box<Self>>,
}

/// Cause of a report, and the cause of that cause.
#[derive(Debug)]
struct VisibleCause {
    text: String,
    cause: Option<Box<Self>>,
}

impl<'a> VisibleReport<'a> {
    fn of(report: &'a dyn Diagnostic) -> Self {
        Self {
            of: report,
            cause: VisibleCause::of(report.source()),
            related: report
                .related()
                .into_iter()
                .flatten()
                .map(Self::of)
                .collect(),
            inner: report
                .diagnostic_source()
                .map(|inner| Box::new(Self::of(inner))),
        }
    }
}

impl VisibleCause {
    fn of(cause: Option<&(dyn std::error::Error + 'static)>) -> Option<Box<Self>> {
        let cause = cause?;
        Some(Box::new(Self {
            text: without_hidden(&cause.to_string()),
            cause: Self::of(cause.source()),
        }))
    }
}

impl fmt::Display for VisibleReport<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&without_hidden(&self.of.to_string()))
    }
}

impl fmt::Display for VisibleCause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl std::error::Error for VisibleReport<'_> {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.cause.as_deref().map(|cause| cause as _)
    }
}

impl std::error::Error for VisibleCause {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.cause.as_deref().map(|cause| cause as _)
    }
}

impl Diagnostic for VisibleReport<'_> {
    fn code<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        self.of.code()
    }

    fn severity(&self) -> Option<miette::Severity> {
        self.of.severity()
    }

    fn help<'b>(&'b self) -> Option<Box<dyn fmt::Display + 'b>> {
        self.of
            .help()
            .map(|help| Box::new(without_hidden(&help.to_string())) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn miette::SourceCode> {
        self.of.source_code()
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = miette::LabeledSpan> + '_>> {
        self.of.labels()
    }

    fn related<'b>(&'b self) -> Option<Box<dyn Iterator<Item = &'b dyn Diagnostic> + 'b>> {
        let related = self
            .related
            .iter()
            .map(|related| related as &dyn Diagnostic);
        (!self.related.is_empty()).then(|| Box::new(related) as _)
    }

    fn diagnostic_source(&self) -> Option<&dyn Diagnostic> {
        self.inner.as_deref().map(|inner| inner as _)
    }
}

/// miette labels a remedy `help:` without a way to choose; ours are hints.
fn with_hints(text: &str) -> String {
    let label = |line: &str| match line.split_once("  help: ") {
        // The label stands at the start of its line, perhaps behind a color; program text may
        // contain anything.
        Some((before, rest)) if before.trim().is_empty() || before.starts_with('\u{1b}') => {
            format!(
                "{before}  hint: {}",
                rest.strip_prefix("hint: ").unwrap_or(rest)
            )
        }
        _ => line.to_owned(),
    };
    text.lines().map(label).collect::<Vec<_>>().join("\n")
}
