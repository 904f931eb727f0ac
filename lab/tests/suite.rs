//! All tests of the laboratory in one binary: it links once, and uses every core to its end.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

#[path = "../../crates/feedwright/tests/common/browser.rs"]
mod browser;
#[path = "../../crates/feedwright/tests/common/command.rs"]
#[expect(dead_code, reason = "the other command needs more of it")]
mod command;
#[path = "../../crates/feedwright/tests/common/controller_list.rs"]
mod controller_list;
#[path = "../../crates/feedwright/tests/common/cut.rs"]
mod cut;
#[path = "../../crates/ident/tests/common/identification_log.rs"]
mod identification_log;
#[path = "../../crates/feedwright/tests/common/json_keys.rs"]
mod json_keys;
#[path = "../../crates/feedwright/tests/common/made_up_report.rs"]
mod made_up_report;
#[path = "../../crates/plan/tests/common/missing.rs"]
mod missing;
#[path = "../../crates/plan/tests/common/programs.rs"]
mod programs;
#[path = "../../crates/feedwright/tests/common/python.rs"]
mod python;
#[path = "../../crates/ident/tests/common/sweep.rs"]
mod sweep;

mod conformance_adaptation;
mod conformance_command;
mod conformance_compare;
mod conformance_controller_faults;
mod conformance_controllers;
mod conformance_feed_planners;
mod conformance_harmless;
mod conformance_identified_control;
mod conformance_independent;
mod conformance_mismatch;
mod conformance_never_worse;
mod conformance_pages_in_browser;
mod conformance_paper;
mod conformance_peers;
mod conformance_rows;
mod golden_noise_levels;
mod golden_tables;
mod oracle_contour_programs;
mod oracle_fastest;
mod oracle_feed;
mod oracle_independent_plant;
mod oracle_lqg;
mod oracle_margins;
mod oracle_resimulation;
mod oracle_riccati;
mod property_feed;
mod property_mismatch;
mod property_never_worse;
mod property_path;
mod property_reference;
mod property_servo_periods;
mod property_time_optimal;
mod property_unseen_machines;
mod regression;
