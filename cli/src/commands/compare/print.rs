//! A comparison as text.

use std::fmt::Write as _;
use std::io::Write;

use feedwright::compare::Comparison;
use feedwright::compare::table::ComparisonRow;
use feedwright::compare::tolerance::{AtTolerance, TOLERANCE_UM};
use feedwright::compare::tuned::Tuned;
use feedwright::compare::verdict::Verdict;

use crate::args::compare::CompareArgs;

pub(super) fn print(args: &CompareArgs, comparison: &Comparison) -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    out.write_all(tuned(&comparison.tuned).as_bytes())?;
    print_rows(&mut out, &comparison.rows)?;
    print_at_tolerance(&mut out, &comparison.at_tolerance)?;
    print_verdicts(&mut out, &comparison.verdicts)?;
    for path in [&args.json, &args.html].into_iter().flatten() {
        writeln!(out, "wrote {}", path.display())?;
    }
    Ok(())
}

/// What searches came to.
pub(super) fn tuned(tuned: &[Tuned]) -> String {
    let mut text = String::new();
    for tuned in tuned.iter().filter(|tuned| tuned.cuts > 0) {
        let Tuned { machine, controller, cuts, rms_um, open_um, .. } = tuned;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "tuned {controller} on {machine}: {} ({cuts} evaluations, {rms_um:.3} um where open loop has {open_um:.3})",
            tuned.words()
        );
    }
    text
}

fn print_rows(out: &mut impl Write, rows: &[ComparisonRow]) -> std::io::Result<()> {
    let mut heading = String::new();
    for row in rows {
        let here = format!("{} on {}", row.contour, row.machine);
        if here != heading {
            writeln!(
                out,
                "\n{here:<36} {:>8} {:>9} {:>19} {:>9} {:>9} {:>9} {:>6} {:>6} {:>6} {:>8} {:>8} {:>7}",
                "time s",
                "RMS um",
                "lowest to highest",
                "encoders",
                "max um",
                "uncut um",
                "time",
                "RMS",
                "max",
                "off um",
                "m/s2",
                "N m"
            )?;
            heading = here;
        }
        let [low, high] = row.rms_spread_um;
        let spread = if row.seeds > 1 { format!("{low:.3} to {high:.3}") } else { String::new() };
        let encoders = row.joint_rms_um.map_or(String::new(), |um| format!("{um:.3}"));
        writeln!(
            out,
            "{:<36} {:>8.3} {:>9.3} {spread:>19} {encoders:>9} {:>9.2} {:>9.2} {:>6.3} {:>6.3} {:>6.3} {:>8.0} {:>8.1} {:>7.2}{}",
            row.controller,
            row.time_s,
            row.rms_um,
            row.max_um,
            row.uncut_um,
            row.time_ratio,
            row.rms_ratio,
            row.max_ratio,
            row.max_deviation_um,
            row.accel_mm_s2 * 1e-3,
            row.peak_torque_nm,
            row.note().map_or(String::new(), |note| format!("  {note}")),
        )?;
    }
    Ok(())
}

fn print_at_tolerance(out: &mut impl Write, rows: &[AtTolerance]) -> std::io::Result<()> {
    if rows.is_empty() {
        return Ok(());
    }
    let limit = format!("max {TOLERANCE_UM} um");
    writeln!(out, "\n{limit:<20} {:<28} {:>9} {:>9} {:>6}", "", "feed mm/s", "time s", "time")?;
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.3}"));
    for row in rows {
        let feed = row.feed_mm_s.map_or("-".to_owned(), |feed| format!("{feed:.1}"));
        let (time, ratio) = (number(row.time_s), number(row.time_ratio));
        writeln!(out, "{:<20} {:<28} {feed:>9} {time:>9} {ratio:>6}", row.contour, row.controller)?;
    }
    Ok(())
}

fn print_verdicts(out: &mut impl Write, verdicts: &[Verdict]) -> std::io::Result<()> {
    if verdicts.is_empty() {
        return Ok(());
    }
    writeln!(out, "\n{:<66} {:<18} {:<10} {:>8} {:>8}", "", "", "", "value", "limit")?;
    for verdict in verdicts {
        let against = if verdict.against.is_empty() { String::new() } else { format!(" ({})", verdict.against) };
        writeln!(
            out,
            "{:<66} {:<18} {:<10} {:>8.3} {:>8.3} {:<5} {}{against}",
            verdict.claim,
            verdict.contour,
            verdict.machine,
            verdict.value,
            verdict.limit,
            verdict.unit,
            if verdict.holds { "holds" } else { "FALLS SHORT" },
        )?;
    }
    let held = verdicts.iter().filter(|verdict| verdict.holds).count();
    writeln!(out, "{held} of {} claims hold", verdicts.len())
}
