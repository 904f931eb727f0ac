//! Kinematics: between the tool in space and the positions of the joints that servo loops move.
//!
//! Path, contour error and rows are of the tool in space, controllers and plant of N joints. Of a Cartesian machine the first N
//! coordinates are the joints; a machine whose third axis the program does not need stands still in it. This file is the one
//! place that knows: a rotary table or a robot puts its own transformation here.
//!
//! Joints are where their encoders say; guideways and screws are not as straight, square and even as that, and the tool is elsewhere:
//!
//! ```text
//! t_i = q_i (1 + e_i) + p_i sin(2 pi q_i / lead_i)            scale and pitch error of each axis
//! x = t_x + a_xy q_y + a_xz q_z,   y = t_y + a_yz q_z,   z = t_z       squareness, of first order
//! ```
//!
//! Source: ISO 230-1 (2012) for the errors and their names, ISO 230-2 (2014) for what is measured of a positioning error; Schwenke et
//! al. (2008), Geometric error measurement and compensation of machines, for the tool's position by them.

use feedwright_plan::vector::Vector;

/// What the tool's position has of the geometry of an axis that its encoder does not see.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct AxisErrors {
    /// What it goes farther, part of its way: e.
    pub scale: f64,
    /// Amplitude of the pitch error, mm: p.
    pub pitch_mm: f64,
    /// Its phase for a travel, rad/mm: 2 pi / lead.
    pub pitch_rad_per_mm: f64,
}

/// Errors of the axes' geometry.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct GeometricErrors<const N: usize> {
    /// Of each axis by itself.
    pub axes: [AxisErrors; N],
    /// Of y to x, z to x and z to y, rad: a_xy, a_xz, a_yz.
    pub squareness_rad: [f64; 3],
}

impl<const N: usize> GeometricErrors<N> {
    /// Where the tool is while the joints are where their encoders say, mm.
    pub(crate) fn tool_mm(&self, joints_mm: [f64; N]) -> [f64; N] {
        let [xy, xz, yz] = self.squareness_rad;
        let [_, y_mm, z_mm] = tool_of(joints_mm);
        let skew_mm = [xy * y_mm + xz * z_mm, yz * z_mm, 0.0];
        std::array::from_fn(|i| {
            let (AxisErrors { scale, pitch_mm, pitch_rad_per_mm }, at_mm) = (self.axes[i], joints_mm[i]);
            at_mm + scale * at_mm + pitch_mm * libm::sin(pitch_rad_per_mm * at_mm) + skew_mm.get(i).unwrap_or(&0.0)
        })
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_becomes_a_rhomb_and_a_metre_a_little_more() {
        let axes = [
            AxisErrors { scale: 20e-6, ..AxisErrors::default() },
            AxisErrors::default(),
            AxisErrors { pitch_mm: 0.003, pitch_rad_per_mm: std::f64::consts::TAU / 10.0, ..AxisErrors::default() },
        ];
        let errors = GeometricErrors { axes, squareness_rad: [50e-6, -30e-6, 10e-6] };
        let moved = |joints: [f64; 3]| {
            let tool = errors.tool_mm(joints);
            [0, 1, 2].map(|i| tool[i] - joints[i])
        };
        let near = |found: [f64; 3], wanted: [f64; 3]| (0..3).all(|i| (found[i] - wanted[i]).abs() < 1e-12);
        assert!(near(moved([1000.0, 0.0, 0.0]), [0.02, 0.0, 0.0]));
        assert!(near(moved([0.0, 100.0, 0.0]), [0.005, 0.0, 0.0]));
        assert!(near(moved([0.0, 0.0, 100.0]), [-0.003, 0.001, 0.0]));
        assert!(near(moved([0.0, 0.0, 2.5]), [-75e-6, 25e-6, 0.003]));
    }
}
