//! The machine: position servo, drive and mechanics of each axis.
//!
//! Each axis follows the model of [`feedwright_control::axis`] under a disturbance torque, D sin(2
//! pi f t), with D and f from the machine file. The command is held for one servo period. The time
//! t, and with it the disturbance, is taken at the start of each mechanics period. The axis starts
//! at rest.
//!
//! A machine file may add what a real axis has on top, each in its own file:
//!
//! | File | What |
//! |---|---|
//! | `plant/drive.rs` | delay and jitter of what goes to the drive, steps of the torque command |
//! | `plant/encoder.rs` | what is measured: interpolation error, noise, steps, latency, speed by differences |
//! | `plant/torque.rs` | ripple and cogging of the motor, broadband torque, a disturbance whose frequency wanders |
//! | `plant/noise.rs` | the random numbers of all of these |
//! | `plant/nonideal.rs` | an axis with all of it |
//! | `plant/gap.rs` | backlash that a geometry states of an axis without a screw |
//!
//! What a controller may have to predict of a drive and of friction stands in
//! [`feedwright_control::axis`], the geometry that no encoder sees in
//! [`feedwright_control::KnownGeometry`].
//!
//! Source: Lee, Cho and Jeon (2005), section 4, Table 1 and Fig. 6; the values that the paper
//! leaves open stand, with their reasons, in the machine file.

mod noise;
mod drive;
mod encoder;
mod torque;
mod nonideal;
mod gap;
use std::f64::consts::TAU;

use feedwright_control::{AxisModel, AxisState, KnownGeometry, Periods, friction_signs};

use crate::kinematics::{joints_of, tool_of};
use crate::machine::{Axis, Machine};
use encoder::Moment;
use gap::TableGap;
use nonideal::NonidealAxis;

/// Motion and torque of the machine in one servo period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measurement<const N: usize> {
    /// True position of the tool at the end of the servo period, mm.
    pub position_mm: [f64; N],
    /// Position of the joints, mm: the tool position without the geometric errors that no encoder
    /// sees.
    pub joint_mm: [f64; N],
    /// The position as it is measured, mm.
    pub measured_mm: [f64; N],
    /// Motor torque at the end of the servo period, N m.
    pub torque_nm: [f64; N],
}

impl<const N: usize> Measurement<N> {
    /// The same of the first M axes; an axis that is not there is at zero.
    pub(crate) fn of_axes<const M: usize>(&self) -> Measurement<M> {
        let of = |values: [f64; N]| joints_of(tool_of(values));
        Measurement {
            position_mm: of(self.position_mm),
            joint_mm: of(self.joint_mm),
            measured_mm: of(self.measured_mm),
            torque_nm: of(self.torque_nm),
        }
    }
}

/// Machine that the closed loop moves: a [`Plant`], or a machine of other equations in its place.
/// It has three axes; a run of two axes uses the first two.
pub trait Mechanism {
    /// One servo period at the position command `command_mm`.
    fn step(&mut self, command_mm: [f64; 3]) -> Measurement<3>;

    /// Lets `periods` servo periods pass in which the command rests.
    fn skip(&mut self, periods: u64);

    /// Returns true if the tool position differs from the encoder positions.
    fn has_geometry(&self) -> bool;
}

impl dyn Mechanism {
    /// Returns the first two axes of a machine, or three of them, as [`Plant::new`] does. Both are
    /// compiled here, with the optimization of this crate, and not where a cut is asked for.
    pub(crate) fn of(machine: &Machine, axes: usize, start_mm: [f64; 3]) -> Box<Self> {
        if axes == 2 {
            Box::new(Plant::<2>::new(machine, joints_of(start_mm)))
        } else {
            Box::new(Plant::<3>::new(machine, start_mm))
        }
    }
}

impl<const N: usize> Mechanism for Plant<N> {
    fn step(&mut self, command_mm: [f64; 3]) -> Measurement<3> {
        Plant::step(self, joints_of(command_mm)).of_axes()
    }

    fn skip(&mut self, periods: u64) {
        Plant::skip(self, periods);
    }

    fn has_geometry(&self) -> bool {
        Plant::has_geometry(self)
    }
}

/// N axes and their state.
#[derive(Debug, Clone)]
pub struct Plant<const N: usize> {
    axis_models: [AxisModel; N],
    periods: Periods,
    /// Servo periods since the start.
    period: u64,
    disturbance_nm: [f64; N],
    disturbance_rad_s: [f64; N],
    /// cos and sin of the angle by which the disturbance turns in one mechanics period.
    disturbance_turn: [[f64; 2]; N],
    /// Torque beside all that the machine file names, N m at the motor shaft.
    added_nm: [f64; N],
    /// The motors.
    states: [AxisState; N],
    /// Effects beyond a rigid axis with an ideal drive and encoder; `None` if no axis has any.
    nonideal: Option<Box<[NonidealAxis; N]>>,
    /// Geometric errors that no encoder sees; `None` if there is no such error.
    geometry: Option<Box<KnownGeometry<N>>>,
    /// Gaps between joints and tables; `None` if no axis has a gap.
    gap: Option<Box<TableGap<N>>>,
}

impl<const N: usize> Plant<N> {
    /// The first N axes of a machine, at rest with the joints at `start_mm`; its random numbers are
    /// by the seed of its file.
    pub fn new(machine: &Machine, start_mm: [f64; N]) -> Self {
        Self::with_seed(machine, start_mm, machine.noise.seed)
    }

    /// Creates the plant as [`Self::new`] does, with another seed of its random numbers.
    pub fn with_seed(machine: &Machine, start_mm: [f64; N], seed: u64) -> Self {
        let each = |value: fn(&Axis) -> f64| -> [f64; N] {
            std::array::from_fn(|i| value(machine.axis(i)))
        };
        let axis_models: [AxisModel; N] = machine.axis_model();
        let disturbance_rad_s = each(|a| TAU * a.disturbance_hz);
        let periods = machine.period.periods();
        let states: [AxisState; N] = std::array::from_fn(|i| AxisState {
            angle_rad: start_mm[i] * axis_models[i].parameters.rad_per_mm,
            ..AxisState::default()
        });
        let nonideal = (0..N).any(|i| !NonidealAxis::is_ideal(machine.axis(i)));
        let geometry = machine.errors_of_geometry().map(Box::new);
        Self {
            axis_models,
            periods,
            period: 0,
            disturbance_nm: each(|a| a.disturbance_nm),
            disturbance_rad_s,
            disturbance_turn: disturbance_rad_s.map(|w| cos_sin(w * periods.mechanics_s)),
            added_nm: [0.0; N],
            states,
            nonideal: nonideal.then(|| {
                Box::new(std::array::from_fn(|i| {
                    NonidealAxis::new(machine, i, &axis_models[i], states[i].angle_rad, seed)
                }))
            }),
            gap: geometry
                .as_ref()
                .and_then(|known| TableGap::new(machine, known, start_mm))
                .map(Box::new),
            geometry,
        }
    }

    /// A blow: torque impulses that act at once, N m s at the motor shaft. They act on the table
    /// where the screw gives, as loads do.
    pub fn push(&mut self, impulse_nm_s: [f64; N]) {
        for (i, impulse_nm_s) in impulse_nm_s.into_iter().enumerate() {
            let pushed = self
                .nonideal
                .as_mut()
                .is_some_and(|nonideal| nonideal[i].push_table(impulse_nm_s));
            if !pushed {
                self.states[i].speed_rad_s +=
                    impulse_nm_s / self.axis_models[i].parameters.inertia_kg_m2;
            }
        }
    }

    /// Adds a torque from now on, N m at the motor shaft, in place of the one that was added
    /// before: a positive one pushes the axis in its positive direction. It acts where loads do, on
    /// the table where the screw gives.
    pub fn add_torque(&mut self, added_nm: [f64; N]) {
        self.added_nm = added_nm;
    }

    /// Returns the speeds of the joints, mm/s.
    pub fn joint_mm_s(&self) -> [f64; N] {
        match &self.nonideal {
            Some(nonideal) => self.in_mm(std::array::from_fn(|i| nonideal[i].table_rad_s())),
            None => self.in_mm(self.states.map(|state| state.speed_rad_s)),
        }
    }

    /// Returns true if the tool position differs from the encoder positions.
    pub fn has_geometry(&self) -> bool {
        self.geometry.is_some()
    }

    /// Returns the tool position, mm.
    pub fn position_mm(&self) -> [f64; N] {
        self.tool_mm(self.joint_mm())
    }

    /// Returns the joint positions, mm.
    fn joint_mm(&self) -> [f64; N] {
        match &self.nonideal {
            Some(nonideal) => self.in_mm(std::array::from_fn(|i| nonideal[i].table_rad())),
            None => self.in_mm(self.states.map(|state| state.angle_rad)),
        }
    }

    fn tool_mm(&self, joint_mm: [f64; N]) -> [f64; N] {
        let table_mm = self.gap.as_ref().map_or(joint_mm, |gap| gap.table_mm());
        self.geometry
            .as_ref()
            .map_or(joint_mm, |geometry| geometry.tool_mm(table_mm))
    }

    /// Travel of the table for angles at the motor shafts, mm.
    fn in_mm(&self, angles_rad: [f64; N]) -> [f64; N] {
        std::array::from_fn(|i| angles_rad[i] / self.axis_models[i].parameters.rad_per_mm)
    }

    /// The position as it is measured, rad at the motor shaft.
    fn measured_rad(&self) -> [f64; N] {
        let Some(nonideal) = &self.nonideal else {
            return self.states.map(|state| state.angle_rad);
        };
        let counter = self.counter();
        std::array::from_fn(|i| nonideal[i].measured_rad(&self.states[i], counter))
    }

    /// Mechanics periods since the start, at the start of a servo period.
    fn counter(&self) -> u64 {
        self.period * u64::from(self.periods.mechanics_per_servo)
    }

    /// One servo period at the position command `command_mm`.
    pub fn step(&mut self, command_mm: [f64; N]) -> Measurement<N> {
        let torque_nm = if self.nonideal.is_some() {
            self.turn_nonideal(command_mm)
        } else {
            let reference_rad_s = self.position_loop(command_mm);
            self.turn(reference_rad_s)
        };
        self.period += 1;
        let joint_mm = self.joint_mm();
        self.gap.iter_mut().for_each(|gap| gap.follow(joint_mm));
        let measured_mm = self.in_mm(self.measured_rad());
        Measurement {
            position_mm: self.tool_mm(joint_mm),
            joint_mm,
            measured_mm,
            torque_nm,
        }
    }

    /// Advances time by `periods` servo periods in which nothing moves. Speeds and angles stay; the
    /// disturbance continues at the new time.
    pub fn skip(&mut self, periods: u64) {
        self.period += periods;
    }

    /// The mechanics of one servo period; the torque at its end.
    fn turn(&mut self, reference_rad_s: [f64; N]) -> [f64; N] {
        let mut disturbance = self.disturbance_at_start();
        let mut torque_nm = [0.0; N];
        for _ in 0..self.periods.mechanics_per_servo {
            let sign = friction_signs(
                &self.axis_models,
                self.states.map(|state| state.speed_rad_s),
            );
            for (i, (axis_model, state)) in
                self.axis_models.iter().zip(&mut self.states).enumerate()
            {
                torque_nm[i] = axis_model.torque_nm(reference_rad_s[i], state.speed_rad_s);
                let outer_nm = self.disturbance_nm[i] * disturbance[i][1] - self.added_nm[i];
                let load = axis_model.friction_nm(state.speed_rad_s, sign[i]) + outer_nm;
                axis_model.accelerate(torque_nm[i] - load, state);
                disturbance[i] = turned(disturbance[i], self.disturbance_turn[i]);
            }
        }
        torque_nm
    }

    /// Position loop and mechanics of one servo period, of axes that are not ideal.
    fn turn_nonideal(&mut self, command_mm: [f64; N]) -> [f64; N] {
        let mut disturbance = self.disturbance_at_start();
        let mut disturbance_turn = self.disturbance_turn;
        let (mut torque_nm, counter) = ([0.0; N], self.counter());
        let t_s = self.period as f64 * self.periods.servo_s;
        let Some(nonideal) = &mut self.nonideal else {
            return torque_nm;
        };
        for (i, axis) in nonideal.iter_mut().enumerate() {
            let axis_model = &self.axis_models[i];
            let command_rad = command_mm[i] * axis_model.parameters.rad_per_mm;
            axis.position_loop(
                axis_model,
                command_rad,
                &mut self.states[i],
                self.period,
                counter,
            );
            if let Some(wander) = &mut axis.wander {
                [disturbance[i], disturbance_turn[i]] = wander.servo_period(self.period, t_s);
            }
        }
        for substep in 0..self.periods.mechanics_per_servo {
            let moment = Moment {
                substep,
                counter: counter + u64::from(substep),
            };
            for (i, axis) in nonideal.iter_mut().enumerate() {
                let load_nm = self.disturbance_nm[i] * disturbance[i][1] - self.added_nm[i];
                torque_nm[i] =
                    axis.advance(&self.axis_models[i], &mut self.states[i], moment, load_nm);
                disturbance[i] = turned(disturbance[i], disturbance_turn[i]);
            }
        }
        torque_nm
    }

    /// The PD position loop of ideal axes: reference speed of the motor, rad/s, held for the servo
    /// period.
    fn position_loop(&mut self, command_mm: [f64; N]) -> [f64; N] {
        std::array::from_fn(|i| {
            let axis_model = &self.axis_models[i];
            let error_rad =
                command_mm[i] * axis_model.parameters.rad_per_mm - self.states[i].angle_rad;
            axis_model.position_loop(error_rad, &mut self.states[i])
        })
    }

    /// cos and sin of the disturbance's phase at the start of the servo period: exact there, turned
    /// from substep to substep within it.
    fn disturbance_at_start(&self) -> [[f64; 2]; N] {
        let t_s = self.period as f64 * self.periods.servo_s;
        self.disturbance_rad_s.map(|w| cos_sin(w * t_s))
    }
}

/// cos and sin of an angle.
fn cos_sin(angle_rad: f64) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle_rad);
    [cos, sin]
}

/// cos and sin of the sum of two angles.
#[inline]
fn turned([cos, sin]: [f64; 2], [by_cos, by_sin]: [f64; 2]) -> [f64; 2] {
    [cos * by_cos - sin * by_sin, sin * by_cos + cos * by_sin]
}
