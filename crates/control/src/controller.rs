//! The family of controllers: each decides, once a feed period, how fast to go on along the path and how far beside it.
//!
//! The command of a feed period is the path, run at `rate` times the planned feed, plus an offset that moves to
//! `offset_mm`:
//!
//! ```text
//! P'(t) = P*(tau(t)) + o(t),   tau(k+1) = tau(k) + rate T,   o(k+1) = offset_mm
//! ```
//!
//! In the paper's words: P'(k+1) = P'(k) + F T with F = F(0) + dF, where the part of dF along F(0) makes the rate and
//! the part across it makes the new offset.
//!
//! To add a controller: one file here and one row in the table of the library.

pub(crate) mod uncorrected;
pub(crate) mod feedforward;
pub(crate) mod lqg_preview;
pub(crate) mod inverting;
pub(crate) mod magnitude_only;
pub(crate) mod two_dimensional;
pub(crate) mod receding_horizon;

use crate::axis::knowledge::AxisKnowledge;
use crate::contour_error::ContourError;
use crate::vector::{add_scaled, scale, sub};
use crate::window::Window;

/// How often a controller wants to decide, and how far it wants to see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schedule {
    /// Servo periods in a feed period, at least 1.
    pub servo_periods: u32,
    /// Feed periods of preview; together at most `PREVIEW_KNOTS` servo periods.
    pub preview: u32,
}

/// What is known of the machine at the start of a feed period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured<const N: usize> {
    /// Where the tool is, mm.
    pub position_mm: [f64; N],
    /// Its contour error against the programmed path.
    pub contour: ContourError<N>,
}

/// What to do in the next feed period. Within it the offset goes from where it is to its end along
///
/// ```text
/// o(s) = o(0) + s (o(1) - o(0)) - s (1 - s) bend      s = 0 .. 1
/// ```
///
/// a line where the bend is zero; with `bend = T^2 a / 2` it has the acceleration a throughout.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command<const N: usize> {
    /// Speed along the path as a multiple of the planned feedrate; 1 leaves the plan as it is.
    pub rate: f64,
    /// Offset of the command from the path at the end of the feed period, mm.
    pub offset_mm: [f64; N],
    /// How far the way of the offset is bent, mm.
    pub bend_mm: [f64; N],
}

impl<const N: usize> Command<N> {
    /// The path at the planned feed.
    pub const AS_PLANNED: Self = Self::straight(1.0, [0.0; N]);

    /// An offset that moves along a line.
    pub const fn straight(rate: f64, offset_mm: [f64; N]) -> Self {
        Self { rate, offset_mm, bend_mm: [0.0; N] }
    }

    /// An offset that accelerates by so much, from the place that it has and this speed.
    #[inline]
    pub fn accelerated(window: &Window<'_, N>, speed_mm_s: [f64; N], acceleration_mm_s2: [f64; N]) -> Self {
        let period_s = window.feed_period_s;
        let bend_mm = scale(0.5 * period_s * period_s, acceleration_mm_s2);
        let moved_mm = add_scaled(bend_mm, period_s, speed_mm_s);
        Self { rate: 1.0, offset_mm: add_scaled(window.offset_mm, 1.0, moved_mm), bend_mm }
    }

    /// Offset after a part of the feed period, which begins at `from_mm`.
    #[inline]
    pub fn offset_after_mm(&self, part: f64, from_mm: [f64; N]) -> [f64; N] {
        let line = add_scaled(from_mm, part, sub(self.offset_mm, from_mm));
        add_scaled(line, -part * (1.0 - part), self.bend_mm)
    }

    /// Speed of the offset at the end of a feed period of `period_s`, which begins at `from_mm`.
    #[inline]
    pub fn offset_mm_s(&self, from_mm: [f64; N], period_s: f64) -> [f64; N] {
        scale(1.0 / period_s, add_scaled(sub(self.offset_mm, from_mm), 1.0, self.bend_mm))
    }
}

/// What was found, and from where on it is a fault, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FaultEvidence {
    /// What was found.
    pub found_mm: f64,
    /// What it may be.
    pub limit_mm: f64,
}

/// The contract. A controller is admitted by the conformance tests of the library: rest stays rest, the same input gives
/// the same bits, a reset is complete, a measurement that is not a number gives a command that is.
pub trait Controller<const N: usize> {
    /// When and how far.
    fn schedule(&self) -> Schedule;
    /// Back to the state after construction.
    fn reset(&mut self);
    /// The same part is cut once more: what was learnt of it is kept.
    fn next_lap(&mut self) {
        self.reset();
    }
    /// Learns from what the last feed period led to: what was really commanded on the way here is in the window, whatever was
    /// asked for; what came of it is in `measured`, none where the position was lost. Called once a feed period, before
    /// [`Self::command`], which is not called where nothing was measured.
    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        let _ = (window, measured);
    }
    /// Distance between the last prediction and the measurement, mm; 0 without a prediction. `safety` reads
    /// it after each decision.
    fn prediction_error_mm(&self) -> f64 {
        0.0
    }
    /// Why [`Self::prediction_error_mm`] is infinite, where that rests on a comparison.
    fn doubt(&self) -> Option<FaultEvidence> {
        None
    }
    /// The axes as it knows them now, if it goes by such knowledge: one that learns knows others than it was made with.
    fn known(&self) -> Option<[AxisKnowledge; N]> {
        None
    }
    /// Which axes it follows by what it learned while they moved.
    fn learned(&self) -> [bool; N] {
        [false; N]
    }
    /// Displacement of the tool by the offset, mm, as the controller's model predicts it. `None`
    /// without such a model.
    fn moved_mm(&self) -> Option<[f64; N]> {
        None
    }
    /// Mean squares of the contour error that the last decision foresees with its correction and without, mm^2.
    fn foreseen_mm2(&self) -> [f64; 2] {
        [0.0; 2]
    }
    /// Called after every decision with the over-correction factor that was measured lately. The
    /// factor is 0 where neither more nor less correction would have been better, and 1 where no
    /// correction would have been as good. It is negative where more would have been better.
    fn judged(&mut self, overdone: f64) {
        let _ = overdone;
    }
    /// Whether it means to make the contour error smaller. One that excites the machine to identify it does not, and is
    /// not taken out of the loop for making it larger.
    fn corrects(&self) -> bool {
        true
    }
    /// Whether its offset is there in the servo period in which it was decided, and not only in the next. It has to decide in every
    /// servo period, and within it.
    fn acts_at_once(&self) -> bool {
        false
    }
    /// Decides.
    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N>;
}
