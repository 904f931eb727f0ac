//! Programs, their motions and their mistakes, and machines.

use std::path::PathBuf;

use feedwright::command::mistake_json;
use feedwright::gcode::canon::{Canon, MotionKind, Shape};
use feedwright::gcode::{AUTO, CheckError, Program, Reader, Settings};
use feedwright::sim::{BUILT_IN_MACHINES, Machine, MachineError};
use feedwright::{CONTROLLERS, JobRequest, TARGETS};
use miette::{IntoDiagnostic, Report, miette};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::json;
use toml_edit::{DocumentMut, Item, Table, Value};

use crate::fault::{exception, from_json};

/// A G-code program in a file or a text, and the settings of its reader.
#[pyclass(frozen, name = "Program", module = "feedwright")]
pub(crate) struct PythonProgram {
    pub(crate) program: Program,
    pub(crate) settings: Settings,
    /// Request with this program.
    request: JobRequest,
}

impl PythonProgram {
    /// Returns a program of the default dialect with this name.
    pub(crate) fn named(name: String, text: String) -> PyResult<Self> {
        Self::new(None, Some(text), Some(name), AUTO, None, false, vec![])
    }
}

#[pymethods]
impl PythonProgram {
    #[new]
    #[pyo3(signature = (path=None, *, text=None, name=None, dialect=AUTO, tool_table=None, inch_tools=false, subroutines=vec![]))]
    fn new(
        path: Option<PathBuf>,
        text: Option<String>,
        name: Option<String>,
        dialect: &str,
        tool_table: Option<PathBuf>,
        inch_tools: bool,
        subroutines: Vec<PathBuf>,
    ) -> PyResult<Self> {
        let settings = JobRequest {
            dialect: dialect.to_owned(),
            tool_table,
            inch_tools,
            subroutines,
            ..JobRequest::default()
        };
        let reader = settings.reader().map_err(|error| exception(&error))?;
        if path.is_some() == text.is_some() {
            return Err(exception(&miette!(
                help = "Program(\"part.ngc\") or Program(text=\"G1 X1 F100\\nM2\")",
                "a program needs a path or a text"
            )));
        }
        let name = name.unwrap_or_else(|| "program.ngc".to_owned());
        let request = JobRequest {
            program: path.unwrap_or_else(|| name.into()),
            program_text: text,
            ..settings
        };
        Ok(Self {
            program: request.program(),
            settings: reader,
            request,
        })
    }

    /// Returns a request with this program, as JSON.
    fn _job(&self) -> PyResult<String> {
        job_text(&self.request)
    }

    /// Name of the program in messages.
    #[getter]
    fn name(&self) -> String {
        self.program.name()
    }

    fn __repr__(&self) -> String {
        format!("<feedwright.Program {}>", self.program.name())
    }
}

/// Returns a request as JSON.
pub(crate) fn job_text(request: &JobRequest) -> PyResult<String> {
    serde_json::to_string(request)
        .into_diagnostic()
        .map_err(|error| exception(&error))
}

/// A motion of a program.
#[pyclass(frozen, get_all, name = "Motion", module = "feedwright")]
pub(crate) struct MotionOfProgram {
    line: u32,
    rapid: bool,
    shape: &'static str,
    start_mm: (f64, f64, f64),
    end_mm: (f64, f64, f64),
    center_mm: Option<(f64, f64, f64)>,
    turns: i32,
    feed_mm_s: f64,
}

#[pymethods]
impl MotionOfProgram {
    fn __repr__(&self) -> String {
        let (x, y, z) = self.end_mm;
        let kind = if self.rapid { "rapid" } else { self.shape };
        format!(
            "<feedwright.Motion line {}: {kind} to {x}, {y}, {z} mm>",
            self.line
        )
    }
}

/// Motions of a program in its order, read on demand.
#[pyclass(name = "Motions", module = "feedwright")]
pub(crate) struct MotionsOfProgram {
    reader: Reader,
}

#[pymethods]
impl MotionsOfProgram {
    #[new]
    fn new(program: &PythonProgram) -> PyResult<Self> {
        let reader = program.program.reader(program.settings.clone());
        Ok(Self {
            reader: reader.map_err(|error| exception(&error.into()))?,
        })
    }

    fn __iter__(of: PyRef<'_, Self>) -> PyRef<'_, Self> {
        of
    }

    fn __next__(&mut self) -> PyResult<Option<MotionOfProgram>> {
        let point = |[x, y, z]: [f64; 3]| (x, y, z);
        for step in &mut self.reader {
            let Canon::Motion(motion) = step.map_err(|fault| exception(&fault.into()))? else {
                continue;
            };
            let (shape, center_mm, turns) = match &motion.shape {
                Shape::Line => ("line", None, 0),
                Shape::Arc {
                    center_mm, turns, ..
                } => ("arc", Some(point(*center_mm)), *turns),
                Shape::Spline(_) => ("spline", None, 0),
            };
            let (start_mm, end_mm) = (point(motion.start_mm), point(motion.end_mm));
            let rapid = motion.kind == MotionKind::Rapid;
            return Ok(Some(MotionOfProgram {
                line: motion.line,
                rapid,
                shape,
                start_mm,
                end_mm,
                center_mm,
                turns,
                feed_mm_s: motion.feed_mm_s,
            }));
        }
        Ok(None)
    }
}

/// Checks a program. Returns every mistake and warning; without a mistake, also its lines, motions,
/// lengths, box and dialect.
#[pyfunction]
pub(crate) fn check<'py>(py: Python<'py>, program: &PythonProgram) -> PyResult<Bound<'py, PyAny>> {
    let answer = match py.detach(|| program.program.check(program.settings.clone())) {
        Ok(summary) => {
            let (dialect, reason) = summary.dialect;
            json!({
                "findings": summary.warnings.iter().map(mistake_json).collect::<Vec<_>>(),
                "lines": summary.lines,
                "motions": summary.motions,
                "feed_mm": summary.feed_mm,
                "rapid_mm": summary.rapid_mm,
                "box_mm": summary.box_mm,
                "dialect": dialect.to_string(),
                "dialect_reason": reason.to_string(),
            })
        }
        Err(CheckError::Read(error)) => return Err(exception(&error.into())),
        Err(CheckError::Faults(faults)) => {
            json!({ "findings": faults.iter().map(mistake_json).collect::<Vec<_>>() })
        }
    };
    from_json(py, &answer.to_string())
}

/// A machine, built in or from a machine file.
#[pyclass(frozen, name = "Machine", module = "feedwright")]
pub(crate) struct PythonMachine {
    pub(crate) machine: Machine,
    /// File that it was read from; `None` if it is built in.
    file: Option<String>,
}

impl PythonMachine {
    pub(crate) fn parsed(name: &str, text: &str) -> Result<Self, MachineError> {
        Ok(Self {
            machine: Machine::parse(name, text)?,
            file: Some(name.to_owned()),
        })
    }
}

#[pymethods]
impl PythonMachine {
    #[new]
    #[pyo3(signature = (name_or_path=None, *, text=None, name="machine.toml"))]
    fn new(name_or_path: Option<PathBuf>, text: Option<&str>, name: &str) -> PyResult<Self> {
        let found = match (name_or_path, text) {
            (Some(path), None) => {
                let file =
                    feedwright::sim::is_machine_path(&path).then(|| path.display().to_string());
                Machine::load(path.as_os_str())
                    .map(|machine| Self { machine, file })
                    .map_err(Report::from)
            }
            (None, Some(text)) => Self::parsed(name, text).map_err(Report::from),
            _ => Err(miette!(
                help = "Machine(\"workshop\"), Machine(\"my.toml\") or Machine(text=...)",
                "a machine needs a name, a path or a text"
            )),
        };
        found.map_err(|error| exception(&error))
    }

    /// Returns name and text of the machine for a request; a built-in machine needs no text.
    fn _job(&self) -> (String, Option<String>) {
        match &self.file {
            Some(file) => (file.clone(), Some(self.machine.text())),
            None => (self.machine.name.clone(), None),
        }
    }

    /// Name of the machine.
    #[getter]
    fn name(&self) -> &str {
        &self.machine.name
    }

    /// Machine file that reads as this machine.
    #[getter]
    fn text(&self) -> String {
        self.machine.text()
    }

    /// Keys and values of the machine file, as nested dicts.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("tomllib")?
            .call_method1("loads", (self.machine.text(),))
    }

    /// Returns a machine with other values, by the keys of the file: `{"axis.x.kp_1_s": 80}`.
    fn with_values(&self, values: &Bound<'_, PyDict>) -> PyResult<Self> {
        let found = || -> PyResult<Result<Self, Report>> {
            let mut document: DocumentMut = match self.machine.text().parse() {
                Ok(document) => document,
                Err(error) => return Ok(Err(error).into_diagnostic()),
            };
            for (key, value) in values {
                let (key, value) = (key.extract::<String>()?, toml_value(&value)?);
                if let Err(error) = set(document.as_table_mut(), &key, value) {
                    return Ok(Err(error));
                }
            }
            let name = self.file.as_deref().unwrap_or(&self.machine.name);
            Ok(Self::parsed(name, &document.to_string()).map_err(Report::from))
        };
        found()?.map_err(|error| exception(&error))
    }

    fn __repr__(&self) -> String {
        format!(
            "<feedwright.Machine {}, {} axes>",
            self.machine.name,
            self.machine.axis_count()
        )
    }
}

/// Converts a number, text or bool of Python to a TOML value.
fn toml_value(value: &Bound<'_, PyAny>) -> PyResult<Value> {
    if value.is_instance_of::<pyo3::types::PyBool>() {
        return Ok(value.extract::<bool>()?.into());
    }
    if let Ok(number) = value.extract::<i64>() {
        return Ok(number.into());
    }
    if let Ok(number) = value.extract::<f64>() {
        return Ok(number.into());
    }
    Ok(value.extract::<String>()?.into())
}

/// Sets a value by its key, whose parts are separated by points.
fn set(mut table: &mut Table, key: &str, value: Value) -> Result<(), Report> {
    let mut parts: Vec<&str> = key.split('.').collect();
    let last = parts.pop().unwrap_or_default();
    for part in parts {
        let item = table
            .entry(part)
            .or_insert_with(|| Item::Table(Table::new()));
        table = item.as_table_mut().ok_or_else(|| {
            miette!(
                help = "Machine.values has the keys of a machine",
                "{key}: `{part}` is a value, not a section"
            )
        })?;
    }
    table.insert(last, Item::Value(value));
    Ok(())
}

/// Returns the names of machines, controllers and controls.
#[pyfunction]
pub(crate) fn lists<'py>(py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
    let controllers: Vec<&str> = CONTROLLERS.iter().map(|entry| entry.name).collect();
    let machines: Vec<&str> = BUILT_IN_MACHINES.iter().map(|(name, _)| *name).collect();
    let targets: Vec<&str> = TARGETS.iter().map(|target| target.name).collect();
    from_json(
        py,
        &json!({ "controllers": controllers, "machines": machines, "targets": targets })
            .to_string(),
    )
}
