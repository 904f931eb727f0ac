//! `feedwright run`: a job from the arguments, a summary of its outcome.

mod files;
mod summary;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::str::FromStr;

use feedwright_control::IdentifierKind;
use feedwright_gcode::Program;
use feedwright_gcode::input::{self, is_standard_input};
use feedwright_ident::{Columns, Log, Model};
use feedwright_sim::{Machine, Stages, Watch, is_machine_path};
use miette::{Result, miette};

use crate::command::args::run::RunArgs;
use crate::command::console::Console;
use crate::command::controllers::{find, settings};
use crate::command::controls::{compensation, control, take_model};
use crate::command::date::today;
use crate::command::message::{OUT_OF_TOLERANCE, printed, remark, tell, tell_assumed_limits, warn};
use crate::command::progress::Bar;
use crate::command::streams::{check_inputs, tables};
use crate::controllers::{BEST, Choices, Controllers};
use crate::correct::{TARGETS, TargetControl, corrected_for};
use crate::fastest::FastestError;
use crate::job::{Job, JobError};
use crate::measured::MeasuredLog;
use crate::output::OutputError;
use files::{Files, Outputs};

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
            ("--geometry", args.geometry.geometry.as_deref()),
            ("--tool-table", args.reader.tool_table.as_deref()),
        ],
    )?;
    let bar = console.bar(0);
    let (exact_settings, band) = (args.exact_settings, usize::from(args.band));
    let Asked {
        mut job,
        inputs,
        outputs,
    } = asked(args, table, &bar)?;
    bar.begin("reading the program", 1);
    let read = job.check()?;
    let (axes, summary) = (read.axes(), read.into_summary());
    let mut files = Files::create(&outputs, inputs.iter().map(PathBuf::as_path), axes)?;
    let of_machine = job.machine.clone();
    let doubts = if exact_settings {
        vec![]
    } else {
        take_model(&mut job, &of_machine, axes, band, &bar)?
    };
    let checked = job.check_read(summary)?;
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
            tell(&error.into());
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
    doubts.iter().for_each(|doubt| remark(doubt));
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

/// The job, and the files, that the arguments request.
struct Asked {
    job: Job,
    /// Files that no output may take the place of.
    inputs: Vec<PathBuf>,
    outputs: Outputs,
}

fn asked(args: RunArgs, table: Controllers, bar: &Bar) -> Result<Asked> {
    let machine_file = Some(PathBuf::from(&args.machine)).filter(|path| is_machine_path(path));
    let report = args.report.unwrap_or_else(|| report_of(&args.part));
    let outputs = Outputs {
        report: Some(report),
        json: args.json,
        trace: args.trace,
        learned: args.learned,
        out: args.out,
    };
    if let (Some(controller), true, Some(out)) =
        (&args.controller, outputs.is_program()?, &outputs.out)
    {
        return Err(no_part(controller, &args.part, out));
    }
    let controller = find(args.controller.as_deref().unwrap_or(BEST), table)?;
    let against = find(&args.against, table)?;
    if outputs.learned.is_some() && controller.identifier != Some(IdentifierKind::Axes) {
        return Err(miette!(
            help = format!("leave --learned out, or choose --controller {BEST}"),
            "{} learns no model of the axes",
            controller.name
        ));
    }
    let target = target(args.target.as_deref(), outputs.out.as_deref())?;
    let set = settings(&args.set, table, Some(controller), &[controller, against])?;
    let machine = Machine::load(&args.machine)?;
    if args.fastest {
        tell_assumed_limits(&machine, Stages::of(&machine.planned_by_axes(1.0)));
    } else if outputs.is_program()? {
        tell_assumed_limits(&machine, target.stages(&machine));
    }
    let mut job = Job::new(Program::in_file(&args.part), machine);
    job.machine_file = machine_file.as_deref().map(input::name);
    (job.controller, job.against) = (controller, against);
    job.compensation = compensation(&args.geometry)?;
    job.feed_mm_s = args.feed;
    job.choices = Choices {
        seed: args.seed,
        set,
        tries: true,
        ..Choices::default()
    };
    let recorded = [controller, against]
        .into_iter()
        .filter_map(|entry| Some((entry, table.recorded(&job.machine, entry)?)));
    job.choices
        .take_recorded(recorded.collect::<Vec<_>>().into_iter());
    job.model = args.model.as_deref().map(Model::read).transpose()?;
    job.learned_on = outputs.learned.is_some().then(today).transpose()?;
    job.tolerance_um = args.tolerance;
    job.target = outputs.is_program()?.then_some(target);
    job.reference = args.reference.as_ref().map(Program::in_file);
    job.planned_as = job
        .reference
        .as_ref()
        .and_then(|_| corrected_for(&job.program));
    if job.planned_as.is_some() {
        job.compensation = job.compensation.in_program();
    }
    job.fastest = args.fastest;
    job.with_limits = true;
    job.reader = args.reader.settings()?;
    if let Some(path) = &args.log {
        let columns = args
            .columns
            .as_deref()
            .map(Columns::from_str)
            .transpose()?
            .unwrap_or_default();
        job.log = Some(MeasuredLog {
            name: input::name(path),
            log: Log::read_watched(path, &columns, bar)?,
        });
    }
    let models = [args.model, args.geometry.geometry, args.log];
    let read = [
        machine_file,
        args.reader.tool_table,
        args.reference,
        Some(args.part),
    ]
    .into_iter()
    .chain(models);
    Ok(Asked {
        job,
        inputs: read.flatten().collect(),
        outputs,
    })
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

/// The control that a program is for; setpoints are for none.
fn target(name: Option<&str>, out: Option<&Path>) -> Result<&'static TargetControl> {
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
