//! Cross-coupled control with an adaptive feedrate: the contour error is added to the command
//! across the path, and the feedrate is the highest that keeps the error within the allowed value.
//!
//! ```text
//! e     = theta v                                       v: rate; e: size of the contour error
//! theta(k+1) = theta(k) + T / (T + Tf) (e / v - theta(k))
//! v     = allowed / theta,   slowest <= v <= 1
//! ```
//!
//! Source: Chuang and Liu (1996), "Techniques in cross-coupled digital adaptive feedrate control
//! for multiaxis machine tools".
//!
//! The paper was not available. Lee, Cho and Jeon (2005) say of it: the relationship between
//! feedrate and contour error is linear. Its title says: cross-coupled control and a digital
//! adaptive feedrate work together. Reconstructed here: both parts. The compensation is the PID of
//! [`super::cross_coupled`]. A first-order filter estimates the slope theta and forgets over Tf,
//! because curvature and load change along the path.
//!
//! Departures: the feed is never above the programmed one, and changes within the acceleration that
//! the machine allows along the path.
use feedwright_control::Window;
use feedwright_control::vector::{bounded, norm};
use feedwright_control::{Command, Controller, Measured, Parameter, Schedule};

use super::cross_coupled::CrossCoupled;
use super::fuzzy_feedrate::eased;

/// Settings of the adaptation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settings {
    /// Contour error that is allowed, mm; above 0.
    pub allowed_mm: f64,
    /// Time constant Tf of the estimate, s.
    pub filter_s: f64,
    /// Slowest rate, as a part of the planned feedrate; 0.1 to 1.
    pub slowest: f64,
    /// Acceleration along the path that the change of the rate may take, mm/s2.
    pub acceleration_mm_s2: f64,
}

impl Settings {
    /// Settings by default: about the error that cross-coupled control alone leaves on a circle of
    /// 10 mm at 50 mm/s on tnv40, so that it slows down in sharper curves; two time constants of a
    /// position loop of 50 1/s.
    pub(super) const DEFAULT: Self = Self {
        allowed_mm: 0.5e-3,
        filter_s: 0.04,
        slowest: 0.4,
        acceleration_mm_s2: 100.0,
    };
}

pub(super) const ALLOWED: Parameter = Parameter::number(
    "allowed_mm",
    Settings::DEFAULT.allowed_mm,
    [1e-5, 10.0],
    Some([1e-4, 0.1]),
    "contour error that is allowed: a small one slows down for every error, a large one for none",
);
pub(super) const FILTER: Parameter = Parameter::number(
    "filter_s",
    Settings::DEFAULT.filter_s,
    [1e-4, 10.0],
    Some([2e-3, 1.0]),
    "time constant of the estimate of the error: short follows its noise, long is late at curves",
);
pub(super) const SLOWEST: Parameter = Parameter::number(
    "slowest",
    Settings::DEFAULT.slowest,
    [0.1, 1.0],
    Some([0.2, 1.0]),
    "slowest it may run, as a part of the planned feedrate",
);

/// Cross-coupled control with an adaptive feedrate.
#[derive(Debug, Clone)]
pub(super) struct CrossCoupledFeedrate<const N: usize> {
    settings: Settings,
    cross_coupled: CrossCoupled<N>,
    /// theta: contour error at the planned feed, mm.
    at_full_feed_mm: f64,
    rate: f64,
}

impl<const N: usize> CrossCoupledFeedrate<N> {
    /// Creates the controller with these settings, on top of cross-coupled control.
    pub(super) fn new(settings: Settings, cross_coupled: CrossCoupled<N>) -> Self {
        Self {
            settings,
            cross_coupled,
            at_full_feed_mm: 0.0,
            rate: 1.0,
        }
    }
}

impl<const N: usize> Controller<N> for CrossCoupledFeedrate<N> {
    fn schedule(&self) -> Schedule {
        self.cross_coupled.schedule()
    }

    fn reset(&mut self) {
        self.cross_coupled.reset();
        (self.at_full_feed_mm, self.rate) = (0.0, 1.0);
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let of = self.settings;
        let error_mm = norm(measured.contour.vector_mm);
        if error_mm.is_finite() {
            let period_s = window.feed_period_s;
            let missing_mm = error_mm / self.rate - self.at_full_feed_mm;
            self.at_full_feed_mm += period_s / (period_s + of.filter_s) * missing_mm;
            let wanted = of.allowed_mm / self.at_full_feed_mm.max(f64::MIN_POSITIVE);
            let wanted = bounded(wanted, of.slowest, 1.0);
            self.rate = eased(self.rate, wanted, of.acceleration_mm_s2, window);
        }
        Command {
            rate: self.rate,
            ..self.cross_coupled.command(window, measured)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::cross_coupled;
    use feedwright_control::{ContourError, Knot, Preview, Register};

    const SETTINGS: Settings = Settings {
        allowed_mm: 0.004,
        ..Settings::DEFAULT
    };

    /// The rates over two seconds, at 50 mm/s, where the error is `at_full_feed_mm` times the
    /// square of the rate; without compensation.
    fn rates(settings: Settings, at_full_feed_mm: f64) -> [f64; 2000] {
        let none = cross_coupled::Settings {
            kp: 0.0,
            ki_1_s: 0.0,
            kd_s: 0.0,
        };
        let mut controller = CrossCoupledFeedrate::<2>::new(settings, CrossCoupled::new(none));
        let mut register = Register::default();
        register.push(Knot {
            feed_mm_s: 50.0,
            ..Knot::REST
        });
        let window = Window {
            register: &register,
            preview: &Preview::new(0.001),
            tau_s: 0.0,
            feed_period_s: 0.001,
            offset_mm: [0.0; 2],
            offset_mm_s: [0.0; 2],
        };
        let mut rate = 1.0;
        core::array::from_fn(|_| {
            let contour = ContourError {
                vector_mm: [0.0, at_full_feed_mm * rate * rate],
                ..ContourError::NONE
            };
            let measured = Measured {
                position_mm: [0.0; 2],
                contour,
            };
            rate = controller.command(&window, &measured).rate;
            rate
        })
    }

    #[test]
    fn it_settles_where_the_error_is_the_allowed_one() {
        let settled = *rates(SETTINGS, 0.009).last().unwrap();
        assert!((settled - libm::sqrt(4.0 / 9.0)).abs() < 1e-9, "{settled}");
    }

    #[test]
    fn a_small_error_leaves_the_feed_and_a_large_one_leaves_the_slowest() {
        assert!(rates(SETTINGS, 0.0039).iter().all(|rate| *rate == 1.0));
        assert_eq!(*rates(SETTINGS, 1.0).last().unwrap(), SETTINGS.slowest);
    }

    #[test]
    fn the_feed_changes_no_faster_than_the_machine_may() {
        // 100 mm/s2 over 1 ms of 50 mm/s.
        let rates = rates(SETTINGS, 1.0);
        let steps = rates
            .windows(2)
            .map(|pair| pair[0] - pair[1])
            .fold(0.0, f64::max);
        assert!((steps - 0.002).abs() < 1e-12, "{steps}");
    }
}
