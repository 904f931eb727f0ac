//! Kinematics: between the tool in space and the positions of the joints that servo loops move.
//!
//! Path, contour error and rows are of the tool in space, controllers and plant of N joints. Of a Cartesian machine the first N
//! coordinates are the joints; a machine whose third axis the program does not need stands still in it. This file is the one
//! place that knows: a rotary table or a robot puts its own transformation here.
//!
//! Joints are where their encoders say; guideways and screws are not as straight, square and even as that, and the tool is elsewhere:
//! see [`KnownGeometry`], and [`Machine::errors_of_geometry`] for what a machine file has of it.

use feedwright_control::{AxisGeometry, KnownGeometry};
use feedwright_plan::vector::Vector;

use crate::machine::Machine;

impl Machine {
    /// Errors of the first N axes that no encoder sees; none where there are none.
    pub fn errors_of_geometry<const N: usize>(&self) -> Option<KnownGeometry<N>> {
        let axes = std::array::from_fn(|i| {
            let axis = self.axis(i);
            AxisGeometry {
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
