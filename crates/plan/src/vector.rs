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

/// Smooths points by a Gaussian of `sigma` samples; beyond its ends a sequence goes on as it ends.
pub fn smoothed(points: &[Vector], sigma: f64) -> Vec<Vector> {
    let reach = (3.0 * sigma).ceil() as isize;
    if reach < 1 || points.is_empty() {
        return points.to_vec();
    }
    let weight = |k: isize| libm::exp(-0.5 * (k as f64 / sigma).powi(2));
    let sum: f64 = (-reach..=reach).map(weight).sum();
    let weights: Vec<f64> = (-reach..=reach).map(|k| weight(k) / sum).collect();
    let last = points.len() as isize - 1;
    (0..=last)
        .map(|n| {
            let mut mean = [0.0; 3];
            for (k, weight) in (-reach..=reach).zip(&weights) {
                let point = points[(n + k).clamp(0, last) as usize];
                for i in 0..3 {
                    mean[i] += weight * point[i];
                }
            }
            mean
        })
        .collect()
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
