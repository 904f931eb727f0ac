//! A comparison as text.

use std::fmt::Write as _;
use std::io::Write;

use feedwright::command::{ConsoleTable, TableColumn, tables, tell_written, wrapped};

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
    tell_written(out, files())
}

/// Returns the results of the searches as text.
pub(super) fn tuned(tuned: &[Tuned]) -> String {
    let mut text = String::new();
    for tuned in tuned.iter().filter(|tuned| tuned.cuts > 0) {
        let Tuned {
            machine,
            controller,
            cuts,
            rms_um,
            open_um,
            ..
        } = tuned;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "tuned {controller} on {machine}: {} ({cuts} evaluations, {rms_um:.3} um where the uncorrected cut has {open_um:.3})",
            tuned.words()
        );
    }
    text
}

fn rows(rows: &[ComparisonRow]) -> ConsoleTable {
    let mut table = ConsoleTable::new(vec![
        TableColumn::new(""),
        TableColumn::optional("time s", 5),
        TableColumn::new("RMS um"),
        TableColumn::optional("lowest to highest", 9),
        TableColumn::optional("encoders um", 6),
        TableColumn::new("max um"),
        TableColumn::optional("uncut um", 1),
        TableColumn::optional("time", 2),
        TableColumn::optional("RMS", 3),
        TableColumn::optional("max", 4),
        TableColumn::optional("off um", 7),
        TableColumn::optional("m/s2", 8),
        TableColumn::optional("N m", 8),
    ]);
    let mut heading = String::new();
    for row in rows {
        let here = format!("{} on {}", row.contour, row.machine);
        if here != heading {
            table.section(here.clone());
            heading = here;
        }
        let [low, high] = row.rms_spread_um;
        table.row(vec![
            row.controller.clone(),
            format!("{:.3}", row.time_s),
            format!("{:.3}", row.rms_um),
            if row.seeds > 1 {
                format!("{low:.3} to {high:.3}")
            } else {
                String::new()
            },
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
            table.remark(note.to_string());
        }
    }
    table
}

fn print_at_tolerance(out: &mut dyn Write, rows: &[AtTolerance]) -> std::io::Result<()> {
    if rows.is_empty() {
        return Ok(());
    }
    let mut table = ConsoleTable::new(vec![
        TableColumn::new(""),
        TableColumn::new("feed mm/s"),
        TableColumn::new("time s"),
        TableColumn::new("time"),
    ]);
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    let mut contour = "";
    for row in rows {
        if row.contour != contour {
            table.section(format!("{}, max {TOLERANCE_UM} um", row.contour));
            contour = &row.contour;
        }
        let feed = row
            .feed_mm_s
            .map_or("-".to_owned(), |feed| format!("{feed:.1}"));
        table.row(vec![
            row.controller.clone(),
            feed,
            number(row.time_s),
            number(row.time_ratio),
        ]);
    }
    table.print(out)
}

fn print_verdicts(out: &mut dyn Write, verdicts: &[Verdict]) -> std::io::Result<()> {
    if verdicts.is_empty() {
        return Ok(());
    }
    writeln!(out)?;
    for verdict in verdicts {
        let Verdict {
            claim,
            contour,
            machine,
            value,
            limit,
            unit,
            against,
            ..
        } = verdict;
        let against = if against.is_empty() {
            String::new()
        } else {
            format!(" ({against})")
        };
        let holds = if verdict.holds {
            "holds"
        } else {
            "FALLS SHORT"
        };
        let place = [contour.to_string(), machine.to_string()]
            .into_iter()
            .filter(|word| !word.is_empty());
        let place = place.collect::<Vec<_>>().join(" on ");
        let text =
            format!("{holds}: {claim}; {place}: {value:.3}, limit {limit:.3} {unit}{against}");
        writeln!(out, "{}", wrapped(&text, 2))?;
    }
    let held = verdicts.iter().filter(|verdict| verdict.holds).count();
    writeln!(out, "{held} of {} claims hold", verdicts.len())
}
