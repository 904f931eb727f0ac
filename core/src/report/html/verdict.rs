//! The verdict: what came out, in one sentence.

use crate::report::text::{change, duration, escaped, number};
use crate::report::{Outcome, Report, RunSummary};

/// The sentence, as HTML.
pub(super) fn verdict(report: &Report) -> String {
    let Some(last) = report.runs.last().map(|run| &run.summary) else {
        return "No run was made.".to_owned();
    };
    match &last.outcome {
        Outcome::Completed => {}
        Outcome::Diverged { at_s } => {
            return format!("{} diverged at {}: the tool ran away from the path.", name(last), duration(*at_s));
        }
    }
    let first = &report.runs[0].summary;
    let numbers = if report.runs.len() == 1 {
        format!(
            "RMS contour error <b>{} µm</b>, largest <b>{} µm</b>, machining time <b>{}</b>",
            number(last.rms_um),
            number(last.max_um),
            duration(last.time_s)
        )
    } else {
        format!(
            "RMS contour error {}, largest {}, machining time {}",
            step(first.rms_um, last.rms_um, &|x| format!("{} µm", number(x))),
            step(first.max_um, last.max_um, &|x| format!("{} µm", number(x))),
            step(first.time_s, last.time_s, &duration)
        )
    };
    let tolerance = match report.tolerance_um {
        Some(limit) if last.max_um <= limit => {
            format!(": within the tolerance of {} µm", number(limit))
        }
        Some(limit) => format!(": out of the tolerance of {} µm", number(limit)),
        None => String::new(),
    };
    let faded = last.faded_out.map_or(String::new(), |faded| {
        let (name, from, share) = (name(last), duration(faded.at_s), number(100.0 * last.engaged_share));
        let cause = faded.cause;
        format!(" {name} was in the loop for {share} % of the cut; the safety layer took it out last at {from}, because {cause}.")
    });
    format!("{numbers}{tolerance}.{faded}")
}

fn name(run: &RunSummary) -> String {
    format!("<b>{}</b>", escaped(&run.controller))
}

/// "18.0 µm → 2.40 µm (−87 %)".
fn step(before: f64, after: f64, text: &dyn Fn(f64) -> String) -> String {
    let change = change(before, after).map_or(String::new(), |c| format!(" <span class=\"change\">({c})</span>"));
    format!("<span class=\"step\">{} → <b>{}</b>{change}</span>", text(before), text(after))
}
