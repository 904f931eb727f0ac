//! Kinematics: between the tool in space and the positions of the joints that servo loops move.
//!
//! Path, contour error and rows describe the tool in space; controllers and plant work on N joints.
//! On a Cartesian machine, the first N coordinates are the joints; a third axis that the program
//! does not need stands still. This file is the only place that makes this assumption: a rotary
//! table or a robot puts its own transformation here.
//!
//! Joint positions are encoder readings. Guideways and screws are not perfectly straight, square
//! and uniform, so the tool is slightly elsewhere: see [`feedwright_control::KnownGeometry`], and
//! `known_geometry.rs` for the known part of these errors.

use feedwright_plan::vector::Vector;

/// Positions of the joints that bring the tool to a place, mm; also of tangents and other
/// differences.
#[inline]
pub fn joints_of<const N: usize>(tool: Vector) -> [f64; N] {
    std::array::from_fn(|joint| tool.get(joint).copied().unwrap_or(0.0))
}

/// Returns the tool position for joint positions, mm.
#[inline]
pub(crate) fn tool_of<const N: usize>(joints: [f64; N]) -> Vector {
    std::array::from_fn(|axis| joints.get(axis).copied().unwrap_or(0.0))
}
