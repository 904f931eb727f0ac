//! What runs in a servo thread: reference window, contour error, identifier, inversion, controllers.
//!
//! Nothing here allocates, panics, locks, reads a clock or does I/O in a tick; the time of a tick is bounded, and the same
//! input gives the same bits. That no panic is left is what `tests/conformance_panics.rs` shows. `N` is the number of axes
//! throughout, 2 or 3. Lengths in mm, times in s.
//!
//! The modules stand in the order in which data flows through a tick; each uses only those above it.
#![no_std]

pub mod vector;
pub mod activation;
pub mod sine;
pub mod least_squares;
pub mod axis;
pub mod window;
pub mod contour_error;
pub mod identifier;
pub mod model;
pub mod inversion;
pub mod horizon;
pub mod controller;
pub mod safety;
pub mod tick;

pub use controller::{Command, Controller, Measured, Schedule};
pub use tick::{Setpoint, Tick};
pub use window::{Knot, KnotSource, Window};
