//! The machine: position servo, drive and mechanics of each axis.
//!
//! ```text
//! e     = 2 pi (cmd - x) / p                     position error at the motor, rad
//! w_ref = Kp e + Kd (e - e_prev) / Ts            PD position loop, once a servo period Ts
//! u     = clamp(Kv (w_ref - w), -Tmax, Tmax)     P speed loop with saturation, every mechanics period dt
//! J dw/dt = u - B w - Fc tanh(w / w_s) - D sin(2 pi f t)
//! ```
//!
//! integrated by semi-implicit Euler: w first, then the angle with the new w. `cmd` is held for one servo period; t, and
//! with it the disturbance, is taken at the start of each mechanics period; the axis starts at rest.
//!
//! A machine file may add what a real axis has on top, each in its own file:
//!
//! | File | What |
//! |---|---|
//! | `plant/transmission.rs` | motor and table as two masses: stiffness, damping, backlash of the ball screw |
//! | `plant/drive.rs` | delay of the reference speed, steps of the torque command |
//!
//! and encoder steps: what is measured, by the position loop and by the controller, is a whole number of them.
//!
//! Source: Lee, Cho and Jeon (2005), section 4, Table 1 and Fig. 6. The paper names the parts and the values of Table 1;
//! the laws are written out as usual for such a loop, and the values that the paper leaves open stand, with their
//! reasons, in the machine file.

mod drive;
mod transmission;

use std::f64::consts::TAU;

use feedwright_control::activation::tanh;

use crate::machine::{Axis, Machine};
use drive::{Delay, in_steps, torque_step_nm};
use transmission::Joint;

/// What the machine did in one servo period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement<const N: usize> {
    /// True position of the tool at the end of the servo period, mm.
    pub position_mm: [f64; N],
    /// The position as it is measured, mm.
    pub measured_mm: [f64; N],
    /// Motor torque at the end of the servo period, N m.
    pub torque_nm: [f64; N],
}

/// N axes and their state.
#[derive(Debug, Clone)]
pub struct Plant<const N: usize> {
    servo_s: f64,
    mechanics_s: f64,
    /// Mechanics periods in a servo period.
    substeps: u32,
    /// Servo periods since the start.
    period: u64,
    rad_per_mm: [f64; N],
    kp_1_s: [f64; N],
    kd: [f64; N],
    kv: [f64; N],
    torque_limit_nm: [f64; N],
    viscous_nm_s: [f64; N],
    coulomb_nm: [f64; N],
    inverse_smoothing_s: [f64; N],
    disturbance_nm: [f64; N],
    disturbance_rad_s: [f64; N],
    /// cos and sin of the angle by which the disturbance turns in one mechanics period.
    disturbance_turn: [[f64; 2]; N],
    inverse_inertia: [f64; N],
    /// Angle of the motor, rad, and its speed, rad/s.
    angle_rad: [f64; N],
    speed_rad_s: [f64; N],
    last_error_rad: [f64; N],
    /// What a rigid axis with an ideal drive and encoder does not have; none where no axis has any of it.
    real: Option<Box<[Real; N]>>,
}

/// What an axis has on top of the ideal one, and its state.
#[derive(Debug, Clone)]
struct Real {
    encoder_step_rad: f64,
    delay: Delay,
    torque_step_nm: f64,
    joint: Option<Joint>,
    scale_on_table: bool,
    /// Angle of the table at the motor shaft, rad, and its speed, rad/s; those of the motor where there is no joint.
    table_rad: f64,
    table_rad_s: f64,
}

impl Real {
    fn new(axis: &Axis, machine: &Machine, angle_rad: f64) -> Self {
        Self {
            encoder_step_rad: axis.encoder_step_um * 1e-3 * TAU / axis.lead_mm_per_rev,
            delay: Delay::new(axis, &machine.period),
            torque_step_nm: torque_step_nm(axis),
            joint: axis.transmission.as_ref().map(|transmission| Joint::new(axis, transmission)),
            scale_on_table: axis.transmission.is_some_and(|transmission| transmission.scale_on_table),
            table_rad: angle_rad,
            table_rad_s: 0.0,
        }
    }

    fn is_ideal(axis: &Axis) -> bool {
        axis.encoder_step_um == 0.0
            && axis.drive_delay_s == 0.0
            && axis.torque_bits.is_none()
            && axis.transmission.is_none()
    }
}

impl<const N: usize> Plant<N> {
    /// The first N axes of a machine, at rest at `start_mm`.
    pub fn new(machine: &Machine, start_mm: [f64; N]) -> Self {
        let each = |value: fn(&Axis) -> f64| -> [f64; N] { std::array::from_fn(|i| value(machine.axis(i))) };
        let rad_per_mm = each(|a| TAU / a.lead_mm_per_rev);
        let disturbance_rad_s = each(|a| TAU * a.disturbance_hz);
        let mechanics_s = machine.period.mechanics_s;
        let angle_rad: [f64; N] = std::array::from_fn(|i| start_mm[i] * rad_per_mm[i]);
        let real = (0..N).any(|i| !Real::is_ideal(machine.axis(i)));
        Self {
            servo_s: machine.period.servo_s,
            mechanics_s,
            substeps: machine.period.mechanics_per_servo,
            period: 0,
            rad_per_mm,
            kp_1_s: each(|a| a.kp_1_s),
            kd: each(|a| a.kd),
            kv: each(|a| a.kv_nm_s_per_rad),
            torque_limit_nm: each(|a| a.torque_limit_nm),
            viscous_nm_s: each(|a| a.viscous_friction_nm_s),
            coulomb_nm: each(|a| a.coulomb_friction_nm),
            inverse_smoothing_s: each(|a| 1.0 / a.coulomb_smoothing_rad_s),
            disturbance_nm: each(|a| a.disturbance_nm),
            disturbance_rad_s,
            disturbance_turn: disturbance_rad_s.map(|w| {
                let (sin, cos) = (w * mechanics_s).sin_cos();
                [cos, sin]
            }),
            inverse_inertia: each(|a| 1.0 / a.inertia_kg_m2),
            angle_rad,
            speed_rad_s: [0.0; N],
            last_error_rad: [0.0; N],
            real: real.then(|| Box::new(std::array::from_fn(|i| Real::new(machine.axis(i), machine, angle_rad[i])))),
        }
    }

    /// The machine becomes another one in mid-cut, as where a workpiece is loaded: angles, speeds, errors and time go on, but what
    /// was on its way through a drive's delay is lost. Leads and periods are to be the same.
    pub fn change_to(&mut self, machine: &Machine) {
        let before = std::mem::replace(self, Self::new(machine, self.position_mm()));
        self.period = before.period;
        (self.angle_rad, self.speed_rad_s) = (before.angle_rad, before.speed_rad_s);
        self.last_error_rad = before.last_error_rad;
        let Some(real) = &mut self.real else { return };
        for (i, axis) in real.iter_mut().enumerate() {
            (axis.table_rad, axis.table_rad_s) = match &before.real {
                Some(real) => (real[i].table_rad, real[i].table_rad_s),
                None => (before.angle_rad[i], before.speed_rad_s[i]),
            };
        }
    }

    /// Where the tool is, mm.
    pub fn position_mm(&self) -> [f64; N] {
        match &self.real {
            Some(real) => std::array::from_fn(|i| real[i].table_rad / self.rad_per_mm[i]),
            None => std::array::from_fn(|i| self.angle_rad[i] / self.rad_per_mm[i]),
        }
    }

    /// The position as it is measured, rad at the motor shaft.
    fn measured_rad(&self) -> [f64; N] {
        let Some(real) = &self.real else { return self.angle_rad };
        std::array::from_fn(|i| {
            let at = if real[i].scale_on_table { real[i].table_rad } else { self.angle_rad[i] };
            in_steps(at, real[i].encoder_step_rad)
        })
    }

    /// One servo period at the position command `command_mm`.
    pub fn step(&mut self, command_mm: [f64; N]) -> Measurement<N> {
        let reference_rad_s = self.position_loop(command_mm);
        let torque_nm = if self.real.is_some() { self.turn_real(reference_rad_s) } else { self.turn(reference_rad_s) };
        self.period += 1;
        let measured_rad = self.measured_rad();
        Measurement {
            position_mm: self.position_mm(),
            measured_mm: std::array::from_fn(|i| measured_rad[i] / self.rad_per_mm[i]),
            torque_nm,
        }
    }

    /// Time goes on by servo periods in which nothing moves: speeds and angles stay, the disturbance is that of the time.
    pub fn skip(&mut self, periods: u64) {
        self.period += periods;
    }

    /// The mechanics of one servo period; the torque at its end.
    fn turn(&mut self, reference_rad_s: [f64; N]) -> [f64; N] {
        let mut disturbance = self.disturbance_at_start();
        let mut torque_nm = [0.0; N];
        for _ in 0..self.substeps {
            let w = self.speed_rad_s;
            let sign = tanh(std::array::from_fn::<_, N, _>(|i| w[i] * self.inverse_smoothing_s[i]));
            for i in 0..N {
                let limit = self.torque_limit_nm[i];
                torque_nm[i] = (self.kv[i] * (reference_rad_s[i] - w[i])).clamp(-limit, limit);
                let load = self.viscous_nm_s[i] * w[i]
                    + self.coulomb_nm[i] * sign[i]
                    + self.disturbance_nm[i] * disturbance[i][1];
                self.speed_rad_s[i] += self.mechanics_s * self.inverse_inertia[i] * (torque_nm[i] - load);
                self.angle_rad[i] += self.mechanics_s * self.speed_rad_s[i];
                let ([c, s], [dc, ds]) = (disturbance[i], self.disturbance_turn[i]);
                disturbance[i] = [c * dc - s * ds, s * dc + c * ds];
            }
        }
        torque_nm
    }

    /// As [`Self::turn`], of real axes.
    fn turn_real(&mut self, reference_rad_s: [f64; N]) -> [f64; N] {
        let mut disturbance = self.disturbance_at_start();
        let mut torque_nm = [0.0; N];
        let Some(real) = &mut self.real else { return torque_nm };
        for (axis, reference_rad_s) in real.iter_mut().zip(reference_rad_s) {
            axis.delay.send(reference_rad_s);
        }
        let dt_s = self.mechanics_s;
        for substep in 0..self.substeps {
            for (i, axis) in real.iter_mut().enumerate() {
                let limit = self.torque_limit_nm[i];
                let w = self.speed_rad_s[i];
                let wanted = (self.kv[i] * (axis.delay.arrived(substep) - w)).clamp(-limit, limit);
                torque_nm[i] = in_steps(wanted, axis.torque_step_nm);
                let sliding = if axis.joint.is_some() { axis.table_rad_s } else { w };
                let [sign] = tanh([sliding * self.inverse_smoothing_s[i]]);
                let load = self.viscous_nm_s[i] * sliding
                    + self.coulomb_nm[i] * sign
                    + self.disturbance_nm[i] * disturbance[i][1];
                match &axis.joint {
                    Some(joint) => {
                        let through = joint.torque_nm(self.angle_rad[i] - axis.table_rad, w - axis.table_rad_s);
                        self.speed_rad_s[i] += dt_s * joint.inverse_motor_inertia * (torque_nm[i] - through);
                        axis.table_rad_s += dt_s * joint.inverse_table_inertia * (through - load);
                        self.angle_rad[i] += dt_s * self.speed_rad_s[i];
                        axis.table_rad += dt_s * axis.table_rad_s;
                    }
                    None => {
                        self.speed_rad_s[i] += dt_s * self.inverse_inertia[i] * (torque_nm[i] - load);
                        self.angle_rad[i] += dt_s * self.speed_rad_s[i];
                        (axis.table_rad, axis.table_rad_s) = (self.angle_rad[i], self.speed_rad_s[i]);
                    }
                }
                let ([c, s], [dc, ds]) = (disturbance[i], self.disturbance_turn[i]);
                disturbance[i] = [c * dc - s * ds, s * dc + c * ds];
            }
        }
        torque_nm
    }

    /// The PD position loop: reference speed of the motor, rad/s, held for the servo period.
    fn position_loop(&mut self, command_mm: [f64; N]) -> [f64; N] {
        let measured_rad = self.measured_rad();
        std::array::from_fn(|i| {
            let error = command_mm[i] * self.rad_per_mm[i] - measured_rad[i];
            let rate = (error - self.last_error_rad[i]) / self.servo_s;
            self.last_error_rad[i] = error;
            self.kp_1_s[i] * error + self.kd[i] * rate
        })
    }

    /// cos and sin of the disturbance's phase at the start of the servo period: exact there, turned from substep to
    /// substep within it.
    fn disturbance_at_start(&self) -> [[f64; 2]; N] {
        let t_s = self.period as f64 * self.servo_s;
        self.disturbance_rad_s.map(|w| {
            let (sin, cos) = (w * t_s).sin_cos();
            [cos, sin]
        })
    }
}
