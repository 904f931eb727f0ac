//! `feedwright-lab mismatch`: by models of some machines, programs on machines that differ from
//! them, uncorrected and corrected.
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use feedwright::command::{Console, ConsoleTable, TableColumn, printed};
use feedwright::{BEST, RESULTS_FORMAT};
use miette::{Result, miette};
use serde::Serialize;

use super::never_worse::{checked, found, read};
use crate::command::args::mismatch::MismatchArgs;
use crate::command::sweep::{self, Sweep, code, loaded};
use crate::mismatch::table::MismatchSummary;
use crate::mismatch::{Variants, variants};
use crate::never_worse::{SweepJob, jobs};

/// A result with its format and version.
#[derive(Serialize)]
struct StampedResult {
    format: u32,
    version: &'static str,
    #[serde(flatten)]
    result: MismatchSummary,
}

/// Machines whose models are tried where none is named.
const BASES: [&str; 4] = ["workshop", "stiff", "tnv40", "router"];

pub(crate) fn run(args: &MismatchArgs, console: &Console) -> Result<ExitCode> {
    checked(args.limit_s)?;
    let bases = if args.machine.is_empty() {
        loaded(BASES)?
    } else {
        loaded(&args.machine)?
    };
    let files = found(&args.programs)?;
    let machine_files: Vec<PathBuf> = args.machine.iter().map(PathBuf::from).collect();
    let inputs: Vec<&Path> = files
        .iter()
        .chain(&machine_files)
        .map(PathBuf::as_path)
        .collect();
    let mut sweep = Sweep::new(&args.sweep, &args.controller, &inputs)?;
    sweep.options.recorded = true;
    let names: Vec<&str> = sweep
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
    let ours = *names
        .iter()
        .find(|name| **name == BEST)
        .unwrap_or(&names[0]);
    let which = Variants {
        gross: args.gross,
        drawn: args.drawn,
        seed: args.sweep.seed,
    };
    let settings = args.reader.settings()?;
    let mut all = vec![];
    for base in &bases {
        let programs = read(&files, &settings, base, args.limit_s, console)?;
        let model = &Arc::new(base.clone());
        let by_model = |job| SweepJob {
            model: model.clone(),
            ..job
        };
        all.extend(
            jobs(programs, variants(base, which))
                .into_iter()
                .map(by_model),
        );
    }
    let [cuts, machines, controllers] = [all.len(), bases.len(), names.len()];
    eprintln!("{cuts} cuts by models of {machines} machines with {controllers} controllers");
    let judge = |rows| StampedResult {
        format: RESULTS_FORMAT,
        version: env!("CARGO_PKG_VERSION"),
        result: MismatchSummary::of(rows, ours),
    };
    let print = |StampedResult { result, .. }: &_, work: &str, out: &mut dyn Write| {
        sweep::print(&result.ours, work, out)?;
        print(result, out)
    };
    let (stamped, printing) = sweep.run(&all, console, judge, print)?;
    printed(printing, code(stamped.result.ours.worse > 0))
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
    let mut table = ConsoleTable::new(columns.map(TableColumn::new).into());
    let mut model = "";
    for group in &summary.groups {
        if model != group.model {
            model = &group.model;
            table.section(format!("by {model}"));
        }
        let it = group.rms_ratio;
        let later = group
            .later_ratio
            .map_or("-".to_owned(), |later| format!("{:.3}", later.median));
        let ratios = [it.median, it.p90, it.largest].map(|ratio| format!("{ratio:.3}"));
        let counts = [group.worse, group.lost].map(|count| count.to_string());
        let name = [group.controller.clone(), it.cuts.to_string()];
        table.row([&name[..], &ratios, &counts, &[later]].concat());
    }
    table.print(out)?;
    for it in &summary.verdicts {
        if let (Some(peer), Some(peer_median), Some(ratio)) = (&it.peer, it.peer_median, it.ratio) {
            let best = format!("{}: best peer {peer} {peer_median:.3}", it.model);
            let (ours, median) = (&it.ours, it.median);
            writeln!(out, "{best}, {ours} {median:.3}, which is {ratio:.2} of it")?;
        }
    }
    Ok(())
}
