//! The page of a comparison: what is claimed, the times at equal tolerance, and for each workpiece and machine the table and
//! the errors side by side. One file without references to anything outside it; equal comparisons give equal bytes.

use std::io::{self, Write};

use super::table::{Row, knows};
use super::tolerance::{AtTolerance, TOLERANCE_UM};
use super::{AT_HOME, Comparison};
use crate::controllers::{BASELINE, BEST, Knows};
use crate::report::figure::{COLORS, Curve, Figure, Panel, write_foot, write_head};
use crate::report::text::{escaped, number};

const CSS: &str = include_str!("../../assets/report/compare.css");
/// A ratio that is coloured: further from 1 than this.
const NOTABLE: f64 = 0.02;

/// Writes the page.
///
/// # Errors
/// Where `out` takes no more.
pub fn write(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let introduction = format!(
        "Every controller on every contour and machine. Controllers know {} at most and meet the other machines unseen; \
         {BEST}{AT_HOME} and its like are identified on the machine that they cut on. Ratios are against {BASELINE} on the same \
         machine. Seed {}.",
        comparison.nominal, comparison.seed
    );
    write_head(out, "Comparison of controllers", &introduction, CSS)?;
    write_contents(out, comparison)?;
    write_tuned(out, comparison)?;
    write_verdicts(out, comparison)?;
    write_at_tolerance(out, &comparison.at_tolerance)?;
    for (index, here) in cells(&comparison.rows).into_iter().enumerate() {
        write_cell(out, index, here)?;
    }
    write_foot(out)
}

/// The rows of each workpiece and machine.
fn cells(rows: &[Row]) -> Vec<&[Row]> {
    rows.chunk_by(|a, b| a.contour == b.contour && a.machine == b.machine).collect()
}

fn write_contents(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    out.write_all(b"<nav>")?;
    for (index, here) in cells(&comparison.rows).into_iter().enumerate() {
        let (contour, machine) = (escaped(&here[0].contour), escaped(&here[0].machine));
        writeln!(out, "<a href=\"#cell-{index}\">{contour} on {machine}</a>")?;
    }
    out.write_all(b"</nav>\n")
}

fn write_tuned(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let searched: Vec<_> = comparison.tuned.iter().filter(|tuned| tuned.cuts > 0).collect();
    if searched.is_empty() {
        return Ok(());
    }
    out.write_all(b"<h2>Tuned values</h2>\n<div class=\"wide\"><table><thead><tr><th>controller</th><th>cuts</th>")?;
    out.write_all("<th>RMS, µm</th><th>values</th></tr></thead><tbody>\n".as_bytes())?;
    for tuned in searched {
        let values: Vec<String> = tuned.values.iter().map(|(name, value)| format!("{name} {value:.3e}")).collect();
        let (name, values) = (escaped(&tuned.controller), escaped(&values.join(", ")));
        let rms = number(tuned.rms_um);
        writeln!(out, "<tr><td>{name}</td><td>{}</td><td>{rms}</td><td>{values}</td></tr>", tuned.cuts)?;
    }
    out.write_all(b"</tbody></table></div>\n")
}

fn write_verdicts(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let verdicts = &comparison.verdicts;
    if verdicts.is_empty() {
        return Ok(());
    }
    let held = verdicts.iter().filter(|verdict| verdict.holds).count();
    write!(out, "<h2>Claims: {held} of {} hold</h2>\n<div class=\"wide\"><table><thead><tr>", verdicts.len())?;
    out.write_all(
        b"<th>claim</th><th>contour</th><th>machine</th><th>against</th><th>ratio</th><th>limit</th><th></th>",
    )?;
    out.write_all(b"</tr></thead><tbody>\n")?;
    for verdict in verdicts {
        let (class, word) = if verdict.holds { ("better", "holds") } else { ("worse", "falls short") };
        writeln!(
            out,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{:.3}</td><td>{:.3}</td><td class=\"{class}\">{word}</td></tr>",
            verdict.claim,
            escaped(&verdict.contour),
            escaped(&verdict.machine),
            escaped(&verdict.against),
            verdict.value,
            verdict.limit
        )?;
    }
    out.write_all(b"</tbody></table></div>\n")
}

fn write_at_tolerance(out: &mut impl Write, rows: &[AtTolerance]) -> io::Result<()> {
    if rows.is_empty() {
        return Ok(());
    }
    write!(
        out,
        "<h2>Machining time where no error is above {TOLERANCE_UM} µm</h2>\n<div class=\"wide\"><table><thead><tr>"
    )?;
    out.write_all(b"<th>contour</th><th>controller</th><th>feedrate, mm/s</th><th>time, s</th><th>ratio</th></tr></thead><tbody>\n")?;
    let cell =
        |value: Option<f64>, decimals: usize| value.map_or("never".to_owned(), |value| format!("{value:.decimals$}"));
    for row in rows {
        writeln!(
            out,
            "<tr{}><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>",
            ours(&row.controller),
            escaped(&row.contour),
            escaped(&row.controller),
            cell(row.feed_mm_s, 1),
            cell(row.time_s, 3),
            cell(row.time_ratio, 3)
        )?;
    }
    out.write_all(b"</tbody></table></div>\n")
}

fn write_cell(out: &mut impl Write, index: usize, rows: &[Row]) -> io::Result<()> {
    let (contour, machine) = (escaped(&rows[0].contour), escaped(&rows[0].machine));
    writeln!(out, "<section id=\"cell-{index}\"><h2>{contour} on {machine}</h2>")?;
    out.write_all(
        "<div class=\"wide\"><table><thead><tr><th>controller</th><th>time, s</th><th>RMS, µm</th><th>max, µm</th>\
         <th>time</th><th>RMS</th><th>max</th><th>command off, µm</th><th>torque, N m</th><th></th></tr></thead><tbody>\n"
            .as_bytes(),
    )?;
    for row in rows {
        let note = match (row.completed, &row.faded_out) {
            (false, _) => "diverged".to_owned(),
            (true, Some(cause)) => format!("open loop in the end: {cause}"),
            (true, None) => String::new(),
        };
        write!(out, "<tr{}><td>{}</td><td>{:.3}</td>", ours(&row.controller), escaped(&row.controller), row.time_s)?;
        write!(out, "<td>{}</td><td>{}</td>", number(row.rms_um), number(row.max_um))?;
        for ratio in [row.time_ratio, row.rms_ratio, row.max_ratio] {
            let class = if ratio < 1.0 - NOTABLE {
                " class=\"better\""
            } else if ratio > 1.0 + NOTABLE {
                " class=\"worse\""
            } else {
                ""
            };
            write!(out, "<td{class}>{ratio:.3}</td>")?;
        }
        let (off, torque) = (number(row.max_deviation_um), number(row.peak_torque_nm));
        writeln!(out, "<td>{off}</td><td>{torque}</td><td class=\"note\">{}</td></tr>", escaped(&note))?;
    }
    out.write_all(b"</tbody></table></div>\n")?;
    writeln!(out, "<figure>{}</figure></section>", errors(rows).to_svg())
}

fn ours(controller: &str) -> &'static str {
    if controller.starts_with(BEST) { " class=\"ours\"" } else { "" }
}

/// Error over the cut: open loop, the best peer that knows no model, and the receding horizon, on one scale.
fn errors(rows: &[Row]) -> Figure {
    let peers = rows.iter().filter(|row| {
        let blind = matches!(knows(row), Some(Knows::Nothing | Knows::Identified));
        blind && row.completed && row.controller != BASELINE && !row.controller.starts_with(BEST)
    });
    let peer = peers.min_by(|a, b| a.rms_um.total_cmp(&b.rms_um));
    let named = |name: &str| rows.iter().find(|row| row.controller == name);
    let shown: Vec<&Row> = [named(BASELINE), peer, named(BEST)].into_iter().flatten().collect();
    let largest = shown.iter().filter(|row| row.completed).map(|row| row.max_um).fold(0.0, f64::max);
    let panel = |(row, color): (&&Row, &str)| {
        let step = 1.0 / row.error_um.len().max(1) as f64;
        let points = row.error_um.iter().enumerate().map(|(i, &e)| [i as f64 * step * row.time_s, f64::from(e)]);
        Panel {
            title: row.controller.clone(),
            x_title: "Time [s]".to_owned(),
            y_title: "Contour error [µm]".to_owned(),
            curves: vec![Curve { points: points.collect(), color: color.to_owned(), ..Curve::default() }],
            y_range: (largest > 0.0).then_some([-largest, largest]),
            ..Panel::default()
        }
    };
    Figure { panels: shown.iter().zip(COLORS).map(panel).collect(), columns: 3, aspect: 0.7 }
}
