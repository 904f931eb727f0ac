//! Whatever a machine file may say: a second of it is simulated without a panic. What is tuned
//! badly diverges; that is a result.

use feedwright_control::position_gains_1_s;
use feedwright_sim::machine_keys as keys;
use feedwright_sim::toml_file::Key;
use feedwright_sim::toml_file::key::Value;
use feedwright_sim::{Machine, Plant, Transmission};
use proptest::prelude::*;

/// Mechanics periods in a second of a case, at the most: a run of all cases is to end.
const MOST_PERIODS: f64 = 20_000.0;

/// A value of a range: one of its ends, zero where that is in it, or one within, evenly in its
/// logarithm.
fn value([least, most]: [f64; 2], choice: u8, part: f64) -> f64 {
    let within_zero = least <= 0.0 && most >= 0.0;
    match choice {
        0 => least,
        1 => most,
        2 | 3 if within_zero => 0.0,
        _ => {
            let small = if least > 0.0 { least } else { most * 1e-9 };
            let size = small * (most / small).powf(part);
            if least < 0.0 && choice.is_multiple_of(2) {
                -size
            } else {
                size
            }
        }
    }
}

fn set<T>(keys: &[Key<T>], part: &mut T, choices: &[(u8, f64)]) {
    for (key, &(choice, share)) in keys.iter().zip(choices.iter().cycle()) {
        if let Value::Number { set, .. } = key.value {
            set(part, value(key.range, choice, share));
        }
    }
}

/// A machine whose values of all kinds are drawn from all over their ranges, or those alone that
/// tnv40 leaves out, so that it does not diverge at once; none where they do not go together.
fn machine(
    choices: &[(u8, f64)],
    per_servo: u32,
    has_screw: bool,
    is_sound: bool,
) -> Option<Machine> {
    let mut machine = Machine::load("tnv40".as_ref()).unwrap();
    let servo_s =
        value([1e-5, 0.1], choices[0].0, choices[0].1).max(f64::from(per_servo) / MOST_PERIODS);
    machine.period.servo_s = servo_s;
    machine.period.mechanics_s = servo_s / f64::from(per_servo);
    for (i, axis) in machine.axes.iter_mut().enumerate() {
        let rotated: Vec<(u8, f64)> = choices
            .iter()
            .cycle()
            .skip(1 + 7 * i)
            .take(choices.len())
            .copied()
            .collect();
        let sound = *axis;
        set(keys::AXIS, axis, &rotated);
        if is_sound {
            for key in keys::AXIS.iter().filter(|key| !key.optional) {
                if let Value::Number { get, set } = key.value {
                    set(axis, get(&sound).unwrap());
                }
            }
        }
        let [least_1_s, most_1_s] = position_gains_1_s(servo_s);
        axis.kp_1_s = axis.kp_1_s.clamp(least_1_s, most_1_s);
        let most_nm = axis.coulomb_friction_nm;
        axis.coulomb_asymmetry_nm = axis.coulomb_asymmetry_nm.max(-most_nm).min(most_nm);
        (axis.jitter_s, axis.drive_delay_s) = (
            axis.jitter_s.min(servo_s),
            axis.drive_delay_s.min(50.0 * servo_s),
        );
        axis.command_delay_s = axis.command_delay_s.min(8.0 * servo_s);
        axis.measurement_delay_s = axis.measurement_delay_s.min(50.0 * servo_s);
        let needed = [
            &mut axis.signal_period_um,
            &mut axis.stribeck_mm_s,
            &mut axis.cogging_per_rev,
            &mut axis.ripple_per_rev,
        ];
        needed
            .into_iter()
            .for_each(|value| *value = value.max(1e-9));
        axis.transmission = has_screw.then(|| {
            let mut transmission = Transmission::default();
            set(keys::TRANSMISSION, &mut transmission, &rotated);
            transmission.resonance_hz = transmission
                .resonance_hz
                .min(0.005 / machine.period.mechanics_s)
                .max(0.1);
            transmission
        });
        // The mechanics period has to follow viscous friction, too.
        let braked_kg_m2 =
            axis.inertia_kg_m2 * axis.transmission.map_or(1.0, |screw| screw.table_share);
        axis.viscous_friction_nm_s = axis
            .viscous_friction_nm_s
            .min(0.999 * braked_kg_m2 / machine.period.mechanics_s);
    }
    set(keys::GEOMETRY, &mut machine.geometry, &choices[3..]);
    machine.noise.seed = choices[0].1.to_bits() >> 11;
    // What is written is what a file may say.
    Machine::parse("drawn.toml", &machine.text()).ok()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn a_second_of_any_machine_is_simulated(
        choices in proptest::collection::vec((0..12_u8, 0.0..1.0), 53), per_servo in 1..30_u32,
        has_screw in any::<bool>(), is_sound in any::<bool>()
    ) {
        let Some(machine) = machine(&choices, per_servo, has_screw, is_sound) else {
            // A screw that the mechanics period cannot follow is refused; everything else has to be
            // a machine.
            prop_assert!(has_screw, "a machine without a screw was refused");
            return Ok(());
        };
        let mut plant = Plant::<3>::new(&machine, [1.0, -2.0, 0.5]);
        let periods = (1.0 / machine.period.servo_s).ceil() as u32;
        for n in 0..periods {
            let phase = f64::from(n) / f64::from(periods) * 30.0;
            let command_mm = if n == periods / 2 { [1e3, -1e3, 0.0] } else { [phase.cos(), -2.0 + phase.sin(), 0.5 + phase] };
            let row = plant.step(command_mm);
            if row.position_mm.iter().any(|at| at.is_nan()) {
                break;
            }
            if n % 97 == 0 {
                plant.skip(u64::from(n));
            }
        }
        let seeded = Plant::<3>::with_seed(&machine, [0.0; 3], u64::MAX).step([0.1; 3]);
        let again = Plant::<3>::with_seed(&machine, [0.0; 3], u64::MAX).step([0.1; 3]);
        prop_assert_eq!(seeded.torque_nm.map(f64::to_bits), again.torque_nm.map(f64::to_bits));
    }
}

/// The draws come to what they are to test.
#[test]
fn the_values_lie_within_their_ranges_and_at_their_ends() {
    for key in keys::AXIS {
        let [least, most] = key.range;
        let values: Vec<f64> = (0..12)
            .flat_map(|choice| [0.0, 0.5, 0.999].map(|part| value(key.range, choice, part)))
            .collect();
        assert!(
            values.iter().all(|value| (least..=most).contains(value)),
            "{}: {values:?}",
            key.name
        );
        assert!(
            values.contains(&least) && values.contains(&most),
            "{}",
            key.name
        );
    }
}

/// Checks an impulse P without loops and friction: the center of mass of motor and table moves at P
/// / J.
#[test]
fn a_blow_gives_the_axis_its_impulse() {
    let mut machine = Machine::load("soft".as_ref()).unwrap();
    for (axis, screw) in machine.axes.iter_mut().zip([true, false, false]) {
        (axis.kp_1_s, axis.kv_nm_s_per_rad, axis.disturbance_nm) = (1e-3, 1e-9, 0.0);
        (axis.viscous_friction_nm_s, axis.coulomb_friction_nm) = (0.0, 0.0);
        if !screw {
            axis.transmission = None;
        }
    }
    let mut plant = Plant::<2>::new(&machine, [0.0; 2]);
    let impulse_nm_s = [1e-3, -2e-3];
    plant.push(impulse_nm_s);
    let seconds = 10.0;
    (0..(seconds / machine.period.servo_s) as usize).for_each(|_| {
        plant.step([0.0; 2]);
    });
    let moved_mm = plant.position_mm();
    for (i, impulse_nm_s) in impulse_nm_s.into_iter().enumerate() {
        let axis = machine.axis(i);
        let free_mm = impulse_nm_s / axis.inertia_kg_m2 * seconds / axis.rad_per_mm();
        // Backlash and a swinging screw: the table is within some hundredths of a millimeter of the
        // center of mass.
        assert!(
            (moved_mm[i] - free_mm).abs() < 0.02,
            "{i}: {} mm, {free_mm} mm expected",
            moved_mm[i]
        );
    }
}
