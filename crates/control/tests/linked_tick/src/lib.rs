//! The servo period of every controller in two and three axes, and the reading of a model, linked
//! without the standard library.
//!
//! The panic handler calls a function that does not exist. Where no panic is left in what is
//! exported, the linker drops the handler with all that it needs; otherwise it has to name that
//! function.

#![no_std]

use core::panic::PanicInfo;
use feedwright_control::{AnyController, Knot, KnotSource, KnownGeometry, ModelBlock, Tick};

unsafe extern "C" {
    fn a_panic_is_left_in_the_tick() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: there is nothing to call: the linker refuses.
    unsafe { a_panic_is_left_in_the_tick() }
}

/// The planned path comes from outside, of which the compiler knows nothing.
struct Foreign<const N: usize>(extern "C" fn(f64, &mut Knot<N>));

impl<const N: usize> KnotSource<N> for Foreign<N> {
    fn knot(&mut self, tau_s: f64) -> Knot<N> {
        let mut knot = Knot { position_mm: [0.0; N], tangent: [0.0; N], feed_mm_s: 0.0, cutting: true };
        (self.0)(tau_s, &mut knot);
        knot
    }
}

macro_rules! servo_periods {
    ($($name:ident: $axes:literal;)*) => {
        $(
            /// A servo period of each controller of the table.
            #[unsafe(no_mangle)]
            pub extern "C" fn $name(
                tick: &mut Tick<$axes>,
                controller: &mut AnyController<$axes>,
                reference: extern "C" fn(f64, &mut Knot<$axes>),
                position_mm: &[f64; $axes],
                command_mm: &mut [f64; $axes],
            ) {
                *command_mm = tick.step(&mut Foreign(reference), &mut **controller, *position_mm).command_mm;
            }
        )*
    };
}

servo_periods! {
    controllers_2: 2;
    controllers_3: 3;
}

macro_rules! models {
    ($($name:ident: $axes:literal;)*) => {
        $(
            /// Reads a model from `length` bytes. Returns whether they hold a valid model.
            ///
            /// # Safety
            /// `bytes` points to `length` readable bytes.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn $name(bytes: *const u8, length: usize, model: &mut ModelBlock<$axes>) -> bool {
                // SAFETY: as the caller promises.
                let bytes = unsafe { core::slice::from_raw_parts(bytes, length) };
                match ModelBlock::from_bytes(bytes) {
                    Ok(read) => *model = read,
                    Err(_) => return false,
                }
                true
            }
        )*
    };
}

models! {
    model_2: 2;
    model_3: 3;
}

/// Exports the conversion of a knot of the tool into the knot of the joints.
#[unsafe(no_mangle)]
pub extern "C" fn geometry_3(geometry: &KnownGeometry<3>, knot: &mut Knot<3>) {
    *knot = geometry.joint_knot(knot);
}

/// Panics for an index out of range.
#[cfg(feature = "one-panic")]
#[unsafe(no_mangle)]
pub extern "C" fn one_panic(values: &[f64; 4], i: usize) -> f64 {
    values[i]
}
