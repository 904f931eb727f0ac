//! All tests of the simulation in one binary: it links once, and uses every core to its end.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

#[path = "../../plan/tests/common/programs.rs"]
mod programs;

mod conformance_path_corpus;
mod conformance_planner_contract;
mod oracle_contour_error;
mod oracle_linuxcnc_planner;
mod oracle_plant_lag;
mod oracle_spline;
mod oracle_time_optimal;
mod property_feed_override;
mod property_linuxcnc_planner;
mod property_machines;
mod property_path_extremes;
mod property_plant;
