//! Corner deviation: how far from a programmed corner the planned path may pass, by the mode of the
//! block (G61, G61.1, G64 P), and at which corners the tool stops.
//!
//! The whole path keeps this distance, not its corners alone: it is the radius of the tube in which
//! `window.rs` looks for the least time. `between_nodes.rs` checks it between the nodes of a window.

use feedwright_gcode::canon::Corner;

/// Deviation of exact path and exact stop, mm.
const EXACT_MM: f64 = 1e-3;

/// A turn of the tangent that is a corner in exact path mode, rad.
const CORNER_RAD: f64 = 1e-3;

/// Deviation where neither program nor machine state one, mm.
const DEFAULT_MM: f64 = 0.01;

/// Least deviation, mm; a smaller one counts as this.
const LEAST_MM: f64 = 1e-5;

/// Returns the largest deviation from the path of a block, mm. `machine_mm` is the machine's
/// tolerance of the path.
pub(super) fn corner_deviation_mm(corner: Corner, machine_mm: Option<f64>) -> f64 {
    let machine_mm = machine_mm.unwrap_or(DEFAULT_MM);
    let deviation_mm = match corner {
        Corner::ExactStop | Corner::ExactPath => EXACT_MM.min(machine_mm),
        Corner::Continuous { tolerance_mm, .. } => tolerance_mm.unwrap_or(machine_mm),
    };
    deviation_mm.max(LEAST_MM)
}

/// Returns true if the tool comes to rest at the end of a block whose tangent turns there by an
/// angle, rad.
pub(super) fn stops_at(corner: Corner, turn_rad: f64) -> bool {
    match corner {
        Corner::ExactStop => true,
        Corner::ExactPath => turn_rad > CORNER_RAD,
        Corner::Continuous { .. } => false,
    }
}
