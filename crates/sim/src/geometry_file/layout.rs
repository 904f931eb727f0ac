//! The layout of a geometry file: its tables, and what holds between their values.

use super::observation::{KINDS, MeasuredSet};
use super::{AxisGeometry, GEOMETRY_FORMAT, GeometryFile, MeasuredSquareness, keys};
use crate::machine::AXIS_NAMES;
use crate::toml_file::key::{read, read_all};
use crate::toml_file::{Document, Fault, Table};

/// Keys of straightness in directions x, y and z.
pub(super) const STRAIGHTNESS: [&str; 3] = ["straightness_x", "straightness_y", "straightness_z"];

/// The geometry that a file states, or every fault in it.
pub(super) fn geometry(document: &Document<'_>) -> Result<GeometryFile, Vec<Fault>> {
    let mut faults = Vec::new();
    let mut root = Table::root(document, None);
    if let Some(format) = root
        .whole("format", "", 1.0..=1e9, &mut faults)
        .filter(|format| *format != GEOMETRY_FORMAT)
    {
        faults.push(Fault {
            at: root.place("format"),
            label: "of another version",
            message: format!("the geometry file is of format {format}; this version reads format {GEOMETRY_FORMAT}"),
            hint: Some("identify the measurement again with this version".to_owned()),
        });
    }
    let mut file = GeometryFile {
        origin: read(keys::ORIGIN, &mut root, &mut faults),
        ..GeometryFile::default()
    };
    if let Some(mut table) = root.optional_table("axis", &mut faults) {
        for (i, name) in AXIS_NAMES.into_iter().enumerate() {
            if let Some(table) = table.optional_table(name, &mut faults) {
                file.axes[i] = axis(i, table, &mut faults);
            }
        }
        table.finish(&mut faults);
    }
    let squareness = root.optional_table("geometry", &mut faults);
    file.squareness = squareness.map_or_else(MeasuredSquareness::default, |table| {
        read_all(keys::SQUARENESS, table, &mut faults)
    });
    if let Some(mut table) = root.optional_table("measured", &mut faults) {
        file.unknowns = table
            .whole("unknowns", "", 0.0..=1e6, &mut faults)
            .unwrap_or(0);
        let sets = table
            .optional_table("set", &mut faults)
            .map(|sets| sets.tables(&mut faults));
        file.measured = sets
            .into_iter()
            .flatten()
            .map(|(name, table)| set(name, table, &mut faults))
            .collect();
        table.finish(&mut faults);
    }
    root.finish(&mut faults);
    if faults.is_empty() {
        Ok(file)
    } else {
        Err(faults)
    }
}

fn axis(number: usize, mut table: Table<'_, '_>, faults: &mut Vec<Fault>) -> AxisGeometry {
    let mut axis: AxisGeometry = read(keys::AXIS, &mut table, faults);
    axis.table = table
        .rows("table", 3, faults)
        .into_iter()
        .filter_map(|row| row.try_into().ok())
        .collect();
    rising("table", axis.table.iter().map(|row| row[0]), &table, faults);
    for (i, key) in STRAIGHTNESS.into_iter().enumerate() {
        let rows = table.rows(key, 2, faults);
        if i == number && !rows.is_empty() {
            faults.push(Fault {
                at: table.place(key),
                label: "its own direction",
                message: format!(
                    "{key} is the error of axis.{} in its own direction",
                    AXIS_NAMES[number]
                ),
                hint: Some("write that as table".to_owned()),
            });
        }
        rising(key, rows.iter().map(|row| row[0]), &table, faults);
        axis.straightness[i] = rows
            .into_iter()
            .filter_map(|row| row.try_into().ok())
            .collect();
    }
    if axis.pitch_error_um != 0.0 && axis.lead_mm_per_rev == 0.0 {
        faults.push(Fault {
            at: table.place("pitch_error_um"),
            label: "needs a lead",
            message: format!(
                "pitch_error_um is {} um, and lead_mm_per_rev is missing",
                axis.pitch_error_um
            ),
            hint: Some(
                "give the lead of the screw, lead_mm_per_rev, as in the machine file".to_owned(),
            ),
        });
    }
    table.finish(faults);
    axis
}

fn rising(
    key: &'static str,
    positions: impl Iterator<Item = f64>,
    table: &Table<'_, '_>,
    faults: &mut Vec<Fault>,
) {
    let positions: Vec<f64> = positions.collect();
    if let Some(pair) = positions.windows(2).find(|pair| pair[0] >= pair[1]) {
        faults.push(Fault {
            at: table.place(key),
            label: "not in order",
            message: format!(
                "positions of {key} have to rise; {} mm is followed by {} mm",
                pair[0], pair[1]
            ),
            hint: None,
        });
    }
}

fn set(name: String, mut table: Table<'_, '_>, faults: &mut Vec<Fault>) -> MeasuredSet {
    let before = faults.len();
    let mut set: MeasuredSet = read(keys::SET, &mut table, faults);
    set.name = name;
    let mut fault = |key: &str, message: String, hint: &str| {
        faults.push(Fault {
            at: table.place(key),
            label: "here",
            message,
            hint: Some(hint.to_owned()),
        });
    };
    let kind = KINDS.iter().find(|(kind, _)| *kind == set.kind);
    if kind.is_none() && !set.kind.is_empty() {
        fault(
            "kind",
            format!("no measurement is of kind '{}'", set.kind),
            "kinds are axis, bar, grid, distance",
        );
    } else if set.axis_numbers().is_none() && !set.axes.is_empty() {
        let message = format!("axes of a set of kind '{}' are '{}'", set.kind, set.axes);
        fault(
            "axes",
            message,
            "write x, y or z for kind axis; xy, xz or yz for the others",
        );
    }
    if set.kind == "bar" && set.radius_mm == 0.0 {
        fault(
            "radius_mm",
            "radius_mm is missing from a set of kind 'bar'".to_owned(),
            "give the nominal radius",
        );
    }
    let width = kind.map_or(3, |(_, width)| *width);
    set.rows = table.rows("rows", width, faults);
    if set.rows.is_empty() && faults.len() == before {
        let message = "rows are missing from a measurement".to_owned();
        faults.push(Fault {
            at: table.header(),
            label: "here",
            message,
            hint: None,
        });
    }
    table.finish(faults);
    set
}
