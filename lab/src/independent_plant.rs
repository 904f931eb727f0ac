//! An independent plant: a machine of other equations than the one that feedwright simulates and
//! assumes.
//!
//! Identification and controllers assume the model of `crates/control/src/axis.rs`, and
//! [`feedwright_sim::Plant`] uses the same model. This plant scores them on a machine that they
//! were not written for. It shares nothing with that model or plant, and nothing is ever tuned on
//! it.
//!
//! | File | What | Unlike the simulated machine |
//! |---|---|---|
//! | `independent_plant/lugre.rs` | LuGre friction at motor and table | bristles with damping; levels by direction and weight |
//! | `independent_plant/ball_screw.rs` | screw between motor and table | hardens; flanks come to bear smoothly |
//! | `independent_plant/mechanics.rs` | winding, motor, table; trapezoidal rule | current, back electromotive force, mass by position |
//! | `independent_plant/position_sensor.rs` | encoder or scale | phase by homing; late by drive periods |
//! | `independent_plant/cascade.rs` | the drive | position, speed and current loop sampled each for itself; delay of the bus |
//! | `independent_plant/linearization.rs` | gains and delays for small motions | |
//! | `independent_plant/machines.rs` | three machines, and others drawn around them | |
//!
//! The tool is at the table plus the lead error of the screw, A (sin(2 pi x / lead + p) - sin p),
//! which no encoder sees. The joint position is the sensor position of the position loop, without
//! steps and errors of the encoder.

pub mod lugre;
pub mod ball_screw;
pub mod mechanics;
pub mod position_sensor;
pub mod cascade;
pub mod linearization;
pub mod machines;

use std::f64::consts::TAU;

use feedwright_sim::{Measurement, Mechanism};
use serde::Serialize;

use cascade::{CascadeState, DriveCascade, DriveInput};
use mechanics::{FeedAxis, FeedState};
use position_sensor::{Late, PositionSensor};

/// Integration steps in a period of the current loop.
const STEPS: u32 = 2;

/// An axis with its drive and its encoders.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct IndependentAxis {
    /// Motor, screw and table.
    pub feed: FeedAxis,
    /// The drive.
    pub cascade: DriveCascade,
    /// Encoder at the motor, in mm of travel.
    pub encoder: PositionSensor,
    /// Scale on the table that the position loop uses; none is the motor's encoder.
    pub scale: Option<PositionSensor>,
    /// Lead error of the screw: amplitude, mm, and phase, rad.
    pub lead_error: [f64; 2],
}

/// An axis under way.
#[derive(Debug, Clone)]
struct RunningAxis {
    axis: IndependentAxis,
    state: FeedState,
    drive: CascadeState,
    /// Sensor positions on their way to the drive, mm: of the position loop, and of the motor.
    sensors: [Late<f64>; 2],
    seen_mm: [f64; 2],
    command_mm: f64,
    /// Lead of the table over the encoder at rest at the start, mm: the table was zeroed there.
    table_zero_mm: f64,
}

/// A machine of these axes.
#[derive(Debug, Clone)]
pub struct IndependentPlant {
    axes: [RunningAxis; 3],
}

impl IndependentPlant {
    /// Starts at rest with the encoders at `start_mm`.
    pub fn new(axes: &[IndependentAxis; 3], start_mm: [f64; 3]) -> Self {
        Self {
            axes: std::array::from_fn(|i| RunningAxis::new(axes[i], start_mm[i])),
        }
    }

    /// State of an axis.
    pub fn state(&self, axis: usize) -> &FeedState {
        &self.axes[axis].state
    }
}

impl Mechanism for IndependentPlant {
    fn step(&mut self, command_mm: [f64; 3]) -> Measurement<3> {
        let axes = self.axes.iter_mut().zip(command_mm);
        axes.for_each(|(axis, command_mm)| axis.servo_period(command_mm));
        let each = |value: fn(&RunningAxis) -> f64| [0, 1, 2].map(|i| value(&self.axes[i]));
        Measurement {
            position_mm: each(RunningAxis::tool_mm),
            joint_mm: each(|axis| axis.axis.places_mm(&axis.state)[0]),
            measured_mm: each(|axis| axis.seen_mm[0]),
            torque_nm: each(|axis| axis.axis.feed.motor.torque_nm(&axis.state)),
        }
    }

    /// Friction creeps and integrals go on in a rest: it is simulated as a whole.
    fn skip(&mut self, periods: u64) {
        for axis in &mut self.axes {
            (0..periods).for_each(|_| axis.servo_period(axis.command_mm));
        }
    }

    fn has_geometry(&self) -> bool {
        true
    }
}

impl IndependentAxis {
    /// Turn of the motor for a travel, rad/mm.
    fn rad_per_mm(&self) -> f64 {
        1e-3 / self.feed.screw.travel_m_rad
    }

    /// Sensors of the position loop, and of the speed loop.
    fn sensors(&self) -> [PositionSensor; 2] {
        [self.scale.unwrap_or(self.encoder), self.encoder]
    }

    /// Returns the positions of the two sensors, mm.
    fn places_mm(&self, state: &FeedState) -> [f64; 2] {
        let motor_mm = state.motor_rad / self.rad_per_mm();
        [
            self.scale.map_or(motor_mm, |_| 1e3 * state.table_m),
            motor_mm,
        ]
    }

    /// Returns the readings of the two sensors, mm.
    fn shown_mm(&self, state: &FeedState) -> [f64; 2] {
        let (sensors, places_mm) = (self.sensors(), self.places_mm(state));
        [0, 1].map(|i| sensors[i].shown_mm(places_mm[i]))
    }
}

impl RunningAxis {
    fn new(axis: IndependentAxis, start_mm: f64) -> Self {
        let state = axis.feed.at_rest(1e-3 * start_mm, axis.scale.is_some());
        let (sensors, seen_mm) = (axis.sensors(), axis.shown_mm(&state));
        let [command_rad, motor_rad] = [start_mm, seen_mm[1]].map(|mm| mm * axis.rad_per_mm());
        let (cascade, motor) = (&axis.cascade, &axis.feed.motor);
        Self {
            axis,
            state,
            drive: CascadeState::at_rest(cascade, command_rad, motor_rad, state.current_a, motor),
            sensors: [0, 1].map(|i| Late::new(sensors[i].late_periods, seen_mm[i])),
            seen_mm,
            command_mm: start_mm,
            table_zero_mm: 1e3 * state.table_m - start_mm,
        }
    }

    fn tool_mm(&self) -> f64 {
        let at_mm = 1e3 * self.state.table_m - self.table_zero_mm;
        let [error_mm, phase_rad] = self.axis.lead_error;
        let lead_mm = TAU / self.axis.rad_per_mm();
        at_mm + error_mm * (libm::sin(TAU * at_mm / lead_mm + phase_rad) - libm::sin(phase_rad))
    }

    fn servo_period(&mut self, command_mm: f64) {
        let IndependentAxis { feed, cascade, .. } = self.axis;
        let [current_periods, drive_periods] = cascade.periods;
        let rad_per_mm = self.axis.rad_per_mm();
        let from_mm = std::mem::replace(&mut self.command_mm, command_mm);
        let speed_rad_s = (command_mm - from_mm) / cascade.servo_s() * rad_per_mm;
        for period in 1..=drive_periods {
            let line = || f64::from(period) / f64::from(drive_periods);
            let part = if cascade.interpolates { line() } else { 1.0 };
            let line_rad = (from_mm + part * (command_mm - from_mm)) * rad_per_mm;
            let input = DriveInput {
                command: [line_rad, speed_rad_s],
                seen_rad: self.seen_mm.map(|mm| mm * rad_per_mm),
            };
            self.drive.drive_period(&cascade, input);
            let step_s = cascade.current_s / f64::from(STEPS);
            for _ in 0..current_periods {
                let current_a = self.state.current_a;
                let volts = self.drive.volts(&cascade, &feed.motor, current_a);
                (0..STEPS).for_each(|_| self.state = feed.step(&self.state, volts, step_s));
            }
            let shown_mm = self.axis.shown_mm(&self.state);
            self.seen_mm = [0, 1].map(|i| self.sensors[i].pass(shown_mm[i]));
        }
    }
}
