//! Exceptions in code of the caller during a run: the first one ends the run, and the caller gets
//! it.

use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use feedwright::sim::{Row, Sink, Watch};
use pyo3::prelude::*;

/// State shared by all parts of a run: its end, and the exception.
#[derive(Clone, Default)]
pub(super) struct Raised(Arc<(AtomicBool, Mutex<Option<PyErr>>)>);

impl Raised {
    /// Ends the run.
    pub(super) fn end(&self) {
        self.0.0.store(true, Ordering::Relaxed);
    }

    /// Ends the run with an exception; the first one counts.
    pub(super) fn raise(&self, error: PyErr) {
        self.0
            .1
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .get_or_insert(error);
        self.end();
    }

    pub(super) fn is_over(&self) -> bool {
        self.0.0.load(Ordering::Relaxed)
    }

    /// Returns the exception, if there is one.
    pub(super) fn take(&self) -> Option<PyErr> {
        self.0
            .1
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take()
    }

    /// Calls code of the caller. Returns `None` if it raises or the interpreter is gone;
    /// afterwards, nothing is called any more.
    pub(super) fn call<T>(&self, call: impl FnOnce(Python<'_>) -> PyResult<T>) -> Option<T> {
        if self.is_over() {
            return None;
        }
        let Some(result) = Python::try_attach(call) else {
            self.end();
            return None;
        };
        result.map_err(|error| self.raise(error)).ok()
    }
}

/// Ends a cut in the servo period in which an exception is raised.
impl Sink for Raised {
    fn row(&mut self, _: &Row) -> io::Result<()> {
        if self.is_over() {
            Err(io::Error::other("the code of the caller ended the run"))
        } else {
            Ok(())
        }
    }
}

/// Watch that ends all other work, too.
pub(super) struct GuardedWatch<'a> {
    pub(super) watch: &'a dyn Watch,
    pub(super) raised: Raised,
}

impl Watch for GuardedWatch<'_> {
    fn begin(&self, stage: &str, steps: u64) {
        self.watch.begin(stage, steps);
    }

    fn advance(&self, steps: u64) {
        self.watch.advance(steps);
    }

    fn is_cancelled(&self) -> bool {
        self.raised.is_over() || self.watch.is_cancelled()
    }

    fn clock(&self) -> Duration {
        self.watch.clock()
    }
}
