//! Predicts the contour error of a G-code program on a CNC machine, and corrects feedrate, speed
//! and geometry of the command, so that the part is more accurate and done sooner.
//!
//! The example cuts the circle of 10 mm radius at 50 mm/s on the machine of the paper, without a
//! correction and with the default controller, which identifies the machine first. It needs no
//! file.
//!
//! ```
//! use feedwright::gcode::Program;
//! use feedwright::sim::{Machine, SetpointWriter};
//! use feedwright::{Job, write_html};
//!
//! let program = Program::from_text("circle.ngc", "G17 G21 G90 F3000\nG2 X0 Y0 I10 J0\nM2\n");
//! let mut job = Job::new(program, Machine::load("tnv40".as_ref())?);
//! job.request.tolerance_um = Some(10.0);
//!
//! let checked = job.check()?;
//! let mut setpoints = SetpointWriter::new(Vec::new(), checked.axes())?;
//! let outcome = checked.run(&mut [&mut setpoints], &())?;
//!
//! let [uncorrected, corrected] = &outcome.report.runs[..] else { panic!("two runs") };
//! for run in [uncorrected, corrected] {
//!     println!("{}: {:.2} um RMS", run.summary.controller, run.summary.rms_um);
//! }
//! assert!(corrected.summary.rms_um < 0.02 * uncorrected.summary.rms_um && outcome.within_tolerance);
//!
//! let mut page = Vec::new();
//! write_html(&mut page, &outcome.report)?;
//! let command_csv = setpoints.finish()?;
//! # assert!(page.starts_with(b"<!") && command_csv.len() > 10_000);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A program comes from a text or a file ([`gcode::Program`]), a machine from a name or
//! a text, and the rows go to [`sim::Sink`]s. Progress, cancellation and the clock are a
//! [`sim::Watch`]; `&()` has none of them. To make a corrected program for a control without
//! feedback, set [`Job::target`], or run a [`CorrectJob`] alone.
//!
//! # Main names
//!
//! | Topic | Names |
//! |---|---|
//! | Predict and compare | [`Job`], [`JobOutcome`], [`JobError`] |
//! | Corrected program for another control | [`CorrectJob`], [`CorrectOutcome`], [`TARGETS`] |
//! | Feedrate that holds a tolerance | [`AdviseJob`], [`Advice`], [`fastest()`], [`FastestPlan`] |
//! | Cycle time | [`cycle_time()`], [`CycleTime`] |
//! | Real machine, from a log | [`LogJob`], [`LogIdentified`], [`measured()`] |
//! | Controllers | [`CONTROLLERS`], [`Entry`], [`Setup`], [`Make`], [`Choices`], [`Setting`], [`controller!`] |
//! | Figures and page | [`Statistics`], [`Report`], [`RunSummary`], [`write_html`] |
//! | LinuxCNC | `LinuxcncSetup`, `LinuxcncWiring` |
//! | Files | `OutputFile`, `OutputFiles`, `OutputError` |
//!
//! The crate re-exports the stages that it joins: [`gcode`] reads programs, [`control`] has the
//! controllers, [`plan`] plans, [`sim`] simulates, and [`ident`] identifies machines.
//!
//! # Units
//!
//! Lengths are mm, times s, feedrates mm/s, angles radians, torques N m. Figures
//! give contour errors in µm. [`gcode`] converts programs in inches or mm/min.
//!
//! # What is promised
//!
//! - The same job predicts the same cut, bit for bit.
//! - Output files appear whole or not at all (`OutputFile`).
//! - [`Job`] and [`CorrectJob`] compare a correction with the uncorrected cut, and say whether it
//!   is worse ([`JobOutcome::is_of_use`]).
//! - A corrected program is read, planned and cut again before it is written.
//! - The mistakes of a program and of a machine file are reported with their lines before a cut
//!   starts.
//! - A prediction is as good as the machine file. Errors that the encoders cannot see stay in the
//!   part, unless the machine file or a geometry file states them.
//!
//! # Features
//!
//! - `command`, on by default: the command line (the binary `feedwright` and the module `command`).
//! - `files`, part of `command`: output files, and the cache of identified models.
//!
//! With `default-features = false` the library writes no file and reads neither clock nor
//! environment. It then builds for `wasm32-unknown-unknown`, where it needs nothing from outside.
//!
//! # Layers
//!
//! The `mod` lines stand in the order in which data flows; each module uses only those above it.
//! `output` writes files, `store` keeps finished work, `measured` compares a log with a cut,
//! `fastest` looks at plans, `controllers` is the table of controllers, `report` makes figures and
//! the page, `correct`, `job` and `log_job` are the jobs of the command line, and `linuxcnc_setup`
//! wires a configuration of LinuxCNC.

#![warn(clippy::disallowed_methods)]

pub use feedwright_control as control;
pub use feedwright_gcode as gcode;
pub use feedwright_ident as ident;
pub use feedwright_plan as plan;
pub use feedwright_sim as sim;

#[cfg(feature = "files")]
mod output;
mod store;
mod results_format;
mod identifier_cache;
mod measured;
#[cfg(feature = "command")]
mod override_time;
mod fastest;
mod controllers;
mod inches;
mod report;
#[cfg(feature = "command")]
mod results_diff;
mod log_job;
mod recorded_model;
mod job_error;
mod compensation;
mod correct;
mod request;
mod job;
#[cfg(feature = "command")]
mod machine_document;
#[cfg(feature = "files")]
mod linuxcnc_setup;
#[cfg(feature = "command")]
pub mod command;

pub use compensation::GeometryChoice;
pub use controllers::{
    BASELINE, BEST, CONTROLLERS, Choices, Controllers, Entry, FEEDFORWARD, LQG_IDENTIFIED,
    MAGNITUDE_ONLY, Make, ModelMisfit, Setting, Setup, TWO_DIMENSIONAL, UNCORRECTED,
};
pub use correct::advise::{Advice, AdviseJob, CutWay, ErrorPlace};
pub use correct::exported::{ExportedCut, ExportedFigures};
pub use correct::{
    CorrectJob, CorrectOutcome, OverrideVerdict, PredictedCut, TARGETS, TargetControl,
    deterministic,
};
pub use fastest::{FastestError, FastestPlan, fastest};
pub use feedwright_sim::cycle_time::{
    CycleTime, CycleTimeOptions, cycle_time, cycle_time_by, cycle_time_within,
};
pub use identifier_cache::identified;
pub use job::{CheckedJob, Guests, Job, JobError, JobOutcome};
#[cfg(feature = "files")]
pub use linuxcnc_setup::{HALLIB, LinuxcncSetup, LinuxcncSetupError};
pub use log_job::{
    LogIdentified, LogJob, LogJobError, following_figure, informative, machine_text, updated_text,
    write_json, write_page,
};
pub use measured::{MeasuredError, MeasuredLog, measured};
#[cfg(feature = "files")]
pub use output::{OutputError, OutputFile, OutputFiles};
pub use recorded_model::{RecordedModelError, built_in_lines, recorded_machine};
pub use report::figure::{
    COLORS, CaptionedFigure, Figure, LineStyle, Panel, Polyline, write_figure_page,
};
pub use report::harm::{CutErrors, ErrorChange, MAX_UM, RMS_UM, UNCUT_UM, harm};
pub use report::plain_page::{PagePart, write_foot, write_head, write_table_end, write_table_head};
pub use report::text::escaped;
pub use report::{
    Assumptions, DrawnLimits, ErrorSpectrum, FullCircle, LimitBand, PageUnits, ProgramLine, Report,
    ReportedRun, Role, Roundness, RunFacts, RunSummary, Series, Statistics, TimelineEvent,
    write_html, write_html_data, write_html_in,
};
pub use request::JobRequest;
pub use request::named::find_control;
pub use results_format::RESULTS_FORMAT;
pub use store::{KeptTexts, keep_in, key_of};
#[cfg(feature = "files")]
pub use store::{Store, cache_folder};
