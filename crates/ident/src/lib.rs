//! Identifies the axes of a machine tool: the program to cut, the log to read, and the model to
//! fit.
//!
//! The example identifies the x axis of a simulated machine. [`Excitation`] makes the machine cut
//! circles at random feedrates, and [`identify_axis`] fits inertia and friction to the commanded
//! and measured positions alone.
//!
//! ```
//! use feedwright_ident::{Excitation, identify_axis};
//! use feedwright_sim::Machine;
//!
//! let machine = Machine::load("tnv40".as_ref())?;
//! // 8 laps of the default 24 are enough without noise. The seed draws feedrates and offsets.
//! let excitation = Excitation { laps: 8, ..Excitation::axis_parameters(&machine) };
//! let (recording, _) = excitation.record::<2>(&machine, 1);
//!
//! let found = identify_axis(&recording, 0, &machine.known())?;
//! println!("{:?}, {:.3} um left", found.parameters, found.left_um);
//!
//! let true_kg_m2 = machine.axis(0).inertia_kg_m2;
//! let found_kg_m2 = found.parameters.inertia_kg_m2;
//! assert!((found_kg_m2 / true_kg_m2 - 1.0).abs() < 0.01, "{found_kg_m2} kg m2");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! For a real machine, [`excitation_program`] writes the G-code to cut, a recorder logs commanded
//! and actual positions, [`Log::read`] reads the log, and [`identify_machine`] fits the axes
//! without any setting of the drives.
//!
//! # Main names
//!
//! | Topic | Names |
//! |---|---|
//! | Program to cut, and its log on a simulated machine | [`excitation_program`], [`recorded_log`], [`ExciteOptions`], [`ExciteError`] |
//! | Logs | [`Log`], [`LogAxis`], [`LogFormat`], [`Columns`], [`LogFinding`], [`LogError`], [`Fitness`] |
//! | Real machine, from a log | [`identify_machine`], [`GreyBoxOptions`], [`FoundMachine`], [`FoundAxis`], [`ModelVerdict`], [`SearchBound`] |
//! | Simulated machine | [`Excitation`], [`Recording`] |
//! | Axis with known drive settings | [`identify_axis`], [`AxisEstimate`], [`NotIdentified`] |
//! | Models for controllers | [`train_axes`], [`TrainContour`], [`axis_statistics`] |
//! | Model files | [`Model`], [`Origin`], [`exact_block`] |
//! | Geometry from measurements | [`GeometryInput`], [`fit_geometry`], [`FoundGeometry`], [`Circularity`], [`comp_file`] |
//! | Geometry: programs, simulated bar | [`BallBarProgram`], [`GridProgram`], [`SimulatedBallBar`] |
//! | Numbers | [`Spectrum`], [`median_and_spread`], [`quadratic_mean`] |
//!
//! # Units
//!
//! Positions are mm and times s, whatever unit the log has. Parameters of an axis are at the motor
//! shaft: kg m2, N m, N m s/rad. Residual errors are in µm. Torque of a log stays in the unit of
//! the file ([`TorqueUnit`]).
//!
//! # What is promised
//!
//! - The same recording and the same seed give the same model, bit for bit.
//! - No function sees the simulated machine: each gets commands, measured positions and the
//!   settings of the drives.
//! - A log is recognized by its content. Every guess is a [`LogFinding`]; a log that cannot give
//!   a model is refused with a reason ([`LogError`]).
//! - A recording that does not determine a parameter is refused ([`NotIdentified`],
//!   [`NotFound`]).
//! - A log is held in memory as a whole.
//!
//! # Layers
//!
//! The `mod` lines stand in the order in which data flows; each module uses only those above it.
//! `average` and `spectrum` are numerical helpers, `log` reads logs, `excite` writes the program
//! that excites a machine, `identify` fits, `model` reads and writes model
//! files, and `geometry` finds the errors that no encoder sees.

#![warn(clippy::disallowed_methods)]

mod average;
mod spectrum;
mod log;
mod excite;
mod identify;
mod model;
mod geometry;

pub use average::{median_and_spread, quadratic_mean};
pub use excite::recorded::recorded_log;
pub use excite::{
    AxisExcitation, ExciteError, ExciteOptions, MotionPart, excitation_program, next_excitation,
};
pub use geometry::circularity::Circularity;
pub use geometry::comp_file::{comp_file, geometry_of_tables, sampled_table};
pub use geometry::fit::{FoundGeometry, fit_geometry};
pub use geometry::formats::GeometryInput;
pub use geometry::programs::{BallBarProgram, GridProgram};
pub use geometry::simulated::SimulatedBallBar;
pub use identify::Excitation;
pub use identify::axes::{AxisRecordings, TrainedAxes, train_axes};
pub use identify::axis_parameters::{AxisEstimate, NotIdentified, identify_axis};
pub use identify::axis_statistics::axis_statistics;
pub use identify::contour::{TrainContour, TrainedContour, Training};
pub use identify::grey_box::axis_facts::AxisFacts;
pub use identify::grey_box::found_axis::{FoundAxis, NumberSource};
pub use identify::grey_box::free_run_scores::{FreeRunErrors, HORIZONS};
pub use identify::grey_box::known_value::KnownValue;
pub use identify::grey_box::place_waves::{PlaceWave, PlaceWaves, place_waves};
pub use identify::grey_box::search_bound::SearchBound;
pub use identify::grey_box::terms::ModelTerm;
pub use identify::grey_box::verdict::ModelVerdict;
pub use identify::grey_box::{
    FoundMachine, GreyBoxOptions, NotFound, SERVO_MECHANICS, identify_machine, servo_period_s,
};
pub use identify::recording::Recording;
pub use log::columns::Columns;
pub use log::error::{Refusal, RefusalReason};
pub use log::{Fitness, Log, LogAxis, LogError, LogFinding, LogFormat, MAX_AXES, TorqueUnit};
pub use model::exact::exact_block;
pub use model::{Model, Origin, an_identifier, identifier_name};
pub use spectrum::{Spectrum, SpectrumSegments};
