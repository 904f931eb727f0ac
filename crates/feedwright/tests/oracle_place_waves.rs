//! What repeats with place, found in logs of simulated machines by the models that other logs
//! identified, against the machine files.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use crate::sweep::part_or_whole;
use feedwright::recorded_machine;
use feedwright_gcode::Program;
use feedwright_ident::{
    Columns, ExciteOptions, Log, PlaceWave, PlaceWaves, excitation_program, place_waves,
    recorded_log,
};
use feedwright_sim::{Axis, Machine};

/// First seed of the logs; the models are of seed 1.
const SEED: u64 = 71_001;

/// Log of the first two axes of a machine that cuts the program of `excite`.
fn log_of(machine: &Machine, seed: u64) -> Log {
    let two = Machine {
        axes: machine.axes.iter().take(2).copied().collect(),
        ..machine.clone()
    };
    let two = two.with_noise_seed(machine.noise.seed.wrapping_add(seed));
    let program = excitation_program(&two, ExciteOptions::default()).unwrap();
    let program = Program::from_text("excite.ngc", program.text);
    let text = recorded_log::<2>(&two, &program).unwrap();
    let length = text.len() as u64;
    let columns = Columns::default();
    Log::from_reader(Path::new("log"), text.as_bytes(), length, &columns, &()).unwrap()
}

/// Returns the waves that a log shows with the model that the log of another seed identified. The
/// actual positions are recorded late by whole samples.
fn shown(machine: &Machine, log: &Log, late: usize) -> Vec<PlaceWaves> {
    let built_in = Machine::load(machine.name.as_ref()).unwrap();
    let (model, _) = recorded_machine(&built_in, 2, 1, &()).unwrap();
    let mut log = log.clone();
    for axis in &mut log.axes {
        let end = axis.actual_mm.len() - late;
        let first_mm = axis.actual_mm[0];
        axis.actual_mm.copy_within(..end, late);
        axis.actual_mm[..late].fill(first_mm);
    }
    let late_s = late as f64 * log.sample_time_s;
    place_waves(&log, &model.axes, model.period.servo_s, late_s)
}

/// Asserts that a wave is as it should be: its amplitude within a part, its phase at zero within
/// `phase_rad`, and within four times that 50 mm from there, where the period counts.
fn assert_wave(found: Option<PlaceWave>, is: [f64; 3], part: f64, phase_rad: f64, what: &str) {
    let [amplitude, period_mm, phase] = is;
    let Some(wave) = found else {
        assert!(amplitude == 0.0, "{what}: not found");
        return;
    };
    println!("{what}: {wave:?}, is {is:?}");
    assert!(
        (wave.amplitude / amplitude - 1.0).abs() < part,
        "{what}: {wave:?}, is {is:?}"
    );
    let off = (wave.phase_rad - phase + PI).rem_euclid(TAU) - PI;
    // The log has positions within 50 mm of zero.
    let far = TAU * 50.0 * (1.0 / wave.period_mm - 1.0 / period_mm);
    assert!(
        off.abs() < phase_rad && (off + far).abs().max((off - far).abs()) < 4.0 * phase_rad,
        "{what}: {wave:?}, is {is:?}"
    );
}

/// Interpolation error in um and cogging in mm/s2, their periods in mm, and their phases in rad.
fn truth(axis: &Axis) -> [[f64; 3]; 2] {
    let cogging_mm_s2 = axis.cogging_nm / axis.inertia_kg_m2 / axis.rad_per_mm();
    [
        [
            axis.interpolation_error_um,
            1e-3 * axis.signal_period_um,
            axis.interpolation_phase_rad,
        ],
        [
            cogging_mm_s2,
            axis.lead_mm_per_rev / axis.cogging_per_rev.max(1.0),
            axis.cogging_phase_rad,
        ],
    ]
}

fn assert_found(machine: &Machine, found: &[PlaceWaves], cogging_part: f64) {
    for (i, (waves, axis)) in found.iter().zip(&machine.axes).enumerate() {
        let [interpolation, cogging] = truth(axis);
        let what = |kind: &str| format!("{kind} of axis {i} of {}", machine.name);
        assert_wave(
            waves.interpolation,
            interpolation,
            0.05,
            0.1,
            &what("interpolation"),
        );
        assert_wave(waves.cogging, cogging, cogging_part, 0.5, &what("cogging"));
    }
}

#[test]
fn a_log_shows_interpolation_error_and_cogging_with_their_phases() {
    for seed in SEED..SEED + part_or_whole(1, 10) {
        // On `router` the motor alone follows above the resonance of the screw: 0.7 of the inertia.
        for (name, cogging_part) in [("workshop", 0.4), ("stiff", 0.4), ("router", 0.5)] {
            let machine = Machine::load(name.as_ref()).unwrap();
            let log = log_of(&machine, seed);
            assert_found(&machine, &shown(&machine, &log, 0), cogging_part);
        }
    }
}

#[test]
fn phases_are_those_of_the_measured_position_however_late_the_record_is() {
    let mut machine = Machine::load("workshop".as_ref()).unwrap();
    for axis in &mut machine.axes {
        (axis.interpolation_phase_rad, axis.cogging_phase_rad) = (1.2, -2.0);
    }
    let log = log_of(&machine, SEED);
    for late in [0, 40] {
        assert_found(&machine, &shown(&machine, &log, late), 0.4);
    }
}

#[test]
fn a_log_shows_no_waves_that_are_not_there() {
    for seed in SEED..SEED + part_or_whole(1, 10) {
        for name in [
            "tnv40", "heavy", "rough", "sticky", "soft", "coarse", "emps",
        ] {
            let machine = Machine::load(name.as_ref()).unwrap();
            let found = shown(&machine, &log_of(&machine, seed), 0);
            for waves in found {
                assert_eq!(waves, PlaceWaves::default(), "{name}, seed {seed}");
            }
        }
    }
}
