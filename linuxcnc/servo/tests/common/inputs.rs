//! Inputs of the link in a servo period of a test in which nothing is wrong.

use feedwright_servo::limits::LinkLimits;
use feedwright_servo::servo::LinkInputs;
use feedwright_servo::through::Through;

/// Servo period, s.
pub(crate) const SERVO_S: f64 = 0.001;
/// Limits as in a configuration.
pub(crate) const LIMITS: LinkLimits = LinkLimits::DEFAULT;

/// Returns the inputs of a powered machine that cuts.
pub(crate) const fn cutting(command_mm: [f64; 2], actual_mm: [f64; 2]) -> LinkInputs<2> {
    LinkInputs {
        command_mm,
        actual_mm,
        through: Through::NONE,
        powered: true,
        enabled: true,
        direct: false,
        probing: false,
        spindle: false,
        cutting: true,
    }
}
