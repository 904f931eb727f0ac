//! Question: is the noise of the measurement as stated?
//!
//! ```text
//! c = 2 nu(k) nu(k-1) / (nu(k)^2 + nu(k-1)^2 + 2 e^2)      in -1 to 1, zero in the mean where the innovations nu are white
//! l <- l - m c,   0 <= l <= 6                               the variance of the measurement is taken to be 4^l times as given
//! ```
//!
//! A gain that is too high follows the noise of the encoder and has to reverse it: adjacent
//! innovations have opposite signs, c is negative, and the noise is taken to be larger. A gain that
//! is too low spreads a real motion over several innovations: c is positive. The gains of a filter
//! depend on the ratio of measurement noise to disturbance, so that one number is enough for both.
//! There is one set of gains for each whole l; between them they are interpolated.
//!
//! Evidence: the correlation of adjacent innovations. The filter takes l as the noise.
//!
//! The division makes a shock, however large, one step of m. A frozen encoder, and an axis that
//! stands still between two steps of its encoder, give no evidence on noise: a measurement that
//! repeats itself to the bit is not used.
//!
//! Source: Mehra (1970), "On the identification of variances and adaptive Kalman filtering", IEEE
//! Trans. Automatic Control 15(2): only a filter with the optimal gain has white innovations. The
//! recursion with normalized products is our own.

/// Number of whole powers of four, from 0 on.
pub(crate) const LEVELS: usize = 7;
/// Step of the power for innovations that are alike.
const STEP: f64 = 0.01;

/// State of the whiteness test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Whiteness {
    /// Power of four by which the variance of the measurement is taken to be larger than given.
    power: f64,
    before_rad: f64,
}

impl Whiteness {
    /// State for the variance as given.
    pub(crate) const GIVEN: Self = Self {
        power: 0.0,
        before_rad: 0.0,
    };

    /// Returns the variance of the measurement as a multiple of the given one.
    pub(crate) fn variance(&self) -> f64 {
        libm::exp2(2.0 * self.power)
    }

    /// Returns l.
    pub(crate) fn power(&self) -> f64 {
        self.power
    }

    /// Returns the nearest whole level.
    pub(crate) fn level(&self) -> usize {
        // The cast saturates to zero where the float is NaN.
        (libm::round(self.power) as usize).min(LEVELS - 1)
    }

    /// Takes in an innovation; below `least_rad` it is rounding. A measurement that `repeats` the
    /// last one to the bit gives no evidence.
    pub(crate) fn take_in(&mut self, repeats: bool, innovation_rad: f64, least_rad: f64) {
        let squares = innovation_rad * innovation_rad + self.before_rad * self.before_rad;
        let alike =
            2.0 * innovation_rad * self.before_rad / (squares + 2.0 * least_rad * least_rad);
        self.before_rad = innovation_rad;
        if !repeats && alike.is_finite() {
            let power = self.power - STEP * alike;
            self.power = power.max(0.0).min((LEVELS - 1) as f64);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A random number of mean 0 and variance 1 (sum of twelve uniform ones), by a congruential
    /// generator.
    fn normal(seed: &mut u64) -> f64 {
        let mut sum = -6.0;
        for _ in 0..12 {
            *seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            sum += (*seed >> 11) as f64 / (1_u64 << 53) as f64;
        }
        sum
    }

    /// Gain of the filter of a random walk with steps of variance 1, as in
    /// `controller/lqg_identified/riccati.rs`.
    fn walk_gain(variance: f64) -> f64 {
        let p = 0.5 + libm::sqrt(0.25 + variance);
        p / (p + variance)
    }

    /// The power that is found for a random walk that is measured with noise of this standard
    /// deviation, where 1 is given: mean of the last half, and the highest of all.
    fn found(noise: f64, periods: u32, mut disturb: impl FnMut(u32, f64) -> f64) -> (f64, f64) {
        let mut whiteness = Whiteness::GIVEN;
        let (mut seed, mut place, mut estimate, mut sum, mut highest) = (7, 0.0, 0.0, 0.0, 0.0_f64);
        for n in 0..periods {
            place += normal(&mut seed);
            let measured = disturb(n, place + noise * normal(&mut seed));
            let innovation = measured - estimate;
            whiteness.take_in(false, innovation, 0.01);
            estimate += walk_gain(whiteness.variance()) * innovation;
            highest = highest.max(whiteness.power);
            sum += if 2 * n >= periods {
                2.0 * whiteness.power / f64::from(periods)
            } else {
                0.0
            };
        }
        (sum, highest)
    }

    #[test]
    fn noise_that_was_not_given_is_found() {
        for power in [0.0, 1.0, 2.0, 3.0_f64] {
            let (mean, _) = found(libm::exp2(power), 40_000, |_, measured| measured);
            assert!((mean - power).abs() < 0.35, "{power}: {mean}");
        }
    }

    #[test]
    fn a_shock_is_one_step_and_a_frozen_encoder_says_nothing() {
        let calm = found(1.0, 2000, |_, measured| measured).1;
        let shocked = found(1.0, 2000, |n, measured| {
            if n % 500 == 250 {
                measured + 1e9
            } else {
                measured
            }
        })
        .1;
        assert!(shocked <= calm + 10.0 * STEP, "{calm} {shocked}");
        let mut frozen = Whiteness::GIVEN;
        (0..1000).for_each(|n| frozen.take_in(n > 0, if n % 2 == 0 { 1.0 } else { -1.0 }, 0.01));
        assert!(frozen.power <= STEP, "{}", frozen.power);
        frozen.take_in(false, f64::NAN, 0.01);
        assert!(frozen.power.is_finite());
    }
}
