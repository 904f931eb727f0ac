//! Parameters of the rows of the table: ranges, defaults, reasons.

use feedwright_control::{Gains, INVERTING_FEED_PERIOD_S, InvertingSettings};

use super::Parameter;

// Of those that invert the paper's identifier.
pub(super) const RHO: Parameter = Parameter::number(
    "rho",
    InvertingSettings::DEFAULT.inversion.rho,
    [0.0, 0.1],
    Some([1e-5, 0.1]),
    "weight of the machining time against the error: 0 looks at the error alone, more is faster and less accurate",
);
pub(super) const ETA: Parameter = Parameter::number(
    "eta",
    InvertingSettings::DEFAULT.inversion.eta,
    [0.0, 10.0],
    Some([1e-3, 10.0]),
    "length of a gradient step: 0 inverts nothing; the paper takes 0.3",
);
pub(super) const INVERSION_STEPS: Parameter = Parameter::whole(
    "steps",
    InvertingSettings::DEFAULT.inversion.steps,
    [1.0, 20.0],
    "gradient steps in a tick: the paper allows 5",
);
pub(super) const INVERSION_KNOTS: Parameter = Parameter::whole(
    "knots",
    InvertingSettings::DEFAULT.knots,
    [1.0, 20.0],
    "knots that are inverted together: 1 is the paper's; with the printed gradient more change nothing",
);
pub(super) const INVERSION_PERIOD_S: Parameter = Parameter::number(
    "feed_period_s",
    INVERTING_FEED_PERIOD_S,
    [1e-3, 0.012],
    None,
    "time between decisions: the paper's 10 ms",
)
.of_unit("s");
pub(super) const LEARNING_STEP: Parameter = Parameter::number(
    "learning_step",
    InvertingSettings::DEFAULT.learning_step,
    [0.0, 0.5],
    None,
    "step of back-propagation while cutting: 0 keeps what was trained, large ones forget it",
);
// Of the same by an identified model, which is to bear what that does not know.
pub(super) const IDENTIFIED_WEIGHT: Parameter = Parameter::number(
    "control_weight",
    feedwright_control::IDENTIFIED_WEIGHT,
    [1e-6, 1e4],
    None,
    "weight of the reference speed against the error, in servo periods squared, near the reference: a high one leaves the error",
).of_unit("servo periods squared");
// Parts of what the exact model calls for, and scales of its parameters.
/// Share of the velocity feedforward.
pub const VELOCITY_GAIN: Parameter = Parameter::number(
    "velocity_gain",
    Gains::EXACT.velocity,
    [0.0, 10.0],
    Some([0.1, 1.5]),
    EXACT_REASON,
)
.of_unit("times the feedforward of the exact model");
/// Share of the acceleration feedforward.
pub const ACCELERATION_GAIN: Parameter = Parameter::number(
    "acceleration_gain",
    Gains::EXACT.acceleration,
    [0.0, 10.0],
    Some([0.0, 2.0]),
    EXACT_REASON,
)
.of_unit("times the feedforward of the exact model");
/// Share of the friction feedforward.
pub const FRICTION_GAIN: Parameter = Parameter::number(
    "friction_gain",
    Gains::EXACT.friction,
    [0.0, 10.0],
    Some([0.0, 4.0]),
    EXACT_REASON,
)
.of_unit("times the feedforward of the exact model");
pub(super) const EXACT_REASON: &str =
    "1 is what the exact model calls for; another makes up for a model that is not exact";
