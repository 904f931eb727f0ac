//! A progress bar on stderr, where stderr is a terminal.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use feedwright::watch::Watch;
use indicatif::{ProgressBar, ProgressStyle};

/// Shows the progress of work, and tells it of an interrupt.
pub(crate) struct Bar {
    bar: ProgressBar,
    interrupted: Arc<AtomicBool>,
}

impl Bar {
    /// Where stderr is no terminal, nothing is drawn.
    pub(crate) fn new(quiet: bool, steps: u64, interrupted: Arc<AtomicBool>) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(steps) };
        // A template that is written here parses.
        if let Ok(style) = ProgressStyle::with_template("{msg:32} {bar:40} {percent:>3} % {eta:>4}") {
            bar.set_style(style);
        }
        Self { bar, interrupted }
    }

    pub(crate) fn say(&self, message: impl Into<String>) {
        self.bar.set_message(message.into());
    }

    /// Does something that prints, with the bar out of the way.
    pub(crate) fn aside<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    pub(crate) fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl Watch for Bar {
    fn begin(&self, stage: &str, steps: u64) {
        self.bar.set_length(steps);
        self.bar.set_position(0);
        self.say(stage);
    }

    fn advance(&self, steps: u64) {
        self.bar.inc(steps);
    }

    fn is_cancelled(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}
