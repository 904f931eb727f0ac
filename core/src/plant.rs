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
//! Source: Lee, Cho and Jeon (2005), section 4, Table 1 and Fig. 6. The paper names the parts and the values of Table 1;
//! the laws are written out as usual for such a loop, and the values that the paper leaves open stand, with their
//! reasons, in the machine file.

use std::f64::consts::TAU;

use feedwright_control::activation::tanh;

use crate::machine::{Axis, Machine};

/// What the machine did in one servo period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement<const N: usize> {
    /// True position of the tool at the end of the servo period, mm.
    pub position_mm: [f64; N],
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
}

impl<const N: usize> Plant<N> {
    /// The first N axes of a machine, at rest at `start_mm`. An axis that the machine file does not have is like its
    /// last.
    pub fn new(machine: &Machine, start_mm: [f64; N]) -> Self {
        let axes = &machine.axes;
        let each =
            |value: fn(&Axis) -> f64| -> [f64; N] { std::array::from_fn(|i| value(&axes[i.min(axes.len() - 1)])) };
        let rad_per_mm = each(|a| TAU / a.lead_mm_per_rev);
        let disturbance_rad_s = each(|a| TAU * a.disturbance_hz);
        let mechanics_s = machine.period.mechanics_s;
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
            angle_rad: std::array::from_fn(|i| start_mm[i] * rad_per_mm[i]),
            speed_rad_s: [0.0; N],
            last_error_rad: [0.0; N],
        }
    }

    /// Where the tool is, mm.
    pub fn position_mm(&self) -> [f64; N] {
        std::array::from_fn(|i| self.angle_rad[i] / self.rad_per_mm[i])
    }

    /// One servo period at the position command `command_mm`.
    pub fn step(&mut self, command_mm: [f64; N]) -> Measurement<N> {
        let reference_rad_s = self.position_loop(command_mm);
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
        self.period += 1;
        Measurement { position_mm: self.position_mm(), torque_nm }
    }

    /// The PD position loop: reference speed of the motor, rad/s, held for the servo period.
    fn position_loop(&mut self, command_mm: [f64; N]) -> [f64; N] {
        std::array::from_fn(|i| {
            let error = command_mm[i] * self.rad_per_mm[i] - self.angle_rad[i];
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
