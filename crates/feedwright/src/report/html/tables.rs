//! The page's tables, written without scripts.

use std::io::{self, Write};

use crate::report::text::{change, duration, escaped, fixed, number};
use crate::report::{
    FadedOut, Outcome, PageUnits, Report, ReportedRun, RunSummary, TimelineEvent, Transition,
    WorstPlace,
};

const AXES: [&str; 3] = ["X", "Y", "Z"];

/// Largest number of events drawn on a strip; the rest is given as a number. More would be a solid
/// bar.
const SHOWN_EVENTS: usize = 200;

/// Writes a row for each controller, then `assumed`, the assumptions of the figures, and the events
/// of each run.
pub(super) fn write_summary(
    out: &mut impl Write,
    report: &Report,
    units: PageUnits,
    assumed: &str,
) -> io::Result<()> {
    let axes = report
        .runs
        .iter()
        .map(|r| r.summary.axes)
        .max()
        .unwrap_or(2)
        .min(3);
    let unit = units.error();
    write!(
        out,
        "<section aria-labelledby=\"h-summary\">\n<h2 id=\"h-summary\">Summary</h2>\n<div class=\"scroll\" tabindex=\"0\"><table class=\"summary\" role=\"table\">\n\
          <thead role=\"rowgroup\"><tr role=\"row\"><th scope=\"col\">Controller</th><th scope=\"col\">RMS error<i>{unit}</i></th>\
          <th scope=\"col\">Largest error<i>{unit}</i></th><th scope=\"col\">Uncut path<i>{unit}</i></th>\
          <th scope=\"col\">Machining time</th>\
          <th scope=\"col\">Outside ±20 % of F<i>%</i></th>\
          <th scope=\"col\">Command deviation<i>{unit}</i></th>\
          <th scope=\"col\">Command acceleration<i>m/s²</i></th>",
    )?;
    for axis in &AXES[..axes] {
        write!(out, "<th scope=\"col\">Peak torque {axis}<i>N m</i></th>")?;
    }
    out.write_all(b"</tr></thead>\n<tbody role=\"rowgroup\">\n")?;
    let first = report.basis().map(|run| &run.summary);
    for (i, run) in report.runs.iter().enumerate() {
        let other = first.filter(|first| first.role != run.summary.role);
        write_summary_row(out, i, &run.summary, other, (axes, units))?;
    }
    write!(out, "</tbody></table></div>\n{assumed}")?;
    for (i, run) in report.runs.iter().enumerate() {
        write_events(out, i, run)?;
        write_transitions(out, i, &run.summary)?;
    }
    out.write_all(b"</section>\n")
}

fn write_summary_row(
    out: &mut impl Write,
    index: usize,
    run: &RunSummary,
    first: Option<&RunSummary>,
    (axes, units): (usize, PageUnits),
) -> io::Result<()> {
    let note = match (&run.outcome, &run.faded_out) {
        (Outcome::Diverged { at_s }, _) => format!(
            "<small class=\"alarm\">diverged at {}</small>",
            duration(*at_s)
        ),
        (Outcome::Completed, Some(FadedOut { at_s, cause })) => {
            let share = number(100.0 * run.engaged_share);
            format!(
                "<small class=\"alarm\">in the loop for {share} %, left it last at {}: {cause}</small>",
                duration(*at_s)
            )
        }
        (Outcome::Completed, None) => String::new(),
    };
    write!(
        out,
        "<tr role=\"row\"><th scope=\"row\" role=\"rowheader\">{}{}{note}</th>",
        swatch(index),
        escaped(&run.controller)
    )?;
    let joints = |um: Option<f64>, tool_um: f64| {
        let shown = um
            .map(|um| units.number(um))
            .filter(|shown| *shown != units.number(tool_um));
        shown.map_or(String::new(), |shown| {
            format!("<small>{shown} by encoders</small>")
        })
    };
    let mut cell = |label: &str, text: String, value: fn(&RunSummary, usize) -> f64, k: usize| {
        // A value that a run does not have is NaN, and has no ratio.
        let ratio = first.and_then(|f| change(value(f, k), value(run, k)));
        let ratio = ratio.map_or(String::new(), |r| format!("<small>{r}</small>"));
        write!(
            out,
            "<td role=\"cell\" data-label=\"{label}\">{text}{ratio}</td>"
        )
    };
    let [rms, max] = [
        (run.rms_um, run.joint_rms_um),
        (run.max_um, run.joint_max_um),
    ]
    .map(|(um, joint_um)| format!("{}{}", units.number(um), joints(joint_um, um)));
    let unit = units.error();
    cell(&format!("RMS error, {unit}"), rms, |r, _| r.rms_um, 0)?;
    cell(&format!("Largest error, {unit}"), max, |r, _| r.max_um, 0)?;
    cell(
        &format!("Uncut path, {unit}"),
        units.number(run.uncut_um),
        |r, _| r.uncut_um,
        0,
    )?;
    cell("Machining time", duration(run.time_s), |r, _| r.time_s, 0)?;
    let outside = |r: &RunSummary, _: usize| {
        r.feed
            .map_or(f64::NAN, |feed| 100.0 * (feed.slow_share + feed.fast_share))
    };
    cell("Outside ±20 % of F, %", number(outside(run, 0)), outside, 0)?;
    cell(
        &format!("Command deviation, {unit}"),
        units.number(run.max_deviation_um),
        |r, _| r.max_deviation_um,
        0,
    )?;
    let accel_m_s2 = |r: &RunSummary, _: usize| {
        if r.role.is_measured() {
            f64::NAN
        } else {
            r.max_command_accel_mm_s2 * 1e-3
        }
    };
    cell(
        "Command acceleration, m/s²",
        number(accel_m_s2(run, 0)),
        accel_m_s2,
        0,
    )?;
    for (k, axis) in AXES.iter().enumerate().take(axes) {
        let label = format!("Peak torque {axis}, N m");
        let torque_nm =
            |r: &RunSummary, k: usize| r.peak_torque_nm.map_or(f64::NAN, |peaks| peaks[k]);
        cell(&label, fixed(torque_nm(run, k), 3), torque_nm, k)?;
    }
    out.write_all(b"</tr>\n")
}

pub(super) fn swatch(index: usize) -> String {
    format!("<span class=\"swatch run-{}\"></span>", index % 6)
}

/// Fraction of the machining time after which only the end of the program counts as an event.
const ENDS_WITHIN: f64 = 0.995;

/// Largest number of rows of a timeline. A machine has a dozen units; of a file that names
/// hundreds, only these are drawn.
const SHOWN_ROWS: usize = 24;

/// Lists when and why the correction engaged and disengaged in a run.
fn write_transitions(out: &mut impl Write, index: usize, run: &RunSummary) -> io::Result<()> {
    let transitions = &run.transitions;
    if transitions.is_empty() {
        return Ok(());
    }
    let (count, name) = (transitions.len(), escaped(&run.controller));
    let changes = if count == 1 { "change" } else { "changes" };
    write!(
        out,
        "<details class=\"events\"><summary>{}<span>{count} {changes} of the correction, {name}</span>",
        swatch(index)
    )?;
    let text = |t: &Transition| format!("{}, line {}: {}", duration(t.at_s), t.line, t.words());
    write_moments(
        out,
        transitions
            .iter()
            .map(|transition| (transition.at_s, text(transition))),
    )
}

/// Ends the heading of a list of moments, and writes the first of them.
fn write_moments(
    out: &mut impl Write,
    moments: impl ExactSizeIterator<Item = (f64, String)>,
) -> io::Result<()> {
    let more = moments.len().saturating_sub(SHOWN_EVENTS);
    out.write_all(b"</summary><ol>")?;
    for (at_s, text) in moments.take(SHOWN_EVENTS) {
        write!(out, "<li data-t=\"{at_s:.5}\">{}</li>", escaped(&text))?;
    }
    if more > 0 {
        write!(out, "<li>and {more} more</li>")?;
    }
    out.write_all(b"</ol></details>\n")
}

/// Writes the events of a run as a list, and on strips as long as the run, one for each unit.
fn write_events(out: &mut impl Write, index: usize, run: &ReportedRun) -> io::Result<()> {
    // The end of a program is not an event: every program has one.
    if run
        .events
        .iter()
        .all(|event| event.duration_s == 0.0 && event.t_s >= ENDS_WITHIN * run.summary.time_s)
    {
        return Ok(());
    }
    let end_s = run
        .events
        .iter()
        .map(|e| e.t_s + e.duration_s)
        .fold(run.summary.time_s, f64::max);
    let percent = |t_s: f64| {
        if end_s > 0.0 {
            (t_s / end_s * 100.0).clamp(0.0, 100.0)
        } else {
            0.0
        }
    };
    write!(
        out,
        "<details class=\"events\"><summary>{}<span>{} program events, {}</span>",
        swatch(index),
        run.events.len(),
        escaped(&run.summary.controller)
    )?;
    write_rows(out, run, percent)?;
    write_moments(
        out,
        run.events
            .iter()
            .map(|event| (event.t_s, event_text(event))),
    )
}

/// Draws a strip for each unit of the machine that has events, in the order of their first events.
fn write_rows(
    out: &mut impl Write,
    run: &ReportedRun,
    percent: impl Fn(f64) -> f64,
) -> io::Result<()> {
    let mut rows: Vec<&str> = Vec::new();
    for event in &run.events {
        if !rows.contains(&event.row.as_str()) && rows.len() < SHOWN_ROWS {
            rows.push(&event.row);
        }
    }
    out.write_all(b"<span class=\"rows\" aria-hidden=\"true\">")?;
    for row in rows {
        let events = || run.events.iter().filter(|event| event.row == row);
        let total_s: f64 = events().map(|event| event.duration_s).sum();
        let took = if total_s > 0.0 {
            duration(total_s)
        } else {
            String::new()
        };
        write!(
            out,
            "<span class=\"row\"><b>{}</b><svg class=\"strip\">",
            escaped(row)
        )?;
        for event in events().take(SHOWN_EVENTS) {
            // A rectangle without a width is not drawn, nor is its stroke.
            let (left, width) = (percent(event.t_s), percent(event.duration_s).max(1e-3));
            let hint = escaped(&event_text(event));
            write!(
                out,
                "<rect x=\"{left:.3}%\" width=\"{width:.3}%\" height=\"100%\"><title>{hint}</title></rect>"
            )?;
        }
        write!(out, "</svg><span class=\"num\">{took}</span></span>")?;
    }
    out.write_all(b"</span>")
}

fn event_text(event: &TimelineEvent) -> String {
    let at = format!(
        "{}  line {}  {}",
        duration(event.t_s),
        event.line,
        event.label
    );
    if event.duration_s > 0.0 {
        format!("{at}, {}", duration(event.duration_s))
    } else {
        at
    }
}

/// Writes the worst places, a table for each controller.
pub(super) fn write_worst(
    out: &mut impl Write,
    report: &Report,
    units: PageUnits,
) -> io::Result<()> {
    out.write_all(
        b"<section aria-labelledby=\"h-worst\">\n<h2 id=\"h-worst\">Worst places</h2>\n\
          <p class=\"hint needs-script\">Choose a place to see it on the path.</p>\n<div class=\"pair\">\n",
    )?;
    for (i, run) in report.runs.iter().enumerate() {
        let axes = run.summary.axes.clamp(2, 3);
        write!(
            out,
            "<div><h3>{}{}</h3>\n<div class=\"scroll\" tabindex=\"0\"><table class=\"worst\"><thead><tr><th scope=\"col\">#</th>\
             <th scope=\"col\">Error<i>{}</i></th><th scope=\"col\">Line</th><th scope=\"col\" class=\"code\">Program</th>",
            swatch(i),
            escaped(&run.summary.controller),
            units.error()
        )?;
        let length = units.length();
        for axis in &AXES[..axes] {
            write!(out, "<th scope=\"col\">{axis}<i>{length}</i></th>")?;
        }
        write!(
            out,
            "<th scope=\"col\">Time<i>s</i></th><th scope=\"col\">Arc length<i>{length}</i></th></tr></thead>\n<tbody>\n"
        )?;
        for (rank, place) in run.summary.worst.iter().enumerate() {
            write_place(out, (i, rank), place, axes, units)?;
        }
        if run.summary.worst.is_empty() {
            out.write_all(b"<tr><td colspan=\"9\" class=\"empty\">No contour error where the tool cuts.</td></tr>\n")?;
        }
        out.write_all(b"</tbody></table></div></div>\n")?;
    }
    out.write_all(b"</div></section>\n")
}

fn write_place(
    out: &mut impl Write,
    (run, rank): (usize, usize),
    place: &WorstPlace,
    axes: usize,
    units: PageUnits,
) -> io::Result<()> {
    let text = escaped(place.text.trim());
    write!(
        out,
        "<tr data-run=\"{run}\" data-place=\"{rank}\"><th scope=\"row\">{}</th><td>{}</td><td>{}</td>\
         <td class=\"code\"><code title=\"{text}\">{text}</code></td>",
        rank + 1,
        units.signed(place.error_um, 2),
        place.line,
    )?;
    for k in 0..axes {
        write!(out, "<td>{}</td>", units.fixed(place.position_mm[k], 3))?;
    }
    writeln!(
        out,
        "<td>{}</td><td>{}</td></tr>",
        fixed(place.t_s, 3),
        units.fixed(place.s_mm, 2)
    )
}

/// Writes the notes on how to read the page, the settings and the machine.
pub(super) fn write_notes(
    out: &mut impl Write,
    report: &Report,
    units: PageUnits,
) -> io::Result<()> {
    out.write_all(NOTES.as_bytes())?;
    out.write_all(b"<div class=\"pair\">\n")?;
    let reported = |entries: &[(String, String)]| -> Vec<(String, String)> {
        entries
            .iter()
            .map(|(name, value)| (name.clone(), units.text(value)))
            .collect()
    };
    write_list(out, "Settings", &reported(&report.settings))?;
    write_list(out, "Machine", &reported(&report.machine))?;
    let mut facts = Vec::new();
    for run in &report.runs {
        let summary = &run.summary;
        let per_point = run.series.rows_per_point();
        let thinned = if per_point > 1 {
            format!("; a drawn point stands for {per_point}")
        } else {
            String::new()
        };
        facts.push((
            summary.controller.clone(),
            format!(
                "{} servo periods{thinned}; {} {} cut in {}",
                summary.rows,
                units.fixed(summary.cutting_length_mm, 2),
                units.length(),
                duration(summary.cutting_time_s)
            ),
        ));
    }
    write_list(out, "Runs", &facts)?;
    out.write_all(b"</div></details></section>\n")
}

const NOTES: &str = include_str!("../../../assets/report/notes.html");

fn write_list(out: &mut impl Write, heading: &str, entries: &[(String, String)]) -> io::Result<()> {
    if entries.is_empty() {
        return Ok(());
    }
    write!(out, "<div><h3>{heading}</h3><dl>")?;
    for (name, value) in entries {
        write!(out, "<dt>{}</dt><dd>{}</dd>", escaped(name), escaped(value))?;
    }
    out.write_all(b"</dl></div>\n")
}
