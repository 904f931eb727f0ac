//! The family of controllers. Once a feed period, each decides the feedrate along the path and the
//! offset from it.
//!
//! To add a controller: one file here and one row in the table of the library.

pub(crate) mod uncorrected;
pub(crate) mod feedforward;
pub(crate) mod lqg_preview;
mod trial;
pub(crate) mod inverting;
pub(crate) mod magnitude_only;
pub(crate) mod two_dimensional;

use crate::axis::AxisModel;
use crate::command::{Command, FaultEvidence, Measured};
use crate::window::Window;

/// Feed period and preview that a controller requests.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schedule {
    /// Servo periods in a feed period, at least 1.
    pub servo_periods: u32,
    /// Feed periods of preview; together at most `PREVIEW_KNOTS` servo periods.
    pub preview: u32,
}

/// Interface of a controller. The conformance tests of the library admit a controller: rest stays
/// rest, the same input gives the same bits, a reset is complete, a NaN measurement gives a finite
/// command.
pub trait Controller<const N: usize> {
    /// Returns the feed period and the preview.
    fn schedule(&self) -> Schedule;
    /// Resets the state to the one after construction.
    fn reset(&mut self);
    /// Starts the same part once more and keeps what was learned from it.
    fn next_lap(&mut self) {
        self.reset();
    }
    /// Learns from the result of the last feed period. The window has the actual commands up to
    /// now, which can differ from the requested ones. `measured` is their result, `None` where the
    /// position was lost. Called once a feed period, before [`Self::command`], which is not called
    /// where nothing was measured.
    fn observe(&mut self, window: &Window<'_, N>, measured: Option<&Measured<N>>) {
        let _ = (window, measured);
    }
    /// Returns the distance between the last prediction and the measurement, mm; 0 without a
    /// prediction. `supervisor` reads it after each decision.
    fn prediction_error_mm(&self) -> f64 {
        0.0
    }
    /// Returns why [`Self::prediction_error_mm`] is infinite, where that rests on a comparison.
    fn doubt(&self) -> Option<FaultEvidence> {
        None
    }
    /// Returns the axes as the controller knows them now, if it uses such knowledge. A controller
    /// that learns returns other axes than the ones of its construction.
    fn known(&self) -> Option<[AxisModel; N]> {
        None
    }
    /// Returns for each axis whether the controller follows a model that it learned in motion.
    fn learned(&self) -> [bool; N] {
        [false; N]
    }
    /// Returns the displacement of the tool by the offset, mm, as the controller's model predicts
    /// it. `None` without such a model.
    fn moved_mm(&self) -> Option<[f64; N]> {
        None
    }
    /// Returns true if the controller reduces the contour error. A controller that excites the
    /// machine to identify it returns false, and is not disengaged for a larger error.
    fn corrects(&self) -> bool {
        true
    }
    /// Returns true if the offset acts in the servo period of its decision, not in the next one.
    /// Such a controller decides in every servo period, and within it.
    fn acts_at_once(&self) -> bool {
        false
    }
    /// Decides the command of the next feed period.
    fn command(&mut self, window: &Window<'_, N>, measured: &Measured<N>) -> Command<N>;
}
