//! The keys of a model file: name, unit, range, and the field that each fills; see
//! [`feedwright_sim::toml_file::key`].

use feedwright_control::{
    AxisKnowledge, FEED_PERIODS_S, IdentifierKind, MAX_WEIGHT, MECHANICS_PERIODS_S, RESPONSES_S,
    SERVO_PERIODS_S,
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

/// The mechanics period, then one key for each parameter of an axis. Each of these keys holds one
/// value per axis.
macro_rules! axes_keys {
    ($($index:literal)*) => {{
        const { assert!(AxisKnowledge::NUMBERS.len() == [$($index),*].len(), "a key for each number of an axis") };
        [key!(mechanics_s, "s", MECHANICS_PERIODS_S[0], MECHANICS_PERIODS_S[1]), $(of_axes::<$index>()),*]
    }};
}
const AXES: &[Key<Weights>] = &axes_keys!(
    0 1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30 31 32 33 34 35 36 37 38
);

const fn of_axes<const INDEX: usize>() -> Key<Weights> {
    let number = &AxisKnowledge::NUMBERS[INDEX];
    let [least, most] = number.range;
    Key {
        name: number.name,
        unit: number.unit,
        // What may be zero or no less than its least is looked at as a whole, once it is read.
        range: [if number.or_none { 0.0 } else { least }, most],
        optional: number.optional,
        value: Value::Numbers {
            get: |weights| weights.axes.get(INDEX).map_or(&[], Vec::as_slice),
            set: |weights, numbers| weights.set_of_axes(INDEX, numbers),
        },
    }
}
