//! The C interface of [`feedwright_servo`]; `feedwright.h` is generated from it. The caller
//! provides the memory, and nothing is allocated. A panic ends in a function of the caller, which
//! does not return.
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
    /// Function of the caller in which a panic ends. It must not return.
    pub fn feedwright_panicked() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: the function takes no argument and does not return.
    unsafe { feedwright_panicked() }
}
