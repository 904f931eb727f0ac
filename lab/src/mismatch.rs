//! Machines that differ from the one that a model was identified on: each of its values alone, and
//! several together.
//!
//! The model is identified on the base machine and cuts on the variant. The settings of peers also
//! come from the base machine, so all controllers have the same knowledge and the same errors in
//! it. A variant that changes nothing of a base is left out.
//!
//! | File | What |
//! |---|---|
//! | `mismatch/table.rs` | what the cuts came to, by machine and controller |

pub mod table;

use feedwright_sim::{Axis, Machine};

use crate::held_out::random::Random;

/// Difference of an axis from the base machine.
#[derive(Debug, Clone, Copy)]
enum Difference {
    /// Inertia, times.
    Inertia(f64),
    /// Inertia of y alone, times.
    InertiaOfY(f64),
    /// All friction, times.
    Friction(f64),
    /// Position gain, times.
    PositionGain(f64),
    /// Gain of the speed loop, times.
    SpeedGain(f64),
    /// Integral time of the speed loop, times.
    IntegralTime(f64),
    /// Velocity feedforward, times.
    Feedforward(f64),
    /// Delay of the drive, ms more.
    Delay(f64),
}

use Difference::{
    Delay, Feedforward, Friction, Inertia, InertiaOfY, IntegralTime, PositionGain, SpeedGain,
};

/// Everyday differences: a workpiece on the table, a cold morning, gains that were read off a
/// screen.
const EVERYDAY: [Difference; 20] = [
    Inertia(0.8),
    Inertia(1.25),
    Inertia(1.4),
    InertiaOfY(1.4),
    Friction(0.75),
    Friction(1.5),
    Friction(1.8),
    PositionGain(0.92),
    PositionGain(0.97),
    PositionGain(1.03),
    PositionGain(1.08),
    SpeedGain(0.85),
    SpeedGain(1.15),
    IntegralTime(0.8),
    IntegralTime(1.2),
    Feedforward(0.93),
    Feedforward(0.98),
    Delay(-0.3),
    Delay(0.4),
    Delay(0.8),
];
/// Gross ones: another machine.
const GROSS: [Difference; 5] = [
    Inertia(3.0),
    Inertia(1.0 / 3.0),
    PositionGain(0.7),
    Delay(2.0),
    Friction(3.0),
];
/// Parts by which drawn variants differ at the most in inertia, gains, integral time and friction.
const DRAWN: [f64; 2] = [0.1, 0.2];

impl Difference {
    fn name(self) -> String {
        match self {
            Inertia(times) => format!("inertia{times:.2}"),
            InertiaOfY(times) => format!("inertia-y{times:.2}"),
            Friction(times) => format!("friction{times:.2}"),
            PositionGain(times) => format!("kp{times:.2}"),
            SpeedGain(times) => format!("kv{times:.2}"),
            IntegralTime(times) => format!("ti{times:.2}"),
            Feedforward(times) => format!("feedforward{times:.2}"),
            Delay(ms) => format!("delay{ms:+.1}ms"),
        }
    }

    fn change(self, axis: &mut Axis, index: usize) {
        match self {
            Inertia(times) => axis.inertia_kg_m2 *= times,
            InertiaOfY(times) if index == 1 => axis.inertia_kg_m2 *= times,
            InertiaOfY(_) => {}
            Friction(times) => friction(axis).into_iter().for_each(|value| *value *= times),
            PositionGain(times) => axis.kp_1_s *= times,
            SpeedGain(times) => axis.kv_nm_s_per_rad *= times,
            IntegralTime(times) => axis.speed_integral_s *= times,
            Feedforward(times) => axis.velocity_feedforward *= times,
            Delay(ms) => axis.drive_delay_s = (axis.drive_delay_s + 1e-3 * ms).max(0.0),
        }
    }
}

/// All friction of an axis.
fn friction(axis: &mut Axis) -> [&mut f64; 4] {
    [
        &mut axis.coulomb_friction_nm,
        &mut axis.viscous_friction_nm_s,
        &mut axis.stribeck_nm,
        &mut axis.coulomb_asymmetry_nm,
    ]
}

/// Choice of the variants to cut.
#[derive(Debug, Clone, Copy)]
pub struct Variants {
    /// Gross differences in place of everyday ones.
    pub gross: bool,
    /// Variants in which everything differs, drawn for each of 10 and 20 %.
    pub drawn: u32,
    /// Their seed.
    pub seed: u64,
}

/// Name of the variant that changes nothing.
fn same_name(base: &str) -> String {
    format!("{base}-same")
}

/// The variants of a machine: the machine itself first.
pub fn variants(base: &Machine, Variants { gross, drawn, seed }: Variants) -> Vec<Machine> {
    let named = |name: &str, change: &mut dyn FnMut(&mut Axis, usize)| {
        let mut machine = base.clone();
        machine
            .axes
            .iter_mut()
            .enumerate()
            .for_each(|(index, axis)| change(axis, index));
        let is_base = machine.axes == base.axes;
        machine.name = format!("{}-{name}", base.name);
        (!is_base).then_some(machine)
    };
    let differences: &[Difference] = if gross { &GROSS } else { &EVERYDAY };
    let mut all = vec![Machine {
        name: same_name(&base.name),
        ..base.clone()
    }];
    all.extend(differences.iter().filter_map(|difference| {
        named(&difference.name(), &mut |axis: &mut Axis, index| {
            difference.change(axis, index);
        })
    }));
    for part in DRAWN {
        for number in 0..drawn {
            let mut random = Random::new(
                seed.wrapping_add(u64::from(number))
                    .wrapping_add((1e6 * part) as u64),
            );
            let mut draw = |axis: &mut Axis, _: usize| {
                let mut differ =
                    |value: &mut f64| *value *= random.between([1.0 - part, 1.0 + part]);
                for value in [
                    &mut axis.inertia_kg_m2,
                    &mut axis.kp_1_s,
                    &mut axis.kv_nm_s_per_rad,
                    &mut axis.speed_integral_s,
                ] {
                    differ(value);
                }
                friction(axis).into_iter().for_each(differ);
            };
            all.extend(named(
                &format!("drawn{:.0}-{number}", 100.0 * part),
                &mut draw,
            ));
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variants_differ_from_the_base_and_from_each_other_and_are_the_same_again() {
        for (name, count) in [("workshop", 20), ("tnv40", 15)] {
            let base = Machine::load(name.as_ref()).unwrap();
            let of = |seed: u64| {
                variants(
                    &base,
                    Variants {
                        gross: false,
                        drawn: 2,
                        seed,
                    },
                )
            };
            let all = of(7);
            assert_eq!(all.len(), 1 + count + 4, "{name}");
            assert_eq!(all, of(7));
            for (i, machine) in all.iter().enumerate() {
                assert_eq!(machine.axes == base.axes, i == 0, "{}", machine.name);
                assert!(
                    all[..i].iter().all(|other| other.axes != machine.axes),
                    "{}",
                    machine.name
                );
            }
            assert_ne!(all.last(), of(8).last());
        }
    }

    #[test]
    fn a_delay_is_never_negative() {
        let base = Machine::load("tnv40".as_ref()).unwrap();
        let all = variants(
            &base,
            Variants {
                gross: false,
                drawn: 0,
                seed: 1,
            },
        );
        assert!(
            all.iter()
                .all(|machine| machine.axes.iter().all(|axis| axis.drive_delay_s >= 0.0))
        );
        assert!(
            all.iter()
                .any(|machine| machine.name == "tnv40-delay+0.8ms")
        );
        assert!(
            !all.iter()
                .any(|machine| machine.name == "tnv40-delay-0.3ms"),
            "it has none"
        );
    }
}
