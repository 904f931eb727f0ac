//! A cut without a correction and one with a controller.

use feedwright::sim::{Sink, TraceWriter, Transition, fixed};
use feedwright::{
    CONTROLLERS, Choices, Job, LimitBand, ReportedRun, take_recorded_model, write_html,
    write_html_data,
};
use miette::IntoDiagnostic;
use serde_json::{Value, json};

use crate::page::{PageCut, PageWatch};
use crate::request::{Outputs, Request, json};

/// Number of points of a cut along the diagonal of its box: about two pixels apart on a large
/// screen.
const POINTS_ON_DIAGONAL: f64 = 1500.0;

pub(crate) fn run(request: &mut Request) -> miette::Result<Outputs> {
    let mut job = Job::new(request.take_program(), request.machine()?);
    job.tolerance_um = request.tolerance_um;
    job.choices.seed = request.seed;
    job.controller = request.controller()?.unwrap_or(job.controller);
    let watch = PageWatch::default();
    let read = job.check()?;
    let (axes, summary) = (read.axes(), read.into_summary());
    if let Some(day) = &request.recorded_on {
        as_in_the_command(&mut job, request, axes, day, &watch)?;
    }
    let squares = (0..3).map(|axis| (summary.box_mm[1][axis] - summary.box_mm[0][axis]).powi(2));
    let mut drawn = PageCut::new(squares.sum::<f64>().sqrt() / POINTS_ON_DIAGONAL);
    let checked = job.check_read(summary)?;
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
    let told = json!({
        "runs": table,
        "remarks": remarks,
        "is_of_use": outcome.is_of_use,
        "verdict": outcome.report.verdict(),
        "limits": outcome.report.limits.as_ref().map_or_else(Vec::new, LimitBand::shares),
    });
    Ok(vec![results, rows, page, json(&told), drawings])
}

/// Sets the settings and the model that the command takes by default. The model comes from a log of
/// the machine, if the controller uses one.
fn as_in_the_command(
    job: &mut Job,
    request: &Request,
    axes: usize,
    day: &str,
    watch: &PageWatch,
) -> miette::Result<()> {
    job.with_limits = true;
    job.machine_file = request
        .is_machine_text()
        .then(|| request.machine_name.clone());
    job.choices = Choices {
        tries: true,
        ..job.choices.clone()
    };
    let recorded = [job.controller, job.against].into_iter();
    let recorded =
        recorded.filter_map(|entry| Some((entry, CONTROLLERS.recorded(&job.machine, entry)?)));
    job.choices
        .take_recorded(recorded.collect::<Vec<_>>().into_iter());
    let machine = job.machine.clone();
    take_recorded_model(job, &machine, axes, day.to_owned(), watch)?;
    Ok(())
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
