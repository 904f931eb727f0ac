//! The page of a comparison: all at a glance, what is claimed, the times at equal tolerance, for each workpiece and machine the
//! table and the errors side by side, and the values of the peers. One file without references to anything outside it; equal comparisons give equal bytes.

use std::io::{self, Write};

use super::Comparison;
use super::competitor::Knowledge;
use super::overview::Claimed;
use super::table::{ComparisonRow, each_once, knows};
use super::tolerance::TOLERANCE_UM;
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
        "Every controller on every workpiece and machine, tuned on each machine and made from what it may know of it: parameters, an \
         identification, or nothing. {} has parameters that are identified from a recording, {} such that are 20 % off, {} was identified and tuned on {} and meets the others \
         unseen. Errors are medians over the noise seeds, with the lowest and the highest below; uncut path, deviation, acceleration \
         and torque are the worst of all. Seed {}.",
        Knowledge::Identified.suffix(),
        Knowledge::TwentyPercentOff.suffix(),
        Knowledge::Unseen.suffix(),
        comparison.nominal,
        comparison.seed
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
    out.write_all("<h2>RMS contour error over all work, µm</h2>\n".as_bytes())?;
    let unseen: Vec<&str> = machines.iter().copied().filter(|machine| comparison.has_geometry(machine)).collect();
    if !unseen.is_empty() {
        writeln!(
            out,
            "<p>By the encoders on {}: pitch, scale and squareness, which no controller can know, are left out there. The tables \
             below have the whole error, too.</p>",
            escaped(&unseen.join(", "))
        )?;
    }
    write_heading(out, std::iter::once("controller").chain(machines.iter().copied()))?;
    for controller in comparison.controllers() {
        write!(out, "<tr{}><td>{}</td>", ours(controller), escaped(controller))?;
        for machine in &machines {
            let cut = comparison.rows.iter().any(|row| row.machine == *machine && row.controller == controller);
            let text = match comparison.controlled_rms_over_contours_um(machine, controller) {
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

/// Where each contour and machine is found, and what the default controller does there.
fn write_contents(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let (machines, cells) = (comparison.machines(), cells(&comparison.rows));
    let whole = if machines.iter().any(|machine| comparison.has_geometry(machine)) { "whole " } else { "" };
    writeln!(
        out,
        "<h2>Contours and machines</h2>\n<p>RMS / largest {whole}contour error of {}, µm.</p>",
        shown(comparison)
    )?;
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
    for Claimed { claim, limit, unit, held, worst, verdicts } in comparison.claims() {
        let class = if held == verdicts.len() { "better" } else { "worse" };
        writeln!(
            out,
            "<details><summary>{claim}, at most {limit}{}: <span class=\"{class}\">{held} of {} hold</span>, worst {worst:.3}</summary>",
            if unit.is_empty() { String::new() } else { format!(" {}", unit.replace("um", "µm")) },
            verdicts.len()
        )?;
        write_heading(out, ["contour", "machine", "against", if unit.is_empty() { "ratio" } else { unit }, ""])?;
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
    let open = "Evaluations, RMS over what was searched on, and that of open loop. A value at an end of its range may have a better one \
                beyond; a correction that is switched off is no better than none.";
    writeln!(out, "<h2>Tuned values</h2>\n<p>{open}</p>")?;
    write_heading(out, ["controller", "machine", "evaluations", "RMS, µm", "open loop, µm", "values"])?;
    for tuned in searched {
        let names = [&tuned.controller, &tuned.machine].map(|name| escaped(name));
        let at_end = tuned.switched_off || tuned.values.iter().any(|value| value.at_end.is_some());
        writeln!(
            out,
            "<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"words{}\">{}</td></tr>",
            names.join("</td><td>"),
            tuned.cuts,
            number(tuned.rms_um),
            number(tuned.open_um),
            if at_end { " worse" } else { "" },
            escaped(&tuned.words())
        )?;
    }
    write_end(out)
}

fn write_cell(out: &mut impl Write, index: usize, rows: &[ComparisonRow]) -> io::Result<()> {
    let (contour, machine) = (escaped(&rows[0].contour), escaped(&rows[0].machine));
    writeln!(out, "<section id=\"cell-{index}\"><h2>{contour} on {machine}</h2>")?;
    let has_joints = rows.iter().any(|row| row.joint_rms_um.is_some());
    let measured = ["controller", "time, s", "RMS, µm", "max, µm"];
    let joints: &[&str] = if has_joints { &["RMS by encoders, µm", "max by encoders, µm"] } else { &[] };
    let ratios = ["uncut, µm", "time ratio", "RMS ratio", "max ratio"];
    let command = ["command off, µm", "command, m/s²", "torque, N m", ""];
    write_heading(out, measured.into_iter().chain(joints.iter().copied()).chain(ratios).chain(command))?;
    rows.iter().try_for_each(|row| write_row(out, row, has_joints))?;
    write_end(out)?;
    writeln!(out, "<figure>{}</figure></section>", errors(rows).to_svg())
}

fn write_row(out: &mut impl Write, row: &ComparisonRow, has_joints: bool) -> io::Result<()> {
    write!(out, "<tr{}><td>{}</td><td>{:.3}</td>", ours(&row.controller), escaped(&row.controller), row.time_s)?;
    for (um, spread_um) in [(row.rms_um, row.rms_spread_um), (row.max_um, row.max_spread_um)] {
        write!(out, "<td>{}{}</td>", number(um), spread(row, spread_um))?;
    }
    if has_joints {
        let [rms, max] = [row.joint_rms_um, row.joint_max_um].map(|um| um.map_or(String::new(), number));
        write!(out, "<td>{rms}</td><td>{max}</td>")?;
    }
    write!(out, "<td>{}</td>", number(row.uncut_um))?;
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
    let command = [row.max_deviation_um, row.accel_mm_s2 * 1e-3, row.peak_torque_nm].map(number).join("</td><td>");
    writeln!(out, "<td>{command}</td><td class=\"note\">{}</td></tr>", escaped(&row.note().unwrap_or_default()))
}

/// The lowest and the highest of all noise seeds, where there are several.
fn spread(row: &ComparisonRow, [low, high]: [f64; 2]) -> String {
    if row.seeds > 1 { format!("<small>{} to {}</small>", number(low), number(high)) } else { String::new() }
}

fn ours(controller: &str) -> &'static str {
    if controller.starts_with(BEST) { " class=\"ours\"" } else { "" }
}

/// Error over the cut: open loop, the best peer that knows no model, and the default, on one scale.
fn errors(rows: &[ComparisonRow]) -> Figure {
    let peers = rows.iter().filter(|row| {
        let blind = matches!(knows(row), Some(Knows::Nothing | Knows::Identified));
        let own = !row.controller.ends_with(Knowledge::Unseen.suffix());
        blind && own && row.completed && row.controller != BASELINE && !row.controller.starts_with(BEST)
    });
    let peer = peers.min_by(|a, b| a.rms_um.total_cmp(&b.rms_um));
    let named = |name: &str| rows.iter().find(|row| row.controller == name);
    let shown: Vec<&ComparisonRow> = [named(BASELINE), peer, named(BEST)].into_iter().flatten().collect();
    let largest = shown.iter().filter(|row| row.completed).map(|row| row.max_spread_um[1]).fold(0.0, f64::max);
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
