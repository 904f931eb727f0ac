//! Cross-coupled control: the contour error through a PID controller, added to the command across
//! the path.
//!
//! ```text
//! u = Kp e + Ki integral(e dt) + Kd de/dt        e: contour error, desired minus actual
//! P'(t) = P*(t) + u n                            n: unit normal of the path where the tool is
//! ```
//!
//! Source: Koren (1980), ASME J. Dyn. Sys. Meas. Control 102, for the structure; Srinivasan and
//! Kulkarni (1990), same journal 112, for curved contours. Koren and Lo (1991) use gains Cx and Cy
//! that turn with the path, for circles. Here they are the components of n, the normal at the
//! nearest point. This normal is exact, where theirs is of second order.
//!
//! The papers were not available; the implementation follows descriptions in later work.
//!
//! e, its integral and its derivative are vectors in the frame of the path and turn with n. A
//! constant radial error on a circle is therefore constant here. In space, n is any direction
//! across the path, and the frame turns by the smallest rotation between two tangents. In the plane
//! this reduces to the scalar error of the papers.
//!
//! Departures: Koren adds u to the velocity command behind the position controllers. Here the
//! drives accept only position commands. With proportional position loops of equal gain, the two
//! are equivalent if all three gains are divided by the loop gain. The derivative is filtered
//! (`DERIVATIVE_S`). While the supervisor holds the command back, the integral does not grow. At
//! a corner the frame does not turn, because turning the integral by the corner makes the command
//! leap. Only the component across the new side is kept. Kp, Ki and Kd are tuned; the sources
//! derive them for their machines.

use feedwright_control::vector::{add_scaled, dot, norm, sub};
use feedwright_control::{Window, carried};

use feedwright_control::{Command, Controller, Measured, Parameter, Schedule};

use super::deciding;

/// Time constant of the filter of the derivative, s: two servo periods of 1 ms, below what a speed
/// loop follows.
const DERIVATIVE_S: f64 = 0.002;
/// A command that differs by more than this from what was asked was held back, mm.
const HELD_BACK_MM: f64 = 1e-9;

/// Gains of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Settings {
    /// Proportional, mm of offset a mm of error; 0 to 8.
    pub kp: f64,
    /// Integral, 1/s; 0 to 400.
    pub ki_1_s: f64,
    /// Derivative, s; 0 to 0.03.
    pub kd_s: f64,
}

impl Settings {
    /// Ki / Kp cancels the pole of a position loop of 50 1/s. Kp / Kd cancels the pole of a speed
    /// loop of 200 1/s.
    pub(super) const DEFAULT: Self = Self {
        kp: 4.0,
        ki_1_s: 200.0,
        kd_s: 0.02,
    };
}

// Beyond the gains that the reasons name the loop is still stable on smooth paths, but catches the
// tool in acute corners; what a machine can bear differs.
pub(super) const KP: Parameter = Parameter::number(
    "kp",
    Settings::DEFAULT.kp,
    [0.0, 100.0],
    Some([0.1, 60.0]),
    "gain of the contour error: more corrects more; beyond 8 the tool is caught in acute corners",
);
pub(super) const KI: Parameter = Parameter::number(
    "ki_1_s",
    Settings::DEFAULT.ki_1_s,
    [0.0, 1e5],
    Some([0.1, 1e4]),
    "gain of its integral: 0 leaves a part of a steady error; beyond 400 the tool is caught in acute corners",
);
pub(super) const KD: Parameter = Parameter::number(
    "kd_s",
    Settings::DEFAULT.kd_s,
    [0.0, 1.0],
    Some([1e-5, 0.5]),
    "gain of its derivative, which damps: beyond 0.03 the tool is caught in acute corners",
);
// The same behind a feedforward, which leaves a tenth of the error: on a noisy encoder next to no
// gain may be best.
pub(super) const BEHIND_KP: Parameter = Parameter {
    searched: Some([0.01, 60.0]),
    ..KP
};
pub(super) const BEHIND_KI: Parameter = Parameter {
    searched: Some([0.01, 1e4]),
    ..KI
};
pub(super) const BEHIND_KD: Parameter = Parameter {
    searched: Some([1e-6, 0.5]),
    ..KD
};

/// Cross-coupled control.
#[derive(Debug, Clone)]
pub(super) struct CrossCoupled<const N: usize> {
    settings: Settings,
    integral_mm_s: [f64; N],
    derivative_mm_s: [f64; N],
    last: Option<LastError<N>>,
}

#[derive(Debug, Clone, Copy)]
struct LastError<const N: usize> {
    error_mm: [f64; N],
    tangent: [f64; N],
    asked_mm: [f64; N],
}

impl<const N: usize> CrossCoupled<N> {
    /// Creates the controller with these gains.
    pub(super) fn new(settings: Settings) -> Self {
        Self {
            settings,
            integral_mm_s: [0.0; N],
            derivative_mm_s: [0.0; N],
            last: None,
        }
    }
}

impl<const N: usize> Controller<N> for CrossCoupled<N> {
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
        let mut held_back = false;
        if let Some(last) = self.last {
            let before_mm = carried(last.error_mm, last.tangent, tangent);
            self.integral_mm_s = carried(self.integral_mm_s, last.tangent, tangent);
            self.derivative_mm_s = carried(self.derivative_mm_s, last.tangent, tangent);
            let change_mm = sub(error_mm, before_mm);
            let missing_mm_s = add_scaled(change_mm, -period_s, self.derivative_mm_s);
            let part_1_s = 1.0 / (period_s + DERIVATIVE_S);
            self.derivative_mm_s = add_scaled(self.derivative_mm_s, part_1_s, missing_mm_s);
            held_back = norm(sub(window.offset_mm, last.asked_mm)) > HELD_BACK_MM;
        }
        let grows = dot(error_mm, self.integral_mm_s) > 0.0;
        if !(held_back && grows) {
            self.integral_mm_s = add_scaled(self.integral_mm_s, period_s, error_mm);
        }
        let Settings { kp, ki_1_s, kd_s } = self.settings;
        let slow_mm = add_scaled([0.0; N], ki_1_s, self.integral_mm_s);
        let offset_mm = add_scaled(slow_mm, kp, error_mm);
        let offset_mm = add_scaled(offset_mm, kd_s, self.derivative_mm_s);
        self.last = Some(LastError {
            error_mm,
            tangent,
            asked_mm: offset_mm,
        });
        Command::straight(1.0, offset_mm)
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use feedwright_control::{Estimator, Knot, KnotSource, Preview, Register};

    /// Returns the tool position after `periods` servo periods of 1 ms, mm. A constant load pushes
    /// the tool `load_mm` off its command. The position loops have a gain of 50 1/s, and there is
    /// no supervisor.
    pub(crate) fn cut<C: Controller<2>>(
        reference: &mut impl KnotSource<2>,
        controller: &mut C,
        load_mm: [f64; 2],
        periods: u32,
    ) -> [f64; 2] {
        let mut register = Register::default();
        let preview = Preview::new(0.001);
        let mut estimator = Estimator::default();
        let (mut offset_mm, mut tool_mm) = ([0.0; 2], [0.0; 2]);
        for n in 0..periods {
            let tau_s = f64::from(n) * 0.001;
            register.push(reference.knot(tau_s));
            let window = Window {
                register: &register,
                preview: &preview,
                tau_s,
                feed_period_s: 0.001,
                offset_mm,
                offset_mm_s: [0.0; 2],
            };
            let measured = Measured {
                position_mm: tool_mm,
                contour: estimator.estimate(&window, tool_mm),
            };
            let command_mm = add_scaled(window.now().position_mm, 1.0, offset_mm);
            let pulled_to_mm = add_scaled(command_mm, 1.0, load_mm);
            offset_mm = controller.command(&window, &measured).offset_mm;
            tool_mm = add_scaled(tool_mm, 1.0 - libm::exp(-0.05), sub(pulled_to_mm, tool_mm));
        }
        tool_mm
    }

    /// Along x at 50 mm/s.
    pub(crate) struct Line;

    impl KnotSource<2> for Line {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            Knot {
                position_mm: [50.0 * tau_s, 0.0],
                tangent: [1.0, 0.0],
                feed_mm_s: 50.0,
                cutting: true,
            }
        }
    }

    #[test]
    fn the_proportional_part_leaves_its_share_and_the_integral_nothing() {
        let rests_at_mm = |settings: Settings| {
            let controller = &mut CrossCoupled::new(settings);
            cut(&mut Line, controller, [0.0, 0.02], 1000)[1]
        };
        let proportional = rests_at_mm(Settings {
            kp: 3.0,
            ki_1_s: 0.0,
            kd_s: 0.0,
        });
        assert!((proportional - 0.02 / 4.0).abs() < 1e-9, "{proportional}");
        assert!(rests_at_mm(Settings::DEFAULT).abs() < 1e-9);
    }
}
