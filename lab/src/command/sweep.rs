//! Shared parts of the commands that compare controllers with the uncorrected cut on many cuts: the
//! options, the run with its files, the table.
use std::ffi::OsStr;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use feedwright::command::{
    Console, ConsoleTable, OUT_OF_TOLERANCE, TableColumn, find, printed, report_written, settings,
    tables, wrapped,
};
use feedwright::{OutputError, OutputFile, OutputFiles};
use feedwright_sim::Machine;
use miette::{IntoDiagnostic, Result, WrapErr};
use serde::Serialize;

use crate::command::args::sweep::SweepArgs;
use crate::never_worse::cut::{Figures, SweepRow};
use crate::never_worse::summary::{Judged, Quantiles, SweepSummary, UNCORRECTED_UM};
use crate::never_worse::{SweepJob, SweepOptions, sweep};
use crate::peers::CONTROLLERS;
use crate::study::Kept;

/// A sweep that is about to begin: everything that can be refused has been.
pub(super) struct Sweep {
    pub(crate) options: SweepOptions,
    kept: Kept,
    json: Option<OutputFile>,
    json_to: Option<PathBuf>,
}

impl Sweep {
    /// `controllers` are names, and `inputs` files that no output may take the place of.
    pub(crate) fn new(args: &SweepArgs, controllers: &[String], inputs: &[&Path]) -> Result<Self> {
        let find = |name: &String| find(name, CONTROLLERS);
        let controllers = controllers.iter().map(find).collect::<Result<Vec<_>>>()?;
        let only = controllers
            .first()
            .filter(|_| controllers.len() == 1)
            .copied();
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        let options = SweepOptions {
            set: settings(&args.set, CONTROLLERS, only, &controllers)?,
            controllers,
            recorded: false,
            seed: args.seed,
            threads: args.threads.map_or_else(cores, usize::from),
        };
        let mut files = OutputFiles::new(inputs.iter().copied());
        let json = args.json.as_ref().map(|path| files.start(path));
        Ok(Self {
            options,
            json: json.transpose()?,
            kept: Kept::open(args.results.as_deref(), "cuts")?,
            json_to: args.json.clone(),
        })
    }

    /// Cuts the jobs, writes what `judge` makes of the rows, and prints it. `print` gets the end of
    /// a line on the work too.
    pub(crate) fn run<S: Serialize>(
        self,
        jobs: &[SweepJob],
        console: &Console,
        judge: impl FnOnce(Vec<SweepRow>) -> S,
        print: impl FnOnce(&S, &str, &mut dyn Write) -> io::Result<()>,
    ) -> Result<(S, io::Result<()>)> {
        let bar = console.bar(0);
        let began = Instant::now();
        let rows = sweep(jobs, &self.options, &self.kept, &bar);
        bar.clear();
        let judged = judge(rows?);
        let known = match self.kept.found() {
            0 => String::new(),
            found => format!("; cuts that were there: {found}"),
        };
        let work = format!(
            "cut {} times, in {:.0} s on {} threads{known}",
            1 + self.options.controllers.len(),
            began.elapsed().as_secs_f64(),
            self.options.threads
        );
        if let Some(file) = self.json {
            write_json(file, &judged, console).wrap_err("cannot write the cuts")?;
        }
        self.kept.complete();
        let printing = print(&judged, &work, &mut *tables([self.json_to.as_deref()]));
        Ok((judged, printing))
    }
}

/// The machines of these names and files.
pub(super) fn loaded(names: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Result<Vec<Machine>> {
    let load = |name: _| Ok(Machine::load(AsRef::as_ref(&name))?);
    names.into_iter().map(load).collect()
}

/// Writes a text to a place.
pub(super) fn write_text(
    mut files: OutputFiles,
    to: &Path,
    text: &str,
    console: &Console,
) -> Result<()> {
    let mut file = files.start(to)?;
    let written = file.write_all(text.as_bytes());
    written.map_err(|error| OutputError::from_io(error, to))?;
    Ok(OutputFile::commit_all(vec![file], &console.bar(0))?)
}

/// Prints that a text is in its place.
pub(super) fn say_place(to: &Path) -> Result<ExitCode> {
    let out = Some(to);
    printed(report_written(&mut tables([out]), [out]), ExitCode::SUCCESS)
}

/// Writes a result, and moves the file to its place.
pub(super) fn write_json(
    mut file: OutputFile,
    result: &impl Serialize,
    console: &Console,
) -> Result<()> {
    serde_json::to_writer_pretty(&mut file, result).into_diagnostic()?;
    file.write_all(b"\n").into_diagnostic()?;
    Ok(OutputFile::commit_all(vec![file], &console.bar(0))?)
}

/// 1 where anything is worse.
pub(super) fn code(is_worse: bool) -> ExitCode {
    ExitCode::from(if is_worse { OUT_OF_TOLERANCE } else { 0 })
}

/// Prints failures, then totals, of the cuts of one controller.
pub(super) fn print(summary: &SweepSummary, work: &str, out: &mut dyn Write) -> io::Result<()> {
    let headings = [
        "RMS / max um",
        "machine",
        "uncorrected",
        "corrected",
        "worse in",
    ];
    let mut table = ConsoleTable::new(headings.map(TableColumn::new).into());
    let is_failure = |judged: &&Judged| !judged.faults.is_empty();
    for Judged { row, faults, .. } in summary.rows.iter().filter(is_failure) {
        let names: Vec<&str> = faults.iter().map(|fault| fault.name()).collect();
        let [before, after] = [&row.uncorrected, &row.corrected].map(figures);
        let [program, machine] = [&row.program, &row.machine].map(String::clone);
        table.row(vec![program, machine, before, after, names.join(", ")]);
        if let Some(why) = &row.corrected.lost {
            table.remark(why.clone());
        }
    }
    if summary.worse > 0 {
        table.print(out)?;
    }
    let by_fault: Vec<String> = (summary.by_fault.iter())
        .map(|(fault, cuts)| format!("{} {cuts}", fault.name()))
        .collect();
    let (worse, judged, faults) = (summary.worse, summary.judged, by_fault.join(", "));
    writeln!(
        out,
        "{worse} of {judged} cuts worse than uncorrected ({faults})"
    )?;
    if summary.not_judged > 0 {
        let why = "not judged, because the uncorrected cut itself is lost";
        writeln!(out, "{why}: {}", summary.not_judged)?;
    }
    print_ratios("all cuts", summary.rms_ratio, out)?;
    let rigid = format!(
        "rigid machines without encoder steps and delay, uncorrected above {UNCORRECTED_UM} um"
    );
    print_ratios(&rigid, summary.rms_ratio_rigid, out)?;
    if let Some(share) = summary.engaged_share {
        let what = "share of the time with the controller in the loop";
        writeln!(out, "{what}: median {share:.3}")?;
    }
    writeln!(
        out,
        "{:.2} h of machining, {work}",
        summary.machining_s / 3600.0
    )
}

fn print_ratios(what: &str, ratios: Option<Quantiles>, out: &mut dyn Write) -> io::Result<()> {
    let Some(it) = ratios else { return Ok(()) };
    let text = format!(
        "RMS against uncorrected, {what}: median {:.3}, 90 % {:.3}, 99 % {:.3}, largest {:.3} ({} cuts)",
        it.median, it.p90, it.p99, it.largest, it.cuts
    );
    writeln!(out, "{}", wrapped(&text, 2))
}

/// RMS and largest error, um.
fn figures(figures: &Figures) -> String {
    format!("{:.2} / {:.1}", figures.rms_um, figures.max_um)
}
