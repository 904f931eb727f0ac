//! A corrected program for a control without feedback.

use feedwright::ExportedFigures;
use feedwright::sim::fixed;
use serde_json::{Value, json};

use crate::page::PageWatch;
use crate::request::{Outputs, PageRequest, json};

pub(crate) fn correct(request: &mut PageRequest) -> miette::Result<Outputs> {
    let watch = PageWatch::default();
    let outcome = request.job_request().correct_job(&watch)?.run(&watch)?;
    let program = outcome.program().unwrap_or_default().as_bytes().to_vec();
    let answer = json!({
        "figures": [figures("uncorrected", &outcome.uncorrected), figures("as exported", &outcome.corrected)],
        "control": outcome.control,
        "refusal": outcome.refusal,
        "hint": outcome.hint,
        "stretches": outcome.stretches,
        "stretches_changed": outcome.stretches_changed,
        "rounds": outcome.rounds,
    });
    Ok(vec![json(&answer), program])
}

/// Returns a row of the table of `correct`.
fn figures(name: &str, figures: &ExportedFigures) -> Value {
    let ExportedFigures {
        rms_um,
        max_um,
        time_s,
        blocks,
        ..
    } = figures;
    json!({
        "name": name,
        "time_s": fixed(*time_s, 3),
        "rms_um": fixed(*rms_um, 2),
        "max_um": fixed(*max_um, 2),
        "blocks": blocks,
    })
}
