//! Geometry files: axis errors that no encoder sees, as measured, together with the measurement.
//!
//! Position of the tool while the encoders are at q; d_i is the direction of travel of axis i, 1 or
//! -1, and 0 where it is unknown:
//!
//! ```text
//! t_i = q_i + e_i q_i + p_i sin(2 pi q_i / lead_i + phase_i) + T_i(q_i, d_i) - d_i b_i / 2 + sum over j of S_ij(q_j)
//! x = t_x + a_xy q_y + a_xz q_z,   y = t_y + a_yz q_z,   z = t_z
//! ```
//!
//! with scale e, pitch error p, table T (linear between its positions, constant beyond them),
//! backlash b, straightness S_ij of axis j in direction i, and squareness a. The signs are those of
//! machine files. Source: ISO 230-1 (2012), ISO 230-2 (2014).
//!
//! | File | What |
//! |---|---|
//! | `geometry_file/least_squares.rs` | weighted least squares with a rank test, and the F distribution |
//! | `geometry_file/observation.rs` | what each row of a measurement says about the geometry |
//! | `geometry_file/keys.rs` | keys of the file |
//! | `geometry_file/check.rs` | tests a geometry against its own measurement |
//! | `geometry_file/layout.rs` | reads the file |

pub(crate) mod least_squares;
pub(crate) mod observation;
pub(crate) mod keys;
pub(crate) mod check;
mod layout;

use std::f64::consts::TAU;
use std::path::Path;

use feedwright_gcode::input;

use crate::machine::AXIS_NAMES;
use crate::toml_file::key::{write, write_rows};
use crate::toml_file::{self, FileError, Kind, read_text};
use observation::MeasuredSet;

/// The format of geometry files that is read and written.
pub(crate) const GEOMETRY_FORMAT: u64 = 1;

/// A geometry file, for messages.
const FILE_KIND: Kind = Kind {
    name: "geometry file",
    is: "a geometry file is TOML text, as 'feedwright identify --geometry' writes it",
    code: "geometry::file",
    where_to_find: "'feedwright identify --geometry MEASUREMENT --machine MACHINE --out FILE.toml' writes one",
};

/// A geometry and the measurement behind it. A standard deviation of 0 means that the file states
/// none.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GeometryFile {
    /// Origin of the geometry.
    pub origin: GeometryOrigin,
    /// X, y and z; an axis that was not measured is all zero.
    pub axes: [AxisGeometry; 3],
    /// Angles between the axes.
    pub squareness: MeasuredSquareness,
    /// Measured sets that the values were fitted to.
    pub measured: Vec<MeasuredSet>,
    /// Parameters that were fitted to the measurement, nuisances such as the center of a ball bar
    /// included.
    pub unknowns: u64,
}

/// Origin of a geometry.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct GeometryOrigin {
    /// Version of feedwright that wrote the file; may be empty.
    pub written_by: String,
    /// Files that the geometry was computed from, or the name of whoever measured.
    pub source: String,
    /// Date of the measurement, as year-month-day; may be empty.
    pub date: String,
}

/// Errors of an axis.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct AxisGeometry {
    /// Scale error: travel of the tool minus travel of the encoder, um per meter.
    pub scale_um_m: f64,
    /// Its standard deviation.
    pub scale_std_um_m: f64,
    /// Amplitude of the error within a turn of the screw.
    pub pitch_error_um: f64,
    /// Its standard deviation.
    pub pitch_error_std_um: f64,
    /// Phase of this error at position 0.
    pub pitch_phase_deg: f64,
    /// Its standard deviation.
    pub pitch_phase_std_deg: f64,
    /// Travel of a turn of the screw; 0 without pitch error.
    pub lead_mm_per_rev: f64,
    /// Lost motion at a reversal: the tool is half of it behind the encoder in either direction.
    pub backlash_um: f64,
    /// Its standard deviation.
    pub backlash_std_um: f64,
    /// Least position that was measured, mm.
    pub from_mm: f64,
    /// Greatest position that was measured, mm; not above the least where this is not known.
    pub to_mm: f64,
    /// Further error: position (mm), and error in forward and in backward travel (um); positions
    /// rise.
    pub table: Vec<[f64; 3]>,
    /// Standard deviation of a value of the table, um.
    pub table_std_um: f64,
    /// Error in direction x, y and z over the position of this axis: position (mm) and error (um).
    /// Its own direction is empty.
    pub straightness: [Vec<[f64; 2]>; 3],
    /// Standard deviation of a value of straightness, um.
    pub straightness_std_um: f64,
}

/// Angles between the axes; positive where the angle between the positive directions is less than
/// 90 degrees.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MeasuredSquareness {
    /// Squareness of y to x.
    pub squareness_xy_urad: f64,
    /// Its standard deviation.
    pub squareness_xy_std_urad: f64,
    /// Squareness of z to x.
    pub squareness_xz_urad: f64,
    /// Its standard deviation.
    pub squareness_xz_std_urad: f64,
    /// Squareness of z to y.
    pub squareness_yz_urad: f64,
    /// Its standard deviation.
    pub squareness_yz_std_urad: f64,
}

/// Value of a function that is linear between its points and constant beyond them; 0 without
/// points.
fn interpolated(points: usize, at_mm: f64, point: impl Fn(usize) -> [f64; 2]) -> f64 {
    let Some(last) = points.checked_sub(1) else {
        return 0.0;
    };
    let above = (0..points).find(|&i| point(i)[0] > at_mm).unwrap_or(last);
    let ([x0, y0], [x1, y1]) = (point(above.saturating_sub(1)), point(above));
    let part = if x1 > x0 {
        ((at_mm - x0) / (x1 - x0)).clamp(0.0, 1.0)
    } else {
        0.0
    };
    y0 + part * (y1 - y0)
}

impl AxisGeometry {
    /// Error of this axis in its own direction, um.
    fn own_um(&self, at_mm: f64, direction: f64) -> f64 {
        let scale_um = 1e-3 * self.scale_um_m * at_mm;
        let pitch_um = if self.lead_mm_per_rev > 0.0 {
            self.pitch_error_um
                * libm::sin(TAU * at_mm / self.lead_mm_per_rev + self.pitch_phase_deg.to_radians())
        } else {
            0.0
        };
        let column = |column: usize| {
            interpolated(self.table.len(), at_mm, |i| {
                [self.table[i][0], self.table[i][column]]
            })
        };
        let [forward_um, backward_um] = [column(1), column(2)];
        let table_um = 0.5 * (forward_um * (1.0 + direction) + backward_um * (1.0 - direction));
        scale_um + pitch_um + table_um - 0.5 * direction * self.backlash_um
    }

    /// Returns true if no error of this axis is known.
    pub fn is_zero(&self) -> bool {
        let own = [self.scale_um_m, self.pitch_error_um, self.backlash_um]
            .iter()
            .all(|value| *value == 0.0);
        own && self.table.is_empty() && self.straightness.iter().all(Vec::is_empty)
    }
}

impl GeometryFile {
    /// Distance of the tool from where the encoders say it is, um: encoders at `at_mm`, axes that
    /// travel in `direction` (1, -1, or 0 where this is not known).
    pub fn error_um(&self, at_mm: [f64; 3], direction: [f64; 3]) -> [f64; 3] {
        let MeasuredSquareness {
            squareness_xy_urad: xy,
            squareness_xz_urad: xz,
            squareness_yz_urad: yz,
            ..
        } = self.squareness;
        let [_, y_mm, z_mm] = at_mm;
        let skew_um = [1e-3 * (xy * y_mm + xz * z_mm), 1e-3 * yz * z_mm, 0.0];
        std::array::from_fn(|i| {
            let across = self.axes.iter().zip(at_mm).map(|(axis, at_mm)| {
                let table = &axis.straightness[i];
                interpolated(table.len(), at_mm, |k| table[k])
            });
            self.axes[i].own_um(at_mm[i], direction[i]) + skew_um[i] + across.sum::<f64>()
        })
    }

    /// A geometry from a file.
    ///
    /// # Errors
    /// A file that cannot be read or is not text, and every fault found in its text.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        Self::parse(&input::name(path), &read_text(&FILE_KIND, path)?)
    }

    /// A geometry from the text of a geometry file; `file` is its name in messages.
    /// [`GeometryFile::check`] tests the values.
    ///
    /// # Errors
    /// Every fault found in the text, in one go.
    pub fn parse(file: &str, text: &str) -> Result<Self, FileError> {
        let invalid = |faults| FileError::invalid(&FILE_KIND, file, text, faults);
        let document = toml_file::document(text).map_err(invalid)?;
        layout::geometry(&document).map_err(invalid)
    }

    /// The text of a geometry file that reads as this geometry.
    pub fn text(&self) -> String {
        let mut text = format!(
            "format = {GEOMETRY_FORMAT}\n{}",
            write(keys::ORIGIN, &self.origin)
        );
        for (axis, name) in self.axes.iter().zip(AXIS_NAMES) {
            let mut lines = write(keys::AXIS, axis);
            lines += &write_rows("table", axis.table.iter().map(<[f64; 3]>::as_slice));
            for (straightness, key) in axis.straightness.iter().zip(layout::STRAIGHTNESS) {
                lines += &write_rows(key, straightness.iter().map(<[f64; 2]>::as_slice));
            }
            if !lines.is_empty() {
                text += &format!("\n[axis.{name}]\n{lines}");
            }
        }
        let squareness = write(keys::SQUARENESS, &self.squareness);
        if !squareness.is_empty() {
            text += &format!("\n[geometry]\n{squareness}");
        }
        if !self.measured.is_empty() {
            text += &format!("\n[measured]\nunknowns = {}\n", self.unknowns);
        }
        for set in &self.measured {
            let rows = write_rows("rows", set.rows.iter().map(Vec::as_slice));
            text += &format!(
                "\n[measured.set.{}]\n{}{rows}",
                toml_file::quoted(&set.name),
                write(keys::SET, set)
            );
        }
        text
    }
}

#[cfg(test)]
mod tests;
