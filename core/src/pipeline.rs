//! The main job, in the order in which data flows: program in, every controller's cut, report and files out.
//!
//! Calls, no arithmetic. The program is read twice: once to find every mistake before anything is written, once for each
//! cut, as a stream.

mod files;
mod job;

use feedwright_control::Controller;

use crate::controllers::{Entry, Make, Setup};
use crate::gcode::{self, Summary};
use crate::plc::Plc;
use crate::reference::Reference;
use crate::report::{Report, Run, RunFacts, Series, Statistics};
use crate::simulate::{practise, simulate_lap};
use crate::trace::Sink;
pub use files::Outputs;
use files::{Files, Timeline};
pub use job::{Error, Job, Progress, Stage};

/// What a job came to. The runs stand in the order in which they were made: what is compared against, then the
/// controller that was asked for.
#[derive(Debug)]
pub struct Outcome {
    /// Everything that the page shows.
    pub report: Report,
    /// What the reader warned of.
    pub warnings: Vec<gcode::Diagnostic>,
    /// Whether the last run was cut to its end and within the tolerance, where one was asked for.
    pub within_tolerance: bool,
}

/// Runs a job and writes its files.
///
/// # Errors
/// A program with mistakes, more axes than the machine has, or a file that cannot be written. No file appears then.
pub fn run(job: &Job, progress: &mut dyn Progress) -> Result<Outcome, Error> {
    progress.stage(Stage::Reading);
    job.check_values()?;
    let summary = gcode::check(&job.part, job.reader.clone())?;
    let axes = job.axes(&summary)?;
    if let Some(model) = &job.model {
        job.controller.suits(model, &job.machine.known(), axes, &job.choices)?;
    }
    let outcome = match axes {
        2 => cut::<2>(job, &summary, progress),
        _ => cut::<3>(job, &summary, progress),
    }?;
    Ok(outcome)
}

fn cut<const N: usize>(job: &Job, summary: &Summary, progress: &mut dyn Progress) -> Result<Outcome, Error>
where
    Entry: Make<N>,
{
    let mut files = Files::create(job, N)?;
    let mut runs = Vec::new();
    for entry in job.controllers() {
        progress.stage(Stage::Preparing { controller: entry.name });
        let mut told = |part: f64| progress.part(part);
        let mut setup = Setup::new(&job.machine, &job.choices).telling(&mut told);
        let judged = entry.name == job.controller.name;
        let mut controller = match job.model.as_ref().filter(|_| judged) {
            Some(model) => Make::<N>::make_with(entry, setup, model)?,
            None => Make::<N>::make(entry, &mut setup),
        };
        progress.stage(Stage::Cutting { controller: entry.name });
        runs.push(cut_once(job, summary, entry, &mut *controller, judged.then_some(&mut files), progress)?);
    }
    progress.stage(Stage::Writing);
    let report = job.report(N, summary, runs);
    let within_tolerance = job.within_tolerance(&report);
    files.finish(job, &report)?;
    let warnings = summary.warnings.iter().cloned().chain(summary.uncontrolled()).collect();
    Ok(Outcome { report, warnings, within_tolerance })
}

fn cut_once<const N: usize>(
    job: &Job,
    summary: &Summary,
    entry: &Entry,
    controller: &mut dyn Controller<N>,
    files: Option<&mut Files>,
    progress: &mut dyn Progress,
) -> Result<Run, Error> {
    let plc = Plc::new(job.machine.plc).with_events(&job.machine.plc_events);
    let reference = || -> Result<Reference<'_>, Error> {
        Ok(Reference::new(job.program()?, &(&job.machine.limits).into())?.with_plc(plc.clone()))
    };
    practise(&job.machine, reference, controller, entry.laps)?;
    let mut reference = reference()?;
    let (mut statistics, mut series, mut timeline) =
        (Statistics::new(), Series::new(), Timeline::new(&job.machine.plc_events));
    let mut told = job::Told::new(progress, summary);
    let mut sinks: Vec<&mut dyn Sink> = vec![&mut statistics, &mut series, &mut timeline, &mut told];
    sinks.extend(files.map(|files| files as &mut dyn Sink));
    let run = simulate_lap(&job.machine, &mut reference, controller, &mut sinks)?;
    if let Some(fault) = reference.fault() {
        return Err(Error::Path { part: job.part.clone(), fault: fault.clone() });
    }
    let facts = RunFacts {
        controller: entry.name.to_owned(),
        machine: job.machine.name.clone(),
        part: job.part_name(),
        axes: N,
        run,
    };
    let mut summary = statistics.summary(facts, |_| String::new());
    job.fill_in_texts(&mut summary.worst)?;
    Ok(Run { summary, series, events: timeline.events })
}
