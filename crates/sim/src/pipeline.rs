//! One run: from the steps of a program to the rows of its cut, in the order in which data flows.
//!
//! ```text
//! pieces -> plan -> reference -> loop of controller and plant -> rows
//! ```
//!
//! Every cut goes through [`Run`]: the main job, the comparison, the experiments of the paper, the
//! excitation of an identification, and tests.

use std::sync::{Arc, Mutex, PoisonError};

use feedwright_control::Controller;
use feedwright_gcode::ReadError;
use feedwright_gcode::canon::Canon;
use feedwright_plan::{
    AlignedPaths, Constraints, FEED_PLANNERS, FeedMember, KeptPlan, LimitsError, PairedSteps,
    PathError, Pieces, Plan, PlanSink, Plc, SpeedCaps, Step, Steps,
};
use thiserror::Error;

use crate::boxed_controller::BoxedController;
use crate::machine::Machine;
use crate::reference::Reference;
use crate::row::Sink;
use crate::simulate::{LapSetup, PlantMaker, RunResult, Stopped, simulate};
use crate::watch::{Cancelled, Watch};

/// Stages that turn a path into a plan.
#[derive(Debug, Clone, Copy)]
pub struct Stages {
    /// Speed over the planned path.
    pub planner: &'static FeedMember,
}

impl Default for Stages {
    /// The first feed planner.
    fn default() -> Self {
        Self {
            planner: &FEED_PLANNERS[0],
        }
    }
}

impl Stages {
    /// Returns the stages that suit a machine: if each axis has its own limits, the planner that
    /// keeps them; otherwise the first planner.
    pub fn of(machine: &Machine) -> Self {
        let planner = FEED_PLANNERS
            .iter()
            .find(|member| member.needs_axes == machine.has_axis_limits());
        Self {
            planner: planner.unwrap_or(&FEED_PLANNERS[0]),
        }
    }

    /// Reference of the steps of a program on a machine.
    ///
    /// # Errors
    /// Fails if a limit of the machine is missing or outside its allowed range.
    pub fn reference<'p>(
        self,
        steps: Steps<'p>,
        machine: &Machine,
    ) -> Result<Reference<'p>, LimitsError> {
        self.reference_within(steps, machine, &Constraints::from(machine))
    }

    /// Returns the reference of the steps within `constraints` in place of the machine's own
    /// limits.
    ///
    /// # Errors
    /// Fails if a limit is missing or outside its allowed range.
    pub(crate) fn reference_within<'p>(
        self,
        steps: Steps<'p>,
        machine: &Machine,
        constraints: &Constraints,
    ) -> Result<Reference<'p>, LimitsError> {
        Ok(Reference::new(Plan::new(
            steps,
            constraints,
            self.planner,
            Plc::from(machine),
        )?))
    }
}

/// The pieces of a program.
pub fn path_steps<'p>(program: impl IntoIterator<Item = Canon, IntoIter: Send + 'p>) -> Steps<'p> {
    Box::new(Pieces::new(program.into_iter()))
}

/// Bits by which the lap number is shifted before it is added to the machine's seed, for the noise
/// of a practice lap. The seeds of laps then stay clear of machine seeds that are counted up one by
/// one.
const LAP_SEED_SHIFT: u32 = 32;

/// A cut that is about to be made.
#[derive(Clone, Copy)]
pub struct Run<'a> {
    machine: &'a Machine,
    plant: Option<PlantMaker<'a>>,
    compensates: bool,
    within_drives: bool,
    caps: Option<&'a Arc<SpeedCaps>>,
    stages: Stages,
    laps: u32,
    plan_sink: Option<&'a dyn PlanSink>,
    memory: Option<&'a PlanCache>,
    watch: &'a dyn Watch,
}

/// The plan of one path within one set of limits, for all cuts along it: the first that comes to
/// its end leaves it here.
#[derive(Debug, Default)]
pub struct PlanCache([Mutex<Option<KeptPlan>>; 2]);

impl PlanCache {
    fn get(&self, beside_correction: bool) -> Option<KeptPlan> {
        self.0[usize::from(beside_correction)]
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    fn keep(&self, beside_correction: bool, plan: Option<KeptPlan>) {
        if plan.is_some() {
            *self.0[usize::from(beside_correction)]
                .lock()
                .unwrap_or_else(PoisonError::into_inner) = plan;
        }
    }
}

/// Why a cut was not made to its end.
#[derive(Debug, Error, miette::Diagnostic)]
pub enum RunError {
    /// The program cannot be read.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Read(#[from] ReadError),
    /// A limit of the machine is missing or outside its allowed range.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Limits(#[from] LimitsError),
    /// A motion has no path.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Path(#[from] PathError),
    /// A sink takes no more rows.
    #[error("cannot write the rows: {0}")]
    Write(std::io::Error),
    /// A correction keeps each servo period of a cut in memory.
    #[error("the program takes more than {:.1} h, {most_periods} servo periods: a correction keeps all of them in memory", most_s / 3600.0)]
    #[diagnostic(help("split the program and correct its parts one by one"))]
    TooLong {
        /// Servo periods that it may have.
        most_periods: usize,
        /// Duration of these servo periods, s.
        most_s: f64,
    },
    /// Ended from outside.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<Stopped> for RunError {
    fn from(stopped: Stopped) -> Self {
        match stopped {
            Stopped::Write(error) => Self::Write(error),
            Stopped::Cancelled(cancelled) => Self::Cancelled(cancelled),
        }
    }
}

/// Path or pair of paths that a lap cuts along.
enum LapPaths<'p> {
    /// The programmed path.
    One(Steps<'p>),
    /// Another path, with errors to the programmed one.
    Paired(PairedSteps<'p>),
}

impl<'a> Run<'a> {
    /// One lap on a machine, by the stages that suit it.
    pub fn on(machine: &'a Machine) -> Self {
        let stages = Stages::of(machine);
        Self {
            machine,
            plant: None,
            compensates: true,
            within_drives: false,
            caps: None,
            stages,
            laps: 1,
            plan_sink: None,
            memory: None,
            watch: &(),
        }
    }

    /// Cuts with another plant in place of the machine's own. Plan, limits and periods stay those
    /// of the machine.
    #[must_use]
    pub const fn plant(self, plant: PlantMaker<'a>) -> Self {
        Self {
            plant: Some(plant),
            ..self
        }
    }

    /// Sets the number of laps. All but the last are practice; only the last lap gives rows and the
    /// result.
    #[must_use]
    pub const fn laps(self, laps: u32) -> Self {
        Self { laps, ..self }
    }

    /// Holds the offset of a controller in the loop within the acceleration that the axes can have
    /// beside the plan.
    #[must_use]
    pub const fn within_drives(self) -> Self {
        Self {
            within_drives: true,
            ..self
        }
    }

    /// Bounds the speed from place to place along the path.
    #[must_use]
    pub const fn capped(self, caps: Option<&'a Arc<SpeedCaps>>) -> Self {
        Self { caps, ..self }
    }

    /// Replaces the feed planner.
    #[must_use]
    pub const fn stages(self, stages: Stages) -> Self {
        Self { stages, ..self }
    }

    /// Turns off the compensation of the machine: cuts the way a control does that gets the program
    /// alone.
    #[must_use]
    pub const fn uncompensated(self) -> Self {
        Self {
            compensates: false,
            ..self
        }
    }

    /// Reports the plan of the last lap to `plan_sink`.
    #[must_use]
    pub const fn planned_to(self, plan_sink: Option<&'a dyn PlanSink>) -> Self {
        Self { plan_sink, ..self }
    }

    /// Shares the plan with other cuts along the same path and within the same limits, so that it
    /// is computed once.
    #[must_use]
    pub const fn sharing(self, memory: &'a PlanCache) -> Self {
        Self {
            memory: Some(memory),
            ..self
        }
    }

    /// Lets `watch` cancel the run.
    #[must_use]
    pub const fn watched(self, watch: &'a dyn Watch) -> Self {
        Self { watch, ..self }
    }

    /// Cuts a path that is in memory, with a controller that begins anew; every row of the last lap
    /// goes to every sink.
    ///
    /// # Errors
    /// A machine without sensible limits, a sink that takes no more, or an end from outside.
    pub fn cut_steps<const N: usize>(
        &self,
        steps: &[Step],
        controller: &mut dyn Controller<N>,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        self.cut(
            || Ok(Box::new(steps.iter().cloned().map(Ok))),
            controller,
            sinks,
        )
    }

    /// Cuts a path that is read anew for each lap; otherwise the same as [`Run::cut_steps`].
    ///
    /// # Errors
    /// Fails as [`Run::cut_steps`] does; also if the program cannot be read or a motion has no
    /// path.
    pub fn cut<'p, const N: usize>(
        &self,
        mut steps: impl FnMut() -> Result<Steps<'p>, ReadError>,
        controller: &mut dyn Controller<N>,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        self.laps_of(|| steps().map(LapPaths::One), controller, sinks)
    }

    /// Cuts as [`Run::cut_steps`] does, with a controller of two or three axes.
    ///
    /// # Errors
    /// Fails as [`Run::cut_steps`] does.
    pub fn cut_boxed_steps(
        &self,
        steps: &[Step],
        controller: &mut BoxedController,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        match controller {
            BoxedController::Plane(controller) => self.cut_steps(steps, &mut **controller, sinks),
            BoxedController::Space(controller) => self.cut_steps(steps, &mut **controller, sinks),
        }
    }

    /// Cuts as [`Run::cut`] does, with a controller of two or three axes.
    ///
    /// # Errors
    /// Fails as [`Run::cut`] does.
    pub fn cut_boxed<'p>(
        &self,
        steps: &mut dyn FnMut() -> Result<Steps<'p>, ReadError>,
        controller: &mut BoxedController,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        match controller {
            BoxedController::Plane(controller) => self.cut(steps, &mut **controller, sinks),
            BoxedController::Space(controller) => self.cut(steps, &mut **controller, sinks),
        }
    }

    /// Cuts as [`Run::cut_aligned`] does, with a controller of two or three axes.
    ///
    /// # Errors
    /// Fails as [`Run::cut`] does.
    pub fn cut_boxed_aligned(
        &self,
        aligned: &AlignedPaths,
        controller: &mut BoxedController,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        match controller {
            BoxedController::Plane(controller) => {
                self.cut_aligned(aligned, &mut **controller, sinks)
            }
            BoxedController::Space(controller) => {
                self.cut_aligned(aligned, &mut **controller, sinks)
            }
        }
    }

    /// All laps, each along paths of its own.
    fn laps_of<'p, const N: usize>(
        &self,
        mut paths: impl FnMut() -> Result<LapPaths<'p>, ReadError>,
        controller: &mut dyn Controller<N>,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        let of_laps = PlanCache::default();
        let memory = self.memory.or((self.laps > 1).then_some(&of_laps));
        controller.reset();
        for lap in 1..self.laps {
            // Noise differs from lap to lap, so a controller cannot gain from learning it.
            let seed = self
                .machine
                .noise
                .seed
                .wrapping_add(u64::from(lap) << LAP_SEED_SHIFT);
            let practice = self.machine.with_noise_seed(seed);
            let practising = Run {
                machine: &practice,
                plan_sink: None,
                memory,
                ..*self
            };
            practising.lap(&mut paths, controller, &mut [])?;
            controller.next_lap();
        }
        Run { memory, ..*self }.lap(&mut paths, controller, sinks)
    }

    /// Cuts along the path of another program, with errors measured to the programmed path;
    /// otherwise the same as [`Run::cut`].
    ///
    /// # Errors
    /// Fails as [`Run::cut`] does.
    pub fn cut_aligned<const N: usize>(
        &self,
        aligned: &AlignedPaths,
        controller: &mut dyn Controller<N>,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        let mut result =
            self.laps_of(|| Ok(LapPaths::Paired(aligned.steps())), controller, sinks)?;
        result.uncut_mm = result.uncut_mm.max(aligned.left_out_mm);
        Ok(result)
    }

    fn constraints(&self, beside_correction: bool) -> Constraints {
        let constraints = if beside_correction {
            self.machine.constraints_beside_correction()
        } else {
            Constraints::from(self.machine)
        };
        Constraints {
            speed_caps: self.caps.cloned(),
            ..constraints
        }
    }

    fn plan_of<'p>(
        &self,
        paths: LapPaths<'p>,
        beside_correction: bool,
    ) -> Result<Plan<'p>, LimitsError> {
        let (constraints, planner, plc) = (
            self.constraints(beside_correction),
            self.stages.planner,
            Plc::from(self.machine),
        );
        match paths {
            LapPaths::One(steps) => Plan::new(steps, &constraints, planner, plc),
            LapPaths::Paired(steps) => Plan::of_paired(steps, &constraints, planner, plc),
        }
    }

    fn lap<'p, const N: usize>(
        &self,
        paths: &mut impl FnMut() -> Result<LapPaths<'p>, ReadError>,
        controller: &mut dyn Controller<N>,
        sinks: &mut [&mut dyn Sink],
    ) -> Result<RunResult, RunError> {
        let beside_correction = self.within_drives && controller.report().acts_at_once;
        let kept = |memory: &PlanCache| memory.get(beside_correction);
        let plan = match self.memory.and_then(kept) {
            Some(kept) => Plan::again(&kept),
            None => {
                let plan = self.plan_of(paths()?, beside_correction)?;
                if self.memory.is_some() {
                    plan.keeping()
                } else {
                    plan
                }
            }
        };
        let mut reference = Reference::new(plan.reporting_to(self.plan_sink));
        let known = self
            .machine
            .compensated
            .as_ref()
            .filter(|_| self.compensates);
        let known = known.map(|known| Box::new(known.of_first::<N>()));
        let setup = LapSetup {
            machine: self.machine,
            plant: self.plant,
            known: known.as_deref(),
            within_drives: self.within_drives,
        };
        let result = simulate(setup, &mut reference, controller, sinks, self.watch)?;
        if let Some(fault) = reference.fault() {
            return Err(fault.clone().into());
        }
        if let Some(memory) = self.memory {
            memory.keep(beside_correction, reference.into_kept());
        }
        Ok(result)
    }
}

#[cfg(test)]
mod tests {
    use feedwright_control::{Command, Measured, Schedule, Window};

    use feedwright_gcode::{Reader, Settings};

    use super::*;
    use crate::plant::{Mechanism, Plant};

    /// Adds up what it measures in each lap.
    #[derive(Default)]
    struct Seen(Vec<f64>);

    impl Controller<2> for Seen {
        fn schedule(&self) -> Schedule {
            Schedule {
                servo_periods: 1,
                preview: 0,
            }
        }

        fn reset(&mut self) {
            self.0 = vec![0.0];
        }

        fn next_lap(&mut self) {
            self.0.push(0.0);
        }

        fn command(&mut self, _: &Window<'_, 2>, measured: &Measured<2>) -> Command<2> {
            if let Some(sum) = self.0.last_mut() {
                *sum += measured.position_mm[0];
            }
            Command::straight(1.0, [0.0; 2])
        }
    }

    #[test]
    fn laps_differ_in_their_noise_and_in_nothing_else() {
        let circle = Reader::from_text(
            "circle.ngc",
            "G17 G21 G90 G61 F3000\nG2 X0 Y0 I10 J0\nM2\n",
            Settings::default(),
        );
        let steps = path_steps(circle.unwrap().map(Result::unwrap))
            .collect::<Result<Vec<_>, _>>()
            .unwrap();
        let quiet = Machine::load("tnv40".as_ref()).unwrap();
        let mut noisy = quiet.clone();
        noisy.axes[0].encoder_noise_um = 1.0;
        let laps = |machine: &Machine| {
            let mut seen = Seen::default();
            Run::on(machine)
                .laps(3)
                .cut_steps(&steps, &mut seen, &mut [])
                .unwrap();
            seen.0
        };
        let [a, b, c] = laps(&quiet).try_into().unwrap();
        assert!(a == b && b == c, "{a} {b} {c}");
        let [a, b, c] = laps(&noisy).try_into().unwrap();
        assert!(a != b && b != c && a != c, "{a} {b} {c}");
    }

    #[test]
    fn a_plant_that_is_given_takes_the_place_of_the_machines_own_and_gets_the_seed_of_each_lap() {
        let circle = Reader::from_text(
            "circle.ngc",
            "G17 G21 G90 G61 F3000\nG2 X0 Y0 I10 J0\nM2\n",
            Settings::default(),
        );
        let steps = path_steps(circle.unwrap().map(Result::unwrap))
            .collect::<Result<Vec<_>, _>>()
            .unwrap();
        let mut machine = Machine::load("tnv40".as_ref()).unwrap();
        machine.axes[0].encoder_noise_um = 1.0;
        let laps = |run: Run<'_>| {
            let mut seen = Seen::default();
            run.laps(2).cut_steps(&steps, &mut seen, &mut []).unwrap();
            seen.0
        };
        let heavy = Machine::load("heavy".as_ref()).unwrap();
        let of = |machine: &Machine, start_mm: [f64; 3], seed: u64| -> Box<dyn Mechanism> {
            Box::new(Plant::<2>::with_seed(
                machine,
                [start_mm[0], start_mm[1]],
                seed,
            ))
        };
        let own = laps(Run::on(&machine));
        assert_eq!(
            own,
            laps(Run::on(&machine).plant(&|start_mm, seed| of(&machine, start_mm, seed)))
        );
        assert_ne!(
            own,
            laps(Run::on(&machine).plant(&|start_mm, seed| of(&heavy, start_mm, seed)))
        );
    }
}
