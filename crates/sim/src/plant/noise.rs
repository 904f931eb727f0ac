//! Random numbers of a machine: a number for each seed, axis, purpose and moment, which needs
//! nothing of those before.
//!
//! ```text
//! mix(z):  z ^= z >> 30; z *= 0xbf58476d1ce4e5b9; z ^= z >> 27; z *= 0x94d049bb133111eb; z ^= z >> 31       64 bits, modulo 2^64
//! key     = mix(seed + (16 axis + purpose + 1) G),   G = 0x9e3779b97f4a7c15
//! bits(c) = mix(key + (c + 1) G)
//! uniform = (bits(c) >> 11) / 2^53                                      0 to 1
//! normal  = (sum of the twelve 16-bit parts of bits(3c), bits(3c + 1), bits(3c + 2) - 393210) / 65536
//! ```
//!
//! The sum of twelve uniform numbers of 16 bits has the mean 12 * 65535 / 2 = 393,210 and the
//! variance 12 (2^32 - 1) / 12, so normal has mean 0 and standard deviation 1 to 1e-10; it lies
//! within -6 to 6, its excess kurtosis is -0.1. Integers and an exact division: any language on any
//! machine computes the same bits.
//!
//! Noise with a correlation time T is an Ornstein-Uhlenbeck process of standard deviation s, its
//! step over dt exact, and it begins in its stationary distribution:
//!
//! ```text
//! x(0) = s normal(0),   x(c + 1) = a x(c) + s sqrt(1 - a^2) normal(c + 1),   a = exp(-dt / T), 0 where T is
//! ```
//!
//! Source: Steele, Lea and Flood (2014), Fast splittable pseudorandom number generators, for the
//! generator, SplitMix64; Irwin (1927) and Hall (1927) for sums of uniform numbers; Uhlenbeck and
//! Ornstein (1930), and Gillespie (1996) for the exact step.

/// 2^64 divided by the golden ratio.
const GAMMA: u64 = 0x9e37_79b9_7f4a_7c15;
/// Twelve times the mean of 16 bits.
const MEAN_OF_TWELVE: i64 = 393_210;
/// 2^-53: the spacing of the uniform numbers.
const LAST_BIT: f64 = 1.0 / 9_007_199_254_740_992.0;

/// Purpose of a random number. Using more numbers for one purpose does not change those of others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RandomUse {
    /// The encoder of the position loop.
    Encoder = 0,
    /// The encoder of the motor, if the position is measured at the table.
    MotorEncoder = 1,
    /// Broadband torque.
    Torque = 2,
    /// Frequency of the disturbance.
    Wander = 3,
    /// The time at which a reference arrives. The bus sets it, so it is the same for all axes.
    Jitter = 4,
}

/// The numbers for one purpose of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct RandomStream {
    key: u64,
}

impl RandomStream {
    pub(super) fn new(seed: u64, axis: usize, purpose: RandomUse) -> Self {
        Self {
            key: splitmix(seed, 16 * axis as u64 + purpose as u64),
        }
    }

    /// Returns a uniform number from 0 to below 1.
    #[inline]
    pub(super) fn uniform(self, counter: u64) -> f64 {
        (splitmix(self.key, counter) >> 11) as f64 * LAST_BIT
    }

    /// Returns a normal number with mean 0 and standard deviation 1.
    #[inline]
    pub(super) fn normal(self, counter: u64) -> f64 {
        let first = counter.wrapping_mul(3);
        let sum = parts(splitmix(self.key, first))
            + parts(splitmix(self.key, first.wrapping_add(1)))
            + parts(splitmix(self.key, first.wrapping_add(2)));
        (sum as i64 - MEAN_OF_TWELVE) as f64 / 65536.0
    }
}

/// The output of SplitMix64 for this seed, `counter` outputs behind the first.
#[inline]
fn splitmix(seed: u64, counter: u64) -> u64 {
    let mut z = seed.wrapping_add(GAMMA.wrapping_mul(counter.wrapping_add(1)));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Sum of the four parts of 16 bits.
#[inline]
fn parts(bits: u64) -> u64 {
    (bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48)
}

/// Noise with a correlation time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CorrelatedNoise {
    stream: RandomStream,
    keep: f64,
    add: f64,
    value: f64,
}

impl CorrelatedNoise {
    /// Creates noise with a standard deviation and a correlation time, for steps of `dt_s`.
    pub(super) fn new(stream: RandomStream, deviation: f64, correlation_s: f64, dt_s: f64) -> Self {
        let keep = if correlation_s > 0.0 {
            libm::exp(-dt_s / correlation_s)
        } else {
            0.0
        };
        Self {
            stream,
            keep,
            add: deviation * (1.0 - keep * keep).sqrt(),
            value: deviation * stream.normal(0),
        }
    }

    /// One step on, at this moment.
    #[inline]
    pub(super) fn next(&mut self, counter: u64) -> f64 {
        self.value = self.keep * self.value + self.add * self.stream.normal(counter + 1);
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_gives_the_numbers_that_are_published_for_it() {
        let published = [
            6_457_827_717_110_365_317,
            3_203_168_211_198_807_973,
            9_817_491_932_198_370_423,
            4_593_380_528_125_082_431,
        ];
        assert_eq!(
            [0, 1, 2, 3].map(|counter| splitmix(1_234_567, counter)),
            published
        );
    }

    /// Mean, variance, and the means of the third and fourth power.
    fn moments(values: impl Iterator<Item = f64>) -> [f64; 4] {
        let (mut sums, mut count) = ([0.0; 4], 0.0);
        for value in values {
            count += 1.0;
            (0..4).for_each(|power| sums[power] += value.powi(power as i32 + 1));
        }
        sums.map(|sum| sum / count)
    }

    #[test]
    fn normal_and_uniform_numbers_have_their_moments() {
        for (axis, purpose) in [(0, RandomUse::Encoder), (2, RandomUse::Torque)] {
            let stream = RandomStream::new(7, axis, purpose);
            // Of 1e6 numbers the standard errors of the means are 1e-3, 1.4e-3, 3.7e-3 and 9e-3;
            // four of each are allowed.
            let [mean, square, cube, fourth] = moments((0..1_000_000).map(|c| stream.normal(c)));
            assert!(
                mean.abs() < 4e-3 && (square - 1.0).abs() < 6e-3,
                "{mean} {square}"
            );
            assert!(
                cube.abs() < 0.015 && (fourth - 2.9).abs() < 0.04,
                "{cube} {fourth}"
            );
            let [mean, square, ..] = moments((0..1_000_000).map(|c| stream.uniform(c)));
            assert!(
                (mean - 0.5).abs() < 1.2e-3 && (square - 1.0 / 3.0).abs() < 1.2e-3,
                "{mean} {square}"
            );
        }
    }

    #[test]
    fn streams_of_seeds_axes_and_purposes_have_nothing_in_common() {
        let streams = [
            RandomStream::new(0, 0, RandomUse::Encoder),
            RandomStream::new(1, 0, RandomUse::Encoder),
            RandomStream::new(0, 1, RandomUse::Encoder),
            RandomStream::new(0, 0, RandomUse::Torque),
        ];
        for (i, a) in streams.iter().enumerate() {
            for b in &streams[i + 1..] {
                let product: f64 =
                    (0..100_000).map(|c| a.normal(c) * b.normal(c)).sum::<f64>() / 1e5;
                assert!(product.abs() < 0.0127, "{product}: four standard errors");
            }
        }
    }

    #[test]
    fn correlated_noise_has_its_deviation_and_forgets_within_its_time() {
        let (deviation, time_s, dt_s) = (0.2, 0.005, 1e-4);
        let mut noise = CorrelatedNoise::new(
            RandomStream::new(3, 0, RandomUse::Torque),
            deviation,
            time_s,
            dt_s,
        );
        let values: Vec<f64> = (0..2_000_000).map(|c| noise.next(c)).collect();
        let covariance = |lag: usize| {
            values[lag..]
                .iter()
                .zip(&values)
                .map(|(a, b)| a * b)
                .sum::<f64>()
                / (values.len() - lag) as f64
        };
        // 200 s are 20,000 independent numbers: 1 % for the variance, four times that is allowed.
        for lag in [0, 10, 50, 150] {
            let wanted = deviation * deviation * libm::exp(-(lag as f64) * dt_s / time_s);
            assert!(
                (covariance(lag) - wanted).abs() < 0.04 * deviation * deviation,
                "{lag}: {}",
                covariance(lag)
            );
        }
    }

    #[test]
    fn it_is_white_without_a_correlation_time_and_begins_where_it_goes_on() {
        let stream = RandomStream::new(3, 0, RandomUse::Torque);
        let mut white = CorrelatedNoise::new(stream, 2.0, 0.0, 1e-4);
        assert_eq!(white.next(5), 2.0 * stream.normal(6));
        let begins = |seed| {
            CorrelatedNoise::new(
                RandomStream::new(seed, 0, RandomUse::Wander),
                1.0,
                1.0,
                1e-3,
            )
            .next(0)
        };
        let square: f64 = (0..10_000).map(|seed| begins(seed).powi(2)).sum::<f64>() / 1e4;
        assert!(
            (square - 1.0).abs() < 0.06,
            "{square}: four standard errors"
        );
    }
}
