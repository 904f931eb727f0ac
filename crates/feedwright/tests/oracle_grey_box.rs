//! Identification from logs: what is found of simulated machines is what they were made of, and of
//! a public bench what was published.

use std::path::Path;

use crate::identification_log::{commands_mm, log_of, logged};
use crate::sweep::part_or_whole;
use feedwright::{LogIdentified, LogJob, machine_text, updated_text};
use feedwright_ident::{AxisFacts, Columns, FoundAxis, Log, ModelTerm, ModelVerdict, NumberSource};
use feedwright_sim::{Machine, Plant};

fn identified(log: Log, job: LogJob) -> LogIdentified {
    job.run(log, &()).unwrap()
}

fn number(axis: &FoundAxis, key: &str) -> f64 {
    axis.numbers()
        .into_iter()
        .find(|number| number.key == key)
        .unwrap()
        .value
}

fn assert_near(found: f64, wanted: f64, part: f64, what: &str) {
    assert!(
        (found / wanted - 1.0).abs() < part,
        "{what}: {found}, not {wanted}"
    );
}

/// 1 %: what the machine file was made with, over what the steps of the encoder and the disturbance
/// of 25 Hz blur.
const PRODUCT: f64 = 0.01;
const FRICTION: f64 = 0.03;

/// Needs 8 s of processor time: identifies two axes from a log of 10 s.
#[test]
fn the_products_of_a_simulated_machine_are_found_from_positions_alone() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let found = identified(
        log_of(&machine, part_or_whole(10.0, 20.0), 1.0, 1),
        LogJob::default(),
    );
    for (axis, is) in found.machine.axes.iter().zip(&machine.axes) {
        let j = is.inertia_kg_m2;
        let fc = is.coulomb_friction_nm / j / is.rad_per_mm();
        assert_near(
            number(axis, "kp_kv_over_j_1_s2"),
            is.kp_1_s * is.kv_nm_s_per_rad / j,
            PRODUCT,
            "Kp Kv / J",
        );
        let damping = (is.kv_nm_s_per_rad + is.viscous_friction_nm_s) / j;
        assert_near(
            number(axis, "kv_plus_b_over_j_1_s"),
            damping,
            PRODUCT,
            "(Kv + B) / J",
        );
        assert_near(number(axis, "fc_over_j_mm_s2"), fc, FRICTION, "Fc / J");
        assert_eq!(axis.inertia().2, NumberSource::Assumed);
        assert!(
            axis.scores.grey_box.at_um[2] < 2.0,
            "{:?}",
            axis.scores.grey_box
        );
    }
    // The file reads back, and its machine does what the log's did on other commands.
    let text = machine_text(&found, "mine");
    let mine = Machine::parse("mine.toml", &text).unwrap();
    let ways = [commands_mm(0.001, 5.0, 77), commands_mm(0.001, 5.0, 78)];
    let mut plants = [&machine, &mine].map(|machine| Plant::<2>::new(machine, [0.0; 2]));
    let mut square = 0.0;
    for (x, y) in ways[0].iter().zip(&ways[1]) {
        let [a, b] = plants
            .each_mut()
            .map(|plant| plant.step([*x, *y]).position_mm);
        square += (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
    }
    // The disturbance of 25 Hz, 0.1 N m, is 1.1 um RMS in each axis, and the file does not have it.
    let rms_um = 1e3 * (square / (2.0 * ways[0].len() as f64)).sqrt();
    assert!(rms_um < 2.5, "{rms_um} um");
}

/// Returns tnv40 without disturbance, with commands late by `periods` servo periods and a drive
/// late by `drive_delay_s`.
fn late_machine(periods: u32, drive_delay_s: f64) -> Machine {
    let mut machine = Machine::load("tnv40".as_ref()).unwrap();
    for axis in &mut machine.axes {
        axis.command_delay_s = f64::from(periods) * machine.period.servo_s;
        (axis.drive_delay_s, axis.disturbance_nm) = (drive_delay_s, 0.0);
    }
    machine
}

/// Needs 26 s of processor time: identifies two axes for each delay.
///
/// A delay before the position loop and one behind it differ in the second order only: a log
/// without disturbance shows that.
#[test]
fn the_servo_periods_by_which_commands_are_late_are_found() {
    for (periods, drive_delay_s) in [(0, 0.001), (1, 0.0), (2, 0.0005)]
        .into_iter()
        .skip(part_or_whole(1, 0))
    {
        let machine = late_machine(periods, drive_delay_s);
        let facts = AxisFacts {
            record_delay_s: Some(0.0),
            ..AxisFacts::default()
        };
        let found = identified(
            log_of(&machine, 8.0, 0.0, 5),
            LogJob {
                facts,
                ..LogJob::default()
            },
        );
        let mine = Machine::parse("mine.toml", &machine_text(&found, "mine")).unwrap();
        for (axis, written) in found.machine.axes.iter().zip(&mine.axes) {
            let late_s = axis.axis_model().get(ModelTerm::CommandDelay);
            assert!(
                (late_s - f64::from(periods) * machine.period.servo_s).abs() < 1e-9,
                "{periods}: {late_s} s"
            );
            assert!(
                (written.command_delay_s - late_s).abs() < 1e-9,
                "{} s is written",
                written.command_delay_s
            );
            let loop_s = axis.axis_model().get(ModelTerm::LoopDelay);
            assert!(
                (loop_s - drive_delay_s).abs() < 1e-4,
                "{periods}: {loop_s} s, not {drive_delay_s} s"
            );
        }
    }
}

#[test]
fn gains_that_are_given_scale_the_machine_file_and_nothing_else() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let mut log = log_of(&machine, part_or_whole(4.0, 8.0), 0.0, 3);
    log.axes.truncate(1);
    let is = machine.axes[0];
    let facts = AxisFacts {
        inertia: Some(is.inertia_kg_m2),
        viscous: Some(is.viscous_friction_nm_s),
        lead_mm_per_rev: Some(is.lead_mm_per_rev),
        ..AxisFacts::default()
    };
    let found = identified(
        log,
        LogJob {
            facts,
            ..LogJob::default()
        },
    );
    let mine = Machine::parse("mine.toml", &machine_text(&found, "mine")).unwrap();
    let axis = mine.axes[0];
    assert_near(axis.inertia_kg_m2, is.inertia_kg_m2, 1e-12, "J");
    assert_near(axis.kp_1_s, is.kp_1_s, PRODUCT, "Kp");
    assert_near(axis.kv_nm_s_per_rad, is.kv_nm_s_per_rad, PRODUCT, "Kv");
    assert_near(
        axis.coulomb_friction_nm,
        is.coulomb_friction_nm,
        FRICTION,
        "Fc",
    );
    assert_eq!(mine.axes[1], axis, "a machine has two axes");
}

#[test]
fn a_log_that_moves_one_way_is_open_until_the_other_is_recorded() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let both = commands_mm(0.001, part_or_whole(5.0, 10.0), 31);
    let mut at_mm = 0.0;
    let one_way: Vec<f64> = std::iter::once(0.0)
        .chain(both.windows(2).map(|pair| {
            at_mm += (pair[1] - pair[0]).abs();
            at_mm
        }))
        .collect();
    let facts = AxisFacts {
        record_delay_s: Some(0.0),
        ..AxisFacts::default()
    };
    let of = |commands: Vec<f64>, facts: AxisFacts| {
        let mut log = logged(&machine, [commands.clone(), commands], 1.0, 31);
        log.axes.truncate(1);
        identified(
            log,
            LogJob {
                facts,
                ..LogJob::default()
            },
        )
    };
    let open = of(one_way, facts);
    assert_eq!(
        ModelVerdict::of(&open.machine.axes[0]),
        ModelVerdict::Open,
        "{:?}",
        open.machine.axes[0].unseen
    );
    let words = open.verdict(0);
    assert!(
        words.contains("offset / J") && words.contains("never moves in the negative direction"),
        "{words}"
    );
    let closed = of(both, facts);
    assert_eq!(
        ModelVerdict::of(&closed.machine.axes[0]),
        ModelVerdict::ModelHolds,
        "{:?}",
        closed.machine.axes[0].unseen
    );
}

/// Needs 6 s of processor time: identifies an axis.
#[test]
fn what_is_known_stands_where_a_log_does_not_determine_it() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    // A constant speed determines only Kp and feedforward together, by the following error.
    let steady: Vec<f64> = (0..6000).map(|k| 0.02 * f64::from(k)).collect();
    let mut log = logged(&machine, [steady.clone(), steady], 1.0, 8);
    log.axes.truncate(1);
    let known = |text: &str| Some(text.parse().unwrap());
    let facts = AxisFacts {
        record_delay_s: Some(0.0),
        ..AxisFacts::default()
    };
    let facts = AxisFacts {
        kp_1_s: known("50±1%"),
        velocity_feedforward: known("0"),
        ..facts
    };
    let found = identified(
        log,
        LogJob {
            facts,
            ..LogJob::default()
        },
    );
    assert_near(found.machine.axes[0].values.kp_1_s(), 50.0, 0.03, "Kp");
    assert_eq!(
        found.machine.axes[0]
            .values
            .get(ModelTerm::VelocityFeedforward),
        0.0
    );
}

/// The machine of the file that is written, without noise.
fn as_written(found: &LogIdentified) -> Machine {
    let mut machine = Machine::parse("mine.toml", &machine_text(found, "mine")).unwrap();
    for axis in &mut machine.axes {
        (
            axis.torque_noise_nm,
            axis.encoder_noise_um,
            axis.encoder_step_um,
        ) = (0.0, 0.0, 0.0);
    }
    machine
}

/// RMS by which that machine misses the samples of an axis that were scored, um, and that by which
/// the free run does. What comes in the first half second of a stretch does not count: the machine
/// starts at rest.
fn missed_um(found: &LogIdentified, i: usize) -> [f64; 2] {
    let (machine, axis, log) = (
        as_written(found),
        &found.machine.axes[i],
        &found.log.axes[i],
    );
    let late = axis.axis_model().get(ModelTerm::RecordDelay) / found.log.sample_time_s;
    let (mut squares, mut samples) = ([0.0; 2], 0.0);
    for stretch in &found.log.stretches {
        let (first, last) = (stretch.start as f64, (stretch.end - 1) as f64);
        let mut plant = Plant::<2>::new(&machine, [log.actual_mm[stretch.start]; 2]);
        let mut now_mm = log.actual_mm[stretch.start];
        for k in stretch.clone() {
            let at = (k as f64 - late).clamp(first, last);
            let (before, part) = (at as usize, at.fract());
            let after = (before + 1).min(stretch.end - 1);
            let is_settled = k >= stretch.start + (0.5 / found.log.sample_time_s) as usize;
            if let Some(Some(free_mm)) = axis.scores.simulated_mm.get(k).filter(|_| is_settled) {
                squares[0] += (log.actual_mm[k] - now_mm).powi(2);
                squares[1] += (log.actual_mm[k] - free_mm).powi(2);
                samples += 1.0;
            }
            let command_mm =
                log.command_mm[before] + part * (log.command_mm[after] - log.command_mm[before]);
            now_mm = plant.step([command_mm; 2]).measured_mm[i];
        }
    }
    squares.map(|square: f64| 1e3 * (square / samples).sqrt())
}

/// Strokes of 0.1 mm there and back, in 20 ms to 0.2 s each, and rests between them, mm.
fn pulses_mm(servo_s: f64) -> Vec<f64> {
    let mut way_mm = vec![];
    for reached_s in [0.01, 0.015, 0.02, 0.03, 0.05, 0.1] {
        let steps = (reached_s / servo_s) as usize;
        let up = (0..=2 * steps).map(|k| {
            let part = k as f64 / (2.0 * steps as f64);
            if part < 0.5 {
                2.0 * part * part
            } else {
                1.0 - 2.0 * (1.0 - part) * (1.0 - part)
            }
        });
        let up: Vec<f64> = up.collect();
        let down: Vec<f64> = up.iter().rev().copied().collect();
        for sign in [1.0, -1.0] {
            way_mm.extend(up.iter().chain(&down).map(|part| sign * 0.1 * part));
            way_mm.extend(std::iter::repeat_n(0.0, (0.1 / servo_s) as usize));
        }
    }
    way_mm
}

/// RMS by which the first axes of two machines differ under pulses, um.
fn differ_um(machines: [&Machine; 2]) -> f64 {
    let pulses = pulses_mm(machines[0].period.servo_s);
    let mut plants = machines.map(|machine| Plant::<2>::new(machine, [0.0; 2]));
    let square = |mm: &f64| {
        let [a, b] = plants
            .each_mut()
            .map(|plant| plant.step([*mm; 2]).position_mm[0]);
        (a - b).powi(2)
    };
    1e3 * (pulses.iter().map(square).sum::<f64>() / pulses.len() as f64).sqrt()
}

/// Needs 7 s of processor time: identifies an axis three times.
#[test]
fn a_window_of_the_speed_goes_into_the_machine_file_and_holds_on_pulses() {
    let mut machine = Machine::load("tnv40".as_ref()).unwrap();
    for axis in &mut machine.axes {
        (axis.speed_window_s, axis.speed_held, axis.disturbance_nm) = (0.002, true, 0.0);
    }
    let commands = [41, 42].map(|seed| commands_mm(0.001, part_or_whole(4.0, 8.0), seed));
    let mut log = logged(&machine, commands, 0.2, 4);
    log.axes.truncate(1);
    let given = AxisFacts {
        speed_window_s: Some(0.002),
        record_delay_s: Some(0.0),
        ..AxisFacts::default()
    };
    let of = |facts, before| {
        identified(
            log.clone(),
            LogJob {
                facts,
                before,
                ..LogJob::default()
            },
        )
    };
    let found = of(given, None);
    let mine = as_written(&found);
    assert_eq!(
        (mine.axes[0].speed_window_s, mine.axes[0].speed_held),
        (0.002, true)
    );
    let facts = AxisFacts {
        speed_window_s: None,
        ..given
    };
    let [with, without] =
        [mine, as_written(&of(facts, None))].map(|mine| differ_um([&machine, &mine]));
    assert!(
        with < 0.2 * without,
        "{with} um, and {without} um without the window"
    );
    // Values that the log does not determine stay, and the fit uses them.
    let text = machine_text(&found, "mine");
    let kept = of(facts, Some(Machine::parse("mine.toml", &text).unwrap()));
    assert_eq!(
        kept.machine.axes[0]
            .axis_model()
            .get(ModelTerm::SpeedWindow),
        0.002
    );
    let updated = Machine::parse("mine.toml", &updated_text(&kept, &text).unwrap()).unwrap();
    assert_eq!(
        (updated.axes[0].speed_window_s, updated.axes[0].speed_held),
        (0.002, true)
    );
    let still = differ_um([&machine, &updated]);
    assert!(
        still < 0.5 * without,
        "{still} um by a file that was updated, and {without} um without the window"
    );
}

#[test]
fn the_public_bench_is_what_was_published_of_it() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/corpus/logs/emps.mat");
    if !path.exists() {
        eprintln!("SKIPPED: {} is missing", path.display());
        return;
    }
    let log = Log::read(&path, &Columns::default()).unwrap();
    // Janot, Gautier and Brunot (2019): 35.15 N/V.
    let facts = AxisFacts {
        torque_gain: Some(35.15),
        ..AxisFacts::default()
    };
    let job = LogJob {
        times_s: Some([0.0..12.42, 12.42..25.0]),
        facts,
        ..LogJob::default()
    };
    let found = identified(log, job);
    let axis = &found.machine.axes[0];
    let scores = &axis.scores;
    assert!(
        scores.grey_box.whole_um < 2.0 && scores.grey_box.at_um[2] < 1.5,
        "{:?}",
        scores.grey_box
    );
    assert!(scores.grey_box.at_um[2] < 1.5 * scores.best_arx().at_um[2]);
    assert_eq!(ModelVerdict::of(axis), ModelVerdict::ModelHolds);
    // M 95.11 kg, viscous 203.5 N s/m, Coulomb 20.4 N; kp 160.18 1/s, kv 243.45 V s/m.
    assert_near(
        number(axis, "kp_kv_over_j_1_s2"),
        14_412.0,
        0.01,
        "Kp Kv / J",
    );
    assert_near(
        number(axis, "kv_plus_b_over_j_1_s"),
        92.1,
        0.01,
        "(Kv + B) / J",
    );
    assert_near(number(axis, "fc_over_j_mm_s2"), 214.5, 0.03, "Fc / J");
    let (inertia, _, source) = axis.inertia();
    let m_per_rad = 0.01 / std::f64::consts::TAU;
    assert_near(inertia / (m_per_rad * m_per_rad), 95.11, 0.01, "M");
    assert_eq!(source, NumberSource::TorqueColumn);
    let [written_um, free_um] = missed_um(&found, 0);
    assert!(
        (written_um / free_um - 1.0).abs() < 0.1,
        "{written_um} um by the machine file, {free_um} um by the fit"
    );
    assert!(
        axis.values.get(ModelTerm::LoopGain) > 15_000.0,
        "without the torque the drive seems to know the speed"
    );
}
