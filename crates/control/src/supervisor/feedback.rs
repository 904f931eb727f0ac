//! Question: can the measured position be true?
//!
//! | It is lost | Test, in every servo period |
//! |---|---|
//! | not a number | NaN or infinite |
//! | leaped | it moved farther than twice the highest speed allows |
//! | frozen | unchanged for [`FROZEN_S`], while the command moved by [`FROZEN_MM`] |
//!
//! Evidence: the position and the command alone; no model is used.

use crate::vector::{norm, sub};

/// Time after which a position that does not change while the command moves is frozen, s.
const FROZEN_S: f64 = 0.012;
/// Distance of the command from its place at the last change of the position beyond which it counts
/// as moving, mm: less does not overcome the static friction of a machine. The distance counts, not
/// the travel: a correction that holds a tool back moves to and fro.
const STIRRED_MM: f64 = 0.02;
/// Distance of the command beyond which a position is frozen, mm: the loop of any machine that
/// follows has then overcome its friction and moved the tool by more than an encoder step of a few
/// micrometers.
const FROZEN_MM: f64 = 0.12;
/// Factor on the highest speed that no tool exceeds.
const LEAP: f64 = 2.0;

/// Recent measurements.
#[derive(Debug, Clone)]
pub(crate) struct Feedback<const N: usize> {
    /// Last plausible position, mm, and the servo periods since then.
    last_mm: Option<[f64; N]>,
    since: u32,
    /// Time without a change of the position, s, and the place of the command when that began, mm.
    still_s: f64,
    commanded_mm: Option<[f64; N]>,
    /// True if a servo period since the last decision had no plausible position.
    lost: bool,
}

impl<const N: usize> Feedback<N> {
    pub(crate) const NONE: Self = Self {
        last_mm: None,
        since: 0,
        still_s: 0.0,
        commanded_mm: None,
        lost: false,
    };

    /// Takes in the position at the start of a servo period of `servo_s`, at which the command was
    /// at `command_mm`.
    #[inline]
    pub(crate) fn take_in(
        &mut self,
        position_mm: [f64; N],
        command_mm: [f64; N],
        servo_s: f64,
        most_mm_s: f64,
    ) {
        let moved_mm = self
            .last_mm
            .map_or(0.0, |last_mm| norm(sub(position_mm, last_mm)));
        self.since = self.since.saturating_add(1);
        let can_mm = LEAP * most_mm_s * servo_s * f64::from(self.since);
        let there = moved_mm <= can_mm && norm(position_mm).is_finite();
        if there {
            self.since = 0;
            self.last_mm = Some(position_mm);
        }
        if there && moved_mm > 0.0 {
            (self.still_s, self.commanded_mm) = (0.0, None);
        }
        // A command that comes to the place where the tool rests goes no farther.
        let since_mm = norm(sub(
            command_mm,
            *self.commanded_mm.get_or_insert(command_mm),
        ));
        let way_mm = since_mm.min(norm(sub(command_mm, position_mm)));
        self.still_s += if way_mm > STIRRED_MM { servo_s } else { 0.0 };
        self.lost |= !there || (self.still_s > FROZEN_S && way_mm > FROZEN_MM);
    }

    /// Returns true if the position was lost since the last decision, and clears the record.
    #[inline]
    pub(crate) fn take_lost(&mut self) -> bool {
        core::mem::replace(&mut self.lost, false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Servo periods of 1 ms until a fault that begins at the hundredth is seen, at 10 mm/s.
    fn seen_after(fault: impl Fn(u32, f64) -> f64) -> Option<u32> {
        let mut feedback = Feedback::<1>::NONE;
        for n in 0..200 {
            let command_mm = 0.01 * f64::from(n);
            let true_mm = command_mm - 0.2;
            let measured_mm = if n < 100 { true_mm } else { fault(n, true_mm) };
            feedback.take_in([measured_mm], [command_mm], 0.001, 400.0);
            if feedback.take_lost() {
                return Some(n - 100);
            }
        }
        None
    }

    #[test]
    fn every_fault_is_seen_within_twenty_milliseconds_and_no_other() {
        assert_eq!(seen_after(|_, position_mm| position_mm), None);
        assert_eq!(seen_after(|_, _| f64::NAN), Some(0));
        assert_eq!(
            seen_after(|n, position_mm| if n == 100 { f64::INFINITY } else { position_mm }),
            Some(0)
        );
        assert_eq!(seen_after(|_, position_mm| position_mm + 1.0), Some(0));
        let frozen = seen_after(|_, _| 0.8).expect("a frozen position is seen");
        assert!(frozen <= 17, "{frozen}");
        // A machine that lags far behind starts: its first encoder step is 16 ms after the command,
        // which is 0.2 mm away by then.
        let mut feedback = Feedback::<1>::NONE;
        for n in 0..16 {
            feedback.take_in([0.0], [8e-4 * f64::from(n * n)], 0.001, 400.0);
            assert!(!feedback.take_lost(), "{n}");
        }
        // A correction moves to and fro to hold the tool back while the path begins.
        let mut feedback = Feedback::<1>::NONE;
        for n in 0..40 {
            feedback.take_in(
                [0.0],
                [if n % 4 < 2 { 0.015 } else { -0.015 }],
                0.001,
                400.0,
            );
            assert!(!feedback.take_lost(), "{n}");
        }
        // The command comes to rest where the tool is, from behind it.
        for n in 0..60 {
            feedback.take_in([0.2], [if n < 2 { 0.0 } else { 0.2 }], 0.001, 400.0);
            assert!(!feedback.take_lost(), "{n}");
        }
        // Steps of 1 um.
        assert_eq!(
            seen_after(|_, position_mm| libm::round(position_mm * 1e3) * 1e-3),
            None
        );
    }
}
