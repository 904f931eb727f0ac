//! Input shaping: the path is run through a sequence of impulses that leaves no vibration at a
//! resonance, in front of feedforward of velocity, acceleration and friction.
//!
//! ```text
//! Td = 1 / (f sqrt(1 - zeta^2))     K = exp(-zeta pi / sqrt(1 - zeta^2))
//! ZV:  weights 1, K       / (1 + K)     at 0, Td / 2
//! ZVD: weights 1, 2K, K^2 / (1 + K)^2   at 0, Td / 2, Td
//! s(t) = sum_i w_i r(t + tm - t_i)      tm = sum_i w_i t_i
//! ```
//!
//! The second sequence also leaves the derivative of the vibration by the frequency at zero. The
//! reference r is taken ahead of time by the mean tm of the delays, which the preview has: what
//! moves steadily is not late. What remains is that the path is rounded: a circle by about `R
//! (omega Td / 4)^2 / 2`.
//!
//! Symbols: f frequency of the damped resonance's undamped twin, Hz; zeta its damping ratio; w_i
//! weights, t_i delays of the impulses, s.
//!
//! Source: Singer and Seering (1990), "Preshaping command inputs to reduce system vibration"; zero
//! vibration with two impulses goes back to Smith (1957), "Posicast".
//!
//! Departures: the shaped reference goes through the inverse dynamics of `feedforward`, because a
//! shaper alone leaves the lag of the position loops as it is. Not the delay but its mean is taken
//! off.

use feedwright_control::vector::{add_scaled, sub};
use feedwright_control::{Preview, Window};

use feedwright_control::{
    Command, Controller, Feedforward, MAX_PREVIEW, Measured, Parameter, Schedule,
};

use super::deciding;

/// Settings of the shaper.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settings {
    /// Frequency of the resonance, Hz; 5 to 500.
    pub frequency_hz: f64,
    /// Its damping ratio; 0 to 0.9.
    pub damping_ratio: f64,
    /// Two impulses leave no vibration at the frequency, three next to none about it, and take
    /// twice the time.
    pub impulses: u32,
}

impl Settings {
    /// Frequency between the 60 Hz of a table on a soft ball screw with the motor held, and the 85
    /// Hz at which both swing freely.
    pub(super) const DEFAULT: Self = Self {
        frequency_hz: 70.0,
        damping_ratio: 0.02,
        impulses: 2,
    };
}

pub(super) const FREQUENCY: Parameter = Parameter::number(
    "frequency_hz",
    Settings::DEFAULT.frequency_hz,
    [5.0, 1000.0],
    Some([10.0, 500.0]),
    "of the resonance that is not excited: at 500 its impulses are a servo period apart, and shape nothing",
);
pub(super) const DAMPING: Parameter = Parameter::number(
    "damping_ratio",
    Settings::DEFAULT.damping_ratio,
    [0.0, 0.9],
    Some([1e-3, 0.5]),
    "of that resonance: more makes the later impulses smaller",
);
pub(super) const IMPULSES: Parameter = Parameter::whole(
    "impulses",
    Settings::DEFAULT.impulses as usize,
    [2.0, 3.0],
    "2 hit the frequency (ZV), 3 also what is near it (ZVD) and round the path by more",
);

/// An impulse of the shaper.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Impulse {
    weight: f64,
    /// Lead of the impulse over the mean delay, s.
    ahead_s: f64,
}

/// The shaper; one of two impulses has a third without weight.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Shaper([Impulse; 3]);

impl Shaper {
    fn new(settings: &Settings) -> Self {
        let zeta = settings.damping_ratio;
        let root = libm::sqrt(1.0 - zeta * zeta);
        let half_s = 0.5 / (settings.frequency_hz * root);
        let k = libm::exp(-zeta * core::f64::consts::PI / root);
        let [first, second, third] = match settings.impulses {
            3.. => [1.0, 2.0 * k, k * k],
            _ => [1.0, k, 0.0],
        };
        let sum = first + second + third;
        let mean_s = (second * half_s + third * 2.0 * half_s) / sum;
        let impulse = |weight: f64, at_s: f64| Impulse {
            weight: weight / sum,
            ahead_s: mean_s - at_s,
        };
        let [second, third] = [impulse(second, half_s), impulse(third, 2.0 * half_s)];
        Self([impulse(first, 0.0), second, third])
    }

    /// The shaped reference at a plan time; rest stays at rest to the bit.
    fn at<const N: usize>(&self, preview: &Preview<N>, tau_s: f64) -> [f64; N] {
        let here_mm = preview.at(tau_s).position_mm;
        let moved = |sum_mm, impulse: &Impulse| {
            let there_mm = preview.at(tau_s + impulse.ahead_s).position_mm;
            add_scaled(sum_mm, impulse.weight, sub(there_mm, here_mm))
        };
        add_scaled(here_mm, 1.0, self.0.iter().fold([0.0; N], moved))
    }

    /// Returns the longest lead of an impulse over the mean delay, s.
    fn ahead_s(&self) -> f64 {
        self.0
            .iter()
            .map(|impulse| impulse.ahead_s)
            .fold(0.0, f64::max)
    }
}

/// Input shaping in front of feedforward.
#[derive(Debug, Clone)]
pub(super) struct InputShaping<const N: usize> {
    feedforward: Feedforward<N>,
    shaper: Shaper,
    preview: u32,
}

impl<const N: usize> InputShaping<N> {
    /// Creates the shaper in front of a feedforward, for a servo period of `servo_s`.
    pub(super) fn new(feedforward: Feedforward<N>, settings: &Settings, servo_s: f64) -> Self {
        let shaper = Shaper::new(settings);
        let Schedule { preview, .. } = feedforward.schedule();
        let ahead = libm::ceil(f64::from(preview) + shaper.ahead_s() / servo_s).min(MAX_PREVIEW);
        // A float that is not a number saturates to zero here.
        Self {
            feedforward,
            shaper,
            preview: ahead as u32,
        }
    }
}

impl<const N: usize> Controller<N> for InputShaping<N> {
    fn schedule(&self) -> Schedule {
        deciding(1, self.preview)
    }

    fn reset(&mut self) {
        self.feedforward.reset();
    }

    /// The command of the next servo period leads the shaped reference as feedforward alone leads
    /// the path.
    fn command(&mut self, window: &Window<'_, N>, _: &Measured<N>) -> Command<N> {
        let next_s = window.tau_s + window.feed_period_s;
        let shaper = self.shaper;
        let shaped = |tau_s: f64| shaper.at(window.preview, tau_s);
        let beside_mm = |tau_s: f64| sub(shaped(tau_s), window.preview.at(tau_s).position_mm);
        let last_mm = sub(window.offset_mm, beside_mm(window.tau_s));
        let at_mm = |after_s| shaped(next_s + after_s);
        let lead_mm = self.feedforward.lead_mm(at_mm, last_mm, [0.0; N]);
        Command::straight(1.0, add_scaled(lead_mm, 1.0, beside_mm(next_s)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::contour_compensation::tests::Circle;
    use crate::peers::cross_coupled::tests::Line;
    use crate::peers::fixture::{axis, commands, inverse};
    use feedwright_control::vector::norm;
    use feedwright_control::{Gains, KnotSource};

    const SERVO_S: f64 = 0.001;

    /// Residual vibration of a resonance at `frequency_hz` after the last impulse, as a fraction of
    /// the vibration that a single impulse excites.
    fn left(settings: &Settings, frequency_hz: f64) -> f64 {
        let zeta = settings.damping_ratio;
        let rad_s = core::f64::consts::TAU * frequency_hz;
        let Shaper(impulses) = Shaper::new(settings);
        let there = impulses.iter().filter(|i| i.weight > 0.0);
        let last_s = there.map(|i| -i.ahead_s).fold(f64::MIN, f64::max);
        let (mut sin, mut cos) = (0.0, 0.0);
        for Impulse { weight, ahead_s } in impulses {
            let since_s = last_s + ahead_s;
            let size = weight * libm::exp(-zeta * rad_s * since_s);
            let phase = rad_s * libm::sqrt(1.0 - zeta * zeta) * since_s;
            (sin, cos) = (sin + size * libm::sin(phase), cos + size * libm::cos(phase));
        }
        libm::hypot(sin, cos)
    }

    #[test]
    fn no_vibration_is_left_at_the_resonance_and_with_three_impulses_next_to_none_about_it() {
        for damping_ratio in [0.0, 0.02, 0.3] {
            let [zv, zvd] = [2, 3].map(|impulses| Settings {
                frequency_hz: 70.0,
                damping_ratio,
                impulses,
            });
            assert!(left(&zv, 70.0) < 1e-12 && left(&zvd, 70.0) < 1e-12);
            // Off by a part d of the frequency, two impulses leave pi d / 2 of an undamped
            // vibration, three its square.
            let [one, squared] = [zv, zvd].map(|settings| left(&settings, 71.4));
            if damping_ratio == 0.0 {
                let off = 0.02 * core::f64::consts::FRAC_PI_2;
                let [by_one, by_square] = [one / off, squared / (off * off)];
                assert!((by_one - 1.0).abs() < 1e-3, "{one}");
                assert!((by_square - 1.0).abs() < 1e-3, "{squared}");
            }
            assert!(
                squared < 0.1 * one && one > 1e-3,
                "{damping_ratio}: {one} {squared}"
            );
        }
    }

    /// A shaper before loops that follow without any lag: its command is the shaped path.
    fn shaped(path: &mut dyn KnotSource<2>, of: &Settings, each: impl FnMut(usize, [f64; 2])) {
        let nothing = Feedforward::new([inverse(axis(0.02, 0.2)); 2], [Gains::NONE; 2]);
        let mut controller = InputShaping::new(nothing, of, SERVO_S);
        commands(path, &mut controller, SERVO_S, each);
    }

    #[test]
    fn a_steady_motion_is_not_late_and_a_circle_loses_what_its_impulses_are_apart() {
        for impulses in [2, 3] {
            let settings = Settings {
                frequency_hz: 40.0,
                damping_ratio: 0.1,
                impulses,
            };
            shaped(&mut Line, &settings, |n, [x, _]| {
                let is_there = (x - 50.0 * n as f64 * SERVO_S).abs() < 1e-12 * 50.0;
                assert!(n <= 100 || is_there, "{n}: {x}");
            });
        }
        // Two equal impulses, Td / 2 apart: R cos(omega Td / 4).
        let settings = Settings {
            frequency_hz: 40.0,
            damping_ratio: 0.0,
            impulses: 2,
        };
        let mut seen = 0;
        shaped(&mut Circle, &settings, |n, at| {
            if n > 100 {
                let radius = norm(sub(at, [10.0, 0.0]));
                let expected = 10.0 * libm::cos(5.0 / 160.0);
                assert!((radius - expected).abs() < 1e-8, "{n}: {radius}");
                seen += 1;
            }
        });
        assert_eq!(seen, 899);
    }
}
