//! All tests of the control in one binary: it links once, and uses every core to its end.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

mod conformance_panics;
mod property_geometry;
mod property_supervisor;
