//! The keys of a model file: name, unit, range, and the field that each fills; see [`crate::toml_file::key`].

use feedwright_control::identifier::{FEED_PERIODS_S, IdentifierKind};
use feedwright_control::model::{MAX_SPREAD, MAX_WEIGHT, SERVO_PERIODS_S};

use super::{About, Fit, ModelPeriods, Weights};
use crate::toml_file::Key;
use crate::toml_file::key::key;

/// Most samples of a training that are believed: a century of decisions.
const MAX_SAMPLES: f64 = 1e12;
/// Largest error of a fit, um: a metre.
const MAX_FIT_UM: f64 = 1e6;

/// Of the top of the file.
pub const ABOUT: &[Key<About>] = &[
    key!(whole format, "", 1.0, 1e9),
    key!(text written_by),
    key!(text kind),
    key!(whole axes, "", 2.0, 3.0),
    key!(text source),
    key!(text date),
    key!(text training_data),
    key!(text checksum),
];

/// Of `[period]`.
pub const PERIOD: &[Key<ModelPeriods>] = &[
    key!(servo_s, "s", SERVO_PERIODS_S[0], SERVO_PERIODS_S[1]),
    key!(feed_period_s, "s", FEED_PERIODS_S[0], FEED_PERIODS_S[1]),
];

/// Of `[fit]`.
pub const FIT: &[Key<Fit>] = &[key!(fit_um, "um", 0.0, MAX_FIT_UM), key!(whole samples, "", 0.0, MAX_SAMPLES)];

/// Of `[weights]`.
pub(crate) const fn weights(kind: IdentifierKind) -> &'static [Key<Weights>] {
    match kind {
        IdentifierKind::Contour => CONTOUR,
        IdentifierKind::Servo => SERVO,
        IdentifierKind::Axes => AXES,
    }
}

const CONTOUR: &[Key<Weights>] =
    &[key!(numbers hidden, "", -MAX_WEIGHT, MAX_WEIGHT), key!(numbers output, "", -MAX_WEIGHT, MAX_WEIGHT)];

const SERVO: &[Key<Weights>] = &[
    key!(numbers linear, "", -MAX_WEIGHT, MAX_WEIGHT),
    key!(numbers hidden, "", -MAX_WEIGHT, MAX_WEIGHT),
    key!(numbers output, "", -MAX_WEIGHT, MAX_WEIGHT),
    key!(numbers spread, "", -MAX_SPREAD, MAX_SPREAD),
];

const AXES: &[Key<Weights>] = &[key!(numbers axes, "", -MAX_WEIGHT, MAX_WEIGHT)];
