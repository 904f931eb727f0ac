//! An axis with the imperfections of real ones, and one mechanics period of it.
//!
//! ```text
//! command -> [queue ->] position loop -> reference that has arrived -> drive -> steps of the torque -> ripple, cogging -> motor [-> screw -> table] <- load, friction
//! ```
//!
//! Effects that the machine file does not name are skipped, with results identical to the bit.

use feedwright_control::{
    AxisModel, AxisState, CommandQueue, DriveModel, DriveState, MechanicsModel, MechanicsState,
    Part,
};

use super::drive::{Delay, in_steps, torque_step_nm};
use super::encoder::{DriveSpeed, Encoder, Latency, Moment};
use super::noise::{CorrelatedNoise, RandomStream, RandomUse};
use super::torque::{MotorTorque, Wander, broadband};
use crate::machine::{Axis, Machine};

/// Imperfections that an axis has on top of the ideal one, and its state.
#[derive(Debug, Clone)]
pub(super) struct NonidealAxis {
    /// Commands on their way to the position loop, rad.
    commands: CommandQueue,
    drive: DriveModel,
    drive_state: DriveState,
    delay: Delay,
    torque_step_nm: f64,
    encoder: Encoder,
    latency: Option<Latency>,
    speed: Option<DriveSpeed>,
    /// True if either of the two is present.
    is_sensed: bool,
    motor: Option<MotorTorque>,
    mechanics: MechanicsModel,
    broadband: Option<CorrelatedNoise>,
    pub(super) wander: Option<Wander>,
    scale_on_table: bool,
    /// Table and friction; the motor is given at each step.
    masses: MechanicsState,
}

impl NonidealAxis {
    pub(super) fn new(
        machine: &Machine,
        index: usize,
        axis_model: &AxisModel,
        angle_rad: f64,
        seed: u64,
    ) -> Self {
        let (axis, period) = (machine.axis(index), &machine.period);
        let encoder = Encoder::new(axis, RandomStream::new(seed, index, RandomUse::Encoder));
        let latency = Latency::new(axis, period, angle_rad);
        let speed = DriveSpeed::new(axis, encoder, period.mechanics_s, seed, index);
        Self {
            commands: CommandQueue::resting(
                axis_model.parameters.command_periods(period.servo_s),
                angle_rad,
            ),
            // What it sees of the speed is simulated as it is.
            drive: DriveModel::new(&axis_model.with(|axis| axis.speed_window_s = 0.0)),
            drive_state: DriveState::default(),
            delay: Delay::new(axis, period, seed),
            torque_step_nm: torque_step_nm(axis),
            encoder,
            is_sensed: latency.is_some() || speed.is_some(),
            latency,
            speed,
            motor: MotorTorque::new(axis),
            mechanics: MechanicsModel::new(axis_model),
            broadband: broadband(axis, period.mechanics_s, seed, index),
            wander: Wander::new(axis, period.servo_s, period.mechanics_s, seed, index),
            scale_on_table: axis
                .transmission
                .is_some_and(|transmission| transmission.scale_on_table),
            masses: MechanicsState::at_rest(angle_rad),
        }
    }

    /// Returns true if an axis has no such imperfection.
    pub(super) fn is_ideal(axis: &Axis) -> bool {
        let absent = [
            axis.encoder_step_um,
            axis.encoder_noise_um,
            axis.interpolation_error_um,
            axis.jitter_s,
            axis.cogging_nm,
            axis.ripple,
            axis.torque_noise_nm,
            axis.disturbance_wander,
        ];
        absent.iter().all(|value| *value == 0.0)
            && !axis.speed_from_encoder
            && !axis.speed_held
            && axis.torque_bits.is_none()
            && axis.transmission.is_none()
            && [Part::Drive, Part::Delays, Part::Friction]
                .iter()
                .all(|part| !axis.parameters().has(*part))
    }

    /// The table gains the speed that a torque impulse gives it, N m s; false where the screw is
    /// rigid, and nothing changes.
    pub(super) fn push_table(&mut self, impulse_nm_s: f64) -> bool {
        let Some(screw) = self.mechanics.transmission() else {
            return false;
        };
        self.masses.table.speed_rad_s += impulse_nm_s * screw.inverse_table_inertia;
        true
    }

    /// The position at the start of a servo period, as the control has it, rad at the motor shaft.
    pub(super) fn measured_rad(&self, motor: &AxisState, counter: u64) -> f64 {
        match &self.latency {
            Some(latency) => latency.arrived_rad(),
            None => self.shown_rad(motor, counter),
        }
    }

    /// Angle of the table at the motor shaft, rad; the motor's where the screw is rigid.
    #[inline]
    pub(super) fn table_rad(&self) -> f64 {
        self.masses.table.angle_rad
    }

    /// Speed of the table, rad/s at the motor shaft.
    pub(super) fn table_rad_s(&self) -> f64 {
        self.masses.table.speed_rad_s
    }

    /// Returns the reading of the encoder.
    #[inline]
    fn shown_rad(&self, motor: &AxisState, counter: u64) -> f64 {
        self.encoder.read(
            if self.scale_on_table {
                self.table_rad()
            } else {
                motor.angle_rad
            },
            counter,
        )
    }

    /// The position loop: what it asks for leaves for the drive.
    pub(super) fn position_loop(
        &mut self,
        axis_model: &AxisModel,
        command_rad: f64,
        motor: &mut AxisState,
        period: u64,
        counter: u64,
    ) {
        let measured_rad = self.measured_rad(motor, counter);
        let arrived_rad = self.commands.pass(command_rad);
        let reference = self.drive.position_loop(
            axis_model,
            arrived_rad,
            measured_rad,
            motor,
            &mut self.drive_state,
        );
        self.delay.send(reference, period);
    }

    /// One mechanics period under a disturbance; the torque of the drive, N m.
    #[inline]
    pub(super) fn advance(
        &mut self,
        axis_model: &AxisModel,
        motor: &mut AxisState,
        moment: Moment,
        disturbance_nm: f64,
    ) -> f64 {
        let speed_rad_s = if self.is_sensed {
            self.sensed_rad_s(axis_model, motor, moment)
        } else {
            motor.speed_rad_s
        };
        let reference = self.delay.arrived(moment.substep);
        let wanted_nm =
            self.drive
                .torque_nm(axis_model, reference, speed_rad_s, &mut self.drive_state);
        let torque_nm = in_steps(wanted_nm, self.torque_step_nm);
        let load_nm = match &mut self.broadband {
            Some(noise) => disturbance_nm + noise.next(moment.counter),
            None => disturbance_nm,
        };
        let motor_nm = match &self.motor {
            Some(unevenness) => unevenness.at_nm(torque_nm, motor.angle_rad),
            None => torque_nm,
        };
        self.masses.motor = *motor;
        self.mechanics.advance(&mut self.masses, motor_nm, load_nm);
        *motor = self.masses.motor;
        torque_nm
    }

    /// The position on its way to the control is taken; the speed as the drive has it.
    fn sensed_rad_s(&mut self, axis_model: &AxisModel, motor: &AxisState, moment: Moment) -> f64 {
        if self
            .latency
            .as_ref()
            .is_some_and(|latency| latency.takes(moment.substep))
        {
            let shown_rad = self.shown_rad(motor, moment.counter);
            if let Some(latency) = &mut self.latency {
                latency.take(shown_rad);
            }
        }
        match &mut self.speed {
            Some(speed) => speed.speed_rad_s(motor, moment, axis_model.periods.mechanics_s),
            None => motor.speed_rad_s,
        }
    }
}
