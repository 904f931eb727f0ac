//! The page of an identification: verdict, numbers, measured against predicted, errors by horizon,
//! spectrum of what is left.
//!
//! One file without references to anything outside it; equal identifications give equal bytes.

use std::io::{self, Write};
use std::ops::Range;

use feedwright_ident::{FoundAxis, FreeRunErrors, Spectrum};

use super::{LogIdentified, digits};
use crate::report::figure::{COLORS, Figure, LineStyle, Panel, Polyline};
use crate::report::plain_page::{
    PagePart, write_foot, write_head, write_table_end, write_table_head,
};
use crate::report::text::{escaped, number};

/// Points of a curve: two for each pixel.
const POINTS: usize = 1500;
/// Segment of a spectrum, samples, at the most.
const SEGMENT: usize = 1024;

/// Writes the page.
///
/// Fails if `out` fails.
pub fn write(out: &mut impl Write, identified: &LogIdentified) -> io::Result<()> {
    let log = &identified.log;
    let used = identified
        .of_samples
        .map_or(String::new(), |all| format!(", windows of {all}"));
    let introduction = format!(
        "The model of each axis, found from commanded and actual positions ({}, {} samples of {} ms{used}). It was fitted on one part of the record and is judged by \
         the other: a free run gets the commands and nothing else. Intervals are those of 90 %.",
        log.format,
        log.time_s.len(),
        digits(1e3 * log.sample_time_s),
    );
    let axes = identified.machine.axes.iter().enumerate();
    let axis_parts: Vec<PagePart> = axes
        .clone()
        .map(|(i, axis)| PagePart::new(&format!("axis-{i}"), format!("Axis {}", axis.name)))
        .collect();
    let lists = lists(identified);
    let list_parts = (0..)
        .zip(&lists)
        .map(|(i, (title, _))| PagePart::new(&format!("list-{i}"), *title));
    let contour_part = contour_title(identified).map(|title| PagePart::new("contour", title));
    let parts: Vec<PagePart> = axis_parts
        .iter()
        .cloned()
        .chain(contour_part.clone())
        .chain(list_parts.clone())
        .collect();
    write_head(
        out,
        "tables",
        &format!("Identification from {}", identified.job.name),
        &introduction,
        &parts,
    )?;
    for ((i, axis), part) in axes.zip(&axis_parts) {
        write_axis(out, identified, i, axis, part)?;
    }
    if let (Some(contour), Some(part)) = (&identified.machine.contour, contour_part) {
        part.begin(out)?;
        writeln!(
            out,
            "<p>Where both move it is {} µm RMS; the free runs miss {} µm of it, those of the best ARX {} µm.</p>",
            number(contour.measured_um),
            number(contour.grey_box_um),
            number(contour.arx_um)
        )?;
        PagePart::end(out)?;
    }
    for (part, (_, lines)) in list_parts.zip(&lists) {
        part.begin(out)?;
        writeln!(out, "<ul>")?;
        lines
            .iter()
            .try_for_each(|line| writeln!(out, "<li>{}</li>", escaped(line)))?;
        writeln!(out, "</ul>")?;
        PagePart::end(out)?;
    }
    write_foot(out)
}

fn contour_title(identified: &LogIdentified) -> Option<String> {
    let contour = identified.machine.contour.as_ref()?;
    let [a, b] = contour
        .plane
        .map(|i| identified.machine.axes[i].name.clone());
    Some(format!("Contour error of {a} and {b}"))
}

/// Lists of sentences that have any, with their headings.
fn lists(identified: &LogIdentified) -> Vec<(&'static str, Vec<String>)> {
    let noticed = identified
        .log
        .findings
        .iter()
        .map(ToString::to_string)
        .collect();
    let mut lists = vec![
        ("What was noticed", noticed),
        ("What other settings would bring", identified.improvements()),
        ("What to record", identified.advice()),
    ];
    lists.retain(|(_, lines): &(_, Vec<String>)| !lines.is_empty());
    lists
}

fn write_axis(
    out: &mut impl Write,
    identified: &LogIdentified,
    i: usize,
    axis: &FoundAxis,
    part: &PagePart,
) -> io::Result<()> {
    let name = escaped(&axis.name).to_string();
    part.begin(out)?;
    writeln!(
        out,
        "<p><b>{}</b></p>",
        escaped(&sentence(&identified.verdict(i)))
    )?;
    writeln!(
        out,
        "<figure>{}<figcaption><b>Following error of axis {name}.</b> Measured, and as free runs over the scored samples have it; below, what they leave. \
         Gaps are samples that were fitted.</figcaption></figure>",
        following(identified, i, f64::NEG_INFINITY..f64::INFINITY).to_html()
    )?;
    write_table_head(out, ["number", "value", "interval", "unit", ""])?;
    for number in axis.numbers() {
        let interval = number.interval.map_or(String::new(), |[low, high]| {
            format!("{} to {}", digits(low), digits(high))
        });
        writeln!(
            out,
            "<tr><td>{}</td><td>{}</td><td>{interval}</td><td>{}</td><td class=\"words\">{}</td></tr>",
            escaped(number.name),
            digits(number.value),
            escaped(number.unit),
            number.source.word()
        )?;
    }
    write_table_end(out)?;
    write_errors(out, axis)?;
    writeln!(
        out,
        "<figure>{}<figcaption><b>Spectrum of what the free run of axis {name} leaves.</b> RMS in a band of a hertz. Correlation from sample to sample: {:.2} of what is left, {:.2} one step ahead.</figcaption></figure>",
        spectrum(identified, i, axis).to_html(),
        axis.scores.residual_correlation,
        axis.scores.innovation_correlation
    )?;
    PagePart::end(out)
}

fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or(String::new(), |first| {
        first.to_uppercase().chain(letters).chain(['.']).collect()
    })
}

fn write_errors(out: &mut impl Write, axis: &FoundAxis) -> io::Result<()> {
    writeln!(
        out,
        "<p>RMS of what predictions miss, µm, of a following error of {} µm:</p>",
        number(axis.scores.following_um)
    )?;
    write_table_head(
        out,
        ["model", "20 ms", "50 ms", "100 ms", "whole run", "one step"],
    )?;
    let mut row = |class: &str, name: &str, errors: &FreeRunErrors| {
        let [a, b, c] = errors.at_um.map(micrometres);
        let [whole, step] = [errors.whole_um, errors.one_step_um].map(micrometres);
        writeln!(
            out,
            "<tr{class}><td>{name}</td><td>{a}</td><td>{b}</td><td>{c}</td><td>{whole}</td><td>{step}</td></tr>"
        )
    };
    row(
        " class=\"ours\"",
        "model of the axis",
        &axis.scores.grey_box,
    )?;
    for (arx, errors) in &axis.scores.arx {
        row("", &format!("ARX, {}", arx.words()), errors)?;
    }
    row("", "the error stays", &axis.scores.stays)?;
    write_table_end(out)?;
    if let Some((um, share)) = axis.scores.beyond {
        writeln!(
            out,
            "<p>{:.0} % of what was scored is faster than all that was fitted; there the model misses {} µm.</p>",
            100.0 * share,
            number(um)
        )?;
    }
    Ok(())
}

fn micrometres(um: f64) -> String {
    if um.is_finite() {
        number(um)
    } else {
        "lost".to_owned()
    }
}

/// Draws every n-th point of a curve, so that it has no more points than can be seen. The first,
/// the least and the largest of each piece would be too many colors.
fn curve(label: &str, color: &str, line: LineStyle, points: &[[f64; 2]]) -> Polyline {
    let apart = points.len().div_ceil(POINTS).max(1);
    let points = points.iter().copied().step_by(apart).collect();
    Polyline {
        label: label.to_owned(),
        points,
        color: color.to_owned(),
        line,
    }
}

/// Following error of an axis over times of the log, s, as measured and as free runs over the
/// scored samples have it; below what they leave.
pub fn following(identified: &LogIdentified, i: usize, times_s: Range<f64>) -> Figure {
    let (log, axis, found) = (
        &identified.log,
        &identified.log.axes[i],
        &identified.machine.axes[i],
    );
    let scored = &identified.machine.split.score;
    let is_shown = |k: usize| scored[k] && times_s.contains(&log.time_s[k]);
    let first = (0..scored.len()).find(|&k| is_shown(k)).unwrap_or(0);
    let last = (0..scored.len()).rfind(|&k| is_shown(k)).unwrap_or(0);
    let over = |value: &dyn Fn(usize) -> Option<f64>| -> Vec<[f64; 2]> {
        (first..=last)
            .map(|k| [log.time_s[k], value(k).map_or(f64::NAN, |mm| 1e3 * mm)])
            .collect()
    };
    let measured = over(&|k| scored[k].then(|| axis.command_mm[k] - axis.actual_mm[k]));
    let predicted = over(&|k| found.scores.simulated_mm[k].map(|mm| axis.command_mm[k] - mm));
    let by_arx = over(&|k| found.scores.arx_mm[k].map(|mm| axis.command_mm[k] - mm));
    let left = over(&|k| found.scores.simulated_mm[k].map(|mm| axis.actual_mm[k] - mm));
    let of_arx = over(&|k| found.scores.arx_mm[k].map(|mm| axis.actual_mm[k] - mm));
    let panel = |title: &str, y_title: &str, curves| Panel {
        title: title.to_owned(),
        x_title: "Time [s]".to_owned(),
        y_title: y_title.to_owned(),
        curves,
        ..Panel::default()
    };
    let above = vec![
        curve("measured", COLORS[0], LineStyle::Solid, &measured),
        curve("best ARX", COLORS[2], LineStyle::Thin, &by_arx),
        curve(
            "model of the axis",
            COLORS[1],
            LineStyle::Dashed,
            &predicted,
        ),
    ];
    let below = vec![
        curve("best ARX", COLORS[2], LineStyle::Thin, &of_arx),
        curve("model of the axis", COLORS[1], LineStyle::Solid, &left),
    ];
    let panels = vec![
        panel("", "Following error [µm]", above),
        panel("", "Left [µm]", below),
    ];
    Figure {
        panels,
        columns: 1,
        aspect: 0.36,
    }
}

fn spectrum(identified: &LogIdentified, i: usize, found: &FoundAxis) -> Figure {
    let (log, axis) = (&identified.log, &identified.log.axes[i]);
    let of = |simulated: &[Option<f64>]| -> Vec<[f64; 2]> {
        let left = |k: usize| simulated[k].map_or(0.0, |mm| 1e3 * (axis.actual_mm[k] - mm));
        let values: Vec<f64> = (0..simulated.len()).map(left).collect();
        let counts: Vec<bool> = simulated.iter().map(Option::is_some).collect();
        let longest = counts
            .chunk_by(|a, b| a == b)
            .filter(|run| run[0])
            .map(<[bool]>::len)
            .max()
            .unwrap_or(0);
        let length = SEGMENT.min(longest.next_power_of_two() / 2).max(16);
        let spectrum = Spectrum::new(&values, &counts, length);
        // Mean square in a sample, were it white, spread over half the rate of samples.
        (1..spectrum.power.len())
            .map(|n| {
                let hz = spectrum.at(n) / log.sample_time_s;
                let um = (spectrum.power[n] * 2.0 * log.sample_time_s).sqrt();
                [libm::log10(hz), libm::log10(um.max(1e-9))]
            })
            .collect()
    };
    let curves = vec![
        curve(
            "best ARX",
            COLORS[2],
            LineStyle::Thin,
            &of(&found.scores.arx_mm),
        ),
        curve(
            "model of the axis",
            COLORS[1],
            LineStyle::Solid,
            &of(&found.scores.simulated_mm),
        ),
    ];
    let panel = Panel {
        x_title: "Frequency [Hz]".to_owned(),
        y_title: "Left [µm/√Hz]".to_owned(),
        curves,
        powers_of_ten: true,
        ..Panel::default()
    };
    Figure {
        panels: vec![panel],
        columns: 1,
        aspect: 0.36,
    }
}
