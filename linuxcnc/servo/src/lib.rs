//! What stands between the position command of a control and the drive: the path that is known while the command is delayed, the
//! correction along it, and the rules by which it comes and goes. Beside it a simulated machine that takes the same commands.
//!
//! Nothing here allocates, panics, locks, reads a clock or does I/O in a servo period. Lengths in mm, times in s.
#![no_std]
#![forbid(unsafe_code)]

pub mod history;
pub mod plant;
pub mod machine;
pub mod following;
mod law_proof;
pub mod trust;
pub mod live_controller;
pub mod correction;
pub mod fading;
pub mod limits;
pub mod play_out;
pub mod servo;
