//! A progress bar on stderr, where stderr is a terminal.

use std::fmt::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use feedwright_gcode::visible;
use feedwright_sim::Watch;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use crate::command::terminal::{is_dumb, shows_unicode};

/// Shows the progress of work, tells it of an interrupt, and has its clock.
pub struct Bar {
    bar: ProgressBar,
    interrupted: Arc<AtomicBool>,
    began: Instant,
}

impl Bar {
    /// Where stderr is no terminal, or one without a cursor, nothing is drawn.
    pub(crate) fn new(quiet: bool, steps: u64, interrupted: Arc<AtomicBool>) -> Self {
        let bar = if quiet || is_dumb() { ProgressBar::hidden() } else { ProgressBar::new(steps) };
        // A template that is written here parses.
        if let Ok(style) = ProgressStyle::with_template("{msg:32!} {wide_bar} {percent:>3} % {left:>14}") {
            let style = style.with_key("left", |state: &ProgressState, out: &mut dyn Write| {
                // Writing to a line does not fail.
                let _ = out.write_str(&left(state.eta(), state.pos(), state.len().unwrap_or(0)));
            });
            bar.set_style(if shows_unicode() { style } else { style.progress_chars("#> ") });
        }
        Self { bar, interrupted, began: Instant::now() }
    }

    pub fn say(&self, message: impl Into<String>) {
        self.bar.set_message(visible(&message.into()).into_owned());
    }

    /// Does something that prints, with the bar out of the way.
    pub fn aside<T>(&self, print: impl FnOnce() -> T) -> T {
        self.bar.suspend(print)
    }

    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// How long a stage still takes; nothing where that cannot be told.
fn left(eta: Duration, done: u64, steps: u64) -> String {
    if done == 0 || done >= steps {
        return String::new();
    }
    match eta.as_secs() {
        0 => "1 s left".to_owned(),
        seconds @ 1..60 => format!("{seconds} s left"),
        seconds @ 60..3600 => format!("{} min left", (seconds + 30) / 60),
        seconds => format!("{:.1} h left", seconds as f64 / 3600.0),
    }
}

impl Watch for Bar {
    fn begin(&self, stage: &str, steps: u64) {
        self.bar.set_length(steps);
        self.bar.set_position(0);
        // What is left is judged by the speed of this stage alone.
        self.bar.reset_eta();
        self.say(stage);
    }

    fn advance(&self, steps: u64) {
        self.bar.inc(steps);
    }

    fn is_cancelled(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }

    fn clock(&self) -> Duration {
        self.began.elapsed()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_told_once_it_is_known() {
        let shown = |seconds: u64, done: u64| left(Duration::from_secs(seconds), done, 10);
        assert_eq!([shown(0, 0), shown(5, 10)], ["", ""]);
        assert_eq!(
            [shown(0, 3), shown(59, 3), shown(90, 3), shown(5400, 3)],
            ["1 s left", "59 s left", "2 min left", "1.5 h left"]
        );
    }
}
