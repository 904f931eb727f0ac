//! The family of controllers: each decides, once a feed period, how fast to go on along the path
//! and how far beside it.
//!
//! To add a controller: one file here and one row in the table of the library.

pub(crate) mod uncorrected;
pub(crate) mod feedforward;
pub(crate) mod lqg_preview;
mod trial;
pub(crate) mod inverting;
pub(crate) mod magnitude_only;
pub(crate) mod two_dimensional;

use crate::axis::knowledge::AxisKnowledge;
use crate::command::{Command, FaultEvidence, Measured};
use crate::window::Window;

/// How often a controller wants to decide, and how far it wants to see.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schedule {
    /// Servo periods in a feed period, at least 1.
    pub servo_periods: u32,
    /// Feed periods of preview; together at most `PREVIEW_KNOTS` servo periods.
    pub preview: u32,
}

/// The contract. A controller is admitted by the conformance tests of the library: rest stays rest,
/// the same input gives the same bits, a reset is complete, a measurement that is not a number
/// gives a command that is.
pub trait Controller<const N: usize> {
    /// When and how far.
    fn schedule(&self) -> Schedule;
    /// Back to the state after construction.
    fn reset(&mut self);
    /// The same part is cut once more: what was learnt of it is kept.
    fn next_lap(&mut self) {
        self.reset();
    }
    /// Learns from what the last feed period led to: what was really commanded on the way here is
    /// in the window, whatever was asked for; what came of it is in `measured`, none where the
    /// position was lost. Called once a feed period, before [`Self::command`], which is not called
    /// where nothing was measured.
    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        let _ = (window, measured);
    }
    /// Distance between the last prediction and the measurement, mm; 0 without a prediction.
    /// `supervisor` reads it after each decision.
    fn prediction_error_mm(&self) -> f64 {
        0.0
    }
    /// Why [`Self::prediction_error_mm`] is infinite, where that rests on a comparison.
    fn doubt(&self) -> Option<FaultEvidence> {
        None
    }
    /// The axes as it knows them now, if it goes by such knowledge: one that learns knows others
    /// than it was made with.
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
    /// Whether it means to make the contour error smaller. One that excites the machine to identify
    /// it does not, and is not taken out of the loop for making it larger.
    fn corrects(&self) -> bool {
        true
    }
    /// Whether its offset is there in the servo period in which it was decided, and not only in the
    /// next. It has to decide in every servo period, and within it.
    fn acts_at_once(&self) -> bool {
        false
    }
    /// Decides.
    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N>;
}
