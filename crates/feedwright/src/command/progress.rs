//! A progress bar on stderr, where stderr is a terminal.
//!
//! A thread of its own draws the bar ten times a second: a stage shows when it begins, even if its
//! first step takes long.

use std::fmt::Write;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use feedwright_gcode::visible;
use feedwright_sim::Watch;
use indicatif::{ProgressBar, ProgressState, ProgressStyle};

use crate::command::terminal::{is_dumb, shows_unicode};

/// Time between two drawings of the bar: short enough that a stage seems to show at once.
const DRAWN_EACH: Duration = Duration::from_millis(100);

/// Shows the progress of work, passes an interrupt on to it, and provides its clock.
pub struct Bar {
    bar: ProgressBar,
    interrupted: Arc<AtomicBool>,
    began: Instant,
}

impl Bar {
    /// Creates the bar. Nothing is drawn where stderr is not a terminal or has no cursor.
    pub(crate) fn new(quiet: bool, steps: u64, interrupted: Arc<AtomicBool>) -> Self {
        let bar = if quiet || is_dumb() {
            ProgressBar::hidden()
        } else {
            ProgressBar::new(steps)
        };
        Self::on(bar, interrupted)
    }

    fn on(bar: ProgressBar, interrupted: Arc<AtomicBool>) -> Self {
        // A template that is written here parses. Writing to a line does not fail.
        if let Ok(style) = ProgressStyle::with_template("{msg:32!} {wide_bar} {done:>5} {left:>14}")
        {
            let style = style
                .with_key("done", |state: &ProgressState, out: &mut dyn Write| {
                    let _ = out.write_str(&done(state.pos(), state.len().unwrap_or(0)));
                })
                .with_key("left", |state: &ProgressState, out: &mut dyn Write| {
                    let _ =
                        out.write_str(&left(state.eta(), state.pos(), state.len().unwrap_or(0)));
                });
            bar.set_style(if shows_unicode() {
                style
            } else {
                style.progress_chars("#> ")
            });
        }
        if !bar.is_hidden() {
            bar.enable_steady_tick(DRAWN_EACH);
        }
        Self {
            bar,
            interrupted,
            began: Instant::now(),
        }
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

/// Formats the completed share of a stage. The text is empty before the first step, because a stage
/// may have only one. 100 % appears only at the end.
fn done(done: u64, steps: u64) -> String {
    match done {
        0 => String::new(),
        _ => format!("{} %", 100 * done.min(steps) / steps.max(1)),
    }
}

/// Formats the remaining time of a stage; empty before the first step and at the end.
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
    use std::io;
    use std::sync::Mutex;

    use indicatif::{ProgressDrawTarget, TermLike};

    use super::*;

    /// A terminal that keeps what is written to it.
    #[derive(Debug, Clone, Default)]
    struct Kept(Arc<Mutex<String>>);

    impl TermLike for Kept {
        fn width(&self) -> u16 {
            100
        }

        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }

        fn write_line(&self, line: &str) -> io::Result<()> {
            self.write_str(line)
        }

        fn write_str(&self, text: &str) -> io::Result<()> {
            self.0.lock().unwrap().push_str(text);
            Ok(())
        }

        fn clear_line(&self) -> io::Result<()> {
            Ok(())
        }

        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_stage_shows_before_its_first_step_though_the_one_before_was_drawn_just_now() {
        let terminal = Kept::default();
        let target = ProgressDrawTarget::term_like(Box::new(terminal.clone()));
        let bar = Bar::on(
            ProgressBar::with_draw_target(Some(0), target),
            Arc::default(),
        );
        bar.begin("cutting, uncorrected", 1000);
        (0..999).for_each(|_| bar.advance(1));
        bar.begin("identifying mine", 1000);
        let shows = |what: &str| {
            (0..1000).any(|_| {
                std::thread::sleep(Duration::from_millis(10));
                terminal.0.lock().unwrap().contains(what)
            })
        };
        assert!(shows("identifying mine"), "{terminal:?}");
        let text = terminal.0.lock().unwrap().clone();
        assert!(
            !text.contains("100 %") && !text[text.find("identifying").unwrap()..].contains('%'),
            "{text}"
        );
        bar.advance(370);
        assert!(shows("37 %"), "{terminal:?}");
    }

    #[test]
    fn a_stage_is_done_when_all_of_its_steps_are() {
        assert_eq!(
            [
                done(0, 1000),
                done(1, 1000),
                done(999, 1000),
                done(1000, 1000)
            ],
            ["", "0 %", "99 %", "100 %"]
        );
    }

    #[test]
    fn the_time_left_is_reported_once_it_is_known() {
        let shown = |seconds: u64, done: u64| left(Duration::from_secs(seconds), done, 10);
        assert_eq!([shown(0, 0), shown(5, 10)], ["", ""]);
        assert_eq!(
            [shown(0, 3), shown(59, 3), shown(90, 3), shown(5400, 3)],
            ["1 s left", "59 s left", "2 min left", "1.5 h left"]
        );
    }
}
