//! All tests of the reader in one binary: it links once, and uses every core to its end.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

#[path = "common/layers.rs"]
mod layers;
#[path = "common/source.rs"]
mod source;

mod conformance_corpus;
mod conformance_dialects;
mod conformance_fanuc;
mod conformance_fanuc_lathe;
mod conformance_fanuc_macros;
mod conformance_faults;
mod conformance_language;
mod conformance_layers;
mod conformance_program_flow;
mod oracle_lathe_cycles;
mod oracle_linuxcnc_expected;
mod oracle_linuxcnc_facts;
mod property_compensation;
mod property_fanuc;
mod property_fanuc_lathe;
mod property_lathe;
mod property_reader;
