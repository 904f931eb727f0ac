//! A log of a cut has the contour error that the cut had, and a log of anything else is refused
//! with its reason.

use std::ops::Range;
use std::path::{Path, PathBuf};

use feedwright::{BASELINE, CONTROLLERS, Choices, MeasuredError, Setup, Statistics, measured};
use feedwright_gcode::{Reader, Settings};
use feedwright_ident::{Fitness, Log, LogAxis, LogFinding, LogFormat, TorqueUnit};
use feedwright_sim::{Machine, Row, Run, RunResult, Stages, path_steps};

fn part(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../parts/{name}.ngc"))
}

fn steps(name: &str) -> feedwright_plan::Steps<'static> {
    path_steps(
        Reader::open(&part(name), Settings::default())
            .unwrap()
            .map_while(Result::ok),
    )
}

fn tnv40() -> Machine {
    Machine::load("tnv40".as_ref()).unwrap()
}

/// The part, cut uncorrected: its rows, and what the run said.
fn cut(name: &str) -> (Vec<Row>, Statistics, RunResult) {
    let machine = tnv40();
    let choices = Choices::default();
    let mut setup = Setup::new(&machine, &choices);
    let mut controller = CONTROLLERS.find(BASELINE).unwrap().in_plane(&mut setup);
    let (mut rows, mut statistics) = (Vec::new(), Statistics::new());
    let run = Run::on(&machine)
        .cut(
            || Ok(steps(name)),
            &mut *controller,
            &mut [&mut rows, &mut statistics],
        )
        .unwrap();
    (rows, statistics, run)
}

/// Rows as a recorder has them, in coordinates that are shifted.
fn log(rows: &[Row], shift_mm: [f64; 2]) -> Log {
    let axis = |name: &str, i: usize| LogAxis {
        name: name.to_owned(),
        command_mm: rows
            .iter()
            .map(|row| row.path_mm[i] + shift_mm[i])
            .collect(),
        actual_mm: rows.iter().map(|row| row.act_mm[i] + shift_mm[i]).collect(),
        torque: None,
        torque_unit: TorqueUnit::Unknown,
        step_mm: 0.0,
        verdict: Fitness::ForControl,
    };
    Log {
        format: LogFormat::TextTable,
        sample_time_s: 0.001,
        stretches: vec![Range {
            start: 0,
            end: rows.len(),
        }],
        time_s: rows.iter().map(|row| row.t_s).collect(),
        axes: vec![axis("x", 0), axis("y", 1)],
        still: Vec::new(),
        findings: Vec::new(),
    }
}

fn compared(log: &Log, name: &str) -> Result<(Statistics, RunResult), MeasuredError> {
    let machine = tnv40();
    let mut reference = Stages::of(&machine)
        .reference(steps(name), &machine)
        .unwrap();
    let mut statistics = Statistics::new();
    measured(
        log,
        &machine,
        2,
        &mut reference,
        &mut [&mut statistics],
        &(),
    )
    .map(|found| (statistics, found.run))
}

#[test]
fn a_log_has_the_contour_error_of_the_cut() {
    for name in ["circle", "star", "square", "eight", "slot"] {
        let (rows, simulated, run) = cut(name);
        for shift_mm in [[0.0; 2], [-123.4, 56.7]] {
            let (found, result) = compared(&log(&rows, shift_mm), name).unwrap();
            for (measured_um, simulated_um) in [
                (found.rms_um(), simulated.rms_um()),
                (found.max_um(), simulated.max_um()),
                (1e3 * result.uncut_mm, 1e3 * run.uncut_mm),
            ] {
                // The shift is known as well as two boxes that are sampled apart fill each other.
                assert!(
                    (measured_um / simulated_um - 1.0).abs() < 0.01,
                    "{name} {shift_mm:?}: {measured_um} {simulated_um}; {} {} {}",
                    found.rms_um(),
                    found.max_um(),
                    result.uncut_mm
                );
            }
            assert!(
                result.time_s <= run.time_s + 0.002,
                "{name}: {} {}",
                result.time_s,
                run.time_s
            );
        }
    }
}

#[test]
fn a_log_of_another_program_is_refused() {
    let (rows, ..) = cut("star");
    let other = compared(&log(&rows, [0.0; 2]), "circle");
    assert!(matches!(
        other,
        Err(MeasuredError::NotBegun { .. } | MeasuredError::Leaves { .. })
    ));
    let (rows, ..) = cut("circle");
    // The circle begins where it does not, and leaves it.
    let mut wrong = log(&rows, [0.0; 2]);
    let half = rows.len() / 2;
    wrong.axes[0].command_mm[half..]
        .iter_mut()
        .for_each(|x_mm| *x_mm += 5.0);
    assert!(
        matches!(compared(&wrong, "circle"), Err(MeasuredError::Leaves { off_mm, .. }) if off_mm > 1.0)
    );
}

#[test]
fn half_a_log_and_one_with_a_gap_or_without_an_axis_are_refused() {
    let (rows, ..) = cut("circle");
    let half = log(&rows[..rows.len() / 2], [0.0; 2]);
    assert!(
        matches!(compared(&half, "circle"), Err(MeasuredError::EndsEarly { share, .. }) if (0.3..0.7).contains(&share))
    );
    let mut gap = log(&rows, [0.0; 2]);
    gap.stretches = vec![0..100, 100..rows.len()];
    assert!(matches!(
        compared(&gap, "circle"),
        Err(MeasuredError::Gap { .. })
    ));
    let mut without = log(&rows, [0.0; 2]);
    without.axes.pop();
    let message = compared(&without, "circle").unwrap_err().to_string();
    assert_eq!(
        message,
        "the log has no axis y, which the program moves; it has x"
    );
}

/// A program that goes along one axis only, its log, and the columns of the other: without record,
/// standing still with noise, or without names.
#[test]
fn an_axis_that_stands_still_in_the_program_need_not_be_in_the_log() {
    let machine = tnv40();
    let program = |axis: char| format!("G21 G90 G64\nG0 X0 Y0\nG1 {axis}20 F1200\n{axis}0\nM2\n");
    for (axis, i) in [('X', 0), ('Y', 1)] {
        let steps = || {
            path_steps(
                Reader::from_text("line.ngc", program(axis), Settings::default())
                    .unwrap()
                    .map_while(Result::ok),
            )
        };
        let choices = Choices::default();
        let mut setup = Setup::new(&machine, &choices);
        let mut controller = CONTROLLERS.find(BASELINE).unwrap().in_plane(&mut setup);
        let mut rows = Vec::new();
        Run::on(&machine)
            .cut(|| Ok(steps()), &mut *controller, &mut [&mut rows])
            .unwrap();
        let compared = |log: &Log| {
            let mut reference = Stages::of(&machine).reference(steps(), &machine).unwrap();
            let mut statistics = Statistics::new();
            let found = measured(
                log,
                &machine,
                2,
                &mut reference,
                &mut [&mut statistics],
                &(),
            )
            .unwrap();
            (statistics.max_um(), found.findings)
        };
        let whole = log(&rows, [0.0, 700.0]);
        let (expected_um, findings) = compared(&whole);
        assert!(findings.is_empty(), "{findings:?}");
        let alone = |name: &str, findings: Vec<LogFinding>| Log {
            axes: vec![LogAxis {
                name: name.to_owned(),
                ..whole.axes[i].clone()
            }],
            findings,
            ..whole.clone()
        };
        let still = LogFinding::TakenAsStill {
            axis: if i == 0 { "y" } else { "x" }.to_owned(),
        };
        // As if the axis that is not there had been where its command was.
        let mut held = whole.clone();
        held.axes[1 - i]
            .actual_mm
            .clone_from(&whole.axes[1 - i].command_mm);
        let held_um = compared(&held).0;
        assert!(held_um < expected_um, "{axis}: {held_um} {expected_um}");
        let is_held = |log: &Log, findings: &[LogFinding]| {
            let (found_um, reported) = compared(log);
            assert!(
                (found_um - held_um).abs() < 1e-6 && reported == findings,
                "{axis}: {found_um} {held_um} {reported:?}"
            );
        };
        is_held(&alone(["x", "y"][i], vec![]), std::slice::from_ref(&still));
        let kept = Log {
            still: vec![whole.axes[1 - i].clone()],
            ..alone(["x", "y"][i], vec![])
        };
        assert_eq!(compared(&kept), (expected_um, vec![]), "{axis}");
        // Columns without names: the only axis that moves is the only one that the program moves.
        let guessed = LogFinding::AxisColumns {
            axis: "x".to_owned(),
            command: "1".to_owned(),
            actual: "2".to_owned(),
            torque: None,
            torque_unit: TorqueUnit::Unknown,
            by_data: true,
        };
        let mut reported = vec![still];
        if i == 1 {
            reported.push(LogFinding::TakenFor {
                axis: "x".to_owned(),
                program: "y".to_owned(),
            });
        }
        is_held(&alone("x", vec![guessed]), &reported);
    }
}
