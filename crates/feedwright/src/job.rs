//! The main job: a program and a machine in, every controller's cut, its rows and the report out.
//!
//! Calls, no arithmetic. The program is read twice: once to find every mistake before anything is
//! cut, once for each cut, as a stream. A cut is a [`Run`](feedwright_sim::Run). [`Job::check`] and
//! [`CheckedJob::run_with`] go through the stages in this order:
//!
//! | File | Stage |
//! |---|---|
//! | `job/lowered.rs` | the job of a request: files are read, names looked up |
//! | `job/values.rs` | which values it takes |
//! | `job/read.rs` | program, reference and log are read, and suit the machine |
//! | `job/model_of_log.rs` | the model of the machine, from a log |
//! | `job/planned.rs` | what all cuts share: the plan, the paths, the circles |
//! | `job/cuts.rs` | one cut for each controller |
//! | `job/band.rs` | cuts on other machines that fit the log of the model |
//! | `job/measured_cut.rs` | the cut that a log shows |
//! | `job/exported.rs` | the corrected program for a control without feedback |
//! | `job/report.rs` | what the page shows |
//!
//! | File | What the stages use |
//! |---|---|
//! | `job/guests.rs` | what takes part in a run and was made elsewhere |
//! | `job/record.rs` | what is kept of the rows of a run |
//! | `job/assumed.rs` | what a job assumes of its machine |
//! | `job/listing.rs` | lines of the program for the page |
//! | `job/results.rs` | the figures as JSON |

mod guests;
mod lowered;
mod values;
mod read;
mod model_of_log;
mod record;
mod planned;
mod cuts;
mod band;
mod measured_cut;
mod exported;
mod assumed;
mod listing;
mod report;
mod results;

use std::sync::Arc;

use feedwright_gcode::{self, Program};
use feedwright_ident::{LogFinding, Model};
use feedwright_sim::cycle_time::CycleTimeOfCut;
use feedwright_sim::{Machine, Sink, Watch};

use crate::compensation::GeometryChoice;
use crate::controllers::{Choices, CutsUncorrected, Entry, LQG_IDENTIFIED, UNCORRECTED};
use crate::correct::{CorrectOutcome, TargetControl};
use crate::fastest::{FastestPlan, TolerancePlan};
pub use crate::job_error::JobError;
use crate::measured::MeasuredLog;
use crate::report::Report;
use crate::report::harm::Harm;
use crate::request::JobRequest;
pub use guests::Guests;
pub use read::CheckedJob;

/// A request whose files are read and whose names are looked up, so that it can run.
///
/// [`Job::new`] cuts the program without a correction and with the default controller. What else is
/// wanted of it is an option of its `request`, such as `job.request.tolerance_um`. The other fields
/// are what the request's names and paths stand for. [`JobRequest::job`] makes a job of a request.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Job {
    /// The options. Its names and paths are those of the other fields; a job does not look them up
    /// again.
    pub request: JobRequest,
    /// Date of the models that come of the job, year-month-day.
    pub(crate) today: String,
    /// The G-code program.
    pub program: Program,
    /// The machine that cuts it.
    pub machine: Machine,
    /// The machine that records the log of a missing model: as its file has it, whatever limits
    /// `machine` is planned with.
    recorder: Machine,
    /// The geometry that the control compensates, in all cuts.
    pub compensation: GeometryChoice,
    /// The requested controller.
    pub controller: &'static Entry,
    /// Controller for comparison.
    pub against: &'static Entry,
    /// Settings of the controllers.
    pub choices: Choices,
    /// A model for the requested controller, in place of a training. One that is missing comes from
    /// a simulated log, or with `exact_settings` from a training on the machine.
    pub(crate) model: Option<Model>,
    /// Machines that fit the recording of the model. Each is cut with the controller too, and the
    /// results are the band of the report.
    pub fitting: Vec<Machine>,
    /// The control, without feedback, that a corrected program is made for.
    pub target: Option<&'static TargetControl>,
    /// Plans the program with the planner of this control instead of the machine's planner.
    pub(crate) planned_as: Option<&'static TargetControl>,
    /// A program that errors are measured to, in place of the one that is cut.
    pub(crate) reference: Option<Program>,
    /// Log that a machine recorded while it cut the program, shown beside the predicted values.
    pub(crate) log: Option<Arc<MeasuredLog>>,
    /// Settings of the reader.
    pub reader: feedwright_gcode::Settings,
}

/// Result of a job. The run for comparison is the first, then the measured run if there is a
/// log, then the requested controller's run.
#[derive(Debug)]
#[non_exhaustive]
pub struct JobOutcome {
    /// Everything that the page shows.
    pub report: Report,
    /// Warnings of the reader.
    pub warnings: Vec<feedwright_gcode::Diagnostic>,
    /// Axes that the log of the model does not determine well enough, in words.
    pub undetermined: Vec<String>,
    /// Controllers that cut uncorrected, because nothing was identified that they could use.
    pub without_identification: Vec<CutsUncorrected>,
    /// Guesses about the log, and remarks on it.
    pub log_findings: Vec<LogFinding>,
    /// The model that the controller had at the end of the cut, if it was given one and this model
    /// was requested.
    pub learned: Option<Model>,
    /// The corrected program for another control, if one was requested; its run is the last.
    pub(crate) exported: Option<CorrectOutcome>,
    /// The plan of least time, if it was requested.
    pub fastest: Option<FastestPlan>,
    /// Tolerance of the planned path, um, where it is a part of the tolerance of the tool.
    pub(crate) path_um: Option<f64>,
    /// Respects in which the correction is worse than uncorrected; empty where it is compared with
    /// something else.
    pub(crate) harm: Vec<Harm>,
    /// True if the command of the controller may be used: it was cut to its end, does no harm, and
    /// asks no drive for twice its limit.
    pub is_of_use: bool,
    /// True if the last run was cut to its end and within the requested tolerance, if any, and a
    /// requested program is better than the original.
    pub within_tolerance: bool,
}

impl Job {
    /// Cuts a program on a machine without a correction, and with the default controller.
    pub fn new(program: Program, machine: Machine) -> Self {
        Self {
            request: JobRequest {
                exact_settings: true,
                ..JobRequest::default()
            },
            today: String::new(),
            program,
            recorder: machine.clone(),
            machine,
            compensation: GeometryChoice::default(),
            controller: &LQG_IDENTIFIED,
            against: &UNCORRECTED,
            choices: Choices::default(),
            model: None,
            fitting: Vec::new(),
            target: None,
            planned_as: None,
            reference: None,
            log: None,
            reader: feedwright_gcode::Settings::default(),
        }
    }

    /// Runs it.
    ///
    /// # Errors
    /// A value out of its range, a program with mistakes, more axes than the machine has, or an end
    /// from outside.
    pub fn run(&self, watch: &dyn Watch) -> Result<JobOutcome, JobError> {
        watch.begin("reading the program", 1);
        self.check()?.run(&mut [], watch)
    }
}

impl CheckedJob<'_> {
    /// The plan whose path uses what the machine leaves of the job's tolerance; `None` without a
    /// tolerance, on a machine that is not planned axis by axis, and where the machine needs all of
    /// it.
    ///
    /// # Errors
    /// As [`CheckedJob::run`].
    pub fn tolerance_plan(&self, watch: &dyn Watch) -> Result<Option<TolerancePlan>, JobError> {
        let (job, _) = self.with_model(watch)?;
        job.tolerance_plan(self.axes, watch)
    }

    /// Cuts the program; the sinks receive the rows of the requested controller.
    ///
    /// # Errors
    /// A log that gives no model, a cut that does not come to its end, a sink that fails, or a
    /// cancellation.
    pub fn run(
        &self,
        rows: &mut [&mut dyn Sink],
        watch: &dyn Watch,
    ) -> Result<JobOutcome, JobError> {
        self.run_with(Guests::default(), rows, watch)
    }

    /// Works as [`CheckedJob::run`], with parts that were made elsewhere.
    ///
    /// # Errors
    /// See there.
    pub fn run_with(
        &self,
        guests: Guests<'_>,
        rows: &mut [&mut dyn Sink],
        watch: &dyn Watch,
    ) -> Result<JobOutcome, JobError> {
        let (job, undetermined) = self.with_model(watch)?;
        let plan = job.plan(self.axes, watch)?;
        let cycle = job.looks_at_cut(&plan);
        let cut = plan.cut(guests, cycle.as_ref().map(|cycle| cycle as _));
        let mut cuts = job.cut_each(self, guests.controller, cut, rows, watch)?;
        let band = job.band(self.axes, cut, cuts.completed(), watch)?;
        let cycle = cycle.filter(|_| cuts.completed().is_some());
        let cycle = cycle.map(CycleTimeOfCut::finish);
        let log_findings = job.insert_measured(&mut cuts.runs, self.axes, &plan.circles, watch)?;
        let exported = job.push_exported(&mut cuts.runs, &plan.circles, watch)?;
        let limits = job.limit_band(&plan, cycle.as_ref(), watch)?;
        let report = Report {
            limits,
            band,
            geometry: cuts.geometry,
            ..job.report(
                self.axes,
                &self.summary,
                plan.circles,
                cuts.runs,
                &cuts.without_identification,
            )?
        };
        Ok(JobOutcome {
            harm: report.harm(),
            is_of_use: report.is_of_use(),
            within_tolerance: report.is_within_tolerance()
                && exported
                    .as_ref()
                    .is_none_or(|outcome| outcome.refusal.is_none()),
            warnings: self.warnings(),
            report,
            undetermined,
            without_identification: cuts.without_identification,
            log_findings,
            learned: cuts.learned,
            exported,
            fastest: plan.fastest,
            path_um: plan.share_um,
        })
    }
}
