//! Compensation files of LinuxCNC (`COMP_FILE`): a line for each position, at most 256.
//!
//! ```text
//! type 0   nominal  forward  reverse               where the tool is at the nominal command
//! type 1   nominal  forward trim  reverse trim     what is added to the command: nominal minus where the tool is
//! ```
//!
//! Source: LinuxCNC 2.9, the INI reference of `COMP_FILE` and `COMP_FILE_TYPE`. The table of a
//! geometry file has the error of the tool, forward minus nominal.

use std::fmt::Write;

use feedwright_sim::{AXIS_NAMES, GeometryCheck, GeometryFile, GeometryOrigin, MeasuredSet};

use super::fit::{FoundGeometry, NoGeometry};
use super::text::{MeasurementError, TextBlock};
use crate::model::version;

/// Most positions that LinuxCNC takes.
const MAX_POSITIONS: usize = 256;

/// Decimals of a millimeter that are written at most; below any encoder, above the rounding of a
/// difference.
const DECIMALS: f64 = 1e9;

/// The table of a file, position (mm) and errors in both directions (um), and the type that its
/// values have.
pub(super) fn table(block: &TextBlock) -> Result<(Vec<[f64; 3]>, u8), MeasurementError> {
    let number = |row: &(usize, Vec<String>)| -> Result<[f64; 3], MeasurementError> {
        Ok([
            block.number(row, 0)?,
            block.number(row, 1)?,
            block.number(row, 2)?,
        ])
    };
    let rows: Vec<[f64; 3]> = block.rows.iter().map(number).collect::<Result<_, _>>()?;
    if let Some(at) = rows.windows(2).position(|pair| pair[0][0] >= pair[1][0]) {
        let message = format!("position {} follows {}", rows[at + 1][0], rows[at][0]);
        return Err(block.error(
            block.rows[at + 1].0,
            message,
            "positions of a compensation file rise",
        ));
    }
    if rows.len() > MAX_POSITIONS {
        let message = format!("{} positions; LinuxCNC takes {MAX_POSITIONS}", rows.len());
        return Err(block.error(block.line(), message, "leave positions out"));
    }
    let largest = |of: &dyn Fn(&[f64; 3]) -> f64| rows.iter().map(of).fold(0.0, f64::max);
    // Errors are far smaller than positions: whichever reading gives the smaller errors is right.
    let as_positions = largest(&|[nominal, forward, reverse]| {
        (forward - nominal).abs().max((reverse - nominal).abs())
    });
    let as_trims = largest(&|[_, forward, reverse]| forward.abs().max(reverse.abs()));
    let kind = match block.keys.get("type").map(String::as_str) {
        Some("0") => 0,
        Some("1") => 1,
        _ => u8::from(as_trims < as_positions),
    };
    // Rounded: a difference of two decimal numbers has no more digits than they have.
    let error_um = |nominal: f64, value: f64| match kind {
        0 => ((value - nominal) * DECIMALS).round() / DECIMALS * 1e3,
        _ => -value * 1e3,
    };
    let row = |&[nominal, forward, reverse]: &[f64; 3]| {
        [
            nominal,
            error_um(nominal, forward),
            error_um(nominal, reverse),
        ]
    };
    Ok((rows.iter().map(row).collect(), kind))
}

/// Steps of a turn of the screw in a table that has a pitch error; linear between them it keeps 93
/// % of it at least.
const STEPS_PER_TURN: f64 = 8.0;
/// Steps of a table without pitch error.
const STEPS: f64 = 32.0;

/// The errors of an axis in its own direction at the positions of a compensation file. `None` where
/// nothing is known of the axis, or not over which travel.
pub fn sampled_table(file: &GeometryFile, axis: usize) -> Option<Vec<[f64; 3]>> {
    let of = &file.axes[axis];
    let has_table_alone = [of.scale_um_m, of.pitch_error_um, of.backlash_um]
        .iter()
        .all(|value| *value == 0.0);
    if has_table_alone {
        return (!of.table.is_empty()).then(|| of.table.clone());
    }
    let travel_mm = of.to_mm - of.from_mm;
    let steps = if of.pitch_error_um == 0.0 {
        STEPS
    } else {
        STEPS_PER_TURN * travel_mm / of.lead_mm_per_rev
    };
    let steps = steps.ceil().clamp(1.0, MAX_POSITIONS as f64 - 1.0);
    let row = |step: u32| {
        let mut at_mm = [0.0; 3];
        at_mm[axis] = (1e4 * (of.from_mm + travel_mm * f64::from(step) / steps)).round() / 1e4;
        let error_um = |way: f64| (1e3 * file.error_um(at_mm, [way; 3])[axis]).round() / 1e3;
        [at_mm[axis], error_um(1.0), error_um(-1.0)]
    };
    (travel_mm > 0.0).then(|| (0..=steps as u32).map(row).collect())
}

/// Noise that is assumed for a table that is exact to its digits, um.
const EXACT_UM: f64 = 0.01;

/// The geometry that compensation files state: axis and rows of each.
///
/// # Errors
/// Tables without any error.
pub fn geometry_of_tables(
    tables: Vec<(usize, Vec<[f64; 3]>)>,
    source: &str,
) -> Result<FoundGeometry, NoGeometry> {
    let origin = GeometryOrigin {
        written_by: version(),
        source: source.to_owned(),
        date: String::new(),
    };
    let mut file = GeometryFile {
        origin,
        ..GeometryFile::default()
    };
    for (axis, table) in tables {
        let rows = table.iter().flat_map(|&[at_mm, forward, backward]| {
            [vec![at_mm, 1.0, forward], vec![at_mm, -1.0, backward]]
        });
        file.measured.push(MeasuredSet {
            name: format!("compensation {}", AXIS_NAMES[axis]),
            kind: "axis".to_owned(),
            axes: AXIS_NAMES[axis].to_owned(),
            noise_um: EXACT_UM,
            left_um: EXACT_UM,
            rows: rows.collect(),
            ..MeasuredSet::default()
        });
        let ends = |row: Option<&[f64; 3]>| row.map_or(0.0, |row| row[0]);
        (file.axes[axis].from_mm, file.axes[axis].to_mm) =
            (ends(table.first()), ends(table.last()));
        file.axes[axis].table = table;
    }
    let check = file.check()?.unwrap_or(GeometryCheck {
        before_um: 0.0,
        after_um: 0.0,
        rows: 0,
    });
    let notes = vec![
        "the tables are taken as exact: a compensation file does not say how well they are known"
            .to_owned(),
    ];
    Ok(FoundGeometry {
        file,
        values: Vec::new(),
        sets: Vec::new(),
        notes,
        check,
    })
}

/// The text of a compensation file of a type, 0 or 1.
pub fn comp_file(table: &[[f64; 3]], kind: u8) -> String {
    let rounded = |mm: f64| (mm * DECIMALS).round() / DECIMALS + 0.0;
    let mut text = String::new();
    for &[nominal, forward_um, backward_um] in table {
        let value = |um: f64| {
            if kind == 0 {
                rounded(nominal + 1e-3 * um)
            } else {
                rounded(-1e-3 * um)
            }
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{nominal} {} {}",
            value(forward_um),
            value(backward_um)
        );
    }
    text
}
