//! The command across the backlash of a screw: half of it ahead of the table, in the direction of travel.
//!
//! ```text
//! lead_i(tau) = b_i / 2 (first direction) + sum over reversals of +-b_i S((tau - tau_r) / T_i + 1/2),   S(x) = 3 x^2 - 2 x^3
//! T_i = sqrt(6 b_i / a_i)
//! ```
//!
//! At a reversal friction holds the table while the motor crosses the gap. The step S takes the acceleration a of the axis at most,
//! 6 b / T^2 at its ends, and so the shortest time that a step of this form can have. It is centered at the reversal: the table stands
//! there, and one half of the crossing falls in the time in which it slows down. Before the first motion the gap is taken to be centered.
//!
//! Symbols: b backlash, mm; a acceleration of the axis, mm/s2; tau plan time and tau_r that of a reversal, s.
//!
//! Source: Nordin and Gutman (2002), "Controlling mechanical systems with backlash: a survey", Automatica 38, section 4: the inverse of
//! the gap, with a crossing of finite speed.

use std::collections::VecDeque;

use feedwright_control::vector::smooth_step;

/// Speed of an axis below which its direction is not clear, mm/s: a hundredth of a slow feedrate.
const CLEAR_MM_S: f64 = 0.05;

/// A change of direction of an axis.
#[derive(Debug, Clone, Copy)]
struct Reversal {
    tau_s: f64,
    /// By which part of half the backlash the lead changes.
    change: f64,
}

/// The axis between its reversals.
#[derive(Debug, Clone, Default)]
struct AxisReversals {
    half_gap_mm: f64,
    crossing_s: f64,
    direction: f64,
    /// Lead of all reversals that are forgotten, in halves of the backlash.
    settled: f64,
    recent: VecDeque<Reversal>,
}

/// Finds the reversals of N axes in the reference, in order.
#[derive(Debug, Clone)]
pub(super) struct Reversals<const N: usize> {
    axes: [AxisReversals; N],
    step_s: f64,
    scanned: u64,
}

impl<const N: usize> Reversals<N> {
    /// Of axes with this backlash, mm, and acceleration, mm/s2; looks at the reference every `step_s`.
    pub(super) fn new(backlash_mm: [f64; N], accel_mm_s2: [f64; N], step_s: f64) -> Self {
        let axes = std::array::from_fn(|i| AxisReversals {
            half_gap_mm: 0.5 * backlash_mm[i],
            crossing_s: (6.0 * backlash_mm[i].abs() / accel_mm_s2[i]).sqrt().max(step_s),
            ..AxisReversals::default()
        });
        Self { axes, step_s, scanned: 0 }
    }

    /// By how much the command of each axis is ahead at plan time `tau_s`, mm; `speed` gives the speeds of the axes at a plan time.
    pub(super) fn lead_mm(&mut self, tau_s: f64, mut speed: impl FnMut(f64) -> [f64; N]) -> [f64; N] {
        if self.axes.iter().all(|axis| axis.half_gap_mm == 0.0) {
            return [0.0; N];
        }
        let longest_s = self.axes.iter().map(|axis| axis.crossing_s).fold(0.0, f64::max);
        while (self.scanned as f64) * self.step_s <= tau_s + longest_s {
            let at_s = self.scanned as f64 * self.step_s;
            for (axis, speed_mm_s) in self.axes.iter_mut().zip(speed(at_s)) {
                axis.take(at_s, speed_mm_s);
            }
            self.scanned += 1;
        }
        std::array::from_fn(|i| self.axes[i].lead_mm(tau_s))
    }

    /// Nothing is asked about plan times before `tau_s` any more.
    pub(super) fn forget_before(&mut self, tau_s: f64) {
        for axis in &mut self.axes {
            while let Some(first) = axis.recent.front().copied().filter(|first| first.tau_s + axis.crossing_s < tau_s) {
                axis.settled += first.change;
                axis.recent.pop_front();
            }
        }
    }
}

impl AxisReversals {
    fn take(&mut self, tau_s: f64, speed_mm_s: f64) {
        let direction = speed_mm_s.signum();
        if speed_mm_s.abs() > CLEAR_MM_S && direction != self.direction {
            self.recent.push_back(Reversal { tau_s, change: direction - self.direction });
            self.direction = direction;
        }
    }

    fn lead_mm(&self, tau_s: f64) -> f64 {
        let crossed = |reversal: &Reversal| {
            let part = (tau_s - reversal.tau_s) / self.crossing_s + 0.5;
            reversal.change * smooth_step(part.clamp(0.0, 1.0))
        };
        self.half_gap_mm * (self.settled + self.recent.iter().map(crossed).sum::<f64>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STEP_S: f64 = 1e-3;

    /// Forth for a second, a rest, and back.
    fn speed(tau_s: f64) -> [f64; 2] {
        [
            if tau_s < 1.0 {
                10.0
            } else if tau_s < 2.0 {
                0.0
            } else {
                -10.0
            },
            0.0,
        ]
    }

    #[test]
    fn the_command_is_half_the_gap_ahead_and_crosses_it_at_the_acceleration_of_the_axis() {
        let (backlash_mm, accel_mm_s2) = (0.02, 300.0);
        let mut reversals = Reversals::new([backlash_mm, 0.0], [accel_mm_s2; 2], STEP_S);
        let leads: Vec<f64> = (0..3000).map(|n| reversals.lead_mm(f64::from(n) * STEP_S, speed)[0]).collect();
        assert!((leads[500] - 0.01).abs() < 1e-15 && (leads[1900] - 0.01).abs() < 1e-15);
        assert!((leads[2000]).abs() < 1e-15 && (leads[2900] + 0.01).abs() < 1e-15);
        let accel = |n: usize| (leads[n + 1] - 2.0 * leads[n] + leads[n - 1]) / (STEP_S * STEP_S);
        let most_mm_s2 = (1500..2500).map(|n| accel(n).abs()).fold(0.0, f64::max);
        assert!(most_mm_s2 < 1.01 * accel_mm_s2 && most_mm_s2 > 0.8 * accel_mm_s2, "{most_mm_s2}");
        // Forgotten reversals stay in the lead.
        reversals.forget_before(3.0);
        assert!((reversals.lead_mm(3.0, speed)[0] + 0.01).abs() < 1e-15);
        assert_eq!(reversals.lead_mm(3.0, speed)[1], 0.0);
    }
}
