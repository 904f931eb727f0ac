//! Remarks on a corrected program that several commands print.

use std::io::{self, Write};

use crate::command::terminal::wrapped;
use crate::correct::feed_overrides::override_sentence;
use crate::correct::{CorrectOutcome, FileAssumption, UnchangedStretch};

/// Unchanged stretches that are listed for each reason.
const LISTED: usize = 6;

/// Prints what was changed, and the reason if no program is written.
pub(crate) fn print_correction(out: &mut dyn Write, outcome: &CorrectOutcome) -> io::Result<()> {
    let CorrectOutcome {
        stretches,
        stretches_changed,
        rounds,
        ..
    } = outcome;
    let changed = format!(
        "{stretches_changed} of {stretches} stretches between corners were changed, found in {rounds} simulated cuts"
    );
    writeln!(out, "{}", wrapped(&changed, 2))?;
    if let Some(assumed) = outcome.assumed.as_ref().map(FileAssumption::sentence) {
        writeln!(out, "{}", wrapped(&assumed, 2))?;
    }
    for sentence in UnchangedStretch::sentences(&outcome.unchanged, LISTED) {
        writeln!(out, "{}", wrapped(&sentence, 2))?;
    }
    if let Some(sentence) = override_sentence(&outcome.feed_overrides) {
        writeln!(out, "{}", wrapped(&sentence, 2))?;
    }
    if outcome.expanded {
        writeln!(out, "loops and subroutines are written out")?;
    }
    match &outcome.refusal {
        Some(refusal) => writeln!(
            out,
            "{}",
            wrapped(&format!("no corrected program: {refusal}"), 2)
        )?,
        None => return Ok(()),
    }
    match &outcome.hint {
        Some(hint) => writeln!(out, "{}", wrapped(&format!("  hint: {hint}"), 8)),
        None => Ok(()),
    }
}
