//! A cut without a correction and one with a controller.

use feedwright::sim::{Sink, TraceWriter, Transition, fixed};
use feedwright::{CONTROLLERS, LimitBand, ReportedRun, write_html, write_html_data};
use miette::IntoDiagnostic;
use serde_json::{Value, json};

use crate::page::{PageCut, PageWatch};
use crate::request::{Outputs, PageRequest, json};

/// Number of points of a cut along the diagonal of its box: about two pixels apart on a large
/// screen.
const POINTS_ON_DIAGONAL: f64 = 1500.0;

pub(crate) fn run(request: &mut PageRequest) -> miette::Result<Outputs> {
    let watch = PageWatch::default();
    let today = request.recorded_on.clone().unwrap_or_default();
    let job = request.job_request().job(CONTROLLERS, &today, &watch)?;
    let checked = job.check()?;
    let (axes, [low_mm, high_mm]) = (checked.axes(), checked.summary().box_mm);
    let squares = (0..3).map(|axis| (high_mm[axis] - low_mm[axis]).powi(2));
    let mut drawn = PageCut::new(squares.sum::<f64>().sqrt() / POINTS_ON_DIAGONAL);
    let mut trace = request
        .rows
        .then(|| TraceWriter::new(Vec::new(), axes))
        .transpose()
        .into_diagnostic()?;
    let mut sinks: Vec<&mut dyn Sink> = vec![&mut drawn];
    sinks.extend(trace.iter_mut().map(|trace| trace as &mut dyn Sink));
    let outcome = checked.run(&mut sinks, &watch)?;
    drawn.flush();
    let mut results = Vec::new();
    outcome.write_json(&job, &mut results).into_diagnostic()?;
    let rows = trace
        .map(TraceWriter::finish)
        .transpose()
        .into_diagnostic()?
        .unwrap_or_default();
    let [mut page, mut drawings] = [const { Vec::new() }; 2];
    if request.page {
        write_html(&mut page, &outcome.report).into_diagnostic()?;
        write_html_data(&mut drawings, &outcome.report).into_diagnostic()?;
    }
    let table: Vec<_> = outcome.report.runs.iter().map(figures).collect();
    let remarks = outcome
        .without_identification
        .iter()
        .map(ToString::to_string);
    let remarks = outcome
        .warnings
        .iter()
        .map(ToString::to_string)
        .chain(remarks)
        .collect::<Vec<_>>();
    let reported = json!({
        "runs": table,
        "remarks": remarks,
        "is_of_use": outcome.is_of_use,
        "verdict": outcome.report.verdict(),
        "limits": outcome.report.limits.as_ref().map_or_else(Vec::new, LimitBand::shares),
    });
    Ok(vec![results, rows, page, json(&reported), drawings])
}

/// Returns a row of the table of `run`.
fn figures(run: &ReportedRun) -> Value {
    let now = &run.summary;
    let record = |transition: &Transition| json!({ "t_s": transition.at_s, "line": transition.line, "text": transition.words() });
    json!({
        "name": now.controller,
        "time_s": fixed(now.time_s, 3),
        "rms_um": fixed(now.rms_um, 2),
        "max_um": fixed(now.max_um, 2),
        "uncut_um": fixed(now.uncut_um, 2),
        "record": now.transitions.iter().map(record).collect::<Vec<_>>(),
    })
}
