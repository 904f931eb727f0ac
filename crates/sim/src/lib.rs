//! Simulates how a machine tool cuts a program, servo period by servo period, and measures the
//! contour error.
//!
//! A [`Run`] joins the stages: it plans the path of a program, puts a controller in the loop with
//! the simulated machine, and hands one [`Row`] per servo period to each [`Sink`]. The example cuts
//! a circle without a correction.
//!
//! ```
//! use feedwright_control::Uncorrected;
//! use feedwright_gcode::{Reader, Settings};
//! use feedwright_sim::{Machine, Outcome, Row, Run, path_steps};
//!
//! let machine = Machine::load("tnv40".as_ref())?;
//! let program = "G17 G21 G90 F3000\nG2 X0 Y0 I10 J0\nM2\n";
//! let canon = Reader::from_text("circle.ngc", program, Settings::default())?
//!     .collect::<Result<Vec<_>, _>>()?;
//! let steps = path_steps(canon).collect::<Result<Vec<_>, _>>()?;
//!
//! let mut rows: Vec<Row> = Vec::new();
//! let result = Run::on(&machine).cut_steps::<2>(&steps, &mut Uncorrected, &mut [&mut rows])?;
//! assert_eq!(result.outcome, Outcome::Completed);
//!
//! let cutting = rows.iter().filter(|row| row.cutting);
//! let largest_um = cutting.map(|row| 1e3 * row.contour_error_mm.abs()).fold(0.0, f64::max);
//! println!("largest contour error: {largest_um:.1} um in {:.2} s", result.time_s);
//! assert!((20.0..40.0).contains(&largest_um), "{largest_um} um");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A `Vec<Row>` is a sink that keeps every row. [`TraceWriter`] writes the rows as CSV instead.
//!
//! # Main names
//!
//! | Topic | Names |
//! |---|---|
//! | Run | [`Run`], [`RunResult`], [`RunError`], [`Stages`], [`path_steps`], [`BoxedController`] |
//! | Rows | [`Sink`], [`Row`], [`Commanded`], [`Outcome`], [`FadedOut`], [`Transition`], [`CorrectionChange`] |
//! | CSV | [`TraceWriter`], [`SetpointWriter`] |
//! | Machine files | [`Machine`], [`Axis`], [`Limits`], [`Period`], [`Transmission`], [`Noise`], [`MachineError`] |
//! | Geometry files | [`GeometryFile`], [`GeometryCheck`], [`GeometryRefused`], [`MeasuredSet`] |
//! | Built-in machines | [`BUILT_IN_MACHINES`], [`DEFAULT_MACHINE`] |
//! | What a controller may know | [`Known`], [`KnownAxis`] |
//! | Plant | [`Plant`], [`Measurement`]; another one in its place: [`Mechanism`], [`PlantMaker`] |
//! | Reference | [`Reference`], [`Sample`], [`Foot`] |
//! | Progress and cancellation | [`Watch`], [`StageSteps`], [`Cancelled`] |
//!
//! [`Machine::load`] takes the name of a built-in machine or the path of a machine file;
//! [`Machine::parse`] takes the text of one.
//!
//! # Units
//!
//! Lengths are mm, times s, feedrates mm/s, torques N m. Names carry the unit: `_mm`, `_mm_s`,
//! `_um`, `_nm`, `_rad`. In the plane the contour error is signed; in space it is a distance.
//!
//! # What is promised
//!
//! - A simulation is deterministic: the seed of the machine's [`Noise`] decides all random
//!   numbers, and [`Machine::with_noise_seed`] draws others.
//! - Memory does not grow with the program where the steps are read as a stream ([`Run::cut`])
//!   and the sink keeps no rows.
//! - A servo loop that is unstable ends the run with [`Outcome::Diverged`].
//! - A machine file is checked as a whole: [`MachineError`] names every fault in it.
//!
//! # Layers
//!
//! The `mod` lines stand in the order in which data flows; each module uses only those above it.
//! `machine` reads machine files, `geometry_file` measured geometry, `reference` looks the plan up
//! by time, `plant` is the simulated machine, `row` has the rows and `trace` writes them, `simulate`
//! closes the loop, `boxed_controller` holds a controller of two or three axes, `pipeline` joins all
//! stages, and `cycle_time` looks at a plan.

#![warn(clippy::disallowed_methods)]

mod parallel;
mod watch;
mod number;
pub mod toml_file;
mod machine;
mod geometry_file;
mod kinematics;
mod known_geometry;
mod reference;
mod plant;
mod row;
mod trace;
mod simulate;
mod boxed_controller;
mod pipeline;
pub mod cycle_time;

pub use boxed_controller::BoxedController;
pub use geometry_file::check::{CHECK_ERROR_RATE, GeometryCheck, GeometryRefused};
pub use geometry_file::least_squares::{RankedLeastSquares, f_exceeded};
pub use geometry_file::observation::{MeasuredPlace, MeasuredSet, NUISANCES, Observation};
pub use geometry_file::{AxisGeometry, GeometryFile, GeometryOrigin, MeasuredSquareness};
pub use kinematics::joints_of;
pub use known_geometry::CompensationError;
#[doc(hidden)]
pub use machine::keys as machine_keys;
pub use machine::{
    AXIS_NAMES, Axis, BUILT_IN_MACHINES, DEFAULT_MACHINE, Known, KnownAxis, Limits, MACHINE_FORMAT,
    Machine, MachineError, Noise, Period, Squareness, Transmission, is_machine_path,
};
pub use number::{fixed, rounded, shown, significant, to_four_digits, trimmed};
pub use parallel::map_in_parallel;
pub use pipeline::{PlanCache, Run, RunError, Stages, path_steps};
pub use plant::{Measurement, Mechanism, Plant};
pub use reference::{Foot, Reference, Sample};
pub use row::{Commanded, CorrectionChange, FadedOut, Outcome, Row, Sink, Transition};
pub use simulate::foot::settled_s;
pub use simulate::uncut::Uncut;
pub use simulate::{PlantMaker, RunResult, Stopped};
pub use trace::{SetpointWriter, TraceWriter};
pub use watch::{Cancelled, StageSteps, Watch};
