//! How much of an offset that is there at once is commanded.
//!
//! ```text
//! o = s(p) d c             c is what the controller asks for now, s(p) = 3 p^2 - 2 p^3
//! p                        rises to 1 in the loop and falls to 0 out of it, in T = max(40 ms, sqrt(6 |o| / A)), A that of a fade
//! d <- d + Ts / 5 s (1 - d)      in an axis where o is followed
//! d <- d - Ts / 5 ms d           where the owner's acceleration keeps the command from it
//! ```
//!
//! p scales what is asked for now: an offset that was frozen and taken back would still be there
//! after its corner has passed. On the way out o is no more than the way back of the last offset
//! has (`supervisor/fade.rs`): what is asked for may be what does the harm.
//!
//! Where an axis goes by another law from now on, its d is 1 again, and stays that for 50 ms.
//!
//! d keeps the loop stable at the bound: a controller whose command is cut off asks for more and
//! more, and the axis swings. With less of the offset the loop is that of the axis by itself, which
//! is stable. A controller that asks for more than there is all the time ends where its offset just
//! fits in.
//!
//! Source: s(p) is at most 6 o / T^2 steep in its slope; for d, the reduction of a gain at a bound,
//! as in Hanus, Kinnaert and Henrotte (1987), "Conditioning technique, a general anti-windup and
//! bumpless transfer method", Automatica 23(6), in a form of our own.

use crate::vector::{bounded, norm, smooth_step};

/// A correction that acts at once takes at least this long to come and to go, s: twice the time
/// constant of a usual position loop.
const LEAST_S: f64 = 0.04;
/// An offset that is kept from what is due by no more than this is followed, mm: what is harm in
/// the mean (`supervisor/benefit.rs`). With 2 um workshop leaves 8.9 um on the star in place of
/// 0.29.
const BEHIND_MM: f64 = 0.005;
/// Times in which d falls and rises, s. What did not fit at the beginning of a block is small at
/// its end, where it would have to vanish: with a rise in 2 s two of 24 cuts within a limit are
/// worse than uncorrected, with this one is, by 2.4 um in its largest error
/// (`linuxcnc/servo/tests/property_acceleration_limit.rs`).
const FALLS_S: f64 = 0.005;
const RISES_S: f64 = 5.0;
/// Time in which an axis takes up a law that it learned, s.
const SPARED_S: f64 = 0.05;
/// A dose that is closer to all is all.
const ROUNDING: f64 = 1e-6;

/// p and d.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Dose<const N: usize> {
    part: f64,
    take_up_s: f64,
    dose: [f64; N],
    /// Which axes go by what was learned, and for how long nothing is held against that, s.
    learned: [bool; N],
    spared_s: [f64; N],
}

impl<const N: usize> Dose<N> {
    /// All of it.
    pub(super) const ALL: Self = Self {
        part: 1.0,
        take_up_s: LEAST_S,
        dose: [1.0; N],
        learned: [false; N],
        spared_s: [0.0; N],
    };

    /// An axis that goes by another law from now on begins anew: what did not fit was asked for by
    /// a law that was wrong.
    pub(super) fn learn(&mut self, learned: [bool; N]) {
        for axis in 0..N {
            if learned[axis] != self.learned[axis] {
                (self.dose[axis], self.spared_s[axis]) = (1.0, SPARED_S);
            }
        }
        self.learned = learned;
    }

    /// The correction comes or goes from now on; the offset that it asks for is this, and its
    /// acceleration is at most `fade_mm_s2` then.
    pub(super) fn turn(&mut self, asked_mm: [f64; N], fade_mm_s2: f64) {
        self.take_up_s = libm::sqrt(6.0 * norm(asked_mm) / fade_mm_s2).max(LEAST_S);
    }

    /// What of an offset is commanded a period later, in the loop or on the way out of it.
    pub(super) fn of(&mut self, asked_mm: [f64; N], is_in: bool, period_s: f64) -> [f64; N] {
        let change = period_s / self.take_up_s;
        self.part = bounded(self.part + if is_in { change } else { -change }, 0.0, 1.0);
        let part = smooth_step(self.part);
        core::array::from_fn(|axis| part * self.dose[axis] * asked_mm[axis])
    }

    /// Whether less than all is commanded at the bound.
    pub(super) fn is_reduced(&self) -> bool {
        self.dose.iter().any(|dose| *dose < 1.0)
    }

    /// Nothing of it is commanded.
    pub(super) fn none(&mut self) {
        self.part = 0.0;
    }

    /// By how much the offset was kept from what was due in a period, mm.
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
