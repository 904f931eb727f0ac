//! Kinematics: between the tool in space and the positions of the joints that servo loops move.
//!
//! Path, contour error and rows are of the tool in space, controllers and plant of N joints. Of a
//! Cartesian machine the first N coordinates are the joints; a machine whose third axis the program
//! does not need stands still in it. This file is the one place that knows: a rotary table or a
//! robot puts its own transformation here.
//!
//! Joints are where their encoders say; guideways and screws are not as straight, square and even
//! as that, and the tool is elsewhere: see [`feedwright_control::KnownGeometry`], and
//! `known_geometry.rs` for what is known of it.

use feedwright_plan::vector::Vector;

/// Positions of the joints that bring the tool to a place, mm; also of tangents and other
/// differences.
#[inline]
pub fn joints_of<const N: usize>(tool: Vector) -> [f64; N] {
    std::array::from_fn(|joint| tool.get(joint).copied().unwrap_or(0.0))
}

/// Where the joints bring the tool, mm.
#[inline]
pub(crate) fn tool_of<const N: usize>(joints: [f64; N]) -> Vector {
    std::array::from_fn(|axis| joints.get(axis).copied().unwrap_or(0.0))
}
