//! Logs of real machines: rates, sizes and following errors that other programs found in the same files.

use std::path::{Path, PathBuf};

use feedwright::log::columns::Columns;
use feedwright::log::{Log, LogAxis, LogError};

/// A file of the corpus; none, loudly, where there is no corpus.
fn file(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/corpus/logs").join(name);
    if !path.exists() {
        eprintln!("SKIPPED: {} is missing", path.display());
        return None;
    }
    Some(path)
}

fn read(path: &Path) -> Result<Log, LogError> {
    let log = Log::read(path, &Columns::default());
    match &log {
        Ok(log) => {
            println!("{} {} s, {} samples, {:?}", log.format, log.sample_time_s, log.time_s.len(), log.stretches);
            log.findings.iter().for_each(|finding| println!("  {finding}"));
            log.axes.iter().for_each(|axis| println!("  {} {} {:?}", axis.name, axis.step_mm, axis.verdict));
        }
        Err(error) => println!("{:?}", miette::Report::msg(format!("{error} {error:?}"))),
    }
    log
}

/// RMS of command minus actual position over a range of samples, um.
fn following_um(axis: &LogAxis, range: std::ops::Range<usize>) -> f64 {
    let count = range.len() as f64;
    let sum: f64 = range.map(|k| (axis.command_mm[k] - axis.actual_mm[k]).powi(2)).sum();
    1e3 * (sum / count).sqrt()
}

#[test]
fn emps_is_read_without_options() {
    let Some(path) = file("emps.mat") else { return };
    let log = read(&path).unwrap();
    let n = log.time_s.len();
    println!("{}", following_um(&log.axes[0], n / 2..n));
}

#[test]
fn all_of_them() {
    for name in [
        "LinA_no-pp-sine-sweep-10mm-0.5Hz.txt",
        "LinD_no-pp-sine-sweep-10mm-0.5Hz.txt",
        "LinA_no-load-square-wave-full-travel-1Hz.txt",
        "experiment_01.csv",
        "sinumerik-edge.json",
    ] {
        let Some(path) = file(name) else { return };
        if let Ok(log) = read(&path) {
            println!("{}", following_um(&log.axes[0], 0..log.time_s.len()));
        }
    }
}
