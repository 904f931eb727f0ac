//! The laboratory of feedwright: published methods, the comparison, held-out work, and the
//! experiments of Lee, Cho and Jeon (2005).
//!
//! Nothing in the product depends on it. The command `feedwright-lab` starts from here, and the
//! examples and studies of the repository use it.

#![warn(clippy::disallowed_methods)]

mod peers;
mod butterfly;
mod contour;
mod contour_program;
mod limited;
mod study;
pub mod held_out;
mod paper;
pub mod independent_plant;
pub mod compare;
mod never_worse;
pub mod mismatch;
mod independent;
pub mod margins;
pub mod command;

pub use compare::held_out_work::HeldOutSeeds;
pub use compare::table::ComparisonRow;
pub use compare::verdict::Verdict;
pub use compare::{Comparison, ComparisonOptions, Knowledge, Tuning, Workpiece, compare};
pub use contour::{CONTOURS, CORNER, contour, motion};
pub use contour_program::contour_program;
pub use held_out::Variant;
pub use held_out::machines::Class;

pub use limited::{AXIS_LIMITS, LIMITED_FEED_MM_S, limited_machine, linear_machine};
pub use never_worse::SweepOptions;
pub use never_worse::cut::{Cutter, SweepRow};
pub use never_worse::generated::{Generated, draw};
pub use never_worse::program::{Length, SweepProgram};
pub use paper::{Numbers, Paper, experiment};
pub use peers::CONTROLLERS;
pub use peers::model_predictive::horizon::gauss_newton::GaussNewton;
pub use peers::model_predictive::horizon::problem::{END_WEIGHT, HorizonProblem};
pub use peers::model_predictive::horizon::{
    Accelerations, CommandedPeriod, CorrectionLimits, HorizonSettings, MAX_KNOTS, Predictor,
    Sensitivity,
};
pub use study::Kept;
