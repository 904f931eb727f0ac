//! Parameters of the rows of the laboratory: ranges, defaults, reasons.

use feedwright_control::{LqgSettings, Parameter};

use super::kalman_disturbance::AxisNoise;
use super::model_predictive::horizon::{HorizonSettings, MAX_KNOTS};
use super::{
    constrained_feedrate, contour_compensation, cross_coupled, cross_coupled_feedrate,
    disturbance_observer, fuzzy_feedrate, h_infinity, input_shaping,
};

// Of the limit.
pub(super) const CONTROL_WEIGHT: Parameter = Parameter::number(
    "control_weight_s2",
    LqgSettings::DEFAULT.control_weight_s2,
    [1e-12, 1e-2],
    Some([1e-11, 1e-3]),
    "weight of the reference speed against the error, s^2: a low one rings between servo periods, a high one leaves the error",
);
// Of cross-coupled control. Beyond the gains that the reasons name the loop is still stable on
// smooth paths, but catches the tool in acute corners; what a machine can bear differs.
pub(super) const CROSS_COUPLED_KP: Parameter = Parameter::number(
    "kp",
    cross_coupled::Settings::DEFAULT.kp,
    [0.0, 100.0],
    Some([0.1, 60.0]),
    "gain of the contour error: more corrects more; beyond 8 the tool is caught in acute corners",
);
pub(super) const CROSS_COUPLED_KI: Parameter = Parameter::number(
    "ki_1_s",
    cross_coupled::Settings::DEFAULT.ki_1_s,
    [0.0, 1e5],
    Some([0.1, 1e4]),
    "gain of its integral: 0 leaves a part of a steady error; beyond 400 the tool is caught in acute corners",
);
pub(super) const CROSS_COUPLED_KD: Parameter = Parameter::number(
    "kd_s",
    cross_coupled::Settings::DEFAULT.kd_s,
    [0.0, 1.0],
    Some([1e-5, 0.5]),
    "gain of its derivative, which damps: beyond 0.03 the tool is caught in acute corners",
);
// The same behind a feedforward, which leaves it a tenth of the error: on a noisy encoder next to
// no gain may be best.
pub(super) const BEHIND_KP: Parameter = Parameter {
    searched: Some([0.01, 60.0]),
    ..CROSS_COUPLED_KP
};
pub(super) const BEHIND_KI: Parameter = Parameter {
    searched: Some([0.01, 1e4]),
    ..CROSS_COUPLED_KI
};
pub(super) const BEHIND_KD: Parameter = Parameter {
    searched: Some([1e-6, 0.5]),
    ..CROSS_COUPLED_KD
};
pub(super) const LAG_SCALE: Parameter = Parameter::number(
    "lag_scale",
    1.0,
    [0.01, 10.0],
    Some([0.1, 1.5]),
    EXACT_REASON,
);
pub(super) const INERTIA_SCALE: Parameter = Parameter::number(
    "inertia_scale",
    1.0,
    [0.01, 10.0],
    Some([0.2, 3.0]),
    EXACT_REASON,
);
pub(super) const EXACT_REASON: &str =
    "1 is what the exact model calls for; another makes up for a model that is not exact";
// Of the reference that is moved by the error.
pub(super) const COMPENSATION_RATE: Parameter = Parameter::number(
    "rate_1_s",
    contour_compensation::Settings::DEFAULT.rate_1_s,
    [0.0, 1e4],
    Some([1.0, 3000.0]),
    "how fast the reference follows the error: small is late, large swings",
);
pub(super) const COMPENSATION_FILTER: Parameter = Parameter::number(
    "filter_s",
    contour_compensation::Settings::DEFAULT.filter_s,
    [1e-5, 10.0],
    Some([1e-4, 0.1]),
    "time constant of the filter on the error: long takes out noise, and is late",
);
// Of the disturbance observer.
pub(super) const OBSERVER_BANDWIDTH: Parameter = Parameter::number(
    "bandwidth_hz",
    disturbance_observer::BANDWIDTH_HZ,
    [0.0, 1000.0],
    Some([1.0, 1000.0]),
    "of the observer: low is late at every reversal, high hands on the noise of the encoder; from 500 on the observer \
     believes what it measures, and hardly changes",
);
// Of the feedrate that adapts to the contour error.
pub(super) const ALLOWED: Parameter = Parameter::number(
    "allowed_mm",
    cross_coupled_feedrate::Settings::DEFAULT.allowed_mm,
    [1e-5, 10.0],
    Some([1e-4, 0.1]),
    "contour error that is allowed: a small one slows down for every error, a large one for none",
);
pub(super) const ALLOWED_FILTER: Parameter = Parameter::number(
    "filter_s",
    cross_coupled_feedrate::Settings::DEFAULT.filter_s,
    [1e-4, 10.0],
    Some([2e-3, 1.0]),
    "time constant of the estimate of the error: short follows its noise, long is late at curves",
);
pub(super) const ALLOWED_SLOWEST: Parameter = Parameter::number(
    "slowest",
    cross_coupled_feedrate::Settings::DEFAULT.slowest,
    [0.1, 1.0],
    Some([0.2, 1.0]),
    "slowest it may run, as a part of the planned feedrate",
);
// Of the feedrate that is planned for a contour error.
pub(super) const CONSTRAINED_ALLOWED: Parameter = Parameter {
    default: constrained_feedrate::Settings::DEFAULT.allowed_mm,
    reason: "contour error that the plan allows by its linear model: a small one is slow everywhere, a large one changes nothing",
    ..ALLOWED
};
// Of the additional contour at corners.
pub(super) const CORNER_REACH: Parameter = Parameter::number(
    "reach_s",
    0.05,
    [0.005, 0.1],
    Some([0.005, 0.1]),
    "time to either side of a corner in which the addition has its whole weight: a short one begins while the axis still lags",
);
// Of the fuzzy rules.
pub(super) const FUZZY_ERROR: Parameter = Parameter::number(
    "error_mm",
    fuzzy_feedrate::Settings::DEFAULT.error_mm,
    [1e-4, 10.0],
    Some([0.002, 0.2]),
    "contour error that counts as large: small slows down for every error, large for none",
);
pub(super) const FUZZY_CHANGE: Parameter = Parameter::number(
    "change_mm_s",
    fuzzy_feedrate::Settings::DEFAULT.change_mm_s,
    [1e-3, 1e3],
    Some([0.05, 20.0]),
    "change of the error that counts as large",
);
pub(super) const FUZZY_SLOWEST: Parameter = Parameter::number(
    "slowest",
    fuzzy_feedrate::Settings::DEFAULT.slowest,
    [0.05, 1.0],
    Some([0.2, 1.0]),
    "slowest it may run, as a part of the planned feedrate",
);
// Of the H-infinity filter.
pub(super) const GAMMA_RATIO: Parameter = Parameter::number(
    "gamma_ratio",
    h_infinity::GAMMA_RATIO,
    [1.01, 100.0],
    Some([1.01, 20.0]),
    "worst case that is allowed, as a multiple of the least possible: near 1 the observer is fast and noisy, a large one is Kalman's",
);
// Of the Kalman filter, in servo periods and against an encoder of 1 um: of all three noises the
// ratios alone count.
pub(super) const DRIFT: Parameter = Parameter::number(
    "drift_mm_s",
    AxisNoise::DEFAULT.drift_mm_s,
    [1e-6, 1e4],
    Some([1e-3, 1e4]),
    "change of the disturbance: a small one is late at every reversal, a large one hands on the noise of the encoder; from 100 on \
     the filter believes what it measures, and hardly changes",
);
pub(super) const TORQUE_NOISE: Parameter = Parameter::number(
    "torque_noise_mm_s",
    AxisNoise::DEFAULT.torque_mm_s,
    [0.0, 100.0],
    Some([1e-4, 10.0]),
    "white part of the torque: what is put down to it is no disturbance",
);
// Of the shaper.
pub(super) const SHAPED_FREQUENCY: Parameter = Parameter::number(
    "frequency_hz",
    input_shaping::Settings::DEFAULT.frequency_hz,
    [5.0, 1000.0],
    Some([10.0, 500.0]),
    "of the resonance that is not excited: at 500 its impulses are a servo period apart, and shape nothing",
);
pub(super) const SHAPED_DAMPING: Parameter = Parameter::number(
    "damping_ratio",
    input_shaping::Settings::DEFAULT.damping_ratio,
    [0.0, 0.9],
    Some([1e-3, 0.5]),
    "of that resonance: more makes the later impulses smaller",
);
pub(super) const SHAPER_IMPULSES: Parameter = Parameter::whole(
    "impulses",
    input_shaping::Settings::DEFAULT.impulses as usize,
    [2.0, 3.0],
    "2 hit the frequency (ZV), 3 also what is near it (ZVD) and round the path by more",
);
// Of the one that plans over a horizon.
pub(super) const RATE_WEIGHT: Parameter = Parameter::number(
    "rate_weight_s2",
    HorizonSettings::<2>::DEFAULT.rate_weight,
    [0.0, 0.01],
    None,
    "weight of the speed of the offset: below 1e-10 the plan rings from knot to knot, above 1e-4 nothing is corrected",
);
pub(super) const KNOTS: Parameter = Parameter::whole(
    "knots",
    HorizonSettings::<2>::DEFAULT.knots,
    [1.0, MAX_KNOTS as f64],
    "knots of the horizon: fewer take less time in a tick, and see less of a corner ahead",
);
pub(super) const PLAN_PERIOD_S: Parameter = Parameter::number(
    "feed_period_s",
    0.003,
    [1e-3, 0.012],
    None,
    "time between decisions: 2 ms is worse on a soft ball screw, 5 ms at every reversal",
);
