//! Programs that no planner likes: axes that move along, events and dwells between, ends in the
//! middle, very many very short blocks.

use crate::sweep::part_or_whole;
use feedwright::{CycleTime, CycleTimeOptions, cycle_time, cycle_time_by};
use feedwright_gcode::{Reader, Settings};
use feedwright_plan::{Constraints, feed_planner};
use feedwright_sim::{Machine, Stages, path_steps};

/// Blocks of 1 um: a twentieth of a million, in a few seconds, and a million.
const MICROMETRES: u32 = 50_000;
const MILLION: u32 = 1_000_000;

fn machine() -> Machine {
    let mut machine = Machine::load("tnv40".as_ref()).unwrap();
    machine.limits.rapid_mm_s = 200.0;
    machine.limits.path_tolerance_um = Some(10.0);
    for axis in &mut machine.axes {
        axis.max_velocity_mm_s = Some(200.0);
        axis.max_accel_mm_s2 = Some(2000.0);
        axis.max_jerk_mm_s3 = Some(50_000.0);
    }
    machine
}

fn planned(machine: &Machine, program: &str) -> CycleTime {
    let steps = || {
        Ok(path_steps(
            Reader::from_text("program", program, Settings::default())?.map_while(Result::ok),
        ))
    };
    let found = cycle_time(machine, false, steps, &()).unwrap();
    assert_eq!(found.planner, "time-optimal");
    assert!(found.time_s.is_finite() && found.time_s >= 0.0, "{found:?}");
    assert!(
        found.largest_violation.unwrap_or(0.0) <= 1.0 + 1e-6,
        "{found:?}"
    );
    assert!(found.largest_deviation_um <= 10.1, "{found:?}");
    found
}

/// The same with any tolerance.
fn planned_within(machine: &Machine, program: &str) -> CycleTime {
    let steps = || {
        Ok(path_steps(
            Reader::from_text("program", program, Settings::default())?.map_while(Result::ok),
        ))
    };
    let found = cycle_time(machine, false, steps, &()).unwrap();
    assert!(
        found.largest_violation.unwrap_or(0.0) <= 1.0 + 1e-6,
        "{found:?}"
    );
    found
}

#[test]
fn rotary_axes_along_hold_the_speed_down() {
    let mut machine = machine();
    machine.plc.rotary_deg_s = 10.0;
    let alone = planned(&machine, "G21 G90 G1 F6000 X20 Y5\nX40 Y0\nM2\n");
    let along = planned(&machine, "G21 G90 G1 F6000 X20 Y5 A45\nX40 Y0 A90\nM2\n");
    assert!(
        along.cutting_s >= 9.0 && alone.cutting_s < 2.0,
        "{} {}",
        along.cutting_s,
        alone.cutting_s
    );
}

#[test]
fn events_and_dwells_between_are_rests_and_nothing_else_is_lost() {
    let machine = machine();
    let through = planned(
        &machine,
        "G21 G90 G64 P0.01 G1 F6000 X10\nX20\nX20 Y10\nM2\n",
    );
    let stopped = planned(
        &machine,
        "G21 G90 G64 P0.01 G1 F6000 X10\nM8\nG4 P0.5\nX20\nM62 P1\nX20 Y10\nM9\nM2\n",
    );
    assert_eq!(through.blocks, stopped.blocks);
    assert!(stopped.waiting_s >= 0.5, "{stopped:?}");
    assert!(
        stopped.cutting_s > through.cutting_s,
        "{} {}",
        stopped.cutting_s,
        through.cutting_s
    );
}

#[test]
fn a_truncated_program_ends_at_rest_where_it_ends() {
    let machine = machine();
    let whole = "G21 G90 G1 F6000 X10 Y3\nX20 Y0\nX30 Y8\nM2\n";
    // A file without a byte is refused by the reader.
    for length in 1..whole.len() {
        let text = &whole[..length];
        let found = planned(&machine, text);
        assert!(found.cutting_s < 2.0, "{text}: {found:?}");
    }
}

/// A straight line at 100 mm/s.
#[test]
fn very_many_blocks_of_a_micrometre_take_the_time_of_one() {
    use std::fmt::Write;
    let (machine, micrometres) = (machine(), part_or_whole(MICROMETRES, MILLION));
    let mut program = "G21 G90 G64 P0.01 F6000\n".to_owned();
    for i in 1..=micrometres {
        writeln!(program, "G1 X{:.3}", f64::from(i) * 1e-3).unwrap();
    }
    let short = planned(&machine, &program);
    let one = planned(
        &machine,
        &format!("G21 G90 G64 P0.01 F6000\nG1 X{}\n", micrometres / 1000),
    );
    assert_eq!((short.blocks, one.blocks), (u64::from(micrometres), 1));
    assert!(
        (short.time_s / one.time_s - 1.0).abs() < 2e-3,
        "{} {}",
        short.time_s,
        one.time_s
    );
}

#[test]
fn memory_does_not_grow_with_the_number_of_blocks() {
    let machine = machine();
    // Blocks of 1 um in a loop, so that the text does not grow either; at 20 mm/s the look-ahead
    // holds some 12,000 of them.
    let memory = |blocks: u32| {
        let program =
            format!("G21 G91 G64 P0.01 F1200\no1 repeat [{blocks}]\nG1 X0.001\no1 endrepeat\nM2\n");
        let settings = || Settings {
            max_motions: u64::from(MILLION),
            ..Settings::default()
        };
        let steps = || {
            Ok(path_steps(
                Reader::from_text("program", program.as_str(), settings())?.map_while(Result::ok),
            ))
        };
        let measured = allocation_counter::measure(|| {
            let found = cycle_time(&machine, false, steps, &()).unwrap();
            assert_eq!(found.blocks, u64::from(blocks));
        });
        measured.bytes_max
    };
    let [short, long] = [MICROMETRES, 3 * MICROMETRES].map(memory);
    assert!(long as f64 <= 1.05 * short as f64, "{short} {long} bytes");
}

#[test]
fn a_negative_tolerance_is_refused_with_its_place() {
    let program = "G21 G90 G64 P-0.01 F6000\nG1 X20\n";
    let fault = Reader::from_text("program", program, Settings::default())
        .unwrap()
        .find_map(Result::err)
        .unwrap();
    assert!(
        fault.to_string().contains("tolerance P of G64 is negative"),
        "{fault}"
    );
}

#[test]
fn invalid_limits_are_refused_by_name() {
    let wrong = [
        0.0,
        -1.0,
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        1e-9,
        1e15,
    ];
    type Set = fn(&mut Machine, f64);
    let keys: [(&str, Set); 4] = [
        ("max_velocity_mm_s", |machine, value| {
            machine.axes[1].max_velocity_mm_s = Some(value);
        }),
        ("max_accel_mm_s2", |machine, value| {
            machine.axes[1].max_accel_mm_s2 = Some(value);
        }),
        ("max_jerk_mm_s3", |machine, value| {
            machine.axes[1].max_jerk_mm_s3 = Some(value);
        }),
        ("path_tolerance_um", |machine, value| {
            machine.limits.path_tolerance_um = Some(value);
        }),
    ];
    for (name, set) in keys {
        for value in wrong {
            let mut machine = machine();
            set(&mut machine, value);
            let steps = || {
                Ok(path_steps(
                    Reader::from_text("program", "G1 F600 X1\nM2\n", Settings::default())?
                        .map_while(Result::ok),
                ))
            };
            let stages = Stages {
                planner: feed_planner("time-optimal").unwrap(),
            };
            let constraints = Constraints::from(&machine);
            let refused = cycle_time_by(
                stages,
                &machine,
                &constraints,
                CycleTimeOptions::default(),
                steps,
                &(),
            )
            .unwrap_err()
            .to_string();
            assert!(refused.contains(name), "{name} = {value}: {refused}");
        }
    }
}

#[test]
fn helices_and_arcs_of_all_planes_and_full_reversals_are_planned() {
    let machine = machine();
    let program = "G21 G90 G64 P0.01 F6000\nG1 X10\nG2 X20 Y0 Z5 I5 J0 P3\nG18 G3 X30 Z5 I5 K0\nG19 G2 Y10 Z5 J5 K0\nG17 G1 X40\nX20\nX40\nM2\n";
    let found = planned(&machine, program);
    assert!(found.blocks >= 7 && found.cutting_s > 1.0, "{found:?}");
}

#[test]
fn g64_is_not_slower_than_stopping_at_every_end_and_a_larger_p_not_slower_than_a_smaller() {
    let machine = machine();
    let program = |mode: &str| {
        format!("G21 G90 {mode} F12000\nG1 X20\nY20\nX11 Y11\nX0 Y20\nG2 X0 Y0 I0 J-10\nM2\n")
    };
    let time_s = |mode: &str| {
        let found = planned_within(&machine, &program(mode));
        found.cutting_s
    };
    let [stops, path] = ["G61.1", "G61"].map(time_s);
    let times = [
        "G64 P0.001",
        "G64 P0.003",
        "G64 P0.01",
        "G64 P0.03",
        "G64 P0.1",
    ]
    .map(time_s);
    assert!(
        path <= 1.001 * stops && times[0] <= 1.001 * stops,
        "{stops} {path} {times:?}"
    );
    assert!(
        times.windows(2).all(|pair| pair[1] <= 1.001 * pair[0]),
        "{times:?}"
    );
    // Bare G64 has the tolerance of the machine, and so does P of the same.
    assert!((time_s("G64") / times[2] - 1.0).abs() < 1e-9);
    assert!((time_s("G64 P0.01 Q0.01") / times[2] - 1.0).abs() < 1e-9);
}
