//! What the link is given in every servo period of a test, where nothing is wrong.

use feedwright_servo::servo::{LinkInputs, LinkLimits};

/// Servo period, s.
pub(crate) const SERVO_S: f64 = 0.001;
/// Limits as in a configuration.
pub(crate) const LIMITS: LinkLimits =
    LinkLimits { delay_s: 0.010, deviation_mm: 0.5, speed_mm_s: 400.0, correction_mm_s2: 400.0, speed_alone: false };

/// A powered machine that cuts.
pub(crate) const fn cutting(command_mm: [f64; 2], actual_mm: [f64; 2]) -> LinkInputs<2> {
    LinkInputs { command_mm, actual_mm, powered: true, enabled: true, direct: false, spindle: false, cutting: true }
}
