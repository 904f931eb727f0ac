//! Question: does an offset that acts at once fit into the owner's acceleration? If not, a part of it
//! is commanded.
//!
//! ```text
//! o = s(p) d c             c is the present request of the controller, s(p) = 3 p^2 - 2 p^3
//! p                        rises to 1 when engaged and falls to 0 when disengaged, in T = max(40 ms, sqrt(6 |o| / A)); A is the acceleration of a fade
//! d <- d + Ts / 5 s (1 - d)      in an axis where o is followed
//! d <- d - Ts / 5 ms d           where the owner's acceleration keeps the command from it
//! ```
//!
//! p scales the present request: an offset that was frozen and taken back would still act after its
//! corner has passed. During disengagement o is at most the fade of the last offset
//! (`supervisor/fade.rs`), because the request itself may do the harm.
//!
//! Where an axis changes to another model, its d returns to 1, and stays there for 50 ms.
//!
//! d keeps the loop stable at the bound: a controller whose command is cut off requests more and
//! more, and the axis swings. With a smaller offset the loop approaches the loop of the axis
//! without correction, which is stable. A controller that always requests more than the bound
//! allows ends where its offset just fits.
//!
//! Source: o s(p) accelerates by at most 6 o / T^2; for d, the reduction of a gain at a bound, as
//! in Hanus, Kinnaert and Henrotte (1987), "Conditioning technique, a general anti-windup and
//! bumpless transfer method", Automatica 23(6), in a form of our own.

use crate::vector::{bounded, norm, smooth_step};

/// Shortest time in which a correction that acts at once engages or disengages, s: twice the time
/// constant of a usual position loop.
const LEAST_S: f64 = 0.04;
/// Difference between the due and the commanded offset up to which the offset counts as followed,
/// mm: the mean error that is harm (`supervisor/benefit.rs`). With 2 um, 8.9 um remain on the star
/// on `workshop` in place of 0.29.
const BEHIND_MM: f64 = 0.005;
/// Times in which d falls and rises, s. The part that did not fit at the beginning of a block is
/// small at its end, where it would have to vanish: with a rise in 2 s two of 24 cuts within a
/// limit are worse than uncorrected, with this rise one is, by 2.4 um in its largest error
/// (`linuxcnc/servo/tests/property_acceleration_limit.rs`).
const FALLS_S: f64 = 0.005;
const RISES_S: f64 = 5.0;
/// Time in which an axis takes up a model that it learned, s.
const SPARED_S: f64 = 0.05;
/// Difference from 1 up to which a dose counts as 1.
const ROUNDING: f64 = 1e-6;

/// The factors p and d.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dose<const N: usize> {
    part: f64,
    take_up_s: f64,
    dose: [f64; N],
    /// True for each axis that follows a learned model, and the remaining time in which its d does
    /// not fall, s.
    learned: [bool; N],
    spared_s: [f64; N],
}

impl<const N: usize> Dose<N> {
    /// The full offset.
    pub(super) const ALL: Self = Self {
        part: 1.0,
        take_up_s: LEAST_S,
        dose: [1.0; N],
        learned: [false; N],
        spared_s: [0.0; N],
    };

    /// Sets d to 1 in each axis that changes to another model: the wrong model requested the offset
    /// that did not fit.
    pub(super) fn learn(&mut self, learned: [bool; N]) {
        for axis in 0..N {
            if learned[axis] != self.learned[axis] {
                (self.dose[axis], self.spared_s[axis]) = (1.0, SPARED_S);
            }
        }
        self.learned = learned;
    }

    /// Begins to engage or disengage the correction. Its requested offset is `asked_mm`, and its
    /// acceleration stays within `fade_mm_s2`.
    pub(super) fn turn(&mut self, asked_mm: [f64; N], fade_mm_s2: f64) {
        self.take_up_s = libm::sqrt(6.0 * norm(asked_mm) / fade_mm_s2).max(LEAST_S);
    }

    /// Returns the part of an offset that is commanded a period later, while the correction is
    /// engaged or disengages.
    pub(super) fn of(&mut self, asked_mm: [f64; N], is_in: bool, period_s: f64) -> [f64; N] {
        let change = period_s / self.take_up_s;
        self.part = bounded(self.part + if is_in { change } else { -change }, 0.0, 1.0);
        let part = smooth_step(self.part);
        core::array::from_fn(|axis| part * self.dose[axis] * asked_mm[axis])
    }

    /// Returns true if a bound reduces the offset.
    pub(super) fn is_reduced(&self) -> bool {
        self.dose.iter().any(|dose| *dose < 1.0)
    }

    /// Commands no part of the offset.
    pub(super) fn none(&mut self) {
        self.part = 0.0;
    }

    /// Takes in the difference between the due and the commanded offset in a period, mm.
    pub(super) fn take_in(&mut self, behind_mm: [f64; N], period_s: f64) {
        for ((dose, spared_s), behind_mm) in
            self.dose.iter_mut().zip(&mut self.spared_s).zip(behind_mm)
        {
            *spared_s = (*spared_s - period_s).max(0.0);
            if *spared_s > 0.0 {
                continue;
            }
            if behind_mm.abs() > BEHIND_MM {
                *dose -= (period_s / FALLS_S).min(1.0) * *dose;
            } else {
                *dose += (period_s / RISES_S).min(1.0) * (1.0 - *dose);
            }
            if 1.0 - *dose < ROUNDING {
                *dose = 1.0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PERIOD_S: f64 = 0.001;

    #[test]
    fn an_offset_that_does_not_fit_is_reduced_and_comes_back_when_it_does() {
        let mut dose = Dose::ALL;
        assert_eq!(
            dose.of([0.1], true, PERIOD_S),
            [0.1],
            "all of it, to the bit"
        );
        (0..20).for_each(|_| dose.take_in([1.0], PERIOD_S));
        let [reduced_mm] = dose.of([0.1], true, PERIOD_S);
        assert!(
            dose.is_reduced() && (0.001..0.0013).contains(&reduced_mm),
            "{reduced_mm}"
        );
        (0..100_000).for_each(|_| dose.take_in([0.0], PERIOD_S));
        assert_eq!(dose.of([0.1], true, PERIOD_S), [0.1]);
        assert!(!dose.is_reduced());
    }

    #[test]
    fn what_comes_back_keeps_the_acceleration_of_a_fade() {
        for (offset_mm, fade_mm_s2) in [(0.5, 400.0), (0.01, 400.0), (0.5, 40.0)] {
            let mut dose = Dose::ALL;
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
