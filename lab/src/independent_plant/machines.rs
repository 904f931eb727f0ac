//! Three machines of the independent plant, and others drawn around them.
//!
//! | Machine | What |
//! |---|---|
//! | `bench-router` | light gantry on thin screws: backlash, slow loops, coarse encoders, commands held at the servo period |
//! | `knee-mill` | retrofitted mill on dovetail ways: heavy, much friction that sticks, some backlash |
//! | `machining-center` | preloaded screws, scales on the tables, fast loops behind a bus with interpolation |
//!
//! Sizes are those of such machines in data sheets of motors, screws and guideways; no number was
//! chosen by a result. A drawn machine is one of the three with every number drawn within [`DRAWN`]
//! of it or of each other.

use std::f64::consts::TAU;

use feedwright_sim::{Axis, Limits, Machine, MachineError, Period};
use serde::Serialize;

use super::IndependentAxis;
use super::ball_screw::BallScrew;
use super::cascade::DriveCascade;
use super::lugre::LuGre;
use super::mechanics::{FeedAxis, GuidedTable, WoundMotor};
use super::position_sensor::PositionSensor;
use crate::held_out::random::Random;

/// Names of the machines.
pub const INDEPENDENT_MACHINES: [&str; 3] = ["bench-router", "knee-mill", "machining-center"];

/// Factors by which numbers of a drawn machine differ from those of the machine that it is drawn
/// around: masses and stiffness, loop settings, friction and backlash.
pub const DRAWN: [[f64; 2]; 3] = [[0.7, 1.4], [0.75, 1.3], [0.5, 1.8]];

/// Period of all current loops: 16 kHz.
const CURRENT_S: f64 = 1.0 / 16_000.0;
/// Gravity, m/s2.
const GRAVITY_M_S2: f64 = 9.81;
/// Bending of a screw at which its hardening makes it stiffer by three tenths, m.
const HARDENED_M: f64 = 50e-6;

/// A machine of the independent plant.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IndependentMachine {
    /// Name.
    pub name: String,
    /// The built-in machine whose PLC and shape of the limits its data sheet has.
    kind: &'static str,
    /// Rapid and highest feed, mm/s, acceleration, mm/s2, and jerk, mm/s3, of its control.
    limits: [f64; 4],
    /// Its axes.
    pub axes: [IndependentAxis; 3],
}

/// Axis data from a data sheet and a drive's parameter list, and data that no document states.
#[derive(Debug, Clone, Copy)]
struct AxisSpec {
    lead_mm: f64,
    /// Inertia of rotor, coupling and screw, kg m2.
    rotor_kg_m2: f64,
    mass_kg: f64,
    /// Part of the mass that depends on the position, and travel for a radian of it, m.
    swing: [f64; 2],
    /// Resonance of the table on the screw, motor held, Hz, and its damping ratio.
    resonance: [f64; 2],
    backlash_um: f64,
    /// Coulomb friction of the motor, N m, and of the guideway's seals and preload, N.
    coulomb: [f64; 2],
    /// Friction for a weight of 1 N on the guideway.
    by_weight: f64,
    /// Break-away over Coulomb level, Stribeck speed, mm/s, bending of the bristles, um.
    stiction: [f64; 3],
    asymmetry: f64,
    /// Viscous friction of motor, N m s/rad, and table, N s/m.
    viscous: [f64; 2],
    load_n: f64,
    /// Resistance, ohm; inductance, H; torque constant, N m/A.
    winding: [f64; 3],
    /// Ripple, a part, and cogging, N m, and their periods in a turn.
    ripple: [f64; 2],
    cogging: [f64; 2],
    /// Voltage, V, and current, A.
    most: [f64; 2],
    kp_1_s: f64,
    /// Kv / J, 1/s.
    speed_loop_1_s: f64,
    integral_s: f64,
    feedforward: f64,
    speed_filter_s: f64,
    /// Periods of the current loop in one of the drive; periods of the drive in a servo period;
    /// drive periods by which a command is late.
    periods: [u32; 3],
    interpolates: bool,
    /// Step, signal period and error of the motor's encoder, um, and of the scale, where there is
    /// one.
    encoder_um: [f64; 3],
    scale_um: Option<[f64; 3]>,
    late_periods: u32,
    lead_error_um: f64,
}

const ROUTER: AxisSpec = AxisSpec {
    lead_mm: 8.0,
    rotor_kg_m2: 7e-5,
    mass_kg: 12.0,
    swing: [0.06, 0.15],
    resonance: [50.0, 0.05],
    backlash_um: 30.0,
    coulomb: [0.015, 12.0],
    by_weight: 0.12,
    stiction: [1.5, 3.0, 8.0],
    asymmetry: 0.08,
    viscous: [2e-4, 100.0],
    load_n: 0.0,
    winding: [0.45, 1.2e-3, 0.09],
    ripple: [0.03, 24.0],
    cogging: [0.012, 48.0],
    most: [48.0, 12.0],
    kp_1_s: 25.0,
    speed_loop_1_s: 120.0,
    integral_s: 0.04,
    feedforward: 0.9,
    speed_filter_s: 1e-3,
    periods: [8, 2, 2],
    interpolates: false,
    encoder_um: [2.0, 8.0, 0.3],
    scale_um: None,
    late_periods: 0,
    lead_error_um: 15.0,
};

const KNEE_MILL: AxisSpec = AxisSpec {
    lead_mm: 5.0,
    rotor_kg_m2: 6e-4,
    mass_kg: 220.0,
    swing: [0.03, 0.25],
    resonance: [75.0, 0.06],
    backlash_um: 8.0,
    coulomb: [0.12, 90.0],
    by_weight: 0.09,
    stiction: [1.7, 1.5, 5.0],
    asymmetry: 0.06,
    viscous: [1e-3, 2500.0],
    load_n: 0.0,
    winding: [0.9, 4e-3, 0.55],
    ripple: [0.02, 18.0],
    cogging: [0.05, 36.0],
    most: [160.0, 18.0],
    kp_1_s: 40.0,
    speed_loop_1_s: 180.0,
    integral_s: 0.025,
    feedforward: 0.95,
    speed_filter_s: 0.5e-3,
    periods: [4, 4, 4],
    interpolates: false,
    encoder_um: [0.5, 20.0, 0.2],
    scale_um: None,
    late_periods: 0,
    lead_error_um: 8.0,
};

const MACHINING_CENTER: AxisSpec = AxisSpec {
    lead_mm: 16.0,
    rotor_kg_m2: 6.5e-3,
    mass_kg: 420.0,
    swing: [0.04, 0.3],
    resonance: [110.0, 0.04],
    backlash_um: 0.0,
    coulomb: [0.6, 120.0],
    by_weight: 0.01,
    stiction: [1.25, 4.0, 12.0],
    asymmetry: 0.04,
    viscous: [4e-3, 600.0],
    load_n: 0.0,
    winding: [0.35, 4.5e-3, 1.3],
    ripple: [0.012, 18.0],
    cogging: [0.25, 36.0],
    most: [560.0, 50.0],
    kp_1_s: 60.0,
    speed_loop_1_s: 300.0,
    integral_s: 0.012,
    feedforward: 1.0,
    speed_filter_s: 0.0,
    periods: [2, 8, 8],
    interpolates: true,
    encoder_um: [0.02, 8.0, 0.02],
    scale_um: Some([0.02, 20.0, 0.08]),
    late_periods: 1,
    lead_error_um: 1.5,
};

impl IndependentMachine {
    /// One of [`INDEPENDENT_MACHINES`] by its name.
    pub fn named(name: &str) -> Option<Self> {
        let number = INDEPENDENT_MACHINES
            .iter()
            .position(|known| *known == name)?;
        Some(Self::made(
            name.to_owned(),
            number,
            &mut Random::new(number as u64 + 1),
            false,
        ))
    }

    /// One drawn around them by a seed: the same on every platform.
    pub fn drawn(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let number = random.whole(0, 2) as usize;
        let name = format!("{}-{seed}", INDEPENDENT_MACHINES[number]);
        Self::made(name, number, &mut random, true)
    }

    /// Draws phases in any case, because the place where an axis was homed is unknown.
    fn made(name: String, number: usize, random: &mut Random, differs: bool) -> Self {
        let (kind, limits, mut specs) = [
            (
                "router",
                [60.0, 50.0, 250.0, 8000.0],
                three(&ROUTER, [0.75, 0.4], 25.0),
            ),
            (
                "workshop",
                [100.0, 60.0, 500.0, 20_000.0],
                three(&KNEE_MILL, [0.6, 1.4], 700.0),
            ),
            (
                "stiff",
                [400.0, 150.0, 2500.0, 60_000.0],
                three(&MACHINING_CENTER, [1.3, 0.9], 1500.0),
            ),
        ][number];
        if differs {
            specs.iter_mut().for_each(|spec| differ(spec, random));
        }
        Self {
            name,
            kind,
            limits,
            axes: specs.map(|spec| axis(&spec, random)),
        }
    }

    /// Returns the knowledge of the machine before anything is recorded: limits of its control,
    /// nominal settings of its drives, data sheets.
    ///
    /// # Errors
    /// None, where the built-in machines are read.
    pub fn sheet(&self) -> Result<Machine, MachineError> {
        let base = Machine::load(self.kind.as_ref())?;
        let [rapid_mm_s, max_feed_mm_s, accel_mm_s2, jerk_mm_s3] = self.limits;
        let servo_s = self.axes[0].cascade.servo_s();
        let axis = |axis: &IndependentAxis| {
            let IndependentAxis { feed, cascade, .. } = axis;
            Axis {
                lead_mm_per_rev: 1e3 * TAU * feed.screw.travel_m_rad,
                inertia_kg_m2: feed.inertia_kg_m2(),
                viscous_friction_nm_s: 1e-4,
                coulomb_friction_nm: 0.05,
                coulomb_smoothing_rad_s: 0.05,
                kp_1_s: cascade.kp_1_s,
                kv_nm_s_per_rad: cascade.speed_gain_a_s * feed.motor.torque_nm_a,
                torque_limit_nm: feed.motor.torque_nm_a * cascade.limits[1],
                speed_integral_s: cascade.speed_integral_s,
                velocity_feedforward: cascade.velocity_feedforward,
                max_velocity_mm_s: Some(rapid_mm_s),
                max_accel_mm_s2: Some(1.2 * accel_mm_s2),
                max_jerk_mm_s3: Some(jerk_mm_s3),
                ..Axis::default()
            }
        };
        Ok(Machine {
            name: self.name.clone(),
            description: format!("data sheet of {}", self.name),
            source: "lab/src/independent_plant/machines.rs".to_owned(),
            period: Period {
                servo_s,
                mechanics_s: 0.1 * servo_s,
                mechanics_per_servo: 10,
            },
            limits: Limits {
                rapid_mm_s,
                max_feed_mm_s,
                tangential_accel_mm_s2: accel_mm_s2,
                normal_accel_mm_s2: accel_mm_s2,
                ..base.limits
            },
            axes: self.axes.iter().map(axis).collect(),
            plc: base.plc,
            plc_events: base.plc_events,
            geometry: Default::default(),
            noise: Default::default(),
            compensated: None,
            tool: None,
        })
    }
}

/// The axes of a machine: y and z have so much of the mass of x, and z carries a load.
fn three(x: &AxisSpec, mass: [f64; 2], load_n: f64) -> [AxisSpec; 3] {
    let other = |part: f64| AxisSpec {
        mass_kg: part * x.mass_kg,
        asymmetry: -x.asymmetry,
        ..*x
    };
    [
        *x,
        other(mass[0]),
        AxisSpec {
            load_n,
            ..other(mass[1])
        },
    ]
}

/// Draws every number that differs from machine to machine.
fn differ(spec: &mut AxisSpec, random: &mut Random) {
    let [solid, set, rough] = DRAWN;
    let mut by = |values: &mut [&mut f64], range| {
        values
            .iter_mut()
            .for_each(|value| **value *= random.by_ratio(range));
    };
    let AxisSpec {
        resonance,
        coulomb,
        stiction,
        ripple,
        cogging,
        viscous,
        ..
    } = spec;
    by(
        &mut [&mut resonance[0], &mut spec.rotor_kg_m2, &mut spec.mass_kg],
        solid,
    );
    by(
        &mut [
            &mut spec.kp_1_s,
            &mut spec.speed_loop_1_s,
            &mut spec.integral_s,
        ],
        set,
    );
    let [motor, table] = coulomb;
    by(
        &mut [
            motor,
            table,
            &mut spec.by_weight,
            &mut spec.backlash_um,
            &mut spec.lead_error_um,
        ],
        rough,
    );
    let [_, stribeck, bending] = stiction;
    by(
        &mut [stribeck, bending, &mut ripple[0], &mut cogging[0]],
        rough,
    );
    let [motor, table] = viscous;
    by(
        &mut [motor, table, &mut resonance[1], &mut spec.swing[0]],
        rough,
    );
    by(
        &mut [
            &mut spec.encoder_um[2],
            &mut spec.asymmetry,
            &mut spec.load_n,
        ],
        rough,
    );
    spec.feedforward = (spec.feedforward * random.between([0.9, 1.05])).min(1.0);
    spec.periods[2] = random.whole(1, 2 * spec.periods[2]);
    if random.one_in(2) {
        spec.asymmetry = -spec.asymmetry;
    }
}

/// The axis of a specification, homed somewhere.
fn axis(spec: &AxisSpec, random: &mut Random) -> IndependentAxis {
    let mut phase = || random.between([0.0, TAU]);
    let travel_m_rad = 1e-3 * spec.lead_mm / TAU;
    let inertia = spec.rotor_kg_m2 + spec.mass_kg * travel_m_rad * travel_m_rad;
    let [resistance_ohm, inductance_h, torque_nm_a] = spec.winding;
    let [stiction, stribeck_mm_s, bending_um] = spec.stiction;
    let [motor_nm, guide_n] = spec.coulomb;
    let guide_n = guide_n + spec.by_weight * spec.mass_kg * GRAVITY_M_S2;
    let friction = |coulomb: f64, per: f64, viscous: f64, mass: f64| {
        let bristles = LuGre::new(
            coulomb,
            stiction,
            1e-3 * stribeck_mm_s * per,
            1e-6 * bending_um * per,
            mass,
        );
        LuGre {
            viscous,
            asymmetry: spec.asymmetry,
            ..bristles
        }
    };
    let angular = TAU * spec.resonance[0];
    let stiffness_n_m = spec.mass_kg * angular * angular;
    let feed = FeedAxis {
        motor: WoundMotor {
            resistance_ohm,
            inductance_h,
            torque_nm_a,
            ripple: [spec.ripple[0], spec.ripple[1], phase()],
            cogging: [spec.cogging[0], spec.cogging[1], phase()],
            inertia_kg_m2: spec.rotor_kg_m2,
            friction: friction(
                motor_nm,
                1.0 / travel_m_rad,
                spec.viscous[0],
                spec.rotor_kg_m2,
            ),
        },
        screw: BallScrew {
            travel_m_rad,
            stiffness_n_m,
            hardening_n_m3: 0.1 * stiffness_n_m / (HARDENED_M * HARDENED_M),
            damping_n_s_m: 2.0 * spec.resonance[1] * spec.mass_kg * angular,
            backlash_m: 1e-6 * spec.backlash_um,
            edge_m: 1e-6,
        },
        table: GuidedTable {
            mass_kg: spec.mass_kg,
            mass_swing: [spec.swing[0], spec.swing[1], phase()],
            load_n: spec.load_n,
            friction: friction(guide_n, 1.0, spec.viscous[1], spec.mass_kg),
        },
    };
    let mut sensor = |[step_um, period_um, error_um]: [f64; 3]| PositionSensor {
        step_mm: 1e-3 * step_um,
        period_mm: 1e-3 * period_um,
        error_mm: 1e-3 * error_um,
        phase_rad: phase(),
        late_periods: spec.late_periods,
    };
    let (encoder, scale) = (sensor(spec.encoder_um), spec.scale_um.map(&mut sensor));
    let cascade = cascade(spec, inertia);
    IndependentAxis {
        feed,
        cascade,
        encoder,
        scale,
        lead_error: [1e-3 * spec.lead_error_um, phase()],
    }
}

/// The drive of a specification, set to the inertia.
fn cascade(spec: &AxisSpec, inertia_kg_m2: f64) -> DriveCascade {
    let [current_periods, drive_periods, bus_periods] = spec.periods;
    DriveCascade {
        current_s: CURRENT_S,
        periods: [current_periods, drive_periods],
        // Controls of drives are delivered with some 500 Hz to 1 kHz.
        current_rad_s: TAU * 700.0,
        limits: spec.most,
        speed_gain_a_s: spec.speed_loop_1_s * inertia_kg_m2 / spec.winding[2],
        speed_integral_s: spec.integral_s,
        speed_filter_s: spec.speed_filter_s,
        kp_1_s: spec.kp_1_s,
        velocity_feedforward: spec.feedforward,
        bus_periods,
        interpolates: spec.interpolates,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn machines_are_the_same_again_differ_from_each_other_and_have_data_sheets_that_read_back() {
        let named = INDEPENDENT_MACHINES.map(|name| IndependentMachine::named(name).unwrap());
        let all: Vec<IndependentMachine> = named
            .into_iter()
            .chain((0..20).map(IndependentMachine::drawn))
            .collect();
        for (i, machine) in all.iter().enumerate() {
            assert!(
                all[..i]
                    .iter()
                    .all(|other| other.axes != machine.axes && other.name != machine.name)
            );
            let sheet = machine.sheet().unwrap();
            assert_eq!(Machine::parse("sheet.toml", &sheet.text()).unwrap(), sheet);
        }
        assert_eq!(IndependentMachine::drawn(7), IndependentMachine::drawn(7));
        assert!(IndependentMachine::named("lathe").is_none());
    }
}
