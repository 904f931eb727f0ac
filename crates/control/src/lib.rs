//! What runs in a servo thread: reference window, contour error, identifier, inversion, controllers.
//!
//! Nothing here allocates, panics, locks, reads a clock or does I/O in a tick; the time of a tick is bounded, and the same
//! input gives the same bits. That no panic is left is what `tests/conformance_panics.rs` shows. `N` is the number of axes
//! throughout, 2 or 3. Lengths in mm, times in s.
//!
//! The modules stand in the order in which data flows through a tick; each uses only those above it.
#![no_std]

pub mod vector;
mod activation;
mod sine;
mod least_squares;
mod axis;
mod window;
mod contour_error;
mod identifier;
mod model;
mod inversion;
mod horizon;
mod controller;
mod safety;
mod tick;

pub use axis::drive::{DriveLaw, DriveParameters, DriveReference, DriveState};
pub use axis::friction::{FrictionLaw, FrictionParameters};
pub use axis::inverse::{AxisInverse, Gains, LoopDelays};
pub use axis::knowledge::{AxisKnowledge, Number};
pub use axis::mechanics::{MechanicsLaw, MechanicsState};
pub use axis::statistics::AxisStatistics;
pub use axis::transmission::{TableState, TransmissionLaw, TransmissionParameters};
pub use axis::{AxisLaw, AxisState, Parameters, Periods, friction_signs};
pub use contour_error::{ContourError, Estimator, MAX_ENTRIES, carried, locate};
pub use controller::feedforward::{Feedforward, MAX_PREVIEW, preview};
pub use controller::inverting::{INVERTING_FEED_PERIOD_S, InvertingSettings};
pub use controller::lqg_preview::{IDENTIFIED_PRICE, LqgGains, LqgPreview, LqgSettings, OffsetBounds};
pub use controller::magnitude_only::MagnitudeOnly;
pub use controller::open_loop::OpenLoop;
pub use controller::receding_horizon::{RECEDING_HORIZON_FEED_PERIOD_S, RecedingHorizon, RecedingHorizonSettings};
pub use controller::two_dimensional::TwoDimensional;
pub use controller::{Command, Controller, Measured, Schedule};
pub use horizon::gauss_newton::GaussNewton;
pub use horizon::problem::{END_WEIGHT, HorizonProblem};
pub use horizon::{
    Accelerations, CommandedPeriod, CorrectionLimits, HorizonSettings, MAX_KNOTS, OffsetPlan, Predictor, Sensitivity,
    Solver,
};
pub use identifier::adaptation::Spread;
pub use identifier::contour::ContourIdentifier;
pub use identifier::residual::{DisturbanceForecast, LAGS, Residual, ResidualSettings};
pub use identifier::servo::{FOLLOWING_SCALE_MM, ServoIdentifier};
pub use identifier::{
    ContourModel, Delays, ERROR_SCALE_MM, FEED_PERIODS_S, FEED_SCALE_MM_S, HIDDEN, INPUTS, Identifier, IdentifierKind,
    Inputs, ServoModel, UNKNOWNS, seen_feed,
};
pub use inversion::{Gradient, InversionSettings};
pub use model::{
    BLOCK_FORMAT, BlockError, IdentifiedAxes, MAX_MECHANICS_PER_SERVO, MAX_SPREAD, MAX_WEIGHT, MECHANICS_PERIODS_S,
    ModelBlock, SERVO_PERIODS_S, Trained,
};
pub use safety::{Bounds, Cause, Fade, State};
pub use sine::sin;
pub use tick::{Setpoint, Tick};
pub use window::{Knot, KnotSource, Preview, REGISTER_KNOTS, Register, Window};
