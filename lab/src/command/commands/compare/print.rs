//! A comparison as text.

use std::io::Write;

use feedwright::command::{ConsoleTable, TableColumn, report_written, tables, wrapped};

use crate::compare::Comparison;
use crate::compare::table::ComparisonRow;
use crate::compare::tolerance::{AtTolerance, TOLERANCE_UM};
use crate::compare::tuned::Tuned;
use crate::compare::verdict::Verdict;

use crate::command::args::compare::CompareArgs;

pub(super) fn print(args: &CompareArgs, comparison: &Comparison) -> std::io::Result<()> {
    let files = || [args.json.as_deref()];
    let out = &mut *tables(files());
    out.write_all(tuned(&comparison.tuned).as_bytes())?;
    rows(&comparison.rows).print(out)?;
    print_at_tolerance(out, &comparison.at_tolerance)?;
    print_verdicts(out, &comparison.verdicts)?;
    report_written(out, files())
}

/// Returns the results of the searches as text.
pub(super) fn tuned(tuned: &[Tuned]) -> String {
    let line = |it: &Tuned| {
        format!(
            "tuned {} on {}: {} ({} evaluations, {:.3} um where the uncorrected cut has {:.3})\n",
            it.controller,
            it.machine,
            it.words(),
            it.cuts,
            it.rms_um,
            it.open_um
        )
    };
    tuned
        .iter()
        .filter(|tuned| tuned.cuts > 0)
        .map(line)
        .collect()
}

fn rows(rows: &[ComparisonRow]) -> ConsoleTable {
    let optional = TableColumn::optional;
    let mut table = ConsoleTable::new(vec![
        TableColumn::new(""),
        optional("time s", 5),
        TableColumn::new("RMS um"),
        optional("lowest to highest", 9),
        optional("encoders um", 6),
        TableColumn::new("max um"),
        optional("uncut um", 1),
        optional("time", 2),
        optional("RMS", 3),
        optional("max", 4),
        optional("off um", 7),
        optional("m/s2", 8),
        optional("N m", 8),
    ]);
    let mut heading = String::new();
    for row in rows {
        let here = format!("{} on {}", row.contour, row.machine);
        if here != heading {
            table.section(here.clone());
            heading = here;
        }
        let [low, high] = row.rms_spread_um;
        let spread = (row.seeds > 1).then(|| format!("{low:.3} to {high:.3}"));
        table.row(vec![
            row.controller.clone(),
            format!("{:.3}", row.time_s),
            format!("{:.3}", row.rms_um),
            spread.unwrap_or_default(),
            row.joint_rms_um
                .map_or(String::new(), |um| format!("{um:.3}")),
            format!("{:.2}", row.max_um),
            format!("{:.2}", row.uncut_um),
            format!("{:.3}", row.time_ratio),
            format!("{:.3}", row.rms_ratio),
            format!("{:.3}", row.max_ratio),
            format!("{:.0}", row.max_deviation_um),
            format!("{:.1}", row.accel_mm_s2 * 1e-3),
            format!("{:.2}", row.peak_torque_nm),
        ]);
        if let Some(note) = row.note() {
            table.remark(note);
        }
    }
    table
}

fn print_at_tolerance(out: &mut dyn Write, rows: &[AtTolerance]) -> std::io::Result<()> {
    if rows.is_empty() {
        return Ok(());
    }
    let headings = ["", "feed mm/s", "time s", "time"];
    let mut table = ConsoleTable::new(headings.map(TableColumn::new).into());
    let number = |value: Option<f64>, digits: usize| {
        value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
    };
    let mut contour = "";
    for row in rows {
        if row.contour != contour {
            table.section(format!("{}, max {TOLERANCE_UM} um", row.contour));
            contour = &row.contour;
        }
        let [time_s, ratio] = [row.time_s, row.time_ratio].map(|value| number(value, 3));
        table.row(vec![
            row.controller.clone(),
            number(row.feed_mm_s, 1),
            time_s,
            ratio,
        ]);
    }
    table.print(out)
}

fn print_verdicts(out: &mut dyn Write, verdicts: &[Verdict]) -> std::io::Result<()> {
    if verdicts.is_empty() {
        return Ok(());
    }
    writeln!(out)?;
    for it in verdicts {
        let against = match &it.against[..] {
            "" => String::new(),
            against => format!(" ({against})"),
        };
        let holds = if it.holds { "holds" } else { "FALLS SHORT" };
        let mut place = vec![it.contour.as_str(), &it.machine];
        place.retain(|word| !word.is_empty());
        let text = format!(
            "{holds}: {}; {}: {:.3}, limit {:.3} {}{against}",
            it.claim,
            place.join(" on "),
            it.value,
            it.limit,
            it.unit
        );
        writeln!(out, "{}", wrapped(&text, 2))?;
    }
    let held = verdicts.iter().filter(|verdict| verdict.holds).count();
    writeln!(out, "{held} of {} claims hold", verdicts.len())
}
