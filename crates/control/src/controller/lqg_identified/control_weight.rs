//! Settings of the controller.

use crate::axis::{AxisModel, Parameters};
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
/// Shortest time constant Ta of the weight of the second difference of the command, in servo
/// periods, with an identified model; the weight is its fourth power. The command alternates with
/// less: in 11,292 servo periods of a plate in inches on `workshop`, in 9 with this.
const LEAST_TIME: f64 = 0.5;
/// Ratio of one time constant to the one before, and the number of them.
const TIME_RATIO: f64 = core::f64::consts::SQRT_2;
const TIMES: u32 = 10;
/// RMS acceleration of the command at constant speed, part of the smallest limit of the axes.
const NOISE_SHARE: f64 = 0.1;
/// Shortest time constant of the regulator of a compliant screw, in radians of its resonance, where
/// the model may be wrong: the model of the regulator has no backlash. On `soft`, 2 leaves 0.6 of
/// the error that 0 leaves on star, circle and square, and 0.1 on pocket.
const SCREW_RAD: f64 = 2.0;

/// Variance of the measurement that the filter assumes, times the stated one, where the acceleration
/// of the command is limited: the less it follows a measurement, the larger are the margins of the
/// loop. With 16 the gain margin on `workshop` is 2.0 and its phase margin 40 degrees, with 4 they
/// are 1.7 and 31, with 1 1.5 and 25; `router`, whose command is at its limit all the time, leaves
/// 611 um with 1, where 255 are uncorrected, and 211 with 16. `stiff` has sound margins with 8 too,
/// but where the machine differs a little from its model, up to 0.75 of the error is left with it.
/// Without a limit the first motion counts more: a machine three times as heavy as its model is worse
/// with 4.
const ASSUMED_NOISE: f64 = 16.0;

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
            command_weight: LEAST_TIME * LEAST_TIME * LEAST_TIME * LEAST_TIME,
            bounds,
            learns: true,
            is_known: true,
        }
    }

    /// Returns the least weight of the second difference of the command, from the one of these
    /// settings on, whose noise is within the budget of an axis. `noise_rad` returns the RMS of the
    /// second difference by its weight.
    pub(super) fn quiet_command_weight(
        &self,
        axis_model: &AxisModel,
        noise_rad: impl Fn(f64) -> f64,
    ) -> f64 {
        let (axis, servo_s) = (&axis_model.parameters, axis_model.periods.servo_s);
        let most_rad_s2 = NOISE_SHARE * self.bounds.acceleration_mm_s2 * axis.rad_per_mm;
        let most_rad = servo_s * servo_s * most_rad_s2;
        let ratio = TIME_RATIO * TIME_RATIO * TIME_RATIO * TIME_RATIO;
        let mut weight = self.command_weight;
        for _ in 1..TIMES {
            if noise_rad(weight) > most_rad {
                weight *= ratio;
            } else {
                break;
            }
        }
        weight
    }

    /// Returns the variance of the measurement that the filter assumes, times the stated one.
    pub(super) fn assumed_noise(&self) -> f64 {
        if self.learns && self.bounds.limits_acceleration() {
            ASSUMED_NOISE
        } else {
            1.0
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
