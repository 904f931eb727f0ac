//! The keys of a model file: name, unit, range, and the field that each fills; see
//! [`feedwright_sim::toml_file::key`].

use feedwright_control::{
    FEED_PERIODS_S, IdentifierKind, MAX_WEIGHT, MECHANICS_PERIODS_S, Parameters, RESPONSES_S,
    SERVO_PERIODS_S, axis_numbers,
};
use feedwright_sim::toml_file::Key;
use feedwright_sim::toml_file::key::{Value, key};

use super::{About, Fit, ModelPeriods, Weights};

/// Most samples of a training that a file may state: a century of decisions.
const MAX_SAMPLES: f64 = 1e12;
/// Largest error of a fit, um: a metre.
const MAX_FIT_UM: f64 = 1e6;

/// Keys at the top of the file.
pub(crate) const ABOUT: &[Key<About>] = &[
    key!(whole format, "", 1.0, 1e9),
    key!(text written_by),
    key!(text kind),
    key!(whole axes, "", 2.0, 3.0),
    key!(text source),
    key!(text date),
    key!(text training_data),
    key!(text checksum),
];

/// Keys of `[period]`.
pub(crate) const PERIOD: &[Key<ModelPeriods>] = &[
    key!(servo_s, "s", SERVO_PERIODS_S[0], SERVO_PERIODS_S[1]),
    key!(feed_period_s, "s", FEED_PERIODS_S[0], FEED_PERIODS_S[1]),
];

/// Keys of `[fit]`.
pub(crate) const FIT: &[Key<Fit>] = &[
    key!(fit_um, "um", 0.0, MAX_FIT_UM),
    key!(whole samples, "", 0.0, MAX_SAMPLES),
];

/// Returns the keys of `[weights]`.
pub(crate) const fn weights(kind: IdentifierKind) -> &'static [Key<Weights>] {
    match kind {
        IdentifierKind::Contour => CONTOUR,
        IdentifierKind::Axes => AXES,
    }
}

const CONTOUR: &[Key<Weights>] = &[
    key!(numbers hidden, "", -MAX_WEIGHT, MAX_WEIGHT),
    key!(numbers output, "", -MAX_WEIGHT, MAX_WEIGHT),
    key!(response_s or zero, "s", RESPONSES_S[0], RESPONSES_S[1]),
];

/// The mechanics period, then one key for each number of an axis. Each of these keys holds one
/// value per axis.
macro_rules! axes_keys {
    (
        axis { $(
            $key:ident $kind:ident $unit:literal $range:tt $words:literal $(needs $needed:ident)?
            $(=> { $place:literal $($number:tt)* })?;
        )* }
        transmission { $(
            $screw:ident $screw_kind:ident $screw_unit:literal $screw_range:tt $screw_words:literal
            $(=> { $screw_place:literal $($of_screw:tt)* })?;
        )* }
    ) => {
        const AXES: &[Key<Weights>] = &{
            const FIRST: Key<Weights> =
                key!(mechanics_s, "s", MECHANICS_PERIODS_S[0], MECHANICS_PERIODS_S[1]);
            let mut keys = [FIRST; 1 + Parameters::NUMBERS.len()];
            $($(keys[1 + $place] = of_axes::<$place>();)?)*
            $($(keys[1 + $screw_place] = of_axes::<$screw_place>();)?)*
            keys
        };
    };
}
axis_numbers!(axes_keys);

const fn of_axes<const PLACE: usize>() -> Key<Weights> {
    let number = &Parameters::NUMBERS[PLACE];
    let [least, most] = number.range;
    Key {
        name: number.name,
        unit: number.unit,
        // What may be zero or no less than its least is looked at as a whole, once it is read.
        range: [if number.or_none { 0.0 } else { least }, most],
        optional: number.optional,
        value: Value::Numbers {
            get: |weights| weights.axes.get(PLACE).map_or(&[], Vec::as_slice),
            set: |weights, numbers| weights.set_of_axes(PLACE, numbers),
        },
    }
}
