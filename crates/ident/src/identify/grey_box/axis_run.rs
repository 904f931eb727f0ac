//! Free runs of an axis: the response of its model to the commands alone, from an initial state.
//!
//! The model is [`feedwright_control::axis`], with the numbers of [`super::terms`]. A sample of the
//! record is a whole number of servo periods, a servo period [`MECHANICS_PER_SERVO`] mechanics
//! periods. Delays and the window of the speed are fractions of these, by linear interpolation, so
//! that they can be fitted.

use std::array::from_fn;

use feedwright_control::{
    AxisModel, AxisState, DriveModel, DriveReference, DriveState, FrictionModel, Periods,
    TransmissionModel,
};

use super::terms::{ModelTerm, TermValues};

/// Mechanics periods in a servo period: as tnv40's.
pub(super) const MECHANICS_PER_SERVO: u32 = 10;
/// Longest servo period that a machine is taken to have, s: a record with fewer samples is one of
/// several servo periods a sample.
const LONGEST_SERVO_S: f64 = 0.0041;

/// Periods of the loops of a machine whose record has such samples.
pub(super) fn periods(sample_s: f64) -> (Periods, usize) {
    // A sample time that is not a number or far too long is the reader's to refuse.
    let servo_per_sample = (sample_s / LONGEST_SERVO_S).ceil().clamp(1.0, 1000.0);
    let servo_s = sample_s / servo_per_sample;
    let mechanics_s = servo_s / f64::from(MECHANICS_PER_SERVO);
    (
        Periods {
            servo_s,
            mechanics_s,
            mechanics_per_servo: MECHANICS_PER_SERVO,
        },
        servo_per_sample as usize,
    )
}

/// Commands of an even stretch of a record, mm.
#[derive(Debug, Clone, Copy)]
pub(super) struct Commands<'a> {
    mm: &'a [f64],
}

impl<'a> Commands<'a> {
    pub(super) fn new(mm: &'a [f64]) -> Self {
        Self { mm }
    }

    /// Returns the command at a time, in samples since the start of the stretch. Beyond an end it
    /// returns the command at that end.
    #[inline]
    pub(super) fn at_mm(&self, samples: f64) -> f64 {
        let last = self.mm.len() - 1;
        let before = samples.floor();
        if before < 0.0 {
            return self.mm[0];
        }
        let index = before as usize;
        if index >= last {
            return self.mm[last];
        }
        let part = samples - before;
        self.mm[index] + part * (self.mm[index + 1] - self.mm[index])
    }
}

/// The last values of something, one a period.
#[derive(Debug, Clone)]
struct Recent<T> {
    values: Vec<T>,
    newest: usize,
}

impl<T: Copy> Recent<T> {
    /// Reserves room for `before` values in addition to the newest.
    fn new(before: usize, value: impl Fn(usize) -> T) -> Self {
        let length = (before + 1).next_power_of_two();
        let values = (0..length)
            .map(|age| value((length - age) % length))
            .collect();
        Self { values, newest: 0 }
    }

    #[inline]
    fn push(&mut self, value: T) {
        self.newest = (self.newest + 1) & (self.values.len() - 1);
        self.values[self.newest] = value;
    }

    /// Returns the value that came `age` periods before the newest.
    #[inline]
    fn before(&self, age: usize) -> T {
        let length = self.values.len();
        self.values[(self.newest + length - age) & (length - 1)]
    }
}

/// An axis, ready to run.
#[derive(Debug, Clone)]
pub(super) struct AxisRun {
    values: TermValues,
    axis_model: AxisModel,
    drive: DriveModel,
    friction: FrictionModel,
    servo_per_sample: usize,
    /// Samples by which the position loop has the commands of the record late.
    late_samples: f64,
    /// Delay within the loop, mechanics periods.
    loop_late: f64,
    /// Ages of the two references that act in each mechanics period of a servo period, and the part
    /// of the older.
    arrive: [[usize; 2]; MECHANICS_PER_SERVO as usize],
    loop_part: f64,
    /// Window of the speed, mechanics periods; none is the speed itself.
    window: Option<f64>,
    /// Motor and table, where the screw is not rigid.
    screw: Option<TransmissionModel>,
    /// The speed is taken at the start of each servo period, and held.
    holds: bool,
}

/// State of an axis, and the memory of its drive.
#[derive(Debug, Clone)]
pub(super) struct RunState {
    axis: AxisState,
    drive: DriveState,
    presliding: f64,
    /// A load that an observer found, mm/s2.
    load: f64,
    /// Position and speed of the table, mm and mm/s, where it is a mass of its own.
    table: [f64; 2],
    /// Speed that the drive has taken, mm/s.
    taken_mm_s: f64,
    /// Positions at the starts of mechanics periods.
    course: Recent<f64>,
    /// References of servo periods.
    sent: Recent<DriveReference>,
}

impl RunState {
    /// Position, mm.
    pub(super) fn position_mm(&self) -> f64 {
        self.axis.angle_rad
    }

    /// Speed of the mass as a whole, which a torque accelerates, and of the part that slides, mm/s.
    pub(super) fn of_whole_and_sliding_mm_s(&self, table_share: Option<f64>) -> [f64; 2] {
        let motor_mm_s = self.axis.speed_rad_s;
        let Some(share) = table_share else {
            return [motor_mm_s; 2];
        };
        [
            motor_mm_s + share * (self.table[1] - motor_mm_s),
            self.table[1],
        ]
    }

    /// Friction of the presliding spring, mm/s2.
    pub(super) fn presliding_mm_s2(&self) -> f64 {
        self.presliding
    }

    /// Adds the corrections of an observer to position, speed and load.
    pub(super) fn correct(&mut self, [mm, mm_s, mm_s2]: [f64; 3]) {
        self.axis.angle_rad += mm;
        self.course
            .values
            .iter_mut()
            .for_each(|position| *position += mm);
        self.axis.speed_rad_s += mm_s;
        self.table[0] += mm;
        self.table[1] += mm_s;
        self.load += mm_s2;
    }
}

impl AxisRun {
    pub(super) fn new(values: &TermValues, sample_s: f64) -> Self {
        let (periods, servo_per_sample) = periods(sample_s);
        let axis_model = AxisModel::new(values.parameters(periods.mechanics_s), periods);
        let window = values.get(ModelTerm::SpeedWindow) / periods.mechanics_s;
        let loop_late = values.get(ModelTerm::LoopDelay) / periods.mechanics_s;
        let age = |late: f64| (late / f64::from(MECHANICS_PER_SERVO)).ceil().max(0.0) as usize;
        Self {
            values: *values,
            axis_model,
            drive: DriveModel::new(&axis_model),
            friction: FrictionModel::new(&axis_model),
            servo_per_sample,
            late_samples: values.commands_late_s() / sample_s,
            loop_late,
            arrive: from_fn(|substep| {
                [0.0, 1.0].map(|more| age(loop_late.floor() + more - substep as f64))
            }),
            loop_part: loop_late.fract(),
            window: (window > 1.0).then_some(window),
            screw: TransmissionModel::new(&axis_model),
            holds: values.get(ModelTerm::SpeedHold) > 0.0,
        }
    }

    /// Moving evenly at a sample: the integral carries the friction.
    pub(super) fn state(
        &self,
        commands: &Commands<'_>,
        sample: usize,
        mm: f64,
        mm_s: f64,
    ) -> RunState {
        let Periods {
            servo_s,
            mechanics_s,
            mechanics_per_servo,
        } = self.axis_model.periods;
        let per_servo = mechanics_per_servo as usize;
        let sign = if mm_s.abs() > self.axis_model.parameters.coulomb_smoothing_rad_s {
            mm_s.signum()
        } else {
            0.0
        };
        let sliding = sign * self.values.get(ModelTerm::Coulomb)
            + sign.abs() * self.values.get(ModelTerm::Offset);
        let carried = sliding + self.values.get(ModelTerm::Viscous) * mm_s;
        let mut axis = AxisState {
            angle_rad: mm,
            speed_rad_s: mm_s,
            error_rad: 0.0,
        };
        let mut drive = DriveState::AT_REST;
        // What the commands before were, it remembers.
        let mut reference = DriveReference::default();
        for servo_periods in [3.0, 2.0, 1.0] {
            let at = sample as f64 - servo_periods / self.servo_per_sample as f64;
            let position_mm = mm - servo_periods * servo_s * mm_s;
            reference = self.drive.position_loop(
                &self.axis_model,
                self.command_mm(commands, at),
                position_mm,
                &mut axis,
                &mut drive,
            );
        }
        let integral = if self.values.get(ModelTerm::Integral) > 0.0 {
            carried
        } else {
            0.0
        };
        drive.correct(integral, carried);
        let longest = self.window.unwrap_or(0.0).ceil() as usize + 1;
        let sent = self.loop_late.ceil() as usize / per_servo + 2;
        RunState {
            axis,
            drive,
            presliding: sliding,
            load: 0.0,
            table: [mm - self.leads_mm(sign), mm_s],
            taken_mm_s: mm_s,
            course: Recent::new(longest, |age| mm - age as f64 * mechanics_s * mm_s),
            sent: Recent::new(sent, |_| reference),
        }
    }

    /// Returns the lead of the motor over the table at constant speed: half the backlash, and the
    /// twist of the screw by friction.
    fn leads_mm(&self, sign: f64) -> f64 {
        let twist_s = self.values.get(ModelTerm::Resonance);
        let share = self
            .values
            .get(ModelTerm::TableShare)
            .max(f64::MIN_POSITIVE);
        let twisted = self.values.get(ModelTerm::Coulomb) / share * twist_s * twist_s;
        if self.screw.is_some() {
            sign * (0.5 * self.values.get(ModelTerm::Backlash) + twisted)
        } else {
            0.0
        }
    }

    #[inline]
    fn command_mm(&self, commands: &Commands<'_>, samples: f64) -> f64 {
        commands.at_mm(samples - self.late_samples)
    }

    /// Part of the mass that is behind a compliant screw.
    pub(super) fn table_share(&self) -> Option<f64> {
        self.screw
            .as_ref()
            .map(|_| self.values.get(ModelTerm::TableShare))
    }

    /// One sample of the record goes by.
    #[inline]
    pub(super) fn step(&self, commands: &Commands<'_>, sample: usize, state: &mut RunState) {
        Self::step_abreast(&[self], commands, sample, std::array::from_mut(state));
    }

    /// The same for several runs. They take turns: while one waits for its friction, the processor
    /// works on the others.
    #[inline]
    pub(super) fn step_abreast<const L: usize>(
        runs: &[&Self; L],
        commands: &Commands<'_>,
        sample: usize,
        states: &mut [RunState; L],
    ) {
        let [first, ..] = &runs[..] else { return };
        let (servo_per_sample, substeps) = (
            first.servo_per_sample,
            first.axis_model.periods.mechanics_per_servo,
        );
        for servo in 0..servo_per_sample {
            let at = sample as f64 + servo as f64 / servo_per_sample as f64;
            for (run, state) in runs.iter().zip(&mut *states) {
                run.refer(run.command_mm(commands, at), state);
            }
            for substep in 0..substeps {
                let (mut forces, mut inverse, mut speeds) = ([0.0; L], [1.0; L], [0.0; L]);
                for (i, (run, state)) in runs.iter().zip(&mut *states).enumerate() {
                    run.push(
                        substep as usize,
                        state,
                        [&mut forces[i], &mut inverse[i], &mut speeds[i]],
                    );
                }
                let mut presliding: [f64; L] = from_fn(|i| states[i].presliding);
                let frictions = runs.map(|run| &run.friction);
                let after = FrictionModel::speeds_after_rad_s(
                    &frictions,
                    forces,
                    inverse,
                    speeds,
                    &mut presliding,
                );
                for (i, (run, state)) in runs.iter().zip(&mut *states).enumerate() {
                    state.presliding = presliding[i];
                    run.advance(after[i], state);
                }
            }
        }
    }

    /// The position loop sends its reference.
    #[inline]
    fn refer(&self, command_mm: f64, state: &mut RunState) {
        let position_mm = state.axis.angle_rad;
        let reference = self.drive.position_loop(
            &self.axis_model,
            command_mm,
            position_mm,
            &mut state.axis,
            &mut state.drive,
        );
        state.sent.push(reference);
    }

    /// The reference that has arrived within a servo period, between two of them where the delay
    /// ends within a mechanics period.
    #[inline]
    fn arrived(&self, substep: usize, state: &RunState) -> DriveReference {
        if self.loop_late <= 0.0 {
            return state.sent.before(0);
        }
        let [newer, older] = self.arrive[substep].map(|age| state.sent.before(age));
        let part = self.loop_part;
        DriveReference {
            speed_rad_s: newer.speed_rad_s + part * (older.speed_rad_s - newer.speed_rad_s),
            torque_nm: newer.torque_nm + part * (older.torque_nm - newer.torque_nm),
        }
    }

    /// Computes the force on a mass before friction, the inverse of the mass, and its speed. The
    /// mass is the table, or the motor where the screw is rigid.
    #[inline]
    fn push(&self, substep: usize, state: &mut RunState, [forces, inverse, speed]: [&mut f64; 3]) {
        let reference = self.arrived(substep, state);
        let dt_s = self.axis_model.periods.mechanics_s;
        let taken_mm_s = match self.window {
            Some(window) => {
                state.course.push(state.axis.angle_rad);
                let (whole, part) = (window.floor() as usize, window.fract());
                let [newer, older] = [whole, whole + 1].map(|age| state.course.before(age));
                (state.axis.angle_rad - newer - part * (older - newer)) / (window * dt_s)
            }
            None => state.axis.speed_rad_s,
        };
        if !self.holds || substep == 0 {
            state.taken_mm_s = taken_mm_s;
        }
        let drive = self.drive.torque_nm(
            &self.axis_model,
            reference,
            state.taken_mm_s,
            &mut state.drive,
        );
        match &self.screw {
            None => (*forces, *speed) = (drive - state.load, state.axis.speed_rad_s),
            Some(screw) => {
                let [table_mm, table_mm_s] = state.table;
                let through = screw.torque_nm(
                    state.axis.angle_rad - table_mm,
                    state.axis.speed_rad_s - table_mm_s,
                );
                state.axis.speed_rad_s += dt_s * screw.inverse_motor_inertia * (drive - through);
                (*forces, *inverse, *speed) = (
                    through - state.load,
                    screw.inverse_table_inertia,
                    table_mm_s,
                );
            }
        }
    }

    /// A mechanics period on, at the end of which what was pushed has a speed.
    #[inline]
    fn advance(&self, after_mm_s: f64, state: &mut RunState) {
        let dt_s = self.axis_model.periods.mechanics_s;
        match &self.screw {
            None => state.axis.speed_rad_s = after_mm_s,
            Some(_) => {
                let [table_mm, table_mm_s] = &mut state.table;
                *table_mm_s = after_mm_s;
                *table_mm += dt_s * after_mm_s;
            }
        }
        state.axis.angle_rad += dt_s * state.axis.speed_rad_s;
    }
}
