//! What runs in a servo thread: reference window, contour error, identifier, inversion, controllers.
//!
//! Nothing here allocates, panics, locks, reads a clock or does I/O in a tick, and the same input gives the same bits.
#![no_std]
