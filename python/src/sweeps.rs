//! Jobs of sweeps, and tables of their results.

use std::path::PathBuf;

use feedwright::command::{JobList, RESULT_COLUMNS, ResultTable, do_job, make_folder};
use feedwright::{CONTROLLERS, JobRequest, OutputError, Store};
use miette::Report;
use numpy::PyArray1;
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde_json::Value;

use crate::fault::exception;
use crate::files::job_text;
use crate::jobs::asked;
use crate::watched::watched;

/// Jobs of JOBS.toml, each made on access.
#[pyclass(frozen, name = "JobList", module = "feedwright")]
pub(crate) struct PythonJobList {
    list: JobList,
}

#[pymethods]
impl PythonJobList {
    #[new]
    fn new(path: PathBuf) -> PyResult<Self> {
        Ok(Self {
            list: JobList::read(&path).map_err(|error| exception(&error))?,
        })
    }

    fn __len__(&self) -> usize {
        self.list.len()
    }

    fn __getitem__(&self, number: usize) -> PyResult<String> {
        match self.list.job(number).map_err(|error| exception(&error))? {
            Some(job) => job_text(&job),
            None => Err(PyIndexError::new_err(number)),
        }
    }
}

fn listed(spec: &str, folder: PathBuf) -> Result<JobRequest, Report> {
    let request = asked(spec)?;
    request.check_names(CONTROLLERS)?;
    Ok(JobRequest { folder, ..request })
}

/// Returns the address of the result of a job.
#[pyfunction]
pub(crate) fn job_address(py: Python<'_>, spec: &str, folder: PathBuf) -> PyResult<String> {
    py.detach(|| listed(spec, folder)?.address())
        .map_err(|error| exception(&error))
}

/// Runs a job, unless its result is in the store. Returns its address, whether it was there, and
/// the error in the result, if any. Returns no address if a file cannot be read.
///
/// # Errors
/// A result that cannot be written, and an end from outside.
#[pyfunction(name = "do_job")]
pub(crate) fn do_python_job(
    py: Python<'_>,
    spec: String,
    folder: PathBuf,
    out: PathBuf,
) -> PyResult<(Option<String>, bool, Option<String>)> {
    watched(py, None, move |watch| {
        make_folder(&out)?;
        match do_job(&Store::new(out), &listed(&spec, folder)?, watch) {
            Ok(done) => Ok((Some(done.address), done.found, done.error)),
            Err(error) if error.downcast_ref::<OutputError>().is_some() => Err(error),
            Err(error) => {
                watch.check()?;
                Ok((None, false, Some(feedwright::command::fault_text(&error))))
            }
        }
    })
}

/// Returns the columns of the results in folders.
#[pyfunction]
pub(crate) fn merge<'py>(py: Python<'py>, folders: Vec<PathBuf>) -> PyResult<Bound<'py, PyDict>> {
    let table = watched(py, None, move |watch| ResultTable::of(&folders, watch))?;
    let columns = PyDict::new(py);
    for (at, column) in RESULT_COLUMNS.iter().enumerate() {
        let cells = table.rows.iter().map(|row| &row[at]);
        if column.is_number {
            let numbers = cells
                .map(|cell| cell.as_f64().unwrap_or(f64::NAN))
                .collect();
            columns.set_item(column.name, PyArray1::from_vec(py, numbers))?;
        } else {
            let objects = cells
                .map(|cell| object(py, cell))
                .collect::<PyResult<Vec<_>>>()?;
            columns.set_item(column.name, PyList::new(py, objects)?)?;
        }
    }
    Ok(columns)
}

/// Converts a text or a bool to a Python object; every other value becomes `None`.
fn object<'py>(py: Python<'py>, cell: &Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match cell {
        Value::String(text) => text.into_pyobject(py)?.into_any(),
        Value::Bool(truth) => truth.into_pyobject(py)?.to_owned().into_any(),
        _ => py.None().into_bound(py),
    })
}
