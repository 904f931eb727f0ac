//! Rows of a measurement as linear equations of the geometry.
//!
//! A row is a deviation in um that is linear in the errors of the geometry, at one place or as the
//! difference of two:
//!
//! | Kind | Row | Deviation | Nuisances |
//! |---|---|---|---|
//! | `axis` | position (mm), direction, deviation | tool beyond the target, along the axis | offset |
//! | `bar` | angle (degrees), direction (1 counterclockwise), deviation | radius longer than nominal | center (2), servo mismatch, radius |
//! | `grid` | two positions (mm), two directions, two deviations | tool beyond the command, in each axis | offsets (2), rotation |
//! | `distance` | two points (mm, mm), factor of the size, deviation | distance longer than nominal | size of the tool |
//!
//! The radius of a bar and the size of a tool are nuisances unless the set is calibrated. The servo
//! mismatch of a bar is proportional to the direction times sin(2 angle): the axes lag by different
//! times. Source: ISO 230-4 (2022); Kakino, Ihara, Nakatsu (1987), The measurement of motion errors
//! of NC machine tools by a double ball bar.

use super::GeometryFile;
use crate::machine::AXIS_NAMES;

/// Most nuisances of a set.
pub const NUISANCES: usize = 4;

/// Kinds of sets: name, and numbers in a row.
pub(super) const KINDS: [(&str, usize); 4] =
    [("axis", 3), ("bar", 3), ("grid", 6), ("distance", 6)];

/// Values that were measured in one setup.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MeasuredSet {
    /// Name of its table.
    pub name: String,
    /// `axis`, `bar`, `grid` or `distance`.
    pub kind: String,
    /// Axes that it is about: `x`, or a plane such as `xy`.
    pub axes: String,
    /// File that it comes from; may be empty.
    pub source: String,
    /// Date of the measurement; may be empty.
    pub date: String,
    /// True if the length of the bar, or the size of the tool, is known.
    pub calibrated: bool,
    /// Machine position of the center of a bar or of the origin of the points; of axes that are not
    /// in `axes`, where they stand.
    pub x_mm: f64,
    /// The same of y.
    pub y_mm: f64,
    /// The same of z.
    pub z_mm: f64,
    /// Radius of a bar.
    pub radius_mm: f64,
    /// Standard deviation of a deviation.
    pub noise_um: f64,
    /// Root mean square of what the fit left.
    pub left_um: f64,
    /// The rows; docs/geometry-file.md has the numbers of each kind.
    pub rows: Vec<Vec<f64>>,
}

/// A place of the encoders, directions of travel there, and the direction that is measured along.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct MeasuredPlace {
    /// Encoder positions, mm.
    pub at_mm: [f64; 3],
    /// Directions of travel.
    pub(crate) direction: [f64; 3],
    /// Unit vector, or zero.
    pub along: [f64; 3],
}

/// A measured deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Observation {
    /// Places whose errors it is the sum of.
    pub places: [MeasuredPlace; 2],
    /// The deviation, um.
    pub deviation_um: f64,
    /// Its derivatives by the nuisances of its set.
    pub nuisance: [f64; NUISANCES],
}

impl Observation {
    /// The deviation by a geometry, um.
    pub fn predicted_um(&self, geometry: &GeometryFile) -> f64 {
        let along = |place: &MeasuredPlace| -> f64 {
            let error_um = geometry.error_um(place.at_mm, place.direction);
            error_um
                .iter()
                .zip(place.along)
                .map(|(error, along)| error * along)
                .sum()
        };
        self.places.iter().map(along).sum()
    }
}

impl MeasuredSet {
    /// Numbers of its axes; `None` where `axes` names none, one twice, or more than `kind` has.
    pub fn axis_numbers(&self) -> Option<Vec<usize>> {
        let number = |name: char| AXIS_NAMES.iter().position(|axis| axis.starts_with(name));
        let axes: Vec<usize> = self.axes.chars().map(number).collect::<Option<_>>()?;
        let count = if self.kind == "axis" { 1 } else { 2 };
        (axes.len() == count && axes.windows(2).all(|pair| pair[0] < pair[1])).then_some(axes)
    }

    /// Every row as observations; none where kind or axes are unknown.
    pub fn observations(&self) -> Vec<Observation> {
        let Some(axes) = self.axis_numbers() else {
            return Vec::new();
        };
        let second = axes.get(1).copied().unwrap_or(axes[0]);
        let seen = |row: &Vec<f64>| match (self.kind.as_str(), row.as_slice()) {
            ("axis", &[at_mm, direction, deviation_um]) => {
                vec![self.on_axis(axes[0], [at_mm, direction, deviation_um])]
            }
            ("bar", &[angle_deg, direction, deviation_um]) => {
                vec![self.on_bar([axes[0], second], [angle_deg, direction, deviation_um])]
            }
            ("grid", &[a_mm, b_mm, a_way, b_way, a_um, b_um]) => self
                .on_grid(
                    [axes[0], second],
                    [a_mm, b_mm],
                    [a_way, b_way],
                    [a_um, b_um],
                )
                .to_vec(),
            ("distance", &[a1, b1, a2, b2, size, deviation_um]) => {
                vec![self.between(
                    [axes[0], second],
                    [[a1, b1], [a2, b2]],
                    [size, deviation_um],
                )]
            }
            _ => Vec::new(),
        };
        self.rows.iter().flat_map(seen).collect()
    }

    fn origin_mm(&self) -> [f64; 3] {
        [self.x_mm, self.y_mm, self.z_mm]
    }

    fn on_axis(&self, axis: usize, [at_mm, direction, deviation_um]: [f64; 3]) -> Observation {
        let mut place = MeasuredPlace {
            at_mm: self.origin_mm(),
            ..MeasuredPlace::default()
        };
        (place.at_mm[axis], place.direction[axis], place.along[axis]) = (at_mm, direction, 1.0);
        Observation {
            places: [place, MeasuredPlace::default()],
            deviation_um,
            nuisance: [1.0, 0.0, 0.0, 0.0],
        }
    }

    fn on_bar(&self, [a, b]: [usize; 2], [angle_deg, way, deviation_um]: [f64; 3]) -> Observation {
        let (sin, cos) = libm::sincos(angle_deg.to_radians());
        let mut place = MeasuredPlace {
            at_mm: self.origin_mm(),
            ..MeasuredPlace::default()
        };
        (place.along[a], place.along[b]) = (cos, sin);
        place.at_mm[a] += self.radius_mm * cos;
        place.at_mm[b] += self.radius_mm * sin;
        (place.direction[a], place.direction[b]) = (sign(-way * sin), sign(way * cos));
        let radius = if self.calibrated { 0.0 } else { 1.0 };
        Observation {
            places: [place, MeasuredPlace::default()],
            deviation_um,
            nuisance: [cos, sin, way * 2.0 * sin * cos, radius],
        }
    }

    fn on_grid(
        &self,
        axes: [usize; 2],
        at_mm: [f64; 2],
        ways: [f64; 2],
        seen_um: [f64; 2],
    ) -> [Observation; 2] {
        let mut place = MeasuredPlace {
            at_mm: self.origin_mm(),
            ..MeasuredPlace::default()
        };
        for ((axis, at_mm), way) in axes.into_iter().zip(at_mm).zip(ways) {
            (place.at_mm[axis], place.direction[axis]) = (place.at_mm[axis] + at_mm, way);
        }
        [0, 1].map(|i| {
            let mut along = [0.0; 3];
            along[axes[i]] = 1.0;
            let turned = if i == 0 { -at_mm[1] } else { at_mm[0] };
            let mut nuisance = [0.0, 0.0, 1e-3 * turned, 0.0];
            nuisance[i] = 1.0;
            let places = [MeasuredPlace { along, ..place }, MeasuredPlace::default()];
            Observation {
                places,
                deviation_um: seen_um[i],
                nuisance,
            }
        })
    }

    fn between(
        &self,
        [a, b]: [usize; 2],
        ends: [[f64; 2]; 2],
        [size, deviation_um]: [f64; 2],
    ) -> Observation {
        let [from, to] = ends;
        let (along_a, along_b) = (to[0] - from[0], to[1] - from[1]);
        let length_mm = libm::hypot(along_a, along_b).max(f64::MIN_POSITIVE);
        let place = |end: [f64; 2], sign: f64| {
            let mut place = MeasuredPlace {
                at_mm: self.origin_mm(),
                ..MeasuredPlace::default()
            };
            (place.along[a], place.along[b]) =
                (sign * along_a / length_mm, sign * along_b / length_mm);
            place.at_mm[a] += end[0];
            place.at_mm[b] += end[1];
            place
        };
        let size = if self.calibrated { 0.0 } else { size };
        Observation {
            places: [place(from, -1.0), place(to, 1.0)],
            deviation_um,
            nuisance: [size, 0.0, 0.0, 0.0],
        }
    }
}

/// 1, -1, or 0 so near to a reversal that the direction is not known.
fn sign(speed: f64) -> f64 {
    if speed.abs() < 1e-9 {
        0.0
    } else {
        speed.signum()
    }
}
