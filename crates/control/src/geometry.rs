//! Geometry of a machine: the position of the tool for given joint positions of the encoders.
//!
//! ```text
//! t_i = q_i + E_i(q)
//! E_i = e_i q_i + p_i sin(k_i q_i + f_i) + sum_j T_ij(q_j) + skew_i     scale, pitch, tables, squareness
//! skew_x = a_xy q_y + a_xz q_z,   skew_y = a_yz q_z,   skew_z = 0
//! ```
//!
//! T_ii is a table of positioning errors, T_ij with j other than i a table of straightness. A table
//! is a cubic between its points with continuous slope and no overshoot. Beyond its ends the error
//! keeps the value of the end.
//!
//! The inverse is a fixed point, `q <- t - E(q)`. The sum of all derivatives of E in a row is at
//! most L, and [`KnownGeometry::check`] rejects an L above [`MOST_SLOPE`]. After n steps the
//! remaining error is therefore at most L^n |E| / (1 - L) in the largest coordinate. Tangents solve
//! `(I + dE/dq) u = t` by the same steps.
//!
//! Symbols: t tool and q joints in mm; e scale; p amplitude, k = 2 pi / period and f phase of the
//! pitch error; a squareness, rad.
//!
//! Source: ISO 230-1 (2012) for the errors and their names, ISO 230-2 (2014) for positioning
//! errors. Schwenke et al. (2008), "Geometric error measurement and compensation of machines", CIRP
//! Annals 57, for the position of the tool. Fritsch and Butland (1984), "A method for constructing
//! local monotone piecewise cubic interpolants", for the tables.

mod numbers;

use crate::vector::{bounded, norm, scale, sub};
use crate::window::Knot;

/// Largest number of points of a table: the limit of LinuxCNC for a compensation file.
pub const TABLE_POINTS: usize = 256;
/// Largest sum of the derivatives of the errors in a row. Machines have about 0.01 at worst: a
/// pitch error of 10 um over a lead of 8 mm. Above this limit a geometry is wrong, and its inverse
/// needs more steps.
pub const MOST_SLOPE: f64 = 0.05;
/// Largest number of steps of an inverse. With L at its limit, 2e-12 of the error remains.
const MOST_STEPS: u32 = 9;
/// Change in a step below which an inverse is found, mm or part of a direction. At most L / (1 - L)
/// of it remains as error.
const FOUND: f64 = 1e-12;

/// Geometric errors of one axis.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct AxisErrors {
    /// Relative scale error: the extra travel for the travel that the encoder reports.
    pub scale: f64,
    /// Amplitude of the pitch error, mm.
    pub pitch_mm: f64,
    /// Phase of the pitch error for a travel, rad/mm: 2 pi / lead.
    pub pitch_rad_per_mm: f64,
    /// Phase of the pitch error at position 0, rad.
    pub pitch_phase_rad: f64,
    /// Lost motion, mm: backlash and windup of the screw by friction. The tool lags by half of it
    /// in either direction. It depends on the direction, and is not part of the map.
    pub backlash_mm: f64,
}

/// Reason why a geometry is rejected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GeometryFault {
    /// A value is not a finite number.
    NotFinite,
    /// A table has more than [`TABLE_POINTS`] points, or less than two.
    Points(usize),
    /// Positions of a table do not increase after this point.
    Order(usize),
    /// Errors of this joint grow by more than [`MOST_SLOPE`] with the travel.
    Slope {
        /// The joint: 0 is x.
        axis: usize,
        /// Largest growth of the errors over the travel, mm/mm.
        slope: f64,
    },
}

/// Table of errors over the position of a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct ErrorTable {
    len: usize,
    at_mm: [f64; TABLE_POINTS],
    error_mm: [f64; TABLE_POINTS],
    slope: [f64; TABLE_POINTS],
}

impl ErrorTable {
    /// Creates a table from positions and errors, mm, by increasing position.
    ///
    /// # Errors
    /// Fails where the number of points is out of range, a position is out of order, or a number is
    /// not finite.
    pub fn new(points: impl IntoIterator<Item = [f64; 2]>) -> Result<Self, GeometryFault> {
        let mut table = Self {
            len: 0,
            at_mm: [0.0; TABLE_POINTS],
            error_mm: [0.0; TABLE_POINTS],
            slope: [0.0; TABLE_POINTS],
        };
        for [at_mm, error_mm] in points {
            if !(at_mm.is_finite() && error_mm.is_finite()) {
                return Err(GeometryFault::NotFinite);
            }
            if table.len > 0 && at_mm <= table.point(table.len - 1)[0] {
                return Err(GeometryFault::Order(table.len));
            }
            let (Some(at), Some(error)) = (
                table.at_mm.get_mut(table.len),
                table.error_mm.get_mut(table.len),
            ) else {
                return Err(GeometryFault::Points(table.len + 1));
            };
            (*at, *error) = (at_mm, error_mm);
            table.len += 1;
        }
        if table.len < 2 {
            return Err(GeometryFault::Points(table.len));
        }
        table.set_slopes();
        Ok(table)
    }

    /// Returns the first and the last position, mm.
    pub fn range_mm(&self) -> [f64; 2] {
        [
            self.at_mm[0],
            self.at_mm[self.len.saturating_sub(1).min(TABLE_POINTS - 1)],
        ]
    }

    /// Returns position, error and slope of the n-th point; zero if the table has no such point.
    fn point(&self, n: usize) -> [f64; 3] {
        match (self.at_mm.get(n), self.error_mm.get(n), self.slope.get(n)) {
            (Some(&at_mm), Some(&error_mm), Some(&slope)) => [at_mm, error_mm, slope],
            _ => [0.0; 3],
        }
    }

    /// Returns length and slope of the chord after the n-th point.
    fn chord(&self, n: usize) -> [f64; 2] {
        let ([from_mm, from_error_mm, _], [to_mm, to_error_mm, _]) =
            (self.point(n), self.point(n + 1));
        [
            to_mm - from_mm,
            (to_error_mm - from_error_mm) / (to_mm - from_mm),
        ]
    }

    /// Sets the slopes at the points: the slope of the chord at the ends, the weighted harmonic
    /// mean of the two chords within, and 0 at a turn.
    fn set_slopes(&mut self) {
        let last = self.len.saturating_sub(1);
        for n in 0..self.len {
            let ([h, before], [next_h, after]) = (self.chord(n.saturating_sub(1)), self.chord(n));
            let [w, next_w] = [2.0 * next_h + h, next_h + 2.0 * h];
            let within = if before * after > 0.0 {
                (w + next_w) / (w / before + next_w / after)
            } else {
                0.0
            };
            if let Some(slope) = self.slope.get_mut(n) {
                *slope = if n == 0 {
                    after
                } else if n == last {
                    before
                } else {
                    within
                };
            }
        }
    }

    /// Returns the error at a position, mm, and its derivative.
    fn at(&self, position_mm: f64) -> [f64; 2] {
        let held = self.at_mm.get(..self.len).unwrap_or(&self.at_mm);
        let after = held.partition_point(|&at_mm| at_mm <= position_mm);
        let [to_mm, to_error_mm, to_slope] = self.point(after.min(held.len().saturating_sub(1)));
        if after == 0 || after >= held.len() {
            return [to_error_mm, 0.0];
        }
        let [from_mm, from_error_mm, from_slope] = self.point(after - 1);
        let (h, rise_mm) = (to_mm - from_mm, to_error_mm - from_error_mm);
        let part = (position_mm - from_mm) / h;
        let rest = 1.0 - part;
        let error_mm = from_error_mm
            + part * part * (3.0 - 2.0 * part) * rise_mm
            + h * part * rest * (rest * from_slope - part * to_slope);
        let slope = 6.0 * part * rest * rise_mm / h
            + rest * (1.0 - 3.0 * part) * from_slope
            + part * (3.0 * part - 2.0) * to_slope;
        [error_mm, slope]
    }

    /// Returns a bound of the derivative: three times the steepest chord, which holds for every
    /// such cubic without overshoot.
    fn most_slope(&self) -> f64 {
        (1..self.len)
            .map(|n| 3.0 * self.chord(n - 1)[1].abs())
            .fold(0.0, f64::max)
    }
}

/// Errors of N axes that the encoders do not see.
#[derive(Debug, Clone, PartialEq)]
pub struct KnownGeometry<const N: usize> {
    axes: [AxisErrors; N],
    /// Squareness of y to x, z to x and z to y, rad: a_xy, a_xz, a_yz.
    squareness_rad: [f64; 3],
    /// Error of the i-th coordinate of the tool over the position of the j-th joint.
    tables: [[Option<ErrorTable>; N]; N],
}

impl<const N: usize> KnownGeometry<N> {
    /// Creates a geometry from the errors of the axes and the squareness of y to x, z to x and z to
    /// y, rad.
    pub fn new(axes: [AxisErrors; N], squareness_rad: [f64; 3]) -> Self {
        let tables = core::array::from_fn(|_| core::array::from_fn(|_| None));
        Self {
            axes,
            squareness_rad,
            tables,
        }
    }

    /// Adds a table of the errors of coordinate `of` over the position of joint `over`.
    #[must_use]
    pub fn with_table(mut self, of: usize, over: usize, table: ErrorTable) -> Self {
        if let Some(place) = self.tables.get_mut(of).and_then(|row| row.get_mut(over)) {
            *place = Some(table);
        }
        self
    }

    /// Returns the geometry of the first M axes. An axis that does not exist has no errors.
    pub fn of_first<const M: usize>(&self) -> KnownGeometry<M> {
        let table = |i: usize, j: usize| {
            self.tables
                .get(i)
                .and_then(|row| row.get(j))
                .cloned()
                .flatten()
        };
        KnownGeometry {
            axes: core::array::from_fn(|i| self.axes.get(i).copied().unwrap_or_default()),
            squareness_rad: self.squareness_rad,
            tables: core::array::from_fn(|i| core::array::from_fn(|j| table(i, j))),
        }
    }

    /// Checks that the geometry can be compensated: its inverse is then exact.
    ///
    /// # Errors
    /// Fails where a value is not finite, or where the errors grow too fast with the travel.
    pub fn check(&self) -> Result<(), GeometryFault> {
        for (axis, own) in self.axes.iter().enumerate() {
            let slope = self.most_slope(axis);
            if !slope.is_finite()
                || !own.pitch_phase_rad.is_finite()
                || !own.backlash_mm.is_finite()
            {
                return Err(GeometryFault::NotFinite);
            }
            if slope > MOST_SLOPE {
                return Err(GeometryFault::Slope { axis, slope });
            }
        }
        Ok(())
    }

    /// Returns a bound of the sum of the derivatives of an axis's errors.
    fn most_slope(&self, i: usize) -> f64 {
        let axis = self.axes[i];
        let of_tables: f64 = self.tables[i]
            .iter()
            .flatten()
            .map(ErrorTable::most_slope)
            .sum();
        let skew: f64 = self.skew(i, [1.0; N], f64::abs);
        axis.scale.abs() + (axis.pitch_mm * axis.pitch_rad_per_mm).abs() + of_tables + skew
    }

    /// Returns true if the geometry has no error at all.
    pub fn is_exact(&self) -> bool {
        let exact = |axis: &AxisErrors| {
            axis.scale == 0.0 && axis.pitch_mm == 0.0 && axis.backlash_mm == 0.0
        };
        self.axes.iter().all(exact)
            && self.squareness_rad == [0.0; 3]
            && self.tables.iter().flatten().all(Option::is_none)
    }

    /// Returns the lost motion of each axis, mm.
    pub fn backlash_mm(&self) -> [f64; N] {
        self.axes.map(|axis| axis.backlash_mm)
    }

    /// Sets the lost motion of each axis, mm.
    #[must_use]
    pub fn with_backlash(mut self, backlash_mm: [f64; N]) -> Self {
        for (axis, backlash_mm) in self.axes.iter_mut().zip(backlash_mm) {
            axis.backlash_mm = backlash_mm;
        }
        self
    }

    /// Returns the squareness error of a coordinate. `of` maps each angle before its use.
    fn skew(&self, i: usize, joints: [f64; N], of: impl Fn(f64) -> f64) -> f64 {
        let [xy, xz, yz] = self.squareness_rad;
        let joint = |j: usize| joints.get(j).copied().unwrap_or(0.0);
        match i {
            0 => of(xy) * joint(1) + of(xz) * joint(2),
            1 => of(yz) * joint(2),
            _ => 0.0,
        }
    }

    /// Returns the position of the tool, mm.
    pub fn tool_mm(&self, joints_mm: [f64; N]) -> [f64; N] {
        core::array::from_fn(|i| {
            let (
                AxisErrors {
                    scale,
                    pitch_mm,
                    pitch_rad_per_mm,
                    pitch_phase_rad,
                    ..
                },
                at_mm,
            ) = (self.axes[i], joints_mm[i]);
            let own_mm = at_mm
                + scale * at_mm
                + pitch_mm * libm::sin(pitch_rad_per_mm * at_mm + pitch_phase_rad);
            let tool_mm = own_mm + self.skew(i, joints_mm, |angle| angle);
            self.tables[i].iter().zip(joints_mm).fold(
                tool_mm,
                |tool_mm, (table, at_mm)| match table {
                    Some(table) => tool_mm + table.at(at_mm)[0],
                    None => tool_mm,
                },
            )
        })
    }

    /// Returns the extra motion of the tool when the joints move by `moved` from a place: dE/dq
    /// times `moved`.
    fn stretched(&self, joints_mm: [f64; N], moved: [f64; N]) -> [f64; N] {
        core::array::from_fn(|i| {
            let AxisErrors {
                scale,
                pitch_mm,
                pitch_rad_per_mm,
                pitch_phase_rad,
                ..
            } = self.axes[i];
            let phase_rad = pitch_rad_per_mm * joints_mm[i] + pitch_phase_rad;
            let own = (scale + pitch_mm * pitch_rad_per_mm * libm::cos(phase_rad)) * moved[i];
            let whole = own + self.skew(i, moved, |angle| angle);
            self.tables[i]
                .iter()
                .enumerate()
                .fold(whole, |sum, (j, table)| match table {
                    Some(table) => sum + table.at(joints_mm[j])[1] * moved[j],
                    None => sum,
                })
        })
    }

    /// Returns the motion of the tool when the joints move by `moved` from a place: Jacobian times
    /// `moved`.
    pub fn tool_moved(&self, joints_mm: [f64; N], moved: [f64; N]) -> [f64; N] {
        let stretched = self.stretched(joints_mm, moved);
        core::array::from_fn(|i| moved[i] + stretched[i])
    }

    /// Returns the joint positions that put the tool at a place, mm.
    pub fn joints_mm(&self, tool_mm: [f64; N]) -> [f64; N] {
        fixed_point(tool_mm, |joints_mm| sub(self.tool_mm(joints_mm), joints_mm))
    }

    /// Returns the motion of the joints that moves the tool by `moved` from a place: inverse
    /// Jacobian times `moved`.
    pub fn joints_moved(&self, joints_mm: [f64; N], moved: [f64; N]) -> [f64; N] {
        fixed_point(moved, |moved| self.stretched(joints_mm, moved))
    }

    /// Returns the knot of the joints for a knot of the tool.
    pub fn joint_knot(&self, tool: &Knot<N>) -> Knot<N> {
        let position_mm = self.joints_mm(tool.position_mm);
        let moved = self.joints_moved(position_mm, tool.tangent);
        let length = norm(moved);
        // Errors are small, so a direction nearly keeps its length. A vector without length, or
        // with NaN, stays as it is.
        let factor = bounded(length, 1.0 - 2.0 * MOST_SLOPE, 1.0 + 2.0 * MOST_SLOPE);
        Knot {
            position_mm,
            tangent: scale(1.0 / factor, moved),
            feed_mm_s: factor * tool.feed_mm_s,
            ..*tool
        }
    }
}

/// Returns the `q` with `q + error(q) = target`, for an error that contracts.
fn fixed_point<const N: usize>(target: [f64; N], error: impl Fn([f64; N]) -> [f64; N]) -> [f64; N] {
    let mut found = target;
    for _ in 0..MOST_STEPS {
        let next = sub(target, error(found));
        let change = sub(next, found)
            .into_iter()
            .fold(0.0, |most: f64, part| most.max(part.abs()));
        found = next;
        if change < FOUND {
            break;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::TAU;

    #[test]
    fn a_square_becomes_a_rhomb_and_a_metre_a_little_more() {
        let axes = [
            AxisErrors {
                scale: 20e-6,
                ..AxisErrors::default()
            },
            AxisErrors::default(),
            AxisErrors {
                pitch_mm: 0.003,
                pitch_rad_per_mm: TAU / 10.0,
                ..AxisErrors::default()
            },
        ];
        let geometry = KnownGeometry::new(axes, [50e-6, -30e-6, 10e-6]);
        let moved = |joints: [f64; 3]| sub(geometry.tool_mm(joints), joints);
        let near = |found: [f64; 3], wanted: [f64; 3]| {
            (0..3).all(|i| (found[i] - wanted[i]).abs() < 1e-12)
        };
        assert!(near(moved([1000.0, 0.0, 0.0]), [0.02, 0.0, 0.0]));
        assert!(near(moved([0.0, 100.0, 0.0]), [0.005, 0.0, 0.0]));
        assert!(near(moved([0.0, 0.0, 100.0]), [-0.003, 0.001, 0.0]));
        assert!(near(moved([0.0, 0.0, 2.5]), [-75e-6, 25e-6, 0.003]));
    }

    #[test]
    fn a_table_meets_its_points_does_not_overshoot_and_stays_beyond_its_ends() {
        let points = [
            [-10.0, 0.001],
            [0.0, 0.0],
            [5.0, 0.0],
            [20.0, 0.003],
            [40.0, -0.002],
        ];
        let table = ErrorTable::new(points).unwrap();
        for [at_mm, error_mm] in points {
            assert!((table.at(at_mm)[0] - error_mm).abs() < 1e-15);
        }
        for n in 0..100 {
            let at_mm = 0.05 * f64::from(n);
            assert_eq!(
                table.at(at_mm)[0],
                0.0,
                "flat between equal points: {at_mm}"
            );
        }
        assert_eq!(
            (table.at(-50.0), table.at(90.0)),
            ([0.001, 0.0], [-0.002, 0.0])
        );
    }

    #[test]
    fn what_is_no_geometry_is_refused() {
        assert_eq!(ErrorTable::new([[0.0, 0.0]]), Err(GeometryFault::Points(1)));
        assert_eq!(
            ErrorTable::new([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]]),
            Err(GeometryFault::Order(2))
        );
        assert_eq!(
            ErrorTable::new([[0.0, f64::NAN], [1.0, 0.0]]),
            Err(GeometryFault::NotFinite)
        );
        let many = (0..=TABLE_POINTS).map(|n| [n as f64, 0.0]);
        assert_eq!(
            ErrorTable::new(many),
            Err(GeometryFault::Points(TABLE_POINTS + 1))
        );
        let steep = AxisErrors {
            scale: 0.06,
            ..AxisErrors::default()
        };
        let found = KnownGeometry::new([AxisErrors::default(), steep], [0.0; 3]);
        assert_eq!(
            found.check(),
            Err(GeometryFault::Slope {
                axis: 1,
                slope: 0.06
            })
        );
        let unknown = AxisErrors {
            pitch_phase_rad: f64::NAN,
            ..AxisErrors::default()
        };
        assert_eq!(
            KnownGeometry::new([unknown; 2], [0.0; 3]).check(),
            Err(GeometryFault::NotFinite)
        );
        let table = ErrorTable::new([[0.0, 0.0], [1.0, 0.05]]).unwrap();
        let found = KnownGeometry::new([AxisErrors::default(); 2], [0.0; 3])
            .with_table(0, 1, table)
            .check();
        assert!(
            matches!(found, Err(GeometryFault::Slope { axis: 0, .. })),
            "{found:?}"
        );
    }
}
