//! What a command shows, and how it is interrupted.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::message::INTERRUPTED;
use crate::progress::Bar;

/// The terminal of a command.
pub(crate) struct Console {
    quiet: bool,
    interrupted: Arc<AtomicBool>,
}

impl Console {
    /// Ctrl-C ends the process at once.
    pub(crate) fn new(quiet: bool) -> Self {
        Self { quiet, interrupted: Arc::default() }
    }

    /// From here on Ctrl-C, or a request to terminate, ends the work at the next chance, so that no file is left half-written;
    /// the second one ends the process.
    pub(crate) fn listen(&self) {
        let interrupted = self.interrupted.clone();
        let listening = ctrlc::set_handler(move || {
            if interrupted.swap(true, Ordering::Relaxed) {
                std::process::exit(INTERRUPTED.into());
            }
        });
        if let Err(error) = listening {
            eprintln!("warning: an interrupt may leave unfinished files behind: {error}");
        }
    }

    /// A progress bar of so many steps.
    pub(crate) fn bar(&self, steps: u64) -> Bar {
        Bar::new(self.quiet, steps, self.interrupted.clone())
    }

    /// A progress bar, or none where it would be in the way.
    pub(crate) fn bar_unless(&self, hidden: bool, steps: u64) -> Bar {
        Bar::new(self.quiet || hidden, steps, self.interrupted.clone())
    }

    pub(crate) const fn is_quiet(&self) -> bool {
        self.quiet
    }

    pub(crate) fn is_interrupted(&self) -> bool {
        self.interrupted.load(Ordering::Relaxed)
    }
}
