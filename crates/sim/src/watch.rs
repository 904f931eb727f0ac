//! Progress, cancellation and clock of long work.

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use thiserror::Error;

/// Receives the progress of long work from any of its threads, can cancel the work, and supplies
/// the clock.
///
/// The work of one stage has a number of steps. It checks for cancellation at least once per second
/// of a core's time.
pub trait Watch: Sync {
    /// Called when a stage of `steps` steps begins.
    fn begin(&self, stage: &str, steps: u64) {
        let _ = (stage, steps);
    }

    /// Called when another `steps` steps are done.
    fn advance(&self, steps: u64) {
        let _ = steps;
    }

    /// Returns true to cancel the work; unfinished results are discarded.
    fn is_cancelled(&self) -> bool {
        false
    }

    /// Time since a fixed moment, which times the ticks. Without a clock they count as taking no
    /// time.
    fn clock(&self) -> Duration {
        Duration::ZERO
    }

    /// Fails if the work is cancelled.
    ///
    /// # Errors
    /// [`Cancelled`].
    fn check(&self) -> Result<(), Cancelled> {
        if self.is_cancelled() {
            Err(Cancelled)
        } else {
            Ok(())
        }
    }
}

/// Ignores the progress, never cancels, and has no clock.
impl Watch for () {}

/// Steps of a stage whose progress is reported as a fraction.
const STEPS: u64 = 1000;

/// Progress of a stage, reported as a fraction of it.
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

    /// Reports that the fraction `part` is done, 0 to 1.
    pub fn reach(&mut self, part: f64) {
        // A float that is not a number saturates to zero here.
        let done = ((part * STEPS as f64) as u64).min(STEPS).max(self.done);
        self.watch.advance(done - self.done);
        self.done = done;
    }

    /// Does work that reports its own stages: each of them fills this stage from its present
    /// progress up to the fraction `to`.
    pub fn filled<T>(&mut self, to: f64, work: impl FnOnce(&dyn Watch) -> T) -> T {
        let most = ((to * STEPS as f64) as u64).clamp(self.done, STEPS) - self.done;
        let part = StagePart {
            watch: self.watch,
            most,
            reported: AtomicU64::new(0),
            steps: AtomicU64::new(0),
            done: AtomicU64::new(0),
        };
        let result = work(&part);
        self.done += part.reported.into_inner();
        self.reach(to);
        result
    }
}

/// Reports the stages of some work as a fraction of another stage.
struct StagePart<'a> {
    watch: &'a dyn Watch,
    /// Steps of the outer stage that the work fills, and the steps that were reported to it.
    most: u64,
    reported: AtomicU64,
    /// Steps of the stage of the work, and those that are done.
    steps: AtomicU64,
    done: AtomicU64,
}

impl Watch for StagePart<'_> {
    fn begin(&self, _stage: &str, steps: u64) {
        self.steps.store(steps, Ordering::Relaxed);
        self.done.store(0, Ordering::Relaxed);
    }

    fn advance(&self, steps: u64) {
        let done = self.done.fetch_add(steps, Ordering::Relaxed) + steps;
        let of = self.steps.load(Ordering::Relaxed).max(1);
        let reached = (self.most as f64 * (done as f64 / of as f64).min(1.0)) as u64;
        let reported = self.reported.fetch_max(reached, Ordering::Relaxed);
        self.watch.advance(reached.saturating_sub(reported));
    }

    fn is_cancelled(&self) -> bool {
        self.watch.is_cancelled()
    }

    fn clock(&self) -> Duration {
        self.watch.clock()
    }
}

/// The work was ended from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error, miette::Diagnostic)]
#[error("interrupted; no file was written")]
pub struct Cancelled;

#[cfg(test)]
mod tests {
    use std::sync::Mutex;

    use super::*;

    /// Stages with their steps, and the steps that are done.
    #[derive(Default)]
    struct Reported(Mutex<Vec<(String, u64, u64)>>);

    impl Watch for Reported {
        fn begin(&self, stage: &str, steps: u64) {
            self.0.lock().unwrap().push((stage.to_owned(), steps, 0));
        }

        fn advance(&self, steps: u64) {
            self.0.lock().unwrap().last_mut().unwrap().2 += steps;
        }
    }

    #[test]
    fn stages_of_work_within_a_stage_fill_their_part_of_it() {
        let reported = Reported::default();
        let mut steps = StageSteps::begin(&reported, "identifying");
        steps.reach(0.1);
        let of = |reported: &Reported| reported.0.lock().unwrap().clone();
        steps.filled(0.6, |watch| {
            let mut inner = StageSteps::begin(watch, "reading");
            inner.reach(0.5);
            assert_eq!(of(&reported), [("identifying".to_owned(), STEPS, 350)]);
            // A second stage goes over the same part, and takes nothing back.
            let mut inner = StageSteps::begin(watch, "fitting");
            inner.filled(0.8, |watch| StageSteps::begin(watch, "an axis").reach(1.0));
            assert_eq!(of(&reported)[0].2, 500);
            inner.reach(0.9);
        });
        assert_eq!(of(&reported), [("identifying".to_owned(), STEPS, 600)]);
        steps.reach(1.0);
        assert_eq!(of(&reported)[0].2, STEPS);
    }
}
