//! `feedwright-lab held-out`: random programs on random machines, uncorrected and corrected, and the smallest case of what fails.
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use feedwright::command::{Console, make_folder, printed};
use feedwright::{OutputFile, OutputFiles};
use feedwright_sim::Watch;
use miette::{IntoDiagnostic, Result};

use crate::command::args::held_out::HeldOutArgs;
use crate::command::sweep::{Sweep, code};
use crate::held_out::machines::Class;
use crate::never_worse::generated::{Generated, draw, smallest};
use crate::never_worse::summary::{Judged, SweepSummary};
use crate::never_worse::{SweepJob, SweepOptions};

/// Trials for each failure: enough for a few hundred lines and a machine of thirty changes.
const TRIALS: u32 = 400;

pub(crate) fn run(args: &HeldOutArgs, console: &Console) -> Result<ExitCode> {
    let sweep = Sweep::new(&args.sweep, std::slice::from_ref(&args.one.controller), &[])?;
    if let Some(folder) = &args.failures {
        make_folder(folder)?;
    }
    let class = match (args.rigid, args.realistic) {
        (true, _) => Class::Rigid,
        (_, true) => Class::Realistic,
        _ => Class::Any,
    };
    let generated = draw(args.drawn_by, args.count, args.programs.into(), class)?;
    eprintln!("{} cuts drawn by seed {}, {} programs for each machine", args.count, args.drawn_by, args.programs);
    let jobs: Vec<SweepJob> = generated.iter().map(|made| made.job.clone()).collect();
    let options = sweep.options.clone();
    let mut done = sweep.run(jobs, console)?;
    let summary = SweepSummary::of(std::mem::take(&mut done.rows));
    let printing = sweep.write(&summary, console).map(|mut out| done.print(&summary, &mut out))?;
    if let Some(folder) = &args.failures {
        let failures = summary.rows.iter().filter(|judged| !judged.faults.is_empty()).take(args.smallest);
        write_smallest(folder, failures, &generated, &options, console)?;
    }
    printed(printing, code(summary.worse))
}

/// Makes each failure smaller and writes it.
fn write_smallest<'a>(
    folder: &Path,
    failures: impl Iterator<Item = &'a Judged>,
    generated: &[Generated],
    options: &SweepOptions,
    console: &Console,
) -> Result<()> {
    let failures: Vec<&Judged> = failures.collect();
    let bar = console.bar(failures.len() as u64);
    bar.say("making failures smaller");
    for (number, failure) in (1..).zip(failures) {
        let is_it = |made: &&Generated| {
            made.job.program.name == failure.row.program && made.job.machine.name == failure.row.machine
        };
        let Some(made) = generated.iter().find(is_it) else { continue };
        let (case, row) = smallest(&made.case, &failure.faults, options, TRIALS, &bar)?;
        let [program, machine] = ["ngc", "toml"].map(|ending| folder.join(format!("{number}.{ending}")));
        write(&program, &case.text(), &bar)?;
        write(&machine, &case.machine.text(), &bar)?;
        let figures = row.map_or(String::new(), |row| {
            let (before, after) = (row.uncorrected, row.corrected);
            format!(", {:.2} / {:.1} -> {:.2} / {:.1} um", before.rms_um, before.max_um, after.rms_um, after.max_um)
        });
        let (lines, changes) = (case.lines.len(), case.machine.changes.len());
        bar.aside(|| eprintln!("wrote {} and .toml: {lines} lines, {changes} changes{figures}", program.display()));
        bar.advance(1);
    }
    bar.clear();
    Ok(())
}

fn write(path: &Path, text: &str, watch: &dyn Watch) -> Result<()> {
    let mut file = OutputFiles::default().start(path)?;
    file.write_all(text.as_bytes()).into_diagnostic()?;
    OutputFile::commit_all(vec![file], watch)?;
    Ok(())
}
