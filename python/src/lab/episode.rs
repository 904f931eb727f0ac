//! A run that waits for its actions, on a thread of its own. The thread does not touch the
//! interpreter while it waits.
//!
//! ```text
//! caller --- action ---> run          channel; its end ends the run
//! caller <-- window ---- run          channel; behind the last one stand the figures
//! ```

use std::cell::{Cell, RefCell};
use std::io;
use std::rc::Rc;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use feedwright::control::{Command, Controller, Measured, Schedule, Window};
use feedwright::sim::{BoxedController, Known, Row, Sink, Watch};
use feedwright::{Guests, Make, Setup};
use miette::{Report, miette};
use pyo3::prelude::*;

use super::guest::{numbers, schedule};
use super::raised::{GuardedWatch, Raised};
use super::seen::{PythonWindow, SeenWindow, of_three};
use super::task::{LabOptions, LabTask};
use crate::fault::{exception, from_json};

/// Interval between two checks for signals.
const EVERY: Duration = Duration::from_millis(40);

/// Contour error since the last decision.
#[derive(Clone, Copy, Default)]
struct ErrorSums {
    rows: u32,
    sum_um2: f64,
    max_um: f64,
}

/// Messages of the run.
enum EpisodeMessage {
    /// Known values of the machine and number of axes, before the first window.
    Known(Box<Known>, usize),
    Window(Box<SeenWindow>, ErrorSums),
    End(Result<String, Report>, ErrorSums),
}

/// Adds up the errors of the rows that cut.
struct ErrorSink(Rc<Cell<ErrorSums>>);

impl Sink for ErrorSink {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        if row.cutting {
            let ErrorSums {
                rows,
                sum_um2,
                max_um,
            } = self.0.get();
            let error_um = 1e3 * row.contour_error_mm.abs();
            self.0.set(ErrorSums {
                rows: rows + 1,
                sum_um2: sum_um2 + error_um * error_um,
                max_um: max_um.max(error_um),
            });
        }
        Ok(())
    }
}

/// Multiple of the planned feedrate, and offset, mm.
type Action = (f64, [f64; 3]);

/// Controller that sends windows and carries out the actions.
struct Waiting {
    schedule: Schedule,
    shown: Sender<EpisodeMessage>,
    actions: Receiver<Action>,
    errors: Rc<Cell<ErrorSums>>,
    raised: Raised,
}

impl<const N: usize> Controller<N> for Waiting {
    fn schedule(&self) -> Schedule {
        self.schedule
    }

    fn reset(&mut self) {}

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        if self.raised.is_over() {
            return Command::AS_PLANNED;
        }
        let seen = Box::new(SeenWindow::of(
            window,
            Some(measured),
            self.schedule.preview,
        ));
        let sent = self
            .shown
            .send(EpisodeMessage::Window(seen, self.errors.take()))
            .is_ok();
        match self.actions.recv() {
            Ok((rate, offset_mm)) if sent => Command::straight(rate, of_three(offset_mm)),
            _ => {
                self.raised.end();
                Command::AS_PLANNED
            }
        }
    }
}

/// Hands the controller over once, since there is one cut.
struct Once(RefCell<Option<Waiting>>);

impl Make for Once {
    fn make(&self, _: &mut Setup<'_>, axes: usize) -> BoxedController {
        match (self.0.take(), axes) {
            (Some(waiting), 2) => BoxedController::Plane(Box::new(waiting)),
            (Some(waiting), _) => BoxedController::Space(Box::new(waiting)),
            (None, axes) => BoxedController::uncorrected(axes),
        }
    }
}

/// A run on its thread.
struct EpisodeWork {
    task: LabTask,
    schedule: Schedule,
    term: Option<super::guest::PlantTerm>,
    raised: Raised,
}

impl EpisodeWork {
    fn cut(
        &self,
        shown: &Sender<EpisodeMessage>,
        actions: Receiver<Action>,
        errors: &Rc<Cell<ErrorSums>>,
    ) -> Result<String, Report> {
        let job = &self.task.job;
        let watch = GuardedWatch {
            watch: &(),
            raised: self.raised.clone(),
        };
        let checked = job.check()?;
        let axes = checked.axes();
        // If the caller has stopped waiting, the first window ends the run.
        let _ = shown.send(EpisodeMessage::Known(
            Box::new(self.task.known(axes)?),
            axes,
        ));
        let (schedule, raised) = (self.schedule, self.raised.clone());
        let waiting = Waiting {
            schedule,
            shown: shown.clone(),
            actions,
            errors: errors.clone(),
            raised,
        };
        let once = Once(RefCell::new(Some(waiting)));
        let plant = self.term.as_ref().map(|term| {
            move |start_mm: [f64; 3], seed: u64| term.plant(&job.machine, axes, start_mm, seed)
        });
        let plant = plant.as_ref().map(|plant| plant as _);
        let guests = Guests {
            controller: Some(&once),
            plant,
            ..Guests::default()
        };
        let (mut sink, mut end) = (ErrorSink(errors.clone()), self.raised.clone());
        watch.check()?;
        let outcome = checked.run_with(guests, &mut [&mut sink, &mut end], &watch)?;
        self.task.results(&outcome)
    }
}

/// Result of `advance`: the window; then rows, mean square and largest error since the last window;
/// then the figures at the end.
type Advanced<'py> = (
    Option<Bound<'py, PythonWindow>>,
    (u32, f64, f64),
    Option<Bound<'py, PyAny>>,
);

/// A run that waits for its actions.
#[pyclass(module = "feedwright.lab")]
pub(crate) struct Episode {
    reported: Mutex<Receiver<EpisodeMessage>>,
    actions: Option<Sender<Action>>,
    thread: Option<JoinHandle<()>>,
    raised: Raised,
    axes: usize,
    known: Option<Py<pyo3::types::PyTuple>>,
}

#[pymethods]
impl Episode {
    #[new]
    fn new(
        py: Python<'_>,
        servo_periods: u32,
        preview: u32,
        options: LabOptions,
    ) -> PyResult<Self> {
        let schedule = schedule(servo_periods, preview)?;
        let task = LabTask::new(&options).map_err(|error| exception(&error))?;
        let raised = Raised::default();
        let work = EpisodeWork {
            task,
            schedule,
            term: options.plant_term(py, &raised),
            raised: raised.clone(),
        };
        let (shown, reported) = channel();
        let (actions, asked) = channel();
        let thread = thread::Builder::new()
            .name("feedwright episode".to_owned())
            .spawn(move || {
                let errors = Rc::new(Cell::new(ErrorSums::default()));
                let end = work.cut(&shown, asked, &errors);
                // If the caller has stopped waiting, nobody needs the figures.
                let _ = shown.send(EpisodeMessage::End(end, errors.take()));
            })?;
        let mut episode = Self {
            reported: Mutex::new(reported),
            actions: Some(actions),
            thread: Some(thread),
            raised,
            axes: 0,
            known: None,
        };
        if let EpisodeMessage::Known(known, axes) = episode.wait(py)? {
            episode.axes = axes;
            episode.known = Some(super::task::reported(py, &known, axes)?.unbind());
            return Ok(episode);
        }
        Err(exception(&miette!("the program has nothing to cut")))
    }

    /// Number of controlled axes.
    #[getter]
    fn axes(&self) -> usize {
        self.axes
    }

    /// Carries out an action, a multiple of the planned feedrate and an offset, until the next
    /// decision. Without an action, runs to the first decision.
    #[pyo3(signature = (action=None))]
    fn advance<'py>(
        &mut self,
        py: Python<'py>,
        action: Option<(f64, Bound<'py, PyAny>)>,
    ) -> PyResult<Advanced<'py>> {
        let Some(actions) = &self.actions else {
            return Err(exception(&miette!("the episode is over: reset it")));
        };
        if let Some((rate, offset)) = action {
            // If the run has ended, its end is reported.
            let _ = actions.send((
                rate,
                numbers(&offset, self.axes, "the offset of an action")?,
            ));
        }
        let mean = |errors: ErrorSums| {
            (
                errors.rows,
                errors.sum_um2 / f64::from(errors.rows.max(1)),
                errors.max_um,
            )
        };
        match self.wait(py)? {
            EpisodeMessage::Window(seen, errors) => {
                let Some(axes) = &self.known else {
                    return Err(exception(&miette!("the episode has not begun")));
                };
                let window = Bound::new(
                    py,
                    PythonWindow {
                        seen: *seen,
                        axes: axes.clone_ref(py),
                    },
                )?;
                Ok((Some(window), mean(errors), None))
            }
            EpisodeMessage::End(Ok(results), errors) => {
                self.close(py);
                Ok((None, mean(errors), Some(from_json(py, &results)?)))
            }
            EpisodeMessage::End(Err(error), _) => Err(exception(&error)),
            EpisodeMessage::Known(..) => Err(exception(&miette!("the episode begins twice"))),
        }
    }

    /// Ends the run and waits for its end.
    fn close(&mut self, py: Python<'_>) {
        self.actions = None;
        self.raised.end();
        if let Some(thread) = self.thread.take() {
            // A panic was already reported on its thread.
            py.detach(|| drop(thread.join()));
        }
    }
}

impl Episode {
    /// Returns the next message of the run. Raises what a signal or the code of the caller raises.
    fn wait(&self, py: Python<'_>) -> PyResult<EpisodeMessage> {
        loop {
            let reported = py.detach(|| {
                self.reported
                    .lock()
                    .unwrap_or_else(PoisonError::into_inner)
                    .recv_timeout(EVERY)
            });
            match reported {
                Ok(EpisodeMessage::End(end, errors)) => {
                    return self
                        .raised
                        .take()
                        .map_or(Ok(EpisodeMessage::End(end, errors)), Err);
                }
                Ok(reported) => return Ok(reported),
                Err(RecvTimeoutError::Timeout) => py.check_signals()?,
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(exception(&miette!("the episode is over: reset it")));
                }
            }
        }
    }
}

/// Does not wait for the thread: it may need the interpreter, which the caller holds.
impl Drop for Episode {
    fn drop(&mut self) {
        self.raised.end();
    }
}
