//! All tests of the planners in one binary: it links once, and uses every core to its end.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

#[path = "../examples/gcode_compare/cut.rs"]
mod cut;
#[path = "common/linuxcnc.rs"]
mod linuxcnc;
#[path = "../examples/gcode_compare/listed.rs"]
mod listed;
#[path = "common/missing.rs"]
mod missing;
#[path = "common/rs274.rs"]
mod rs274;

mod oracle_linuxcnc_listed;
mod oracle_linuxcnc_programs;
mod oracle_parts;
