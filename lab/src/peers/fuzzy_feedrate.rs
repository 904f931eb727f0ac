//! Fuzzy adaptive feedrate: slower where the contour error is large or grows; the geometry stays on
//! the path.
//!
//! ```text
//!   slow down by       error falls  steady  rises
//!   error small             0          0      1/4
//!   error medium           1/4        1/2     3/4
//!   error large            3/4         1       1          rate = 1 - (1 - slowest) slow down
//! ```
//!
//! Source: Tsai and others (1995), "DSP-based motion control by H-infinity axis-controller and
//! fuzzy adaptive feedrate"; here its second half alone, [`super::h_infinity`] has both.
//!
//! The paper was not available. Lee, Cho and Jeon (2005) say of it: a fuzzy adaptive feedrate.
//! Chosen here: contour error and its change as inputs; three triangular sets on either, which
//! overlap by half and saturate at `error_mm` and `change_mm_s`; the nine rules above, inferred by
//! the product, with the mean of the centers as the output. Every rule of the table is then met
//! exactly, and the surface is monotonic in both inputs, which inference by the minimum does not
//! guarantee.
//!
//! Departures: the feed is never above the programmed one; the factor changes within the
//! acceleration that the machine allows along the path.

use feedwright_control::Window;
use feedwright_control::vector::{bounded, norm};

use feedwright_control::{Command, Controller, Measured, Parameter, Schedule};

use super::deciding;

/// Period in which the rules are evaluated, s: the period of an interpolator, not of a servo.
pub(super) const FEED_PERIOD_S: f64 = 0.01;
/// The consequents: error small, medium, large; within it falling, steady, rising.
const RULES: [[f64; 3]; 3] = [[0.0, 0.0, 0.25], [0.25, 0.5, 0.75], [0.75, 1.0, 1.0]];

/// Settings of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settings {
    /// Servo periods between two decisions; 1 to 100.
    pub servo_periods: u32,
    /// Contour error that is large, mm; above 0.
    pub error_mm: f64,
    /// Change of the contour error that is fast, mm/s; above 0.
    pub change_mm_s: f64,
    /// Slowest rate, as a part of the planned feedrate; 0.1 to 1.
    pub slowest: f64,
    /// Acceleration along the path that the change of the rate may take, mm/s2.
    pub acceleration_mm_s2: f64,
}

impl Settings {
    /// Large is what a machine of the class shows at full feed in a circle of 10 mm radius.
    pub(super) const DEFAULT: Self = Self {
        servo_periods: 10,
        error_mm: 0.02,
        change_mm_s: 1.0,
        slowest: 0.4,
        acceleration_mm_s2: 100.0,
    };

    /// The rate that the rules give for an error and its change.
    pub(super) fn rate(&self, error_mm: f64, change_mm_s: f64) -> f64 {
        let error = memberships(2.0 * error_mm / self.error_mm - 1.0);
        let change = memberships(change_mm_s / self.change_mm_s);
        let mut slow_down = 0.0;
        for (row, of_error) in RULES.iter().zip(error) {
            for (consequent, of_change) in row.iter().zip(change) {
                slow_down += of_error * of_change * consequent;
            }
        }
        1.0 - (1.0 - self.slowest) * slow_down
    }
}

pub(super) const ERROR: Parameter = Parameter::number(
    "error_mm",
    Settings::DEFAULT.error_mm,
    [1e-4, 10.0],
    Some([0.002, 0.2]),
    "contour error that counts as large: small slows down for every error, large for none",
);
pub(super) const CHANGE: Parameter = Parameter::number(
    "change_mm_s",
    Settings::DEFAULT.change_mm_s,
    [1e-3, 1e3],
    Some([0.05, 20.0]),
    "change of the error that counts as large",
);
pub(super) const SLOWEST: Parameter = Parameter::number(
    "slowest",
    Settings::DEFAULT.slowest,
    [0.05, 1.0],
    Some([0.2, 1.0]),
    "slowest it may run, as a part of the planned feedrate",
);

/// Degrees in which `x` belongs to the sets with their tops at -1, 0 and 1; their sum is 1.
fn memberships(x: f64) -> [f64; 3] {
    let x = bounded(x, -1.0, 1.0);
    [(-x).max(0.0), 1.0 - x.abs(), x.max(0.0)]
}

/// The wanted rate, or as near to it as this acceleration along the path allows in a feed period.
pub(super) fn eased<const N: usize>(
    rate: f64,
    wanted: f64,
    acceleration_mm_s2: f64,
    window: &Window<'_, N>,
) -> f64 {
    let feed_mm_s = window.now().feed_mm_s.max(f64::MIN_POSITIVE);
    let step = acceleration_mm_s2 * window.feed_period_s / feed_mm_s;
    bounded(wanted, rate - step, rate + step)
}

/// Fuzzy adaptive feedrate.
#[derive(Debug, Clone)]
pub(super) struct FuzzyFeedrate {
    settings: Settings,
    error_mm: Option<f64>,
    rate: f64,
}

impl FuzzyFeedrate {
    /// Creates the controller with these settings.
    pub(super) fn new(settings: Settings) -> Self {
        Self {
            settings,
            error_mm: None,
            rate: 1.0,
        }
    }
}

impl<const N: usize> Controller<N> for FuzzyFeedrate {
    fn schedule(&self) -> Schedule {
        deciding(self.settings.servo_periods, 0)
    }

    fn reset(&mut self) {
        *self = Self::new(self.settings);
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let error_mm = norm(measured.contour.vector_mm);
        if error_mm.is_finite() {
            let change = |last_mm| (error_mm - last_mm) / window.feed_period_s;
            let change_mm_s = self.error_mm.map_or(0.0, change);
            let wanted = self.settings.rate(error_mm, change_mm_s);
            self.rate = eased(self.rate, wanted, self.settings.acceleration_mm_s2, window);
            self.error_mm = Some(error_mm);
        }
        Command::straight(self.rate, [0.0; N])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: Settings = Settings::DEFAULT;

    #[test]
    fn every_rule_is_met_where_it_alone_holds() {
        for (i, row) in RULES.iter().enumerate() {
            for (j, slow_down) in row.iter().enumerate() {
                let error_mm = 0.5 * i as f64 * SETTINGS.error_mm;
                let rate = SETTINGS.rate(error_mm, (j as f64 - 1.0) * SETTINGS.change_mm_s);
                let expected = 1.0 - (1.0 - SETTINGS.slowest) * slow_down;
                assert!((rate - expected).abs() < 1e-12, "{i} {j}: {rate}");
            }
        }
    }

    #[test]
    fn a_larger_and_a_growing_error_never_make_it_faster() {
        let at = |i: i32, j: i32| SETTINGS.rate(0.001 * f64::from(i), 0.1 * f64::from(j));
        for i in 0..40 {
            for j in -20..20 {
                let rate = at(i, j);
                let [larger, growing] = [at(i + 1, j), at(i, j + 1)];
                assert!(larger <= rate + 1e-12 && growing <= rate + 1e-12, "{i} {j}");
                let range = SETTINGS.slowest - 1e-12..=1.0;
                assert!(range.contains(&rate), "{i} {j}: {rate}");
            }
        }
    }

    #[test]
    fn memberships_are_a_partition() {
        for x in [-2.0, -1.0, -0.3, 0.0, 0.7, 1.0, 9.0] {
            let degrees = memberships(x);
            let is_one = (degrees.iter().sum::<f64>() - 1.0).abs() < 1e-15;
            let are_parts = degrees.iter().all(|d| (0.0..=1.0).contains(d));
            assert!(is_one && are_parts, "{x}: {degrees:?}");
        }
    }
}
