//! An axis: its filter, regulator and inverse, and the command that makes its drive supply their
//! reference speed.

use crate::axis::delays::CommandQueue;
use crate::axis::drive::{DriveReference, DriveState};
use crate::axis::inverse::AxisInverse;
use crate::axis::mechanics::MechanicsState;
use crate::axis::{AxisModel, AxisState, Parameters};
use crate::supervisor::load;
use crate::supervisor::model_choice::ModelChange;
use crate::supervisor::one_step::{OneStep, run_periods};
use crate::supervisor::validity::ModelWeights;

use super::approach::{self, Room, WeightedGains};
use super::command_weight::{self, CommandHistory, CommandModel, REGULATED};
use super::control_weight::LqgSettings;
use super::estimate::{Estimate, FilterModel, Innovation, KEPT_PERIODS, Learnt, ModelTrial, Sent};
use super::learning::{Learner, Learning};
use super::linear;
use super::loop_margins::LoopMargins;
use super::screw::{ScrewTwist, TwistCourse};
use crate::controller::OffsetBounds;

/// Part of the acceleration of an axis that its command may take against cogging.
const COGGING_SHARE: f64 = 0.1;

/// Stationary gains of an axis, by state as in `lqg_identified/linear.rs`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LqgGains {
    /// Correction of each state for an innovation of 1 rad.
    pub filter: [f64; linear::STATES],
    /// Reduction of the reference speed, rad/s, for a unit of each state.
    pub regulator: [f64; linear::STATES],
    /// Smallest factor on the gain of the loop, above 1, at which it becomes unstable.
    pub gain_margin: f64,
    /// Smallest lag in the loop at which it becomes unstable, rad.
    pub phase_margin_rad: f64,
}

/// An axis, its gains, and its state.
#[derive(Debug, Clone)]
pub(super) struct AxisLqg {
    model: FilterModel,
    inverse: AxisInverse,
    twist: Option<ScrewTwist>,
    regulator: WeightedGains,
    command_model: CommandModel,
    bounds: OffsetBounds,
    /// Learner of the model errors; `None` if the model is exact.
    learner: Option<Learner>,
    /// The model in parallel: the learned one until it is followed, the nominal one after that.
    other: FilterModel,
    may_learn: bool,
    state: Option<Running>,
}

/// State of an axis while it runs.
#[derive(Debug, Clone, Copy)]
struct Running {
    /// Runs of the followed model and of the other one: the learned model until it is followed, the
    /// nominal one after that.
    real: ModelRun,
    beside: ModelRun,
    /// State without any offset, under the same load.
    open: Tracked,
    /// Position of the path at the last decision, mm; the command had an offset from it.
    path_mm: Option<f64>,
    commands: CommandHistory,
    /// Difference between the last measurement and its prediction, rad.
    missed_rad: f64,
    /// Agreement of the last servo period, and the mean square error of a free run by its
    /// innovation, if it is noise, rad^2.
    step: OneStep,
    by_noise_rad2: f64,
    /// State of the learning; `None` if the model is exact, or learning is off.
    learning: Option<Learning>,
}

impl Running {
    /// Creates the state from an angle and a speed.
    fn at(
        model: &FilterModel,
        learning: Option<Learning>,
        angle_rad: f64,
        speed_rad_s: f64,
    ) -> Self {
        let moving = Tracked::moving(model, angle_rad, speed_rad_s);
        Self {
            real: ModelRun::from(moving),
            beside: ModelRun::from(moving),
            open: moving,
            path_mm: None,
            commands: CommandHistory::IDEAL,
            missed_rad: 0.0,
            step: OneStep::NONE,
            by_noise_rad2: 0.0,
            learning,
        }
    }
}

/// An axis with its position loop.
#[derive(Debug, Clone, Copy)]
struct Tracked {
    /// Commands on their way to the position loop, rad.
    commands: CommandQueue,
    estimate: Estimate,
    sent: Sent,
    /// Position loop, in the control or in the drive.
    position_loop: (AxisState, DriveState),
    /// Present measurement, rad.
    measured_rad: f64,
}

impl Tracked {
    fn moving(model: &FilterModel, measured_rad: f64, speed_rad_s: f64) -> Self {
        let (estimate, sent) = model.moving(measured_rad, speed_rad_s);
        let commands = CommandQueue::resting(model.command_periods, measured_rad);
        Self {
            commands,
            position_loop: (AxisState::default(), estimate.drive),
            estimate,
            sent,
            measured_rad,
        }
    }

    /// Returns the state at the time at which the position loop has the command that is sent now,
    /// by the commands on their way and the model alone.
    fn at_position_loop(&self, model: &FilterModel) -> Self {
        let mut later = *self;
        // A command that is sent meanwhile does not arrive.
        (0..self.commands.periods()).for_each(|_| later.foresee(model, 0.0));
        later
    }

    /// Sets the earlier commands to a path that is at an angle now, and moves at the present speed.
    fn commanded_along(&mut self, here_rad: f64, servo_s: f64) {
        let change_rad = self.estimate.masses.motor.speed_rad_s * servo_s;
        self.commands = CommandQueue::moving(self.commands.periods(), here_rad, change_rad);
    }

    /// Returns the reference speed that the position loop makes of a command. It includes the
    /// torque, converted to a speed.
    fn asked_rad_s(&self, model: &FilterModel, command_rad: f64) -> f64 {
        let (mut axis, mut drive) = self.position_loop;
        let DriveReference {
            speed_rad_s,
            torque_nm,
        } = model.drive.position_loop(
            &model.axis_model,
            command_rad,
            self.measured_rad,
            &mut axis,
            &mut drive,
        );
        speed_rad_s + torque_nm / model.axis_model.parameters.kv_nm_s_per_rad
    }

    /// Advances by a servo period with a command, by the model alone.
    fn foresee(&mut self, model: &FilterModel, command_rad: f64) {
        self.send(model, command_rad);
        model.predict(&mut self.estimate, &self.sent);
        self.measured_rad = self.estimate.masses.motor.angle_rad;
    }

    /// Sends a command. The output of the position loop for the command that has arrived goes to
    /// the drive.
    fn send(&mut self, model: &FilterModel, command_rad: f64) {
        let command_rad = self.commands.pass(command_rad);
        let (axis, drive) = &mut self.position_loop;
        axis.angle_rad = self.measured_rad;
        let reference = model.drive.position_loop(
            &model.axis_model,
            command_rad,
            self.measured_rad,
            axis,
            drive,
        );
        self.sent.copy_within(..KEPT_PERIODS - 1, 1);
        self.sent[0] = reference;
    }
}

/// An axis under one model: its filter, and a free run in parallel.
#[derive(Debug, Clone, Copy)]
struct ModelRun {
    tracked: Tracked,
    learnt: Learnt,
    trial: ModelTrial,
}

impl ModelRun {
    fn from(tracked: Tracked) -> Self {
        Self {
            tracked,
            learnt: Learnt::NOTHING,
            trial: ModelTrial::from(&tracked.estimate),
        }
    }

    /// Advances by a servo period with a command and the measurement at its end.
    fn go_on(&mut self, model: &FilterModel, command_rad: f64, measured_rad: f64) -> Innovation {
        let Self {
            tracked,
            learnt,
            trial,
        } = self;
        tracked.send(model, command_rad);
        let innovation = model.correct(&mut tracked.estimate, &tracked.sent, measured_rad, learnt);
        tracked.measured_rad = innovation.measured_rad;
        trial.go_on(model, &tracked.sent, measured_rad, &tracked.estimate);
        innovation
    }

    /// Advances by a servo period with a command, by the model alone.
    fn foresee(&mut self, model: &FilterModel, command_rad: f64) {
        self.tracked.foresee(model, command_rad);
        self.trial = ModelTrial::from(&self.tracked.estimate);
    }
}

impl AxisLqg {
    /// Creates an axis from its model.
    pub(super) fn new(axis_model: AxisModel, settings: LqgSettings) -> Self {
        let model = FilterModel::new(axis_model, &settings);
        let regulated = command_weight::regulated_axis(&axis_model);
        let command_model = CommandModel::new(&axis_model);
        let control_weight_s2 = settings.lowest_control_weight_s2(&axis_model.parameters);
        let gains = command_weight::gains(&regulated, &command_model);
        let command_weight = if settings.command_weight > 0.0 {
            settings.quiet_command_weight(&axis_model, |weight| {
                let gains = gains([control_weight_s2, weight]);
                command_weight::noise_rad(&regulated, &command_model, &gains, model.innovations())
            })
        } else {
            0.0
        };
        let regulator = WeightedGains::new([control_weight_s2, command_weight], gains);
        let least_inertia = || command_weight::least_inertia(&axis_model, &regulator.near());
        Self {
            inverse: AxisInverse::new(axis_model),
            twist: model
                .mechanics
                .transmission()
                .map(|screw| ScrewTwist::new(&axis_model, screw)),
            bounds: settings.bounds,
            learner: settings
                .learns
                .then(|| Learner::new(axis_model, &model.linear, least_inertia())),
            regulator,
            command_model,
            other: model.clone(),
            may_learn: true,
            state: None,
            model,
        }
    }

    /// Returns the present model of the axis.
    pub(super) fn axis_model(&self) -> &AxisModel {
        &self.model.axis_model
    }

    /// Returns true if the followed model was learned.
    pub(super) fn is_learned(&self) -> bool {
        self.state
            .as_ref()
            .and_then(|state| state.learning.as_ref())
            .is_some_and(Learning::is_followed)
    }

    /// Returns the gains near the reference.
    pub(super) fn gains(&self) -> LqgGains {
        let near = self.regulator.near();
        let margins = LoopMargins::of(&self.model, &self.command_model, &near);
        LqgGains {
            filter: self.model.gains_as_given(),
            regulator: core::array::from_fn(|state| near[state]),
            gain_margin: margins.gain,
            phase_margin_rad: margins.phase_rad,
        }
    }

    /// Returns the time that the inverse looks ahead, s.
    pub(super) fn ahead_s(&self) -> f64 {
        let twist_s = self.twist.map_or(0.0, |twist| twist.ahead_s());
        self.inverse.lag_s() + self.inverse.ahead_s() + twist_s
    }

    /// Returns the time after the present command up to which the axis evaluates the reference, s.
    pub(super) fn looks_ahead_s(&self) -> f64 {
        let twist_s = self.twist.map_or(0.0, |twist| twist.ahead_s());
        let servo_s = self.model.axis_model.periods.servo_s;
        self.inverse.ahead_s() + twist_s + self.command_delay_s() + super::DIFFERENCES * servo_s
    }

    /// Changes the bounds of the offsets.
    pub(super) fn hold_to(&mut self, bounds: OffsetBounds) {
        self.bounds = bounds;
    }

    /// Begins anew after the position was lost. If the model seems wrong from there on, the
    /// position is the cause: nothing more is learned.
    pub(super) fn begin_anew(&mut self) {
        (self.state, self.may_learn) = (None, false);
    }

    /// Takes in that the machine has changed.
    pub(super) fn restore_uncertainty(&mut self) {
        if let (
            Some(learner),
            Some(Running {
                learning: Some(learning),
                ..
            }),
        ) = (&self.learner, &mut self.state)
        {
            learner.restore_uncertainty(learning);
        }
    }

    /// Forgets all measurements.
    pub(super) fn forget(&mut self) {
        (self.state, self.may_learn) = (None, true);
        let Some(learner) = &self.learner else { return };
        let nominal = learner.nominal();
        self.model.follow(nominal);
        self.other.follow(nominal);
        self.inverse.follow(nominal);
    }

    /// Returns true before the first measurement.
    pub(super) fn begins(&self) -> bool {
        self.state.is_none()
    }

    /// Returns the lag of the axis behind the command at constant speed without an offset, s.
    pub(super) fn lag_s(&self) -> f64 {
        self.measured_lag_s() - self.model.axis_model.parameters.measurement_delay_s
    }

    /// Returns that lag for the measured position, s.
    pub(super) fn measured_lag_s(&self) -> f64 {
        self.position_loop_lag_s() + self.command_delay_s()
    }

    /// Returns the delay until the position loop has a command, s.
    pub(super) fn command_delay_s(&self) -> f64 {
        self.model.command_periods as f64 * self.model.axis_model.periods.servo_s
    }

    /// Returns the lag of the measured position behind the command that the position loop has, at
    /// constant speed, s.
    fn position_loop_lag_s(&self) -> f64 {
        let parameters = &self.model.axis_model.parameters;
        let friction = if parameters.speed_integral_s > 0.0 {
            0.0
        } else {
            parameters.viscous_friction_nm_s / parameters.kv_nm_s_per_rad
        };
        (1.0 + friction - parameters.velocity_feedforward) / parameters.kp_1_s
    }

    /// Takes in the position that followed from the command of the last servo period, an offset
    /// from the path. At the start the axis has about this speed. With `is_alone`, the run without
    /// offset omits the loads that the filter finds. Returns true if another model is followed from
    /// now on.
    pub(super) fn observe(
        &mut self,
        offset_mm: f64,
        position_mm: f64,
        speed_mm_s: f64,
        [is_alone, is_likely]: [bool; 2],
    ) -> bool {
        let rad_per_mm = self.model.axis_model.parameters.rad_per_mm;
        let measured_rad = position_mm * rad_per_mm;
        let learning = || {
            self.learner
                .as_ref()
                .filter(|_| self.may_learn)
                .map(Learner::begin)
        };
        let begins = || {
            Running::at(
                &self.model,
                learning(),
                measured_rad,
                speed_mm_s * rad_per_mm,
            )
        };
        let running = self.state.get_or_insert_with(begins);
        let Some(path_mm) = running.path_mm else {
            running.real.tracked.measured_rad = measured_rad;
            running.beside.tracked.measured_rad = measured_rad;
            return false;
        };
        let command_rad = (path_mm + offset_mm) * rad_per_mm;
        let from_rad = running.real.tracked.measured_rad;
        running
            .commands
            .sent(command_rad, self.bounds.limits_acceleration());
        if let (Some(learner), Some(learning)) = (&self.learner, &mut running.learning) {
            learner.along(learning, path_mm * rad_per_mm);
        }
        let innovation = running.real.go_on(&self.model, command_rad, measured_rad);
        running.step = innovation.step(1.0 / rad_per_mm);
        running.by_noise_rad2 = self.model.by_noise_rad2(&innovation, &running.real.learnt);
        let turned = self.learn(
            &innovation,
            [command_rad, from_rad, measured_rad],
            is_likely,
        );
        let Some(Running {
            real,
            open,
            missed_rad,
            ..
        }) = &mut self.state
        else {
            return false;
        };
        *missed_rad = innovation.missed_rad;
        if turned && is_alone {
            *open = real.tracked;
        }
        open.estimate.acting_nm = if is_alone {
            [0.0; 4]
        } else {
            real.tracked.estimate.acting_nm
        };
        open.foresee(&self.model, path_mm * rad_per_mm);
        turned
    }

    /// Learns from a servo period: from the innovation of the followed model, the command, the
    /// angle at which it was sent and the measured angle. Returns true if another model is followed
    /// from now on.
    fn learn(
        &mut self,
        innovation: &Innovation,
        [command_rad, from_rad, measured_rad]: [f64; 3],
        is_likely: bool,
    ) -> bool {
        let (
            Some(learner),
            Some(Running {
                real,
                beside,
                learning: Some(learning),
                ..
            }),
        ) = (&self.learner, &mut self.state)
        else {
            return false;
        };
        let beside_from_rad = beside.tracked.measured_rad;
        let beside_innovation = beside.go_on(&self.other, command_rad, measured_rad);
        let missed_rad = [&*real, &*beside].map(|run| run.trial.missed_rad());
        let followed = learning.is_followed();
        let (run, model) = if followed {
            (&mut *real, &mut self.model)
        } else {
            (&mut *beside, &mut self.other)
        };
        let (innovation, from_rad) = if followed {
            (innovation, from_rad)
        } else {
            (&beside_innovation, beside_from_rad)
        };
        learner.sent(learning, run.tracked.commands.arrived(), from_rad);
        learner.take_in(
            learning,
            model,
            (&run.tracked.estimate, &run.tracked.sent),
            innovation,
        );
        if let Some(moved) = learner.apply(learning) {
            model.follow(learner.known(learning));
            run.tracked.estimate.correct(moved);
        }
        let ModelChange { turns, begins_anew } = learner.compare(learning, missed_rad, is_likely);
        if turns {
            core::mem::swap(&mut self.model, &mut self.other);
            core::mem::swap(real, beside);
        }
        if begins_anew {
            self.other.follow(learner.nominal());
            *beside = *real;
        }
        if followed || turns {
            self.inverse.follow(self.model.axis_model);
        }
        turns
    }

    /// Takes in a servo period without a measurement: the command of the last period, an offset
    /// from the path, led to the position that the model predicts. The path is at `here_mm` now.
    pub(super) fn foresee(&mut self, offset_mm: f64, here_mm: f64) {
        let rad_per_mm = self.model.axis_model.parameters.rad_per_mm;
        let Some(running) = &mut self.state else {
            return;
        };
        let Running {
            real,
            beside,
            open,
            path_mm,
            commands,
            missed_rad,
            step,
            ..
        } = running;
        let before_mm = path_mm.replace(here_mm).unwrap_or(here_mm);
        commands.sent(
            (before_mm + offset_mm) * rad_per_mm,
            self.bounds.limits_acceleration(),
        );
        real.foresee(&self.model, (before_mm + offset_mm) * rad_per_mm);
        beside.foresee(&self.other, (before_mm + offset_mm) * rad_per_mm);
        open.estimate.acting_nm = real.tracked.estimate.acting_nm;
        open.foresee(&self.model, before_mm * rad_per_mm);
        (*missed_rad, *step) = (0.0, OneStep::NONE);
    }

    /// Returns the displacement by the offset, and the difference between the measurement and its
    /// prediction, mm.
    pub(super) fn moved_and_missed_mm(&self) -> [f64; 2] {
        let mm = 1.0 / self.model.axis_model.parameters.rad_per_mm;
        self.state.as_ref().map_or(
            [0.0; 2],
            |Running {
                 real,
                 open,
                 missed_rad,
                 ..
             }| {
                let [with_rad, without_rad] =
                    [&real.tracked, open].map(|tracked| tracked.estimate.masses.table.angle_rad);
                [with_rad - without_rad, *missed_rad].map(|rad| rad * mm)
            },
        )
    }

    /// Returns true if the load that the filter finds can be real.
    pub(super) fn is_possible(&self) -> bool {
        let torque_limit_nm = self.model.axis_model.parameters.torque_limit_nm;
        self.state.as_ref().is_none_or(|running| {
            load::is_possible(running.real.tracked.estimate.load_nm(), torque_limit_nm)
        })
    }

    /// Returns the error of the free run of the model, mm.
    pub(super) fn model_missed_mm(&self) -> f64 {
        self.state.as_ref().map_or(0.0, |running| {
            running.real.trial.missed_rad() / self.model.axis_model.parameters.rad_per_mm
        })
    }

    /// Returns the position that would be measured without any offset, mm.
    pub(super) fn alone_mm(&self) -> f64 {
        self.state.as_ref().map_or(0.0, |running| {
            running.open.measured_rad / self.model.axis_model.parameters.rad_per_mm
        })
    }

    /// Returns the distance of the measured position from the reference that would occur without
    /// any offset, mm. `at_mm` is the reference at a time before now. The contribution of loads is
    /// subtracted, because a wrong model finds loads.
    pub(super) fn open_off_mm(&self, at_mm: impl Fn(f64) -> f64) -> f64 {
        let Some(Running { open, .. }) = &self.state else {
            return 0.0;
        };
        let Parameters {
            kp_1_s,
            kv_nm_s_per_rad,
            rad_per_mm,
            ..
        } = self.model.axis_model.parameters;
        let off_mm = open.measured_rad / rad_per_mm
            - at_mm(self.model.axis_model.parameters.measurement_delay_s);
        // The integral of a speed loop compensates constant loads.
        let takes_up = self.model.axis_model.parameters.speed_integral_s > 0.0;
        let by_loads_mm = if takes_up {
            0.0
        } else {
            open.estimate.load_nm() / (kv_nm_s_per_rad * kp_1_s * rad_per_mm)
        };
        (off_mm.abs() - by_loads_mm.abs()).max(0.0)
    }

    /// Returns the mean square error of a free run by the last innovation, if it is noise, mm^2.
    pub(super) fn by_noise_mm2(&self) -> f64 {
        let Parameters { rad_per_mm, .. } = self.model.axis_model.parameters;
        self.state
            .as_ref()
            .map_or(0.0, |running| running.by_noise_rad2)
            / (rad_per_mm * rad_per_mm)
    }

    /// Returns the agreement of the last servo period.
    pub(super) fn step(&self) -> OneStep {
        self.state
            .as_ref()
            .map_or(OneStep::NONE, |running| running.step)
    }

    /// Returns the mean square error of a free run by noise and unforeseen loads, mm^2.
    pub(super) fn unforeseen_mm2(&self) -> f64 {
        let Parameters { rad_per_mm, .. } = self.model.axis_model.parameters;
        self.model
            .unforeseen_rad2(run_periods(self.model.axis_model.periods.servo_s))
            / (rad_per_mm * rad_per_mm)
    }

    /// Returns the offset of the command in this servo period, with these weights of the model.
    /// `at_mm` is the reference at a time after the position loop has that command. The motion
    /// without offset replaces it by the part `open`.
    pub(super) fn offset_mm(
        &mut self,
        here_mm: f64,
        model_weights: ModelWeights,
        open: f64,
        at_mm: impl Fn(f64) -> f64,
    ) -> f64 {
        let Some(running) = &mut self.state else {
            return 0.0;
        };
        let rad_per_mm = self.model.axis_model.parameters.rad_per_mm;
        if running.path_mm.replace(here_mm).is_none() {
            for tracked in [
                &mut running.real.tracked,
                &mut running.beside.tracked,
                &mut running.open,
            ] {
                tracked
                    .commanded_along(here_mm * rad_per_mm, self.model.axis_model.periods.servo_s);
            }
        }
        let tracked = running.real.tracked.at_position_loop(&self.model);
        let ahead = self.model.ahead(&tracked.estimate, &tracked.sent);
        let inner = [ahead.drive.integral_nm(), ahead.masses.presliding_nm];
        let acts_s = self.model.axis_model.parameters.drive_delay_s;
        let twist = self
            .twist
            .map_or(TwistCourse::NONE, |twist| twist.course(&at_mm, acts_s));
        let load_mm_s = self.cogging_mm_s(&at_mm) - twist.spared_mm_s();
        let motor_mm = |after_s: f64| at_mm(after_s) + twist.mm(after_s);
        let reference_mm_s = self.inverse.reference_mm_s(motor_mm, inner, load_mm_s);
        let mut reference_rad_s = reference_mm_s * rad_per_mm;
        let mut off = self.off(&ahead, &at_mm, &motor_mm);
        if open > 0.0 {
            let (open_rad_s, open_off) = self.beside_open(here_mm, &ahead);
            reference_rad_s += open * (open_rad_s - reference_rad_s);
            off.iter_mut()
                .zip(open_off)
                .for_each(|(off, of_open)| *off += open * (of_open - *off));
        }
        let Parameters {
            kv_nm_s_per_rad, ..
        } = self.model.axis_model.parameters;
        let [_, off_rad_s, ..] = off;
        let reference_nm =
            kv_nm_s_per_rad * (reference_rad_s - (ahead.masses.motor.speed_rad_s - off_rad_s));
        let commands_off = self
            .state
            .as_ref()
            .map_or([0.0; 2], |running| running.commands.off_rad());
        let off = command_weight::with_commands(&off, commands_off);
        let asked_rad_s = self.asked_rad_s(reference_nm, &off, model_weights);
        let offset_mm = self.solved_mm(&tracked, here_mm, reference_rad_s - asked_rad_s);
        if let Some(Running { commands, .. }) = &mut self.state {
            commands.decide(
                &self.command_model,
                &off,
                asked_rad_s,
                (here_mm + offset_mm) * rad_per_mm,
            );
        }
        offset_mm
    }

    /// Forgets the command that was decided last: another one is sent, and counts as ideal.
    pub(super) fn forget_decision(&mut self) {
        if let Some(running) = &mut self.state
            && self.bounds.limits_acceleration()
        {
            running.commands.forget_decision();
        }
    }

    /// Returns the reference speed of the axis without any offset, and the deviation of the axis
    /// from that motion.
    fn beside_open(&self, here_mm: f64, ahead: &Estimate) -> (f64, [f64; linear::STATES]) {
        let Some(Running { open, .. }) = &self.state else {
            return (0.0, [0.0; linear::STATES]);
        };
        let open = open.at_position_loop(&self.model);
        let beside = self.model.ahead(&open.estimate, &open.sent);
        let Parameters {
            kv_nm_s_per_rad,
            rad_per_mm,
            ..
        } = self.model.axis_model.parameters;
        let integral_rad_s =
            (beside.drive.integral_nm() - ahead.drive.integral_nm()) / kv_nm_s_per_rad;
        let reference_rad_s = open.asked_rad_s(&self.model, here_mm * rad_per_mm) + integral_rad_s;
        let [real, open] = [ahead, &beside].map(|estimate| estimate.masses);
        let x = real.motor.angle_rad - open.motor.angle_rad;
        let w = real.motor.speed_rad_s - open.motor.speed_rad_s;
        let xt = real.table.angle_rad - open.table.angle_rad;
        let wt = real.table.speed_rad_s - open.table.speed_rad_s;
        (
            reference_rad_s,
            [x, w, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, xt, wt],
        )
    }

    /// Returns the reduction of the reference speed by the regulator. The reference takes this
    /// torque.
    fn asked_rad_s(
        &self,
        reference_nm: f64,
        off: &[f64; REGULATED],
        model_weights: ModelWeights,
    ) -> f64 {
        let Parameters {
            torque_limit_nm,
            kp_1_s,
            kv_nm_s_per_rad,
            rad_per_mm,
            ..
        } = self.model.axis_model.parameters;
        let by_torque_rad_s = approach::left_nm(torque_limit_nm, reference_nm) / kv_nm_s_per_rad;
        let of_offset = kp_1_s * rad_per_mm;
        let room = Room {
            most_rad_s: by_torque_rad_s.min(of_offset * self.bounds.largest_mm),
            change_rad_s2: of_offset * self.bounds.fastest_mm_s,
        };
        self.regulator.asked_rad_s(off, room, model_weights)
    }

    /// Returns the deviation of the axis from the reference at the time at which the present
    /// command begins to act, and the loads.
    fn off(
        &self,
        ahead: &Estimate,
        table_mm: &impl Fn(f64) -> f64,
        motor_mm: &impl Fn(f64) -> f64,
    ) -> [f64; linear::STATES] {
        let MechanicsState { motor, table, .. } = ahead.masses;
        let [x, w] = self.off_reference([motor.angle_rad, motor.speed_rad_s], motor_mm);
        let [xt, wt] = self.off_reference([table.angle_rad, table.speed_rad_s], table_mm);
        let [broadband, disturbance, quadrature, drift] = ahead.acting_nm;
        [
            x,
            w,
            0.0,
            0.0,
            broadband,
            disturbance,
            quadrature,
            drift,
            xt,
            wt,
        ]
    }

    /// Returns the deviations of an angle, rad, and of its speed, rad/s, from the reference.
    fn off_reference(
        &self,
        [angle_rad, speed_rad_s]: [f64; 2],
        at_mm: &impl Fn(f64) -> f64,
    ) -> [f64; 2] {
        let (rad_per_mm, periods) = (
            self.model.axis_model.parameters.rad_per_mm,
            self.model.axis_model.periods,
        );
        let servo_s = periods.servo_s;
        let [before_mm, there_mm, after_mm] = [-1.0, 0.0, 1.0]
            .map(|n: f64| at_mm(self.model.axis_model.parameters.drive_delay_s + n * servo_s));
        // The speed of the model belongs to the mechanics period that has ended: it is half a
        // period old.
        let change_mm = (after_mm - there_mm) - (there_mm - before_mm);
        let late_mm_s = 0.5 * periods.mechanics_s * change_mm / (servo_s * servo_s);
        let there_mm_s = (after_mm - before_mm) / (2.0 * servo_s) - late_mm_s;
        [
            angle_rad - there_mm * rad_per_mm,
            speed_rad_s - there_mm_s * rad_per_mm,
        ]
    }

    /// Returns the reference speed that cogging takes along the reference, mm/s: its mean over the
    /// period in which the present command acts. If the command would need too much acceleration
    /// for all of it, a part is left to the regulator.
    fn cogging_mm_s(&self, at_mm: &impl Fn(f64) -> f64) -> f64 {
        let (parameters, servo_s) = (
            &self.model.axis_model.parameters,
            self.model.axis_model.periods.servo_s,
        );
        if parameters.cogging_nm == 0.0 {
            return 0.0;
        }
        let [from_rad, to_rad] = [0.0, servo_s]
            .map(|after_s| parameters.rad_per_mm * at_mm(parameters.drive_delay_s + after_s));
        let half_rad = 0.5 * parameters.cogging_per_rev * (to_rad - from_rad);
        let mean = if half_rad == 0.0 {
            1.0
        } else {
            libm::sin(half_rad) / half_rad
        };
        let mean_nm = mean * self.model.cogging_nm(0.5 * (from_rad + to_rad));
        let by_torque = 1.0 / (parameters.kv_nm_s_per_rad * parameters.rad_per_mm);
        let swings_1_s = 2.0 * half_rad / servo_s;
        let offset_mm = by_torque * parameters.cogging_nm * self.command_model.by_speed_s();
        let takes_mm_s2 = offset_mm * swings_1_s * swings_1_s;
        let room_mm_s2 = COGGING_SHARE * self.bounds.acceleration_mm_s2;
        let part = if takes_mm_s2 > room_mm_s2 {
            room_mm_s2 / takes_mm_s2
        } else {
            1.0
        };
        -part * by_torque * mean_nm
    }

    /// Returns the offset for which the position loop requests a reference speed, once it has the
    /// command.
    fn solved_mm(&self, tracked: &Tracked, here_mm: f64, wanted_rad_s: f64) -> f64 {
        let rad_per_mm = self.model.axis_model.parameters.rad_per_mm;
        let asked = |command_mm: f64| tracked.asked_rad_s(&self.model, command_mm * rad_per_mm);
        // The request is linear in the command.
        let (here, beyond) = (asked(here_mm), asked(here_mm + 1.0));
        (wanted_rad_s - here) / (beyond - here)
    }
}
