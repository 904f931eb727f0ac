//! Which faults are shown: each place once, however often a loop comes by, and no more than anybody
//! reads.

use std::collections::HashMap;
use std::sync::Arc;

use crate::text::diagnostic::Diagnostic;

/// Faults after which a program is not read any further. Subroutines that call themselves twice and
/// err each time make faults without end from a few lines.
const HOPELESS: usize = 100_000;
/// Places that are remembered; beyond, every fault counts as new.
const MAX_PLACES: usize = 10_000;

/// File, line, column and kind of a fault.
type Place = (Arc<str>, u32, u32, &'static str);

/// Faults so far.
#[derive(Debug, Default)]
pub(super) struct Faults {
    /// Faults at new places.
    count: usize,
    /// All, with those of loops.
    met: usize,
    times: HashMap<Place, u64>,
}

pub(super) fn place(diagnostic: &Diagnostic) -> Place {
    (
        diagnostic.file.clone(),
        diagnostic.line,
        diagnostic.column,
        diagnostic.code,
    )
}

impl Faults {
    /// Counts a fault; true where it is to be shown: the first of its place, and within the limit.
    pub(super) fn add(&mut self, diagnostic: &Diagnostic, most: usize) -> bool {
        self.met += 1;
        if self.is_known(diagnostic) {
            return false;
        }
        self.count += 1;
        self.count <= most
    }

    /// Returns true if this fault or warning has come up at its place before, and counts it.
    pub(super) fn is_known(&mut self, diagnostic: &Diagnostic) -> bool {
        if let Some(times) = self.times.get_mut(&place(diagnostic)) {
            *times += 1;
            return true;
        }
        if self.times.len() < MAX_PLACES {
            self.times.insert(place(diagnostic), 1);
        }
        false
    }

    /// Returns how often a fault or warning has come up at its place.
    pub(super) fn times(&self, diagnostic: &Diagnostic) -> u64 {
        self.times.get(&place(diagnostic)).copied().unwrap_or(1)
    }

    /// Returns true if there are too many faults to read on.
    pub(super) const fn are_hopeless(&self) -> bool {
        self.met >= HOPELESS
    }

    /// Returns the closing message with the number of faults that were not shown, and resets the
    /// counts. Returns `None` if all were shown.
    pub(super) fn rest(&mut self, most: usize) -> Option<String> {
        let more = self.count.saturating_sub(most);
        let unread = if self.are_hopeless() {
            "; the rest of the program was not read"
        } else {
            ""
        };
        let said = match (more, unread) {
            (0, "") => None,
            (0, _) => Some(
                "the same errors come again and again; the rest of the program was not read"
                    .to_owned(),
            ),
            _ => Some(format!("and {more} more errors{unread}")),
        };
        (self.count, self.met) = (0, 0);
        said
    }
}
