//! Parameters of the rows of the table: ranges, defaults, reasons.

use feedwright_control::{
    Gains, INVERTING_FEED_PERIOD_S, InvertingSettings, MAX_KNOTS, RECEDING_HORIZON_FEED_PERIOD_S,
    RecedingHorizonSettings,
};

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
);
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
);
// Of those that plan over a horizon.
/// Weight of the speed of the offset.
pub const RATE_WEIGHT: Parameter = Parameter::number(
    "rate_weight_s2",
    RecedingHorizonSettings::<2>::DEFAULT.horizon.rate_weight,
    [0.0, 0.01],
    None,
    "weight of the speed of the offset: below 1e-10 the plan rings from knot to knot, above 1e-4 nothing is corrected",
);
/// Knots of the horizon.
pub const KNOTS: Parameter = Parameter::whole(
    "knots",
    RecedingHorizonSettings::<2>::DEFAULT.horizon.knots,
    [1.0, MAX_KNOTS as f64],
    "knots of the horizon: fewer take less time in a tick, and see less of a corner ahead",
);
/// Time between decisions of the horizon.
pub const PLAN_PERIOD_S: Parameter = Parameter::number(
    "feed_period_s",
    RECEDING_HORIZON_FEED_PERIOD_S,
    [1e-3, 0.012],
    None,
    "time between decisions: 2 ms is worse on a soft ball screw, 5 ms at every reversal",
);
pub(super) const CHANGE_WEIGHT: Parameter = Parameter::number(
    "change_weight_s2",
    RecedingHorizonSettings::<2>::DEFAULT.horizon.change_weight,
    [0.0, 0.01],
    None,
    "weight of the change of that speed from knot to knot: more is smoother, and blunter at corners",
);
pub(super) const TANGENTIAL_WEIGHT: Parameter = Parameter::number(
    "tangential_weight",
    RecedingHorizonSettings::<2>::DEFAULT.horizon.tangential_weight,
    [0.0, 1.0],
    None,
    "weight of an error along the path: small leaves room at a corner, large keeps the tool from staying behind",
);
pub(super) const LAST_WEIGHT: Parameter = Parameter::number(
    "last_weight",
    RecedingHorizonSettings::<2>::DEFAULT.horizon.last_weight,
    [0.0, 1.0],
    None,
    "the same at the end of the horizon, at the least: where it is small, the tool swings about turns that are not seen yet",
);
pub(super) const INNOVATION_SCALE_MM: Parameter = Parameter::number(
    "innovation_scale_mm",
    RecedingHorizonSettings::<2>::DEFAULT.innovation_scale_mm,
    [1e-6, 1.0],
    None,
    "innovations of this size make the plan half as sharp: small is gentle, large builds on predictions that miss",
);
pub(super) const FORESEEN_MM: Parameter = Parameter::number(
    "foreseen_mm",
    RecedingHorizonSettings::<2>::DEFAULT.foreseen_mm,
    [1e-4, 10.0],
    None,
    "a miss by this some knots ahead makes the offset count as much as an error: large trusts a model that is wrong",
);
pub(super) const SOLVER_STEPS: Parameter = Parameter::whole(
    "steps",
    RecedingHorizonSettings::<2>::DEFAULT.steps,
    [1.0, 20.0],
    "steps of the solver in a tick: further ones hardly change anything",
);
pub(super) const ON_RAPIDS: Parameter = Parameter::switch(
    "on_rapids",
    RecedingHorizonSettings::<2>::DEFAULT.horizon.on_rapids,
    "whether rapids are corrected as cuts are",
);
// Parts of what the exact model calls for, and scales of its parameters.
/// Share of the velocity feedforward.
pub const VELOCITY_GAIN: Parameter =
    Parameter::number("velocity_gain", Gains::EXACT.velocity, [0.0, 10.0], Some([0.1, 1.5]), EXACT_REASON);
/// Share of the acceleration feedforward.
pub const ACCELERATION_GAIN: Parameter =
    Parameter::number("acceleration_gain", Gains::EXACT.acceleration, [0.0, 10.0], Some([0.0, 2.0]), EXACT_REASON);
/// Share of the friction feedforward.
pub const FRICTION_GAIN: Parameter =
    Parameter::number("friction_gain", Gains::EXACT.friction, [0.0, 10.0], Some([0.0, 4.0]), EXACT_REASON);
pub(super) const EXACT_REASON: &str =
    "1 is what the exact model calls for; another makes up for a model that is not exact";
