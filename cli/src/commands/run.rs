//! `feedwright run`: a job from the arguments, a table from its outcome.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright::controllers::Choices;
use feedwright::fastest::{FastestError, FastestPlan};
use feedwright::job::{Job, JobError, JobOutcome, LogFile, MEASURED, Outputs};
use feedwright::machine::{self, Machine};
use feedwright::model::Model;
use feedwright::report::{Outcome as Ending, ReportedRun, RunSummary};
use miette::Result;

use crate::args::run::RunArgs;
use crate::console::Console;
use crate::controllers::{find, settings};
use crate::message::{OUT_OF_TOLERANCE, printed, tell, warn};

pub(crate) fn run(args: RunArgs, console: &Console) -> Result<ExitCode> {
    let job = job(args)?;
    let bar = console.bar(0);
    let outcome = job.run(&bar);
    bar.clear();
    // That nothing is fast enough is what the answer is, and no mistake of what was asked for.
    let outcome = match outcome {
        Err(error @ JobError::Fastest { error: FastestError::Impossible { .. }, .. }) => {
            tell(&error.into());
            return Ok(ExitCode::from(OUT_OF_TOLERANCE));
        }
        outcome => outcome?,
    };
    for warning in outcome.warnings.iter().cloned() {
        warn(warning.into());
    }
    for remark in outcome.without_identification.iter().cloned() {
        warn(remark.into());
    }
    outcome.log_findings.iter().for_each(|finding| eprintln!("{finding}"));
    let code = if outcome.within_tolerance { ExitCode::SUCCESS } else { ExitCode::from(OUT_OF_TOLERANCE) };
    printed(print(&job, &outcome), code)
}

fn job(args: RunArgs) -> Result<Job> {
    let report = args.report.unwrap_or_else(|| report_of(&args.part));
    let (controller, against) = (find(&args.controller)?, find(&args.against)?);
    let set = settings(&args.set, Some(controller), &[controller, against])?;
    Ok(Job {
        machine: Machine::load(&args.machine)?,
        controller,
        against,
        feed_mm_s: args.feed,
        choices: Choices { seed: args.seed, set },
        model: args.model.as_deref().map(Model::read).transpose()?,
        tolerance_um: args.tolerance,
        reference: args.reference.clone(),
        fastest: args.fastest,
        log: args.log.clone().map(|path| LogFile { path, columns: args.columns }),
        reader: args.reader.settings()?,
        inputs: Some(PathBuf::from(args.machine))
            .filter(|path| machine::is_path(path))
            .into_iter()
            .chain(args.reader.tool_table)
            .chain(args.model)
            .chain(args.log)
            .chain(args.reference)
            .collect(),
        outputs: Outputs { report: Some(report), json: args.json, trace: args.trace, out: args.out },
        part: args.part,
    })
}

/// `parts/star.ngc` gives `star.report.html`, in the folder where the user is.
fn report_of(part: &Path) -> PathBuf {
    let mut name = part.file_stem().unwrap_or_default().to_owned();
    name.push(".report.html");
    PathBuf::from(name)
}

/// A ratio for the table; a dash where there is none, as after a run that diverged at once.
fn ratio(value: f64, base: f64) -> String {
    if value.is_finite() && base > 0.0 { format!("{:.3}", value / base) } else { "-".to_owned() }
}

fn print(job: &Job, outcome: &JobOutcome) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    let runs = &outcome.report.runs;
    writeln!(
        out,
        "{:<18} {:>9} {:>10} {:>10} {:>10} {:>8} {:>8} {:>8}",
        "", "time s", "RMS um", "max um", "uncut um", "time", "RMS", "max"
    )?;
    for run in runs {
        let (now, first) = (&run.summary, &runs[0].summary);
        let ratio = |value: fn(&RunSummary) -> f64| ratio(value(now), value(first));
        writeln!(
            out,
            "{:<18} {:>9.3} {:>10.2} {:>10.2} {:>10.2} {:>8} {:>8} {:>8}",
            now.controller,
            now.time_s,
            now.rms_um,
            now.max_um,
            now.uncut_um,
            ratio(|s| s.time_s),
            ratio(|s| s.rms_um),
            ratio(|s| s.max_um)
        )?;
        if let (Some(rms_um), Some(max_um)) = (now.joint_rms_um, now.joint_max_um) {
            writeln!(out, "{:<18} without the geometry that no encoder sees: RMS {rms_um:.2}, max {max_um:.2} um", "")?;
        }
        if let Ending::Diverged { at_s } = now.outcome {
            writeln!(out, "{:<18} diverged at {at_s:.3} s: the servo loop of this machine is unstable", "")?;
        }
        if let Some(faded) = now.faded_out {
            let share = 100.0 * now.engaged_share;
            let last = if now.engaged_at_end { "last left it" } else { "left it for good" };
            writeln!(
                out,
                "{:<18} in the loop for {share:.1} % of the cut; {last} at {:.3} s, because {}",
                "", faded.at_s, faded.cause
            )?;
        }
    }
    if let Some(reference) = &job.reference {
        writeln!(out, "errors and uncut path are those to {}", reference.display())?;
    }
    print_worse(&mut out, runs)?;
    if let (Some(tolerance_um), Some(last)) = (job.tolerance_um, runs.last()) {
        let verdict = if outcome.within_tolerance { "within" } else { "out of" };
        writeln!(out, "{verdict} tolerance: max {:.2} um, allowed {tolerance_um} um", last.summary.max_um)?;
    }
    if let Some(plan) = &outcome.fastest {
        print_fastest(&mut out, plan)?;
    }
    print_written(&mut out, &job.outputs)
}

/// Which files there are.
fn print_written(out: &mut impl Write, outputs: &Outputs) -> std::io::Result<()> {
    for path in [&outputs.report, &outputs.json, &outputs.trace, &outputs.out].into_iter().flatten() {
        writeln!(out, "wrote {}", path.display())?;
    }
    if let Some(path) = outputs.out.as_deref().filter(|path| path.extension().is_some_and(|ending| ending != "csv")) {
        let path = path.display();
        writeln!(
            out,
            "{path} is the command of this cut, with feedback: `feedwright correct` writes programs for controls that have none"
        )?;
    }
    Ok(())
}

/// Says so where the controller does harm.
fn print_worse(out: &mut impl Write, runs: &[ReportedRun]) -> std::io::Result<()> {
    if let [first, .., last] = runs
        && first.summary.controller != MEASURED
        && last.summary.rms_um > first.summary.rms_um
        && last.summary.max_um > first.summary.max_um
    {
        let (worse, better) = (&last.summary.controller, &first.summary.controller);
        writeln!(out, "{worse} is worse than {better} for this part on this machine: do not use its command")?;
    }
    Ok(())
}

fn print_fastest(out: &mut impl Write, plan: &FastestPlan) -> std::io::Result<()> {
    let FastestPlan { cycle, largest_um, rounds, machine, .. } = plan;
    let moving_s = cycle.cutting_s + cycle.rapid_s;
    writeln!(out, "least time: {moving_s:.3} s of motion, largest error {largest_um:.2} um, found in {rounds} cuts")?;
    if let Some(bound_s) = cycle.bound_s {
        writeln!(out, "  bound of the path alone {bound_s:.3} s, motion {:.4} times that", moving_s / bound_s)?;
    }
    if let Some(path_um) = machine.limits.path_tolerance_um {
        writeln!(out, "  of the tolerance, {path_um:.2} um are the path's")?;
    }
    for binding in &cycle.binding {
        writeln!(out, "  {:<16} binds {:>5.1} % of the motion", binding.limit, 100.0 * binding.share)?;
    }
    Ok(())
}
