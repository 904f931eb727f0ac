//! Kinematics: between the tool in space and the positions of the joints that servo loops move.
//!
//! Path, contour error and rows are of the tool in space, controllers and plant of N joints. Of a Cartesian machine the first N
//! coordinates are the joints; a machine whose third axis the program does not need stands still in it. This file is the one
//! place that knows: a rotary table or a robot puts its own transformation here.
//!
//! Joints are where their encoders say; guideways and screws are not as straight, square and even as that, and the tool is elsewhere:
//! see [`KnownGeometry`], and [`Machine::errors_of_geometry`] for what a machine file has of it.

use std::sync::Arc;

use feedwright_control::{AxisErrors, GeometryFault, KnownGeometry, MOST_SLOPE, TABLE_POINTS};
use feedwright_plan::vector::Vector;

use thiserror::Error;

use crate::machine::{AXIS_NAMES, Machine};
use crate::number::to_four_digits;

/// Why a geometry cannot be compensated.
#[derive(Debug, Clone, PartialEq, Error, miette::Diagnostic)]
#[error("the geometry cannot be compensated: {0}")]
#[diagnostic(help("correct the geometry, or leave its compensation out with --no-geometry"))]
pub struct CompensationError(pub String);

impl Machine {
    /// Errors of the first N axes that no encoder sees; none where there are none.
    pub fn errors_of_geometry<const N: usize>(&self) -> Option<KnownGeometry<N>> {
        let axes = std::array::from_fn(|i| {
            let axis = self.axis(i);
            AxisErrors {
                scale: axis.scale_um_m * 1e-6,
                pitch_mm: axis.pitch_error_um * 1e-3,
                pitch_rad_per_mm: axis.rad_per_mm(),
                pitch_phase_rad: 0.0,
            }
        });
        let square = self.geometry;
        let urad = [square.squareness_xy_urad, square.squareness_xz_urad, square.squareness_yz_urad];
        let geometry = KnownGeometry::new(axes, urad.map(|urad| urad * 1e-6));
        (!geometry.is_exact()).then_some(geometry)
    }

    /// The same machine with a control that compensates this geometry, whatever the errors of the machine are.
    ///
    /// # Errors
    /// A geometry that is out of its range.
    pub fn compensating(&self, known: KnownGeometry<3>) -> Result<Self, CompensationError> {
        known.check().map_err(|fault| CompensationError(in_words(fault)))?;
        Ok(Self { compensated: Some(Arc::new(known)), ..self.clone() })
    }

    /// The same machine with a control that compensates what the machine file says of its geometry.
    ///
    /// # Errors
    /// As [`Machine::compensating`].
    pub fn compensating_own(&self) -> Result<Self, CompensationError> {
        match self.errors_of_geometry() {
            Some(known) => self.compensating(known),
            None => Ok(Self { compensated: None, ..self.clone() }),
        }
    }
}

fn in_words(fault: GeometryFault) -> String {
    match fault {
        GeometryFault::NotFinite => "a value is not a finite number".to_owned(),
        GeometryFault::Points(points) => {
            format!("a table has {points} points; it must have 2 to {TABLE_POINTS}")
        }
        GeometryFault::Order(point) => {
            format!("the position of point {} of a table is not beyond that of the point before", point + 1)
        }
        GeometryFault::Slope { axis, slope } => format!(
            "the errors of axis {} grow by up to {} % of the travel; {} % are allowed",
            AXIS_NAMES.get(axis).unwrap_or(&"?"),
            to_four_digits(100.0 * slope),
            100.0 * MOST_SLOPE
        ),
    }
}

/// Positions of the joints that bring the tool to a place, mm; also of tangents and other differences.
#[inline]
pub fn joints_of<const N: usize>(tool: Vector) -> [f64; N] {
    std::array::from_fn(|joint| tool.get(joint).copied().unwrap_or(0.0))
}

/// Where the joints bring the tool, mm.
#[inline]
pub(crate) fn tool_of<const N: usize>(joints: [f64; N]) -> Vector {
    std::array::from_fn(|axis| joints.get(axis).copied().unwrap_or(0.0))
}
