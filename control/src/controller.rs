//! The family of controllers: each decides, once a feed period, how fast to go on along the path and how far beside it.
//!
//! The command of a feed period is the path, run at `rate` times the planned feed, plus an offset that moves linearly to
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

pub mod contour_compensation;
pub mod cross_coupled;
pub mod fuzzy_feedrate;
pub mod feedforward;
pub mod inverting;
pub mod magnitude_only;
pub mod open_loop;
pub mod receding_horizon;
pub mod two_dimensional;
pub mod zero_phase;

use crate::contour_error::ContourError;
use crate::window::Window;

/// How often a controller wants to decide, and how far it wants to see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schedule {
    /// Servo periods in a feed period, at least 1.
    pub servo_periods: u32,
    /// Feed periods of preview; together at most [`crate::window::PREVIEW_KNOTS`] servo periods.
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

/// What to do in the next feed period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Command<const N: usize> {
    /// Speed along the path as a multiple of the planned feedrate; 1 leaves the plan as it is.
    pub rate: f64,
    /// Offset of the command from the path at the end of the feed period, mm.
    pub offset_mm: [f64; N],
}

impl<const N: usize> Command<N> {
    /// The path at the planned feed.
    pub const AS_PLANNED: Self = Self { rate: 1.0, offset_mm: [0.0; N] };
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
    /// Learns from what the last command led to. Called once a feed period, before [`Self::command`].
    fn observe(&mut self, measured: &Measured<N>);
    /// By how much the last prediction missed what was measured, mm; 0 where there was none. [`crate::safety`] reads it
    /// after each decision.
    fn missed_mm(&self) -> f64 {
        0.0
    }
    /// Whether it means to make the contour error smaller. One that excites the machine to identify it does not, and is
    /// not taken out of the loop for making it larger.
    fn corrects(&self) -> bool {
        true
    }
    /// Decides.
    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N>;
}
