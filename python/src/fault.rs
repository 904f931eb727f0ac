//! Errors as exceptions of Python.

use feedwright::command::{fault_findings, fault_text};
use miette::Report;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::Value;

pyo3::create_exception!(
    feedwright,
    FeedwrightError,
    PyValueError,
    "What keeps feedwright from doing what is asked for.\n\n`findings` has every mistake as a dict; file, line, column, code and hint are \
     those of the first."
);

/// Returns the exception of an error.
pub(crate) fn exception(report: &Report) -> PyErr {
    let findings = fault_findings(report);
    let error = FeedwrightError::new_err(fault_text(report));
    let set = |py: Python<'_>| -> PyResult<()> {
        let value = error.value(py);
        let findings = from_json(py, &Value::Array(findings).to_string())?;
        let first = findings.get_item(0)?;
        for name in ["file", "line", "column", "code", "hint"] {
            value.setattr(name, first.get_item(name)?)?;
        }
        value.setattr("findings", findings)
    };
    // If memory or the interpreter fails, that failure is reported.
    Python::attach(set).err().unwrap_or(error)
}

/// Converts a JSON text to objects of Python.
pub(crate) fn from_json<'py>(py: Python<'py>, text: &str) -> PyResult<Bound<'py, PyAny>> {
    py.import("json")?.call_method1("loads", (text,))
}
