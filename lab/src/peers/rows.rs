//! Parameters of the rows of the laboratory: default, allowed range, searched range, reason.

use feedwright::Parameter;
use feedwright_control::LqgSettings;

use super::kalman_disturbance::AxisNoise;
use super::model_predictive::horizon::{HorizonSettings, MAX_KNOTS};
use super::{
    constrained_feedrate, contour_compensation, cross_coupled, cross_coupled_feedrate,
    disturbance_observer, fuzzy_feedrate, h_infinity, input_shaping, iterative_learning,
};

macro_rules! parameters {
    ($($name:ident = $kind:ident($($argument:expr),+);)+) => {
        $(pub(super) const $name: Parameter = Parameter::$kind($($argument),+);)+
    };
}

const EXACT_REASON: &str =
    "1 is what the exact model calls for; another makes up for a model that is not exact";
const PID: cross_coupled::Settings = cross_coupled::Settings::DEFAULT;
const BY_ERROR: cross_coupled_feedrate::Settings = cross_coupled_feedrate::Settings::DEFAULT;
const FUZZY: fuzzy_feedrate::Settings = fuzzy_feedrate::Settings::DEFAULT;
const SHAPED: input_shaping::Settings = input_shaping::Settings::DEFAULT;
const LEARNED: iterative_learning::Settings = iterative_learning::Settings::DEFAULT;
const HORIZON: HorizonSettings<2> = HorizonSettings::DEFAULT;

parameters! {
    // Of the limit.
    CONTROL_WEIGHT = number("control_weight_s2", LqgSettings::DEFAULT.control_weight_s2, [1e-12, 1e-2], Some([1e-11, 1e-3]),
        "weight of the reference speed against the error, s^2: a low one rings between servo periods, a high one leaves the error");
    // Of cross-coupled control. Beyond the gains that the reasons name the loop is still stable on
    // smooth paths, but catches the tool in acute corners; what a machine can bear differs.
    CROSS_COUPLED_KP = number("kp", PID.kp, [0.0, 100.0], Some([0.1, 60.0]),
        "gain of the contour error: more corrects more; beyond 8 the tool is caught in acute corners");
    CROSS_COUPLED_KI = number("ki_1_s", PID.ki_1_s, [0.0, 1e5], Some([0.1, 1e4]),
        "gain of its integral: 0 leaves a part of a steady error; beyond 400 the tool is caught in acute corners");
    CROSS_COUPLED_KD = number("kd_s", PID.kd_s, [0.0, 1.0], Some([1e-5, 0.5]),
        "gain of its derivative, which damps: beyond 0.03 the tool is caught in acute corners");
    // Of zero phase.
    LAG_SCALE = number("lag_scale", 1.0, [0.01, 10.0], Some([0.1, 1.5]), EXACT_REASON);
    INERTIA_SCALE = number("inertia_scale", 1.0, [0.01, 10.0], Some([0.2, 3.0]), EXACT_REASON);
    // Of the reference that the error moves.
    COMPENSATION_RATE = number("rate_1_s", contour_compensation::Settings::DEFAULT.rate_1_s, [0.0, 1e4], Some([1.0, 3000.0]),
        "how fast the reference follows the error: small is late, large swings");
    COMPENSATION_FILTER = number("filter_s", contour_compensation::Settings::DEFAULT.filter_s, [1e-5, 10.0], Some([1e-4, 0.1]),
        "time constant of the filter on the error: long takes out noise, and is late");
    // Of the feedrate that adapts to the contour error.
    ALLOWED = number("allowed_mm", BY_ERROR.allowed_mm, [1e-5, 10.0], Some([1e-4, 0.1]),
        "contour error that is allowed: a small one slows down for every error, a large one for none");
    ALLOWED_FILTER = number("filter_s", BY_ERROR.filter_s, [1e-4, 10.0], Some([2e-3, 1.0]),
        "time constant of the estimate of the error: short follows its noise, long is late at curves");
    ALLOWED_SLOWEST = number("slowest", BY_ERROR.slowest, [0.1, 1.0], Some([0.2, 1.0]),
        "slowest it may run, as a part of the planned feedrate");
    // Of the feedrate that is planned for a contour error.
    CONSTRAINED_ALLOWED = number("allowed_mm", constrained_feedrate::Settings::DEFAULT.allowed_mm, ALLOWED.allowed, ALLOWED.searched,
        "contour error that the plan allows by its linear model: a small one is slow everywhere, a large one changes nothing");
    // Of the additional contour at corners.
    CORNER_REACH = number("reach_s", 0.05, [0.005, 0.1], Some([0.005, 0.1]),
        "time to either side of a corner in which the addition has its whole weight: a short one begins while the axis still lags");
    // Of the fuzzy rules.
    FUZZY_ERROR = number("error_mm", FUZZY.error_mm, [1e-4, 10.0], Some([0.002, 0.2]),
        "contour error that counts as large: small slows down for every error, large for none");
    FUZZY_CHANGE = number("change_mm_s", FUZZY.change_mm_s, [1e-3, 1e3], Some([0.05, 20.0]),
        "change of the error that counts as large");
    FUZZY_SLOWEST = number("slowest", FUZZY.slowest, [0.05, 1.0], Some([0.2, 1.0]),
        "slowest it may run, as a part of the planned feedrate");
    // Of the H-infinity filter.
    GAMMA_RATIO = number("gamma_ratio", h_infinity::GAMMA_RATIO, [1.01, 100.0], Some([1.01, 20.0]),
        "worst case that is allowed, as a multiple of the least possible: near 1 the observer is fast and noisy, a large one is Kalman's");
    // Of the observers.
    BANDWIDTH = number("bandwidth_hz", disturbance_observer::BANDWIDTH_HZ, [0.0, 1000.0], Some([1.0, 1000.0]),
        "of the observer: low is late at every reversal, high hands on the noise of the encoder; from 500 on the observer \
         believes what it measures, and hardly changes");
    // Of the Kalman filter, in servo periods and against an encoder of 1 um: of all three noises the
    // ratios alone count.
    DRIFT = number("drift_mm_s", AxisNoise::DEFAULT.drift_mm_s, [1e-6, 1e4], Some([1e-3, 1e4]),
        "change of the disturbance: a small one is late at every reversal, a large one hands on the noise of the encoder; from 100 on \
         the filter believes what it measures, and hardly changes");
    TORQUE_NOISE = number("torque_noise_mm_s", AxisNoise::DEFAULT.torque_mm_s, [0.0, 100.0], Some([1e-4, 10.0]),
        "white part of the torque: what is put down to it is no disturbance");
    // Of the shaper.
    SHAPED_FREQUENCY = number("frequency_hz", SHAPED.frequency_hz, [5.0, 1000.0], Some([10.0, 500.0]),
        "of the resonance that is not excited: at 500 its impulses are a servo period apart, and shape nothing");
    SHAPED_DAMPING = number("damping_ratio", SHAPED.damping_ratio, [0.0, 0.9], Some([1e-3, 0.5]),
        "of that resonance: more makes the later impulses smaller");
    SHAPER_IMPULSES = whole("impulses", SHAPED.impulses as usize, [2.0, 3.0],
        "2 hit the frequency (ZV), 3 also what is near it (ZVD) and round the path by more");
    // Of the one that plans over a horizon.
    RATE_WEIGHT = number("rate_weight_s2", HORIZON.rate_weight, [0.0, 0.01], Some([1e-11, 1e-2]),
        "weight of the speed of the offset: below 1e-10 the plan rings from knot to knot, above 1e-4 nothing is corrected");
    KNOTS = whole("knots", HORIZON.knots, [1.0, MAX_KNOTS as f64],
        "knots of the horizon: fewer take less time in a tick, and see less of a corner ahead");
    PLAN_PERIOD_S = number("feed_period_s", 0.003, [1e-3, 0.012], None,
        "time between decisions: 2 ms is worse on a soft ball screw, 5 ms at every reversal");
    // Of the learning.
    LEARNING_GAIN = number("gain", LEARNED.gain, [0.0, 2.0], Some([0.1, 1.9]),
        "part of the error that a lap takes up: 0 learns nothing, 2 swings from lap to lap");
    LEAD_S = number("lead_s", LEARNED.lead_s, [0.0, 0.5], Some([2e-4, 0.05]),
        "time by which an offset comes before the error that it is for: the lag of the loop");
    CUT_OFF_HZ = number("cut-off_hz", LEARNED.cut_off_hz, [0.1, 1e4], Some([2.0, 400.0]),
        "frequency above which nothing is learned: beyond the bandwidth of the loop, learning grows noise");
}

// The same behind a feedforward, which leaves it a tenth of the error: on a noisy encoder next to
// no gain may be best.
pub(super) const BEHIND: [Parameter; 3] = [
    searched(CROSS_COUPLED_KP, [0.01, 60.0]),
    searched(CROSS_COUPLED_KI, [0.01, 1e4]),
    searched(CROSS_COUPLED_KD, [1e-6, 0.5]),
];

const fn searched(parameter: Parameter, range: [f64; 2]) -> Parameter {
    Parameter {
        searched: Some(range),
        ..parameter
    }
}
