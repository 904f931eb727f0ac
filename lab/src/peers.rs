//! The peers: published controllers, each in a file named after its method, and the table of all
//! controllers.
//!
//! | File | What |
//! |---|---|
//! | `peers/closed_loop.rs` | the closed loop of an axis, for the filter that inverts it |
//! | `peers/make.rs` | how each row is made from what is known of a machine |
//! | `peers/model_predictive.rs`, `peers/iterative_learning.rs` | those that are not fit for a servo thread |
//! | `peers/model_predictive/` | the horizon of the first, its solver, and what its model misses |

mod cross_coupled;
mod contour_compensation;
mod corner_contour;
mod fuzzy_feedrate;
mod cross_coupled_feedrate;
mod constrained_feedrate;
mod input_shaping;
mod zero_phase;
#[cfg(test)]
mod fixture;
mod sum;
mod disturbance_rejection;
mod disturbance_observer;
mod kalman_disturbance;
mod h_infinity;
mod iterative_learning;
pub(crate) mod model_predictive;
mod closed_loop;
mod make;

use feedwright::{
    Controllers, Entry, FEEDFORWARD, LQG_IDENTIFIED, MAGNITUDE_ONLY, TWO_DIMENSIONAL, UNCORRECTED,
    controller,
};
use feedwright_control::{ACCELERATION_GAIN, FRICTION_GAIN, Schedule, VELOCITY_GAIN};

/// Schedule of a decision in every `servo_periods`, with `preview` feed periods ahead.
const fn deciding(servo_periods: u32, preview: u32) -> Schedule {
    Schedule {
        servo_periods,
        preview,
    }
}

/// PID control of the contour error, added to the command across the path.
pub(crate) static CROSS_COUPLED: Entry = controller!(
    "cross-coupled",
    "PID control of the contour error, added to the command across the path",
    "Koren (1980); Srinivasan and Kulkarni (1990)",
    Nothing,
    laps: 1,
    [cross_coupled::KP, cross_coupled::KI, cross_coupled::KD],
    |setup, values| make::cross_coupled(setup, values)
);

/// The reference moved by the estimated contour error.
pub(crate) static CONTOUR_COMPENSATION: Entry = controller!(
    "contour-compensation",
    "the reference moved by the estimated contour error",
    "Lee and Jeon (1999)",
    Nothing,
    laps: 1,
    [contour_compensation::RATE, contour_compensation::FILTER],
    |setup, values| make::contour_compensation(setup, values)
);

/// Fuzzy rules on the contour error and its change, speed along the path only.
pub(crate) static FUZZY_FEEDRATE: Entry = controller!(
    "fuzzy-feedrate",
    "fuzzy rules on the contour error and its change, speed along the path only",
    "Tsai and others (1995), the feedrate alone",
    Nothing,
    laps: 1,
    [fuzzy_feedrate::ERROR, fuzzy_feedrate::CHANGE, fuzzy_feedrate::SLOWEST],
    |setup, values| make::fuzzy_feedrate(setup, values)
);

/// H-infinity control of each axis, and fuzzy rules on the contour error for the feedrate.
pub(crate) static FUZZY_H_INFINITY: Entry = controller!(
    "fuzzy-h-infinity",
    "H-infinity control of each axis, and fuzzy rules on the contour error for the feedrate",
    "Tsai and others (1995); Shaked and Theodor (1992)",
    ExactModel,
    laps: 1,
    [h_infinity::GAMMA_RATIO, kalman_disturbance::DRIFT, fuzzy_feedrate::ERROR, fuzzy_feedrate::CHANGE, fuzzy_feedrate::SLOWEST],
    |setup, values| make::fuzzy_h_infinity(setup, values)
);

/// PID control of the contour error, and a feedrate that keeps it within what is allowed.
pub(crate) static CROSS_COUPLED_FEEDRATE: Entry = controller!(
    "cross-coupled-feedrate",
    "PID control of the contour error, and a feedrate that keeps it within what is allowed",
    "Chuang and Liu (1996)",
    Nothing,
    laps: 1,
    [cross_coupled_feedrate::ALLOWED, cross_coupled_feedrate::FILTER, cross_coupled_feedrate::SLOWEST, cross_coupled::KP, cross_coupled::KI, cross_coupled::KD],
    |setup, values| make::cross_coupled_feedrate(setup, values)
);

/// An additional reference contour at corners, from linear models of the axes.
pub(crate) static CORNER_CONTOUR: Entry = controller!(
    "corner-contour",
    "an additional reference contour at corners, from linear models of the axes",
    "Yang (1993)",
    ExactModel,
    laps: 1,
    [corner_contour::REACH, VELOCITY_GAIN, ACCELERATION_GAIN],
    |setup, values| make::corner_contour(setup, values)
);

/// The feedrate of least time with a bounded contour error, by nonlinear programming on linear
/// models of the axes.
pub(crate) static CONSTRAINED_FEEDRATE: Entry = controller!(
    "constrained-feedrate",
    "the feedrate of least time with a bounded contour error, by nonlinear programming on linear models of the axes",
    "Imamura and Kaufman (1989)",
    ExactModel,
    laps: 2,
    [constrained_feedrate::ALLOWED, cross_coupled_feedrate::SLOWEST],
    |setup, values| make::constrained_feedrate(setup, values)
);

/// Velocity and acceleration feedforward as controls are delivered, set to each axis; nothing of
/// friction.
pub(crate) static FEEDFORWARD_AS_DELIVERED: Entry = controller!(
    "feedforward-as-delivered",
    "velocity and acceleration feedforward as controls are delivered, set to each axis; nothing of friction",
    "Masory (1986); FF1 and FF2 of LinuxCNC",
    ExactModel,
    laps: 1,
    [VELOCITY_GAIN, ACCELERATION_GAIN],
    |setup, values| make::feedforward_as_delivered(setup, values)
);

/// Velocity, acceleration and friction feedforward, and PID control of the contour error behind it.
pub(crate) static FEEDFORWARD_CROSS_COUPLED: Entry = controller!(
    "feedforward-cross-coupled",
    "velocity, acceleration and friction feedforward, and PID control of the contour error behind it",
    "Masory (1986); Koren (1980); Koren and Lo (1992)",
    ExactModel,
    laps: 1,
    [VELOCITY_GAIN, ACCELERATION_GAIN, FRICTION_GAIN, cross_coupled::BEHIND_KP, cross_coupled::BEHIND_KI, cross_coupled::BEHIND_KD],
    |setup, values| make::feedforward_cross_coupled(setup, values)
);

/// The path shaped so that a resonance is not excited, and feedforward of it with the exact model.
pub(crate) static INPUT_SHAPING: Entry = controller!(
    "input-shaping",
    "the path shaped so that a resonance is not excited, and feedforward of it with the exact model",
    "Singer and Seering (1990)",
    ExactModel,
    laps: 1,
    [input_shaping::FREQUENCY, input_shaping::DAMPING, input_shaping::IMPULSES],
    |setup, values| make::input_shaping(setup, values)
);

/// Zero phase error tracking control with the linear model of the machine.
pub(crate) static ZERO_PHASE: Entry = controller!(
    "zero-phase",
    "zero phase error tracking control with the linear model of the machine",
    "Tomizuka (1987)",
    ExactModel,
    laps: 1,
    [zero_phase::LAG_SCALE, zero_phase::INERTIA_SCALE],
    |setup, values| make::zero_phase(setup, values)
);

/// Zero phase error tracking control, and feedforward of the Coulomb friction.
pub(crate) static ZERO_PHASE_FRICTION: Entry = controller!(
    "zero-phase-friction",
    "zero phase error tracking control, and feedforward of the Coulomb friction",
    "Tomizuka (1987); Armstrong-Helouvry, Dupont and Canudas de Wit (1994)",
    ExactModel,
    laps: 1,
    [zero_phase::LAG_SCALE, zero_phase::INERTIA_SCALE, FRICTION_GAIN],
    |setup, values| make::zero_phase_friction(setup, values)
);

/// Velocity and acceleration feedforward, and an observer of friction and cutting force.
pub(crate) static DISTURBANCE_OBSERVER: Entry = controller!(
    "disturbance-observer",
    "velocity and acceleration feedforward, and an observer of friction and cutting force",
    "Ohnishi (1987)",
    ExactModel,
    laps: 1,
    [disturbance_observer::BANDWIDTH],
    |setup, values| make::disturbance_observer(setup, values)
);

/// Velocity, acceleration and friction feedforward, and a Kalman filter whose disturbance is taken
/// out.
pub(crate) static KALMAN_DISTURBANCE: Entry = controller!(
    "kalman-disturbance",
    "velocity, acceleration and friction feedforward, and a Kalman filter whose disturbance is taken out",
    "Erkorkmaz and Altintas (2001)",
    ExactModel,
    laps: 1,
    [kalman_disturbance::DRIFT, kalman_disturbance::TORQUE_NOISE, FRICTION_GAIN],
    |setup, values| make::kalman_disturbance(setup, values)
);

/// Contouring over 20 knots ahead with the exact model of the machine, solved to convergence.
pub(crate) static MODEL_PREDICTIVE: Entry = controller!(
    "model-predictive",
    "contouring over 20 knots ahead with the exact model of the machine, solved to convergence",
    "Lam, Manzie and Good (2010)",
    ExactModel,
    laps: 1,
    [model_predictive::RATE_WEIGHT, model_predictive::KNOTS, model_predictive::PLAN_PERIOD_S],
    |setup, values| make::model_predictive(setup, values)
);

/// The limit: Kalman filter and linear-quadratic regulator with preview, by everything that can be
/// known of the machine.
pub(crate) static LQG_PREVIEW: Entry = controller!(
    "lqg-preview",
    "the limit: Kalman filter and linear-quadratic regulator with preview, by everything that can be known of the machine",
    "Anderson and Moore (1990)",
    Everything,
    laps: 1,
    [make::CONTROL_WEIGHT],
    |setup, values| make::lqg_preview(setup, values)
);

/// Offsets learned from the contour error of the same part, 1 lap of practice.
pub(crate) static ITERATIVE_LEARNING_1: Entry = controller!(
    "iterative-learning-1",
    "offsets learned from the contour error of the same part, 1 lap of practice",
    "Arimoto, Kawamura and Miyazaki (1984)",
    EarlierLaps,
    laps: 2,
    iterative_learning::PARAMETERS,
    |setup, values| make::iterative_learning(setup, values)
);

/// Offsets learned from the contour error of the same part, 3 laps of practice.
pub(crate) static ITERATIVE_LEARNING_3: Entry = controller!(
    "iterative-learning-3",
    "offsets learned from the contour error of the same part, 3 laps of practice",
    "Arimoto, Kawamura and Miyazaki (1984)",
    EarlierLaps,
    laps: 4,
    iterative_learning::PARAMETERS,
    |setup, values| make::iterative_learning(setup, values)
);

/// Offsets learned from the contour error of the same part, 10 laps of practice.
pub(crate) static ITERATIVE_LEARNING_10: Entry = controller!(
    "iterative-learning-10",
    "offsets learned from the contour error of the same part, 10 laps of practice",
    "Arimoto, Kawamura and Miyazaki (1984)",
    EarlierLaps,
    laps: 11,
    iterative_learning::PARAMETERS,
    |setup, values| make::iterative_learning(setup, values)
);

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
