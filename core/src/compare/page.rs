//! The page of a comparison: all at a glance, what is claimed, the times at equal tolerance, for each workpiece and machine the
//! table and the errors side by side, and the values of the peers. One file without references to anything outside it; equal comparisons give equal bytes.

use std::io::{self, Write};

use super::overview::{Claimed, each_once};
use super::table::{ComparisonRow, knows};
use super::tolerance::TOLERANCE_UM;
use super::{Comparison, IDENTIFIED_HERE};
use crate::controllers::{BASELINE, BEST, Knows};
use crate::report::figure::{COLORS, Figure, Panel, Polyline, write_foot, write_head};
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
         {BEST}{IDENTIFIED_HERE} and its like are identified on the machine that they cut on. Seed {}.",
        comparison.nominal, comparison.seed
    );
    write_head(out, "Comparison of controllers", &introduction, CSS)?;
    write_machines(out, comparison)?;
    write_contents(out, comparison)?;
    write_claims(out, comparison)?;
    write_at_tolerance(out, comparison)?;
    for (index, here) in cells(&comparison.rows).into_iter().enumerate() {
        write_cell(out, index, here)?;
    }
    write_tuned(out, comparison)?;
    write_foot(out)
}

/// The rows of each workpiece and machine.
fn cells(rows: &[ComparisonRow]) -> Vec<&[ComparisonRow]> {
    rows.chunk_by(|a, b| a.contour == b.contour && a.machine == b.machine).collect()
}

/// The beginning of a table, up to its first row.
fn write_heading<'a>(out: &mut impl Write, heads: impl IntoIterator<Item = &'a str>) -> io::Result<()> {
    out.write_all(b"<div class=\"wide\"><table><thead><tr>")?;
    heads.into_iter().try_for_each(|head| write!(out, "<th>{}</th>", escaped(head)))?;
    out.write_all(b"</tr></thead><tbody>\n")
}

fn write_end(out: &mut impl Write) -> io::Result<()> {
    out.write_all(b"</tbody></table></div>\n")
}

/// All controllers on all machines.
fn write_machines(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let machines = comparison.machines();
    out.write_all("<h2>RMS contour error over all contours, µm</h2>\n".as_bytes())?;
    write_heading(out, std::iter::once("controller").chain(machines.iter().copied()))?;
    for controller in comparison.controllers() {
        write!(out, "<tr{}><td>{}</td>", ours(controller), escaped(controller))?;
        for machine in &machines {
            let cut = comparison.rows.iter().any(|row| row.machine == *machine && row.controller == controller);
            let text = match comparison.rms_over_contours_um(machine, controller) {
                Some(rms_um) => number(rms_um),
                None if cut => "diverged".to_owned(),
                None => String::new(),
            };
            write!(out, "<td>{text}</td>")?;
        }
        out.write_all(b"</tr>\n")?;
    }
    write_end(out)
}

/// Where each contour and machine is found, and what the receding horizon does there.
fn write_contents(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let (machines, cells) = (comparison.machines(), cells(&comparison.rows));
    writeln!(out, "<h2>Contours and machines</h2>\n<p>RMS / largest contour error of {}, µm.</p>", shown(comparison))?;
    write_heading(out, std::iter::once("contour").chain(machines.iter().copied()))?;
    for contour in comparison.contours() {
        write!(out, "<tr><td>{}</td>", escaped(contour))?;
        for machine in &machines {
            let index = cells.iter().position(|cell| cell[0].contour == contour && cell[0].machine == *machine);
            let row = comparison.row(contour, machine, shown(comparison));
            match (index, row) {
                (Some(index), Some(row)) => {
                    let (rms, max) = (number(row.rms_um), number(row.max_um));
                    write!(out, "<td><a href=\"#cell-{index}\">{rms} / {max}</a></td>")?;
                }
                (Some(index), None) => write!(out, "<td><a href=\"#cell-{index}\">there</a></td>")?,
                (None, _) => out.write_all(b"<td></td>")?,
            }
        }
        out.write_all(b"</tr>\n")?;
    }
    write_end(out)
}

/// The controller that the contents show.
fn shown(comparison: &Comparison) -> &str {
    if comparison.controllers().contains(&BEST) { BEST } else { BASELINE }
}

/// Each claim in a line, and what it says of every contour and machine behind it.
fn write_claims(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let verdicts = &comparison.verdicts;
    if verdicts.is_empty() {
        return Ok(());
    }
    let held = verdicts.iter().filter(|verdict| verdict.holds).count();
    writeln!(out, "<h2>Claims: {held} of {} hold</h2>", verdicts.len())?;
    for Claimed { claim, limit, held, worst, verdicts } in comparison.claims() {
        let class = if held == verdicts.len() { "better" } else { "worse" };
        writeln!(
            out,
            "<details><summary>{claim}, at most {limit}: <span class=\"{class}\">{held} of {} hold</span>, worst {worst:.3}</summary>",
            verdicts.len()
        )?;
        write_heading(out, ["contour", "machine", "against", "ratio", ""])?;
        for verdict in verdicts {
            let (class, word) = if verdict.holds { ("better", "holds") } else { ("worse", "falls short") };
            writeln!(
                out,
                "<tr><td>{}</td><td>{}</td><td>{}</td><td>{:.3}</td><td class=\"{class}\">{word}</td></tr>",
                escaped(&verdict.contour),
                escaped(&verdict.machine),
                escaped(&verdict.against),
                verdict.value
            )?;
        }
        write_end(out)?;
        out.write_all(b"</details>\n")?;
    }
    Ok(())
}

fn write_at_tolerance(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let rows = &comparison.at_tolerance;
    if rows.is_empty() {
        return Ok(());
    }
    let contours = each_once(rows.iter().map(|row| &row.contour));
    writeln!(out, "<h2>Machining time where no error is above {TOLERANCE_UM} µm</h2>")?;
    writeln!(out, "<p>Time against {BASELINE}, and the feedrate at which the tolerance just holds, mm/s.</p>")?;
    write_heading(out, std::iter::once("controller").chain(contours.iter().copied()))?;
    for controller in each_once(rows.iter().map(|row| &row.controller)) {
        write!(out, "<tr{}><td>{}</td>", ours(controller), escaped(controller))?;
        for contour in &contours {
            match comparison.just_holding(contour, controller) {
                Some((feed_mm_s, ratio)) => write!(out, "<td>{ratio:.2} at {feed_mm_s:.0}</td>")?,
                None => out.write_all(b"<td>never</td>")?,
            }
        }
        out.write_all(b"</tr>\n")?;
    }
    write_end(out)
}

/// The values that the peers were cut with.
fn write_tuned(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let searched: Vec<_> = comparison.tuned.iter().filter(|tuned| tuned.cuts > 0).collect();
    if searched.is_empty() {
        return Ok(());
    }
    out.write_all(b"<h2>Tuned values</h2>\n")?;
    write_heading(out, ["controller", "cuts", "RMS, µm", "values"])?;
    for tuned in searched {
        let (name, rms) = (escaped(&tuned.controller), number(tuned.rms_um));
        writeln!(
            out,
            "<tr><td>{name}</td><td>{}</td><td>{rms}</td><td class=\"words\">{}</td></tr>",
            tuned.cuts,
            escaped(&tuned.words())
        )?;
    }
    write_end(out)
}

fn write_cell(out: &mut impl Write, index: usize, rows: &[ComparisonRow]) -> io::Result<()> {
    let (contour, machine) = (escaped(&rows[0].contour), escaped(&rows[0].machine));
    writeln!(out, "<section id=\"cell-{index}\"><h2>{contour} on {machine}</h2>")?;
    let ratios = ["time ratio", "RMS ratio", "max ratio"];
    let measured = ["controller", "time, s", "RMS, µm", "max, µm", "uncut, µm"];
    write_heading(out, measured.into_iter().chain(ratios).chain(["command off, µm", "torque, N m", ""]))?;
    for row in rows {
        let note = match (row.completed, &row.faded_out) {
            (false, _) => "diverged".to_owned(),
            (true, Some(cause)) => format!("left the loop: {cause}"),
            (true, None) => String::new(),
        };
        write!(out, "<tr{}><td>{}</td><td>{:.3}</td>", ours(&row.controller), escaped(&row.controller), row.time_s)?;
        let errors_um = [row.rms_um, row.max_um, row.uncut_um].map(number);
        write!(out, "<td>{}</td>", errors_um.join("</td><td>"))?;
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
    write_end(out)?;
    writeln!(out, "<figure>{}</figure></section>", errors(rows).to_svg())
}

fn ours(controller: &str) -> &'static str {
    if controller.starts_with(BEST) { " class=\"ours\"" } else { "" }
}

/// Error over the cut: open loop, the best peer that knows no model, and the receding horizon, on one scale.
fn errors(rows: &[ComparisonRow]) -> Figure {
    let peers = rows.iter().filter(|row| {
        let blind = matches!(knows(row), Some(Knows::Nothing | Knows::Identified));
        blind && row.completed && row.controller != BASELINE && !row.controller.starts_with(BEST)
    });
    let peer = peers.min_by(|a, b| a.rms_um.total_cmp(&b.rms_um));
    let named = |name: &str| rows.iter().find(|row| row.controller == name);
    let shown: Vec<&ComparisonRow> = [named(BASELINE), peer, named(BEST)].into_iter().flatten().collect();
    let largest = shown.iter().filter(|row| row.completed).map(|row| row.max_um).fold(0.0, f64::max);
    let panel = |(row, color): (&&ComparisonRow, &str)| {
        let step = 1.0 / row.error_um.len().max(1) as f64;
        let points = row.error_um.iter().enumerate().map(|(i, &e)| [i as f64 * step * row.time_s, f64::from(e)]);
        Panel {
            title: row.controller.clone(),
            x_title: "Time [s]".to_owned(),
            y_title: "Contour error [µm]".to_owned(),
            curves: vec![Polyline { points: points.collect(), color: color.to_owned(), ..Polyline::default() }],
            y_range: (largest > 0.0).then_some([-largest, largest]),
            ..Panel::default()
        }
    };
    Figure { panels: shown.iter().zip(COLORS).map(panel).collect(), columns: 3, aspect: 0.7 }
}
