//! Runs a job on a thread of its own, while the thread of the caller reports its progress and
//! reacts to Ctrl-C.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use feedwright::sim::Watch;
use miette::Report;
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::fault::exception;

/// Interval between two checks for signals and two reports of progress.
const EVERY: Duration = Duration::from_millis(40);

/// State of a job: stage, steps, cancellation and start.
struct Progress {
    stage: Mutex<(String, u64)>,
    done: AtomicU64,
    cancelled: AtomicBool,
    begun: Instant,
}

impl Watch for Progress {
    fn begin(&self, stage: &str, steps: u64) {
        *self.stage.lock().unwrap_or_else(PoisonError::into_inner) = (stage.to_owned(), steps);
        self.done.store(0, Ordering::Relaxed);
    }

    fn advance(&self, steps: u64) {
        self.done.fetch_add(steps, Ordering::Relaxed);
    }

    fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    fn clock(&self) -> Duration {
        self.begun.elapsed()
    }
}

impl Progress {
    /// Calls the callback with the stage, the done steps and all steps. Raises what the callback or
    /// a signal raises.
    fn call(&self, callback: Option<&Py<PyAny>>) -> PyResult<()> {
        Python::attach(|py| {
            py.check_signals()?;
            let Some(callback) = callback else {
                return Ok(());
            };
            let (stage, steps) = self
                .stage
                .lock()
                .unwrap_or_else(PoisonError::into_inner)
                .clone();
            let done = self.done.load(Ordering::Relaxed).min(steps);
            callback.call1(py, (stage, done, steps)).map(|_| ())
        })
    }
}

/// Runs a job on a thread of its own, without the lock of the interpreter. Meanwhile calls the
/// callback with the stage, the done steps and all steps. If the callback raises, or at Ctrl-C,
/// cancels the job and returns at once: the result of the job is dropped.
pub(crate) fn watched<T: Send + 'static>(
    py: Python<'_>,
    callback: Option<&Py<PyAny>>,
    job: impl FnOnce(&dyn Watch) -> Result<T, Report> + Send + 'static,
) -> PyResult<T> {
    let progress = Arc::new(Progress {
        stage: Mutex::new((String::new(), 0)),
        done: AtomicU64::new(0),
        cancelled: AtomicBool::new(false),
        begun: Instant::now(),
    });
    let (send, done) = channel();
    let of_job = Arc::clone(&progress);
    thread::Builder::new()
        .name("feedwright job".to_owned())
        .spawn(move || {
            // If the caller has stopped waiting, nobody needs the result.
            let _ = send.send(job(&*of_job));
        })?;
    py.detach(move || {
        loop {
            match done.recv_timeout(EVERY) {
                Ok(result) => return result.map_err(|error| exception(&error)),
                Err(RecvTimeoutError::Timeout) => {
                    progress
                        .call(callback)
                        .inspect_err(|_| progress.cancelled.store(true, Ordering::Relaxed))?;
                }
                Err(RecvTimeoutError::Disconnected) => {
                    return Err(PyRuntimeError::new_err(
                        "feedwright has a fault: its work ended without a result",
                    ));
                }
            }
        }
    })
}
