//! The verdict: what came out and what it costs, in one sentence.

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
    let first = Some(&report.runs[0].summary).filter(|_| report.runs.len() > 1);
    let um = |x: f64| format!("{} µm", number(x));
    let gains = [
        format!("RMS contour error {}", step(first, last, |r| r.rms_um, &um)),
        format!("largest {}", step(first, last, |r| r.max_um, &um)),
        format!("uncut path {}", step(first, last, |r| r.uncut_um, &um)),
        format!("machining time {}", step(first, last, |r| r.time_s, &duration)),
    ];
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
    format!("{}; {}{tolerance}.{faded}{}", gains.join(", "), cost(first, last), measured(report))
}

/// What the command and the drives do for it.
fn cost(first: Option<&RunSummary>, last: &RunSummary) -> String {
    let axis = dearest_axis(first, last);
    let torque = move |r: &RunSummary| r.peak_torque_nm.map_or(f64::NAN, |peaks| peaks[axis]);
    let accel = |r: &RunSummary| if r.measured { f64::NAN } else { r.max_command_accel_mm_s2 * 1e-3 };
    let um = |x: f64| format!("{} µm", number(x));
    [
        format!(
            "peak torque of {} {}",
            ["X", "Y", "Z"][axis],
            step(first, last, torque, &|x| format!("{} N m", number(x)))
        ),
        format!("command beside the program by up to {}", step(None, last, |r| r.max_deviation_um, &um)),
        format!("its largest acceleration {}", step(first, last, accel, &|x| format!("{} m/s²", number(x)))),
    ]
    .join(", ")
}

/// The axis whose peak torque rose by the largest factor; the strongest where there is nothing to compare with.
fn dearest_axis(first: Option<&RunSummary>, last: &RunSummary) -> usize {
    let Some(peaks) = last.peak_torque_nm else { return 0 };
    let before = first.and_then(|first| first.peak_torque_nm).unwrap_or([1.0; 3]);
    let ratio = |k: usize| if before[k] > 0.0 { peaks[k] / before[k] } else { 0.0 };
    (0..last.axes.clamp(1, 3)).max_by(|&a, &b| ratio(a).total_cmp(&ratio(b))).unwrap_or(0)
}

/// What a log says, where there is one.
fn measured(report: &Report) -> String {
    let run = report.runs.iter().map(|run| &run.summary).find(|run| run.measured);
    run.map_or(String::new(), |run| {
        format!(
            " Measured on the machine: RMS contour error <b>{} µm</b>, largest <b>{} µm</b>.",
            number(run.rms_um),
            number(run.max_um)
        )
    })
}

fn name(run: &RunSummary) -> String {
    format!("<b>{}</b>", escaped(&run.controller))
}

/// "18.0 µm → 2.40 µm (−87 %)", or the value alone.
fn step(
    first: Option<&RunSummary>,
    last: &RunSummary,
    value: impl Fn(&RunSummary) -> f64,
    text: &dyn Fn(f64) -> String,
) -> String {
    let after = value(last);
    let Some(before) = first.map(value) else { return format!("<b>{}</b>", text(after)) };
    let change = change(before, after).map_or(String::new(), |c| format!(" <span class=\"change\">({c})</span>"));
    format!("<span class=\"step\">{} → <b>{}</b>{change}</span>", text(before), text(after))
}
