//! `feedwright-lab held-out`: random programs on random machines, uncorrected and corrected.
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use feedwright::command::{Console, make_folder, printed};
use feedwright::{OutputFile, OutputFiles};
use feedwright_sim::Watch;
use miette::{IntoDiagnostic, Result};

use crate::command::args::held_out::HeldOutArgs;
use crate::command::sweep::{Sweep, code, print};
use crate::held_out::machines::Class;
use crate::never_worse::SweepJob;
use crate::never_worse::generated::{Generated, draw};
use crate::never_worse::summary::{Judged, SweepSummary};

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
    eprintln!(
        "{} cuts drawn by seed {}, {} programs for each machine",
        args.count, args.drawn_by, args.programs
    );
    let jobs: Vec<SweepJob> = generated.iter().map(|made| made.job.clone()).collect();
    let (summary, printing) = sweep.run(&jobs, console, SweepSummary::of, print)?;
    if let Some(folder) = &args.failures {
        write_failures(folder, &summary.rows, &generated, &console.bar(0))?;
    }
    printed(printing, code(summary.worse > 0))
}

/// Writes the program and the machine of each failure.
fn write_failures(
    folder: &Path,
    rows: &[Judged],
    generated: &[Generated],
    watch: &dyn Watch,
) -> Result<()> {
    let failures = rows.iter().filter(|judged| !judged.faults.is_empty());
    for (number, Judged { row, .. }) in (1..).zip(failures) {
        let is_it = |made: &&Generated| {
            made.job.program.name == row.program && made.job.machine.name == row.machine
        };
        let Some(made) = generated.iter().find(is_it) else {
            continue;
        };
        let mut files = OutputFiles::default();
        let mut complete = vec![];
        for (ending, text) in [("ngc", &made.text), ("toml", &made.variant.text())] {
            let mut file = files.start(&folder.join(format!("{number}.{ending}")))?;
            file.write_all(text.as_bytes()).into_diagnostic()?;
            complete.push(file);
        }
        OutputFile::commit_all(complete, watch)?;
    }
    Ok(())
}
