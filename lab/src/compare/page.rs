//! The page of a comparison: all at a glance, what is claimed, the times at equal tolerance, for each workpiece and machine the
//! table and the errors side by side, and the values of the peers. One file without references to anything outside it; equal comparisons give equal bytes.

mod cell;

use std::io::{self, Write};

use feedwright::{
    BASELINE, BEST, PagePart, escaped, number, write_foot, write_head, write_table_end, write_table_head,
};

use super::Comparison;
use super::competitor::Knowledge;
use super::overview::Claimed;
use super::table::{ComparisonRow, each_once};
use super::tolerance::TOLERANCE_UM;

/// Workpieces and machines are folded where there are more of them than these.
const OPEN_CELLS: usize = 4;

/// Writes the page.
///
/// # Errors
/// Where `out` takes no more.
pub fn write(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let introduction = format!(
        "Every controller on every workpiece and machine, tuned on each machine and made from what it may know of it: parameters, an \
         identification, or nothing. {} has parameters that are identified from a recording, {} such that are 20 % off, {} was identified and tuned on {} and meets the others \
         unseen. Errors are medians over the noise seeds, with the lowest and the highest below; uncut path, deviation, acceleration \
         and torque are the worst of all. All of it is simulated. Seed {}.",
        Knowledge::Identified.suffix(),
        Knowledge::TwentyPercentOff.suffix(),
        Knowledge::Unseen.suffix(),
        comparison.nominal,
        comparison.seed
    );
    let cells = cells(&comparison.rows);
    let [before, after] = overviews(comparison);
    let machines = comparison.machines().len();
    let cell_parts: Vec<PagePart> =
        cells.iter().enumerate().map(|(i, rows)| cell::part(i, rows, cells.len() > OPEN_CELLS, machines)).collect();
    let all: Vec<PagePart> = before
        .iter()
        .map(|(part, _)| part)
        .chain(&cell_parts)
        .chain(after.iter().map(|(part, _)| part))
        .cloned()
        .collect();
    write_head(out, "tables", "Comparison of controllers", &introduction, &all)?;
    before.iter().try_for_each(|overview| write_overview(out, comparison, overview))?;
    for (part, rows) in cell_parts.iter().zip(cells) {
        part.begin(out)?;
        cell::write(out, rows)?;
        PagePart::end(out)?;
    }
    after.iter().try_for_each(|overview| write_overview(out, comparison, overview))?;
    write_foot(out)
}

/// A part of the page over many rows.
#[derive(Clone, Copy)]
enum Overview {
    Machines,
    Contours,
    Claims,
    AtTolerance,
    Tuned,
}

/// Those before the rows and those behind them, where there is something to show.
fn overviews(comparison: &Comparison) -> [Vec<(PagePart, Overview)>; 2] {
    let verdicts = &comparison.verdicts;
    let held = verdicts.iter().filter(|verdict| verdict.holds).count();
    let mut before = vec![
        (PagePart::new("machines", "RMS contour error over all work, µm"), Overview::Machines),
        (PagePart::new("contours", "Contours and machines"), Overview::Contours),
    ];
    if !verdicts.is_empty() {
        let title = format!("Claims: {held} of {} hold", verdicts.len());
        before.push((PagePart::new("claims", title), Overview::Claims));
    }
    if !comparison.at_tolerance.is_empty() {
        let title = format!("Machining time where no error is above {TOLERANCE_UM} µm");
        before.push((PagePart::new("at-tolerance", title), Overview::AtTolerance));
    }
    let tuned = comparison.tuned.iter().any(|tuned| tuned.cuts > 0);
    let after = tuned.then(|| (PagePart::new("tuned", "Tuned values"), Overview::Tuned));
    [before, after.into_iter().collect()]
}

fn write_overview(
    out: &mut impl Write,
    comparison: &Comparison,
    (part, overview): &(PagePart, Overview),
) -> io::Result<()> {
    part.begin(out)?;
    match overview {
        Overview::Machines => write_machines(out, comparison)?,
        Overview::Contours => write_contents(out, comparison)?,
        Overview::Claims => write_claims(out, comparison)?,
        Overview::AtTolerance => write_at_tolerance(out, comparison)?,
        Overview::Tuned => write_tuned(out, comparison)?,
    }
    PagePart::end(out)
}

/// The rows of each workpiece and machine.
fn cells(rows: &[ComparisonRow]) -> Vec<&[ComparisonRow]> {
    rows.chunk_by(|a, b| a.contour == b.contour && a.machine == b.machine).collect()
}

/// All controllers on all machines.
fn write_machines(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let machines = comparison.machines();
    let unseen: Vec<&str> = machines.iter().copied().filter(|machine| comparison.has_geometry(machine)).collect();
    if !unseen.is_empty() {
        writeln!(
            out,
            "<p>By the encoders on {}: pitch, scale and squareness, which no controller can know, are left out there. The tables \
             below have the whole error, too.</p>",
            escaped(&unseen.join(", "))
        )?;
    }
    write_table_head(out, std::iter::once("controller").chain(machines.iter().copied()))?;
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
    write_table_end(out)
}

/// Where each contour and machine is found, and what the default controller does there.
fn write_contents(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let (machines, cells) = (comparison.machines(), cells(&comparison.rows));
    let whole = if machines.iter().any(|machine| comparison.has_geometry(machine)) { "whole " } else { "" };
    writeln!(out, "<p>RMS / largest {whole}contour error of {}, µm.</p>", shown(comparison))?;
    write_table_head(out, std::iter::once("contour").chain(machines.iter().copied()))?;
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
    write_table_end(out)
}

/// The controller that the contents show.
fn shown(comparison: &Comparison) -> &str {
    if comparison.controllers().contains(&BEST) { BEST } else { BASELINE }
}

/// Each claim in a line, and what it says of every contour and machine behind it.
fn write_claims(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    for Claimed { claim, limit, unit, held, worst, verdicts } in comparison.claims() {
        let class = if held == verdicts.len() { "better" } else { "worse" };
        writeln!(
            out,
            "<details class=\"claim\"><summary>{claim}, at most {limit}{}: <span class=\"{class}\">{held} of {} hold</span>, worst {worst:.3}</summary>",
            if unit.is_empty() { String::new() } else { format!(" {}", unit.replace("um", "µm")) },
            verdicts.len()
        )?;
        write_table_head(out, ["contour", "machine", "against", if unit.is_empty() { "ratio" } else { unit }, ""])?;
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
        write_table_end(out)?;
        out.write_all(b"</details>\n")?;
    }
    Ok(())
}

fn write_at_tolerance(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let rows = &comparison.at_tolerance;
    let contours = each_once(rows.iter().map(|row| &row.contour));
    writeln!(out, "<p>Time against {BASELINE}, and the feedrate at which the tolerance just holds, mm/s.</p>")?;
    write_table_head(out, std::iter::once("controller").chain(contours.iter().copied()))?;
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
    write_table_end(out)
}

/// The values that the peers were cut with.
fn write_tuned(out: &mut impl Write, comparison: &Comparison) -> io::Result<()> {
    let searched = comparison.tuned.iter().filter(|tuned| tuned.cuts > 0);
    let open = "Evaluations, RMS of the work that was searched on, and its uncorrected RMS. A value at an end of its range may have a better one \
                beyond; a correction that is switched off is no better than none.";
    writeln!(out, "<p>{open}</p>")?;
    write_table_head(out, ["controller", "machine", "evaluations", "RMS, µm", "uncorrected, µm", "values"])?;
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
    write_table_end(out)
}

fn ours(controller: &str) -> &'static str {
    if controller.starts_with(BEST) { " class=\"ours\"" } else { "" }
}
