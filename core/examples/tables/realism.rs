//! The tables of what real axes have: held-out work on machines with noise, and what each imperfection costs each controller.

use std::fmt::Write;

use feedwright::compare::Comparison;
use feedwright::compare::table::ComparisonRow;

use super::{Result, heading};

/// Controllers that are shown, in this order.
const SHOWN: &[&str] = &[
    "open-loop",
    "feedforward-as-delivered",
    "contour-compensation",
    "cross-coupled",
    "disturbance-observer",
    "kalman-disturbance",
    "feedforward",
    "feedforward-cross-coupled",
    "feedforward-cross-coupled+20%off",
    "receding-horizon",
    "lqg-preview",
];

/// Of a controller on a machine, over all that was cut: RMS (quadratic mean), um, and the largest error, um. None where it was not cut, or
/// not to its end.
fn over_all_um(
    comparison: &Comparison,
    machine: &str,
    controller: &str,
    [rms, max]: [fn(&ComparisonRow) -> f64; 2],
) -> Option<[f64; 2]> {
    let contours = comparison.contours();
    let (mut square_um2, mut largest_um) = (0.0, 0.0_f64);
    for contour in &contours {
        let row = comparison.row(contour, machine, controller).filter(|row| row.completed)?;
        square_um2 += rms(row).powi(2);
        largest_um = largest_um.max(max(row));
    }
    Some([(square_um2 / contours.len() as f64).sqrt(), largest_um])
}

/// One line for each controller, one column for each machine: RMS and largest error by encoders, over all work.
pub(super) fn held_out(comparison: &Comparison) -> Result<String> {
    let machines = comparison.machines();
    let mut table = String::new();
    heading(&mut table, "RMS / max, \u{b5}m", &machines)?;
    for controller in SHOWN {
        write!(table, "| {controller} |")?;
        for machine in &machines {
            let numbers = [ComparisonRow::controlled_rms_um, ComparisonRow::controlled_max_um];
            match over_all_um(comparison, machine, controller, numbers) {
                Some([rms_um, max_um]) => write!(table, " {rms_um:.2} / {max_um:.1} |")?,
                None => write!(table, " lost |")?,
            }
        }
        writeln!(table)?;
    }
    Ok(table)
}

/// One line for each machine, one column for each controller: RMS over all contours.
pub(super) fn imperfections(comparison: &Comparison) -> Result<String> {
    let mut table = String::new();
    heading(&mut table, "RMS over all contours, \u{b5}m", SHOWN)?;
    for machine in comparison.machines() {
        write!(table, "| {machine} |")?;
        for controller in SHOWN {
            let numbers: [fn(&ComparisonRow) -> f64; 2] = [|row| row.rms_um, |row| row.max_um];
            match over_all_um(comparison, machine, controller, numbers) {
                Some([rms_um, _]) => write!(table, " {rms_um:.3} |")?,
                None => write!(table, " lost |")?,
            }
        }
        writeln!(table)?;
    }
    Ok(table)
}
