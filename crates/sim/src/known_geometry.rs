//! Known geometry of a machine, for a control that compensates it: from the machine file or from a
//! geometry file.
//!
//! The uncertainty of the tool position follows from the standard deviations in the geometry file
//! by linear propagation. With g_k the change of the tool position by one standard deviation of
//! value k, and n the plane normal to the direction of travel:
//!
//! ```text
//! sigma^2 = sum over k of |g_k in n|^2
//! ```
//!
//! The values are treated as independent of each other. Source: JCGM 100 (2008), Guide to the
//! expression of uncertainty in measurement, eq. 10.

use std::f64::consts::TAU;
use std::sync::Arc;

use feedwright_control::{
    AxisErrors, ErrorTable, GeometryFault, KnownGeometry, MOST_SLOPE, TABLE_POINTS,
};
use feedwright_plan::vector::Vector;
use thiserror::Error;

use crate::geometry_file::{AxisGeometry, GeometryFile};
use crate::machine::{AXIS_NAMES, Machine};
use crate::number::to_four_digits;

/// Largest relative difference of two leads that count as equal: files state them with few digits.
const SAME_LEAD: f64 = 1e-6;
/// Distance that a part may extend beyond the measured travel, mm. Within it, the errors at the end
/// of the measured travel hold up to the change that scale and pitch state.
const BEYOND_MM: f64 = 1.0;

/// Why a geometry cannot be compensated.
#[derive(Debug, Clone, PartialEq, Error, miette::Diagnostic)]
pub enum CompensationError {
    /// A value is out of its range.
    #[error("the geometry cannot be compensated: {0}")]
    #[diagnostic(help("correct the geometry, or leave the compensation out with --no-geometry"))]
    Range(String),
    /// The geometry states another screw lead than the machine.
    #[error(
        "axis {axis}: the pitch error repeats every {lead_mm} mm, and lead_mm_per_rev of the machine is {machine_mm} mm; they must be equal"
    )]
    #[diagnostic(help(
        "use the geometry of this machine, or correct lead_mm_per_rev in the machine file"
    ))]
    Lead {
        /// The axis.
        axis: &'static str,
        /// Lead of the geometry, mm.
        lead_mm: f64,
        /// Lead of the machine, mm.
        machine_mm: f64,
    },
    /// The part is outside of what was measured.
    #[error(
        "axis {axis}: the part reaches {at_mm} mm, and the geometry was measured from {from_mm} to {to_mm} mm"
    )]
    #[diagnostic(help(
        "measure the whole travel. Where the errors go on alike beyond it, widen from_mm and to_mm in the geometry file"
    ))]
    Travel {
        /// The axis.
        axis: &'static str,
        /// Farthest position of the part, mm, to 0.001.
        at_mm: f64,
        /// Least position that was measured, mm.
        from_mm: f64,
        /// Greatest, mm.
        to_mm: f64,
    },
}

impl From<GeometryFault> for CompensationError {
    fn from(fault: GeometryFault) -> Self {
        Self::Range(match fault {
            GeometryFault::NotFinite => "a value is not a finite number".to_owned(),
            GeometryFault::Points(points) => {
                format!("a table has {points} points; it must have 2 to {TABLE_POINTS}")
            }
            GeometryFault::Order(point) => {
                format!(
                    "the position of point {} of a table is not beyond the point before",
                    point + 1
                )
            }
            GeometryFault::Slope { axis, slope } => format!(
                "the errors of axis {} grow by up to {} % of the travel; at most {} % are allowed",
                AXIS_NAMES.get(axis).unwrap_or(&"?"),
                to_four_digits(100.0 * slope),
                100.0 * MOST_SLOPE
            ),
        })
    }
}

impl Machine {
    /// Returns the errors of the first N axes that no encoder sees; `None` if the machine has no
    /// such error.
    pub fn errors_of_geometry<const N: usize>(&self) -> Option<KnownGeometry<N>> {
        if let Some(tool) = &self.tool {
            return Some(tool.of_first()).filter(|tool| !tool.is_exact());
        }
        let axes = std::array::from_fn(|i| {
            let axis = self.axis(i);
            AxisErrors {
                scale: axis.scale_um_m * 1e-6,
                pitch_mm: axis.pitch_error_um * 1e-3,
                pitch_rad_per_mm: axis.rad_per_mm(),
                ..AxisErrors::default()
            }
        });
        let square = self.geometry;
        let urad = [
            square.squareness_xy_urad,
            square.squareness_xz_urad,
            square.squareness_yz_urad,
        ];
        let geometry = KnownGeometry::new(axes, urad.map(|urad| urad * 1e-6));
        (!geometry.is_exact()).then_some(geometry)
    }

    /// The same machine with a control that compensates this geometry, whatever the errors of the
    /// machine are. The windup of its screws is part of the lost motion, and is not in `known`.
    ///
    /// # Errors
    /// A geometry that is out of its range.
    pub fn compensating(&self, known: KnownGeometry<3>) -> Result<Self, CompensationError> {
        known.check()?;
        let backlash_mm = known.backlash_mm();
        let lost_mm = [0, 1, 2].map(|i| backlash_mm[i] + self.axis(i).hidden_windup_mm());
        Ok(Self {
            compensated: Some(Arc::new(known.with_backlash(lost_mm))),
            ..self.clone()
        })
    }

    /// The same machine with a control that compensates what the machine file says of its geometry.
    /// Where an axis has backlash that its encoder does not see, this is the lost motion alone: a
    /// table behind a gap does not follow the small steps that the rest asks for.
    ///
    /// # Errors
    /// As [`Machine::compensating`].
    pub fn compensating_own(&self) -> Result<Self, CompensationError> {
        let backlash_mm = [0, 1, 2].map(|i| self.axis(i).hidden_backlash_mm());
        let exact = KnownGeometry::new([AxisErrors::default(); 3], [0.0; 3]);
        if self.has_hidden_backlash() {
            return self.compensating(exact.with_backlash(backlash_mm));
        }
        match self.errors_of_geometry() {
            Some(known) => self.compensating(known),
            None => Ok(Self {
                compensated: None,
                ..self.clone()
            }),
        }
    }

    /// Returns the same machine with the tool where a geometry puts it, whatever its file states. A
    /// screw gets the backlash that the geometry states; if the geometry states no backlash, the
    /// screw keeps its own.
    #[must_use]
    pub fn with_tool(mut self, known: KnownGeometry<3>) -> Self {
        for (axis, backlash_mm) in self.axes.iter_mut().zip(known.backlash_mm()) {
            let is_hidden = axis.hidden_screw().is_some();
            if let Some(screw) = axis
                .transmission
                .as_mut()
                .filter(|_| is_hidden && backlash_mm != 0.0)
            {
                screw.backlash_um = 1e3 * backlash_mm;
            }
        }
        self.tool = Some(Arc::new(known));
        self
    }

    /// Returns true if an axis has backlash that its encoder does not see.
    pub fn has_hidden_backlash(&self) -> bool {
        self.axes.iter().any(|axis| axis.hidden_backlash_mm() > 0.0)
    }
}

/// Returns the mean lag of the tool in forward travel against backward travel over a table of both,
/// um.
fn mean_reversal_um(table: &[[f64; 3]]) -> f64 {
    let sum_um: f64 = table
        .iter()
        .map(|[_, forward_um, backward_um]| backward_um - forward_um)
        .sum();
    sum_um / table.len().max(1) as f64
}

impl GeometryFile {
    /// The geometry to compensate; of a table, the mean of both directions, and their mean
    /// difference as backlash.
    ///
    /// # Errors
    /// A geometry that is out of its range.
    pub fn known(&self) -> Result<KnownGeometry<3>, CompensationError> {
        let errors = |axis: &AxisGeometry| AxisErrors {
            scale: axis.scale_um_m * 1e-6,
            pitch_mm: axis.pitch_error_um * 1e-3,
            pitch_rad_per_mm: if axis.lead_mm_per_rev > 0.0 {
                TAU / axis.lead_mm_per_rev
            } else {
                0.0
            },
            pitch_phase_rad: axis.pitch_phase_deg.to_radians(),
            backlash_mm: 1e-3 * (axis.backlash_um + mean_reversal_um(&axis.table)),
        };
        let square = self.squareness;
        let urad = [
            square.squareness_xy_urad,
            square.squareness_xz_urad,
            square.squareness_yz_urad,
        ];
        let mut known = KnownGeometry::new(
            [0, 1, 2].map(|i| errors(&self.axes[i])),
            urad.map(|urad| urad * 1e-6),
        );
        for (over, axis) in self.axes.iter().enumerate() {
            if !axis.table.is_empty() {
                let mean = |&[at_mm, forward_um, backward_um]: &[f64; 3]| {
                    [at_mm, 0.5e-3 * (forward_um + backward_um)]
                };
                known = known.with_table(over, over, ErrorTable::new(axis.table.iter().map(mean))?);
            }
            for (of, straightness) in axis
                .straightness
                .iter()
                .enumerate()
                .filter(|(_, table)| !table.is_empty())
            {
                let in_mm = |&[at_mm, error_um]: &[f64; 2]| [at_mm, 1e-3 * error_um];
                known =
                    known.with_table(of, over, ErrorTable::new(straightness.iter().map(in_mm))?);
            }
        }
        known.check()?;
        Ok(known)
    }

    /// Checks that the screw leads of the geometry match the leads of this machine.
    ///
    /// # Errors
    /// Fails if the lead of a screw differs.
    pub fn suits(&self, machine: &Machine) -> Result<(), CompensationError> {
        for (i, (geometry, axis)) in self
            .axes
            .iter()
            .zip(AXIS_NAMES)
            .enumerate()
            .take(machine.axis_count())
        {
            let machine_mm = machine.axis(i).lead_mm_per_rev;
            let lead_mm = geometry.lead_mm_per_rev;
            if geometry.pitch_error_um != 0.0 && (lead_mm / machine_mm - 1.0).abs() > SAME_LEAD {
                return Err(CompensationError::Lead {
                    axis,
                    lead_mm,
                    machine_mm,
                });
            }
        }
        Ok(())
    }

    /// Checks that the measured travel covers a part that uses this many axes and spans these least
    /// and greatest positions, mm.
    ///
    /// # Errors
    /// Fails if the part extends beyond the measured travel.
    pub fn covers(
        &self,
        axes: usize,
        [least_mm, most_mm]: [Vector; 2],
    ) -> Result<(), CompensationError> {
        for (i, (geometry, axis)) in self.axes.iter().zip(AXIS_NAMES).enumerate().take(axes) {
            let AxisGeometry { from_mm, to_mm, .. } = *geometry;
            let beyond = |at_mm: &f64| *at_mm < from_mm - BEYOND_MM || *at_mm > to_mm + BEYOND_MM;
            if let Some(at_mm) = [least_mm[i], most_mm[i]]
                .into_iter()
                .find(|at_mm| to_mm > from_mm && beyond(at_mm))
            {
                let at_mm = libm::round(at_mm * 1e3) / 1e3;
                return Err(CompensationError::Travel {
                    axis,
                    at_mm,
                    from_mm,
                    to_mm,
                });
            }
        }
        Ok(())
    }

    /// Standard deviation across the direction of travel of the tool that is at a place, um; 0
    /// where the file states none.
    pub fn spread_um(&self, at_mm: Vector, tangent: Vector) -> f64 {
        let across = |i: usize, um: f64| um * um * (1.0 - tangent[i] * tangent[i]).max(0.0);
        let mut sum_um2 = 0.0;
        for (i, axis) in self.axes.iter().enumerate() {
            let phase_rad = if axis.lead_mm_per_rev > 0.0 {
                TAU * at_mm[i] / axis.lead_mm_per_rev
            } else {
                0.0
            };
            let (sin, cos) = libm::sincos(phase_rad + axis.pitch_phase_deg.to_radians());
            let own = [
                1e-3 * axis.scale_std_um_m * at_mm[i],
                axis.pitch_error_std_um * sin,
                axis.pitch_error_um * axis.pitch_phase_std_deg.to_radians() * cos,
                // The mean of both directions.
                if axis.table.is_empty() {
                    0.0
                } else {
                    axis.table_std_um / std::f64::consts::SQRT_2
                },
            ];
            sum_um2 += own.iter().map(|&um| across(i, um)).sum::<f64>();
            let straight = axis
                .straightness
                .iter()
                .enumerate()
                .filter(|(_, table)| !table.is_empty());
            sum_um2 += straight
                .map(|(of, _)| across(of, axis.straightness_std_um))
                .sum::<f64>();
        }
        let square = self.squareness;
        let [_, y_mm, z_mm] = at_mm;
        sum_um2 += across(0, 1e-3 * square.squareness_xy_std_urad * y_mm);
        sum_um2 += across(0, 1e-3 * square.squareness_xz_std_urad * z_mm);
        sum_um2 += across(1, 1e-3 * square.squareness_yz_std_urad * z_mm);
        sum_um2.sqrt()
    }

    /// Returns true if the file states any standard deviation.
    pub fn states_spread(&self) -> bool {
        let places = [[1e3, 2e3, 3e3], [1.0, 1.0, 1.0]];
        places.iter().any(|&at_mm| {
            (0..3).any(|i| {
                self.spread_um(at_mm, std::array::from_fn(|k| f64::from(u8::from(k == i)))) > 0.0
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> GeometryFile {
        let mut file = GeometryFile::default();
        file.axes[0] = AxisGeometry {
            scale_um_m: 20.0,
            scale_std_um_m: 3.0,
            pitch_error_um: 2.0,
            pitch_error_std_um: 0.1,
            pitch_phase_deg: 30.0,
            lead_mm_per_rev: 10.0,
            from_mm: -50.0,
            to_mm: 300.0,
            table: vec![[0.0, 1.0, 3.0], [300.0, -1.0, 1.0]],
            ..AxisGeometry::default()
        };
        file.axes[1].straightness[0] = vec![[0.0, 0.0], [100.0, 4.0]];
        file.squareness.squareness_xy_urad = 25.0;
        file.squareness.squareness_xy_std_urad = 4.0;
        file
    }

    /// The file's own error without a direction is the mean of both.
    #[test]
    fn what_is_compensated_is_what_the_file_states() {
        let file = file();
        let known = file.known().unwrap();
        for at_mm in [
            [0.0; 3],
            [123.4, 50.0, 7.0],
            [-40.0, 100.0, -20.0],
            [300.0, 0.0, 0.0],
        ] {
            let stated_um = file.error_um(at_mm, [0.0; 3]);
            let tool_mm = known.tool_mm(at_mm);
            for i in 0..3 {
                assert!(
                    (1e3 * (tool_mm[i] - at_mm[i]) - stated_um[i]).abs() < 1e-9,
                    "{at_mm:?}: {tool_mm:?} {stated_um:?}"
                );
            }
        }
    }

    #[test]
    fn another_lead_and_another_travel_are_refused() {
        let machine = Machine::load("workshop".as_ref()).unwrap();
        let part = |most_mm: f64| [[0.0; 3], [most_mm, 0.0, 0.0]];
        assert_eq!(file().covers(3, part(300.0)), Ok(()));
        let text = file().covers(3, part(302.5)).unwrap_err().to_string();
        assert_eq!(
            text,
            "axis x: the part reaches 302.5 mm, and the geometry was measured from -50 to 300 mm"
        );
        let mut other = file();
        other.axes[0].lead_mm_per_rev = 5.0;
        let text = other.suits(&machine).unwrap_err().to_string();
        assert!(
            text.starts_with("axis x: the pitch error repeats every 5 mm"),
            "{text}"
        );
    }

    /// Checks x 100 and y 50 mm: scale 0.3 um, squareness 0.2 um in x, and pitch 0.05 um.
    #[test]
    fn the_spread_is_taken_from_the_values_across_the_path() {
        let file = file();
        assert!(file.states_spread() && !GeometryFile::default().states_spread());
        let at_mm = [100.0, 50.0, 0.0];
        let across = file.spread_um(at_mm, [0.0, 1.0, 0.0]);
        assert!(
            (across - f64::sqrt(0.09 + 0.04 + 0.0025)).abs() < 1e-12,
            "{across}"
        );
        assert_eq!(file.spread_um(at_mm, [1.0, 0.0, 0.0]), 0.0);
    }

    #[test]
    fn a_geometry_without_a_valid_inverse_is_reported_with_its_limit() {
        let mut steep = Machine::load("workshop".as_ref()).unwrap();
        // 2 pi 0.1 / 10, and 15e-6 each of scale and squareness.
        steep.axes[1].pitch_error_um = 100.0;
        let text = steep.compensating_own().unwrap_err().to_string();
        assert_eq!(
            text,
            "the geometry cannot be compensated: the errors of axis y grow by up to 6.286 % of the travel; at most 5 % are allowed"
        );
    }
}
