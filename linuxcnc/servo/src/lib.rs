//! What stands between the position command of a control and the drive: the path that is known
//! while the command is delayed, and the controller along it, under the supervisor of
//! `feedwright-control`. Beside it a simulated machine that takes the same commands.
//!
//! Nothing here allocates, panics, locks, reads a clock or does I/O in a servo period. Lengths in
//! mm, times in s.
#![no_std]
#![forbid(unsafe_code)]

pub mod through;
pub mod history;
pub mod plant;
pub mod machine;
pub mod following;
pub mod fading;
pub mod limits;
mod latch;
pub mod servo;
pub mod play_out;
pub mod compensation;
