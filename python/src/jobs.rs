//! The jobs: run, correct, advise, plan, identify.

use std::io;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use feedwright::command::{find, mistake_json, settings, today};
use feedwright::gcode::input;
use feedwright::ident::{Columns, Log, Model};
use feedwright::plan::Constraints;
use feedwright::sim::{Machine, Sink, Stages, Watch, path_steps};
use feedwright::{
    AdviseJob, BEST, CONTROLLERS, Choices, CorrectJob, CycleTimeOptions, Job, JobError, JobOutcome,
    LogIdentified, LogJob, MeasuredLog, TARGETS, TargetControl, cycle_time_by, fitting_machines,
    machine_text, take_recorded_model, write_html, write_json, write_page,
};
use miette::{IntoDiagnostic, Report, Result, miette};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};

use crate::columns::RowColumns;
use crate::fault::{exception, from_json};
use crate::files::{PythonMachine, PythonProgram};
use crate::watched::watched;

/// Largest tolerance that is not taken for a slip of the unit, um.
const MAX_TOLERANCE_UM: f64 = 1e6;

/// Options of `run` besides program and machine.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct RunOptions {
    controller: Option<String>,
    against: String,
    tolerance_um: Option<f64>,
    feed_mm_s: Option<f64>,
    seed: u64,
    settings: Vec<String>,
    model: Option<PathBuf>,
    exact_settings: bool,
    log: Option<PathBuf>,
    rows: bool,
    band: usize,
}

impl RunOptions {
    /// Returns the job of these options, as the command makes it.
    fn job(
        &self,
        program: &PythonProgram,
        machine: &PythonMachine,
        watch: &dyn Watch,
    ) -> Result<Job> {
        let controller = find(self.controller.as_deref().unwrap_or(BEST), CONTROLLERS)?;
        let against = find(&self.against, CONTROLLERS)?;
        let set = settings(
            &self.settings,
            CONTROLLERS,
            Some(controller),
            &[controller, against],
        )?;
        let mut job = Job::new(program.program.clone(), machine.machine.clone());
        job.machine_file.clone_from(&machine.file);
        (job.controller, job.against) = (controller, against);
        job.feed_mm_s = self.feed_mm_s;
        job.choices = Choices {
            seed: self.seed,
            set,
            tries: true,
            ..Choices::default()
        };
        let both = [controller, against].into_iter();
        let recorded =
            both.filter_map(|entry| Some((entry, CONTROLLERS.recorded(&job.machine, entry)?)));
        job.choices
            .take_recorded(recorded.collect::<Vec<_>>().into_iter());
        job.model = self.model.as_deref().map(Model::read).transpose()?;
        job.tolerance_um = self.tolerance_um;
        job.with_limits = true;
        job.reader = program.settings.clone();
        job.log = self
            .log
            .as_deref()
            .map(|path| measured(path, None, watch))
            .transpose()?;
        Ok(job)
    }
}

/// Reads a log of a cut.
fn measured(path: &Path, columns: Option<&str>, watch: &dyn Watch) -> Result<MeasuredLog> {
    let columns = columns
        .map(Columns::from_str)
        .transpose()?
        .unwrap_or_default();
    Ok(MeasuredLog {
        name: input::name(path),
        log: Log::read_watched(path, &columns, watch)?,
    })
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
    program: Py<PythonProgram>,
    machine: Py<PythonMachine>,
    options: RunOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<Ran<'py>> {
    let cut = move |watch: &dyn Watch| {
        let (program, machine) = (program.get(), machine.get());
        watch.begin("reading the program", 1);
        let mut job = options.job(program, machine, watch)?;
        let read = job.check()?;
        let (axes, summary) = (read.axes(), read.into_summary());
        if !options.exact_settings {
            let model = take_recorded_model(&mut job, &machine.machine, axes, today()?, watch)?;
            if model.is_some() && options.band > 0 {
                job.fitting =
                    fitting_machines(&machine.machine, axes, options.seed, options.band, watch)?;
            }
        }
        let mut columns = RowColumns::new(axes);
        let mut sinks: Vec<&mut dyn Sink> = Vec::new();
        if options.rows {
            sinks.push(&mut columns);
        }
        let outcome = job.check_read(summary)?.run(&mut sinks, watch)?;
        let mut results = Vec::new();
        outcome.write_json(&job, &mut results).into_diagnostic()?;
        Ok((text(results)?, options.rows.then_some(columns), outcome))
    };
    let (results, columns, outcome) = watched(py, progress.as_ref(), cut)?;
    let columns = columns.map(|columns| columns.into_arrays(py)).transpose()?;
    Ok((from_json(py, &results)?, columns, CutOutcome { outcome }))
}

fn text(bytes: Vec<u8>) -> Result<String> {
    String::from_utf8(bytes).into_diagnostic()
}

fn target(name: &str) -> Result<&'static TargetControl> {
    TargetControl::find(name).ok_or_else(|| {
        let names: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
        miette!(
            "no control is called '{name}'; there are {}",
            names.join(", ")
        )
    })
}

fn check_tolerance(tolerance_um: f64) -> Result<()> {
    if tolerance_um > 0.0 && tolerance_um <= MAX_TOLERANCE_UM {
        return Ok(());
    }
    Err(miette!(
        help = "the unit is um: 0.01 mm is tolerance_um=10",
        "tolerance_um is {tolerance_um} um; it must lie above 0 and up to {MAX_TOLERANCE_UM} um"
    ))
}

/// Options of `correct` besides program and machine.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct CorrectOptions {
    control: String,
    logs: Vec<PathBuf>,
    columns: Option<String>,
    file_error: Option<f64>,
}

/// Corrects a program. Returns the figures of the correction, and the corrected program if it is
/// better.
#[pyfunction]
pub(crate) fn correct<'py>(
    py: Python<'py>,
    program: Py<PythonProgram>,
    machine: Py<PythonMachine>,
    options: CorrectOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Option<String>)> {
    let work = move |watch: &dyn Watch| {
        let (program, machine) = (program.get(), machine.get());
        let mut job = CorrectJob::new(
            program.program.clone(),
            machine.machine.clone(),
            target(&options.control)?,
        );
        job.reader = program.settings.clone();
        job.file_error = machine.file_error(options.file_error);
        let measured = |path: &PathBuf| measured(path, options.columns.as_deref(), watch);
        job.logs = options.logs.iter().map(measured).collect::<Result<_>>()?;
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

/// Options of `advise` besides program and machine.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct AdviseOptions {
    tolerance_um: f64,
    control: String,
    controller: Option<String>,
    file_error: Option<f64>,
}

/// Returns the feedrates at which a tolerance is held.
#[pyfunction]
pub(crate) fn advise<'py>(
    py: Python<'py>,
    program: Py<PythonProgram>,
    machine: Py<PythonMachine>,
    options: AdviseOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let work = move |watch: &dyn Watch| {
        let (program, machine) = (program.get(), machine.get());
        let AdviseOptions {
            tolerance_um,
            control,
            controller,
            ..
        } = &options;
        check_tolerance(*tolerance_um)?;
        let machine_of = machine.machine.clone();
        let mut job = AdviseJob::new(
            program.program.clone(),
            machine_of,
            target(control)?,
            *tolerance_um,
        );
        job.controller = find(controller.as_deref().unwrap_or(BEST), CONTROLLERS)?;
        job.reader = program.settings.clone();
        job.file_error = machine.file_error(options.file_error);
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
            Some(name) => target(name)?.stages(machine),
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
