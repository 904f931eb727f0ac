//! What is read from a model file.

use feedwright_control::model::{BlockError, IdentifiedAxes, ModelBlock, Trained};

/// Why a model cannot be used here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refused {
    /// The bytes are no model of so many axes.
    Block(BlockError),
    /// It is of an identifier; identified axes are needed.
    Kind,
    /// It was identified with another servo period.
    Period,
}

/// Parts by which the period of a thread may differ from that of the model: threads of LinuxCNC are whole nanoseconds.
const PERIOD_TOLERANCE: f64 = 1e-3;

/// The axes in these bytes.
///
/// # Errors
/// What is wrong with them.
pub fn axes_of<const N: usize>(bytes: &[u8]) -> Result<IdentifiedAxes<N>, Refused> {
    match ModelBlock::from_bytes(bytes).map_err(Refused::Block)?.trained {
        Trained::Axes(axes) => Ok(axes),
        Trained::Contour(_) | Trained::Servo(..) => Err(Refused::Kind),
    }
}

/// Their servo period, s.
pub fn servo_s<const N: usize>(axes: &IdentifiedAxes<N>) -> f64 {
    axes.axes.first().map_or(0.0, |axis| axis.periods.servo_s)
}

/// Whether a model with a servo period of `theirs_s` is for a thread of `servo_s`.
pub fn fits(theirs_s: f64, servo_s: f64) -> bool {
    (servo_s / theirs_s - 1.0).abs() <= PERIOD_TOLERANCE
}
