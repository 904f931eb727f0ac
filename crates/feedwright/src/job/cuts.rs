//! The cuts of a job: one for each controller, on one plan.

use std::sync::Arc;

use feedwright_control::{Controller, IdentifiedAxes};
use feedwright_gcode::Summary;
use feedwright_ident::{Model, Origin};
use feedwright_plan::{AlignedPaths, PlanSink, SpeedCaps};
use feedwright_sim::{
    BoxedController, Machine, PlanCache, Row, Run, RunError, RunResult, Sink, StageSteps, Watch,
    path_steps,
};

use super::guests::{Guests, SharedPlantMaker};
use super::planned::{JobPlan, with_feeds};
use super::record::{RunRecord, Timeline};
use super::{CheckedJob, Job, JobError};
use crate::controllers::{CutsUncorrected, Entry, Make, Setup, identifying};
use crate::fastest::with_tolerance;
use crate::report::{CompensatedGeometry, FullCircle, Outcome, ReportedRun, Role, RunSummary};

/// Results of the cuts of all controllers.
#[derive(Default)]
pub(super) struct Cuts {
    pub(super) runs: Vec<ReportedRun>,
    /// Controllers for which nothing was identified.
    pub(super) without_identification: Vec<CutsUncorrected>,
    pub(super) learned: Option<Model>,
    pub(super) geometry: Option<CompensatedGeometry>,
}

/// Inputs of a cut besides the controller: those of the [`JobPlan`], and what takes part in it.
#[derive(Clone, Copy)]
pub(super) struct PlannedCut<'a> {
    /// The machine that cuts.
    pub(super) machine: &'a Machine,
    /// Plant that moves in place of the machine's axes.
    pub(super) plant: Option<SharedPlantMaker<'a>>,
    /// Feedrates of the motions in place of the program's, mm/s.
    pub(super) feeds_mm_s: Option<&'a [f64]>,
    /// Tolerance of the path in place of the program's, um.
    pub(super) path_um: Option<f64>,
    /// Bounds on the speed along the path.
    pub(super) caps: Option<&'a Arc<SpeedCaps>>,
    /// The plan, for all controllers.
    pub(super) kept: &'a PlanCache,
    pub(super) aligned: Option<&'a AlignedPaths>,
    pub(super) circles: &'a [FullCircle],
    /// Receives the plan.
    pub(super) looked_at: Option<&'a dyn PlanSink>,
}

/// Reports the progress of a cut by its arc length.
struct CutProgress<'a> {
    steps: StageSteps<'a>,
    length_mm: f64,
    rows: u32,
}

/// Rows between two steps at the least: a tenth of a second of machining.
const ROWS_BETWEEN: u32 = 100;

impl Sink for CutProgress<'_> {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        self.rows += 1;
        if self.rows == ROWS_BETWEEN {
            self.rows = 0;
            self.steps.reach(row.s_mm / self.length_mm);
        }
        Ok(())
    }
}

impl Cuts {
    /// Returns the figures of the requested controller's cut, if it came to its end.
    pub(super) fn completed(&self) -> Option<&RunSummary> {
        let mut summaries = self.runs.iter().map(|run| &run.summary);
        summaries.find(|run| run.role == Role::Corrected && run.outcome == Outcome::Completed)
    }
}

impl JobPlan {
    /// Returns the inputs of a cut; `looked_at` receives its plan.
    pub(super) fn cut<'a>(
        &'a self,
        guests: Guests<'a>,
        looked_at: Option<&'a dyn PlanSink>,
    ) -> PlannedCut<'a> {
        PlannedCut {
            machine: &self.machine,
            plant: guests.plant,
            feeds_mm_s: guests.feeds_mm_s,
            path_um: self.path_um,
            caps: self.fastest.as_ref().map(|plan| &plan.caps),
            kept: &self.kept,
            aligned: self.aligned.as_ref(),
            circles: &self.circles,
            looked_at,
        }
    }
}

impl Job {
    /// Returns the controllers in the order in which they cut: the requested one last, and once.
    fn controllers(&self) -> Vec<&'static Entry> {
        if self.against.name == self.controller.name {
            vec![self.controller]
        } else {
            vec![self.against, self.controller]
        }
    }

    /// One run for each controller.
    pub(super) fn cut_each(
        &self,
        checked: &CheckedJob<'_>,
        guest: Option<&dyn Make>,
        plan: PlannedCut<'_>,
        rows: &mut [&mut dyn Sink],
        watch: &dyn Watch,
    ) -> Result<Cuts, JobError> {
        let (axes, summary) = (checked.axes, &checked.summary);
        let mut cuts = Cuts::default();
        for entry in self.controllers() {
            watch.check()?;
            let judged = self.role_of(entry) == Role::Corrected;
            let model = self.model.as_ref().filter(|_| judged);
            let mut steps = (entry.identifier.is_some() && model.is_none())
                .then(|| identifying(&self.machine, watch));
            let mut progress = |part: f64| steps.iter_mut().for_each(|steps| steps.reach(part));
            let mut setup = Setup::new(&self.machine, &self.choices).reporting(&mut progress);
            let mut controller = match (guest.filter(|_| judged), model) {
                (Some(guest), _) => guest.make(&mut setup, axes),
                (None, Some(model)) => entry.make_with(setup, axes, model)?,
                (None, None) => {
                    let controller = entry.make(&mut setup, axes);
                    cuts.without_identification.extend(setup.remark(entry));
                    controller
                }
            };
            let mut spread = self.compensation.spread_meter();
            let mut sinks: Vec<&mut dyn Sink> = vec![&mut spread];
            if judged {
                sinks.extend(rows.iter_mut().map(|sink| &mut **sink as &mut dyn Sink));
            }
            // A cut with the feedrates of a planner has its own plan.
            let (own, feeds_mm_s) = (PlanCache::default(), plan.feeds_mm_s.filter(|_| judged));
            let kept = if feeds_mm_s.is_some() {
                &own
            } else {
                plan.kept
            };
            let plan = PlannedCut {
                looked_at: plan.looked_at.filter(|_| judged),
                feeds_mm_s,
                kept,
                ..plan
            };
            cuts.runs.push(self.cut_once(
                summary,
                entry,
                &mut controller,
                plan,
                &mut sinks,
                watch,
            )?);
            cuts.geometry = self.compensation.reported(&self.machine, &spread);
            let given = self.model.as_ref().filter(|_| judged);
            if let Some(model) = given.filter(|_| self.request.learns) {
                cuts.learned = self.learned(model, &controller);
            }
        }
        Ok(cuts)
    }

    /// Returns the part that a controller's cut has in the report.
    fn role_of(&self, entry: &Entry) -> Role {
        if entry.name == self.controller.name {
            Role::Corrected
        } else {
            Role::Reference
        }
    }

    /// A model with the axes as a controller knows them now; `None` of one that does not learn.
    fn learned(&self, model: &Model, controller: &BoxedController) -> Option<Model> {
        let (given, part) = (&model.about().source, self.program.file_name());
        let source = format!("{given}; learned while {} cut {part}", self.machine.name);
        let origin = Origin {
            source,
            date: self.today.clone(),
        };
        match controller {
            BoxedController::Plane(controller) => self.known_by(&**controller, model, origin),
            BoxedController::Space(controller) => self.known_by(&**controller, model, origin),
        }
    }

    fn known_by<const N: usize>(
        &self,
        controller: &dyn Controller<N>,
        model: &Model,
        origin: Origin,
    ) -> Option<Model> {
        let axes = IdentifiedAxes {
            periods: self.machine.period.periods(),
            axes: controller.known()?.map(|axis| axis.parameters),
        };
        model.with_axes(axes, origin)
    }

    fn cut_once(
        &self,
        summary: &Summary,
        entry: &Entry,
        controller: &mut BoxedController,
        plan: PlannedCut<'_>,
        rows: &mut [&mut dyn Sink],
        watch: &dyn Watch,
    ) -> Result<ReportedRun, JobError> {
        let mut record =
            RunRecord::new(controller.axes(), self.machine.period.servo_s, plan.circles);
        let mut timeline = Timeline::new(&self.machine.plc_events);
        let steps = StageSteps::begin(watch, &format!("cutting, {}", entry.name));
        let mut cut = CutProgress {
            steps,
            length_mm: summary.feed_mm + summary.rapid_mm,
            rows: 0,
        };
        let others: [&mut dyn Sink; 2] = [&mut timeline, &mut cut];
        let mut sinks: Vec<&mut dyn Sink> = record.sinks().into_iter().chain(others).collect();
        for sink in rows {
            sinks.push(&mut **sink);
        }
        let run = self.cut_planned(plan, entry, controller, &mut sinks, watch);
        let run = run.map_err(|error| JobError::of_run(&self.program, error))?;
        drop(sinks);
        Ok(ReportedRun {
            events: timeline.events,
            ..self.reported(record, (self.role_of(entry), entry.name), run)?
        })
    }

    /// Cuts the program on the machine of a plan.
    pub(super) fn cut_planned(
        &self,
        PlannedCut {
            machine,
            plant,
            feeds_mm_s,
            path_um,
            caps,
            kept,
            aligned,
            looked_at,
            ..
        }: PlannedCut<'_>,
        entry: &Entry,
        controller: &mut BoxedController,
        sinks: &mut [&mut dyn Sink],
        watch: &dyn Watch,
    ) -> Result<RunResult, RunError> {
        let mut steps = || {
            let steps = path_steps(with_feeds(
                self.steps()?,
                feeds_mm_s.unwrap_or_default().iter().copied(),
            ));
            Ok(match path_um {
                Some(path_um) => with_tolerance(steps, 1e-3 * path_um),
                None => steps,
            })
        };
        let run = self.planned_as.map_or_else(
            || Run::on(machine),
            |control| Run::on(machine).stages(control.stages(machine)),
        );
        let run = plant.map_or(run, |plant| run.plant(plant));
        let run = run
            .within_drives()
            .capped(caps)
            .laps(entry.laps)
            .sharing(kept)
            .watched(watch)
            .planned_to(looked_at);
        match aligned {
            Some(aligned) => run.cut_boxed_aligned(aligned, controller, sinks),
            None => run.cut_boxed(&mut steps, controller, sinks),
        }
    }
}
