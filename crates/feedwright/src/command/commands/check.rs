//! `feedwright check`: reports all mistakes of programs and machine files, as a compiler does.
//!
//! Files are read in parallel, each as a stream. The output is in the order of the arguments,
//! whatever the number of threads.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;

use feedwright_gcode::{self, CheckError, Program, Settings, ToolTableError, input, visible};
use feedwright_ident::{Model, identifier_name};
use feedwright_sim::toml_file::{FileError, Problem};
use feedwright_sim::{Machine, MachineError, Watch};
use miette::{Report, Result, miette};
use rayon::iter::{ParallelBridge, ParallelIterator};
use serde_json::{Value, json};

use crate::command::args::check::{CheckArgs, Format};
use crate::command::console::Console;
use crate::command::files_to_check::FilesToCheck;
use crate::command::findings::{Finding, sarif};
use crate::command::folded::folded;
use crate::command::message::{ERROR, MISTAKES, printed, show, warn};
use crate::command::progress::Bar;
use crate::command::streams::check_inputs;
use crate::results_format::{stamped, write_json};

/// Outcome of one file, from best to worst. The worst of all files is the exit code.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum FileOutcome {
    /// Warnings at most.
    Fine,
    Mistakes,
    Unreadable,
}

impl FileOutcome {
    const fn code(self) -> u8 {
        match self {
            Self::Fine => 0,
            Self::Mistakes => MISTAKES,
            Self::Unreadable => ERROR,
        }
    }

    const fn name(self) -> &'static str {
        match self {
            Self::Fine => "fine",
            Self::Mistakes => "mistakes",
            Self::Unreadable => "unreadable",
        }
    }
}

/// Findings of one file.
struct CheckedFile {
    outcome: FileOutcome,
    /// Summary of the file; `None` where it has mistakes.
    line: Option<String>,
    /// The mistakes, or the warnings of a file without mistakes.
    reports: Vec<Report>,
    /// The same for other programs.
    findings: Vec<Finding>,
}

/// State of the output: what was printed, and what is printed at the end.
struct CheckOutput {
    format: Format,
    worst: FileOutcome,
    findings: Vec<Finding>,
    files: Vec<Value>,
}

pub(crate) fn run(args: &CheckArgs, console: &Console) -> Result<ExitCode> {
    let files = args
        .files
        .iter()
        .map(|file| ("a file", Some(file.as_path())));
    check_inputs(
        console,
        files.chain([("--tool-table", args.reader.tool_table.as_deref())]),
    )?;
    let settings = match args.reader.settings() {
        Ok(settings) => settings,
        Err(report) => return tool_table(args, report),
    };
    let found = FilesToCheck::find(&args.files);
    let bar = console.bar_unless(args.format != Format::Text, found.files.len() as u64);
    let mut output = CheckOutput {
        format: args.format,
        worst: FileOutcome::Fine,
        findings: Vec::new(),
        files: Vec::new(),
    };
    for remark in &found.remarks {
        crate::command::message::remark(remark);
    }
    for fault in &found.faults {
        show(&miette!("{fault}"));
        output.worst = FileOutcome::Unreadable;
    }
    let result = print(&found.files, &settings, &bar, &mut output);
    bar.clear();
    printed(result, ExitCode::from(output.worst.code()))
}

/// Reports the mistakes of the tool table in the requested format. Any other error is an error of
/// the command line.
fn tool_table(args: &CheckArgs, report: Report) -> Result<ExitCode> {
    let Some((error, table)) = report
        .downcast_ref::<ToolTableError>()
        .zip(args.reader.tool_table.as_deref())
    else {
        return Err(report);
    };
    let findings = match error {
        ToolTableError::Faults { faults, .. } => faults.iter().map(Finding::of).collect(),
        ToolTableError::Io { .. } => vec![Finding::of_file(&input::name(table), &report)],
    };
    let checked = CheckedFile {
        outcome: FileOutcome::Unreadable,
        line: None,
        reports: vec![report],
        findings,
    };
    let mut output = CheckOutput {
        format: args.format,
        worst: FileOutcome::Fine,
        findings: Vec::new(),
        files: Vec::new(),
    };
    let mut out = io::stdout().lock();
    let result = output
        .show(&mut out, table, checked)
        .and_then(|()| output.end(&mut out));
    printed(result, ExitCode::from(ERROR))
}

/// Checks all files and prints what is found in each as soon as those before it are printed.
fn print(
    files: &[PathBuf],
    settings: &Settings,
    bar: &Bar,
    output: &mut CheckOutput,
) -> io::Result<()> {
    let enough = AtomicBool::new(false);
    let (sender, receiver) = mpsc::channel();
    rayon::in_place_scope(|scope| {
        let enough = &enough;
        scope.spawn(move |_| {
            // A bridge hands the files out one by one, so that results come about in their order.
            files.iter().enumerate().par_bridge().for_each_with(
                sender,
                |sender, (number, file)| {
                    // Once printing has failed, no more results are read: the remaining files are
                    // skipped.
                    if !enough.load(Ordering::Relaxed) {
                        let _ = sender.send((number, check_file(file, settings)));
                    }
                },
            );
        });
        let result = print_in_order(files, &receiver, bar, output);
        enough.store(true, Ordering::Relaxed);
        result
    })
}

fn print_in_order(
    files: &[PathBuf],
    checked_files: &mpsc::Receiver<(usize, CheckedFile)>,
    bar: &Bar,
    output: &mut CheckOutput,
) -> io::Result<()> {
    let mut out = io::stdout().lock();
    let (mut early, mut next, mut faulty) = (BTreeMap::new(), 0, 0);
    for (number, checked) in checked_files {
        early.insert(number, checked);
        while let Some(checked) = early.remove(&next) {
            faulty += usize::from(checked.outcome != FileOutcome::Fine);
            bar.aside(|| output.show(&mut out, &files[next], checked))?;
            bar.advance(1);
            next += 1;
        }
    }
    if output.format == Format::Text && files.len() > 1 {
        writeln!(
            out,
            "{} files: {} without mistakes, {faulty} with mistakes",
            files.len(),
            files.len() - faulty
        )?;
    }
    output.end(&mut out)
}

impl CheckOutput {
    /// Prints what was kept for the end.
    fn end(&self, out: &mut impl Write) -> io::Result<()> {
        match self.format {
            Format::Text | Format::Github => Ok(()),
            Format::Json => write_json(out, &stamped(json!({ "files": self.files }))),
            Format::Sarif => write_json(out, &sarif(&self.findings)),
        }
    }

    /// Prints what was found in a file, or keeps it for the end.
    fn show(&mut self, out: &mut impl Write, file: &Path, checked: CheckedFile) -> io::Result<()> {
        self.worst = self.worst.max(checked.outcome);
        match self.format {
            Format::Text => {
                for report in checked.reports {
                    if checked.line.is_some() {
                        warn(report);
                    } else {
                        show(&report);
                    }
                }
                checked.line.iter().try_for_each(|line| {
                    writeln!(out, "{}: {}", input::name(file), visible(line))
                })?;
            }
            Format::Github => {
                checked
                    .findings
                    .iter()
                    .try_for_each(|finding| writeln!(out, "{}", finding.github()))?;
            }
            Format::Sarif => self.findings.extend(checked.findings),
            Format::Json => self.files.push(json!({
                "file": input::name(file),
                "outcome": checked.outcome.name(),
                "amounts_to": checked.line,
                "findings": checked.findings.iter().map(Finding::json).collect::<Vec<_>>(),
            })),
        }
        Ok(())
    }
}

fn check_file(file: &Path, settings: &Settings) -> CheckedFile {
    let is_machine = file
        .extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    let is_model = is_machine
        && file
            .file_stem()
            .is_some_and(|stem| Path::new(stem).extension().is_some_and(|e| e == "model"));
    match (is_model, is_machine) {
        (true, _) => model(file),
        (_, true) => machine(file),
        _ => program(file, settings.clone()),
    }
}

/// Reports a file that is wrong as a whole.
fn refused(file: &Path, outcome: FileOutcome, report: Report) -> CheckedFile {
    let findings = vec![Finding::of_file(&input::name(file), &report)];
    CheckedFile {
        outcome,
        line: None,
        reports: vec![report],
        findings,
    }
}

fn machine(file: &Path) -> CheckedFile {
    match Machine::read(file) {
        Ok(machine) => fine(format!(
            "machine {}, {} axes",
            machine.name,
            machine.axis_count()
        )),
        Err(error) => {
            let findings = match &error {
                MachineError::File(error) => findings(file, error),
                MachineError::UnknownName { .. } => Vec::new(),
            };
            at_fault(file, findings, error.into())
        }
    }
}

fn model(file: &Path) -> CheckedFile {
    match Model::read(file) {
        Ok(model) => fine(format!(
            "{} model, {} axes, {}",
            identifier_name(model.kind()),
            model.axes(),
            model.about().source
        )),
        Err(error) => at_fault(file, findings(file, &error), error.into()),
    }
}

fn fine(line: String) -> CheckedFile {
    CheckedFile {
        outcome: FileOutcome::Fine,
        line: Some(line),
        reports: Vec::new(),
        findings: Vec::new(),
    }
}

fn at_fault(file: &Path, findings: Vec<Finding>, error: Report) -> CheckedFile {
    let outcome = if findings.is_empty() {
        FileOutcome::Unreadable
    } else {
        FileOutcome::Mistakes
    };
    let refused = refused(file, outcome, error);
    if findings.is_empty() {
        refused
    } else {
        CheckedFile {
            findings,
            ..refused
        }
    }
}

/// The faults in the text of a machine file or model file; none where it cannot be read.
fn findings(file: &Path, error: &FileError) -> Vec<Finding> {
    let FileError::Invalid { problems, .. } = error else {
        return Vec::new();
    };
    let finding = |problem: &Problem| Finding {
        file: input::name(file),
        is_error: true,
        code: problem.code.to_owned(),
        line: u32::try_from(problem.line).unwrap_or(u32::MAX),
        column: u32::try_from(problem.column).unwrap_or(u32::MAX),
        span: 1,
        message: problem.message.clone(),
        hint: problem.hint.clone(),
    };
    problems.iter().map(finding).collect()
}

fn program(file: &Path, settings: Settings) -> CheckedFile {
    let summary = match Program::in_file(file).check(settings) {
        Ok(summary) => summary,
        Err(CheckError::Read(error)) => {
            return refused(file, FileOutcome::Unreadable, error.into());
        }
        Err(CheckError::Faults(faults)) => {
            let findings = faults.iter().map(Finding::of).collect();
            let reports = folded(&faults).into_iter().map(Report::new).collect();
            return CheckedFile {
                outcome: FileOutcome::Mistakes,
                line: None,
                reports,
                findings,
            };
        }
    };
    let (dialect, reason) = summary.dialect;
    let line = format!(
        "{}, {}, {:.3} mm of feed, {:.3} mm of rapids, read as {dialect}: {reason}",
        counted(summary.lines, "line"),
        counted(summary.motions, "motion"),
        summary.feed_mm,
        summary.rapid_mm
    );
    let findings = summary.warnings.iter().map(Finding::of).collect();
    let reports = folded(&summary.warnings)
        .into_iter()
        .map(Report::new)
        .collect();
    CheckedFile {
        outcome: FileOutcome::Fine,
        line: Some(line),
        reports,
        findings,
    }
}

fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}
