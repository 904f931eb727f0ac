//! The laboratory of feedwright: published methods, the comparison, held-out work, and the experiments of Lee, Cho and Jeon (2005).
//!
//! Nothing in the product depends on it. The command `feedwright-lab` starts from here, and the examples and studies of the
//! repository use it.

#![warn(clippy::disallowed_methods)]

pub mod peers;
pub mod butterfly;
pub mod contour;
pub mod contour_program;
pub mod journal;
pub mod held_out;
pub mod paper;
pub mod independent_plant;
pub mod compare;
pub mod never_worse;
pub mod mismatch;
pub mod independent;
pub mod command;

pub use compare::held_out_work::HeldOutSeeds;
pub use compare::overview::Claimed;
pub use compare::table::{ComparisonRow, each_once};
pub use compare::verdict::{LIMIT, Verdict};
pub use compare::{
    Comparison, ComparisonOptions, Finished, Knowledge, RowsStamp, Shard, Tuning, Workpiece, compare, journal_path,
    merged, page, work_on,
};
pub use contour::{CONTOURS, contour};
pub use contour_program::contour_program;
pub use held_out::Variant;
pub use held_out::machines::Class;
pub use journal::Journal;
pub use never_worse::SweepOptions;
pub use never_worse::cut::{Cutter, SweepRow};
pub use never_worse::generated::{Generated, draw, smallest};
pub use never_worse::program::{Length, SweepProgram};
pub use paper::{Numbers, Paper, experiment};
pub use peers::contour_compensation::ContourCompensation;
pub use peers::cross_coupled::CrossCoupled;
pub use peers::cross_coupled_feedrate::CrossCoupledFeedrate;
pub use peers::disturbance_rejection::{DisturbanceRejection, ObservedAxis, ObservedDrive};
pub use peers::fuzzy_feedrate::FuzzyFeedrate;
pub use peers::input_shaping::InputShaping;
pub use peers::kalman_disturbance::AxisNoise;
pub use peers::receding_horizon::{
    Accelerations, CommandedPeriod, CorrectionLimits, END_WEIGHT, GaussNewton, HorizonProblem, HorizonSettings,
    MAX_KNOTS, Predictor, RecedingHorizon, RecedingHorizonSettings, Sensitivity, Solver,
};
pub use peers::sum::Sum;
pub use peers::zero_phase::{Filter, SampledAxis, ZeroPhase};
pub use peers::{CONTROLLERS, HORIZON};
