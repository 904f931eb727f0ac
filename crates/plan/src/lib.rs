//! Plans how fast a machine tool moves along a program: path, feedrate, and events on a clock.
//!
//! A [`Plan`] is an iterator. It reads the motions of a program, builds exact curves by arc length,
//! and returns [`Phase`]s of constant jerk, with the events between them.
//!
//! ```
//! use feedwright_gcode::{Reader, Settings};
//! use feedwright_plan::{
//!     Constraints, FEED_PLANNERS, PathLimits, Pieces, Plan, Planned, Plc,
//! };
//!
//! let constraints = Constraints::from(&PathLimits {
//!     rapid_mm_s: 200.0,
//!     max_feed_mm_s: 100.0,
//!     tangential_accel_mm_s2: 500.0,
//!     normal_accel_mm_s2: 500.0,
//!     corner_jump_mm_s: 0.0,
//! });
//! let program = "G21 G90 F3000\nG1 X100\nM2\n";
//! let canon = Reader::from_text("line.ngc", program, Settings::default())?
//!     .collect::<Result<Vec<_>, _>>()?;
//! let steps = Box::new(Pieces::new(canon.into_iter()));
//!
//! let mut time_s = 0.0;
//! for planned in Plan::new(steps, &constraints, &FEED_PLANNERS[0], Plc::default())? {
//!     if let Planned::Phase(phase) = planned {
//!         time_s += phase.duration_s;
//!     }
//! }
//! // 100 mm at 50 mm/s, and 0.1 s for speeding up and slowing down at 500 mm/s2.
//! assert!((time_s - 2.1).abs() < 1e-9, "{time_s} s");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Main names
//!
//! | Topic | Names |
//! |---|---|
//! | Path | [`Pieces`], [`Piece`], [`Curve`], [`Steps`], [`Step`], [`PathError`] |
//! | Curves through points | [`ArcFit`], [`FitPoint`], [`FitMotion`] |
//! | Planned path beside the programmed one | [`PlannedPiece`], [`AlignedPaths`] |
//! | Limits | [`Constraints`], [`PathLimits`], [`AxisLimits`], [`SpeedCaps`], [`LimitsError`] |
//! | Feed planners | [`FEED_PLANNERS`], [`FeedPlanner`], [`FeedMember`], [`feed_planner`], [`TimeOptimal`], [`Trapezoid`] |
//! | Plan | [`Plan`], [`Planned`], [`Phase`], [`Span`], [`AxisMotion`], [`PlanSink`] |
//! | Events | [`Plc`], [`Durations`], [`PlcEvent`], [`TimedEvent`] |
//! | Feed override | [`TimeScaling`], [`ScalingLimits`], [`PublishedPlan`], [`shortest_stop_mm`] |
//!
//! The table [`FEED_PLANNERS`] lists what can be chosen for the speed along the path. Its first row
//! is the default.
//!
//! # Units
//!
//! Lengths are mm, times s, angles of rotary axes degrees; speeds, accelerations and jerks are in
//! mm/s, mm/s2 and mm/s3. Plan time (`tau_s`) begins at 0 s at the start of the program.
//!
//! # What is promised
//!
//! - Memory does not grow with the program: every planner has a bounded look-ahead.
//!   [`WHOLE_PROGRAM`] is the exception, and no row of the table.
//! - A path error ends the plan, and [`Plan::fault`] returns it. [`Plan::new`] refuses limits
//!   that are missing or out of range.
//! - The same program and the same limits give the same bits.
//!
//! # Layers
//!
//! The `mod` lines stand in the order in which data flows; each module uses only those above it.
//! `plc` says how long events take, `constraints` what the machine allows, `path` makes curves of
//! motions, `paired` has the planned path beside the programmed one, and `feed` plans the speed.

#![warn(clippy::disallowed_methods)]

pub mod vector;
mod plc;
mod constraints;
mod path;
mod paired;
mod feed;

pub use constraints::speed_caps::SpeedCaps;
pub use constraints::{AxisLimits, Constraints, LimitsError, PathLimits};
pub use feed::feed_override::{
    MOST_OVERRIDE, PublishedPlan, ScaledStep, ScalingLimits, TimeScaling, shortest_stop_mm,
};
pub use feed::plan::{KeptPlan, Plan, PlanSink, Planned};
pub use feed::sections::{Section, SectionPlanner};
pub use feed::time_optimal::{PlanCounts, TimeOptimal};
pub use feed::trapezoid::Trapezoid;
pub use feed::unlimited::Unlimited;
pub use feed::{
    AxisMotion, FEED_PLANNERS, FeedMember, FeedPlanner, Phase, Span, TimedEvent, WHOLE_PROGRAM,
    feed_mm_s, feed_planner,
};
pub use paired::aligned::AlignedPaths;
pub use paired::{PairedSteps, PlannedPiece, ProgrammedPart};
pub use path::arc::Arc;
pub use path::arc_fit::{ArcFit, FitMotion, FitPoint};
pub use path::pieces::Pieces;
pub use path::smooth::{Jet, Parametric, Smooth};
pub use path::{Curve, MIN_FEED_MM_S, PathError, Piece, Point, Step, Steps, signed_distance_mm};
pub use plc::{Durations, EventName, Plc, PlcEvent, named};
