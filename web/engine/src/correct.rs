//! A corrected program for a control without feedback.

use feedwright::sim::fixed;
use feedwright::{CorrectJob, ExportedFigures, TARGETS, TargetControl};
use serde_json::{Value, json};

use crate::page::PageWatch;
use crate::request::{Outputs, Request, json};

pub(crate) fn correct(request: &mut Request) -> miette::Result<Outputs> {
    let target = match &request.target {
        None => &TARGETS[0],
        Some(name) => TargetControl::find(name)
            .ok_or_else(|| miette::miette!("no control is called '{name}'"))?,
    };
    let mut job = CorrectJob::new(request.take_program(), request.machine()?, target);
    job.file_error = CorrectJob::usual_file_error(request.is_machine_text());
    let outcome = job.run(&PageWatch::default())?;
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
