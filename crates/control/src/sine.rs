//! A sine without a panic. The sine of libm keeps a panic for arguments beyond 1e5, and a tick must
//! not contain one.
//!
//! [`sin`] subtracts the nearest whole number of turns, which leaves at most half a turn to either
//! side of zero. The symmetry of the sine reduces this to a quarter turn. There the error of the
//! Taylor series to x^17 is below (pi/2)^19 / 19! = 5e-14. The reduction adds the rounding error of
//! the angle: 1e-10 at 1e6 rad.

use core::f64::consts::{FRAC_PI_2, PI, TAU};

/// 1/3!, 1/5!, .. 1/17!, by turns negative and positive, the last first.
const TAYLOR: [f64; 8] = [
    1.0 / 355_687_428_096_000.0,
    -1.0 / 1_307_674_368_000.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 39_916_800.0,
    1.0 / 362_880.0,
    -1.0 / 5_040.0,
    1.0 / 120.0,
    -1.0 / 6.0,
];

/// Returns the sine of an angle, rad; NaN if the angle is not finite.
#[inline]
pub fn sin(angle_rad: f64) -> f64 {
    let half = angle_rad - TAU * libm::round(angle_rad / TAU);
    let quarter = if half > FRAC_PI_2 {
        PI - half
    } else if half < -FRAC_PI_2 {
        -PI - half
    } else {
        half
    };
    let square = quarter * quarter;
    let series = TAYLOR
        .iter()
        .fold(0.0, |sum, coefficient| (sum + coefficient) * square);
    quarter + quarter * series
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_agrees_with_the_library_and_what_is_not_finite_has_none() {
        for n in -20_000..20_000 {
            let angle_rad = 0.0137 * f64::from(n);
            assert!(
                (sin(angle_rad) - libm::sin(angle_rad)).abs() < 1e-12,
                "{angle_rad}"
            );
        }
        for angle_rad in [1e5, -3.3e6] {
            assert!(
                (sin(angle_rad) - libm::sin(angle_rad)).abs() < 1e-9,
                "{angle_rad}"
            );
        }
        assert_eq!(sin(0.0), 0.0);
        assert!(
            [f64::NAN, f64::INFINITY]
                .into_iter()
                .all(|angle_rad| sin(angle_rad).is_nan())
        );
    }
}
