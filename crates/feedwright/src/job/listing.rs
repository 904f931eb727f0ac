//! The lines of the program that the page shows beside the tool.

use std::collections::BTreeSet;

use super::{Job, JobError};
use crate::report::{ProgramLine, ReportedRun};

/// Largest program that the page lists in full, bytes. Of a larger program it lists the lines of
/// the drawn points.
const WHOLE_BYTES: u64 = 128 << 10;
/// Text that is kept, bytes: deflated, G-code is a quarter of it in the page.
const MOST_BYTES: usize = 512 << 10;
/// Most characters of a listed line; the rest is cut off.
const MOST_CHARACTERS: usize = 160;

impl Job {
    /// The lines in their order.
    pub(super) fn listing(&self, runs: &[ReportedRun]) -> Result<Vec<ProgramLine>, JobError> {
        let (mut file, size_bytes) = self.program.text().map_err(|cause| self.reread(cause))?;
        let whole = size_bytes <= WHOLE_BYTES;
        let drawn: BTreeSet<u32> = match whole {
            true => BTreeSet::new(),
            false => runs
                .iter()
                .flat_map(|run| run.series.points().map(|point| point.line))
                .collect(),
        };
        let (mut listing, mut bytes) = (Vec::new(), 0);
        let mut text = Vec::new();
        for line in 1.. {
            text.clear();
            if file
                .read_until(b'\n', &mut text)
                .map_err(|cause| self.reread(cause))?
                == 0
                || bytes > MOST_BYTES
            {
                break;
            }
            if whole || drawn.contains(&line) {
                let text: String = String::from_utf8_lossy(&text)
                    .trim_end()
                    .chars()
                    .take(MOST_CHARACTERS)
                    .collect();
                bytes += text.len();
                listing.push(ProgramLine { line, text });
            }
        }
        Ok(listing)
    }
}
