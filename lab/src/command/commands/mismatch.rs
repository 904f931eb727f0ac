//! `feedwright-lab mismatch`: by a model of one machine, programs on machines that differ from it, uncorrected and corrected.
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;

use feedwright::command::{Console, printed, tables};
use feedwright_sim::Machine;
use miette::Result;

use super::never_worse::{checked, found, read};
use crate::command::args::mismatch::MismatchArgs;
use crate::command::sweep::Sweep;
use crate::mismatch::{Variants, variants};
use crate::never_worse::summary::{Quantiles, SweepSummary};
use crate::never_worse::verdict::Failure;
use crate::never_worse::{SweepJob, jobs};

/// Machines whose models are tried where none is named.
const BASES: [&str; 4] = ["workshop", "stiff", "tnv40", "router"];

pub(crate) fn run(args: &MismatchArgs, console: &Console) -> Result<ExitCode> {
    checked(args.limit_s)?;
    let bases: Vec<Machine> = if args.machine.is_empty() {
        BASES.iter().map(|name| Machine::load(name.as_ref())).collect::<Result<_, _>>()?
    } else {
        args.machine.iter().map(|machine| Machine::load(machine)).collect::<Result<_, _>>()?
    };
    let files = found(&args.programs)?;
    let machine_files = args.machine.iter().map(PathBuf::from).collect::<Vec<_>>();
    let inputs: Vec<&Path> = files.iter().chain(&machine_files).map(PathBuf::as_path).collect();
    let sweep = Sweep::new(&args.sweep, &inputs)?;
    let which = Variants { gross: args.gross, drawn: args.drawn, seed: args.sweep.seed };
    let mut all = vec![];
    for base in &bases {
        let programs = read(&files, &args.reader.settings()?, base, args.limit_s, console)?;
        let model = Arc::new(base.clone());
        let of_variants = jobs(programs, variants(base, which)).into_iter();
        all.extend(of_variants.map(|job| SweepJob { model: model.clone(), ..job }));
    }
    eprintln!("{} cuts by models of {} machines", all.len(), bases.len());
    let done = sweep.run(&all, console)?;
    let printing = done.print().and_then(|()| {
        let out = &mut *tables([args.sweep.json.as_deref()]);
        bases.iter().try_for_each(|base| print_base(base, &done.summary, out))
    });
    printed(printing, done.code())
}

/// What the cuts by the model of one machine came to.
fn print_base(base: &Machine, summary: &SweepSummary, out: &mut dyn Write) -> std::io::Result<()> {
    let prefix = format!("{}-", base.name);
    let of_base = || summary.rows.iter().filter(|judged| judged.row.machine.starts_with(&prefix));
    let ratios = of_base().filter(|judged| judged.row.is_judged()).map(|judged| judged.row.rms_ratio());
    let Some(Quantiles { cuts, median, p90, .. }) = Quantiles::of(ratios.collect()) else { return Ok(()) };
    let lost = of_base().filter(|judged| judged.faults.contains(&Failure::Lost)).count();
    let worse = of_base().filter(|judged| judged.faults.iter().any(|fault| *fault != Failure::Lost)).count();
    writeln!(
        out,
        "by the model of {}: median {median:.3}, 90 % {p90:.3} of the uncorrected RMS; {worse} of {cuts} cuts worse, \
         {lost} uncorrected at the end",
        base.name
    )
}
