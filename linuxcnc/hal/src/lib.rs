//! The C interface of [`feedwright_servo`], of which `feedwright.h` is made: memory comes from the
//! caller, nothing is allocated, and a panic ends in a function of the caller, which does not come
//! back here.
//!
//! | Function | When |
//! |---|---|
//! | `feedwright_servo_*`, `feedwright_plant_*` ending in `_new` | once, before the thread runs |
//! | those ending in `_step` | once a servo period |
#![no_std]

pub mod servo;
pub mod plant;
pub mod following;
mod memory;

use core::panic::PanicInfo;

unsafe extern "C" {
    /// The caller's: where a panic ends. It must not return.
    pub fn feedwright_panicked() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: it takes nothing and does not come back.
    unsafe { feedwright_panicked() }
}
