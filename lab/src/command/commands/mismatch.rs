//! `feedwright-lab mismatch`: by models of some machines, programs on machines that differ from
//! them, uncorrected and corrected.
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use feedwright::command::{Console, ConsoleTable, TableColumn, printed};
use feedwright::{BEST, RESULTS_FORMAT};
use feedwright_sim::Machine;
use miette::{Result, miette};
use serde::Serialize;

use super::never_worse::{checked, found, read};
use crate::command::args::mismatch::MismatchArgs;
use crate::command::sweep::{Sweep, code};
use crate::mismatch::table::{MismatchSummary, MismatchVerdict};
use crate::mismatch::{Variants, variants};
use crate::never_worse::summary::Quantiles;
use crate::never_worse::{SweepJob, jobs};

/// A result with its format and version.
#[derive(Serialize)]
struct StampedResult<'a, T> {
    format: u32,
    version: &'static str,
    #[serde(flatten)]
    result: &'a T,
}

impl<'a, T> StampedResult<'a, T> {
    const fn of(result: &'a T) -> Self {
        Self {
            format: RESULTS_FORMAT,
            version: env!("CARGO_PKG_VERSION"),
            result,
        }
    }
}

/// Machines whose models are tried where none is named.
const BASES: [&str; 4] = ["workshop", "stiff", "tnv40", "router"];

pub(crate) fn run(args: &MismatchArgs, console: &Console) -> Result<ExitCode> {
    checked(args.limit_s)?;
    let bases: Vec<Machine> = if args.machine.is_empty() {
        BASES
            .iter()
            .map(|name| Machine::load(name.as_ref()))
            .collect::<Result<_, _>>()?
    } else {
        args.machine
            .iter()
            .map(|machine| Machine::load(machine))
            .collect::<Result<_, _>>()?
    };
    let files = found(&args.programs)?;
    let machine_files = args.machine.iter().map(PathBuf::from).collect::<Vec<_>>();
    let inputs: Vec<&Path> = files
        .iter()
        .chain(&machine_files)
        .map(PathBuf::as_path)
        .collect();
    let mut sweep = Sweep::new(&args.sweep, &args.controller, &inputs)?;
    sweep.options.recorded = true;
    let names: Vec<&'static str> = sweep
        .options
        .controllers
        .iter()
        .map(|entry| entry.name)
        .collect();
    if let Some(twice) = (1..names.len()).find(|&i| names[..i].contains(&names[i])) {
        return Err(miette!(
            help = "leave one of them out",
            "--controller {} is there twice",
            names[twice]
        ));
    }
    let ours = names
        .iter()
        .find(|name| **name == BEST)
        .unwrap_or(&names[0]);
    let which = Variants {
        gross: args.gross,
        drawn: args.drawn,
        seed: args.sweep.seed,
    };
    let mut all = vec![];
    for base in &bases {
        let programs = read(
            &files,
            &args.reader.settings()?,
            base,
            args.limit_s,
            console,
        )?;
        let model = Arc::new(base.clone());
        all.extend(
            jobs(programs, variants(base, which))
                .into_iter()
                .map(|job| SweepJob {
                    model: model.clone(),
                    ..job
                }),
        );
    }
    eprintln!(
        "{} cuts by models of {} machines with {} controllers",
        all.len(),
        bases.len(),
        names.len()
    );
    let mut done = sweep.run(&all, console)?;
    let summary = MismatchSummary::of(std::mem::take(&mut done.rows), ours);
    let mut out = sweep.write(&StampedResult::of(&summary), console)?;
    let printing = done
        .print(&summary.ours, &mut out)
        .and_then(|()| print(&summary, &mut out));
    printed(printing, code(summary.ours.worse))
}

/// A row for each machine and controller, and a line for each machine; the help explains the
/// columns.
fn print(summary: &MismatchSummary, out: &mut dyn Write) -> io::Result<()> {
    let columns = [
        "RMS / uncorrected",
        "cuts",
        "median",
        "90 %",
        "largest",
        "worse",
        "out",
        "later",
    ];
    let mut table = ConsoleTable::new(columns.into_iter().map(TableColumn::new).collect());
    let mut model = "";
    for group in &summary.groups {
        if model != group.model {
            model = &group.model;
            table.section(format!("by {model}"));
        }
        let Quantiles {
            cuts,
            median,
            p90,
            largest,
            ..
        } = group.rms_ratio;
        let later = group
            .later_ratio
            .map_or("-".to_owned(), |later| format!("{:.3}", later.median));
        let ratios = [median, p90, largest].map(|ratio| format!("{ratio:.3}"));
        let counts = [group.worse, group.lost].map(|count| count.to_string());
        let name = [group.controller.clone(), cuts.to_string()];
        table.row([&name[..], &ratios, &counts, &[later]].concat());
    }
    table.print(out)?;
    for MismatchVerdict {
        model,
        ours,
        median,
        peer,
        peer_median,
        ratio,
    } in &summary.verdicts
    {
        if let (Some(peer), Some(peer_median), Some(ratio)) = (peer, peer_median, ratio) {
            writeln!(
                out,
                "{model}: best peer {peer} {peer_median:.3}, {ours} {median:.3}, which is {ratio:.2} of it"
            )?;
        }
    }
    Ok(())
}
