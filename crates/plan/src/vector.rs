//! Vectors: what the servo thread's crate has for N axes, and what only three dimensions, or only
//! planning, need.

pub use feedwright_control::vector::{add_scaled, dot, norm, scale, sub};

/// Three components.
pub type Vector = [f64; 3];

/// Distance of two points.
#[inline]
pub fn distance<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    norm(sub(a, b))
}

/// Vector product.
#[inline]
pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

/// Angle between two directions, 0 to pi; accurate at both ends, where an arc cosine is not.
pub fn angle(a: Vector, b: Vector) -> f64 {
    libm::atan2(norm(cross(a, b)), dot(a, b))
}
