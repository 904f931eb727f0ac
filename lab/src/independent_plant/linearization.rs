//! Linear part of an axis for small and slow motion: gains and delays to compare an identification
//! with.
//!
//! ```text
//! Kp Kv / J,  (Kv + B) / J     Kv = kv Kt, J = Jm + m0 r^2, B = s2 of the motor + r^2 s2 of the table
//! command delay                bus + Ts - Td on lines, bus + (Ts - Td) / 2 held
//! loop delay                   sensor + Td / 2 of the hold + 1 / wc + Tc of the current loop
//! lag                          (1 - f) / Kp + command delay: following error over speed, as recorded, where the integral has settled
//! ```
//!
//! Delays are absolute; the model of `crates/control/src/axis.rs` holds its reference for a servo
//! period in addition to its delay.

use serde::Serialize;

use super::IndependentAxis;

/// Linear part of an axis.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct LinearPart {
    /// Kp Kv / J, 1/s2.
    pub gain_product_1_s2: f64,
    /// (Kv + B) / J, 1/s.
    pub speed_loop_1_s: f64,
    /// Velocity feedforward.
    pub velocity_feedforward: f64,
    /// Delay of a command at the position loop, s.
    pub command_delay_s: f64,
    /// Delay from the position through the loops to the torque, s.
    pub loop_delay_s: f64,
    /// Following error over speed, s.
    pub lag_s: f64,
}

impl LinearPart {
    /// Computes the linear part of an axis.
    pub fn of(axis: &IndependentAxis) -> Self {
        let IndependentAxis {
            feed,
            cascade,
            encoder,
            scale,
            ..
        } = axis;
        let inertia = feed.inertia_kg_m2();
        let gain = cascade.speed_gain_a_s * feed.motor.torque_nm_a;
        let viscous = feed.motor.friction.viscous
            + feed.screw.travel_m_rad.powi(2) * feed.table.friction.viscous;
        let (servo_s, drive_s) = (cascade.servo_s(), cascade.drive_s());
        let line_s = if cascade.interpolates {
            servo_s - drive_s
        } else {
            0.5 * (servo_s - drive_s)
        };
        let command_delay_s = f64::from(cascade.bus_periods) * drive_s + line_s;
        let late_s = f64::from(scale.as_ref().unwrap_or(encoder).late_periods) * drive_s;
        Self {
            gain_product_1_s2: cascade.kp_1_s * gain / inertia,
            speed_loop_1_s: (gain + viscous) / inertia,
            velocity_feedforward: cascade.velocity_feedforward,
            command_delay_s,
            loop_delay_s: late_s + 0.5 * drive_s + 1.0 / cascade.current_rad_s + cascade.current_s,
            lag_s: (1.0 - cascade.velocity_feedforward) / cascade.kp_1_s + command_delay_s,
        }
    }
}
