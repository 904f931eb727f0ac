//! The machines identified from the logs of the built-in machines, and the models from them,
//! shipped with the program: their first cut waits for no identification.
//!
//! `just built-in-logs` writes the file, for each machine and number of axes a line of the log and
//! one of the model for the default controller. A line is found by a hash of what it follows from:
//! a machine with another value, or another seed, is identified anew. One test finds all lines,
//! another compares a line with a new identification.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::KeptFromLog;
use crate::store::content_key;

/// The lines.
const BUILT_IN: &str = include_str!("built_in.jsonl");
/// Machines that fit a log as well, in each line: as many as `run` cuts without `--band`.
pub(super) const FITTING: usize = 8;

/// Result of a log, shortened: a machine that fits as well differs in some lines of the text.
#[derive(Serialize, Deserialize)]
struct BuiltInLog {
    /// Hash of the content. It is the first key: lines are found by it without parsing the others.
    content: String,
    text: String,
    #[serde(rename = "doubts")]
    warnings: Vec<String>,
    fitting: Vec<Vec<(usize, String)>>,
}

/// All lines.
pub(super) fn lines() -> impl Iterator<Item = &'static str> {
    BUILT_IN.lines()
}

/// Returns the beginning of the line of a content.
fn beginning(content: &Value) -> Option<String> {
    Some(format!("{{\"content\":\"{}\"", content_key(content)?))
}

/// Returns the result that is shipped with the program for a content.
pub(super) fn from_log(content: &Value) -> Option<KeptFromLog> {
    let beginning = beginning(content)?;
    let BuiltInLog {
        text,
        warnings,
        fitting,
        ..
    } = serde_json::from_str(lines().find(|line| line.starts_with(&beginning))?).ok()?;
    let with = |changes: &Vec<(usize, String)>| {
        let mut lines: Vec<&str> = text.split('\n').collect();
        changes.iter().try_for_each(|(number, line)| {
            lines.get_mut(*number).map(|old| *old = line.as_str())
        })?;
        Some(lines.join("\n"))
    };
    let fitting = fitting.iter().map(with).collect::<Option<_>>()?;
    Some(KeptFromLog {
        text,
        warnings,
        fitting,
    })
}

/// The line of a content. A machine that fits as well has the lines of the text with other values;
/// one that has not is left out.
pub(super) fn line(content: &Value, from_log: &KeptFromLog) -> String {
    let lines: Vec<&str> = from_log.text.split('\n').collect();
    let changes = |fits: &String| {
        let of_fits: Vec<&str> = fits.split('\n').collect();
        let changed = lines
            .iter()
            .zip(&of_fits)
            .enumerate()
            .filter(|(_, (line, other))| line != other);
        let changed = changed.map(|(number, (_, other))| (number, (*other).to_owned()));
        (of_fits.len() == lines.len()).then(|| changed.collect::<Vec<_>>())
    };
    let fitting = from_log
        .fitting
        .iter()
        .filter_map(changes)
        .take(FITTING)
        .collect();
    let line = BuiltInLog {
        content: content_key(content).unwrap_or_default(),
        text: from_log.text.clone(),
        warnings: from_log.warnings.clone(),
        fitting,
    };
    serde_json::to_string(&line).unwrap_or_default()
}
