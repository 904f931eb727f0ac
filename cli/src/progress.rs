//! A progress bar on stderr, where stderr is a terminal.

use feedwright::pipeline::{Progress, Stage};
use indicatif::{ProgressBar, ProgressStyle};

/// Steps of a bar whose part runs from 0 to 1.
const STEPS: u64 = 1000;

/// Shows the stages of a job. Where stderr is no terminal, nothing is drawn.
pub(crate) struct Bar(ProgressBar);

impl Bar {
    pub(crate) fn new(quiet: bool, steps: u64) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(steps) };
        // A template that is written here parses.
        if let Ok(style) = ProgressStyle::with_template("{msg:32} {bar:40} {percent:>3} % {eta:>4}") {
            bar.set_style(style);
        }
        Self(bar)
    }

    /// The bar of one job.
    pub(crate) fn of_job(quiet: bool) -> Self {
        Self::new(quiet, STEPS)
    }

    /// Begins anew with so many steps.
    pub(crate) fn begin(&self, message: &'static str, steps: u64) {
        self.0.set_length(steps);
        self.0.set_position(0);
        self.say(message);
    }

    pub(crate) fn say(&self, message: impl Into<String>) {
        self.0.set_message(message.into());
    }

    pub(crate) fn step(&self) {
        self.advance(1);
    }

    pub(crate) fn advance(&self, steps: u64) {
        self.0.inc(steps);
    }

    /// Does something that prints, with the bar out of the way.
    pub(crate) fn aside<T>(&self, print: impl FnOnce() -> T) -> T {
        self.0.suspend(print)
    }

    pub(crate) fn clear(&self) {
        self.0.finish_and_clear();
    }
}

impl Progress for Bar {
    fn stage(&mut self, stage: Stage) {
        self.say(match stage {
            Stage::Reading => "reading the program".to_owned(),
            Stage::Preparing { controller } => format!("identifying for {controller}"),
            Stage::Cutting { controller } => format!("cutting, {controller}"),
            Stage::Writing => "writing".to_owned(),
        });
        self.0.set_position(0);
    }

    fn part(&mut self, part: f64) {
        self.0.set_position((part * STEPS as f64) as u64);
    }
}
