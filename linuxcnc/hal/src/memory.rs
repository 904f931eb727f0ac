//! Values of two or three axes in memory of the caller.

use core::ptr::NonNull;

/// A value for two or three axes.
pub(crate) enum TwoOrThree<A, B> {
    /// Two axes.
    Two(A),
    /// Three axes.
    Three(B),
}

/// Writes a value into memory of the caller. Returns false if the memory is too small, not aligned
/// or null.
///
/// # Safety
/// `memory` is null, or points to `bytes` bytes that nothing else uses.
pub(crate) unsafe fn put<T>(memory: *mut T, bytes: usize, make: impl FnOnce() -> T) -> bool {
    let Some(memory) = NonNull::new(memory) else {
        return false;
    };
    if bytes < size_of::<T>() || !memory.is_aligned() {
        return false;
    }
    // SAFETY: the memory is aligned and large enough.
    unsafe { memory.write(make()) };
    true
}

/// Returns the bytes of a model; empty if `bytes` is null.
///
/// # Safety
/// `bytes` is null, or points to `length` bytes.
pub(crate) unsafe fn model<'a>(bytes: *const u8, length: usize) -> &'a [u8] {
    if bytes.is_null() {
        return &[];
    }
    // SAFETY: as the caller promises.
    unsafe { core::slice::from_raw_parts(bytes, length) }
}

/// Returns the first N of three numbers.
pub(crate) fn first<const N: usize>(three: [f64; 3]) -> [f64; N] {
    core::array::from_fn(|i| three.get(i).copied().unwrap_or(0.0))
}

/// Returns N numbers as three, zero beyond.
pub(crate) fn three<const N: usize>(numbers: [f64; N]) -> [f64; 3] {
    core::array::from_fn(|i| numbers.get(i).copied().unwrap_or(0.0))
}
