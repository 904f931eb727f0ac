//! Work of a run: its job, the known values of its machine, and its results.

use std::collections::VecDeque;
use std::sync::{Mutex, PoisonError};

use feedwright::command::find;
use feedwright::control::{ControllerRow, Knows, Parameters};
use feedwright::sim::{BoxedController, Known, Machine};
use feedwright::{
    Choices, Controllers, Entry, Job, JobOutcome, JobRequest, Make, Setup, UNCORRECTED,
};
use miette::{IntoDiagnostic, Result, miette};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use super::guest::PlantTerm;
use super::raised::Raised;
use crate::jobs::asked;

/// Controllers that have a name.
const TABLE: Controllers = if cfg!(feature = "peers") {
    feedwright_lab::CONTROLLERS
} else {
    feedwright::CONTROLLERS
};
/// Assumed inertia and friction where the knowledge is wrong, as parts of the true values. The two
/// errors are opposite.
const ASSUMED: [f64; 2] = [0.8, 1.2];

/// Seed of recordings and trainings: a machine is identified once, whatever the noise of the cut.
pub(super) const RECORDING_SEED: u64 = 1;
/// Largest number of identified machines that are kept.
const KEPT_MACHINES: usize = 64;

/// Options of a run besides the controller.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct LabOptions {
    /// Request as JSON: program, machine, settings, feedrate.
    request: String,
    /// Name of the controller.
    name: String,
    /// Controller of the library that takes its place.
    pub(super) of_library: Option<String>,
    /// Output of a planner: a feedrate for each motion, mm/s.
    feeds_mm_s: Option<Vec<f64>>,
    against: Option<String>,
    knowledge: String,
    seed: Option<u64>,
    plant_term: Option<Py<PyAny>>,
    pub(super) rows: bool,
}

/// Returns the entry of a controller that the caller provides. Each entry stays for the life of the
/// process, once.
fn entry(name: &str, knows: Knows, laps: u32) -> &'static Entry {
    static ENTRIES: Mutex<Vec<&'static Entry>> = Mutex::new(Vec::new());
    let taken = TABLE.find(name).is_some();
    let name = if taken {
        format!("{name} in Python")
    } else {
        name.to_owned()
    };
    let mut entries = ENTRIES.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some(entry) = entries
        .iter()
        .find(|entry| (entry.name, entry.knows, entry.laps) == (&name, knows, laps))
    {
        return entry;
    }
    let entry: &'static Entry = Box::leak(Box::new(Entry {
        row: ControllerRow {
            name: name.leak(),
            knows,
            identifier: None,
            parameters: &[],
        },
        summary: "a controller in Python",
        source: "its author",
        laps,
        plane: UNCORRECTED.plane,
        space: UNCORRECTED.space,
    }));
    entries.push(entry);
    entry
}

/// Maker of a controller of the library, from the known values of a machine.
pub(super) struct Informed<'a> {
    task: &'a LabTask,
    known: Known,
}

impl Make for Informed<'_> {
    /// Makes the controller. Its recordings have the noise of the machine file, as in `identified`.
    fn make(&self, setup: &mut Setup<'_>, axes: usize) -> BoxedController {
        let mut reported = Setup::new(&self.task.machine, setup.choices);
        reported.known.clone_from(&self.known);
        self.task.made.make(&mut reported, axes)
    }
}

/// Returns the values identified from a recording of a machine, made once: with the noise of its
/// file, whatever the noise of the cut.
fn identified(machine: &Machine, axes: usize) -> Result<Known> {
    static FOUND: Mutex<VecDeque<(String, Known)>> = Mutex::new(VecDeque::new());
    let kept = || FOUND.lock().unwrap_or_else(PoisonError::into_inner);
    let key = format!(
        "{axes} axes of {}, noise {}",
        machine.fingerprint(),
        machine.noise.seed
    );
    if let Some((_, known)) = kept().iter().find(|(of, _)| *of == key) {
        return Ok(known.clone());
    }
    let choices = Choices {
        seed: RECORDING_SEED,
        ..Choices::default()
    };
    let mut setup = Setup::new(machine, &choices);
    match axes {
        2 => setup.identify_parameters::<2>().into_diagnostic()?,
        _ => setup.identify_parameters::<3>().into_diagnostic()?,
    }
    let mut found = kept();
    found.truncate(KEPT_MACHINES - 1);
    found.push_front((key, setup.known.clone()));
    Ok(setup.known)
}

/// A job, and the knowledge that its controller gets.
pub(super) struct LabTask {
    pub(super) job: Job,
    /// Entry of the controller that is made: one of the library, or else the controller of the job.
    made: &'static Entry,
    pub(super) feeds_mm_s: Option<Vec<f64>>,
    /// Machine with the noise seed of its file.
    machine: Machine,
    knowledge: String,
}

impl LabTask {
    pub(super) fn new(options: &LabOptions) -> Result<Self> {
        let knows = match options.knowledge.as_str() {
            "exact" | "wrong" => Knows::ExactModel,
            "identified" => Knows::Identified,
            other => {
                return Err(miette!(
                    "knowledge is '{other}'; there are exact, identified, wrong"
                ));
            }
        };
        let made = options
            .of_library
            .as_deref()
            .map(|name| find(name, TABLE))
            .transpose()?;
        // A planner's cut needs a name of its own, even if the cut beside it has the same
        // controller.
        let as_it_is = made.filter(|_| options.feeds_mm_s.is_none());
        let laps = made.map_or(1, |made| made.laps);
        let controller = as_it_is.unwrap_or_else(|| entry(&options.name, knows, laps));
        let against = options
            .against
            .as_deref()
            .map_or(Ok(controller), |name| find(name, TABLE))?;
        let made = made.unwrap_or(controller);
        let request = JobRequest {
            seed: RECORDING_SEED,
            exact_settings: true,
            ..asked(&options.request)?
        };
        let mut job = request.job_of([made, against], TABLE, "", &())?;
        job.controller = controller;
        job.choices.tries = false;
        let machine = job.machine.clone();
        if let Some(seed) = options.seed {
            job.machine = machine.with_noise_seed(seed);
        }
        let (feeds_mm_s, knowledge) = (options.feeds_mm_s.clone(), options.knowledge.clone());
        Ok(Self {
            job,
            made,
            feeds_mm_s,
            machine,
            knowledge,
        })
    }

    /// Returns the known values of the machine with `axes` controlled axes.
    pub(super) fn known(&self, axes: usize) -> Result<Known> {
        match self.knowledge.as_str() {
            "wrong" => Ok(self.machine.known().misjudged(ASSUMED[0], ASSUMED[1])),
            "identified" => identified(&self.machine, axes),
            _ => Ok(self.machine.known()),
        }
    }

    /// Returns the maker of the requested controller of the library, with the known values.
    pub(super) fn informed(&self, known: &Known) -> Informed<'_> {
        Informed {
            task: self,
            known: known.clone(),
        }
    }

    /// Returns the figures of a run, as JSON.
    pub(super) fn results(&self, outcome: &JobOutcome) -> Result<String> {
        let mut results = Vec::new();
        outcome
            .write_json(&self.job, &mut results)
            .into_diagnostic()?;
        String::from_utf8(results).into_diagnostic()
    }
}

impl LabOptions {
    pub(super) fn plant_term(&self, py: Python<'_>, raised: &Raised) -> Option<PlantTerm> {
        let function = self.plant_term.as_ref()?.clone_ref(py).into();
        Some(PlantTerm {
            function,
            raised: raised.clone(),
        })
    }
}

/// Returns the known values of each axis, by name: a mapping that cannot be changed.
pub(super) fn reported<'py>(
    py: Python<'py>,
    known: &Known,
    axes: usize,
) -> PyResult<Bound<'py, PyTuple>> {
    let read_only = py.import("types")?.getattr("MappingProxyType")?;
    let axis = |i: usize| {
        let mut axis = known.axis(i).nominal;
        let numbers = PyDict::new(py);
        for number in Parameters::NUMBERS {
            numbers.set_item(number.name, *(number.of)(&mut axis))?;
        }
        read_only.call1((numbers,))
    };
    PyTuple::new(py, (0..axes).map(axis).collect::<PyResult<Vec<_>>>()?)
}
