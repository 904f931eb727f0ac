//! An additional reference contour at corners, from linear models of the axes; away from corners
//! the reference is the path.
//!
//! ```text
//! r(t) = p(t) + g(d) (p'(t) / kp + p''(t) / (kp w))       w: bandwidth of the speed loop, 1/s
//! g(d) = 1 for |d| <= h,   s(2 - |d| / h) for h < |d| < 2 h,   0 beyond       s(x) = 3 x^2 - 2 x^3
//! ```
//!
//! with p the path, r the reference and d the time to the nearest corner, s. The bracket is the
//! reference that a linear axis follows without error, so the reference runs past the corner before
//! it turns, and the tool does not cut the corner. On the lines beside the corner the addition lies
//! along the path. It fades in and out there and makes no contour error.
//!
//! Source: Yang (1993), "Optimal feedrate control strategy for high-speed high-accuracy corner
//! motions".
//!
//! The paper was not at hand. Lee, Cho and Jeon (2005) say of it: an analytic method sets an
//! additional reference contour, the models are simplified linear equations, and only corners are
//! treated. Reconstructed here: the addition as the inverse of the linear axis ([`Feedforward`]
//! without friction, which also knows the delays and the feedforward of a drive), and the weight g.
//! The optimal feedrate of its title is left to the feed planner, which bounds the speed at a
//! corner.
use feedwright_control::vector::{dot, scale, smooth_step};
use feedwright_control::{
    Command, Controller, Feedforward, MAX_PREVIEW, Measured, Parameter, Schedule, Window,
};

/// Cosine of the turn between two knots beyond which there is a corner between them: a curve turns
/// so far (0.1 rad) in a servo period only where its radius is below ten steps.
const CORNER_COSINE: f64 = 0.995;

pub(super) const REACH: Parameter = Parameter::number(
    "reach_s",
    0.05,
    [0.005, 0.1],
    Some([0.005, 0.1]),
    "time to either side of a corner in which the addition has its whole weight: a short one begins while the axis still lags",
);

/// The additional contour.
#[derive(Debug, Clone)]
pub(super) struct CornerContour<const N: usize> {
    inverse: Feedforward<N>,
    reach_s: f64,
    servo_s: f64,
    /// The whole addition of the last period, before its weight, mm.
    whole_mm: [f64; N],
}

impl<const N: usize> CornerContour<N> {
    /// Creates the controller from the inverse of the linear axes; the addition has its whole
    /// weight within `reach_s` of a corner.
    pub(super) fn new(inverse: Feedforward<N>, reach_s: f64, servo_s: f64) -> Self {
        Self {
            inverse,
            reach_s,
            servo_s,
            whole_mm: [0.0; N],
        }
    }

    /// Weight of the addition at the next servo period, 0 to 1.
    fn weight(&self, window: &Window<'_, N>) -> f64 {
        let farthest = libm::ceil((2.0 * self.reach_s / self.servo_s).min(MAX_PREVIEW)) as i32;
        let is_corner = |periods: i32| {
            let [from, to] = [periods, periods + 1].map(|n| window.at(f64::from(n) * self.servo_s));
            from.feed_mm_s.max(to.feed_mm_s) > 0.0 && dot(from.tangent, to.tangent) < CORNER_COSINE
        };
        let nearest = (0..farthest).find(|&away| is_corner(away) || is_corner(-away));
        let away_s = |periods: i32| f64::from(periods) * self.servo_s;
        nearest.map_or(0.0, |periods| {
            smooth_step((2.0 - away_s(periods) / self.reach_s).clamp(0.0, 1.0))
        })
    }
}

impl<const N: usize> Controller<N> for CornerContour<N> {
    fn schedule(&self) -> Schedule {
        let own = libm::ceil(2.0 * self.reach_s / self.servo_s).min(MAX_PREVIEW) as u32;
        let inverse = self.inverse.schedule();
        Schedule {
            preview: inverse.preview.max(own),
            ..inverse
        }
    }

    fn reset(&mut self) {
        self.inverse.reset();
        self.whole_mm = [0.0; N];
    }

    fn observe(&mut self, _: &Window<'_, N>, measured: Option<&Measured<N>>) {
        if measured.is_none() {
            self.reset();
        }
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let alone = Window {
            offset_mm: self.whole_mm,
            ..*window
        };
        self.whole_mm = self.inverse.command(&alone, measured).offset_mm;
        Command::straight(1.0, scale(self.weight(window), self.whole_mm))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::contour_compensation::tests::Circle;
    use crate::peers::fixture::{axis, commands, inverse};
    use feedwright_control::vector::{norm, sub};
    use feedwright_control::{Gains, Knot, KnotSource};

    const SERVO_S: f64 = 0.001;
    const REACH_S: f64 = 0.05;
    const CORNER_S: f64 = 0.5;

    /// 50 mm/s along the first axis, and along the second from 0.5 s on.
    struct Corner;

    impl KnotSource<2> for Corner {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            let [x, y] = [tau_s.min(CORNER_S), (tau_s - CORNER_S).max(0.0)].map(|t_s| 50.0 * t_s);
            let is_before = tau_s < CORNER_S;
            Knot {
                position_mm: [x, y],
                tangent: [is_before, !is_before].map(|is| f64::from(u8::from(is))),
                feed_mm_s: 50.0,
                cutting: true,
            }
        }
    }

    fn contour() -> CornerContour<2> {
        let gains = Gains {
            friction: 0.0,
            ..Gains::EXACT
        };
        let inverse = Feedforward::new([inverse(axis(0.0, 0.0)); 2], [gains; 2]);
        CornerContour::new(inverse, REACH_S, SERVO_S)
    }

    #[test]
    fn the_reference_runs_past_the_corner_by_the_lag_and_is_the_path_away_from_it() {
        let mut farthest_mm = 0.0_f64;
        commands(&mut Corner, &mut contour(), SERVO_S, |n, command_mm| {
            let tau_s = n as f64 * SERVO_S;
            let [x, y] = sub(command_mm, Corner.knot(tau_s).position_mm);
            if (tau_s - CORNER_S).abs() > 2.0 * REACH_S + SERVO_S {
                assert_eq!([x, y], [0.0; 2], "{tau_s}");
            }
            farthest_mm = farthest_mm.max(command_mm[0] - 50.0 * CORNER_S);
        });
        // 50 mm/s over 50 1/s; the corner is a mean over two servo periods of 0.05 mm each.
        assert!((farthest_mm - 1.0).abs() < 0.1, "{farthest_mm}");
    }

    #[test]
    fn a_curve_without_a_corner_gets_none() {
        commands(&mut Circle, &mut contour(), SERVO_S, |n, command_mm| {
            let path_mm = Circle.knot(n as f64 * SERVO_S).position_mm;
            assert!(norm(sub(command_mm, path_mm)) < 1e-12, "{n}");
        });
    }
}
