//! The activation of the identifier: the bipolar sigmoid f(x) = tanh(x / 2) = (1 - e^-x) / (1 +
//! e^-x).
//!
//! Lee, Cho and Jeon (2005) call it a hyperbolic tangent; the factor 1/4 in their eqs 9 and 10
//! shows which one: each layer contributes f'(x) = (1 - f(x)^2) / 2.
//!
//! The code has no branch, no table and no call, so that a compiler vectorizes it over an array.

/// Argument beyond which the result is 1 to the last bit; e^-x stays a normal number.
const SATURATED: f64 = 40.0;
/// ln 2 in two parts, so that `x - n ln 2` is exact for |n| < 2^20 (Cody and Waite 1980).
const LN2_HIGH: f64 = 6.931_471_803_691_238e-1;
const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;
/// 1.5 * 2^52 + 1023: adding it rounds to the nearest integer and leaves that integer, biased as an
/// exponent, in the low bits.
const ROUND_TO_EXPONENT: f64 = 6_755_399_441_055_744.0 + 1023.0;
/// 1 / n! from n = 12 down to 0: the truncated series is good to 2e-16 on |r| <= ln(2) / 2.
const EXP_SERIES: [f64; 13] = [
    1.0 / 479_001_600.0,
    1.0 / 39_916_800.0,
    1.0 / 3_628_800.0,
    1.0 / 362_880.0,
    1.0 / 40_320.0,
    1.0 / 5_040.0,
    1.0 / 720.0,
    1.0 / 120.0,
    1.0 / 24.0,
    1.0 / 6.0,
    0.5,
    1.0,
    1.0,
];

/// f(x) = tanh(x / 2) of every element, to 1e-15 absolute. NaN stays NaN.
#[inline]
pub(crate) fn bipolar_sigmoid<const M: usize>(x: [f64; M]) -> [f64; M] {
    let mut f = [0.0; M];
    for i in 0..M {
        let e = exp(-x[i].clamp(-SATURATED, SATURATED));
        f[i] = (1.0 - e) / (1.0 + e);
    }
    f
}

/// Derivative of the activation, given its value: f' = (1 - f^2) / 2.
#[inline]
pub(crate) fn slope(f: f64) -> f64 {
    0.5 * (1.0 - f * f)
}

/// tanh(x) to 1e-15 absolute, for the plant's smooth sign function.
#[inline]
pub(crate) fn tanh<const M: usize>(x: [f64; M]) -> [f64; M] {
    bipolar_sigmoid(x.map(|x| 2.0 * x))
}

/// Returns e^x for -40 to 40, to the last bits. The result is wrong far beyond this range.
#[inline]
pub(crate) fn exp(x: f64) -> f64 {
    let shifted = x * core::f64::consts::LOG2_E + ROUND_TO_EXPONENT;
    let n = shifted - ROUND_TO_EXPONENT;
    let r = (x - n * LN2_HIGH) - n * LN2_LOW;
    let mut p = EXP_SERIES[0];
    for c in &EXP_SERIES[1..] {
        p = p * r + c;
    }
    p * f64::from_bits(shifted.to_bits() << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn agrees_with_tanh_of_the_c_library_everywhere() {
        for i in -200_000..=200_000 {
            let x = f64::from(i) * 5e-4;
            let [f] = bipolar_sigmoid([x]);
            assert!((f - libm::tanh(0.5 * x)).abs() < 1e-15, "x = {x}: {f}");
        }
    }

    #[test]
    fn is_odd_and_saturates_at_one() {
        let f = bipolar_sigmoid([0.0, 1e300, -1e300, f64::INFINITY]);
        assert_eq!(f, [0.0, 1.0, -1.0, 1.0]);
        assert!(bipolar_sigmoid([f64::NAN])[0].is_nan());
    }
}
