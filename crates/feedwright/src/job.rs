//! The main job: a program and a machine in, every controller's cut, its rows and the report out.
//!
//! Calls, no arithmetic. The program is read twice: once to find every mistake before anything is
//! cut, once for each cut, as a stream. A cut is a [`Run`].
//!
//! | File | What |
//! |---|---|
//! | `job/guests.rs` | what takes part in a run and was made elsewhere |
//! | `job/assumed.rs` | what it assumes of its machine |
//! | `job/values.rs` | which values it takes |
//! | `job/record.rs` | what it keeps of the rows of a run |
//! | `job/cuts.rs` | its cuts: one for each controller, on one plan |
//! | `job/band.rs` | cuts on other machines that fit the recording of the model |
//! | `job/exported.rs` | the corrected program for a control without feedback |
//! | `job/report.rs` | what the page shows |
//! | `job/listing.rs` | lines of the program for it |
//! | `job/results.rs` | its figures as JSON |
//! | `job/stored.rs` | how it is serialised |

mod guests;
mod assumed;
mod values;
mod record;
mod cuts;
mod band;
mod exported;
mod report;
mod listing;
mod results;
mod stored;

use std::borrow::Cow;

use feedwright_control::Controller;
use feedwright_gcode::canon::Canon;
use feedwright_gcode::{self, Program, ReadError, Summary};
use feedwright_ident::{LogFinding, Model};
use feedwright_plan::{AlignedPaths, Constraints, PlanSink, Step, Steps};
use feedwright_sim::{Machine, Outcome, PlanCache, RunError, Sink, Stages, Watch, path_steps};
use serde::{Deserialize, Serialize};

use crate::compensation::GeometryChoice;
use crate::controllers::{
    Choices, CutsUncorrected, Entry, LQG_IDENTIFIED, Make, Setup, UNCORRECTED,
};
use crate::correct::{CorrectOutcome, TargetControl};
use crate::cycle_time::CycleTimeOfCut;
use crate::fastest::{FastestError, FastestPlan, TolerancePlan, fastest, plan_within};
pub use crate::job_error::JobError;
use crate::job_error::axes_that_move;
use crate::measured::{MeasuredLog, MeasuredRun, measured};
use crate::report::harm::Harm;
use crate::report::{FullCircle, Report, ReportedRun, Role, full_circles};
use cuts::{Cuts, PlannedCut, with_feeds};
pub use guests::Guests;
use record::RunRecord;

/// A program, a machine, two controllers, and what is wanted of the cuts.
///
/// [`Job::new`] cuts the program without a correction and with the default controller; what else is
/// wanted is set in its fields. Serialised, the machine and the model are the texts of their files,
/// and the controllers their names; the log is left out.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Job {
    /// The G-code program.
    pub program: Program,
    /// The machine that cuts it.
    #[serde(with = "stored::machine")]
    pub machine: Machine,
    /// The file that the machine was read from, for the report; none where it is built in.
    pub machine_file: Option<String>,
    /// The geometry that the control compensates, in all cuts.
    pub compensation: GeometryChoice,
    /// The requested controller.
    #[serde(with = "stored::entry")]
    pub controller: &'static Entry,
    /// Controller for comparison.
    #[serde(with = "stored::entry")]
    pub against: &'static Entry,
    /// Replaces every programmed feedrate, mm/s.
    pub feed_mm_s: Option<f64>,
    /// Settings of the controllers.
    pub choices: Choices,
    /// A model for the requested controller, in place of a training.
    #[serde(with = "stored::model")]
    pub model: Option<Model>,
    /// Machines that fit the recording of the model. Each is cut with the controller too, and the
    /// results are the band of the report.
    #[serde(skip)]
    pub fitting: Vec<Machine>,
    /// The day, year-month-day, on which the model that the controller learns is written; `None`
    /// where none is wanted.
    #[serde(skip)]
    pub learned_on: Option<String>,
    /// Largest contour error that is allowed, um. Where the machine is planned axis by axis, the
    /// planned path uses what the predicted error of the machine leaves of it.
    pub tolerance_um: Option<f64>,
    /// The control, without feedback, that a corrected program is made for.
    #[serde(with = "stored::target")]
    pub target: Option<&'static TargetControl>,
    /// Plans the program with the planner of this control instead of the machine's planner.
    #[serde(
        default,
        with = "stored::target",
        skip_serializing_if = "Option::is_none"
    )]
    pub planned_as: Option<&'static TargetControl>,
    /// A program that errors are measured to, in place of the one that is cut.
    pub reference: Option<Program>,
    /// Cut as fast as the tolerance allows the requested controller.
    pub fastest: bool,
    /// Find which limit of the machine binds the feedrate along the path.
    pub with_limits: bool,
    /// Log that a machine recorded while it cut the program, shown beside the predicted values.
    #[serde(skip)]
    pub log: Option<MeasuredLog>,
    /// Settings of the reader.
    pub reader: feedwright_gcode::Settings,
}

/// Result of a job. The runs stand in the order in which they were made: the run for comparison,
/// the measured run if there is a log, then the requested controller's run.
#[derive(Debug)]
#[non_exhaustive]
pub struct JobOutcome {
    /// Everything that the page shows.
    pub report: Report,
    /// Warnings of the reader.
    pub warnings: Vec<feedwright_gcode::Diagnostic>,
    /// Controllers that cut uncorrected, because nothing was identified that they could use.
    pub without_identification: Vec<CutsUncorrected>,
    /// Guesses about the log, and remarks on it.
    pub log_findings: Vec<LogFinding>,
    /// The model that the controller had at the end of the cut, if it was given one and this model
    /// was requested.
    pub learned: Option<Model>,
    /// The corrected program for another control, if one was requested; its run is the last.
    pub exported: Option<CorrectOutcome>,
    /// The plan of least time, if it was requested.
    pub fastest: Option<FastestPlan>,
    /// Tolerance of the planned path, um, where it is a part of the tolerance of the tool.
    pub path_um: Option<f64>,
    /// Respects in which the correction is worse than uncorrected; empty where it is compared with
    /// something else.
    pub harm: Vec<Harm>,
    /// True if the command of the controller may be used: it was cut to its end, does no harm, and
    /// asks no drive for twice its limit.
    pub is_of_use: bool,
    /// True if the last run was cut to its end and within the requested tolerance, if any, and a
    /// requested program is better than the original.
    pub within_tolerance: bool,
}

/// A job whose program was read to its end and has no mistakes.
#[derive(Debug)]
pub struct CheckedJob<'a> {
    /// The job; its machine has the geometry that is compensated.
    job: Cow<'a, Job>,
    summary: Summary,
    axes: usize,
}

impl Job {
    /// Cuts a program on a machine without a correction, and with the default controller.
    pub fn new(program: Program, machine: Machine) -> Self {
        Self {
            program,
            machine,
            machine_file: None,
            compensation: GeometryChoice::default(),
            controller: &LQG_IDENTIFIED,
            against: &UNCORRECTED,
            feed_mm_s: None,
            choices: Choices::default(),
            model: None,
            fitting: Vec::new(),
            learned_on: None,
            tolerance_um: None,
            target: None,
            planned_as: None,
            reference: None,
            fastest: false,
            with_limits: false,
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

    /// Reads the program and the reference to their ends and looks whether the log is one of the
    /// program, so that every mistake is known before anything is identified or cut.
    ///
    /// # Errors
    /// A value out of its range, a program with mistakes, more axes than the machine has, a model
    /// that does not suit, and a log of another program.
    pub fn check(&self) -> Result<CheckedJob<'_>, JobError> {
        self.check_values()?;
        let checked = self.check_read(self.program.check(self.reader.clone())?)?;
        if let Some(reference) = &self.reference {
            reference.check(self.reader.clone())?;
        }
        checked.job.measured_run(checked.axes, &mut [], &())?;
        Ok(checked)
    }

    /// The same where the program was read to its end before.
    ///
    /// # Errors
    /// Axes that the machine does not have, a model that does not suit, and a geometry that cannot
    /// be compensated or does not suit.
    pub fn check_read(&self, summary: Summary) -> Result<CheckedJob<'_>, JobError> {
        let axes = axes_that_move(&self.program, &summary, &self.machine)?;
        if let Some(model) = &self.model {
            self.controller
                .suits(model, &self.machine.known(), axes, &self.choices)?;
        }
        let machine = self.compensation.on(&self.machine, summary.box_mm)?;
        let as_it_is = machine.tool.is_none()
            && machine.compensated.is_none()
            && self.machine.compensated.is_none();
        let job = if as_it_is {
            Cow::Borrowed(self)
        } else {
            Cow::Owned(Self {
                machine,
                ..self.clone()
            })
        };
        Ok(CheckedJob { job, summary, axes })
    }
}

impl CheckedJob<'_> {
    /// Axes that are controlled: two where the program stays in the XY plane, else three.
    pub const fn axes(&self) -> usize {
        self.axes
    }

    /// Returns the summary of the program from its reading.
    pub fn into_summary(self) -> Summary {
        self.summary
    }

    /// The plan whose path uses what the machine leaves of the job's tolerance; `None` without a
    /// tolerance, on a machine that is not planned axis by axis, and where the machine needs all of
    /// it.
    ///
    /// # Errors
    /// As [`CheckedJob::run`].
    pub fn tolerance_plan(&self, watch: &dyn Watch) -> Result<Option<TolerancePlan>, JobError> {
        match self.axes {
            2 => self.job.tolerance_plan::<2>(watch),
            _ => self.job.tolerance_plan::<3>(watch),
        }
    }

    /// Cuts the program; the sinks receive the rows of the requested controller.
    ///
    /// A cut that does not come to its end, a sink that fails, or a cancellation.
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
        match self.axes {
            2 => self
                .job
                .cut::<2>(&self.summary, guests.plane, guests, rows, watch),
            _ => self
                .job
                .cut::<3>(&self.summary, guests.space, guests, rows, watch),
        }
    }
}

impl Job {
    fn cut<const N: usize>(
        &self,
        summary: &Summary,
        guest: Option<&dyn Make<N>>,
        Guests {
            plant, feeds_mm_s, ..
        }: Guests<'_>,
        rows: &mut [&mut dyn Sink],
        watch: &dyn Watch,
    ) -> Result<JobOutcome, JobError>
    where
        Entry: Make<N>,
    {
        let aligned = self.aligned()?;
        let fastest = self.fastest_plan::<N>(watch)?;
        let within = self.tolerance_plan::<N>(watch)?;
        let planned = fastest
            .as_ref()
            .map(|plan| &plan.machine)
            .or(within.as_ref().map(|plan| &plan.machine));
        let machine = planned.unwrap_or(&self.machine);
        let circles = self.circles()?;
        let constraints = Constraints::from(machine);
        let looked_at = self.looks_at_cut(fastest.as_ref(), aligned.as_ref(), &constraints);
        let kept = PlanCache::default();
        let plan = PlannedCut {
            kept: &kept,
            machine,
            plant,
            feeds_mm_s,
            path_um: planned.and_then(|machine| machine.limits.path_tolerance_um),
            caps: fastest.as_ref().map(|plan| &plan.caps),
            aligned: aligned.as_ref(),
            circles: &circles,
            looked_at: looked_at.as_ref().map(|cycle| cycle as &dyn PlanSink),
        };
        let Cuts {
            mut runs,
            without_identification,
            learned,
            geometry,
        } = self.cut_with_each::<N>(summary, guest, plan, rows, watch)?;
        let band = runs
            .last()
            .map_or(Ok(None), |run| self.band::<N>(plan, &run.summary, watch))?;
        let completed = runs
            .last()
            .is_some_and(|run| run.summary.outcome == Outcome::Completed);
        let cycle = looked_at.filter(|_| completed).map(CycleTimeOfCut::finish);
        let log_findings = self.insert_measured(&mut runs, N, &circles, watch)?;
        let exported = self.push_exported(&mut runs, &circles, watch)?;
        let limits = self.limit_band(
            machine,
            fastest.as_ref().map(|plan| &plan.cycle).or(cycle.as_ref()),
            watch,
        )?;
        let report = Report {
            limits,
            band,
            geometry,
            ..self.report(N, summary, circles, runs, &without_identification)?
        };
        let exported_well = exported
            .as_ref()
            .is_none_or(|outcome| outcome.refusal.is_none());
        Ok(JobOutcome {
            harm: report.harm(),
            is_of_use: self.is_of_use(&report),
            within_tolerance: report.is_within_tolerance() && exported_well,
            warnings: summary
                .warnings
                .iter()
                .cloned()
                .chain(summary.uncontrolled())
                .collect(),
            report,
            without_identification,
            log_findings,
            learned,
            exported,
            fastest,
            path_um: within.map(|plan| plan.path_um),
        })
    }

    /// Inserts the measured run of a log, if there is one, before the run of the requested
    /// controller. Returns guesses about the log, and remarks on it.
    fn insert_measured(
        &self,
        runs: &mut Vec<ReportedRun>,
        axes: usize,
        circles: &[FullCircle],
        watch: &dyn Watch,
    ) -> Result<Vec<LogFinding>, JobError> {
        let Some(MeasuredLog { log, .. }) = &self.log else {
            return Ok(Vec::new());
        };
        watch.begin("comparing the log", 1);
        let mut record = RunRecord::new(axes, log.sample_time_s, circles);
        let Some(MeasuredRun { run, findings }) =
            self.measured_run(axes, &mut record.sinks(), watch)?
        else {
            return Ok(Vec::new());
        };
        let run = self.reported(record, (Role::Measured, "measured"), run)?;
        let corrected = runs
            .iter()
            .position(|run| run.summary.role == Role::Corrected);
        runs.insert(corrected.unwrap_or(runs.len()), run);
        Ok([log.findings.clone(), findings].concat())
    }

    /// The cut that the log shows, where there is one.
    fn measured_run(
        &self,
        axes: usize,
        rows: &mut [&mut dyn Sink],
        watch: &dyn Watch,
    ) -> Result<Option<MeasuredRun>, JobError> {
        let Some(MeasuredLog { name, log }) = &self.log else {
            return Ok(None);
        };
        let steps = path_steps(self.steps()?);
        let limits = |error| JobError::of_run(&self.program, RunError::Limits(error));
        let mut reference = Stages::of(&self.machine)
            .reference(steps, &self.machine)
            .map_err(limits)?;
        let run = measured(log, &self.machine, axes, &mut reference, rows, watch);
        run.map(Some)
            .map_err(|error| JobError::of_log(name, &self.program, error))
    }

    /// The plan of least time, found with a controller of its own.
    fn fastest_plan<const N: usize>(
        &self,
        watch: &dyn Watch,
    ) -> Result<Option<FastestPlan>, JobError>
    where
        Entry: Make<N>,
    {
        let Some(tolerance_um) = self.tolerance_um.filter(|_| self.fastest) else {
            return Ok(None);
        };
        watch.begin("planning the least time", 1);
        let mut controller = self.own_controller::<N>()?;
        let steps = || Ok(path_steps(self.steps()?));
        let found = fastest(
            &self.machine,
            tolerance_um,
            steps,
            &mut *controller,
            self.controller.laps,
            watch,
        );
        found.map(Some).map_err(|error| self.of_search(error))
    }

    /// The plan whose path uses what the machine leaves of the tolerance, where the machine is
    /// planned axis by axis.
    fn tolerance_plan<const N: usize>(
        &self,
        watch: &dyn Watch,
    ) -> Result<Option<TolerancePlan>, JobError>
    where
        Entry: Make<N>,
    {
        let shares = !self.fastest
            && self.reference.is_none()
            && Stages::of(&self.machine).planner.needs_axes;
        let Some(tolerance_um) = self.tolerance_um.filter(|_| shares) else {
            return Ok(None);
        };
        watch.begin("looking for the tolerance of the path", 1);
        let mut controller = self.own_controller::<N>()?;
        let steps = || Ok(path_steps(self.steps()?));
        let found = plan_within(
            &self.machine,
            tolerance_um,
            steps,
            &mut *controller,
            self.controller.laps,
            watch,
        );
        found.map_err(|error| self.of_search(error))
    }

    /// The requested controller, for a search beside the cut.
    fn own_controller<const N: usize>(&self) -> Result<Box<dyn Controller<N>>, JobError>
    where
        Entry: Make<N>,
    {
        let mut setup = Setup::new(&self.machine, &self.choices);
        Ok(match &self.model {
            Some(model) => self.controller.make_with::<N>(setup, model)?,
            None => Make::<N>::make(self.controller, &mut setup),
        })
    }

    fn of_search(&self, error: FastestError) -> JobError {
        match error {
            FastestError::Run(error) => JobError::of_run(&self.program, error),
            error => JobError::Fastest {
                part: self.program.name(),
                error,
            },
        }
    }

    /// The full circles of the program that errors are measured to.
    fn circles(&self) -> Result<Vec<FullCircle>, JobError> {
        Ok(match &self.reference {
            None => full_circles(path_steps(self.steps()?).map_while(Result::ok)),
            Some(reference) => {
                let steps = reference.reader(self.reader.clone())?.map_while(Result::ok);
                full_circles(path_steps(steps).map_while(Result::ok))
            }
        })
    }

    /// The path that is cut beside the one that errors are measured to, where that is another.
    fn aligned(&self) -> Result<Option<AlignedPaths>, JobError> {
        let Some(reference) = &self.reference else {
            return Ok(None);
        };
        reference.check(self.reader.clone())?;
        let original = reference.reader(self.reader.clone())?.map_while(Result::ok);
        let steps = |program: &Program, steps: Steps<'_>| {
            let of_path = |fault| JobError::Path {
                part: program.name(),
                fault,
            };
            steps.collect::<Result<Vec<Step>, _>>().map_err(of_path)
        };
        let (original, other) = (
            steps(reference, path_steps(original))?,
            steps(&self.program, path_steps(self.steps()?))?,
        );
        Ok(Some(AlignedPaths::new(&original, &other)))
    }

    /// Returns the controllers in the order in which they cut: the requested one last, and once.
    fn controllers(&self) -> Vec<&'static Entry> {
        if self.against.name == self.controller.name {
            vec![self.controller]
        } else {
            vec![self.against, self.controller]
        }
    }

    /// Returns the canonical steps of the program, with the feedrate replaced where that was
    /// requested.
    fn steps(&self) -> Result<impl Iterator<Item = Canon> + Send + use<>, ReadError> {
        // The program was checked from end to end before: a mistake here means that the file
        // changed, and ends it.
        let steps = self
            .program
            .reader(self.reader.clone())?
            .map_while(Result::ok);
        Ok(with_feeds(steps, self.feed_mm_s.into_iter().cycle()))
    }
}
