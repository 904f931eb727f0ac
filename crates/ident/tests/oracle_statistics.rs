//! Statistics of axes that are estimated from a recording of a simulated machine, against those of
//! its file.

use std::f64::consts::TAU;
use std::path::PathBuf;

use crate::sweep::part_or_whole;
use feedwright_control::Parameters;
use feedwright_ident::{Excitation, axis_statistics};
use feedwright_sim::Machine;

/// Seed that was not used to choose the constants.
const SEED: u64 = 55_001;

/// A machine of the library, or one of the examples' with one imperfection.
fn machine(name: &str) -> Machine {
    let example = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join(format!("../../examples/03_realism/machines/{name}.toml"));
    Machine::load(if example.exists() {
        example.as_os_str()
    } else {
        name.as_ref()
    })
    .unwrap()
}

fn true_and_found(name: &str, seed: u64) -> [[Parameters; 2]; 2] {
    let mut machine = machine(name);
    machine.noise.seed = seed;
    let recording = Excitation::statistics(&machine).record_in_one::<2>(&machine, seed);
    let start = std::time::Instant::now();
    let found = axis_statistics(&recording, &machine.known());
    println!(
        "{name}: {} samples, {:.2} s",
        recording.stretches[0].len(),
        start.elapsed().as_secs_f64()
    );
    let truth = [0, 1].map(|i| machine.axis(i).parameters());
    for i in 0..2 {
        let um = 1e3 / machine.axis(i).rad_per_mm();
        [("is ", &truth[i]), ("est", &found[i])]
            .iter()
            .for_each(|(what, s)| println!("{i} {what} {}", row(s, um)));
    }
    [truth, found]
}

/// A row of the table: um, N m, ms, Hz.
fn row(s: &Parameters, um: f64) -> String {
    let signal_um = if s.signal_per_rad > 0.0 {
        TAU / s.signal_per_rad * um
    } else {
        0.0
    };
    format!(
        "noise {:.4} step {:.4} | interpolation {:.4} in {signal_um:.4} at {:.2} | torque {:.4} {:.2} ms | line {:.4} {:.2} Hz wander {:.4} | cogging {:.4} {:.0} at {:.2}",
        s.encoder_noise_rad * um,
        s.encoder_step_rad * um,
        s.interpolation_rad * um,
        s.interpolation_phase_rad,
        s.torque_noise_nm,
        1e3 * s.torque_noise_s,
        s.disturbance_nm,
        s.disturbance_rad_s / TAU,
        s.disturbance_wander,
        s.cogging_nm,
        s.cogging_per_rev,
        s.cogging_phase_rad
    )
}

/// Lists the misses, in words. A term that is present must be found within these factors, an absent
/// one must be zero.
fn missed(truth: &Parameters, found: &Parameters) -> Vec<String> {
    let of = |s: &Parameters| {
        [
            ("noise", s.encoder_noise_rad, 1.15),
            ("step", s.encoder_step_rad, 1.000_001),
            ("interpolation", s.interpolation_rad, 1.1),
            (
                "signal",
                if s.interpolation_rad > 0.0 {
                    s.signal_per_rad
                } else {
                    0.0
                },
                1.0001,
            ),
            ("torque", s.torque_noise_nm, 1.2),
            ("correlation", s.torque_noise_s, 1.4),
            ("line", s.disturbance_nm, 1.2),
            ("frequency", s.disturbance_rad_s, 1.02),
            // A minute has thirty independent values of it.
            ("wander", s.disturbance_wander, 1.6),
            ("cogging", s.cogging_nm, 1.25),
            ("lines", s.cogging_per_rev, 1.000_001),
        ]
    };
    let is_off = |(is, found, factor): (f64, f64, f64)| {
        if is == 0.0 {
            found != 0.0
        } else {
            found > is * factor || found < is / factor
        }
    };
    // An interpolation error shifts the place at which it is looked up: what that leaves counts as
    // noise.
    let lookup_rad = 0.1 * truth.interpolation_rad;
    let found = &Parameters {
        encoder_noise_rad: if found.encoder_noise_rad < lookup_rad {
            0.0
        } else {
            found.encoder_noise_rad
        },
        ..*found
    };
    let pairs = of(truth).into_iter().zip(of(found));
    let mut missed: Vec<String> = pairs
        .filter(|((_, is, factor), (_, found, _))| is_off((*is, *found, *factor)))
        .map(|((what, is, _), (_, found, _))| format!("{what}: is {is}, found {found}"))
        .collect();
    for (what, phase_rad) in [
        ("interpolation", found.interpolation_phase_rad),
        ("cogging", found.cogging_phase_rad),
    ] {
        if phase_rad.abs() > 0.25 {
            missed.push(format!("phase of {what}: {phase_rad} rad"));
        }
    }
    missed
}

fn holds(names: &[&str]) {
    let mut all = Vec::new();
    for name in names {
        let [truth, found] = true_and_found(name, SEED);
        for i in 0..2 {
            all.extend(
                missed(&truth[i], &found[i])
                    .into_iter()
                    .map(|text| format!("{name} {i}: {text}")),
            );
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn a_delivered_machine_is_found_term_by_term() {
    holds(&["workshop", "stiff"]);
}

#[test]
fn what_a_machine_does_not_have_is_not_found() {
    holds(&["tnv40"]);
}

#[test]
fn single_imperfections_are_distinguished() {
    let all = [
        "geometry",
        "late",
        "measured_late",
        "pi_speed_loop",
        "white_0.1",
        "cogging",
        "combined",
        "interpolation",
        "presliding",
        "steps_1",
        "torque_noise",
        "white_0.5",
    ];
    holds(&all[part_or_whole(5, 0)..]);
}

/// The axis model has no ball screw: above its resonance only the motor moves, 0.7 of the inertia,
/// and the resonance counts as load.
#[test]
fn a_machine_with_a_soft_screw_shows_steps_and_cogging_and_more_load_than_it_has() {
    let [truth, found] = true_and_found("router", SEED);
    for (truth, found) in truth.iter().zip(&found) {
        assert!((found.encoder_step_rad / truth.encoder_step_rad - 1.0).abs() < 1e-6);
        assert_eq!(
            (found.cogging_per_rev, found.interpolation_rad),
            (truth.cogging_per_rev, 0.0)
        );
        let of_motor = found.cogging_nm / (truth.cogging_nm / 0.7);
        assert!((0.8..1.25).contains(&of_motor), "{of_motor}");
        assert!(
            found.torque_noise_nm > 0.8 * truth.torque_noise_nm,
            "{found:?}"
        );
    }
}

/// The statistics have no terms for jitter and ripple: both are reported as torque, and nothing
/// with place.
#[test]
fn what_has_no_term_counts_as_torque() {
    for name in ["jitter", "ripple"] {
        let [_, found] = true_and_found(name, SEED);
        assert!(
            found
                .iter()
                .all(|found| found.interpolation_rad == 0.0 && found.encoder_step_rad == 0.0),
            "{found:?}"
        );
    }
}

/// Only the skirts of the line show where there is no other noise, and they are not those of a
/// normal distribution: a spindle's frequency is held for about a second.
#[test]
fn a_line_that_wanders_beside_nothing_is_found_wider_than_it_is() {
    let [truth, found] = true_and_found("wander", SEED);
    for (truth, found) in truth.iter().zip(&found) {
        let ratio = |is: f64, found: f64| (found / is).max(is / found);
        assert!(
            ratio(truth.disturbance_nm, found.disturbance_nm) < 1.4,
            "{found:?}"
        );
        assert!(
            ratio(truth.disturbance_rad_s, found.disturbance_rad_s) < 1.02,
            "{found:?}"
        );
        assert!(
            ratio(truth.disturbance_wander, found.disturbance_wander) < 2.0,
            "{found:?}"
        );
        let others = [
            found.encoder_noise_rad,
            found.torque_noise_nm,
            found.interpolation_rad,
            found.cogging_nm,
        ];
        assert_eq!(others, [0.0; 4]);
    }
}
