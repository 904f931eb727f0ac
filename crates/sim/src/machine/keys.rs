//! The keys of a machine file that are numbers: name, unit, range, and the field that each fills.
//!
//! Reading, writing, the bounds in messages and the tables of docs/machine-file.md all use these
//! tables, see [`crate::toml_file::key`]. A new key needs one field and one row.
//!
//! Ranges keep out what no machine has (a negative inertia, a unit mistaken by a factor of a
//! million), not what is unusual: a machine that is tuned badly is a result of the simulation, not
//! a fault of its file.

use feedwright_plan::Durations;

use super::{Axis, Limits, Noise, Period, Squareness, Transmission};
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

/// Keys of `[axis.x]`, `[axis.y]` and `[axis.z]`.
pub const AXIS: &[Key<Axis>] = &[
    key!(lead_mm_per_rev, "mm/rev", 0.01, 1e3),
    key!(inertia_kg_m2, "kg m2", 1e-9, 1e3),
    key!(viscous_friction_nm_s, "N m s/rad", 0.0, 1e4),
    key!(coulomb_friction_nm, "N m", 0.0, 1e5),
    key!(coulomb_smoothing_rad_s, "rad/s", 1e-6, 1e3),
    key!(disturbance_nm, "N m", 0.0, 1e5),
    key!(disturbance_hz, "Hz", 0.0, 1e5),
    key!(kp_1_s, "1/s", 1e-3, 1e5),
    key!(kd, "(no unit)", 0.0, 1e3),
    key!(kv_nm_s_per_rad, "N m s/rad", 1e-9, 1e6),
    key!(torque_limit_nm, "N m", 1e-6, 1e6),
    key!(command_delay_s or zero, "s", 0.0, 0.02),
    key!(drive_delay_s or zero, "s", 0.0, 0.02),
    Key {
        name: "torque_bits",
        unit: "bits",
        range: [4.0, 32.0],
        optional: true,
        value: Value::Number {
            get: |axis| axis.torque_bits.map(f64::from),
            set: |axis, bits| axis.torque_bits = Some(bits.round() as u32),
        },
    },
    key!(optional correction_accel_mm_s2, "mm/s2", 0.1, 1e6),
    key!(encoder_step_um or zero, "um", 0.0, 1e3),
    key!(speed_integral_s or zero, "s", 0.0, 10.0),
    key!(velocity_feedforward or zero, "(no unit)", 0.0, 2.0),
    key!(acceleration_feedforward or zero, "(no unit)", 0.0, 2.0),
    key!(torque_filter_hz or zero, "Hz", 0.0, 1e5),
    key!(speed_limit_mm_s or zero, "mm/s", 0.0, 1e4),
    key!(flag speed_from_encoder),
    key!(speed_window_s or zero, "s", 0.0, 0.02),
    key!(flag speed_held),
    key!(encoder_noise_um or zero, "um", 0.0, 1e3),
    key!(interpolation_error_um or zero, "um", 0.0, 1e3),
    key!(signal_period_um or zero, "um", 0.0, 1e5),
    key!(measurement_delay_s or zero, "s", 0.0, 0.02),
    key!(jitter_s or zero, "s", 0.0, 0.02),
    key!(coulomb_asymmetry_nm or zero, "N m", -1e5, 1e5),
    key!(stribeck_nm or zero, "N m", 0.0, 1e5),
    key!(stribeck_mm_s or zero, "mm/s", 0.0, 1e4),
    key!(presliding_um or zero, "um", 0.0, 1e4),
    key!(cogging_nm or zero, "N m", 0.0, 1e5),
    key!(cogging_per_rev or zero, "1/rev", 0.0, 1e4),
    key!(ripple or zero, "(no unit)", 0.0, 1.0),
    key!(ripple_per_rev or zero, "1/rev", 0.0, 1e4),
    key!(torque_noise_nm or zero, "N m", 0.0, 1e5),
    key!(torque_noise_s or zero, "s", 0.0, 10.0),
    key!(disturbance_wander or zero, "(no unit)", 0.0, 0.5),
    key!(scale_um_m or zero, "um/m", -1e4, 1e4),
    key!(pitch_error_um or zero, "um", 0.0, 1e3),
    key!(optional max_velocity_mm_s, "mm/s", 0.01, 1e4),
    key!(optional max_accel_mm_s2, "mm/s2", 0.1, 1e6),
    key!(optional max_jerk_mm_s3, "mm/s3", 1.0, 1e9),
];

/// Keys of `[axis.x.transmission]`, `[axis.y.transmission]` and `[axis.z.transmission]`.
pub const TRANSMISSION: &[Key<Transmission>] = &[
    key!(table_share, "(no unit)", 0.01, 0.99),
    key!(resonance_hz, "Hz", 0.1, 1e4),
    key!(damping_ratio, "(no unit)", 0.0, 1.0),
    key!(backlash_um, "um", 0.0, 1e4),
    key!(flag scale_on_table),
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
