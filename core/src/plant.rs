//! The machine: position servo, drive and mechanics of each axis.
//!
//! Each axis follows the law of [`feedwright_control::axis`] under the load of a disturbance, D sin(2 pi f t), with D and f of the
//! machine file. The command is held for one servo period; t, and with it the disturbance, is taken at the start of each mechanics
//! period; the axis starts at rest.
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
//! Source: Lee, Cho and Jeon (2005), section 4, Table 1 and Fig. 6; the values that the paper leaves open stand, with their reasons, in
//! the machine file.

mod drive;
mod transmission;

use std::f64::consts::TAU;

use feedwright_control::axis::{self, AxisState, Periods};

use crate::machine::{Axis, Machine};
use drive::{Delay, in_steps, torque_step_nm};
use transmission::Coupling;

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
    laws: [axis::AxisLaw; N],
    periods: Periods,
    /// Servo periods since the start.
    period: u64,
    disturbance_nm: [f64; N],
    disturbance_rad_s: [f64; N],
    /// cos and sin of the angle by which the disturbance turns in one mechanics period.
    disturbance_turn: [[f64; 2]; N],
    /// The motors.
    states: [AxisState; N],
    /// What a rigid axis with an ideal drive and encoder does not have; none where no axis has any of it.
    nonideal: Option<Box<[NonidealAxis; N]>>,
}

/// What an axis has on top of the ideal one, and its state.
#[derive(Debug, Clone)]
struct NonidealAxis {
    encoder_step_rad: f64,
    delay: Delay,
    torque_step_nm: f64,
    coupling: Option<Coupling>,
    scale_on_table: bool,
    /// Angle of the table at the motor shaft, rad, and its speed, rad/s; those of the motor where there is no coupling.
    table_rad: f64,
    table_rad_s: f64,
}

impl NonidealAxis {
    fn new(axis: &Axis, machine: &Machine, angle_rad: f64) -> Self {
        Self {
            encoder_step_rad: axis.encoder_step_um * 1e-3 * TAU / axis.lead_mm_per_rev,
            delay: Delay::new(axis, &machine.period),
            torque_step_nm: torque_step_nm(axis),
            coupling: axis.transmission.as_ref().map(|transmission| Coupling::new(axis, transmission)),
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
        let laws: [axis::AxisLaw; N] = machine.law();
        let disturbance_rad_s = each(|a| TAU * a.disturbance_hz);
        let periods = machine.period.periods();
        let states: [AxisState; N] = std::array::from_fn(|i| AxisState {
            angle_rad: start_mm[i] * laws[i].parameters.rad_per_mm,
            ..AxisState::default()
        });
        let nonideal = (0..N).any(|i| !NonidealAxis::is_ideal(machine.axis(i)));
        Self {
            laws,
            periods,
            period: 0,
            disturbance_nm: each(|a| a.disturbance_nm),
            disturbance_rad_s,
            disturbance_turn: disturbance_rad_s.map(|w| {
                let (sin, cos) = (w * periods.mechanics_s).sin_cos();
                [cos, sin]
            }),
            states,
            nonideal: nonideal.then(|| {
                Box::new(std::array::from_fn(|i| NonidealAxis::new(machine.axis(i), machine, states[i].angle_rad)))
            }),
        }
    }

    /// The machine becomes another one in mid-cut, as where a workpiece is loaded: angles, speeds, errors and time go on, but what
    /// was on its way through a drive's delay is lost. Leads and periods are to be the same.
    pub fn change_to(&mut self, machine: &Machine) {
        let before = std::mem::replace(self, Self::new(machine, self.position_mm()));
        self.period = before.period;
        self.states = before.states;
        let Some(nonideal) = &mut self.nonideal else { return };
        for (i, axis) in nonideal.iter_mut().enumerate() {
            (axis.table_rad, axis.table_rad_s) = match &before.nonideal {
                Some(nonideal) => (nonideal[i].table_rad, nonideal[i].table_rad_s),
                None => (before.states[i].angle_rad, before.states[i].speed_rad_s),
            };
        }
    }

    /// Where the tool is, mm.
    pub fn position_mm(&self) -> [f64; N] {
        match &self.nonideal {
            Some(nonideal) => self.in_mm(std::array::from_fn(|i| nonideal[i].table_rad)),
            None => self.in_mm(self.states.map(|state| state.angle_rad)),
        }
    }

    /// Travel of the table for angles at the motor shafts, mm.
    fn in_mm(&self, angles_rad: [f64; N]) -> [f64; N] {
        std::array::from_fn(|i| angles_rad[i] / self.laws[i].parameters.rad_per_mm)
    }

    /// The position as it is measured, rad at the motor shaft.
    fn measured_rad(&self) -> [f64; N] {
        let Some(nonideal) = &self.nonideal else { return self.states.map(|state| state.angle_rad) };
        std::array::from_fn(|i| {
            let at = if nonideal[i].scale_on_table { nonideal[i].table_rad } else { self.states[i].angle_rad };
            in_steps(at, nonideal[i].encoder_step_rad)
        })
    }

    /// One servo period at the position command `command_mm`.
    pub fn step(&mut self, command_mm: [f64; N]) -> Measurement<N> {
        let reference_rad_s = self.position_loop(command_mm);
        let torque_nm =
            if self.nonideal.is_some() { self.turn_nonideal(reference_rad_s) } else { self.turn(reference_rad_s) };
        self.period += 1;
        Measurement { position_mm: self.position_mm(), measured_mm: self.in_mm(self.measured_rad()), torque_nm }
    }

    /// Time goes on by servo periods in which nothing moves: speeds and angles stay, the disturbance is that of the time.
    pub fn skip(&mut self, periods: u64) {
        self.period += periods;
    }

    /// The mechanics of one servo period; the torque at its end.
    fn turn(&mut self, reference_rad_s: [f64; N]) -> [f64; N] {
        let mut disturbance = self.disturbance_at_start();
        let mut torque_nm = [0.0; N];
        for _ in 0..self.periods.mechanics_per_servo {
            let sign = axis::signs(&self.laws, self.states.map(|state| state.speed_rad_s));
            for (i, (law, state)) in self.laws.iter().zip(&mut self.states).enumerate() {
                torque_nm[i] = law.torque_nm(reference_rad_s[i], state.speed_rad_s);
                let load = law.friction_nm(state.speed_rad_s, sign[i]) + self.disturbance_nm[i] * disturbance[i][1];
                law.accelerate(torque_nm[i] - load, state);
                let ([c, s], [dc, ds]) = (disturbance[i], self.disturbance_turn[i]);
                disturbance[i] = [c * dc - s * ds, s * dc + c * ds];
            }
        }
        torque_nm
    }

    /// As [`Self::turn`], of axes that are not ideal.
    fn turn_nonideal(&mut self, reference_rad_s: [f64; N]) -> [f64; N] {
        let mut disturbance = self.disturbance_at_start();
        let mut torque_nm = [0.0; N];
        let Some(nonideal) = &mut self.nonideal else { return torque_nm };
        for (axis, reference_rad_s) in nonideal.iter_mut().zip(reference_rad_s) {
            axis.delay.send(reference_rad_s);
        }
        let dt_s = self.periods.mechanics_s;
        for substep in 0..self.periods.mechanics_per_servo {
            for (i, axis) in nonideal.iter_mut().enumerate() {
                let (law, state) = (&self.laws[i], &mut self.states[i]);
                let wanted = law.torque_nm(axis.delay.arrived(substep), state.speed_rad_s);
                torque_nm[i] = in_steps(wanted, axis.torque_step_nm);
                let sliding = if axis.coupling.is_some() { axis.table_rad_s } else { state.speed_rad_s };
                let [sign] = axis::signs(&[*law], [sliding]);
                let load = law.friction_nm(sliding, sign) + self.disturbance_nm[i] * disturbance[i][1];
                match &axis.coupling {
                    Some(coupling) => {
                        let twist_rad = state.angle_rad - axis.table_rad;
                        let through = coupling.torque_nm(twist_rad, state.speed_rad_s - axis.table_rad_s);
                        state.speed_rad_s += dt_s * coupling.inverse_motor_inertia * (torque_nm[i] - through);
                        axis.table_rad_s += dt_s * coupling.inverse_table_inertia * (through - load);
                        state.angle_rad += dt_s * state.speed_rad_s;
                        axis.table_rad += dt_s * axis.table_rad_s;
                    }
                    None => {
                        law.accelerate(torque_nm[i] - load, state);
                        (axis.table_rad, axis.table_rad_s) = (state.angle_rad, state.speed_rad_s);
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
            let law = &self.laws[i];
            let error_rad = command_mm[i] * law.parameters.rad_per_mm - measured_rad[i];
            law.position_loop(error_rad, &mut self.states[i])
        })
    }

    /// cos and sin of the disturbance's phase at the start of the servo period: exact there, turned from substep to
    /// substep within it.
    fn disturbance_at_start(&self) -> [[f64; 2]; N] {
        let t_s = self.period as f64 * self.periods.servo_s;
        self.disturbance_rad_s.map(|w| {
            let (sin, cos) = (w * t_s).sin_cos();
            [cos, sin]
        })
    }
}
