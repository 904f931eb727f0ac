//! Machines drawn at random: `tnv40` with other loops, accelerations, masses, friction, encoders
//! and delays.
//!
//! Each axis has a position loop of gain Kp around a speed loop of bandwidth a = (Kv + Bv) / J. The
//! dead time T of the loop is the drive delay plus one and a half servo periods:
//!
//! ```text
//! L(s) = Kp e^(-s T) / (s (1 + s / a))      T = delay + 3/2 Ts
//! phase margin = 90 deg - atan(w / a) - w T  at the w with |L| = 1
//! ```
//!
//! A machine with an axis below [`PHASE_MARGIN_DEG`] is drawn again, because no machine is
//! delivered that way. The performance of a controller on the machine plays no part. Each torque
//! limit is the torque that the plan needs, times a random factor from 1.5 to 4.
//!
//! Realistic machines add further effects (`machines/realistic.rs`). The formula above leaves out
//! the integral of a speed loop and a ball screw. If a machine has one of them, its response to an
//! impulse is simulated too, and has to decay.

mod realistic;

use std::f64::consts::{PI, TAU};

use feedwright_sim::{Axis, Machine, Plant, rounded};

use super::random::Random;
use super::variant::{AXES, Variant};

/// Base of all machines.
const BASE: &str = "tnv40";
/// Least phase margin of a position loop, degrees: textbooks ask for 30 to 60.
pub const PHASE_MARGIN_DEG: f64 = 40.0;
/// Time within which the response to an impulse has to decay, s, and the part that may remain: a
/// screw of 40 Hz with a damping ratio of 0.02 does so by itself.
const QUIET_S: f64 = 0.5;
const QUIET: f64 = 0.1;
/// Range of the position loops' gain, 1/s.
const KP_1_S: [f64; 2] = [25.0, 150.0];
/// Range of the speed loops' bandwidth, in gains of the position loop: cascades are tuned with 2
/// to 6.
const SPEED_LOOP: [f64; 2] = [2.0, 6.0];
/// Range of accelerations along and across the path, mm/s2.
const ACCEL_MM_S2: [f64; 2] = [100.0, 4000.0];
/// Range of factors on inertia and friction.
const FACTOR: [f64; 2] = [0.5, 2.0];
/// x and y differ by up to this factor in gain and inertia.
const UNLIKE: f64 = 1.5;
/// Largest encoder step, um, and drive delay, s; one machine in three has none.
const ENCODER_UM: [f64; 2] = [0.05, 1.0];
const DELAY_S: f64 = 0.002;
/// Range of the disturbance, N m, and of its frequency, Hz.
const DISTURBANCE_NM: [f64; 2] = [0.02, 0.5];
const DISTURBANCE_HZ: [f64; 2] = [5.0, 120.0];
/// Range of torque limits, in what the plan needs.
const TORQUE: [f64; 2] = [1.5, 4.0];

/// Class of machines to draw.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Class {
    /// All of them.
    Any,
    /// Machines without encoder steps and without delay.
    Rigid,
    /// Machines as in `Any`, plus the effects of real axes: ball screw, friction, motor, drive,
    /// noise, servo period.
    Realistic,
}

/// The machine of a seed; the same on every platform.
pub fn machine(seed: u64, class: Class) -> Variant {
    let mut random = Random::new(seed);
    loop {
        let mut variant = draw(&mut random, seed, class);
        if class == Class::Realistic {
            let Ok(machine) = variant.machine() else {
                continue;
            };
            variant = realistic::with_imperfections(variant, &machine.axes, &mut random);
        }
        if variant.machine().is_ok_and(|machine| is_stable(&machine)) {
            return variant;
        }
    }
}

fn draw(random: &mut Random, seed: u64, class: Class) -> Variant {
    let base = Machine::load(BASE.as_ref()).expect("the base is built in");
    let mut variant = Variant::of(BASE, format!("random-{seed}"));
    let [along, across] = [random.by_ratio(ACCEL_MM_S2), random.by_ratio(ACCEL_MM_S2)];
    variant = variant
        .with("limits", "tangential_accel_mm_s2", along)
        .with("limits", "normal_accel_mm_s2", across);
    let (kp_1_s, speed_loop) = (random.by_ratio(KP_1_S), random.by_ratio(SPEED_LOOP));
    // One machine in two has equal axes, as it should.
    let unlike = random.one_in(2);
    let other = |random: &mut Random| match unlike {
        true => random.by_ratio([1.0 / UNLIKE, UNLIKE]),
        false => 1.0,
    };
    let inertia = random.by_ratio(FACTOR);
    let friction = [random.by_ratio(FACTOR), random.by_ratio(FACTOR)];
    let disturbance = [DISTURBANCE_NM, DISTURBANCE_HZ].map(|range| random.by_ratio(range));
    let torque = random.by_ratio(TORQUE);
    for (i, table) in AXES.into_iter().enumerate() {
        let mut axis = *base.axis(i);
        axis.kp_1_s = rounded((kp_1_s * other(random)).clamp(KP_1_S[0], KP_1_S[1]), 3);
        axis.inertia_kg_m2 = rounded(axis.inertia_kg_m2 * inertia * other(random), 3);
        axis.kv_nm_s_per_rad = rounded(speed_loop * kp_1_s * axis.inertia_kg_m2, 3);
        axis.viscous_friction_nm_s = rounded(axis.viscous_friction_nm_s * friction[0], 3);
        axis.coulomb_friction_nm = rounded(axis.coulomb_friction_nm * friction[1], 3);
        [axis.disturbance_nm, axis.disturbance_hz] = disturbance;
        let needed_nm = torque_of_plan_nm(&axis, &base, libm::hypot(along, across));
        for (key, value) in [
            ("kp_1_s", axis.kp_1_s),
            ("inertia_kg_m2", axis.inertia_kg_m2),
            ("kv_nm_s_per_rad", axis.kv_nm_s_per_rad),
            ("viscous_friction_nm_s", axis.viscous_friction_nm_s),
            ("coulomb_friction_nm", axis.coulomb_friction_nm),
            ("disturbance_nm", axis.disturbance_nm),
            ("disturbance_hz", axis.disturbance_hz),
            ("torque_limit_nm", rounded(torque * needed_nm, 3)),
        ] {
            variant = variant.with(table, key, value);
        }
    }
    let step_um = random.by_ratio(ENCODER_UM);
    let late = [step_um, rounded(random.between([0.0, DELAY_S]), 3)];
    let has = [!random.one_in(3), !random.one_in(3)];
    let keys = ["encoder_step_um", "drive_delay_s"];
    let wanted = (0..2).filter(|&i| has[i] && class != Class::Rigid);
    wanted.fold(variant, |variant, i| variant.with_axes(keys[i], late[i]))
}

/// Torque that the plan may ask of an axis: the largest acceleration and the jump at corners that
/// the position loop passes on, against friction and disturbance, N m.
fn torque_of_plan_nm(axis: &Axis, machine: &Machine, accel_mm_s2: f64) -> f64 {
    let rad_per_mm = TAU / axis.lead_mm_per_rev;
    let jump_mm_s2 = machine.limits.corner_jump_mm_s * axis.kp_1_s;
    let friction_nm = axis.coulomb_friction_nm
        + axis.viscous_friction_nm_s * machine.limits.rapid_mm_s * rad_per_mm;
    axis.inertia_kg_m2 * (accel_mm_s2 + jump_mm_s2) * rad_per_mm + friction_nm + axis.disturbance_nm
}

/// Returns true if every position loop has its phase margin, and the effects beyond the formula
/// decay.
pub fn is_stable(machine: &Machine) -> bool {
    let is_simple = |axis: &Axis| axis.transmission.is_none() && axis.speed_integral_s == 0.0;
    let margin_deg = |axis: &Axis| phase_margin_deg(axis, machine.period.servo_s);
    machine
        .axes
        .iter()
        .all(|axis| margin_deg(axis) >= PHASE_MARGIN_DEG)
        && (machine.axes.iter().all(is_simple) || dies_away(machine))
}

/// Returns true if an impulse decays in every axis: after [`QUIET_S`] the table stays within
/// [`QUIET`] of its largest deviation. The axes are simulated without friction, backlash, steps and
/// noise: the remaining axis is linear, and the least damped.
fn dies_away(machine: &Machine) -> bool {
    let mut linear = machine.clone();
    for axis in &mut linear.axes {
        *axis = Axis {
            coulomb_friction_nm: 0.0,
            coulomb_asymmetry_nm: 0.0,
            stribeck_nm: 0.0,
            presliding_um: 0.0,
            disturbance_nm: 0.0,
            encoder_step_um: 0.0,
            encoder_noise_um: 0.0,
            cogging_nm: 0.0,
            ripple: 0.0,
            torque_noise_nm: 0.0,
            jitter_s: 0.0,
            ..*axis
        };
        if let Some(screw) = &mut axis.transmission {
            screw.backlash_um = 0.0;
        }
    }
    let mut plant = Plant::<3>::new(&linear, [0.0; 3]);
    // A hundredth of a turn a second: far below the torque limit.
    plant.push([0, 1, 2].map(|i| 0.01 * TAU * linear.axis(i).inertia_kg_m2));
    let [mut most_mm, mut late_mm] = [[0.0_f64; 3]; 2];
    let periods = (2.0 * QUIET_S / machine.period.servo_s) as u32;
    for n in 0..periods {
        let at_mm = plant.step([0.0; 3]).joint_mm;
        for i in 0..3 {
            most_mm[i] = most_mm[i].max(at_mm[i].abs());
            if 2 * n >= periods {
                late_mm[i] = late_mm[i].max(at_mm[i].abs());
            }
        }
    }
    (0..3).all(|i| late_mm[i] <= QUIET * most_mm[i])
}

/// Phase margin of the position loop, degrees.
fn phase_margin_deg(axis: &Axis, servo_s: f64) -> f64 {
    let speed_1_s = (axis.kv_nm_s_per_rad + axis.viscous_friction_nm_s) / axis.inertia_kg_m2;
    // |L| = 1: w^2 (1 + w^2 / a^2) = Kp^2, solved so that nothing cancels where a is large.
    let ratio = axis.kp_1_s / speed_1_s;
    let w_1_s = axis.kp_1_s * (2.0 / (1.0 + (1.0 + 4.0 * ratio * ratio).sqrt())).sqrt();
    let late_s = axis.drive_delay_s + 1.5 * servo_s;
    90.0 - (libm::atan(w_1_s / speed_1_s) + w_1_s * late_s) * 180.0 / PI
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Seeds that are looked at.
    const SEEDS: u64 = 200;

    #[test]
    fn machines_are_valid_stable_and_the_same_for_the_same_seed() {
        for seed in 0..SEEDS {
            let variant = machine(seed, Class::Any);
            let made = variant.machine().expect("a machine file without faults");
            assert!(is_stable(&made), "{}", variant.text());
            assert_eq!(variant, machine(seed, Class::Any));
            let [least, most] = KP_1_S;
            let is_in_range = |axis: &Axis| (least..=most).contains(&axis.kp_1_s);
            assert!(made.axes.iter().all(is_in_range), "{}", variant.text());
        }
        let [one, two] = [1, 2].map(|seed| machine(seed, Class::Any).changes);
        assert_ne!(one, two);
    }

    #[test]
    fn rigid_ones_have_neither_steps_nor_delay_and_most_others_do() {
        let late = |seed: u64, class| {
            let axis = *machine(seed, class).machine().expect("valid").axis(0);
            axis.encoder_step_um > 0.0 || axis.drive_delay_s > 0.0
        };
        let count = |class| (0..SEEDS).filter(|&seed| late(seed, class)).count();
        assert_eq!(count(Class::Rigid), 0);
        assert!(count(Class::Any) > SEEDS as usize / 2);
    }

    #[test]
    fn realistic_machines_are_valid_stable_and_of_all_kinds() {
        let made = |seed: u64| {
            let variant = machine(seed, Class::Realistic);
            assert_eq!(variant, machine(seed, Class::Realistic));
            let made = variant.machine().expect("a machine file without faults");
            assert!(is_stable(&made), "{}", variant.text());
            made
        };
        let machines: Vec<Machine> = (0..SEEDS).map(made).collect();
        let effects: [fn(&Axis) -> f64; 10] = [
            |axis| axis.transmission.map_or(0.0, |_| 1.0),
            |axis| axis.transmission.map_or(0.0, |screw| screw.backlash_um),
            |axis| axis.speed_integral_s,
            |axis| axis.velocity_feedforward,
            |axis| axis.cogging_nm,
            |axis| axis.stribeck_nm,
            |axis| axis.presliding_um,
            |axis| axis.encoder_step_um,
            |axis| axis.drive_delay_s,
            |axis| axis.encoder_noise_um,
        ];
        let parts = effects.map(|effect| {
            let has = |machine: &&Machine| effect(machine.axis(1)) > 0.0;
            machines.iter().filter(has).count() as f64 / SEEDS as f64
        });
        assert!(
            parts.iter().all(|part| (0.1..0.9).contains(part)),
            "{parts:?}"
        );
        for servo_s in [0.0005, 0.001, 0.002] {
            let has = |machine: &&Machine| machine.period.servo_s == servo_s;
            assert!(machines.iter().filter(has).count() > 20, "{servo_s} s");
        }
    }

    #[test]
    fn a_blow_dies_away_on_built_in_machines_and_not_with_an_integral_that_is_too_fast() {
        for name in ["workshop", "stiff", "router", "soft"] {
            let mut machine = Machine::load(name.as_ref()).expect("built in");
            assert!(is_stable(&machine), "{name}");
            let axis = &mut machine.axes[1];
            (axis.speed_integral_s, axis.torque_filter_hz) = (0.0005, 50.0);
            let what = "with an integral time of 0.5 ms behind a filter of 50 Hz";
            assert!(!is_stable(&machine), "{name} {what}");
        }
    }

    /// A pure integrator has 90 degrees less its delay; a speed loop as fast as its crossover takes
    /// 45 more.
    #[test]
    fn the_phase_margin_agrees_with_the_closed_form() {
        let mut axis = *Machine::load(BASE.as_ref()).expect("built in").axis(0);
        (axis.kp_1_s, axis.inertia_kg_m2, axis.viscous_friction_nm_s) = (50.0, 1e-9, 0.0);
        assert!((phase_margin_deg(&axis, 0.001) - (90.0 - 0.075 * 180.0 / PI)).abs() < 1e-3);
        (axis.kv_nm_s_per_rad, axis.inertia_kg_m2) = (1.0, 0.02);
        axis.kp_1_s = 50.0 * 2.0_f64.sqrt();
        assert!((phase_margin_deg(&axis, 0.0) - 45.0).abs() < 1e-9);
    }
}
