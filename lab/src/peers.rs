//! The peers: published controllers, each in a file named after its method, and the table of all
//! controllers.
//!
//! | File | What |
//! |---|---|
//! | `peers/rows.rs` | the parameters of the rows |
//! | `peers/closed_loop.rs` | the closed loop of an axis, for the filter that inverts it |
//! | `peers/make.rs` | how each row is made from what is known of a machine |
//! | `peers/model_predictive.rs`, `peers/iterative_learning.rs` | those that are not fit for a servo thread |
//! | `peers/model_predictive/` | the horizon of the first, its solver, and what its model misses |

mod cross_coupled;
mod contour_compensation;
mod corner_contour;
mod constrained_feedrate;
mod fuzzy_feedrate;
mod cross_coupled_feedrate;
mod input_shaping;
mod zero_phase;
mod sum;
mod disturbance_rejection;
mod disturbance_observer;
mod kalman_disturbance;
mod h_infinity;
mod iterative_learning;
pub(crate) mod model_predictive;
#[cfg(test)]
mod fixture;
mod closed_loop;
mod make;
mod rows;

use feedwright::{
    ACCELERATION_GAIN, Controllers, Entry, FEEDFORWARD, FRICTION_GAIN, LQG_IDENTIFIED,
    MAGNITUDE_ONLY, TWO_DIMENSIONAL, UNCORRECTED, VELOCITY_GAIN, controller,
};
use feedwright_control::Schedule;
use rows::{
    ALLOWED, ALLOWED_FILTER, ALLOWED_SLOWEST, BANDWIDTH, BEHIND, COMPENSATION_FILTER,
    COMPENSATION_RATE, CONSTRAINED_ALLOWED, CONTROL_WEIGHT, CORNER_REACH, CROSS_COUPLED_KD,
    CROSS_COUPLED_KI, CROSS_COUPLED_KP, CUT_OFF_HZ, DRIFT, FUZZY_CHANGE, FUZZY_ERROR,
    FUZZY_SLOWEST, GAMMA_RATIO, INERTIA_SCALE, KNOTS, LAG_SCALE, LEAD_S, LEARNING_GAIN,
    PLAN_PERIOD_S, RATE_WEIGHT, SHAPED_DAMPING, SHAPED_FREQUENCY, SHAPER_IMPULSES, TORQUE_NOISE,
};

/// Schedule of a decision in every `servo_periods`, with `preview` feed periods ahead.
const fn deciding(servo_periods: u32, preview: u32) -> Schedule {
    Schedule {
        servo_periods,
        preview,
    }
}

/// Rows: name, summary, source, what it knows, laps, parameters, and how it is made.
macro_rules! peers {
    ($($row:ident = $name:literal, $summary:literal, $source:literal, $knows:ident, laps: $laps:literal, [$($parameter:expr),+], $make:path;)+) => {
        $(pub(crate) static $row: Entry =
            controller!($name, $summary, $source, $knows, laps: $laps, [$($parameter),+], |setup, values| $make(setup, values));)+
    };
}

peers! {
    CROSS_COUPLED = "cross-coupled",
        "PID control of the contour error, added to the command across the path",
        "Koren (1980); Srinivasan and Kulkarni (1990)",
        Nothing, laps: 1, [CROSS_COUPLED_KP, CROSS_COUPLED_KI, CROSS_COUPLED_KD],
        make::cross_coupled;
    CONTOUR_COMPENSATION = "contour-compensation",
        "the reference moved by the estimated contour error",
        "Lee and Jeon (1999)",
        Nothing, laps: 1, [COMPENSATION_RATE, COMPENSATION_FILTER],
        make::contour_compensation;
    FUZZY_FEEDRATE = "fuzzy-feedrate",
        "fuzzy rules on the contour error and its change, speed along the path only",
        "Tsai and others (1995), the feedrate alone",
        Nothing, laps: 1, [FUZZY_ERROR, FUZZY_CHANGE, FUZZY_SLOWEST],
        make::fuzzy_feedrate;
    FUZZY_H_INFINITY = "fuzzy-h-infinity",
        "H-infinity control of each axis, and fuzzy rules on the contour error for the feedrate",
        "Tsai and others (1995); Shaked and Theodor (1992)",
        ExactModel, laps: 1, [GAMMA_RATIO, DRIFT, FUZZY_ERROR, FUZZY_CHANGE, FUZZY_SLOWEST],
        make::fuzzy_h_infinity;
    CROSS_COUPLED_FEEDRATE = "cross-coupled-feedrate",
        "PID control of the contour error, and a feedrate that keeps it within what is allowed",
        "Chuang and Liu (1996)",
        Nothing, laps: 1, [ALLOWED, ALLOWED_FILTER, ALLOWED_SLOWEST, CROSS_COUPLED_KP, CROSS_COUPLED_KI, CROSS_COUPLED_KD],
        make::cross_coupled_feedrate;
    CORNER_CONTOUR = "corner-contour",
        "an additional reference contour at corners, from linear models of the axes",
        "Yang (1993)",
        ExactModel, laps: 1, [CORNER_REACH, VELOCITY_GAIN, ACCELERATION_GAIN],
        make::corner_contour;
    CONSTRAINED_FEEDRATE = "constrained-feedrate",
        "the feedrate of least time with a bounded contour error, by nonlinear programming on linear models of the axes",
        "Imamura and Kaufman (1989)",
        ExactModel, laps: 2, [CONSTRAINED_ALLOWED, ALLOWED_SLOWEST],
        make::constrained_feedrate;
    FEEDFORWARD_AS_DELIVERED = "feedforward-as-delivered",
        "velocity and acceleration feedforward as controls are delivered, set to each axis; nothing of friction",
        "Masory (1986); FF1 and FF2 of LinuxCNC",
        ExactModel, laps: 1, [VELOCITY_GAIN, ACCELERATION_GAIN],
        make::feedforward_as_delivered;
    FEEDFORWARD_CROSS_COUPLED = "feedforward-cross-coupled",
        "velocity, acceleration and friction feedforward, and PID control of the contour error behind it",
        "Masory (1986); Koren (1980); Koren and Lo (1992)",
        ExactModel, laps: 1, [VELOCITY_GAIN, ACCELERATION_GAIN, FRICTION_GAIN, BEHIND[0], BEHIND[1], BEHIND[2]],
        make::feedforward_cross_coupled;
    INPUT_SHAPING = "input-shaping",
        "the path shaped so that a resonance is not excited, and feedforward of it with the exact model",
        "Singer and Seering (1990)",
        ExactModel, laps: 1, [SHAPED_FREQUENCY, SHAPED_DAMPING, SHAPER_IMPULSES],
        make::input_shaping;
    ZERO_PHASE = "zero-phase",
        "zero phase error tracking control with the linear model of the machine",
        "Tomizuka (1987)",
        ExactModel, laps: 1, [LAG_SCALE, INERTIA_SCALE],
        make::zero_phase;
    ZERO_PHASE_FRICTION = "zero-phase-friction",
        "zero phase error tracking control, and feedforward of the Coulomb friction",
        "Tomizuka (1987); Armstrong-Helouvry, Dupont and Canudas de Wit (1994)",
        ExactModel, laps: 1, [LAG_SCALE, INERTIA_SCALE, FRICTION_GAIN],
        make::zero_phase_friction;
    DISTURBANCE_OBSERVER = "disturbance-observer",
        "velocity and acceleration feedforward, and an observer of friction and cutting force",
        "Ohnishi (1987)",
        ExactModel, laps: 1, [BANDWIDTH],
        make::disturbance_observer;
    KALMAN_DISTURBANCE = "kalman-disturbance",
        "velocity, acceleration and friction feedforward, and a Kalman filter whose disturbance is taken out",
        "Erkorkmaz and Altintas (2001)",
        ExactModel, laps: 1, [DRIFT, TORQUE_NOISE, FRICTION_GAIN],
        make::kalman_disturbance;
    MODEL_PREDICTIVE = "model-predictive",
        "contouring over 20 knots ahead with the exact model of the machine, solved to convergence",
        "Lam, Manzie and Good (2010)",
        ExactModel, laps: 1, [RATE_WEIGHT, KNOTS, PLAN_PERIOD_S],
        make::model_predictive;
    LQG_PREVIEW = "lqg-preview",
        "the limit: Kalman filter and linear-quadratic regulator with preview, by everything that can be known of the machine",
        "Anderson and Moore (1990)",
        Everything, laps: 1, [CONTROL_WEIGHT],
        make::lqg_preview;
    ITERATIVE_LEARNING_1 = "iterative-learning-1",
        "offsets learned from the contour error of the same part, 1 lap of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps, laps: 2, [LEARNING_GAIN, LEAD_S, CUT_OFF_HZ],
        make::iterative_learning;
    ITERATIVE_LEARNING_3 = "iterative-learning-3",
        "offsets learned from the contour error of the same part, 3 laps of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps, laps: 4, [LEARNING_GAIN, LEAD_S, CUT_OFF_HZ],
        make::iterative_learning;
    ITERATIVE_LEARNING_10 = "iterative-learning-10",
        "offsets learned from the contour error of the same part, 10 laps of practice",
        "Arimoto, Kawamura and Miyazaki (1984)",
        EarlierLaps, laps: 11, [LEARNING_GAIN, LEAD_S, CUT_OFF_HZ],
        make::iterative_learning;
}

/// All controllers: those that a machine runs, and the peers.
pub const CONTROLLERS: Controllers = Controllers::new(&ROWS, RECORDED);

/// Recorded results of the laboratory's searches, a value of `RecordedSearch` on each line.
pub(crate) const RECORDED: &str = include_str!("compare/recorded.jsonl");

static ROWS: [&Entry; 24] = [
    &UNCORRECTED,
    &CROSS_COUPLED,
    &CONTOUR_COMPENSATION,
    &FUZZY_FEEDRATE,
    &FUZZY_H_INFINITY,
    &CROSS_COUPLED_FEEDRATE,
    &CORNER_CONTOUR,
    &CONSTRAINED_FEEDRATE,
    &FEEDFORWARD,
    &FEEDFORWARD_AS_DELIVERED,
    &FEEDFORWARD_CROSS_COUPLED,
    &INPUT_SHAPING,
    &ZERO_PHASE,
    &ZERO_PHASE_FRICTION,
    &DISTURBANCE_OBSERVER,
    &KALMAN_DISTURBANCE,
    &MODEL_PREDICTIVE,
    &LQG_PREVIEW,
    &ITERATIVE_LEARNING_1,
    &ITERATIVE_LEARNING_3,
    &ITERATIVE_LEARNING_10,
    &MAGNITUDE_ONLY,
    &TWO_DIMENSIONAL,
    &LQG_IDENTIFIED,
];
