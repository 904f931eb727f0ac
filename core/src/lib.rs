//! feedwright reads a G-code program and a machine file, predicts what the machine will really cut, and corrects the
//! commanded feedrate, speed and geometry, so that the part comes out more accurate and sooner.
//!
//! Millimetres, seconds, radians and newton-metres everywhere; inches and mm/min end in [`gcode`].
//!
//! The modules stand in the order in which data flows; each uses only those above it.

mod vector;
mod spectrum;
pub mod average;
pub mod watch;
pub mod kinematics;
pub mod number;
pub use feedwright_gcode as gcode;
pub mod toml_file;
pub mod machine;
pub mod plc;
pub mod constraints;
pub mod path;
pub mod blend;
pub mod feed;
pub mod reference;
pub mod plant;
pub mod trace;
pub mod output;
mod checked_json;
pub mod journal;
pub mod simulate;
pub mod pipeline;
pub mod excite;
pub mod log;
pub mod measured;
pub mod cycle_time;
pub mod override_time;
pub mod fastest;
pub mod identify;
pub mod model;
pub mod controllers;
pub mod report;
mod job_error;
pub mod correct;
pub mod job;
pub mod contour_program;
pub mod log_job;
pub mod paper;
pub mod held_out;
pub mod compare;
pub mod never_worse;
