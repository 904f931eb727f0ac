//! Contours turned and scaled at random.

use std::f64::consts::PI;

use super::random::Random;
use crate::contour::Placement;

/// Range of the scale: half as small bends as where anything was tuned, and larger ones.
const SCALE: [f64; 2] = [0.5, 1.5];

/// The placement of a seed; the same on every platform.
pub fn placement(seed: u64) -> Placement {
    let mut random = Random::new(seed);
    Placement {
        scale: random.by_ratio(SCALE),
        turn_rad: random.between([-PI, PI]),
    }
}
