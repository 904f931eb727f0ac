//! The plan that all cuts of a job share: the machine with its limits, the paths and the circles.

use feedwright_gcode::canon::{Canon, MotionKind};
use feedwright_gcode::{Program, ReadError};
use feedwright_plan::{AlignedPaths, Constraints, Step, Steps};
use feedwright_sim::{BoxedController, Machine, PlanCache, Stages, Watch, path_steps};

use super::{Job, JobError};
use crate::controllers::{Make, Setup};
use crate::fastest::{FastestError, FastestPlan, TolerancePlan, fastest, plan_within};
use crate::report::{FullCircle, full_circles};

/// Plan of the cuts of a job.
pub(super) struct JobPlan {
    /// The machine of the job, perhaps with another tolerance of the path.
    pub(super) machine: Machine,
    /// Its limits.
    pub(super) constraints: Constraints,
    /// The path that is cut beside the one that errors are measured to, where that is another.
    pub(super) aligned: Option<AlignedPaths>,
    /// The full circles of the program that errors are measured to.
    pub(super) circles: Vec<FullCircle>,
    /// The plan of least time, if it was requested.
    pub(super) fastest: Option<FastestPlan>,
    /// Tolerance of the planned path, um, where it is a part of the tolerance of the tool.
    pub(super) share_um: Option<f64>,
    /// Tolerance of the path in place of the program's, um.
    pub(super) path_um: Option<f64>,
    /// The plan, for all controllers.
    pub(super) kept: PlanCache,
}

/// The steps of a program with other feedrates of its motions, in its order, mm/s. Rapids and
/// motions that have none keep their own.
pub(super) fn with_feeds(
    steps: impl Iterator<Item = Canon> + Send,
    mut feeds_mm_s: impl Iterator<Item = f64> + Send,
) -> impl Iterator<Item = Canon> + Send {
    steps.map(move |mut step| {
        if let Canon::Motion(motion) = &mut step
            && let Some(feed_mm_s) = feeds_mm_s.next()
            && motion.kind == MotionKind::Feed
        {
            motion.feed_mm_s = feed_mm_s;
        }
        step
    })
}

/// Reads the path of a program anew.
type ProgramSteps<'s> = Box<dyn FnMut() -> Result<Steps<'s>, ReadError> + 's>;

/// Search for a plan: machine, tolerance in um, path, controller and its laps.
type PlanSearch<'s, P> = fn(
    &Machine,
    f64,
    ProgramSteps<'s>,
    &mut BoxedController,
    u32,
    &dyn Watch,
) -> Result<P, FastestError>;

impl Job {
    /// Plans the cuts.
    pub(super) fn plan(&self, axes: usize, watch: &dyn Watch) -> Result<JobPlan, JobError> {
        let aligned = self.aligned()?;
        let fastest = self.fastest_plan(axes, watch)?;
        let within = self.tolerance_plan(axes, watch)?;
        let planned = fastest
            .as_ref()
            .map(|plan| &plan.machine)
            .or(within.as_ref().map(|plan| &plan.machine));
        let machine = planned.unwrap_or(&self.machine).clone();
        Ok(JobPlan {
            constraints: Constraints::from(&machine),
            aligned,
            circles: self.circles()?,
            share_um: within.as_ref().map(|plan| plan.path_um),
            path_um: planned.and_then(|machine| machine.limits.path_tolerance_um),
            fastest,
            kept: PlanCache::default(),
            machine,
        })
    }

    /// The plan of least time, found with a controller of its own.
    fn fastest_plan(
        &self,
        axes: usize,
        watch: &dyn Watch,
    ) -> Result<Option<FastestPlan>, JobError> {
        let Some(tolerance_um) = self.request.tolerance_um.filter(|_| self.request.fastest) else {
            return Ok(None);
        };
        watch.begin("planning the least time", 1);
        self.search(axes, tolerance_um, watch, fastest).map(Some)
    }

    /// The plan whose path uses what the machine leaves of the tolerance, where the machine is
    /// planned axis by axis.
    pub(super) fn tolerance_plan(
        &self,
        axes: usize,
        watch: &dyn Watch,
    ) -> Result<Option<TolerancePlan>, JobError> {
        let shares = !self.request.fastest
            && self.reference.is_none()
            && Stages::of(&self.machine).planner.needs_axes;
        let Some(tolerance_um) = self.request.tolerance_um.filter(|_| shares) else {
            return Ok(None);
        };
        watch.begin("looking for the tolerance of the path", 1);
        self.search(axes, tolerance_um, watch, plan_within)
    }

    /// Searches for a plan of the program with a controller of its own.
    fn search<'s, P>(
        &'s self,
        axes: usize,
        tolerance_um: f64,
        watch: &dyn Watch,
        search: PlanSearch<'s, P>,
    ) -> Result<P, JobError> {
        let mut controller = self.own_controller(axes)?;
        let steps: ProgramSteps<'s> = Box::new(|| Ok(path_steps(self.steps()?)));
        let found = search(
            &self.machine,
            tolerance_um,
            steps,
            &mut controller,
            self.controller.laps,
            watch,
        );
        found.map_err(|error| match error {
            FastestError::Run(error) => JobError::of_run(&self.program, error),
            error => JobError::Fastest {
                part: self.program.name(),
                error,
            },
        })
    }

    /// The requested controller, for a search beside the cut.
    pub(super) fn own_controller(&self, axes: usize) -> Result<BoxedController, JobError> {
        let mut setup = Setup::new(&self.machine, &self.choices);
        Ok(match &self.model {
            Some(model) => self.controller.make_with(setup, axes, model)?,
            None => self.controller.make(&mut setup, axes),
        })
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

    /// Returns the canonical steps of the program, with the feedrate replaced where that was
    /// requested.
    pub(super) fn steps(&self) -> Result<impl Iterator<Item = Canon> + Send + use<>, ReadError> {
        // The program was checked from end to end before: a mistake here means that the file
        // changed, and ends it.
        let steps = self
            .program
            .reader(self.reader.clone())?
            .map_while(Result::ok);
        Ok(with_feeds(
            steps,
            self.request.feed_mm_s.into_iter().cycle(),
        ))
    }
}
