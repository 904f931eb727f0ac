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

/// Values that differ from those of the base machine: name in the variant, and factors; of the delay
/// ms more.
type ChangedValues = [(&'static str, &'static [f64])];

/// Everyday differences: a workpiece on the table, a cold morning, gains that were read off a
/// screen.
const EVERYDAY: &ChangedValues = &[
    ("inertia", &[0.8, 1.25, 1.4]),
    ("inertia-y", &[1.4]),
    ("friction", &[0.75, 1.5, 1.8]),
    ("kp", &[0.92, 0.97, 1.03, 1.08]),
    ("kv", &[0.85, 1.15]),
    ("ti", &[0.8, 1.2]),
    ("feedforward", &[0.93, 0.98]),
    ("delay", &[-0.3, 0.4, 0.8]),
];
/// Gross ones: another machine.
const GROSS: &ChangedValues = &[
    ("inertia", &[3.0, 1.0 / 3.0]),
    ("kp", &[0.7]),
    ("delay", &[2.0]),
    ("friction", &[3.0]),
];
/// Parts by which drawn variants differ at the most in inertia, gains, integral time and friction.
const DRAWN: [f64; 2] = [0.1, 0.2];

/// Changes an axis with this index.
fn differ(what: &str, by: f64, axis: &mut Axis, index: usize) {
    match what {
        "inertia" => axis.inertia_kg_m2 *= by,
        "inertia-y" if index == 1 => axis.inertia_kg_m2 *= by,
        "friction" => friction(axis).into_iter().for_each(|value| *value *= by),
        "kp" => axis.kp_1_s *= by,
        "kv" => axis.kv_nm_s_per_rad *= by,
        "ti" => axis.speed_integral_s *= by,
        "feedforward" => axis.velocity_feedforward *= by,
        "delay" => axis.drive_delay_s = (axis.drive_delay_s + 1e-3 * by).max(0.0),
        _ => {}
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
        let axes = machine.axes.iter_mut().enumerate();
        axes.for_each(|(index, axis)| change(axis, index));
        machine.name = format!("{}-{name}", base.name);
        (machine.axes != base.axes).then_some(machine)
    };
    let mut all = vec![Machine {
        name: same_name(&base.name),
        ..base.clone()
    }];
    for (what, values) in if gross { GROSS } else { EVERYDAY } {
        for &by in *values {
            let name = match *what {
                "delay" => format!("delay{by:+.1}ms"),
                _ => format!("{what}{by:.2}"),
            };
            all.extend(named(&name, &mut |axis, index| {
                differ(what, by, axis, index);
            }));
        }
    }
    for part in DRAWN {
        for number in 0..drawn {
            let seed = seed
                .wrapping_add(u64::from(number))
                .wrapping_add((1e6 * part) as u64);
            let mut random = Random::new(seed);
            let mut draw = |axis: &mut Axis, _: usize| {
                let mut differ =
                    |value: &mut f64| *value *= random.between([1.0 - part, 1.0 + part]);
                differ(&mut axis.inertia_kg_m2);
                differ(&mut axis.kp_1_s);
                differ(&mut axis.kv_nm_s_per_rad);
                differ(&mut axis.speed_integral_s);
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

    fn everyday(drawn: u32, seed: u64) -> Variants {
        Variants {
            gross: false,
            drawn,
            seed,
        }
    }

    #[test]
    fn variants_differ_from_the_base_and_from_each_other_and_are_the_same_again() {
        for (name, count) in [("workshop", 20), ("tnv40", 15)] {
            let base = Machine::load(name.as_ref()).unwrap();
            let of = |seed: u64| variants(&base, everyday(2, seed));
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
        let all = variants(&base, everyday(0, 1));
        let mut axes = all.iter().flat_map(|machine| &machine.axes);
        assert!(axes.all(|axis| axis.drive_delay_s >= 0.0));
        let has = |name: &str| all.iter().any(|machine| machine.name == name);
        assert!(has("tnv40-delay+0.8ms"));
        assert!(!has("tnv40-delay-0.3ms"), "it has none");
    }
}
