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
use serde::{Deserialize, Serialize};

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
    kind: String,
    /// Rapid and highest feed, mm/s, acceleration, mm/s2, and jerk, mm/s3, of its control.
    limits: [f64; 4],
    /// Its axes.
    pub axes: [IndependentAxis; 3],
}

/// Axis data from a data sheet and a drive's parameter list, and data that no document states.
#[derive(Debug, Clone, Copy, Deserialize)]
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

/// A machine around which others are drawn.
#[derive(Deserialize)]
struct MachineSpec {
    name: String,
    kind: String,
    limits: [f64; 4],
    /// Parts of the mass of x that y and z have.
    mass: [f64; 2],
    /// Load of z, N.
    load_n: f64,
    x: AxisSpec,
}

impl MachineSpec {
    fn all() -> Vec<Self> {
        serde_json::from_str(include_str!("machines.json")).expect("a test reads it")
    }

    /// The axes: y and z have so much of the mass of x, and z carries a load.
    fn axes(&self) -> [AxisSpec; 3] {
        let [y, z] = self.mass.map(|part| AxisSpec {
            mass_kg: part * self.x.mass_kg,
            asymmetry: -self.x.asymmetry,
            ..self.x
        });
        let load_n = self.load_n;
        [self.x, y, AxisSpec { load_n, ..z }]
    }
}

impl IndependentMachine {
    /// One of [`INDEPENDENT_MACHINES`] by its name.
    pub fn named(name: &str) -> Option<Self> {
        let number = INDEPENDENT_MACHINES
            .iter()
            .position(|known| *known == name)?;
        let mut random = Random::new(number as u64 + 1);
        Some(Self::made(number, "", &mut random, false))
    }

    /// One drawn around them by a seed: the same on every platform.
    pub fn drawn(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let number = random.whole(0, 2) as usize;
        Self::made(number, &format!("-{seed}"), &mut random, true)
    }

    /// Draws phases in any case, because the place where an axis was homed is unknown.
    fn made(number: usize, suffix: &str, random: &mut Random, differs: bool) -> Self {
        let spec = MachineSpec::all().swap_remove(number);
        let mut axes = spec.axes();
        if differs {
            axes.iter_mut().for_each(|spec| differ(spec, random));
        }
        Self {
            name: spec.name + suffix,
            kind: spec.kind,
            limits: spec.limits,
            axes: axes.map(|spec| axis(&spec, random)),
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

/// Draws every number that differs from machine to machine.
fn differ(it: &mut AxisSpec, random: &mut Random) {
    let [solid, set, rough] = DRAWN;
    let mut by = |value: &mut f64, range| *value *= random.by_ratio(range);
    by(&mut it.resonance[0], solid);
    by(&mut it.rotor_kg_m2, solid);
    by(&mut it.mass_kg, solid);
    by(&mut it.kp_1_s, set);
    by(&mut it.speed_loop_1_s, set);
    by(&mut it.integral_s, set);
    it.coulomb.iter_mut().for_each(|value| by(value, rough));
    by(&mut it.by_weight, rough);
    by(&mut it.backlash_um, rough);
    by(&mut it.lead_error_um, rough);
    it.stiction[1..]
        .iter_mut()
        .for_each(|value| by(value, rough));
    by(&mut it.ripple[0], rough);
    by(&mut it.cogging[0], rough);
    it.viscous.iter_mut().for_each(|value| by(value, rough));
    by(&mut it.resonance[1], rough);
    by(&mut it.swing[0], rough);
    by(&mut it.encoder_um[2], rough);
    by(&mut it.asymmetry, rough);
    by(&mut it.load_n, rough);
    it.feedforward = (it.feedforward * random.between([0.9, 1.05])).min(1.0);
    it.periods[2] = random.whole(1, 2 * it.periods[2]);
    if random.one_in(2) {
        it.asymmetry = -it.asymmetry;
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
        let (stribeck, bending) = (1e-3 * stribeck_mm_s * per, 1e-6 * bending_um * per);
        let bristles = LuGre::new(coulomb, stiction, stribeck, bending, mass);
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
        assert!(
            MachineSpec::all()
                .iter()
                .map(|spec| &spec.name[..])
                .eq(INDEPENDENT_MACHINES)
        );
        let named = INDEPENDENT_MACHINES.map(|name| IndependentMachine::named(name).unwrap());
        let mut all = named.to_vec();
        all.extend((0..20).map(IndependentMachine::drawn));
        for (i, machine) in all.iter().enumerate() {
            let is_other =
                |it: &IndependentMachine| it.axes != machine.axes && it.name != machine.name;
            assert!(all[..i].iter().all(is_other));
            let sheet = machine.sheet().unwrap();
            assert_eq!(Machine::parse("sheet.toml", &sheet.text()).unwrap(), sheet);
        }
        assert_eq!(IndependentMachine::drawn(7), IndependentMachine::drawn(7));
        assert!(IndependentMachine::named("lathe").is_none());
    }
}
