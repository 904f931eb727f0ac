//! `feedwright run`: a job from the arguments, a summary of its outcome.

mod files;
mod summary;

use std::path::Path;
use std::process::ExitCode;

use feedwright_control::IdentifierKind;
use feedwright_sim::{Stages, Watch};
use miette::{Result, miette};

use crate::command::args::run::RunArgs;
use crate::command::console::Console;
use crate::command::date::today;
use crate::command::message::{
    OUT_OF_TOLERANCE, printed, remark, report_assumed_limits, show, warn,
};
use crate::command::streams::{check_request, outputs_of, tables};
use crate::controllers::{BEST, Controllers};
use crate::correct::TARGETS;
use crate::fastest::FastestError;
use crate::job::{Job, JobError};
use crate::output::OutputError;
use crate::request::JobRequest;
use crate::request::named::find;
use files::{Files, Outputs};

/// Cuts a part with controllers of a table.
pub fn run(args: RunArgs, table: Controllers, console: &Console) -> Result<ExitCode> {
    let outputs = Outputs::of(&args);
    let request = asked(&args, &outputs, table)?;
    check_request(console, &request)?;
    let bar = console.bar(0);
    let job = request.job(table, &today()?, &bar)?;
    if let Some(stages) = limits_used(&job) {
        report_assumed_limits(&job.machine, stages);
    }
    bar.begin("reading the program", 1);
    let checked = job.check()?;
    let mut files = Files::create(&outputs, outputs_of(&request), checked.axes())?;
    let outcome = match checked.run(&mut [&mut files], &bar) {
        Ok(outcome) => outcome,
        // That nothing is fast enough is what the answer is, and no mistake of what was asked for.
        Err(
            error @ JobError::Fastest {
                error: FastestError::Impossible { .. },
                ..
            },
        ) => {
            bar.clear();
            show(&error.into());
            return Ok(ExitCode::from(OUT_OF_TOLERANCE));
        }
        // The rows go to files, whose errors name them.
        Err(JobError::Write(error)) => {
            return Err(OutputError::from_io(error, Path::new("the output")).into());
        }
        Err(error) => return Err(error.into()),
    };
    bar.begin("writing", 1);
    files.finish(&job, &outcome, &bar)?;
    bar.clear();
    for warning in outcome.warnings.iter().cloned() {
        warn(warning.into());
    }
    for remark in outcome.without_identification.iter().cloned() {
        warn(remark.into());
    }
    outcome.undetermined.iter().for_each(|axes| remark(axes));
    outcome
        .log_findings
        .iter()
        .for_each(|finding| remark(&finding.to_string()));
    // Where a program for another control was asked for, that program decides.
    let corrects = outcome.harm.is_empty() && !outcome.report.is_mostly_uncorrected();
    let is_good = outcome.within_tolerance && (corrects || outcome.exported.is_some());
    let code = if is_good {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(OUT_OF_TOLERANCE)
    };
    let Outputs {
        report,
        json,
        trace,
        learned,
        out,
    } = &outputs;
    let mut table = tables([report, json, trace, learned, out].map(Option::as_deref));
    printed(summary::print(&mut *table, &job, &outputs, &outcome), code)
}

/// Returns the request of the arguments.
fn asked(args: &RunArgs, outputs: &Outputs, table: Controllers) -> Result<JobRequest> {
    let is_program = outputs.is_program()?;
    if let (Some(controller), true, Some(out)) = (&args.controller, is_program, &outputs.out) {
        return Err(no_part(controller, &args.part, out));
    }
    let mut request = args.request()?;
    let controller = find(&request.controller, table)?;
    if request.learns && controller.identifier != Some(IdentifierKind::Axes) {
        return Err(miette!(
            help = format!("leave --learned out, or choose --controller {BEST}"),
            "{} learns no model of the axes",
            controller.name
        ));
    }
    let target = target(args.target.as_deref(), outputs.out.as_deref())?;
    request.target = is_program.then(|| target.to_owned());
    Ok(request)
}

/// The stages whose limits the job assumes where the machine states none.
fn limits_used(job: &Job) -> Option<Stages> {
    if job.request.fastest {
        return Some(Stages::of(&job.machine.planned_by_axes(1.0)));
    }
    job.target.map(|target| target.stages(&job.machine))
}

/// Returns the error of a request for a corrected program together with a controller.
fn no_part(controller: &str, part: &Path, out: &Path) -> miette::Report {
    miette!(
        help = format!(
            "feedwright correct {} --out {} writes the program; or leave --controller out; or write the setpoints of \
             {controller}: --out FILE.csv",
            part.display(),
            out.display()
        ),
        "--controller {controller} has no part in a corrected program, which is cut without a controller"
    )
}

/// The name of the control that a program is for; setpoints are for none.
fn target<'a>(name: Option<&'a str>, out: Option<&Path>) -> Result<&'a str> {
    match (name, out) {
        (Some(_), Some(out))
            if out
                .extension()
                .is_some_and(|ending| ending.eq_ignore_ascii_case("csv")) =>
        {
            Err(miette!(
                help = "leave --for out, or write a program: --out FILE.ngc",
                "--for is the control of a program, and {} is for setpoints",
                out.display()
            ))
        }
        (name, _) => Ok(name.unwrap_or(TARGETS[0].name)),
    }
}
