//! The keys of a machine file that are numbers: name, unit, range, and the field that each fills.
//!
//! Reading, writing, the bounds in messages and the tables of docs/machine-file.md all go by these tables. To add a key is one field
//! and one row.

use super::error::Fault;
use super::reader::Table;
use super::{Axis, Durations, Limits, Period, Transmission};

/// A key whose value is a number.
pub struct Key<T> {
    /// Name; its end is the unit.
    pub name: &'static str,
    /// Unit, as messages tell it.
    pub unit: &'static str,
    /// Least and most. They keep out what no machine has (a negative inertia, a unit mistaken by a factor of a million), not what is
    /// unusual: a machine that is tuned badly is a result of the simulation, not a fault of its file.
    pub range: [f64; 2],
    /// Whether it may be left out.
    pub optional: bool,
    /// The value of a part of a machine; none where it was left out.
    pub get: fn(&T) -> Option<f64>,
    /// Fills it in.
    pub set: fn(&mut T, f64),
}

/// `field, unit, least, most`; `optional field` is an `Option`, `field or zero` is 0 where it is left out.
macro_rules! key {
    (optional $field:ident, $unit:literal, $least:literal, $most:literal) => {
        Key {
            name: stringify!($field),
            unit: $unit,
            range: [$least, $most],
            optional: true,
            get: |part| part.$field,
            set: |part, value| part.$field = Some(value),
        }
    };
    ($field:ident or zero, $unit:literal, $least:literal, $most:literal) => {
        Key {
            name: stringify!($field),
            unit: $unit,
            range: [$least, $most],
            optional: true,
            get: |part| Some(part.$field).filter(|value| *value != 0.0),
            set: |part, value| part.$field = value,
        }
    };
    ($field:ident, $unit:literal, $least:literal, $most:literal) => {
        Key {
            name: stringify!($field),
            unit: $unit,
            range: [$least, $most],
            optional: false,
            get: |part| Some(part.$field),
            set: |part, value| part.$field = value,
        }
    };
}

/// Of `[period]`.
pub const PERIOD: &[Key<Period>] = &[key!(servo_s, "s", 1e-5, 0.1), key!(mechanics_s, "s", 1e-7, 0.1)];

/// Of `[limits]`.
pub const LIMITS: &[Key<Limits>] = &[
    key!(rapid_mm_s, "mm/s", 0.01, 1e4),
    key!(max_feed_mm_s, "mm/s", 0.01, 1e4),
    key!(tangential_accel_mm_s2, "mm/s2", 0.1, 1e6),
    key!(normal_accel_mm_s2, "mm/s2", 0.1, 1e6),
    key!(corner_jump_mm_s, "mm/s", 0.0, 1e4),
    key!(max_deviation_mm, "mm", 0.0, 100.0),
];

/// Of `[axis.x]`, `[axis.y]` and `[axis.z]`.
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
    key!(drive_delay_s or zero, "s", 0.0, 0.02),
    Key {
        name: "torque_bits",
        unit: "bits",
        range: [4.0, 32.0],
        optional: true,
        get: |axis| axis.torque_bits.map(f64::from),
        set: |axis, bits| axis.torque_bits = Some(bits.round() as u32),
    },
    key!(optional correction_accel_mm_s2, "mm/s2", 0.1, 1e6),
    key!(encoder_step_um or zero, "um", 0.0, 1e3),
    key!(optional max_velocity_mm_s, "mm/s", 0.01, 1e4),
    key!(optional max_accel_mm_s2, "mm/s2", 0.1, 1e6),
    key!(optional max_jerk_mm_s3, "mm/s3", 1.0, 1e9),
];

/// Of `[axis.x.transmission]` and its like.
pub const TRANSMISSION: &[Key<Transmission>] = &[
    key!(table_share, "(no unit)", 0.01, 0.99),
    key!(resonance_hz, "Hz", 0.1, 1e4),
    key!(damping_ratio, "(no unit)", 0.0, 1.0),
    key!(backlash_um, "um", 0.0, 1e4),
    Key {
        name: "scale_on_table",
        unit: "(0 or 1)",
        range: [0.0, 1.0],
        optional: true,
        get: |transmission| transmission.scale_on_table.then_some(1.0),
        set: |transmission, on| transmission.scale_on_table = on > 0.5,
    },
];

/// Of `[plc]`.
pub const PLC: &[Key<Durations>] = &[
    key!(tool_change_s, "s", 0.0, 1e4),
    key!(coolant_s, "s", 0.0, 1e4),
    key!(pallet_change_s, "s", 0.0, 1e5),
    key!(spindle_rev_min_s, "rev/min/s", 0.0, 1e7),
    key!(rotary_deg_s or zero, "degrees/s", 0.0, 1e5),
];

/// Reads all keys of a table; what has a fault is not a number.
pub(super) fn read<T: Default>(keys: &[Key<T>], table: &mut Table<'_, '_>, faults: &mut Vec<Fault>) -> T {
    let mut part = T::default();
    for key in keys {
        let [least, most] = key.range;
        if key.optional {
            if let Some(value) = table.optional_number(key.name, key.unit, least..=most, faults) {
                (key.set)(&mut part, value);
            }
        } else {
            (key.set)(&mut part, table.number(key.name, key.unit, least..=most, faults));
        }
    }
    part
}

/// The lines of a table; what was left out stays out.
pub(super) fn write<T>(keys: &[Key<T>], part: &T) -> String {
    let line = |key: &Key<T>| Some(format!("{} = {:?}\n", key.name, (key.get)(part)?));
    keys.iter().filter_map(line).collect()
}
