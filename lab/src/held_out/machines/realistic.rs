//! Effects of real axes beside their loops, drawn on top of a drawn machine: each within the range
//! of the built-in machines, or not at all.

use feedwright_sim::{Axis, rounded};

use super::super::random::Random;
use super::super::variant::{AXES, Variant};

/// Tables of the ball screws.
const SCREWS: [&str; 3] = [
    "axis.x.transmission",
    "axis.y.transmission",
    "axis.z.transmission",
];
/// Servo periods, s, and mechanics periods in one: `stiff` has the first, most others the second,
/// an older control the third.
const SERVO_S: [f64; 3] = [0.0005, 0.001, 0.002];
const MECHANICS_PERIODS: f64 = 10.0;
/// Range of the integral time of the speed loop, in J / Kv: 4 is the symmetrical optimum (Kessler
/// 1958).
const INTEGRAL: [f64; 2] = [4.0, 8.0];
/// Ranges of the parts that are fed forward.
const VELOCITY_FEEDFORWARD: [f64; 2] = [0.5, 1.0];
const ACCELERATION_FEEDFORWARD: [f64; 2] = [0.5, 0.8];
/// Range of the corner of the torque filter, Hz.
const TORQUE_FILTER_HZ: [f64; 2] = [500.0, 1500.0];
/// Ranges of Stribeck's friction and of the asymmetry in Coulomb friction, of Stribeck's speed,
/// mm/s, and of presliding, um.
const STRIBECK: [f64; 2] = [0.2, 0.5];
const ASYMMETRY: [f64; 2] = [-0.1, 0.1];
const STRIBECK_MM_S: [f64; 2] = [2.0, 3.0];
const PRESLIDING_UM: [f64; 2] = [10.0, 20.0];
/// Ranges of cogging in Coulomb friction, and of torque ripple; their periods in a turn, of servo
/// motors and of steppers.
const COGGING: [f64; 2] = [0.125, 0.6];
const RIPPLE: [f64; 2] = [0.01, 0.03];
const PER_REV: [[f64; 2]; 2] = [[24.0, 8.0], [200.0, 100.0]];
/// Ranges of a ball screw: part of the inertia at the table, resonance, Hz, damping ratio, and
/// backlash, um.
const TABLE_SHARE: [f64; 2] = [0.3, 0.5];
const RESONANCE_HZ: [f64; 2] = [40.0, 150.0];
const DAMPING: [f64; 2] = [0.02, 0.05];
const BACKLASH_UM: [f64; 2] = [1.0, 20.0];
/// Ranges of noise: of the encoder, um, of torque in the amplitude of the disturbance, and of the
/// disturbance's frequency.
const ENCODER_NOISE_UM: [f64; 2] = [0.02, 0.1];
const TORQUE_NOISE: [f64; 2] = [0.1, 1.0];
const TORQUE_NOISE_S: f64 = 0.005;
const WANDER: [f64; 2] = [0.01, 0.05];

/// Adds the effects that are drawn. Motors, screws and drives of a machine are of one make;
/// friction differs from axis to axis.
pub(super) fn with_imperfections(variant: Variant, axes: &[Axis], random: &mut Random) -> Variant {
    let servo_s = SERVO_S[random.whole(0, 2) as usize];
    let variant = variant.with("period", "servo_s", servo_s).with(
        "period",
        "mechanics_s",
        servo_s / MECHANICS_PERIODS,
    );
    let variant = with_drive(variant, axes, random);
    let variant = with_friction(variant, axes, random);
    with_screw(with_motor_and_noise(variant, axes, random), random)
}

fn with_drive(mut variant: Variant, axes: &[Axis], random: &mut Random) -> Variant {
    if !random.one_in(3) {
        let times = random.by_ratio(INTEGRAL);
        for (table, axis) in AXES.into_iter().zip(axes) {
            let integral_s = times * axis.inertia_kg_m2 / axis.kv_nm_s_per_rad;
            variant = variant.with(table, "speed_integral_s", rounded(integral_s, 3));
        }
    }
    for (key, range, one_in) in [
        ("velocity_feedforward", VELOCITY_FEEDFORWARD, 3),
        ("acceleration_feedforward", ACCELERATION_FEEDFORWARD, 2),
        ("torque_filter_hz", TORQUE_FILTER_HZ, 2),
    ] {
        let value = random.by_ratio(range);
        if !random.one_in(one_in) {
            variant = variant.with_axes(key, value);
        }
    }
    variant
}

fn with_friction(mut variant: Variant, axes: &[Axis], random: &mut Random) -> Variant {
    let [slides, sticks] = [random.one_in(4), random.one_in(4)].map(|is_absent| !is_absent);
    let stribeck_mm_s = random.by_ratio(STRIBECK_MM_S);
    let presliding_um = random.by_ratio(PRESLIDING_UM);
    for (table, axis) in AXES.into_iter().zip(axes) {
        let of_coulomb = |part: f64| rounded(part * axis.coulomb_friction_nm, 3);
        let (stribeck, asymmetry) = (random.between(STRIBECK), random.between(ASYMMETRY));
        variant = variant.with(table, "coulomb_asymmetry_nm", of_coulomb(asymmetry));
        if slides {
            variant = variant
                .with(table, "stribeck_nm", of_coulomb(stribeck))
                .with(table, "stribeck_mm_s", stribeck_mm_s);
        }
    }
    match sticks {
        true => variant.with_axes("presliding_um", presliding_um),
        false => variant,
    }
}

fn with_motor_and_noise(mut variant: Variant, axes: &[Axis], random: &mut Random) -> Variant {
    let [cogging_per_rev, ripple_per_rev] = PER_REV[usize::from(random.one_in(3))];
    let [cogging, ripple, noise] =
        [COGGING, RIPPLE, TORQUE_NOISE].map(|range| random.by_ratio(range));
    let [cogs, ripples, is_noisy] = [2, 2, 3].map(|one_in| !random.one_in(one_in));
    for (table, axis) in AXES.into_iter().zip(axes) {
        if cogs {
            let cogging_nm = rounded(cogging * axis.coulomb_friction_nm, 3);
            variant = variant.with(table, "cogging_nm", cogging_nm);
            variant = variant.with(table, "cogging_per_rev", cogging_per_rev);
        }
        if ripples {
            variant = variant.with(table, "ripple", ripple);
            variant = variant.with(table, "ripple_per_rev", ripple_per_rev);
        }
        if is_noisy {
            let noise_nm = rounded(noise * axis.disturbance_nm, 3);
            variant = variant.with(table, "torque_noise_nm", noise_nm);
            variant = variant.with(table, "torque_noise_s", TORQUE_NOISE_S);
        }
    }
    let (encoder_um, wander) = (random.by_ratio(ENCODER_NOISE_UM), random.by_ratio(WANDER));
    if !is_noisy {
        return variant;
    }
    variant
        .with_axes("encoder_noise_um", encoder_um)
        .with_axes("disturbance_wander", wander)
}

/// One machine in two has screws that give, and one of these in two has backlash.
fn with_screw(variant: Variant, random: &mut Random) -> Variant {
    if random.one_in(2) {
        return variant;
    }
    let (share, damping) = (random.by_ratio(TABLE_SHARE), random.by_ratio(DAMPING));
    let backlash_um = match random.one_in(2) {
        true => 0.0,
        false => random.by_ratio(BACKLASH_UM),
    };
    let resonance_hz = random.by_ratio(RESONANCE_HZ);
    let screw = |variant: Variant, table| {
        let variant = variant.with(table, "table_share", share);
        let variant = variant.with(table, "resonance_hz", resonance_hz);
        let variant = variant.with(table, "damping_ratio", damping);
        variant.with(table, "backlash_um", backlash_um)
    };
    SCREWS.into_iter().fold(variant, screw)
}
