//! Errors as exceptions of Python.

use feedwright::JobError;
use feedwright::gcode::Diagnostic as Finding;
use miette::{Diagnostic, Report};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::{Value, json};

pyo3::create_exception!(
    feedwright,
    FeedwrightError,
    PyValueError,
    "What keeps feedwright from doing what is asked for.\n\n`findings` has every mistake as a dict; file, line, column, code and hint are \
     those of the first."
);

/// The exception of an error.
pub(crate) fn exception(report: &Report) -> PyErr {
    let findings = findings(report);
    let error = FeedwrightError::new_err(text(report));
    let set = |py: Python<'_>| -> PyResult<()> {
        let value = error.value(py);
        let findings = from_json(py, &Value::Array(findings).to_string())?;
        let first = findings.get_item(0)?;
        for name in ["file", "line", "column", "code", "hint"] {
            value.setattr(name, first.get_item(name)?)?;
        }
        value.setattr("findings", findings)
    };
    // Where memory or the interpreter fails, that is what is told.
    Python::attach(set).err().unwrap_or(error)
}

/// A JSON text as objects of Python.
pub(crate) fn from_json<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}

/// An error, the errors that belong to it, and the remedy.
fn text(report: &Report) -> String {
    let related = report.related().into_iter().flatten().map(|fault| format!("\n{fault}"));
    let hint = report.help().map(|hint| format!("\nhint: {hint}"));
    std::iter::once(report.to_string()).chain(related).chain(hint).collect()
}

/// All that is wrong, at least one.
fn findings(report: &Report) -> Vec<Value> {
    if let Some(JobError::Faults { faults, .. }) = report.downcast_ref() {
        return faults.iter().map(finding).collect();
    }
    let related: Vec<Value> = report.related().into_iter().flatten().map(|fault| placed(fault, report)).collect();
    if related.is_empty() { vec![placed(report.as_ref(), report)] } else { related }
}

/// A mistake or a warning of a program.
pub(crate) fn finding(found: &Finding) -> Value {
    json!({
        "file": &*found.file,
        "severity": if found.severity == feedwright::gcode::Severity::Error { "error" } else { "warning" },
        "code": found.code,
        "line": (found.line > 0).then_some(found.line),
        "column": (found.column > 0).then_some(found.column),
        "length": found.span,
        "message": found.message,
        "hint": found.hint,
    })
}

/// A fault at the place that its label marks in its source, or in that of `within`.
fn placed(fault: &dyn Diagnostic, within: &Report) -> Value {
    let source = fault.source_code().or_else(|| within.source_code());
    let label = fault.labels().and_then(|mut labels| labels.next());
    let place = source.zip(label).and_then(|(source, label)| source.read_span(label.inner(), 0, 0).ok());
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
