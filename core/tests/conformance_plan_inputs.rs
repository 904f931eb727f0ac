//! Programs that no planner likes: axes that move along, events and dwells between, ends in the middle, very many very short blocks.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use feedwright::cycle_time::{CycleTime, cycle_time};
use feedwright::gcode::{Reader, Settings};
use feedwright::machine::Machine;
use feedwright::pipeline::pieces;

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
    let steps = || Ok(pieces(Reader::from_text("program", program, Settings::default())?.map_while(Result::ok)));
    let found = cycle_time(machine, false, steps, &()).unwrap();
    assert_eq!(found.planner, "time-optimal");
    assert!(found.time_s.is_finite() && found.time_s >= 0.0, "{found:?}");
    assert!(found.largest_violation.unwrap_or(0.0) <= 1.0 + 1e-6, "{found:?}");
    assert!(found.largest_deviation_um <= 10.1, "{found:?}");
    found
}

#[test]
fn rotary_axes_along_hold_the_speed_down() {
    let mut machine = machine();
    machine.plc.rotary_deg_s = 10.0;
    let alone = planned(&machine, "G21 G90 G1 F6000 X20 Y5\nX40 Y0\nM2\n");
    let along = planned(&machine, "G21 G90 G1 F6000 X20 Y5 A45\nX40 Y0 A90\nM2\n");
    assert!(along.cutting_s >= 9.0 && alone.cutting_s < 2.0, "{} {}", along.cutting_s, alone.cutting_s);
}

#[test]
fn events_and_dwells_between_are_rests_and_nothing_else_is_lost() {
    let machine = machine();
    let through = planned(&machine, "G21 G90 G64 P0.01 G1 F6000 X10\nX20\nX20 Y10\nM2\n");
    let stopped = planned(&machine, "G21 G90 G64 P0.01 G1 F6000 X10\nM8\nG4 P0.5\nX20\nM62 P1\nX20 Y10\nM9\nM2\n");
    assert_eq!(through.blocks, stopped.blocks);
    assert!(stopped.waiting_s >= 0.5, "{stopped:?}");
    assert!(stopped.cutting_s > through.cutting_s, "{} {}", stopped.cutting_s, through.cutting_s);
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

#[test]
fn very_many_blocks_of_a_micrometre_take_the_time_of_one() {
    use std::fmt::Write;
    let machine = machine();
    let mut program = "G21 G90 G64 P0.01 F6000\n".to_owned();
    for i in 1..=20_000 {
        writeln!(program, "G1 X{:.3}", f64::from(i) * 1e-3).unwrap();
    }
    let short = planned(&machine, &program);
    let one = planned(&machine, "G21 G90 G64 P0.01 F6000\nG1 X20\n");
    assert_eq!((short.blocks, one.blocks), (20_000, 1));
    assert!((short.time_s / one.time_s - 1.0).abs() < 2e-3, "{} {}", short.time_s, one.time_s);
}

#[test]
fn a_negative_tolerance_is_refused_with_its_place() {
    let program = "G21 G90 G64 P-0.01 F6000\nG1 X20\n";
    let fault = Reader::from_text("program", program, Settings::default()).unwrap().find_map(Result::err).unwrap();
    assert!(fault.to_string().contains("tolerance P of G64 is negative"), "{fault}");
}
