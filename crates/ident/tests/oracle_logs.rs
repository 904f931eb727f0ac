//! Logs of real machines: rates, stretches and following errors that were computed from the same
//! files by other means.

use std::ops::Range;
use std::path::{Path, PathBuf};

use feedwright_ident::{
    Columns, Fitness, Log, LogAxis, LogError, LogFinding, LogFormat, RefusalReason, TorqueUnit,
};

/// A file of the corpus; none, loudly, where there is no corpus.
fn file(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/corpus/logs")
        .join(name);
    if !path.exists() {
        eprintln!("SKIPPED: {} is missing", path.display());
        return None;
    }
    Some(path)
}

fn read(path: &Path) -> Result<Log, LogError> {
    let log = Log::read(path, &Columns::default());
    match &log {
        Ok(log) => log
            .findings
            .iter()
            .for_each(|finding| println!("{finding}")),
        Err(error) => println!("{error:?}"),
    }
    log
}

/// RMS of command minus actual position over a range of samples, um.
fn following_um(axis: &LogAxis, range: Range<usize>) -> f64 {
    let count = range.len() as f64;
    let sum: f64 = range
        .map(|k| (axis.command_mm[k] - axis.actual_mm[k]).powi(2))
        .sum();
    1e3 * (sum / count).sqrt()
}

/// Standard deviation of the same, um.
fn deviation_um(axis: &LogAxis, range: Range<usize>) -> f64 {
    let count = range.len() as f64;
    let mean_um = 1e3
        * range
            .clone()
            .map(|k| axis.command_mm[k] - axis.actual_mm[k])
            .sum::<f64>()
        / count;
    (following_um(axis, range).powi(2) - mean_um * mean_um).sqrt()
}

/// Compares two numbers to the known digits.
fn assert_um(found: f64, expected: f64) {
    assert!(
        (found - expected).abs() <= 0.5,
        "{found} um, not {expected}"
    );
}

#[test]
fn emps_is_read_without_options() {
    let Some(path) = file("emps.mat") else { return };
    let log = read(&path).unwrap();
    assert_eq!(
        (log.format, log.sample_time_s, log.stretches.len()),
        (LogFormat::Matlab, 1e-3, 1)
    );
    let [axis] = &log.axes[..] else {
        panic!("{} axes", log.axes.len())
    };
    let count = log.time_s.len();
    assert!(
        (24.0..26.0).contains(&log.time_s[count - 1]),
        "{} s",
        log.time_s[count - 1]
    );
    assert_um(following_um(axis, count / 2..count), 578.0);
    assert_eq!(
        (axis.torque_unit, &axis.verdict),
        (TorqueUnit::Volt, &Fitness::ForControl)
    );
}

#[test]
fn sinumerik_is_read_without_options_and_has_one_gap() {
    let Some(path) = file("sinumerik-edge.json") else {
        return;
    };
    let log = read(&path).unwrap();
    assert_eq!(
        (log.format, log.sample_time_s, log.stretches.len()),
        (LogFormat::SinumerikEdge, 2e-3, 2)
    );
    let recorded_s = log.time_s.len() as f64 * log.sample_time_s;
    assert!((7.5..7.7).contains(&recorded_s), "{recorded_s} s");
    assert_eq!(log.axes[0].torque_unit, TorqueUnit::NewtonMetre);
    // The signal called Z1 covers 64 m, too much for a linear axis, so it is left out.
    assert_eq!(
        log.axes
            .iter()
            .map(|axis| axis.name.as_str())
            .collect::<Vec<_>>(),
        ["x", "y"]
    );
    // Behind the gap: RMS, and deviation from the mean.
    for (name, rms_um, expected_um) in [("x", 413.0, 399.0), ("y", 1556.0, 1328.0)] {
        let axis = log.axes.iter().find(|axis| axis.name == name).unwrap();
        assert_um(following_um(axis, log.stretches[1].clone()), rms_um);
        assert_um(deviation_um(axis, log.stretches[1].clone()), expected_um);
        assert_eq!(axis.verdict, Fitness::ForControl, "{name}");
    }
}

#[test]
fn sine_sweeps_of_linear_actuators_are_accepted() {
    for (name, expected_um, limit_mm_s) in [("LinA", 2311.0, 48.0), ("LinD", 1463.0, 98.0)] {
        let Some(path) = file(&format!("{name}_no-pp-sine-sweep-10mm-0.5Hz.txt")) else {
            return;
        };
        let log = read(&path).unwrap();
        assert_eq!(
            (log.format, log.sample_time_s, log.stretches.len()),
            (LogFormat::TextTable, 1e-2, 1)
        );
        assert_um(following_um(&log.axes[0], 0..log.time_s.len()), expected_um);
        assert_eq!(log.axes[0].verdict, Fitness::ForControl, "{name}");
        let limits: Vec<f64> = log
            .findings
            .iter()
            .filter_map(|finding| match finding {
                LogFinding::SpeedLimit { limit_mm_s, .. } => Some(*limit_mm_s),
                _ => None,
            })
            .collect();
        let [found] = limits[..] else {
            panic!("{limits:?}")
        };
        // A fit of the whole model finds the limit to 2 mm/s; the finding of the log reader is good
        // to a tenth.
        assert!(
            (found / limit_mm_s - 1.0).abs() < 0.1,
            "{name}: {found} mm/s, not {limit_mm_s}"
        );
    }
}

#[test]
fn a_square_wave_at_an_uneven_clock_is_not_for_control() {
    let Some(path) = file("LinA_no-load-square-wave-full-travel-1Hz.txt") else {
        return;
    };
    let log = read(&path).unwrap();
    assert_um(following_um(&log.axes[0], 0..log.time_s.len()), 26.0);
    assert_eq!(log.axes[0].step_mm, 0.01);
    let Fitness::NotForControl { reason } = &log.axes[0].verdict else {
        panic!("it is taken for control")
    };
    assert!(
        reason.contains("steps of 10 um") && reason.contains("from 12 to 20 ms"),
        "{reason}"
    );
}

#[test]
fn a_log_at_ten_hertz_with_three_digits_is_refused_for_both() {
    let Some(path) = file("experiment_01.csv") else {
        return;
    };
    let reasons = read(&path).unwrap_err().reasons();
    assert_eq!(reasons[0], RefusalReason::TooSlow);
    assert!(
        reasons[1..]
            .iter()
            .all(|reason| *reason == RefusalReason::TooCoarse)
            && reasons.len() > 1,
        "{reasons:?}"
    );
}
