//! The keys of a machine file that are numbers: name, unit, range, and the field that each fills.
//!
//! Reading, writing, the bounds in messages and the tables of docs/machine-file.md all use these
//! tables, see [`crate::toml_file::key`]. The keys of an axis are rows of the table of its
//! numbers, `crates/control/src/axis/numbers.rs`. Any other new key needs one field and one row.
//!
//! Ranges keep out what no machine has (a negative inertia, a unit mistaken by a factor of a
//! million), not what is unusual: a machine that is tuned badly is a result of the simulation, not
//! a fault of its file.

use feedwright_plan::Durations;

pub use super::axis::{AXIS, TRANSMISSION};
use super::{Limits, Noise, Period, Squareness};
use crate::toml_file::Key;
use crate::toml_file::key::{Value, key};

/// Keys of `[period]`.
pub const PERIOD: &[Key<Period>] = &[
    key!(servo_s, "s", 1e-5, 0.1),
    key!(mechanics_s, "s", 1e-7, 0.1),
];

/// Keys of `[limits]`.
pub const LIMITS: &[Key<Limits>] = &[
    key!(rapid_mm_s, "mm/s", 0.01, 1e4),
    key!(max_feed_mm_s, "mm/s", 0.01, 1e4),
    key!(tangential_accel_mm_s2, "mm/s2", 0.1, 1e6),
    key!(normal_accel_mm_s2, "mm/s2", 0.1, 1e6),
    key!(corner_jump_mm_s, "mm/s", 0.0, 1e4),
    key!(max_deviation_mm, "mm", 0.0, 100.0),
    key!(optional max_feed_rise_percent, "%", 0.0, 200.0),
    key!(optional path_tolerance_um, "um", 0.01, 1e4),
];

/// Keys of `[geometry]`.
pub const GEOMETRY: &[Key<Squareness>] = &[
    key!(squareness_xy_urad or zero, "urad", -1e4, 1e4),
    key!(squareness_xz_urad or zero, "urad", -1e4, 1e4),
    key!(squareness_yz_urad or zero, "urad", -1e4, 1e4),
];

/// Keys of `[noise]`.
pub const NOISE: &[Key<Noise>] = &[Key {
    name: "seed",
    unit: "",
    // Whole numbers that a number of a file holds exactly.
    range: [0.0, 9_007_199_254_740_992.0],
    optional: true,
    value: Value::Whole {
        get: |noise| Some(noise.seed).filter(|seed| *seed != 0),
        set: |noise, seed| noise.seed = seed,
    },
}];

/// Keys of `[plc]`.
pub const PLC: &[Key<Durations>] = &[
    key!(tool_change_s, "s", 0.0, 1e4),
    key!(coolant_s, "s", 0.0, 1e4),
    key!(pallet_change_s, "s", 0.0, 1e5),
    key!(spindle_rev_min_s, "rev/min/s", 0.0, 1e7),
    key!(rotary_deg_s or zero, "degrees/s", 0.0, 1e5),
];
