//! Errors as data, for programs: every mistake with its place, as JSON.

use feedwright_gcode::{Diagnostic as Mistake, Severity};
use miette::{Diagnostic, Report};
use serde_json::{Value, json};

use crate::job::JobError;

/// The message of an error, those of the errors that belong to it, and the remedy.
pub fn fault_text(report: &Report) -> String {
    let related = report
        .related()
        .into_iter()
        .flatten()
        .map(|fault| format!("\n{fault}"));
    let hint = report.help().map(|hint| format!("\nhint: {hint}"));
    std::iter::once(report.to_string())
        .chain(related)
        .chain(hint)
        .collect()
}

/// All mistakes of an error, at least one.
pub fn fault_findings(report: &Report) -> Vec<Value> {
    if let Some(JobError::Faults { faults, .. }) = report.downcast_ref() {
        return faults.iter().map(mistake_json).collect();
    }
    let related: Vec<Value> = report
        .related()
        .into_iter()
        .flatten()
        .map(|fault| placed(fault, report))
        .collect();
    if related.is_empty() {
        vec![placed(report.as_ref(), report)]
    } else {
        related
    }
}

/// A mistake or a warning of a program.
pub fn mistake_json(found: &Mistake) -> Value {
    json!({
        "file": &*found.file,
        "severity": if found.severity == Severity::Error { "error" } else { "warning" },
        "code": found.code,
        "line": (found.line > 0).then_some(found.line),
        "column": (found.column > 0).then_some(found.column),
        "length": found.span,
        "message": found.message,
        "hint": found.hint,
    })
}

/// A fault at the place that its label marks in its source, or in the source of `within`.
fn placed(fault: &dyn Diagnostic, within: &Report) -> Value {
    let source = fault.source_code().or_else(|| within.source_code());
    let label = fault.labels().and_then(|mut labels| labels.next());
    let place = source
        .zip(label)
        .and_then(|(source, label)| source.read_span(label.inner(), 0, 0).ok());
    json!({
        "file": place.as_ref().and_then(|place| place.name()),
        "severity": "error",
        "code": fault.code().map(|code| code.to_string()),
        "line": place.as_ref().map(|place| place.line() + 1),
        "column": place.as_ref().map(|place| place.column() + 1),
        "message": fault.to_string(),
        "hint": fault.help().map(|hint| hint.to_string()),
    })
}
