//! Arithmetic on `[f64; N]`, N axes, and on numbers where the core has none of it.

/// `a - b`.
#[inline]
pub fn sub<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    core::array::from_fn(|i| a[i] - b[i])
}

/// `a + k b`.
#[inline]
pub fn add_scaled<const N: usize>(a: [f64; N], k: f64, b: [f64; N]) -> [f64; N] {
    core::array::from_fn(|i| a[i] + k * b[i])
}

/// `k a`.
#[inline]
pub fn scale<const N: usize>(k: f64, a: [f64; N]) -> [f64; N] {
    core::array::from_fn(|i| k * a[i])
}

/// Scalar product.
#[inline]
pub fn dot<const N: usize>(a: [f64; N], b: [f64; N]) -> f64 {
    let mut sum = 0.0;
    for i in 0..N {
        sum += a[i] * b[i];
    }
    sum
}

/// Euclidean length.
#[inline]
pub fn norm<const N: usize>(a: [f64; N]) -> f64 {
    libm::sqrt(dot(a, a))
}

/// `a` without its component along the unit vector `direction`.
#[inline]
pub fn reject<const N: usize>(a: [f64; N], direction: [f64; N]) -> [f64; N] {
    add_scaled(a, -dot(a, direction), direction)
}

/// `a`, shortened to `limit` where it is longer. NaN becomes zero.
#[inline]
pub(crate) fn limit_norm<const N: usize>(a: [f64; N], limit: f64) -> [f64; N] {
    let length = norm(a);
    if length <= limit {
        a
    } else if length.is_finite() {
        scale(limit / length, a)
    } else {
        [0.0; N]
    }
}

/// `x^4`.
#[inline]
pub fn fourth_power(x: f64) -> f64 {
    x * x * x * x
}

/// Limits `x` to `least..most`. NaN becomes `least`. Where the ends are crossed or NaN, the result
/// is one of them or `x`.
/// `f64::clamp` would panic.
#[inline]
pub fn bounded(x: f64, least: f64, most: f64) -> f64 {
    x.max(least).min(most)
}

/// `3 x^2 - 2 x^3`: from 0 to 1, and begins and ends without a slope.
#[inline]
pub fn smooth_step(x: f64) -> f64 {
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vector_is_shortened_to_the_limit_and_what_is_no_number_becomes_none() {
        assert_eq!(limit_norm([3.0, 4.0], 5.0), [3.0, 4.0]);
        assert_eq!(limit_norm([3.0, 4.0], 2.5), [1.5, 2.0]);
        for bad in [[f64::NAN, 1.0], [f64::INFINITY, 1.0]] {
            assert_eq!(limit_norm(bad, 5.0), [0.0; 2]);
        }
    }

    #[test]
    fn what_is_rejected_has_nothing_left_along_the_direction() {
        let left = reject([3.0, -2.0, 7.0], [0.6, 0.8, 0.0]);
        assert!(
            dot(left, [0.6, 0.8, 0.0]).abs() < 1e-15 && (left[2] - 7.0).abs() < 1e-15,
            "{left:?}"
        );
    }

    #[test]
    fn a_bounded_number_is_within_its_bounds_whatever_it_was() {
        assert_eq!(
            [-3.0, 0.5, 3.0, f64::NAN].map(|x| bounded(x, -1.0, 2.0)),
            [-1.0, 0.5, 2.0, -1.0]
        );
        assert!(bounded(0.5, f64::NAN, f64::NAN) == 0.5);
    }
}
