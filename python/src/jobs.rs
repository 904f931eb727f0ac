//! The jobs: run, correct, advise, plan, identify.

use std::io;
use std::path::PathBuf;
use std::str::FromStr;

use feedwright::command::{mistake_json, today};
use feedwright::gcode::input;
use feedwright::ident::{Columns, Log};
use feedwright::plan::Constraints;
use feedwright::sim::{Machine, Sink, Stages, Watch, path_steps};
use feedwright::{
    CONTROLLERS, CycleTimeOptions, JobError, JobOutcome, JobRequest, LogIdentified, LogJob,
    cycle_time_by, find_control, machine_text, write_html, write_json, write_page,
};
use miette::{IntoDiagnostic, Report, Result, WrapErr};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};

use crate::columns::RowColumns;
use crate::fault::{exception, from_json};
use crate::files::{PythonMachine, PythonProgram};
use crate::watched::watched;

/// Reads a request from its keys as JSON.
pub(crate) fn asked(keys: &str) -> Result<JobRequest> {
    serde_json::from_str(keys)
        .into_diagnostic()
        .wrap_err("no job")
}

/// Writes a page to bytes, without the lock of the interpreter.
fn written(
    py: Python<'_>,
    write: impl FnOnce(&mut Vec<u8>) -> io::Result<()> + Send,
) -> PyResult<Vec<u8>> {
    let page = || {
        let mut page = Vec::new();
        write(&mut page).into_diagnostic().map(|()| page)
    };
    py.detach(page).map_err(|error| exception(&error))
}

/// Outcome of a cut without a correction and of one with a controller.
#[pyclass(frozen, module = "feedwright")]
pub(crate) struct CutOutcome {
    pub(crate) outcome: JobOutcome,
}

#[pymethods]
impl CutOutcome {
    /// Returns the report, one page of HTML that needs no other file.
    fn html(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        written(py, |page| write_html(page, &self.outcome.report))
    }
}

/// Results, rows and outcome.
pub(crate) type Ran<'py> = (Bound<'py, PyAny>, Option<Bound<'py, PyDict>>, CutOutcome);

/// Cuts a program without a correction and with a controller, in a simulation.
#[pyfunction]
pub(crate) fn run<'py>(
    py: Python<'py>,
    request: String,
    rows: bool,
    progress: Option<Py<PyAny>>,
) -> PyResult<Ran<'py>> {
    let cut = move |watch: &dyn Watch| {
        watch.begin("reading the program", 1);
        let request = JobRequest {
            with_limits: true,
            ..asked(&request)?
        };
        let job = request.job(CONTROLLERS, &today()?, watch)?;
        let checked = job.check()?;
        let mut columns = RowColumns::new(checked.axes());
        let mut sinks: Vec<&mut dyn Sink> = Vec::new();
        if rows {
            sinks.push(&mut columns);
        }
        let outcome = checked.run(&mut sinks, watch)?;
        let mut results = Vec::new();
        outcome.write_json(&job, &mut results).into_diagnostic()?;
        Ok((text(results)?, rows.then_some(columns), outcome))
    };
    let (results, columns, outcome) = watched(py, progress.as_ref(), cut)?;
    let columns = columns.map(|columns| columns.into_arrays(py)).transpose()?;
    Ok((from_json(py, &results)?, columns, CutOutcome { outcome }))
}

fn text(bytes: Vec<u8>) -> Result<String> {
    String::from_utf8(bytes).into_diagnostic()
}

/// Corrects a program. Returns the figures of the correction, and the corrected program if it is
/// better.
#[pyfunction]
pub(crate) fn correct<'py>(
    py: Python<'py>,
    request: String,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Option<String>)> {
    let work = move |watch: &dyn Watch| {
        let job = asked(&request)?.correct_job(watch)?;
        let outcome = job.run(watch)?;
        let mut results = serde_json::to_value(&outcome).into_diagnostic()?;
        results["warnings"] = outcome
            .warnings
            .iter()
            .map(mistake_json)
            .collect::<Vec<_>>()
            .into();
        Ok((results, outcome.program().map(str::to_owned)))
    };
    let (results, program) = watched(py, progress.as_ref(), work)?;
    Ok((from_json(py, &results.to_string())?, program))
}

/// Returns the feedrates at which a tolerance is held.
#[pyfunction]
pub(crate) fn advise<'py>(
    py: Python<'py>,
    request: String,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let work = move |watch: &dyn Watch| {
        let job = asked(&request)?.advise_job()?;
        let advice = job.run(watch)?;
        let mut results = serde_json::to_value(&advice).into_diagnostic()?;
        results["holds"] = advice.holds().into();
        Ok(results)
    };
    let results = watched(py, progress.as_ref(), work)?;
    from_json(py, &results.to_string())
}

/// Returns the cycle time of a program, and the times of its lines.
#[pyfunction]
pub(crate) fn plan<'py>(
    py: Python<'py>,
    program: Py<PythonProgram>,
    machine: Py<PythonMachine>,
    control: Option<String>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyDict>)> {
    let work = move |watch: &dyn Watch| {
        let (program, machine): (_, &Machine) = (program.get(), &machine.get().machine);
        let stages = match &control {
            Some(name) => find_control(name)?.stages(machine),
            None => Stages::of(machine),
        };
        let summary = program
            .program
            .check(program.settings.clone())
            .map_err(JobError::from)?;
        let steps = || {
            Ok(path_steps(
                program
                    .program
                    .reader(program.settings.clone())?
                    .map_while(std::result::Result::ok),
            ))
        };
        let options = CycleTimeOptions {
            bound: false,
            lines: true,
            length_mm: summary.feed_mm + summary.rapid_mm,
        };
        let found = cycle_time_by(
            stages,
            machine,
            &Constraints::from(machine),
            options,
            steps,
            watch,
        )?;
        Ok((serde_json::to_value(&found).into_diagnostic()?, found.lines))
    };
    let (results, lines): (Value, _) = watched(py, progress.as_ref(), work)?;
    let arrays = PyDict::new(py);
    arrays.set_item(
        "line",
        PyArray1::from_vec(py, lines.iter().map(|line| line.line).collect()),
    )?;
    arrays.set_item(
        "time_s",
        PyArray1::from_vec(py, lines.iter().map(|line| line.time_s).collect()),
    )?;
    arrays.set_item(
        "waiting_s",
        PyArray1::from_vec(py, lines.iter().map(|line| line.waiting_s).collect()),
    )?;
    Ok((from_json(py, &results.to_string())?, arrays))
}

/// A machine identified from its log.
#[pyclass(frozen, module = "feedwright")]
pub(crate) struct IdentifiedMachine {
    identified: LogIdentified,
}

#[pymethods]
impl IdentifiedMachine {
    /// Returns the page of the identification, which needs no other file.
    fn html(&self, py: Python<'_>) -> PyResult<Vec<u8>> {
        written(py, |page| write_page(page, &self.identified))
    }
}

/// Identifies a machine from logs. Returns the results, the machine, and the identification.
#[pyfunction]
pub(crate) fn identify<'py>(
    py: Python<'py>,
    logs: Vec<PathBuf>,
    columns: Option<String>,
    name: String,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, PythonMachine, IdentifiedMachine)> {
    let work = move |watch: &dyn Watch| {
        let columns = columns
            .as_deref()
            .map(Columns::from_str)
            .transpose()?
            .unwrap_or_default();
        let read = |path: &PathBuf| Ok((path.clone(), Log::read_watched(path, &columns, watch)?));
        let log = Log::joined(logs.iter().map(read).collect::<Result<Vec<_>, Report>>()?)?;
        let findings: Vec<String> = log.findings.iter().map(ToString::to_string).collect();
        let named = logs
            .iter()
            .map(|path| input::name(path))
            .collect::<Vec<_>>()
            .join(", ");
        let identified = LogJob {
            name: named,
            ..LogJob::default()
        }
        .run(log, watch)?;
        let machine =
            PythonMachine::parsed(&format!("{name}.toml"), &machine_text(&identified, &name))?;
        let mut results = Vec::new();
        write_json(&mut results, &identified).into_diagnostic()?;
        let mut results: Value = serde_json::from_slice(&results).into_diagnostic()?;
        results["findings"] = json!(findings);
        results["advice"] = json!(identified.advice());
        Ok((results, machine, identified))
    };
    let (results, machine, identified) = watched(py, progress.as_ref(), work)?;
    Ok((
        from_json(py, &results.to_string())?,
        machine,
        IdentifiedMachine { identified },
    ))
}
