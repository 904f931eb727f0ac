//! Output of the study: the table of its README and a figure for each kind of noise.

use std::fmt::Write;
use std::ops::Range;

use feedwright::{BASELINE, COLORS, Figure, LineStyle, Panel, Polyline};
use feedwright_lab::{Comparison, LIMIT};

use crate::levels::{BASE, KINDS, NoiseKind};

/// Uncorrected, two peers, the default, and the limit.
pub(crate) const CONTROLLERS: [&str; 5] = [
    BASELINE,
    "feedforward-cross-coupled",
    "kalman-disturbance",
    "lqg-identified",
    LIMIT,
];
/// The comparison as it is kept, without plots and claims.
pub(crate) const COMPARISON: &str = "noise.json";
/// The document of the table.
pub(crate) const DOCUMENT: &str = "README.md";
/// Lines around the table.
const BEGIN: &str = "<!-- table of noise levels, made by `just noise-levels` -->\n";
const END: &str = "<!-- end of table -->\n";
/// Mark behind the number of a controller that did not stay in the loop in every cut.
const OUT_OF_THE_LOOP: &str = "*";
/// Room on either side of curves, powers of ten.
const MARGIN: f64 = 0.06;

/// Result of a controller on a machine.
struct Level {
    rms_um: f64,
    /// Cuts in which the supervisor took it out of the loop.
    lost: u32,
}

/// None where it was not cut, or not to its end.
fn level(comparison: &Comparison, machine: &str, controller: &str) -> Option<Level> {
    let rms_um = comparison.controlled_rms_over_contours_um(machine, controller)?;
    let its = comparison
        .rows
        .iter()
        .filter(|row| row.machine == machine && row.controller == controller);
    Some(Level {
        rms_um,
        lost: its.map(|row| row.lost).sum(),
    })
}

/// The levels of a kind that were cut.
fn levels_cut(comparison: &Comparison, kind: &NoiseKind) -> Vec<(f64, String)> {
    let named = kind
        .levels
        .iter()
        .map(|&level| (level, kind.machine_name(level)));
    let machines = comparison.machines();
    named
        .filter(|(_, machine)| machines.contains(&machine.as_str()))
        .collect()
}

/// One line for each level of each kind, one column for each controller.
pub(crate) fn table(comparison: &Comparison) -> Result<String, std::fmt::Error> {
    let mut table = String::from("| RMS over all contours, µm | |");
    CONTROLLERS
        .iter()
        .try_for_each(|controller| write!(table, " {controller} |"))?;
    writeln!(table, "\n|---|--:|{}", "--:|".repeat(CONTROLLERS.len()))?;
    line(&mut table, comparison, "without noise", "0", BASE)?;
    for kind in &KINDS {
        for (k, (size, machine)) in levels_cut(comparison, kind).into_iter().enumerate() {
            let unit = if kind.unit == "1" {
                String::new()
            } else {
                format!(" {}", kind.unit)
            };
            let name = if k == 0 { kind.level } else { "" };
            line(
                &mut table,
                comparison,
                name,
                &format!("{size}{unit}"),
                &machine,
            )?;
        }
    }
    writeln!(table, "\n{}", made(comparison))?;
    Ok(table)
}

/// Returns a sentence on the way in which the numbers were made.
fn made(comparison: &Comparison) -> String {
    let evaluations: u64 = comparison.tuned.iter().map(|tuned| tuned.cuts).sum();
    let tuned = if evaluations == 0 {
        "peers run with their defaults, which is a trial and no verdict".to_owned()
    } else {
        format!("peers were tuned in {evaluations} evaluations")
    };
    let machines = comparison.machines().len();
    format!(
        "{machines} machines, {} noise seeds; {tuned}.",
        comparison.noise_seeds
    )
}

fn line(
    table: &mut String,
    comparison: &Comparison,
    kind: &str,
    size: &str,
    machine: &str,
) -> std::fmt::Result {
    write!(table, "| {kind} | {size} |")?;
    for controller in CONTROLLERS {
        match level(comparison, machine, controller) {
            Some(Level { rms_um, lost: 0 }) => write!(table, " {rms_um:.3} |")?,
            Some(Level { rms_um, .. }) => write!(table, " {rms_um:.3}{OUT_OF_THE_LOOP} |")?,
            None => write!(table, " lost |")?,
        }
    }
    writeln!(table)
}

/// Returns the place of the table in the text of the document.
pub(crate) fn place(text: &str) -> Result<Range<usize>, String> {
    let start = text
        .find(BEGIN)
        .ok_or_else(|| format!("{DOCUMENT} has no line {BEGIN}"))?
        + BEGIN.len();
    let length = text[start..]
        .find(END)
        .ok_or_else(|| format!("{DOCUMENT} has no line {END}"))?;
    Ok(start..start + length)
}

/// Name and drawing of the figure of each kind: the error of each controller over the level. All
/// have the same vertical axis.
pub(crate) fn figures(comparison: &Comparison) -> Vec<(String, String)> {
    let curves: Vec<Vec<Polyline>> = KINDS.iter().map(|kind| curves(comparison, kind)).collect();
    let points = || curves.iter().flatten().flat_map(|curve| &curve.points);
    let y_range = range(points().map(|point| point[1]));
    let named = KINDS.iter().zip(&curves).map(|(kind, curves)| {
        let unit = if kind.unit == "1" {
            String::new()
        } else {
            format!(" [{}]", kind.unit)
        };
        let panel = Panel {
            x_title: format!("{}{unit}", capitalized(kind.level)),
            y_title: "RMS contour error [µm]".to_owned(),
            curves: curves.clone(),
            powers_of_ten: true,
            x_range: range(
                curves
                    .iter()
                    .flat_map(|curve| &curve.points)
                    .map(|point| point[0]),
            ),
            y_range,
            ..Panel::default()
        };
        (
            format!("{}.svg", kind.name),
            Figure {
                panels: vec![panel],
                ..Figure::default()
            }
            .to_svg(),
        )
    });
    named.collect()
}

fn curves(comparison: &Comparison, kind: &NoiseKind) -> Vec<Polyline> {
    let levels = levels_cut(comparison, kind);
    let curve = |(k, controller): (usize, &str)| {
        let at = |(size, machine): &(f64, String)| {
            let rms_um =
                level(comparison, machine, controller).map_or(f64::NAN, |level| level.rms_um);
            [size.log10(), rms_um.log10()]
        };
        let (label, line) = match controller {
            BASELINE => (controller.to_owned(), LineStyle::Dotted),
            LIMIT => (format!("{controller}, the limit"), LineStyle::Dashed),
            _ => (controller.to_owned(), LineStyle::Solid),
        };
        Polyline {
            label,
            points: levels.iter().map(at).collect(),
            line,
            color: COLORS[k].to_owned(),
        }
    };
    CONTROLLERS.into_iter().enumerate().map(curve).collect()
}

/// Returns the range with a margin; values that are not finite do not count.
fn range(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let finite = values.filter(|value| value.is_finite());
    let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
        [low.min(v), high.max(v)]
    });
    (low <= high).then_some([low - MARGIN, high + MARGIN])
}

fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_uppercase().chain(letters).collect()
    })
}
