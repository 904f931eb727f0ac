//! Two controllers at once: their offsets add.
//!
//! ```text
//! o(k+1) = a(k+1) + b(k+1)      a decides as if b were not there: it sees the offset o - b, and b sees o - a
//! ```
//!
//! Each controller derives some quantities from its own last offset: the derivative of a position
//! loop, and whether the command was held back. These are the same as if it ran alone. For linear
//! loops the two tool motions add.
//!
//! | Row | First | Second |
//! |---|---|---|
//! | feedforward-cross-coupled | feedforward | PID of the contour error |
//! | zero-phase-friction | inverse of the closed loop | feedforward of the Coulomb friction |
//!
//! An offset of the first controller along the path is not a contour error, because the second
//! measures the tool against the path and not against the command. Both learn from the full command
//! that was given, which [`Controller::observe`] receives.
//!
//! Source: the sources of the two controllers. Feedforward in the axes with cross-coupled feedback
//! behind it is common practice; Koren and Lo (1992), "Advanced controllers for feed drives",
//! review both side by side.

use feedwright_control::Window;
use feedwright_control::vector::{add_scaled, sub};

use feedwright_control::{Command, Controller, Measured, Schedule};

use super::deciding;

/// Two controllers that decide in every servo period at the planned feed; the second may not bend
/// its offset.
#[derive(Debug, Clone)]
pub(super) struct Sum<A, B, const N: usize> {
    first: A,
    second: B,
    /// Last offset that each controller requested, mm.
    asked_mm: [[f64; N]; 2],
}

impl<A: Controller<N>, B: Controller<N>, const N: usize> Sum<A, B, N> {
    /// Combines these two controllers.
    pub(super) fn new(first: A, second: B) -> Self {
        Self {
            first,
            second,
            asked_mm: [[0.0; N]; 2],
        }
    }
}

impl<A: Controller<N>, B: Controller<N>, const N: usize> Controller<N> for Sum<A, B, N> {
    fn schedule(&self) -> Schedule {
        let (first, second) = (self.first.schedule(), self.second.schedule());
        deciding(1, first.preview.max(second.preview))
    }

    fn reset(&mut self) {
        self.first.reset();
        self.second.reset();
        self.asked_mm = [[0.0; N]; 2];
    }

    /// Sets both last offsets to zero if the position is lost: the offset then returns to the path.
    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        self.first.observe(window, measured);
        self.second.observe(window, measured);
        if measured.is_none() {
            self.asked_mm = [[0.0; N]; 2];
        }
    }

    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N> {
        let [first_mm, second_mm] = self.asked_mm;
        let without = |part_mm| Window {
            offset_mm: sub(window.offset_mm, part_mm),
            ..*window
        };
        let first = self.first.command(&without(second_mm), measured);
        let second = self.second.command(&without(first_mm), measured);
        self.asked_mm = [first.offset_mm, second.offset_mm];
        Command::straight(1.0, add_scaled(first.offset_mm, 1.0, second.offset_mm))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::contour_compensation::tests::Circle;
    use crate::peers::cross_coupled::tests::{Line, cut};
    use crate::peers::cross_coupled::{CrossCoupled, Settings};
    use crate::peers::fixture::{axis, commands, inverse};
    use feedwright_control::vector::norm;
    use feedwright_control::{Feedforward, Gains, KnotSource};

    const SERVO_S: f64 = 0.001;

    fn feedforward(gains: Gains, kd: f64) -> Feedforward<2> {
        Feedforward::new([inverse(axis(kd, 0.2)); 2], [gains; 2])
    }

    #[test]
    fn the_parts_of_a_feedforward_add_up_to_all_of_it() {
        let friction = Gains {
            friction: 1.0,
            ..Gains::NONE
        };
        let rest = Gains {
            friction: 0.0,
            ..Gains::EXACT
        };
        for kd in [0.0, 0.05] {
            let (mut whole_mm, mut worst_mm, mut largest_mm) = ([[0.0; 2]; 1000], 0.0_f64, 0.0_f64);
            let all = &mut feedforward(Gains::EXACT, kd);
            commands(&mut Circle, all, SERVO_S, |n, mm| whole_mm[n] = mm);
            let mut sum = Sum::new(feedforward(rest, kd), feedforward(friction, kd));
            commands(&mut Circle, &mut sum, SERVO_S, |n, mm| {
                worst_mm = worst_mm.max(norm(sub(mm, whole_mm[n])));
                let path_mm = Circle.knot(n as f64 * SERVO_S).position_mm;
                largest_mm = largest_mm.max(norm(sub(mm, path_mm)));
            });
            assert!(
                worst_mm < 1e-12 && largest_mm > 0.9,
                "kd {kd}: {worst_mm} of {largest_mm}"
            );
        }
    }

    /// A first controller whose offset runs along the path, as a feedforward's does: 1 mm, and no
    /// contour error.
    struct Ahead;

    impl Controller<2> for Ahead {
        fn schedule(&self) -> Schedule {
            deciding(1, 0)
        }

        fn reset(&mut self) {}

        fn command(&mut self, _: &Window<'_, 2>, _: &Measured<2>) -> Command<2> {
            Command::straight(1.0, [1.0, 0.0])
        }
    }

    #[test]
    fn an_offset_along_the_path_is_no_contour_error() {
        let settings = Settings {
            kp: 3.0,
            ki_1_s: 0.0,
            kd_s: 0.0,
        };
        let mut sum = Sum::new(Ahead, CrossCoupled::new(settings));
        let [x_mm, y_mm] = cut(&mut Line, &mut sum, [0.0, 0.02], 1000);
        // Alone, the second leaves a quarter of the error across the path (1 / (1 + kp)), and the
        // first takes up a lag of 20 periods.
        let alone = &mut CrossCoupled::new(settings);
        let [lagging_mm, alone_mm] = cut(&mut Line, alone, [0.0, 0.02], 1000);
        assert!((y_mm - 0.005).abs() < 1e-9, "{y_mm}");
        assert!((y_mm - alone_mm).abs() < 1e-12, "{y_mm} {alone_mm}");
        assert!(
            (x_mm - lagging_mm - 1.0).abs() < 1e-9,
            "{x_mm} {lagging_mm}"
        );
    }
}
