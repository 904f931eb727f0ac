//! Gains of the filter for each noise of the measurement that its test finds
//! (`supervisor/whiteness.rs`): one set for each whole power of four, and interpolated between them.

use crate::supervisor::whiteness::LEVELS;

use super::linear::STATES;

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
        let at = |level: usize| gains(given_rad2 * libm::exp2(2.0 * level as f64));
        Self {
            gains: core::array::from_fn(at),
        }
    }

    /// Creates a table with the same gains at each level.
    pub(super) fn constant(gains: [f64; STATES]) -> Self {
        Self {
            gains: [gains; LEVELS],
        }
    }

    /// Returns the gains of each level.
    pub(super) fn levels(&self) -> &[[f64; STATES]; LEVELS] {
        &self.gains
    }

    /// Returns the gains for a noise, in powers of four.
    pub(super) fn at(&self, power: f64) -> [f64; STATES] {
        // The cast saturates to zero where the float is NaN.
        let below = (libm::floor(power) as usize).min(LEVELS - 2);
        let part = power - below as f64;
        let [lower, upper] =
            [below, below + 1].map(|n| self.gains.get(n).copied().unwrap_or([0.0; STATES]));
        core::array::from_fn(|i| lower[i] + part * (upper[i] - lower[i]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_two_powers_gains_are_interpolated_and_beyond_the_last_they_stay() {
        let table = GainTable::new(3.0, |variance| [variance; STATES]);
        let [[low, ..], [middle, ..], [high, ..]] = [1.0, 1.5, 2.0].map(|power| table.at(power));
        assert_eq!([low, middle, high], [12.0, 30.0, 48.0]);
        let [last, ..] = table.at((LEVELS - 1) as f64);
        assert_eq!(last, 3.0 * 4096.0);
    }
}
