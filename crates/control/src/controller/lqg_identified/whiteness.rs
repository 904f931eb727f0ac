//! Weight of the measurements in the filter, learned from the whiteness of its innovations.
//!
//! ```text
//! c = 2 nu(k) nu(k-1) / (nu(k)^2 + nu(k-1)^2 + 2 e^2)      in -1 to 1, zero in the mean where the innovations nu are white
//! l <- l - m c,   L0 <= l <= L1                             the variance of the measurement is taken to be 4^l times as given
//! ```
//!
//! A gain that is too high follows the noise of the encoder and has to reverse it: adjacent
//! innovations have opposite signs, c is negative, and the noise is taken to be larger. A gain that
//! is too low spreads a real motion over several innovations: c is positive. The gains of a filter
//! depend on the ratio of measurement noise to disturbance, so that one number is enough for both.
//! There is one set of gains for each whole l; between them they are interpolated.
//!
//! The division makes a shock, however large, one step of m. A frozen encoder, and an axis that
//! stands still between two steps of its encoder, give no evidence on noise: a measurement that
//! repeats itself to the bit is not used.
//!
//! Source: Mehra (1970), "On the identification of variances and adaptive Kalman filtering", IEEE
//! Trans. Automatic Control 15(2): only a filter with the optimal gain has white innovations. The
//! recursion with normalized products is our own.

use super::linear::STATES;

/// Lowest and highest power of four.
const LOWEST: i32 = 0;
const HIGHEST: i32 = 6;
/// Number of levels.
pub(super) const LEVELS: usize = (HIGHEST - LOWEST + 1) as usize;
/// Step of the power for innovations that are alike.
const STEP: f64 = 0.01;

/// Gains of the filter by the ratio of the measurement's variance to the given one, in powers of
/// four.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GainTable {
    gains: [[f64; STATES]; LEVELS],
}

impl GainTable {
    /// Creates the table of a filter; `gains` returns its gains for a variance of the measurement,
    /// and `given_rad2` is the variance by the statistics.
    pub(super) fn new(given_rad2: f64, gains: impl Fn(f64) -> [f64; STATES]) -> Self {
        let at =
            |level: usize| gains(given_rad2 * libm::exp2(2.0 * f64::from(LOWEST + level as i32)));
        Self {
            gains: core::array::from_fn(at),
        }
    }

    /// Returns the gains of each level.
    pub(super) fn levels(&self) -> &[[f64; STATES]; LEVELS] {
        &self.gains
    }

    /// Creates a table with the same gains at each level, for a measurement with the given
    /// variance.
    pub(super) fn constant(gains: [f64; STATES]) -> Self {
        Self {
            gains: [gains; LEVELS],
        }
    }

    fn at(&self, power: f64) -> [f64; STATES] {
        let level = power - f64::from(LOWEST);
        // The cast saturates to zero where the float is NaN.
        let below = (libm::floor(level) as usize).min(LEVELS - 2);
        let part = level - below as f64;
        let [lower, upper] =
            [below, below + 1].map(|n| self.gains.get(n).copied().unwrap_or([0.0; STATES]));
        core::array::from_fn(|i| lower[i] + part * (upper[i] - lower[i]))
    }
}

/// State of the whiteness test.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Whiteness {
    /// Power of four by which the variance of the measurement is taken to be larger than given.
    power: f64,
    before_rad: f64,
    measured_rad: f64,
}

impl Whiteness {
    /// State for the variance as given.
    pub(super) const GIVEN: Self = Self {
        power: 0.0,
        before_rad: 0.0,
        measured_rad: f64::NAN,
    };

    /// Returns the variance of the measurement as a multiple of the given one.
    pub(super) fn variance(&self) -> f64 {
        libm::exp2(2.0 * self.power)
    }

    /// Returns the gains of the filter.
    pub(super) fn gains(&self, table: &GainTable) -> [f64; STATES] {
        table.at(self.power)
    }

    /// Returns the nearest whole level.
    pub(super) fn level(&self) -> usize {
        // The cast saturates to zero where the float is NaN.
        (libm::round(self.power - f64::from(LOWEST)) as usize).min(LEVELS - 1)
    }

    /// Takes in a measurement and its innovation; innovations below `least_rad` are rounding.
    pub(super) fn take_in(&mut self, measured_rad: f64, innovation_rad: f64, least_rad: f64) {
        let repeats = measured_rad.to_bits() == self.measured_rad.to_bits();
        let squares = innovation_rad * innovation_rad + self.before_rad * self.before_rad;
        let alike =
            2.0 * innovation_rad * self.before_rad / (squares + 2.0 * least_rad * least_rad);
        (self.before_rad, self.measured_rad) = (innovation_rad, measured_rad);
        if !repeats && alike.is_finite() {
            let power = self.power - STEP * alike;
            self.power = power.max(f64::from(LOWEST)).min(f64::from(HIGHEST));
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
    /// [`super::super::riccati`].
    fn walk_gain(variance: f64) -> f64 {
        let p = 0.5 + libm::sqrt(0.25 + variance);
        p / (p + variance)
    }

    fn table() -> GainTable {
        GainTable::new(1.0, |variance| {
            core::array::from_fn(|i| if i == 0 { walk_gain(variance) } else { 0.0 })
        })
    }

    /// The power that is found for a random walk that is measured with noise of this standard
    /// deviation, where 1 is given: mean of the last half, and the highest of all.
    fn found(noise: f64, periods: u32, mut disturb: impl FnMut(u32, f64) -> f64) -> (f64, f64) {
        let (table, mut whiteness) = (table(), Whiteness::GIVEN);
        let (mut seed, mut place, mut estimate, mut sum, mut highest) = (7, 0.0, 0.0, 0.0, 0.0_f64);
        for n in 0..periods {
            place += normal(&mut seed);
            let measured = disturb(n, place + noise * normal(&mut seed));
            let innovation = measured - estimate;
            whiteness.take_in(measured, innovation, 0.01);
            let [gain, ..] = whiteness.gains(&table);
            estimate += gain * innovation;
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
        (0..1000).for_each(|n| frozen.take_in(1.0, if n % 2 == 0 { 1.0 } else { -1.0 }, 0.01));
        assert!(frozen.power <= STEP, "{}", frozen.power);
        frozen.take_in(f64::NAN, f64::NAN, 0.01);
        assert!(frozen.power.is_finite());
    }

    #[test]
    fn between_two_powers_gains_are_interpolated_and_beyond_the_last_they_stay() {
        let table = table();
        let [[low, ..], [middle, ..], [high, ..]] = [1.0, 1.5, 2.0].map(|power| table.at(power));
        assert_eq!([low, high], [walk_gain(4.0), walk_gain(16.0)]);
        assert!((middle - 0.5 * (low + high)).abs() < 1e-15);
        assert_eq!(
            table.at(f64::from(HIGHEST))[0],
            walk_gain(libm::exp2(2.0 * f64::from(HIGHEST)))
        );
    }
}
