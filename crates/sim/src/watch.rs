//! Who is told how far work has come, can end it, and has the clock.

use std::time::Duration;

use thiserror::Error;

/// Is told of the progress of long work, from any of its threads, and is asked whether it shall go on.
///
/// Work of one stage has a number of steps; it is asked at least every second of a core's time.
pub trait Watch: Sync {
    /// Called when a stage of `steps` steps begins.
    fn begin(&self, stage: &str, steps: u64) {
        let _ = (stage, steps);
    }

    /// Called when another `steps` steps are done.
    fn advance(&self, steps: u64) {
        let _ = steps;
    }

    /// Whether to end the work: nothing that is unfinished is kept.
    fn is_cancelled(&self) -> bool {
        false
    }

    /// Time since a fixed moment, which times the ticks. Without a clock they count as taking no time.
    fn clock(&self) -> Duration {
        Duration::ZERO
    }

    /// Ends the work where that is asked for.
    ///
    /// # Errors
    /// [`Cancelled`].
    fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }
}

/// Ignores the progress, never cancels, and has no clock.
impl Watch for () {}

/// Steps of a stage that is told by parts.
const STEPS: u64 = 1000;

/// The steps of a stage by the part of it that is done.
pub struct StageSteps<'a> {
    watch: &'a dyn Watch,
    done: u64,
}

impl<'a> StageSteps<'a> {
    /// A stage begins.
    pub fn begin(watch: &'a dyn Watch, stage: &str) -> Self {
        watch.begin(stage, STEPS);
        Self { watch, done: 0 }
    }

    /// So large a part is done, 0 to 1.
    pub fn reach(&mut self, part: f64) {
        // A float that is not a number saturates to zero here.
        let done = ((part * STEPS as f64) as u64).min(STEPS).max(self.done);
        self.watch.advance(done - self.done);
        self.done = done;
    }
}

/// The work was ended from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error, miette::Diagnostic)]
#[error("interrupted; no file was written")]
pub struct Cancelled;
