//! All tests of the command and its library in one binary: it links once, and uses every core to
//! its end.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

#[path = "common/command.rs"]
mod command;
#[path = "common/controller_list.rs"]
mod controller_list;
#[path = "common/cut.rs"]
mod cut;
#[path = "../../ident/tests/common/identification_log.rs"]
mod identification_log;
#[path = "common/json_keys.rs"]
mod json_keys;
#[path = "../../gcode/tests/common/layers.rs"]
mod layers;
#[path = "common/made_up_report.rs"]
mod made_up_report;
#[path = "../../plan/tests/common/missing.rs"]
mod missing;
#[path = "common/python.rs"]
mod python;
#[path = "../../gcode/tests/common/source.rs"]
mod source;
#[path = "../../ident/tests/common/sweep.rs"]
mod sweep;

mod conformance_advise;
mod conformance_bad_input;
mod conformance_check;
mod conformance_check_formats;
mod conformance_command_line;
mod conformance_comments;
mod conformance_contrast;
mod conformance_correct;
mod conformance_correct_command;
mod conformance_documents;
mod conformance_drive_limits;
mod conformance_events;
mod conformance_excite;
mod conformance_fanuc_options;
mod conformance_fastest;
mod conformance_geometry;
mod conformance_geometry_command;
mod conformance_hidden_text;
mod conformance_identification;
mod conformance_identify_log;
mod conformance_job;
mod conformance_json;
mod conformance_layers;
mod conformance_learn;
mod conformance_linuxcnc_hardware;
mod conformance_linuxcnc_log;
mod conformance_linuxcnc_setup;
mod conformance_long_programs;
mod conformance_measured;
mod conformance_measured_run;
mod conformance_models;
#[cfg(has_page)]
mod conformance_open;
#[cfg(not(has_page))]
mod conformance_open_without_page;
mod conformance_outputs;
mod conformance_plan;
mod conformance_plan_inputs;
mod conformance_real_axes;
mod conformance_report_page;
mod conformance_results;
mod conformance_supply_chain;
mod conformance_sweep;
mod golden_gcode_mistakes;
mod golden_help;
mod golden_linuxcnc_setup;
mod oracle_contour_metric;
mod oracle_grey_box;
mod oracle_place_waves;
mod oracle_plant_terms;
mod property_correct;
mod property_identification;
mod property_linuxcnc_setup;
mod property_report;
