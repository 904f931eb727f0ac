//! The gym: controllers and terms of the plant in Python take part in a run.
//!
//! | File | Content |
//! |---|---|
//! | `lab/seen.rs` | inputs of a controller, as copies |
//! | `lab/raised.rs` | an exception in code of the caller ends the run |
//! | `lab/guest.rs` | a controller and a term of the plant that are objects of Python |
//! | `lab/task.rs` | the work of a run, and the known values of the machine |
//! | `lab/episode.rs` | a run that waits for its actions |
//! | `lab/held_out.rs` | held-out work by seeds, and a page of tables |

mod seen;
mod raised;
mod guest;
mod task;
pub(crate) mod episode;
pub(crate) mod held_out;

use std::sync::mpsc::channel;

use feedwright::Guests;
use feedwright::sim::{Sink, Watch};
use miette::{Result, miette};
use pyo3::prelude::*;

pub(crate) use seen::{MeasuredTool, PythonWindow};

use crate::columns::RowColumns;
use crate::fault::from_json;
use crate::jobs::{CutOutcome, Ran};
use crate::watched::watched;
use guest::{PlantTerm, PythonController};
use raised::{GuardedWatch, Raised};
use task::{LabOptions, LabTask, reported};

/// A cut with a controller of Python.
struct GuestRun {
    task: LabTask,
    /// `None` if the controller is one of the library.
    controller: Option<Py<PyAny>>,
    term: Option<PlantTerm>,
    rows: bool,
    raised: Raised,
}

impl GuestRun {
    fn cut(&self, watch: &dyn Watch) -> Result<(String, Option<RowColumns>, CutOutcome)> {
        let watch = GuardedWatch {
            watch,
            raised: self.raised.clone(),
        };
        watch.begin("reading the program", 1);
        let job = &self.task.job;
        let checked = job.check()?;
        let axes = checked.axes();
        let known = self.task.known(axes)?;
        let made = |controller: &Py<PyAny>| {
            let made = self.raised.call(|py| {
                let reported = reported(py, &known, axes)?;
                PythonController::new(
                    controller.bind(py),
                    &reported,
                    known.period.servo_s,
                    self.raised.clone(),
                )
            });
            made.ok_or_else(|| miette!("the controller could not be made"))
        };
        let (controller, informed) = (
            self.controller.as_ref().map(made).transpose()?,
            self.task.informed(&known),
        );
        let plant = self.term.as_ref().map(|term| {
            move |start_mm: [f64; 3], seed: u64| term.plant(&job.machine, axes, start_mm, seed)
        });
        let plant = plant.as_ref().map(|plant| plant as _);
        let feeds_mm_s = self.task.feeds_mm_s.as_deref();
        let guests = Guests {
            controller: match &controller {
                Some(controller) => Some(controller),
                None => Some(&informed),
            },
            feeds_mm_s,
            plant,
        };
        let (mut columns, mut end) = (RowColumns::new(axes), self.raised.clone());
        let mut sinks: Vec<&mut dyn Sink> = vec![&mut end];
        if self.rows {
            sinks.push(&mut columns);
        }
        let outcome = checked.run_with(guests, &mut sinks, &watch)?;
        Ok((
            self.task.results(&outcome)?,
            self.rows.then_some(columns),
            CutOutcome { outcome },
        ))
    }
}

/// Cuts a program without a correction and with a controller of Python, in a simulation.
#[pyfunction]
pub(crate) fn run_with<'py>(
    py: Python<'py>,
    controller: Py<PyAny>,
    options: LabOptions,
    progress: Option<Py<PyAny>>,
) -> PyResult<Ran<'py>> {
    let task = LabTask::new(&options).map_err(|error| crate::fault::exception(&error))?;
    let raised = Raised::default();
    let (term, rows) = (options.plant_term(py, &raised), options.rows);
    let controller = options.of_library.is_none().then_some(controller);
    let calls = controller.is_some() || term.is_some();
    let run = GuestRun {
        task,
        controller,
        term,
        rows,
        raised: raised.clone(),
    };
    let (running, ended) = channel::<()>();
    let done = watched(py, progress.as_ref(), move |watch| {
        let _running = running;
        // A thread that calls code of the caller keeps its interpreter state from call to call.
        if calls {
            Python::attach(|py| py.detach(|| run.cut(watch)))
        } else {
            run.cut(watch)
        }
    });
    if done.is_err() && calls {
        // Waits for the thread, so that no code of the caller is called after the return.
        raised.end();
        let _ = py.detach(move || ended.recv());
    }
    if let Some(error) = raised.take() {
        return Err(error);
    }
    let (results, columns, outcome) = done?;
    let columns = columns.map(|columns| columns.into_arrays(py)).transpose()?;
    Ok((from_json(py, &results)?, columns, outcome))
}
