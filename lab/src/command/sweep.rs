//! Shared parts of the commands that compare controllers with the uncorrected cut on many cuts: the
//! store, the progress bar, the table.
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use feedwright::command::{
    Console, ConsoleTable, OUT_OF_TOLERANCE, TableColumn, find, settings, tables, wrapped,
};
use feedwright::{OutputFile, OutputFiles};
use miette::{IntoDiagnostic, Result, WrapErr};
use serde::Serialize;

use crate::command::args::sweep::SweepArgs;
use crate::kept::Kept;
use crate::never_worse::cut::{Figures, SweepRow};
use crate::never_worse::summary::{Judged, Quantiles, SweepSummary, UNCORRECTED_UM};
use crate::never_worse::{SweepJob, SweepOptions, Swept, sweep};
use crate::peers::CONTROLLERS;

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
        let controllers = controllers
            .iter()
            .map(|name| find(name, CONTROLLERS))
            .collect::<Result<Vec<_>>>()?;
        let only = if let [only] = controllers[..] {
            Some(only)
        } else {
            None
        };
        let set = settings(&args.set, CONTROLLERS, only, &controllers)?;
        let threads = args.threads.map_or_else(
            || std::thread::available_parallelism().map_or(1, usize::from),
            usize::from,
        );
        let options = SweepOptions {
            controllers,
            set,
            recorded: false,
            seed: args.seed,
            threads,
        };
        let mut files = OutputFiles::new(inputs.iter().copied());
        let json = args
            .json
            .as_ref()
            .map(|path| files.start(path))
            .transpose()?;
        let kept = Kept::open(args.results.as_deref(), "cuts")?;
        Ok(Self {
            options,
            kept,
            json,
            json_to: args.json.clone(),
        })
    }

    /// Cuts the jobs.
    pub(crate) fn run(&self, jobs: &[SweepJob], console: &Console) -> Result<Done> {
        let bar = console.bar(0);
        let began = Instant::now();
        let swept = sweep(jobs, &self.options, &self.kept, &bar);
        bar.clear();
        let Swept { rows, known } = swept?;
        let SweepOptions {
            controllers,
            threads,
            ..
        } = &self.options;
        let (times, took_s) = (1 + controllers.len(), began.elapsed().as_secs_f64());
        Ok(Done {
            rows,
            known,
            times,
            threads: *threads,
            took_s,
        })
    }

    /// Writes the results of a run to the requested places, and returns where tables are printed.
    pub(crate) fn write(
        self,
        summary: &impl Serialize,
        console: &Console,
    ) -> Result<Box<dyn Write>> {
        if let Some(mut file) = self.json {
            serde_json::to_writer_pretty(&mut file, summary)
                .into_diagnostic()
                .wrap_err("cannot write the cuts")?;
            file.write_all(b"\n").into_diagnostic()?;
            OutputFile::commit_all(vec![file], &console.bar(0))?;
        }
        self.kept.complete();
        Ok(tables([self.json_to.as_deref()]))
    }
}

/// 1 where any cut is worse.
pub(super) fn code(worse: usize) -> ExitCode {
    if worse > 0 {
        ExitCode::from(OUT_OF_TOLERANCE)
    } else {
        ExitCode::SUCCESS
    }
}

/// A sweep that is done.
pub(super) struct Done {
    pub(crate) rows: Vec<SweepRow>,
    known: usize,
    /// Number of cuts of each program on each machine.
    times: usize,
    threads: usize,
    took_s: f64,
}

impl Done {
    /// Failures, then totals, of the cuts of one controller.
    pub(crate) fn print(&self, summary: &SweepSummary, out: &mut dyn Write) -> io::Result<()> {
        let SweepSummary {
            judged,
            not_judged,
            worse,
            by_fault,
            rows,
            ..
        } = summary;
        let failures: Vec<&Judged> = rows
            .iter()
            .filter(|judged| !judged.faults.is_empty())
            .collect();
        let mut table = ConsoleTable::new(vec![
            TableColumn::new("RMS / max um"),
            TableColumn::new("machine"),
            TableColumn::new("uncorrected"),
            TableColumn::new("corrected"),
            TableColumn::new("worse in"),
        ]);
        for Judged { row, faults, .. } in &failures {
            let names: Vec<&str> = faults.iter().map(|fault| fault.name()).collect();
            let [before, after] = [&row.uncorrected, &row.corrected].map(figures);
            table.row(vec![
                row.program.clone(),
                row.machine.clone(),
                before,
                after,
                names.join(", "),
            ]);
            if let Some(why) = &row.corrected.lost {
                table.remark(why.clone());
            }
        }
        if !failures.is_empty() {
            table.print(out)?;
        }
        let by_fault: Vec<String> = by_fault
            .iter()
            .map(|(fault, cuts)| format!("{} {cuts}", fault.name()))
            .collect();
        writeln!(
            out,
            "{worse} of {judged} cuts worse than uncorrected ({})",
            by_fault.join(", ")
        )?;
        if *not_judged > 0 {
            writeln!(
                out,
                "not judged, because the uncorrected cut itself is lost: {not_judged}"
            )?;
        }
        self.print_numbers(summary, out)
    }

    fn print_numbers(&self, summary: &SweepSummary, out: &mut dyn Write) -> io::Result<()> {
        let SweepSummary {
            rms_ratio,
            rms_ratio_rigid,
            engaged_share,
            machining_s,
            ..
        } = summary;
        let mut quantiles = |what: &str, ratios: &Option<Quantiles>| match ratios {
            Some(Quantiles {
                cuts,
                median,
                p90,
                p99,
                largest,
            }) => {
                let text = format!(
                    "RMS against uncorrected, {what}: median {median:.3}, 90 % {p90:.3}, 99 % {p99:.3}, largest {largest:.3} ({cuts} cuts)"
                );
                writeln!(out, "{}", wrapped(&text, 2))
            }
            None => Ok(()),
        };
        quantiles("all cuts", rms_ratio)?;
        quantiles(
            &format!(
                "rigid machines without encoder steps and delay, uncorrected above {UNCORRECTED_UM} um"
            ),
            rms_ratio_rigid,
        )?;
        if let Some(share) = engaged_share {
            writeln!(
                out,
                "share of the time with the controller in the loop: median {share:.3}"
            )?;
        }
        let Self {
            known,
            times,
            threads,
            took_s,
            ..
        } = self;
        let known = if *known > 0 {
            format!("; cuts that were there: {known}")
        } else {
            String::new()
        };
        writeln!(
            out,
            "{:.2} h of machining, cut {times} times, in {took_s:.0} s on {threads} threads{known}",
            machining_s / 3600.0
        )
    }
}

/// RMS and largest error, um.
fn figures(figures: &Figures) -> String {
    format!("{:.2} / {:.1}", figures.rms_um, figures.max_um)
}
