//! A corrected program delivers what is told of it: its text keeps the lines of the original, and is better as the control cuts it.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use std::path::Path;

use feedwright::correct::{CorrectJob, CorrectOutcome, TARGETS, TargetControl};
use feedwright::gcode::canon::Canon;
use feedwright::gcode::{Reader, Settings};
use feedwright::machine::Machine;

fn corrected(text: &str, target: &'static TargetControl) -> CorrectOutcome {
    let folder = tempfile::tempdir().unwrap();
    let part = folder.path().join("part.ngc");
    std::fs::write(&part, text).unwrap();
    job(&part, target).run(&()).unwrap()
}

fn job(part: &Path, target: &'static TargetControl) -> CorrectJob {
    // LinuxCNC plans by the limits of each axis.
    let machine =
        if target.planner == Some("linuxcnc") { with_axis_limits() } else { Machine::load("tnv40".as_ref()).unwrap() };
    CorrectJob { part: part.to_owned(), machine, believed: None, target, reader: Settings::default() }
}

fn with_axis_limits() -> Machine {
    let axis = |name: &str| {
        format!("[axis.{name}]\nmax_velocity_mm_s = 200\nmax_accel_mm_s2 = 2000\nmax_jerk_mm_s3 = 50000\n")
    };
    let axes: String = ["x", "y", "z"].map(axis).concat();
    let head =
        "base = \"tnv40\"\nname = \"limited\"\ndescription = \"tnv40 with limits of its axes\"\nsource = \"a test\"\n";
    Machine::parse("limited", &format!("{head}{axes}[limits]\npath_tolerance_um = 10\n")).unwrap()
}

/// Motions and events of a text.
fn steps(text: &str) -> Vec<Canon> {
    Reader::from_text("part.ngc", text, Settings::default()).unwrap().map(Result::unwrap).collect()
}

fn end(text: &str) -> [f64; 3] {
    let last = steps(text)
        .into_iter()
        .rev()
        .find_map(|step| if let Canon::Motion(motion) = step { Some(motion.end_mm) } else { None });
    last.unwrap()
}

#[test]
fn a_circle_is_cut_open_loop_with_a_twentieth_of_its_error_for_every_control() {
    for target in TARGETS {
        let outcome = corrected("G21 G90 G64\nG0 X0 Y0\nG2 X0 Y0 I6 J0 F2400\nM2\n", target);
        let (was, is) = (outcome.original, outcome.corrected);
        let name = target.name;
        assert_eq!(outcome.refusal, None, "{name}");
        // Steps of 1 um are as large as what is left.
        let part = if target.decimals > 3 { 0.05 } else { 0.1 };
        assert!(is.rms_um < part * was.rms_um && is.max_um < 2.0 * part * was.max_um, "{name}: {is:?} {was:?}");
        assert!(is.time_s < 1.04 * was.time_s && is.blocks < 31, "{name}: {is:?} {was:?}");
        assert!(outcome.program.unwrap().lines().all(|line| line.len() <= target.columns));
    }
}

#[test]
fn a_control_that_plans_by_axes_needs_their_limits() {
    let folder = tempfile::tempdir().unwrap();
    let part = folder.path().join("part.ngc");
    std::fs::write(&part, "G21 G90 G64\nG2 X0 Y0 I6 J0 F2400\nM2\n").unwrap();
    let target = TargetControl::find("linuxcnc").unwrap();
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let error = CorrectJob { machine, ..job(&part, target) }.run(&()).unwrap_err();
    assert_eq!(error.to_string(), "linuxcnc plans by the limits of each axis, and the machine `tnv40` has none");
}

#[test]
fn lines_that_need_no_change_stay_and_what_they_say_still_holds() {
    let text = "%\n(part)\nN10 G21 G17 G90 G94 G64 S900\nN20 T1 M6\nN30 M3\nN40 G0 Z5\n(the cut)\nN50 G0 X1 Y0\nN60 G1 Z-1 F300\n\
                N70 G3 X1 Y0 I-5 J0 F2400 (around)\nN80 G3 X1 Y0 I-5 J0 M8\nN90 Z5 I-5 J0\nN95 M9\nN100 G81 X20 Y5 Z-3 R1 F200\nN110 G80 G0 Z20\nN120 M30\n%\n";
    let outcome = corrected(text, &TARGETS[0]);
    let program = outcome.program.clone().unwrap();
    assert!(!outcome.expanded && outcome.corrected.rms_um < 0.5 * outcome.original.rms_um, "{outcome:?}");
    for kept in [
        "(part)",
        "N10 G21 G17 G90 G94 G64 S900",
        "N20 T1 M6",
        "N100 G81 X20 Y5 Z-3 R1 F200",
        "N110 G80 G0 Z20",
        "(around)",
        "N95 M9",
    ] {
        assert!(program.lines().any(|line| line == kept), "{kept}\n{program}");
    }
    assert!(program.starts_with("%\n(corrected by feedwright"), "{program}");
    assert_eq!(end(&program), end(text));
    let events = |text: &str| steps(text).iter().filter(|step| matches!(step, Canon::Event(_))).count();
    assert!(events(&program) > events(text), "no dwell at a corner\n{program}");
}

#[test]
fn units_distances_and_offsets_of_the_place_are_kept() {
    let millimetres = corrected("G21 G90 G64\nG0 X30 Y-5\nG2 X42 Y-5 I6 J0 F2400\nM2\n", &TARGETS[0]);
    let inches = "G20 G91 G64\nG0 X1 Y0\nG92 X0 Y0\nG2 X0.5 Y0 I0.25 J0 F90\nG1 X0.2\nM2\n";
    let outcome = corrected(inches, &TARGETS[0]);
    let program = outcome.program.clone().unwrap();
    assert!(!outcome.expanded && millimetres.program.is_some());
    assert!(program.contains("\nG90\n") && program.contains("\nG91\n"), "{program}");
    let gap = (0..3).map(|i| (end(&program)[i] - end(inches)[i]).abs()).fold(0.0, f64::max);
    assert!(gap < 1e-4, "{gap}\n{program}");
    assert!(outcome.corrected.rms_um < 0.2 * outcome.original.rms_um, "{outcome:?}");
}

#[test]
fn a_loop_is_written_out_and_says_so() {
    let text = "G21 G90 G64 F2400\n#1=0\no1 while [#1 LT 2]\nG2 X0 Y0 I6 J0\n#1=[#1+1]\no1 endwhile\nM2\n";
    let outcome = corrected(text, &TARGETS[0]);
    let program = outcome.program.clone().unwrap();
    assert!(outcome.expanded && program.contains("(expanded:") && !program.contains("while"), "{program}");
    assert!(outcome.corrected.rms_um < 0.1 * outcome.original.rms_um);
}

#[test]
fn what_cannot_get_better_is_refused_with_a_reason() {
    let outcome = corrected("G21 G90 G64\nG1 X40 F300\nM2\n", &TARGETS[0]);
    assert_eq!(outcome.program, None);
    assert!(outcome.refusal.is_some(), "{outcome:?}");
}
