//! All tests of the control in one binary: it links once, and uses every core to its end.

mod conformance_panics;
mod oracle_riccati;
mod property_safety;
