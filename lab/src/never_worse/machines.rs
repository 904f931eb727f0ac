//! The machines of the sweep: the built-in ones that differ in kind, and `tnv40` with one thing
//! changed at a time.

use feedwright_sim::{Machine, MachineError};

use crate::held_out::Variant;

/// Base of all machines.
const BASE: &str = "tnv40";
/// Built-in machines of the sweep.
const BUILT_IN_MACHINES: [&str; 4] = [BASE, "sticky", "coarse", "soft"];
/// Gains of all position loops, 1/s: the range of published machines.
const KP_1_S: [f64; 5] = [25.0, 40.0, 60.0, 100.0, 150.0];
/// Accelerations along and across the path, mm/s2: from a heavy gantry to half a g.
const ACCEL_MM_S2: [f64; 4] = [100.0, 400.0, 1000.0, 4000.0];
/// Encoder steps of all axes, um.
const ENCODER_UM: [f64; 2] = [0.1, 1.0];
/// Drive delays of all axes, ms.
const DELAY_MS: [f64; 2] = [1.0, 2.0];
/// Factor on the gain or on the inertia of y; x keeps its value. With a larger factor every line is
/// visibly askew, and no machine is left that way.
const UNLIKE: f64 = 1.5;

/// All of them.
///
/// # Errors
/// None as long as the changes are within the ranges of a machine file, which a test holds.
pub(crate) fn machines() -> Result<Vec<Machine>, MachineError> {
    let built_in = BUILT_IN_MACHINES.map(|name| Machine::load(name.as_ref()));
    let variants = variants();
    let all = built_in
        .into_iter()
        .chain(variants.iter().map(Variant::machine));
    all.collect()
}

fn variants() -> Vec<Variant> {
    let named = |name: String| Variant::of(BASE, name);
    let base = Machine::load(BASE.as_ref()).expect("the base is built in");
    let y = base.axis(1);
    let mut all = Vec::new();
    for kp in KP_1_S {
        all.push(named(format!("kp{kp}")).with_axes("kp_1_s", kp));
    }
    for accel in ACCEL_MM_S2 {
        let along = named(format!("accel{accel}")).with("limits", "tangential_accel_mm_s2", accel);
        all.push(along.with("limits", "normal_accel_mm_s2", accel));
    }
    for step in ENCODER_UM {
        all.push(named(format!("encoder{step}um")).with_axes("encoder_step_um", step));
    }
    for delay in DELAY_MS {
        all.push(named(format!("delay{delay}ms")).with_axes("drive_delay_s", delay * 1e-3));
    }
    let unlike =
        |name: &str, key, value| named(name.to_owned()).with("axis.y", key, UNLIKE * value);
    all.push(unlike("unlike-gain", "kp_1_s", y.kp_1_s));
    all.push(unlike("unlike-inertia", "inertia_kg_m2", y.inertia_kg_m2));
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_are_machines_and_no_name_comes_twice() {
        let machines = machines().expect("all are valid");
        let mut names: Vec<&str> = machines.iter().map(|machine| &machine.name[..]).collect();
        assert_eq!(names.len(), 19);
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), 19, "{names:?}");
    }
}
