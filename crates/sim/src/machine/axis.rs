//! An axis of a machine file, as the table of `crates/control/src/axis/numbers.rs` has it.

use std::f64::consts::TAU;

use feedwright_control::{Parameters, axis_numbers};
use serde::ser::SerializeMap;
use serde::{Serialize, Serializer};

use crate::toml_file::Key;
use crate::toml_file::key::{Value, key};

/// Type of a field, by the kind of its key.
macro_rules! field {
    (required) => { f64 };
    (or_zero) => { f64 };
    (flag) => { bool };
    (optional) => { Option<f64> };
    (bits) => { Option<u32> };
}

macro_rules! is_required {
    (required) => {
        true
    };
    ($other:ident) => {
        false
    };
}

/// Key of a field, by its kind.
macro_rules! of_kind {
    (required $key:ident $unit:literal [$least:expr, $most:expr]) => {
        key!($key, $unit, $least, $most)
    };
    (or_zero $key:ident $unit:literal [$least:expr, $most:expr]) => {
        key!($key or zero, $unit, $least, $most)
    };
    (flag $key:ident $($range:tt)*) => {
        key!(flag $key)
    };
    (optional $key:ident $unit:literal [$least:expr, $most:expr]) => {
        key!(optional $key, $unit, $least, $most)
    };
    (bits $key:ident $unit:literal [$least:expr, $most:expr]) => {
        Key {
            name: stringify!($key),
            unit: $unit,
            range: [$least, $most],
            optional: true,
            value: Value::Number {
                get: |axis| axis.$key.map(f64::from),
                set: |axis, bits| axis.$key = Some(bits.round() as u32),
            },
        }
    };
}

/// Number at the motor shaft: the function of the row, or the value of the key itself.
macro_rules! at_shaft {
    ($axis:expr, $value:expr, ) => {
        $value
    };
    ($axis:expr, $value:expr, $of:expr) => {{
        let of: fn(&Axis) -> f64 = $of;
        of($axis)
    }};
    ($axis:expr, $screw:expr, $value:expr, ) => {
        $value
    };
    ($axis:expr, $screw:expr, $value:expr, $of:expr) => {{
        let of: fn(&Axis, &Transmission) -> f64 = $of;
        of($axis, $screw)
    }};
}

/// Makes [`Axis`] and [`Transmission`] of the table.
macro_rules! axis {
    (
        axis { $(
            $key:ident $kind:ident $unit:literal $range:tt $words:literal $(needs $needed:ident)?
            $(=> {
                $place:literal $part:ident $name:ident $($own_unit:literal)?
                $rule:ident $([$least:expr, $most:expr])? $format:literal
                $(($own_words:literal, $of:expr))?
            })?;
        )* }
        transmission { $(
            $screw_key:ident $screw_kind:ident $screw_unit:literal $screw_range:tt
            $screw_words:literal
            $(=> {
                $screw_place:literal $screw_part:ident $screw_name:ident $($screw_own_unit:literal)?
                $screw_rule:ident $([$screw_least:expr, $screw_most:expr])? $screw_format:literal
                $(($screw_own_words:literal, $of_screw:expr))?
            })?;
        )* }
    ) => {
        /// A servo axis: mechanics at the motor shaft and the two control loops.
        #[derive(Debug, Clone, Copy, Default, PartialEq)]
        pub struct Axis {
            $(#[doc = concat!($words, ".")] pub $key: field!($kind),)*
            /// Acceleration of a correction that fades, mm/s2, kept where a plan by axes adds
            /// limits that the file does not state; no key of the file.
            pub fade_accel_mm_s2: Option<f64>,
            /// Ball screw; none is rigid.
            pub transmission: Option<Transmission>,
        }

        /// The ball screw between motor and table: `[axis.x.transmission]`.
        #[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
        pub struct Transmission {
            $(#[doc = concat!($screw_words, ".")] pub $screw_key: field!($screw_kind),)*
        }

        /// Keys of `[axis.x]`, `[axis.y]` and `[axis.z]`.
        pub const AXIS: &[Key<Axis>] = &[$(of_kind!($kind $key $unit $range)),*];

        /// Keys of `[axis.x.transmission]`, `[axis.y.transmission]` and `[axis.z.transmission]`.
        pub const TRANSMISSION: &[Key<Transmission>] =
            &[$(of_kind!($screw_kind $screw_key $screw_unit $screw_range)),*];

        impl Serialize for Axis {
            fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
                let mut map = serializer.serialize_map(None)?;
                $(if is_required!($kind) || self.$key != <field!($kind)>::default() {
                    map.serialize_entry(stringify!($key), &self.$key)?;
                })*
                if let Some(transmission) = &self.transmission {
                    map.serialize_entry("transmission", transmission)?;
                }
                map.end()
            }
        }

        impl Axis {
            /// Keys that say how much, each with its value, and the key that says over what.
            pub(super) fn needs(&self) -> impl Iterator<Item = [(&'static str, f64); 2]> {
                [$($([(stringify!($key), self.$key), (stringify!($needed), self.$needed)],)?)*]
                    .into_iter()
            }

            /// Returns the numbers of the axis at the motor shaft.
            pub fn parameters(&self) -> Parameters {
                let axis = Parameters {
                    $($($name: at_shaft!(self, self.$key, $($of)?),)?)*
                    ..Parameters::NOTHING
                };
                self.transmission.map_or(axis, |screw| Parameters {
                    $($($screw_name: at_shaft!(self, &screw, screw.$screw_key, $($of_screw)?),)?)*
                    ..axis
                })
            }
        }
    };
}

axis_numbers!(axis);

impl Axis {
    /// Returns true if any property of the axis is random.
    pub(super) fn is_noisy(&self) -> bool {
        [
            self.encoder_noise_um,
            self.jitter_s,
            self.torque_noise_nm,
            self.disturbance_wander,
        ]
        .iter()
        .any(|&size| size > 0.0)
    }

    /// Backlash that the encoder does not see, mm: a scale on the table sees the gap.
    pub fn hidden_backlash_mm(&self) -> f64 {
        self.hidden_screw()
            .map_or(0.0, |screw| 1e-3 * screw.backlash_um)
    }

    /// Returns the windup of the screw by the friction of both directions before the table moves,
    /// mm: the part that the encoder does not see.
    pub fn hidden_windup_mm(&self) -> f64 {
        self.hidden_screw()
            .map_or(0.0, |_| self.parameters().windup_rad() / self.rad_per_mm())
    }

    /// The screw, where the encoder is at the motor.
    pub(crate) fn hidden_screw(&self) -> Option<Transmission> {
        self.transmission.filter(|screw| !screw.scale_on_table)
    }

    /// Turn of the motor for a travel, rad/mm.
    pub fn rad_per_mm(&self) -> f64 {
        TAU / self.lead_mm_per_rev
    }

    /// Turn of the motor for a travel in um, rad.
    fn rad(&self, um: f64) -> f64 {
        um * 1e-3 * self.rad_per_mm()
    }

    fn signal_per_rad(&self) -> f64 {
        let signal_rad = self.rad(self.signal_period_um);
        if signal_rad > 0.0 {
            TAU / signal_rad
        } else {
            0.0
        }
    }
}
