//! An axis: its filter, its regulator and its inverse, and the command that asks its drive for what
//! they want.

use crate::axis::delays::CommandQueue;
use crate::axis::drive::{DriveReference, DriveState};
use crate::axis::inverse::AxisInverse;
use crate::axis::knowledge::AxisKnowledge;
use crate::axis::mechanics::MechanicsState;
use crate::axis::{AxisLaw, AxisState, Parameters};
use crate::supervisor::one_step::{OneStep, run_periods};
use crate::supervisor::validity::Trusted;

use super::approach::{self, Room, WeightedGains};
use super::command_weight::{self, CommandHistory, CommandLaw, REGULATED};
use super::control_weight::{LqgSettings, OffsetBounds};
use super::estimate::{AxisModel, Estimate, Innovation, KEPT_PERIODS, LawTrial, Learnt, Sent};
use super::learning::{LawChoice, Learner, Learning};
use super::linear;
use super::screw::{ScrewTwist, TwistCourse};

/// Stationary gains of an axis: by state, as in `lqg_preview/linear.rs`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LqgGains {
    /// How much of what is measured beyond the prediction, rad, is added to each state.
    pub filter: [f64; linear::STATES],
    /// By how much the reference speed, rad/s, is less for a unit of each state.
    pub regulator: [f64; linear::STATES],
}

/// An axis, its gains, and what it remembers.
#[derive(Debug, Clone)]
pub(super) struct AxisLqg {
    model: AxisModel,
    inverse: AxisInverse,
    twist: Option<ScrewTwist>,
    regulator: WeightedGains,
    command_law: CommandLaw,
    bounds: OffsetBounds,
    known: AxisKnowledge,
    /// What finds where the law is wrong, of a law that may be.
    learner: Option<Learner>,
    /// The law that stands beside it: the one that is learned until that is followed, the nominal
    /// one then.
    other: AxisModel,
    other_known: AxisKnowledge,
    may_learn: bool,
    state: Option<Running>,
}

/// What an axis remembers while it runs.
#[derive(Debug, Clone, Copy)]
struct Running {
    /// As the law that is followed has it, and as the other one has it: the learned law until that
    /// is followed, the nominal one then.
    real: LawRun,
    beside: LawRun,
    /// As it would be without any offset, under the same load.
    open: Tracked,
    /// Where the path was at the last decision, mm; the command was an offset beside it.
    path_mm: Option<f64>,
    commands: CommandHistory,
    /// What was measured beyond what was expected, rad.
    missed_rad: f64,
    /// How the last servo period went, and what its innovation makes of a free run, if it is noise,
    /// rad^2.
    step: OneStep,
    by_noise_rad2: f64,
    /// What is learned of a law that may be wrong.
    learning: Option<Learning>,
}

impl Running {
    /// Where nothing is known yet but an angle and a speed.
    fn at(model: &AxisModel, learning: Option<Learning>, angle_rad: f64, speed_rad_s: f64) -> Self {
        let moving = Tracked::moving(model, angle_rad, speed_rad_s);
        Self {
            real: LawRun::from(moving),
            beside: LawRun::from(moving),
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

/// An axis behind its position loop.
#[derive(Debug, Clone, Copy)]
struct Tracked {
    /// Commands on their way to the position loop, rad.
    commands: CommandQueue,
    estimate: Estimate,
    sent: Sent,
    /// The position loop as the control or the drive has it.
    position_loop: (AxisState, DriveState),
    /// What is measured now, rad.
    measured_rad: f64,
}

impl Tracked {
    fn moving(model: &AxisModel, measured_rad: f64, speed_rad_s: f64) -> Self {
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

    /// As it will be when the position loop has the command that is sent now: by the commands on
    /// their way and the law alone.
    fn at_position_loop(&self, model: &AxisModel) -> Self {
        let mut later = *self;
        // What is sent meanwhile does not arrive.
        (0..self.commands.periods()).for_each(|_| later.foresee(model, 0.0));
        later
    }

    /// Its commands so far were those of a path that is at an angle now, with the speed that it
    /// has.
    fn commanded_along(&mut self, here_rad: f64, servo_s: f64) {
        let change_rad = self.estimate.masses.motor.speed_rad_s * servo_s;
        self.commands = CommandQueue::moving(self.commands.periods(), here_rad, change_rad);
    }

    /// The reference speed that the position loop makes of a command; torque beside it counts as
    /// that.
    fn asked_rad_s(&self, model: &AxisModel, command_rad: f64) -> f64 {
        let (mut axis, mut drive) = self.position_loop;
        let DriveReference {
            speed_rad_s,
            torque_nm,
        } = model.drive.position_loop(
            &model.law,
            command_rad,
            self.measured_rad,
            &mut axis,
            &mut drive,
        );
        speed_rad_s + torque_nm / model.law.parameters.kv_nm_s_per_rad
    }

    /// A servo period by a command and the law alone.
    fn foresee(&mut self, model: &AxisModel, command_rad: f64) {
        self.send(model, command_rad);
        model.predict(&mut self.estimate, &self.sent);
        self.measured_rad = self.estimate.masses.motor.angle_rad;
    }

    /// A command is sent. What the position loop makes of the one that has arrived goes to the
    /// drive.
    fn send(&mut self, model: &AxisModel, command_rad: f64) {
        let command_rad = self.commands.pass(command_rad);
        let (axis, drive) = &mut self.position_loop;
        axis.angle_rad = self.measured_rad;
        let reference =
            model
                .drive
                .position_loop(&model.law, command_rad, self.measured_rad, axis, drive);
        self.sent.copy_within(..KEPT_PERIODS - 1, 1);
        self.sent[0] = reference;
    }
}

/// An axis as a law has it: its filter, and a free run beside that.
#[derive(Debug, Clone, Copy)]
struct LawRun {
    tracked: Tracked,
    learnt: Learnt,
    trial: LawTrial,
}

impl LawRun {
    fn from(tracked: Tracked) -> Self {
        Self {
            tracked,
            learnt: Learnt::NOTHING,
            trial: LawTrial::from(&tracked.estimate),
        }
    }

    /// A servo period by a command, and what was measured at its end.
    fn go_on(&mut self, model: &AxisModel, command_rad: f64, measured_rad: f64) -> Innovation {
        let Self {
            tracked,
            learnt,
            trial,
        } = self;
        tracked.send(model, command_rad);
        let told = model.correct(&mut tracked.estimate, &tracked.sent, measured_rad, learnt);
        tracked.measured_rad = told.measured_rad;
        trial.go_on(model, &tracked.sent, measured_rad, &tracked.estimate);
        told
    }

    /// A servo period by a command and the law alone.
    fn foresee(&mut self, model: &AxisModel, command_rad: f64) {
        self.tracked.foresee(model, command_rad);
        self.trial = LawTrial::from(&self.tracked.estimate);
    }
}

impl AxisLqg {
    /// Of an axis of which this is known.
    pub(super) fn new(known: AxisKnowledge, settings: LqgSettings) -> Self {
        let AxisKnowledge {
            drive,
            friction,
            transmission,
            delays,
            ..
        } = known;
        let law = known.law();
        let model = AxisModel::new(&known, settings.learns);
        let regulated = command_weight::regulated_axis(&known);
        let command_law = CommandLaw::new(&law, &drive);
        let lowest = [
            settings.lowest_control_weight_s2(&transmission),
            settings.command_weight,
        ];
        let regulator = WeightedGains::new(lowest, command_weight::gains(&regulated, &command_law));
        let least_inertia = || command_weight::least_inertia(&known, &regulator.near());
        Self {
            inverse: AxisInverse::new(law, drive, friction, delays),
            twist: model
                .mechanics
                .transmission()
                .map(|screw| ScrewTwist::new(&law, screw)),
            bounds: settings.bounds,
            known,
            learner: settings
                .learns
                .then(|| Learner::new(known, &model.linear, least_inertia())),
            regulator,
            command_law,
            other: model.clone(),
            other_known: known,
            may_learn: true,
            state: None,
            model,
        }
    }

    pub(super) fn law(&self) -> &AxisLaw {
        &self.model.law
    }

    /// What is known of it now.
    pub(super) fn known(&self) -> AxisKnowledge {
        self.known
    }

    /// Whether the law that is followed was learned.
    pub(super) fn is_learned(&self) -> bool {
        self.state
            .as_ref()
            .and_then(|state| state.learning.as_ref())
            .is_some_and(Learning::is_followed)
    }

    /// Near the reference.
    pub(super) fn gains(&self) -> LqgGains {
        let near = self.regulator.near();
        LqgGains {
            filter: self.model.gains_as_given(),
            regulator: core::array::from_fn(|state| near[state]),
        }
    }

    /// How far ahead the inverse looks, s.
    pub(super) fn ahead_s(&self) -> f64 {
        let twist_s = self.twist.map_or(0.0, |twist| twist.ahead_s());
        self.inverse.lag_s() + self.inverse.ahead_s() + twist_s
    }

    /// Holds offsets to other bounds from now on.
    pub(super) fn hold_to(&mut self, bounds: OffsetBounds) {
        self.bounds = bounds;
    }

    /// Begins anew where the position was lost. If the law seems to be another one from there on,
    /// it is the position that is: nothing more is learned.
    pub(super) fn begin_anew(&mut self) {
        (self.state, self.may_learn) = (None, false);
    }

    /// The axis is another one from now on.
    pub(super) fn doubt(&mut self) {
        if let (
            Some(learner),
            Some(Running {
                learning: Some(learning),
                ..
            }),
        ) = (&self.learner, &mut self.state)
        {
            learner.doubt(learning);
        }
    }

    /// Forgets all that came.
    pub(super) fn forget(&mut self) {
        (self.state, self.may_learn) = (None, true);
        let Some(learner) = &self.learner else { return };
        let nominal = learner.nominal();
        (self.known, self.other_known) = (nominal, nominal);
        self.model.follow(&nominal);
        self.other.follow(&nominal);
        self.inverse.follow(
            self.model.law,
            nominal.drive,
            nominal.friction,
            nominal.delays,
        );
    }

    /// Whether nothing has come yet.
    pub(super) fn begins(&self) -> bool {
        self.state.is_none()
    }

    /// How far the axis is behind the command at constant speed where nothing is added to it, s.
    pub(super) fn lag_s(&self) -> f64 {
        self.measured_lag_s() - self.known.delays.measurement_s
    }

    /// The same of its position as it is measured, s.
    pub(super) fn measured_lag_s(&self) -> f64 {
        self.position_loop_lag_s() + self.command_delay_s()
    }

    /// How late the position loop has a command, s.
    pub(super) fn command_delay_s(&self) -> f64 {
        self.model.command_periods as f64 * self.model.law.periods.servo_s
    }

    /// How far the measured position is behind the command that the position loop has, at constant
    /// speed, s.
    fn position_loop_lag_s(&self) -> f64 {
        let (parameters, AxisKnowledge { drive, .. }) = (self.model.law.parameters, self.known);
        let friction = if drive.speed_integral_s > 0.0 {
            0.0
        } else {
            parameters.viscous_friction_nm_s / parameters.kv_nm_s_per_rad
        };
        (1.0 + friction - drive.velocity_feedforward) / parameters.kp_1_s
    }

    /// What was commanded in the last servo period, as an offset from the path, has led to this
    /// position. Where it begins it has about this speed. `is_alone` leaves out of the axis by
    /// itself what loads the filter finds. Whether another law is followed from now on.
    pub(super) fn observe(
        &mut self,
        offset_mm: f64,
        position_mm: f64,
        speed_mm_s: f64,
        [is_alone, is_likely]: [bool; 2],
    ) -> bool {
        let rad_per_mm = self.model.law.parameters.rad_per_mm;
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
        running.commands.sent(command_rad);
        if let (Some(learner), Some(learning)) = (&self.learner, &mut running.learning) {
            learner.along(learning, path_mm * rad_per_mm);
        }
        let told = running.real.go_on(&self.model, command_rad, measured_rad);
        running.step = told.step(1.0 / rad_per_mm);
        running.by_noise_rad2 = self.model.by_noise_rad2(&told, &running.real.learnt);
        let turned = self.learn(&told, [command_rad, from_rad, measured_rad], is_likely);
        let Some(Running {
            real,
            open,
            missed_rad,
            ..
        }) = &mut self.state
        else {
            return false;
        };
        let possible = self.model.is_possible(&real.tracked.estimate);
        *missed_rad = if possible {
            told.missed_rad
        } else {
            f64::INFINITY
        };
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

    /// Learns of a servo period, in which the law that is followed was told this, a command went
    /// out at one angle, and another was measured. Whether another law is followed from now on.
    fn learn(
        &mut self,
        told: &Innovation,
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
        let beside_told = beside.go_on(&self.other, command_rad, measured_rad);
        let missed_rad = [&*real, &*beside].map(|run| run.trial.missed_rad());
        let followed = learning.is_followed();
        let (run, model, known) = if followed {
            (&mut *real, &mut self.model, &mut self.known)
        } else {
            (&mut *beside, &mut self.other, &mut self.other_known)
        };
        let (told, from_rad) = if followed {
            (told, from_rad)
        } else {
            (&beside_told, beside_from_rad)
        };
        learner.sent(learning, run.tracked.commands.arrived(), from_rad);
        learner.take_in(
            learning,
            model,
            (&run.tracked.estimate, &run.tracked.sent),
            told,
        );
        if let Some(moved) = learner.apply(learning) {
            *known = learner.known(learning);
            model.follow(known);
            run.tracked.estimate.correct(moved);
        }
        let LawChoice { turns, begins_anew } = learner.compare(learning, missed_rad, is_likely);
        if turns {
            core::mem::swap(&mut self.model, &mut self.other);
            core::mem::swap(&mut self.known, &mut self.other_known);
            core::mem::swap(real, beside);
        }
        if begins_anew {
            self.other_known = learner.nominal();
            self.other.follow(&self.other_known);
            *beside = *real;
        }
        if followed || turns {
            let AxisKnowledge {
                drive,
                friction,
                delays,
                ..
            } = self.known;
            self.inverse.follow(self.model.law, drive, friction, delays);
        }
        turns
    }

    /// What was commanded in the last servo period, as an offset from the path, which is at a place
    /// now, has led to where the law says.
    pub(super) fn foresee(&mut self, offset_mm: f64, here_mm: f64) {
        let rad_per_mm = self.model.law.parameters.rad_per_mm;
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
        commands.sent((before_mm + offset_mm) * rad_per_mm);
        real.foresee(&self.model, (before_mm + offset_mm) * rad_per_mm);
        beside.foresee(&self.other, (before_mm + offset_mm) * rad_per_mm);
        open.estimate.acting_nm = real.tracked.estimate.acting_nm;
        open.foresee(&self.model, before_mm * rad_per_mm);
        (*missed_rad, *step) = (0.0, OneStep::NONE);
    }

    /// By how much the offset has moved it, and what was measured beyond what was expected, mm.
    pub(super) fn moved_and_missed_mm(&self) -> [f64; 2] {
        let mm = 1.0 / self.model.law.parameters.rad_per_mm;
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

    /// By how much the law has missed what was measured, mm.
    pub(super) fn law_missed_mm(&self) -> f64 {
        self.state.as_ref().map_or(0.0, |running| {
            running.real.trial.missed_rad() / self.model.law.parameters.rad_per_mm
        })
    }

    /// Where it would be measured without any offset, mm.
    pub(super) fn alone_mm(&self) -> f64 {
        self.state.as_ref().map_or(0.0, |running| {
            running.open.measured_rad / self.model.law.parameters.rad_per_mm
        })
    }

    /// By how much it would be measured off the reference without any offset, mm; `at_mm` is the
    /// reference so long before now. What loads make of that does not count: a law that is wrong
    /// finds them.
    pub(super) fn open_off_mm(&self, at_mm: impl Fn(f64) -> f64) -> f64 {
        let Some(Running { open, .. }) = &self.state else {
            return 0.0;
        };
        let Parameters {
            kp_1_s,
            kv_nm_s_per_rad,
            rad_per_mm,
            ..
        } = self.model.law.parameters;
        let off_mm = open.measured_rad / rad_per_mm - at_mm(self.known.delays.measurement_s);
        // The integral of a speed loop takes up what is constant.
        let takes_up = self.known.drive.speed_integral_s > 0.0;
        let by_loads_mm = if takes_up {
            0.0
        } else {
            open.estimate.load_nm() / (kv_nm_s_per_rad * kp_1_s * rad_per_mm)
        };
        (off_mm.abs() - by_loads_mm.abs()).max(0.0)
    }

    /// Mean square of what a free run misses by the last innovation, if it is noise, mm^2.
    pub(super) fn by_noise_mm2(&self) -> f64 {
        let Parameters { rad_per_mm, .. } = self.model.law.parameters;
        self.state
            .as_ref()
            .map_or(0.0, |running| running.by_noise_rad2)
            / (rad_per_mm * rad_per_mm)
    }

    /// How the last servo period went.
    pub(super) fn step(&self) -> OneStep {
        self.state
            .as_ref()
            .map_or(OneStep::NONE, |running| running.step)
    }

    /// What noise and loads that nobody foresees make it miss, mm^2.
    pub(super) fn unforeseen_mm2(&self) -> f64 {
        let Parameters { rad_per_mm, .. } = self.model.law.parameters;
        self.model
            .unforeseen_rad2(run_periods(self.model.law.periods.servo_s))
            / (rad_per_mm * rad_per_mm)
    }

    /// The offset of the command in this servo period, by a law that is `trusted` so far; `at_mm`
    /// is the reference so many seconds after the position loop has that command, in whose place
    /// the `open` loop is followed in part.
    pub(super) fn offset_mm(
        &mut self,
        here_mm: f64,
        trusted: Trusted,
        open: f64,
        at_mm: impl Fn(f64) -> f64,
    ) -> f64 {
        let Some(running) = &mut self.state else {
            return 0.0;
        };
        let rad_per_mm = self.model.law.parameters.rad_per_mm;
        if running.path_mm.replace(here_mm).is_none() {
            for tracked in [
                &mut running.real.tracked,
                &mut running.beside.tracked,
                &mut running.open,
            ] {
                tracked.commanded_along(here_mm * rad_per_mm, self.model.law.periods.servo_s);
            }
        }
        let tracked = running.real.tracked.at_position_loop(&self.model);
        let ahead = self.model.ahead(&tracked.estimate, &tracked.sent);
        let inner = [ahead.drive.integral_nm(), ahead.masses.presliding_nm];
        let acts_s = self.known.delays.drive_s;
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
        } = self.model.law.parameters;
        let [_, off_rad_s, ..] = off;
        let reference_nm =
            kv_nm_s_per_rad * (reference_rad_s - (ahead.masses.motor.speed_rad_s - off_rad_s));
        let commands_off = self
            .state
            .as_ref()
            .map_or([0.0; 2], |running| running.commands.off_rad());
        let off = command_weight::with_commands(&off, commands_off);
        let asked_rad_s = self.asked_rad_s(reference_nm, &off, trusted);
        let offset_mm = self.solved_mm(&tracked, here_mm, reference_rad_s - asked_rad_s);
        if let Some(Running { commands, .. }) = &mut self.state {
            commands.decide(
                &self.command_law,
                &off,
                asked_rad_s,
                (here_mm + offset_mm) * rad_per_mm,
            );
        }
        offset_mm
    }

    /// The reference speed of the axis by itself, without any offset, and by how much the axis is
    /// off it.
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
        } = self.model.law.parameters;
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

    /// By how much the regulator asks for less speed than the reference has, which takes this
    /// torque.
    fn asked_rad_s(&self, reference_nm: f64, off: &[f64; REGULATED], trusted: Trusted) -> f64 {
        let Parameters {
            torque_limit_nm,
            kp_1_s,
            kv_nm_s_per_rad,
            rad_per_mm,
            ..
        } = self.model.law.parameters;
        let by_torque_rad_s = approach::left_nm(torque_limit_nm, reference_nm) / kv_nm_s_per_rad;
        let of_offset = kp_1_s * rad_per_mm;
        let room = Room {
            most_rad_s: by_torque_rad_s.min(of_offset * self.bounds.largest_mm),
            change_rad_s2: of_offset * self.bounds.fastest_mm_s,
        };
        self.regulator.asked_rad_s(off, room, trusted)
    }

    /// By how much the axis is off the reference when what is sent now begins to act, and what acts
    /// on it.
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

    /// By how much an angle, rad, and its speed, rad/s, are off theirs.
    fn off_reference(
        &self,
        [angle_rad, speed_rad_s]: [f64; 2],
        at_mm: &impl Fn(f64) -> f64,
    ) -> [f64; 2] {
        let (rad_per_mm, periods) = (self.model.law.parameters.rad_per_mm, self.model.law.periods);
        let servo_s = periods.servo_s;
        let [before_mm, there_mm, after_mm] =
            [-1.0, 0.0, 1.0].map(|n: f64| at_mm(self.known.delays.drive_s + n * servo_s));
        // The speed of the law is that of the mechanics period that has ended: half of one ago.
        let change_mm = (after_mm - there_mm) - (there_mm - before_mm);
        let late_mm_s = 0.5 * periods.mechanics_s * change_mm / (servo_s * servo_s);
        let there_mm_s = (after_mm - before_mm) / (2.0 * servo_s) - late_mm_s;
        [
            angle_rad - there_mm * rad_per_mm,
            speed_rad_s - there_mm_s * rad_per_mm,
        ]
    }

    /// What cogging takes along the reference in the period in which what is sent now acts, mm/s of
    /// reference speed; by Simpson's rule.
    fn cogging_mm_s(&self, at_mm: &impl Fn(f64) -> f64) -> f64 {
        let (parameters, servo_s) = (self.model.law.parameters, self.model.law.periods.servo_s);
        let cogging_nm = |n: f64| {
            self.model
                .cogging_nm(at_mm(self.known.delays.drive_s + n * servo_s) * parameters.rad_per_mm)
        };
        let mean_nm = (cogging_nm(0.0) + 4.0 * cogging_nm(0.5) + cogging_nm(1.0)) / 6.0;
        -mean_nm / (parameters.kv_nm_s_per_rad * parameters.rad_per_mm)
    }

    /// The offset with which the position loop asks for a reference speed, once it has the command.
    fn solved_mm(&self, tracked: &Tracked, here_mm: f64, wanted_rad_s: f64) -> f64 {
        let rad_per_mm = self.model.law.parameters.rad_per_mm;
        let asked = |command_mm: f64| tracked.asked_rad_s(&self.model, command_mm * rad_per_mm);
        // It is linear.
        let (here, beyond) = (asked(here_mm), asked(here_mm + 1.0));
        (wanted_rad_s - here) / (beyond - here)
    }
}
