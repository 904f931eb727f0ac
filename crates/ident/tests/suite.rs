//! All tests of the identification in one binary: it links once, and uses every core to its end.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

#[path = "common/logs.rs"]
mod logs;
#[path = "common/sweep.rs"]
mod sweep;

mod conformance_excite;
mod conformance_geometry;
mod conformance_log_refusals;
mod conformance_log_units;
mod conformance_logs;
mod conformance_scopes;
mod oracle_axis_parameters;
mod oracle_halsampler;
mod oracle_logs;
mod oracle_statistics;
mod property_logs;
mod regression;
