//! Computes the position command of each servo period from the programmed path and the measured
//! tool position, and corrects the contour error with one of several controllers.
//!
//! The crate is `no_std`, so that the same code runs in a servo thread and in a simulation. The
//! example follows a circle uncorrected with two axes that lag by 20 ms, and reads the contour
//! error.
//!
//! ```
//! use feedwright_control::{Bounds, Controller, Knot, KnotSource, Uncorrected, Tick};
//!
//! /// A circle of 10 mm radius, run at 50 mm/s: 5 rad/s.
//! struct Circle;
//!
//! impl KnotSource<2> for Circle {
//!     fn knot(&mut self, tau_s: f64) -> Knot<2> {
//!         let (sin, cos) = (5.0 * tau_s).sin_cos();
//!         let position_mm = [10.0 * cos, 10.0 * sin];
//!         Knot { position_mm, tangent: [-sin, cos], feed_mm_s: 50.0, cutting: true }
//!     }
//! }
//!
//! let mut controller = Uncorrected;
//! let schedule = Controller::<2>::schedule(&controller);
//! let mut tick = Tick::new(0.001, schedule, Bounds::new(1.0, 400.0, 1000.0));
//! let mut tool_mm = [10.0, 0.0];
//! for _ in 0..1000 {
//!     let setpoint = tick.step(&mut Circle, &mut controller, tool_mm);
//!     for axis in 0..2 {
//!         tool_mm[axis] += 0.05 * (setpoint.command_mm[axis] - tool_mm[axis]);
//!     }
//! }
//! // The tool cuts inside the circle, which it runs counterclockwise: the path is on its right.
//! let error_mm = tick.contour().signed_mm();
//! assert!((-0.06..-0.04).contains(&error_mm), "{error_mm} mm");
//! ```
//!
//! A [`Feedforward`] in place of [`Uncorrected`] leads the command by what the axes lag.
//!
//! # Main names
//!
//! | Topic | Names |
//! |---|---|
//! | One servo period | [`Tick`], [`Setpoint`] |
//! | The path | [`KnotSource`], [`Knot`], [`Window`], [`Register`], [`Preview`] |
//! | Geometry | [`KnownGeometry`], [`AxisErrors`], [`ErrorTable`] |
//! | Contour error | [`ContourError`], [`Estimator`] |
//! | Controllers | [`Controller`], [`Schedule`], [`Measured`], [`Command`], [`SelfReport`] |
//! | Making one | [`AnyController`], [`MemberName`], [`Member`], [`ControllerData`], [`ControllerRow`], [`Parameter`] |
//! | Members | [`Uncorrected`], [`Feedforward`], [`MagnitudeOnly`], [`TwoDimensional`], [`LqgIdentified`] |
//! | Supervisor | [`Bounds`], [`State`], [`Fade`], [`Cause`], [`Verdict`] |
//! | Model of an axis | [`AxisModel`], [`AxisState`], [`Parameters`], [`Number`], [`AxisInverse`] |
//! | Trained models | [`ContourIdentifier`], [`IdentifiedAxes`], [`TrainedModel`], [`ModelBlock`] |
//!
//! [`ModelBlock::from_bytes`] reads a trained model from bytes, so that a servo thread needs no
//! file.
//!
//! # Units
//!
//! Lengths are mm, times s, feedrates mm/s, torques N m. `N` is the number of axes, 2 or 3. Plan
//! time (`tau_s`) is the time at which the plan reaches a point; it runs slower than time where a
//! controller lowers the rate.
//!
//! # What is promised
//!
//! - A tick does not allocate, lock, read a clock or do I/O.
//! - A tick does not panic. `tests/conformance_panics.rs` links every controller without a panic
//!   handler.
//! - The time of a tick is bounded: the register and the preview have fixed sizes.
//! - The same input gives the same bits.
//! - The supervisor keeps every command within [`Bounds`]. It disengages a controller whose
//!   predictions fail, and the command returns to the path.
//!
//! # Layers
//!
//! The `mod` lines stand in the order in which data flows through a tick; each module uses only
//! those above it. `axis` is the model of an axis, `window` holds the path behind and ahead,
//! `geometry` leads from the tool to the joints, `contour_error` locates the tool on it,
//! `identifier` and `model` predict, `inversion` computes corrections, `supervisor` judges and
//! bounds what controllers ask for, `controller` has them, and `tick` joins all of it.
#![no_std]
#![warn(clippy::disallowed_methods)]

pub mod vector;
mod activation;
mod sine;
mod axis;
mod window;
mod geometry;
mod contour_error;
mod identifier;
mod model;
mod inversion;
mod command;
mod supervisor;
mod controller;
mod tick;

pub use axis::delays::{CommandQueue, MAX_COMMAND_PERIODS};
pub use axis::drive::{DriveModel, DriveReference, DriveState};
pub use axis::friction::FrictionModel;
pub use axis::inverse::{AxisInverse, Gains};
pub use axis::mechanics::{MechanicsModel, MechanicsState};
pub use axis::numbers::{Number, Parameters, Part, position_gains_1_s};
pub use axis::transmission::{TableState, TransmissionModel};
pub use axis::{AxisModel, AxisState, Periods, friction_signs};
pub use command::{Command, Measured, SelfReport, Verdict};
pub use contour_error::{ContourError, Estimator, MAX_ENTRIES, carried};
pub use controller::feedforward::{
    ACCELERATION_GAIN, FRICTION_GAIN, Feedforward, MAX_PREVIEW, VELOCITY_GAIN, preview,
};
pub use controller::inverting::{INVERSION_PERIOD_S, InvertingSettings};
pub use controller::lqg_identified::{IDENTIFIED_WEIGHT, LqgGains, LqgIdentified, LqgSettings};
pub use controller::magnitude_only::MagnitudeOnly;
pub use controller::row::{ControllerData, ControllerRow, Knows, Member, Parameter, Values};
pub use controller::two_dimensional::TwoDimensional;
pub use controller::uncorrected::Uncorrected;
pub use controller::{AnyController, Controller, MemberName, OffsetBounds, Schedule};
pub use geometry::{
    AxisErrors, ErrorTable, GeometryFault, KnownGeometry, MOST_SLOPE, TABLE_POINTS,
};
pub use identifier::contour::ContourIdentifier;
pub use identifier::{
    ContourModel, Delays, ERROR_SCALE_MM, FEED_PERIODS_S, FEED_SCALE_MM_S, HIDDEN, INPUTS,
    Identifier, IdentifierKind, Inputs, seen_feed,
};
pub use inversion::{Gradient, TimeTerm};
pub use model::{
    BLOCK_FORMAT, BlockError, IdentifiedAxes, MAX_MECHANICS_PER_SERVO, MAX_WEIGHT,
    MECHANICS_PERIODS_S, ModelBlock, RESPONSES_S, SERVO_PERIODS_S, Trained, TrainedModel,
};
pub use sine::sin;
pub use supervisor::{Bounds, Cause, FORGIVEN_S, Fade, State, fade_acceleration};
pub use tick::{Setpoint, Tick};
pub use window::{Knot, KnotSource, PREVIEW_KNOTS, Preview, REGISTER_KNOTS, Register, Window};
