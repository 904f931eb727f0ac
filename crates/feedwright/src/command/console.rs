//! What a command shows, and how it is interrupted.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::command::message::{INTERRUPTED, interrupted as report_interrupted};
use crate::command::progress::Bar;
use crate::output::exit_without_files;

/// Signals that follow each other faster are one: some shells send it to the process and to its
/// group.
const PATIENCE: Duration = Duration::from_millis(500);

/// Time in which work that was interrupted may end by itself.
const GRACE: Duration = Duration::from_millis(700);

/// The terminal of a command.
pub struct Console {
    quiet: bool,
    interrupted: Arc<AtomicBool>,
}

impl Console {
    /// Ctrl-C ends the process at once.
    pub(crate) fn new(quiet: bool) -> Self {
        Self {
            quiet,
            interrupted: Arc::default(),
        }
    }

    /// Ends the work at the next chance after Ctrl-C or a request to terminate, so that no file is
    /// left half-written. Work without such a chance within [`GRACE`] ends with the process.
    /// Another signal [`PATIENCE`] later or more also ends all work.
    pub(crate) fn listen(&self) {
        let interrupted = self.interrupted.clone();
        let mut first: Option<Instant> = None;
        let listening = ctrlc::set_handler(move || {
            if !interrupted.swap(true, Ordering::Relaxed) {
                std::thread::spawn(|| {
                    std::thread::sleep(GRACE);
                    report_interrupted();
                    exit_without_files(INTERRUPTED);
                });
            }
            if first.get_or_insert_with(Instant::now).elapsed() > PATIENCE {
                std::process::exit(INTERRUPTED.into());
            }
        });
        if let Err(error) = listening {
            eprintln!("warning: an interrupt may leave unfinished files behind: {error}");
        }
    }

    /// A progress bar with `steps` steps, hidden on a quiet console.
    pub fn bar(&self, steps: u64) -> Bar {
        Bar::new(self.quiet, steps, self.interrupted.clone())
    }

    /// A progress bar, or none where it would be in the way.
    pub(crate) fn bar_unless(&self, hidden: bool, steps: u64) -> Bar {
        Bar::new(self.quiet || hidden, steps, self.interrupted.clone())
    }

    /// Returns true if remarks and progress are left out.
    pub const fn is_quiet(&self) -> bool {
        self.quiet
    }

    pub(crate) fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}
