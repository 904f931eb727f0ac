//! The tables of the effects of real axes: held-out work on machines with noise, and the cost of
//! each imperfection for each controller.

use std::fmt::Write;

use feedwright_ident::quadratic_mean;
use feedwright_lab::{Comparison, ComparisonRow};

use super::{Result, heading};

/// Controllers that are shown, in this order.
const SHOWN: &[&str] = &[
    "uncorrected",
    "feedforward-as-delivered",
    "contour-compensation",
    "cross-coupled",
    "cross-coupled-feedrate",
    "corner-contour",
    "constrained-feedrate",
    "fuzzy-h-infinity",
    "disturbance-observer",
    "kalman-disturbance",
    "feedforward",
    "feedforward-cross-coupled",
    "feedforward-cross-coupled+identified",
    "feedforward-cross-coupled+20%off",
    "feedforward-cross-coupled+log",
    "lqg-identified",
    "lqg-identified+log",
    "lqg-preview",
];

/// Returns those shown controllers that were cut.
fn shown(comparison: &Comparison) -> Vec<&'static str> {
    let was_cut = |controller: &&str| {
        comparison
            .rows
            .iter()
            .any(|row| row.controller == *controller)
    };
    SHOWN.iter().copied().filter(was_cut).collect()
}

/// Errors of a controller on a machine, over all work that was cut, um.
struct OverAll {
    /// Half of the workpieces have a lower RMS.
    median_um: f64,
    /// The same at the tool.
    tool_um: f64,
    /// Quadratic mean of the RMS.
    rms_um: f64,
    /// Largest error.
    max_um: f64,
}

/// None where it was not cut, or not to its end.
fn over_all(
    comparison: &Comparison,
    machine: &str,
    controller: &str,
    [rms, max]: [fn(&ComparisonRow) -> f64; 2],
) -> Option<OverAll> {
    let each_um = comparison.on_contours(machine, controller, rms)?;
    let median = |mut each_um: Vec<f64>| {
        each_um.sort_by(f64::total_cmp);
        each_um.get(each_um.len() / 2).copied()
    };
    Some(OverAll {
        median_um: median(each_um.clone())?,
        tool_um: median(comparison.on_contours(machine, controller, |row| row.rms_um)?)?,
        rms_um: quadratic_mean(each_um),
        max_um: comparison
            .on_contours(machine, controller, max)?
            .into_iter()
            .fold(0.0, f64::max),
    })
}

/// One line for each controller, one column for each machine: errors by encoders over all work, and
/// the median at the tool.
pub(super) fn held_out(comparison: &Comparison) -> Result<String> {
    let machines = comparison.machines();
    let mut table = String::new();
    heading(
        &mut table,
        "median RMS / at the tool / RMS of all / max, \u{b5}m",
        &machines,
    )?;
    for controller in shown(comparison) {
        write!(table, "| {controller} |")?;
        for machine in &machines {
            let numbers = [
                ComparisonRow::controlled_rms_um,
                ComparisonRow::controlled_max_um,
            ];
            match over_all(comparison, machine, controller, numbers) {
                Some(OverAll {
                    median_um,
                    tool_um,
                    rms_um,
                    max_um,
                }) => {
                    write!(
                        table,
                        " {median_um:.2} / {tool_um:.2} / {rms_um:.2} / {max_um:.1} |"
                    )?;
                }
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
    let shown = shown(comparison);
    heading(&mut table, "RMS over all contours, \u{b5}m", &shown)?;
    for machine in comparison.machines() {
        write!(table, "| {machine} |")?;
        for controller in &shown {
            match comparison.rms_over_contours_um(machine, controller) {
                Some(rms_um) => write!(table, " {rms_um:.3} |")?,
                None => write!(table, " lost |")?,
            }
        }
        writeln!(table)?;
    }
    Ok(table)
}
