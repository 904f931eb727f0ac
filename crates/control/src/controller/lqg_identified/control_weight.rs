//! Settings of the controller.

use crate::axis::Parameters;
use crate::controller::OffsetBounds;
use crate::controller::row::Parameter;

/// Settings of the controller.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LqgSettings {
    /// Weight of the reference speed against the position error near the reference, s^2.
    pub control_weight_s2: f64,
    /// Weight of the second difference of the command against the position error near the
    /// reference; 0 omits it.
    pub command_weight: f64,
    /// Bounds of the offset.
    pub bounds: OffsetBounds,
    /// True if model and statistics may be wrong: both are learned, and a wrong model is not
    /// followed. Otherwise both are exact.
    pub learns: bool,
    /// True if the controller was used on this machine before. Otherwise the models have to pass a
    /// test on this machine before anything is corrected.
    pub is_known: bool,
}

/// Control weight used with an identified model, in servo periods squared. A weight of 1 leaves 50
/// % more error on `workshop`. While the model is not followed, both weights are 256 times as high.
pub const IDENTIFIED_WEIGHT: Parameter = Parameter::number(
    "control_weight",
    0.01,
    [1e-6, 1e4],
    None,
    "weight of the reference speed against the error, in servo periods squared, near the reference: a high one leaves the error",
)
.of_unit("servo periods squared");
/// Weight of the second difference of the command with an identified model: the fourth power of
/// half a servo period, in servo periods. With it the command for a plate in inches alternates in 9
/// servo periods on `workshop`, and in 130 on `stiff`; without it in 11,292 and 1,523.
const COMMAND_WEIGHT: f64 = 0.0625;
/// Shortest time constant of the regulator of a compliant screw, in radians of its resonance, where
/// the model may be wrong: the model of the regulator has no backlash. On `soft`, 2 leaves 0.6 of
/// the error that 0 leaves on star, circle and square, and 0.1 on pocket.
const SCREW_RAD: f64 = 2.0;

impl LqgSettings {
    /// Control weight of a tenth of a servo period of 1 ms, squared.
    pub const DEFAULT: Self = Self {
        control_weight_s2: 1e-8,
        command_weight: 0.0,
        bounds: OffsetBounds::NONE,
        learns: false,
        is_known: true,
    };

    /// Creates the settings for an identified model; `control_weight` is in servo periods squared,
    /// with a servo period of `servo_s`.
    pub fn identified(control_weight: f64, servo_s: f64, bounds: OffsetBounds) -> Self {
        Self {
            control_weight_s2: control_weight * servo_s * servo_s,
            command_weight: COMMAND_WEIGHT,
            bounds,
            learns: true,
            is_known: true,
        }
    }

    /// Returns the control weight near the reference, for an axis with its screw.
    pub(super) fn lowest_control_weight_s2(&self, axis: &Parameters) -> f64 {
        if self.learns && axis.resonance_rad_s > 0.0 {
            let slow_s = SCREW_RAD / axis.resonance_rad_s;
            self.control_weight_s2.max(slow_s * slow_s)
        } else {
            self.control_weight_s2
        }
    }
}
