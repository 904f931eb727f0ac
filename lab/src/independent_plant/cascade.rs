//! The drive: position, speed and current loop, one within the other, each sampled.
//!
//! ```text
//! c, c'  = command and its speed, late by the bus; held for a servo period, or on a line through it
//! w_ref  = kp (c - y) + f c'                       position loop, once a drive period Td; y as measured
//! w     += (1 - exp(-Td / Tf)) ((y - y_before) / Td - w)   speed, from differences of the motor's encoder
//! i*     = kv (w_ref - w) + I,   i_ref = i* within -imax, imax
//! I     += Td / Ti (kv (w_ref - w) + i_ref - i*)   speed loop: what is cut off by the limit resets the integral
//! u*     = wc L (i_ref - i) + U,   u = u* within -umax, umax
//! U     += Tc wc R (i_ref - i) + (u - u*) Tc R / L  current loop, once a period Tc
//! ```
//!
//! wc bandwidth of the current loop, rad/s, with the zero of its controller on the pole of the
//! winding (R, L).
//!
//! Source: Gross, Hamann and Wiegaertner (2001), Electrical feed drives in automation, for the
//! cascade and its settings; Astrom and Hagglund (2006), Advanced PID control, section 3.5, for the
//! reset by back-calculation.

use serde::Serialize;

use super::mechanics::WoundMotor;
use super::position_sensor::Late;

/// Settings of a drive.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct DriveCascade {
    /// Period of the current loop, s.
    pub current_s: f64,
    /// Periods of the current loop in one of the drive, and of the drive in one of the bus, which
    /// is the servo period.
    pub periods: [u32; 2],
    /// Bandwidth of the current loop, rad/s.
    pub current_rad_s: f64,
    /// Most voltage, V, and current, A.
    pub limits: [f64; 2],
    /// Gain of the speed loop, A s/rad.
    pub speed_gain_a_s: f64,
    /// Integral time of the speed loop, s.
    pub speed_integral_s: f64,
    /// Time constant of the filter on the speed, s; 0 is without.
    pub speed_filter_s: f64,
    /// Gain of the position loop, 1/s.
    pub kp_1_s: f64,
    /// Part of the command's speed that is fed forward.
    pub velocity_feedforward: f64,
    /// Delay of a command, in drive periods.
    pub bus_periods: u32,
    /// True if commands are joined by lines, which takes a servo period more; false if they are
    /// held.
    pub interpolates: bool,
}

impl DriveCascade {
    /// Period of position and speed loop, s.
    pub fn drive_s(&self) -> f64 {
        self.current_s * f64::from(self.periods[0])
    }

    /// Period of the commands, s.
    pub fn servo_s(&self) -> f64 {
        self.drive_s() * f64::from(self.periods[1])
    }
}

/// Inputs of the drive in one of its periods, at the motor shaft.
#[derive(Debug, Clone, Copy)]
pub(super) struct DriveInput {
    /// Command, rad, and its speed, rad/s.
    pub(super) command: [f64; 2],
    /// Measured position of the position loop, and of the motor, rad.
    pub(super) seen_rad: [f64; 2],
}

/// State of the drive.
#[derive(Debug, Clone)]
pub(super) struct CascadeState {
    bus: Late<[f64; 2]>,
    motor_before_rad: f64,
    speed_rad_s: f64,
    speed_integral_a: f64,
    current_ref_a: f64,
    voltage_integral_v: f64,
}

impl CascadeState {
    /// Starts at rest at a command, with the motor's encoder at an angle, holding a load with a
    /// current.
    pub(super) fn at_rest(
        cascade: &DriveCascade,
        command_rad: f64,
        motor_rad: f64,
        current_a: f64,
        motor: &WoundMotor,
    ) -> Self {
        Self {
            bus: Late::new(cascade.bus_periods, [command_rad, 0.0]),
            motor_before_rad: motor_rad,
            speed_rad_s: 0.0,
            speed_integral_a: current_a,
            current_ref_a: current_a,
            voltage_integral_v: motor.resistance_ohm * current_a,
        }
    }

    /// Position and speed loop: the reference of the current, A.
    pub(super) fn drive_period(&mut self, cascade: &DriveCascade, input: DriveInput) {
        let drive_s = cascade.drive_s();
        let [command_rad, command_rad_s] = self.bus.pass(input.command);
        let [seen_rad, motor_rad] = input.seen_rad;
        let part = if cascade.speed_filter_s > 0.0 {
            1.0 - libm::exp(-drive_s / cascade.speed_filter_s)
        } else {
            1.0
        };
        self.speed_rad_s +=
            part * ((motor_rad - self.motor_before_rad) / drive_s - self.speed_rad_s);
        self.motor_before_rad = motor_rad;
        let reference_rad_s = cascade.kp_1_s * (command_rad - seen_rad)
            + cascade.velocity_feedforward * command_rad_s;
        let proportional_a = cascade.speed_gain_a_s * (reference_rad_s - self.speed_rad_s);
        let wanted_a = proportional_a + self.speed_integral_a;
        let [_, limit_a] = cascade.limits;
        self.current_ref_a = wanted_a.clamp(-limit_a, limit_a);
        self.speed_integral_a +=
            drive_s / cascade.speed_integral_s * (proportional_a + self.current_ref_a - wanted_a);
    }

    /// Current loop: the voltage, V.
    pub(super) fn volts(
        &mut self,
        cascade: &DriveCascade,
        motor: &WoundMotor,
        current_a: f64,
    ) -> f64 {
        let error_a = self.current_ref_a - current_a;
        let wanted_v =
            cascade.current_rad_s * motor.inductance_h * error_a + self.voltage_integral_v;
        let [limit_v, _] = cascade.limits;
        let volts = wanted_v.clamp(-limit_v, limit_v);
        let reset_v = (volts - wanted_v) * motor.resistance_ohm / motor.inductance_h;
        self.voltage_integral_v +=
            cascade.current_s * (cascade.current_rad_s * motor.resistance_ohm * error_a + reset_v);
        volts
    }
}
