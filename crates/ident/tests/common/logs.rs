//! Logs of an axis that follows its command 8 ms late and has friction, written as files.

use std::path::PathBuf;

use feedwright_ident::{Columns, Log, LogError};

/// Time between samples, s.
pub(crate) const SAMPLE_S: f64 = 1e-3;
/// Samples.
pub(crate) const SAMPLES: usize = 3000;
/// Lag of the actual position behind the command, s.
pub(crate) const LAG_S: f64 = 8e-3;

/// Command and actual position of an axis, mm, six digits behind the point.
pub(crate) fn axis(amplitude_mm: f64, hz: f64) -> (Vec<f64>, Vec<f64>) {
    let rounded = |value: f64| (value * 1e6).round() / 1e6;
    let command: Vec<f64> = (0..SAMPLES)
        .map(|k| rounded(amplitude_mm * (std::f64::consts::TAU * hz * SAMPLE_S * k as f64).sin()))
        .collect();
    let mut actual = vec![0.0];
    for k in 1..SAMPLES {
        let speed = (command[k] - command[k - 1]).signum();
        let goal: f64 = command[k - 1] - 0.01 * speed;
        let before: f64 = actual[k - 1];
        actual.push(before + (goal - before) * SAMPLE_S / LAG_S);
    }
    (command, actual.into_iter().map(rounded).collect())
}

/// Rows of text with these columns.
pub(crate) fn rows(columns: &[&[f64]], delimiter: &str) -> String {
    let mut text = String::new();
    for k in 0..columns[0].len() {
        let fields: Vec<String> = columns.iter().map(|column| column[k].to_string()).collect();
        text.push_str(&fields.join(delimiter));
        text.push('\n');
    }
    text
}

/// Time of the samples, s.
pub(crate) fn time_s() -> Vec<f64> {
    (0..SAMPLES).map(|k| k as f64 / 1000.0).collect()
}

/// A file with this content, in a folder that goes away.
pub(crate) fn file(content: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    // A name that says nothing: formats are recognised by content.
    let path = folder.path().join("log");
    std::fs::write(&path, content).unwrap();
    (folder, path)
}

/// Reads a log with this content.
pub(crate) fn read(content: &[u8], columns: &str) -> Result<Log, LogError> {
    let (_folder, path) = file(content);
    Log::read(&path, &columns.parse::<Columns>().unwrap())
}

/// All findings, a line each.
pub(crate) fn reported(log: &Log) -> String {
    log.findings
        .iter()
        .map(|finding| format!("{finding}\n"))
        .collect()
}
