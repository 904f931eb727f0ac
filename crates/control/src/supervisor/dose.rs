//! The part of an offset that acts at once and is commanded while the correction engages or
//! disengages.
//!
//! ```text
//! o = s(p) c               c is the present request of the controller, s(p) = 3 p^2 - 2 p^3
//! p                        rises to 1 when engaged and falls to 0 when disengaged, in T = max(40 ms, sqrt(6 |o| / A)); A is the acceleration of a fade
//! ```
//!
//! p scales the present request: an offset that was frozen and taken back would still act after its
//! corner has passed. During disengagement o is at most the fade of the last offset
//! (`supervisor/fade.rs`), because the request itself may do the harm.
//!
//! Source: o s(p) accelerates by at most 6 o / T^2; the form is our own.

use crate::vector::{bounded, norm, scale, smooth_step};

/// Shortest time in which a correction that acts at once engages or disengages, s: twice the time
/// constant of a usual position loop.
const LEAST_S: f64 = 0.04;

/// The factor p.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dose {
    part: f64,
    take_up_s: f64,
}

impl Dose {
    /// The full offset.
    pub(super) const ALL: Self = Self {
        part: 1.0,
        take_up_s: LEAST_S,
    };

    /// Begins to engage or disengage the correction. Its requested offset is `asked_mm`, and its
    /// acceleration stays within `fade_mm_s2`.
    pub(super) fn turn<const N: usize>(&mut self, asked_mm: [f64; N], fade_mm_s2: f64) {
        self.take_up_s = libm::sqrt(6.0 * norm(asked_mm) / fade_mm_s2).max(LEAST_S);
    }

    /// Returns the part of an offset that is commanded a period later, while the correction is
    /// engaged or disengages.
    pub(super) fn of<const N: usize>(
        &mut self,
        asked_mm: [f64; N],
        is_in: bool,
        period_s: f64,
    ) -> [f64; N] {
        let change = period_s / self.take_up_s;
        self.part = bounded(self.part + if is_in { change } else { -change }, 0.0, 1.0);
        scale(smooth_step(self.part), asked_mm)
    }

    /// Commands no part of the offset.
    pub(super) fn none(&mut self) {
        self.part = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 0.001;

    #[test]
    fn what_comes_back_keeps_the_acceleration_of_a_fade() {
        for (offset_mm, fade_mm_s2) in [(0.5, 400.0), (0.01, 400.0), (0.5, 40.0)] {
            let mut dose = Dose::ALL;
            assert_eq!(
                dose.of([offset_mm], true, PERIOD_S),
                [offset_mm],
                "all of it, to the bit"
            );
            dose.none();
            dose.turn([offset_mm], fade_mm_s2);
            let mut way_mm = [0.0; 1000];
            way_mm
                .iter_mut()
                .for_each(|at_mm| [*at_mm] = dose.of([offset_mm], true, PERIOD_S));
            let bends = way_mm
                .windows(3)
                .map(|o| ((o[2] - 2.0 * o[1] + o[0]) / (PERIOD_S * PERIOD_S)).abs());
            let bend_mm_s2 = bends.fold(0.0, f64::max);
            assert!(
                bend_mm_s2 <= 1.01 * fade_mm_s2,
                "{offset_mm} {fade_mm_s2}: {bend_mm_s2}"
            );
            assert!(way_mm.is_sorted() && way_mm[999] == offset_mm);
        }
    }
}
