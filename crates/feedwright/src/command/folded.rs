//! Folds faults of one kind that repeat in a program: shows the first ones and counts the rest.

use feedwright_gcode::Diagnostic;
use miette::Report;
use thiserror::Error;

use crate::job::JobError;

/// Number of faults of one kind that are shown.
const REPORTED: usize = 3;

/// Returns the faults without repeats: of each kind, the first [`REPORTED`] remain, and the last of
/// them gives the number of those left out.
pub(crate) fn folded(faults: &[Diagnostic]) -> Vec<Diagnostic> {
    let mut reported: Vec<Diagnostic> = Vec::new();
    for (at, fault) in faults.iter().enumerate() {
        let alike =
            |other: &&Diagnostic| (other.code, other.severity) == (fault.code, fault.severity);
        let before = faults[..at].iter().filter(alike).count();
        if before >= REPORTED {
            continue;
        }
        let mut fault = fault.clone();
        let rest: Vec<u32> = faults[at + 1..]
            .iter()
            .filter(alike)
            .map(|other| other.line)
            .collect();
        if let (true, [first, ..], [.., last]) = (before + 1 == REPORTED, &rest[..], &rest[..]) {
            let lines = if first == last {
                format!("line {first}")
            } else {
                format!("lines {first} to {last}")
            };
            fault.message += &format!("; and {} more like it, {lines}", rest.len());
        }
        reported.push(fault);
    }
    reported
}

/// The mistakes of a program with repeated ones left out.
#[derive(Debug, Error, miette::Diagnostic)]
#[error("{text}")]
struct FoldedFaults {
    text: String,
    #[related]
    faults: Vec<Diagnostic>,
}

/// The report with repeated mistakes left out; none where it has none.
pub(crate) fn folded_report(report: &Report) -> Option<Report> {
    match report.downcast_ref::<JobError>() {
        Some(error @ JobError::Faults { faults, .. }) => Some(
            FoldedFaults {
                text: error.to_string(),
                faults: folded(faults),
            }
            .into(),
        ),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use feedwright_gcode::{CheckError, Program, Settings};

    #[test]
    fn repeated_faults_are_counted_and_others_are_reported() {
        let lines: String = (0..9).map(|_| "G555\n").collect();
        let Err(CheckError::Faults(faults)) =
            Program::from_text("a.ngc", format!("{lines}G1 X1 F100 Q\nM2\n"))
                .check(Settings::default())
        else {
            panic!("the program has faults")
        };
        let reported = folded(&faults);
        assert_eq!(
            reported.iter().map(|fault| fault.line).collect::<Vec<_>>(),
            [1, 2, 3, 10]
        );
        assert!(
            reported[2]
                .message
                .ends_with("; and 6 more like it, lines 4 to 9"),
            "{}",
            reported[2].message
        );
        assert!(!reported[1].message.contains("more") && !reported[3].message.contains("more"));
        assert_eq!(folded(&faults[..3]), faults[..3]);
    }
}
