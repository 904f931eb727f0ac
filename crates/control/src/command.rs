//! Input and output of a controller, and its report on itself.
//!
//! The command of a feed period is the path, run at `rate` times the planned feed, plus an offset
//! that moves to `offset_mm`:
//!
//! ```text
//! P'(t) = P*(tau(t)) + o(t),   tau(k+1) = tau(k) + rate T,   o(k+1) = offset_mm
//! ```
//!
//! In the paper's words: P'(k+1) = P'(k) + F T with F = F(0) + dF, where the part of dF along F(0)
//! makes the rate and the part across it makes the new offset.

use crate::contour_error::ContourError;
use crate::vector::{add_scaled, scale, sub};
use crate::window::Window;

/// Measured state of the machine at the start of a feed period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured<const N: usize> {
    /// Position of the tool, mm.
    pub position_mm: [f64; N],
    /// Its contour error against the programmed path.
    pub contour: ContourError<N>,
}

/// Command for the next feed period. Within the period the offset moves from its start to its end
/// along
///
/// ```text
/// o(s) = o(0) + s (o(1) - o(0)) - s (1 - s) bend      s = 0 .. 1
/// ```
///
/// This is a line where the bend is zero. With `bend = T^2 a / 2` the offset has the acceleration a
/// throughout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command<const N: usize> {
    /// Speed along the path as a multiple of the planned feedrate; 1 leaves the plan as it is.
    pub rate: f64,
    /// Offset of the command from the path at the end of the feed period, mm.
    pub offset_mm: [f64; N],
    /// Deviation of the offset's motion from a straight line, mm.
    pub bend_mm: [f64; N],
}

impl<const N: usize> Command<N> {
    /// Follows the path at the planned feedrate without an offset.
    pub const AS_PLANNED: Self = Self::straight(1.0, [0.0; N]);

    /// Creates a command whose offset moves along a line.
    pub const fn straight(rate: f64, offset_mm: [f64; N]) -> Self {
        Self {
            rate,
            offset_mm,
            bend_mm: [0.0; N],
        }
    }

    /// Creates a command whose offset accelerates by `acceleration_mm_s2` from its present place
    /// and `speed_mm_s`.
    #[inline]
    pub fn accelerated(
        window: &Window<'_, N>,
        speed_mm_s: [f64; N],
        acceleration_mm_s2: [f64; N],
    ) -> Self {
        let period_s = window.feed_period_s;
        let bend_mm = scale(0.5 * period_s * period_s, acceleration_mm_s2);
        let moved_mm = add_scaled(bend_mm, period_s, speed_mm_s);
        Self {
            rate: 1.0,
            offset_mm: add_scaled(window.offset_mm, 1.0, moved_mm),
            bend_mm,
        }
    }

    /// Returns the offset after a part of the feed period, which begins at `from_mm`.
    #[inline]
    pub fn offset_after_mm(&self, part: f64, from_mm: [f64; N]) -> [f64; N] {
        let line = add_scaled(from_mm, part, sub(self.offset_mm, from_mm));
        add_scaled(line, -part * (1.0 - part), self.bend_mm)
    }

    /// Returns the speed of the offset at the end of a feed period of `period_s`, which begins at
    /// `from_mm`.
    #[inline]
    pub fn offset_mm_s(&self, from_mm: [f64; N], period_s: f64) -> [f64; N] {
        scale(
            1.0 / period_s,
            add_scaled(sub(self.offset_mm, from_mm), 1.0, self.bend_mm),
        )
    }
}

/// Report of a controller on itself after a decision.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SelfReport<const N: usize> {
    /// Distance between the last prediction and the measurement, mm; 0 without a prediction.
    pub missed_mm: f64,
    /// Verdict on the model with which it predicts.
    pub model: Verdict,
    /// Displacement of the tool by the offset, mm, as that model predicts it; `None` without one.
    pub moved_mm: Option<[f64; N]>,
    /// True for each axis that follows a model that was learned in motion.
    pub learned: [bool; N],
    /// True if the controller reduces the contour error. A controller that excites the machine to
    /// identify it does not, and is not disengaged for a larger error.
    pub corrects: bool,
    /// True if the offset acts in the servo period of its decision, not in the next one. Such a
    /// controller decides in every servo period, and within it.
    pub acts_at_once: bool,
}

impl<const N: usize> SelfReport<N> {
    /// Report of a controller that corrects without a model.
    pub const CORRECTS: Self = Self {
        missed_mm: 0.0,
        model: Verdict::Sound,
        moved_mm: None,
        learned: [false; N],
        corrects: true,
        acts_at_once: false,
    };
}

/// Verdict of a test, with its evidence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Verdict {
    /// The test found nothing.
    Sound,
    /// The evidence is not sufficient yet.
    Suspect {
        /// Error, and the limit that it approached or exceeded.
        evidence: FaultEvidence,
    },
    /// The evidence is sufficient.
    Wrong {
        /// Error, and the limit that it exceeded; `None` where no error was compared.
        evidence: Option<FaultEvidence>,
    },
}

/// Measured error that caused a fault, and the limit that it exceeded, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaultEvidence {
    /// Measured error, mm.
    pub found_mm: f64,
    /// Largest permitted error, mm.
    pub limit_mm: f64,
}
