//! What a command shows, and how it is interrupted.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use crate::command::message::INTERRUPTED;
use crate::command::progress::Bar;

/// Signals that follow each other faster are one: some shells send it to the process and to its group.
const PATIENCE: Duration = Duration::from_millis(500);

/// The terminal of a command.
pub struct Console {
    quiet: bool,
    interrupted: Arc<AtomicBool>,
}

impl Console {
    /// Ctrl-C ends the process at once.
    pub(crate) fn new(quiet: bool) -> Self {
        Self { quiet, interrupted: Arc::default() }
    }

    /// From here on Ctrl-C, or a request to terminate, ends the work at the next chance, so that no file is left half-written;
    /// another one, [`PATIENCE`] later or more, ends the process.
    pub(crate) fn listen(&self) {
        let interrupted = self.interrupted.clone();
        let mut first: Option<Instant> = None;
        let listening = ctrlc::set_handler(move || {
            interrupted.store(true, Ordering::Relaxed);
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

    /// Whether remarks and progress are left out.
    pub const fn is_quiet(&self) -> bool {
        self.quiet
    }

    pub(crate) fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}
