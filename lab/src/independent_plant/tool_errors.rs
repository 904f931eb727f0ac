//! Errors of the tool that no encoder sees and that feedwright's geometry does not have: angular errors, and growth by heat.
//!
//! ```text
//! t = q + theta(q) x r + g(tau) q        theta(q) = sum over axes j of A_j sin(2 pi q_j / P_j)
//! dg/dtau = (G - g) / T                  g(tau) = G (1 - exp(-tau / T)) from a cold machine on
//! ```
//!
//! theta has the roll, pitch and yaw of each table, and r is the Abbe arm from where the scales are to the tool. g is the growth of
//! each axis while the machine warms up.
//!
//! Symbols: q joints, mm; A amplitude of the rotation about x, y and z, rad; P period, mm; r arm, mm; G growth of a warm machine, mm/mm;
//! T its time constant, s; tau time, s.
//!
//! Source: ISO 230-1 (2012) for angular errors, Bryan (1979), "The Abbe principle revisited", Precision Engineering 1, for the arm.
//! ISO 230-3 (2007) for drift by heat. A lumped heat capacity grows by a first-order law.

use std::f64::consts::TAU;

use serde::Serialize;

/// Errors of the tool; all zero is without.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct ToolErrors {
    /// Amplitude of the rotation about x, y and z, by the axis that moves, rad.
    pub angular_rad: [[f64; 3]; 3],
    /// Travel over which the rotation repeats, by the axis that moves, mm.
    pub period_mm: [f64; 3],
    /// From the scales to the tool, mm.
    pub arm_mm: [f64; 3],
    /// Growth of each axis of a warm machine, mm/mm.
    pub growth: [f64; 3],
    /// Time constant of the growth, s.
    pub warms_s: f64,
}

impl ToolErrors {
    /// Where the tool is, of where it would be without, `time_s` after a cold start, mm.
    pub fn tool_mm(&self, at_mm: [f64; 3], time_s: f64) -> [f64; 3] {
        let mut turned_rad = [0.0; 3];
        for ((by_axis_rad, period_mm), at_mm) in self.angular_rad.iter().zip(self.period_mm).zip(at_mm) {
            let part = if period_mm > 0.0 { libm::sin(TAU * at_mm / period_mm) } else { 0.0 };
            turned_rad.iter_mut().zip(by_axis_rad).for_each(|(sum, rad)| *sum += part * rad);
        }
        let ([a, b, c], [x, y, z]) = (turned_rad, self.arm_mm);
        let moved_mm = [b * z - c * y, c * x - a * z, a * y - b * x];
        let warm = if self.warms_s > 0.0 { -libm::expm1(-time_s / self.warms_s) } else { 0.0 };
        [0, 1, 2].map(|i| at_mm[i] + moved_mm[i] + warm * self.growth[i] * at_mm[i])
    }
}
