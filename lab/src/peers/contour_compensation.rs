//! Real-time contour error compensation: the reference is moved by the estimated contour error.
//!
//! ```text
//! f(k)   = f(k-1) + T / (T + Tf) (e(k) - f(k-1))    e: estimated contour error, desired minus actual; T: servo period
//! c(k+1) = c(k) + g T f(k)
//! P'(k)  = P*(k) + c(k)
//! ```
//!
//! Source: Lee and Jeon (1999), whose estimator over the shift register of references is
//! `contour_error`, as far as Lee, Cho and Jeon (2005) describe it: the contour error is estimated
//! in each period, and the position command is compensated by it.
//!
//! The paper on the compensator was not available, so these are choices made here: the compensation
//! accumulates, because a compensation equal to the error leaves half of it. Rate g and filter Tf
//! are tuned. c and f turn with the path, so that the droop in a circle is one constant error and
//! not a wave on two axes.
//!
//! Departure: while the supervisor holds the command back, the accumulation starts from the offset
//! that the supervisor passed.

use feedwright_control::vector::{add_scaled, norm, sub};
use feedwright_control::{Window, carried};

use feedwright_control::{Command, Controller, Measured, Parameter, Schedule};

use super::deciding;

/// Settings of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settings {
    /// Rate g at which the error goes over into the compensation, 1/s; 1 to 300.
    pub rate_1_s: f64,
    /// Time constant Tf of the filter of the estimate, s; 0 (none) to 0.1.
    pub filter_s: f64,
}

impl Settings {
    /// Just below the 50 1/s of a position loop, a filter of one servo period: found by hand on the
    /// circle.
    pub(super) const DEFAULT: Self = Self {
        rate_1_s: 40.0,
        filter_s: 0.001,
    };
}

pub(super) const RATE: Parameter = Parameter::number(
    "rate_1_s",
    Settings::DEFAULT.rate_1_s,
    [0.0, 1e4],
    Some([1.0, 3000.0]),
    "how fast the reference follows the error: small is late, large swings",
);
pub(super) const FILTER: Parameter = Parameter::number(
    "filter_s",
    Settings::DEFAULT.filter_s,
    [1e-5, 10.0],
    Some([1e-4, 0.1]),
    "time constant of the filter on the error: long takes out noise, and is late",
);

/// Real-time contour error compensation.
#[derive(Debug, Clone)]
pub(super) struct ContourCompensation<const N: usize> {
    settings: Settings,
    filtered_mm: [f64; N],
    tangent: Option<[f64; N]>,
}

impl<const N: usize> ContourCompensation<N> {
    /// Creates the controller with these settings.
    pub(super) fn new(settings: Settings) -> Self {
        Self {
            settings,
            filtered_mm: [0.0; N],
            tangent: None,
        }
    }
}

impl<const N: usize> Controller<N> for ContourCompensation<N> {
    fn schedule(&self) -> Schedule {
        deciding(1, 0)
    }

    fn reset(&mut self) {
        *self = Self::new(self.settings);
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let period_s = window.feed_period_s;
        let tangent = measured.contour.tangent;
        let error_mm = measured.contour.vector_mm;
        if !norm(error_mm).is_finite() {
            return Command::straight(1.0, window.offset_mm);
        }
        let mut offset_mm = window.offset_mm;
        if let Some(last) = self.tangent {
            self.filtered_mm = carried(self.filtered_mm, last, tangent);
            offset_mm = carried(offset_mm, last, tangent);
        }
        self.tangent = Some(tangent);
        let part = period_s / (period_s + self.settings.filter_s);
        self.filtered_mm = add_scaled(self.filtered_mm, part, sub(error_mm, self.filtered_mm));
        let rate = self.settings.rate_1_s * period_s;
        Command::straight(1.0, add_scaled(offset_mm, rate, self.filtered_mm))
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::peers::cross_coupled::tests::cut;
    use feedwright_control::{Knot, KnotSource, Uncorrected};

    /// The circle of eq. 11 at 50 mm/s.
    pub(crate) struct Circle;

    impl KnotSource<2> for Circle {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            let (sin, cos) = (libm::sin(5.0 * tau_s), libm::cos(5.0 * tau_s));
            Knot {
                position_mm: [10.0 - 10.0 * cos, 10.0 * sin],
                tangent: [sin, cos],
                feed_mm_s: 50.0,
                cutting: true,
            }
        }
    }

    /// Error of the radius after 2 s, mm.
    fn droop_mm(mut controller: impl Controller<2>) -> f64 {
        let tool_mm = cut(&mut Circle, &mut controller, [0.0; 2], 2000);
        norm(sub(tool_mm, [10.0, 0.0])) - 10.0
    }

    #[test]
    fn the_droop_of_a_circle_is_one_constant_error_and_vanishes() {
        // Radius of a first-order lag with the time constant T at the angular speed w: R / sqrt(1 +
        // (w T)^2).
        let open = droop_mm(Uncorrected);
        let expected = 10.0 / libm::sqrt(1.01) - 10.0;
        assert!((open - expected).abs() < 1e-3, "{open}");
        let compensated = droop_mm(ContourCompensation::new(Settings::DEFAULT));
        assert!(compensated.abs() < 2e-4, "{compensated}");
    }
}
