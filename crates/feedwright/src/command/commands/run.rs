//! `feedwright run`: a job from the arguments, a summary of its outcome.

mod summary;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use feedwright_gcode::input::is_standard_input;
use feedwright_ident::Model;
use feedwright_sim::{Machine, is_machine_path};
use miette::{Result, miette};

use crate::command::args::run::RunArgs;
use crate::command::console::Console;
use crate::command::controllers::{find, settings};
use crate::command::controls::control;
use crate::command::message::{OUT_OF_TOLERANCE, printed, remark, tell, warn};
use crate::command::streams::{check_inputs, tables};
use crate::controllers::{Choices, Controllers};
use crate::correct::{TARGETS, TargetControl};
use crate::fastest::FastestError;
use crate::job::{Job, JobError, LogFile, Outputs};

/// Cuts a part with controllers of a table.
pub fn run(args: RunArgs, table: Controllers, console: &Console) -> Result<ExitCode> {
    check_inputs(
        console,
        [
            ("the program", Some(args.part.as_path())),
            ("--machine", Some(Path::new(&args.machine))),
            ("--reference", args.reference.as_deref()),
            ("--model", args.model.as_deref()),
            ("--log", args.log.as_deref()),
            ("--tool-table", args.reader.tool_table.as_deref()),
        ],
    )?;
    let job = job(args, table)?;
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
    outcome.log_findings.iter().for_each(|finding| remark(&finding.to_string()));
    // Where a program for another control was asked for, that program decides.
    let is_good = outcome.within_tolerance && (outcome.harm.is_empty() || outcome.exported.is_some());
    let code = if is_good { ExitCode::SUCCESS } else { ExitCode::from(OUT_OF_TOLERANCE) };
    let Outputs { report, json, trace, out } = &job.outputs;
    let mut table = tables([report, json, trace, out].map(Option::as_deref));
    printed(summary::print(&mut *table, &job, &outcome), code)
}

fn job(args: RunArgs, table: Controllers) -> Result<Job> {
    let report = args.report.unwrap_or_else(|| report_of(&args.part));
    let (controller, against) = (find(&args.controller, table)?, find(&args.against, table)?);
    let target = target(args.target.as_deref(), args.out.as_deref())?;
    let set = settings(&args.set, table, Some(controller), &[controller, against])?;
    let mut machine = Machine::load(&args.machine)?;
    if args.fastest && machine.limits.path_tolerance_um.is_none() {
        machine.limits.path_tolerance_um = args.tolerance;
    }
    Ok(Job {
        machine,
        machine_file: Some(PathBuf::from(&args.machine)).filter(|path| is_machine_path(path)),
        controller,
        against,
        feed_mm_s: args.feed,
        choices: Choices { seed: args.seed, set },
        model: args.model.as_deref().map(Model::read).transpose()?,
        tolerance_um: args.tolerance,
        target,
        reference: args.reference.clone(),
        fastest: args.fastest,
        log: args.log.clone().map(|path| LogFile { path, columns: args.columns }),
        reader: args.reader.settings()?,
        inputs: Some(PathBuf::from(args.machine))
            .filter(|path| is_machine_path(path))
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

/// The control that a program is for; setpoints are for none.
fn target(name: Option<&str>, out: Option<&Path>) -> Result<&'static TargetControl> {
    match (name, out) {
        (Some(_), Some(out)) if out.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv")) => {
            Err(miette!(
                help = "leave --for out, or write a program: --out FILE.ngc",
                "--for is the control of a program, and {} is for setpoints",
                out.display()
            ))
        }
        (name, _) => name.map_or(Ok(&TARGETS[0]), control),
    }
}

/// `parts/star.ngc` gives `star.report.html`, in the folder where the user is.
fn report_of(part: &Path) -> PathBuf {
    if is_standard_input(part) {
        return PathBuf::from("stdin.report.html");
    }
    let mut name = part.file_stem().unwrap_or_default().to_owned();
    name.push(".report.html");
    PathBuf::from(name)
}
