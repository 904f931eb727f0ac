//! Restraint of the plan: where a correction cannot undo the whole error, it undoes a part of it
//! and does no harm.
//!
//! ```text
//! q = q_0 + (n / D)^4 + q_s b^k + (a / S)^8     D = min(D_max, 2 A t^2)
//! n = max_i (|eps_i|^2 + (z_i theta_i)^2)^(1/2)
//! l = L min(1, u / U)^2             u = max((e^2 - e_0^2)^(1/2) / e)
//! ```
//!
//! n is the error of the tool in the worst knot of the horizon: across the path, and along it as
//! far as the path turns back there (z). D is the deviation limit, or the distance that the offset
//! covers within t under the smallest acceleration limit A, if this is less. t is the time that the
//! tool takes to follow an offset, but at least the lag that the horizon is made for (its length /
//! `LAGS_AHEAD`). The second case applies to a machine whose own feedforward leaves hardly any lag.
//! Where n exceeds D, no offset within the limits undoes the whole error, and an offset cut off at
//! a limit can be worse than none. A servo is nearly linear, however: every *part* of a correction
//! that helps also helps.
//!
//! u is 1 where the RMS contour error e over the first half of the horizon is far above e_0. The
//! plan must then not reduce it by a tool that is late or early, because such a tool cuts corners
//! off.
//!
//! The third term, in decision k, acts at the start, when no earlier plan exists. The last term
//! acts for drives at their limit: a is the largest acceleration of the tool, as a share of the
//! acceleration at the torque limit of its drive. After a rapid that demands more, the tool is late
//! for the cut, and a correction for the wrong position goes wrong.

use feedwright_control::vector::fourth_power;

use super::{CorrectionLimits, HorizonSettings};

/// q at the most.
const MAX_OFFSET_WEIGHT: f64 = 10.0;
/// Distance that an offset with the acceleration A covers within t, in A t^2: it has some of the
/// time before, and some behind.
const REACH: f64 = 2.0;
/// Decay factor of n and u from one tick to the next where they become smaller: the correction that
/// was held back returns gently.
const LEFT: f64 = 0.97;
/// q_s and b: q in the first decision, and its decay factor from one decision to the next.
const START_WEIGHT: f64 = 0.3;
const START_LEFT: f64 = 0.5;
/// S, and the most of that term: at 10, drilling behind rapids at the torque limit was still worse
/// by 2 um.
const DRIVE_SHARE: f64 = 0.8;
const MAX_LIMIT_WEIGHT: f64 = 100.0;
/// L, and U: the part of the contour error at which it is reached.
const LATE_WEIGHT: f64 = 0.6;
const UNDONE_SHARE: f64 = 0.3;
/// e_0: an RMS contour error that says nothing, mm; and its square.
const NOTHING_MM2: f64 = 1e-6;
/// The least mean square that a share is taken of, mm^2.
const MIN_MM2: f64 = 1e-12;

/// n, u and a lately.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Restraint {
    need_mm: f64,
    undone: f64,
    start_weight: f64,
    drive_share: f64,
}

impl Restraint {
    /// Restraint of a plan that has just begun.
    pub(super) const START: Self = Self {
        need_mm: 0.0,
        undone: 0.0,
        start_weight: START_WEIGHT,
        drive_share: 0.0,
    };

    /// Takes in n, mm; the mean square of the contour error over the horizon, mm^2; and a.
    pub(super) fn take_in(&mut self, need_mm: f64, contour_mm2: f64, drive_share: f64) {
        let undone =
            libm::sqrt((contour_mm2 - NOTHING_MM2).max(0.0) / contour_mm2.max(MIN_MM2)).min(1.0);
        self.need_mm = need_mm.max(LEFT * self.need_mm);
        self.undone = undone.max(LEFT * self.undone);
        self.start_weight *= START_LEFT;
        self.drive_share = drive_share.max(LEFT * self.drive_share);
    }

    /// The settings with q and l where an offset has the time t, s.
    pub(super) fn on<const N: usize>(
        &self,
        settings: &HorizonSettings<N>,
        time_s: f64,
    ) -> HorizonSettings<N> {
        let weight = settings.offset_weight
            + self.start_weight
            + fourth_power(self.need_mm / within_mm(&settings.limits, time_s));
        let at_limit = fourth_power(self.drive_share / DRIVE_SHARE);
        let at_limit = at_limit * at_limit;
        let share = (self.undone / UNDONE_SHARE).min(1.0);
        HorizonSettings {
            offset_weight: weight.min(MAX_OFFSET_WEIGHT) + at_limit.min(MAX_LIMIT_WEIGHT),
            late_weight: settings.late_weight.max(LATE_WEIGHT * share * share),
            ..*settings
        }
    }
}

/// D, mm.
fn within_mm<const N: usize>(limits: &CorrectionLimits<N>, time_s: f64) -> f64 {
    let least_mm_s2 = limits
        .acceleration_mm_s2
        .iter()
        .copied()
        .fold(f64::INFINITY, f64::min);
    limits
        .deviation_mm
        .min(REACH * least_mm_s2 * time_s * time_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SETTINGS: HorizonSettings<2> = HorizonSettings {
        limits: CorrectionLimits {
            acceleration_mm_s2: [400.0, 100.0],
            deviation_mm: 0.5,
            ..CorrectionLimits::NONE
        },
        ..HorizonSettings::EXAMPLE
    };

    /// Returns the settings after as many decisions as the start takes, without any error, and one
    /// more decision with these errors.
    fn restrained(need_mm: f64, contour_mm2: f64, lag_s: f64) -> HorizonSettings<2> {
        let mut restraint = Restraint::START;
        (0..100).for_each(|_| restraint.take_in(0.0, 0.0, 0.0));
        restraint.take_in(need_mm, contour_mm2, 0.0);
        restraint.on(&SETTINGS, lag_s)
    }

    #[test]
    fn what_is_needed_beyond_the_deviation_or_beyond_what_the_acceleration_reaches_has_a_cost() {
        assert!(restrained(0.01, 0.0, 0.1).offset_weight < 1e-6);
        assert!((restrained(0.25, 0.0, 0.1).offset_weight - 0.0625).abs() < 1e-12);
        // 2 * 100 mm/s^2 * (20 ms)^2 = 0.08 mm: the slowest of the axes there are.
        assert!((restrained(0.04, 0.0, 0.02).offset_weight - 0.0625).abs() < 1e-12);
        assert!((restrained(1e9, 0.0, 0.1).offset_weight - MAX_OFFSET_WEIGHT).abs() < 1e-12);
    }

    #[test]
    fn where_drives_are_at_their_limit_hardly_anything_is_corrected_for_a_while() {
        let mut restraint = Restraint::START;
        (0..100).for_each(|_| restraint.take_in(0.0, 0.0, 0.5));
        assert!(restraint.on(&SETTINGS, 0.1).offset_weight < 0.03);
        restraint.take_in(0.0, 0.0, 1.0);
        assert!((restraint.on(&SETTINGS, 0.1).offset_weight - 0.8_f64.powi(-8)).abs() < 1e-3);
        restraint.take_in(0.0, 0.0, 1e9);
        assert!(restraint.on(&SETTINGS, 0.1).offset_weight >= MAX_LIMIT_WEIGHT);
    }

    #[test]
    fn what_the_plan_leaves_across_holds_it_along() {
        assert!(restrained(0.0, 1e-6, 0.1).late_weight < 1e-12);
        // e^2 = 1.01 e_0^2: u is the root of 0.01 / 1.01.
        let share = (0.01 / 1.01) / (UNDONE_SHARE * UNDONE_SHARE);
        assert!((restrained(0.0, 1.01e-6, 0.1).late_weight - LATE_WEIGHT * share).abs() < 1e-9);
        assert!((restrained(0.0, 1.0, 0.1).late_weight - LATE_WEIGHT).abs() < 1e-12);
    }

    #[test]
    fn a_start_is_gentle_and_what_was_needed_is_forgotten() {
        let mut restraint = Restraint::START;
        assert!(restraint.on(&SETTINGS, 0.1).offset_weight > 0.2);
        restraint.take_in(0.5, 0.0, 0.0);
        (0..200).for_each(|_| restraint.take_in(0.0, 0.0, 0.0));
        assert!(restraint.on(&SETTINGS, 0.1).offset_weight < 1e-9);
    }
}
