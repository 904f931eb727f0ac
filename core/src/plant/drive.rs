//! The way from the position loop to the motor: delay of the reference speed, steps of the torque command.
//!
//! ```text
//! w_ref(t) reaches the speed loop at t + d        u = q round(u / q),   q = 2 Tmax / 2^bits
//! ```
//!
//! The delay stands between the position loop, which runs in the control, and the speed loop, which runs in the drive: a
//! fieldbus and its two buffers. The torque command is a whole number of steps of the drive's current loop.
//!
//! Source: transport delay and amplitude quantisation as in Franklin, Powell and Workman (1998), chapters 4 and 10.

use crate::machine::{Axis, Period};

/// Longest delay, in servo periods.
const MAX_PERIODS: usize = 64;

/// References on their way to the drive; one for each axis.
#[derive(Debug, Clone)]
pub(super) struct Delay {
    /// A ring, one reference a servo period, rad/s.
    sent_rad_s: [f64; MAX_PERIODS],
    newest: usize,
    /// Whole servo periods of the delay, and the mechanics periods beyond.
    periods: usize,
    substeps: u32,
}

impl Delay {
    pub(super) fn new(axis: &Axis, period: &Period) -> Self {
        let total = (axis.drive_delay_s / period.mechanics_s).round();
        // The reader of machine files keeps it below the ring; what is made by hand is held to it.
        let most = ((MAX_PERIODS - 2) as u64 * u64::from(period.mechanics_per_servo)) as f64;
        let total = total.clamp(0.0, most) as u64;
        let per_servo = u64::from(period.mechanics_per_servo);
        Self {
            sent_rad_s: [0.0; MAX_PERIODS],
            newest: 0,
            periods: (total / per_servo) as usize,
            substeps: (total % per_servo) as u32,
        }
    }

    /// A new reference leaves the position loop.
    pub(super) fn send(&mut self, reference_rad_s: f64) {
        self.newest = (self.newest + 1) % MAX_PERIODS;
        self.sent_rad_s[self.newest] = reference_rad_s;
    }

    /// The reference at the drive in a mechanics period of this servo period.
    #[inline]
    pub(super) fn arrived(&self, substep: u32) -> f64 {
        let age = self.periods + usize::from(substep < self.substeps);
        self.sent_rad_s[(self.newest + MAX_PERIODS - age) % MAX_PERIODS]
    }
}

/// Step of the torque command, N m; 0 where it has none.
pub(super) fn torque_step_nm(axis: &Axis) -> f64 {
    axis.torque_bits.map_or(0.0, |bits| 2.0 * axis.torque_limit_nm / 2.0_f64.powi(bits as i32))
}

/// The nearest whole number of steps.
#[inline]
pub(super) fn in_steps(value: f64, step: f64) -> f64 {
    if step > 0.0 { (value / step).round() * step } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Machine;

    #[test]
    fn a_reference_arrives_after_the_delay_to_the_mechanics_period() {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let substeps = machine.period.mechanics_per_servo;
        for delay_s in [0.0, 0.0003, 0.001, 0.0027, 0.02] {
            let axis = Axis { drive_delay_s: delay_s, ..machine.axes[0] };
            let mut delay = Delay::new(&axis, &machine.period);
            let mut arrived_s = None;
            for period in 0..40_u32 {
                delay.send(if period >= 10 { 1.0 } else { 0.0 });
                for substep in 0..substeps {
                    let now_s = f64::from((period - 10.min(period)) * substeps + substep) * machine.period.mechanics_s;
                    if delay.arrived(substep) == 1.0 && arrived_s.is_none() {
                        arrived_s = Some(now_s);
                    }
                }
            }
            assert!((arrived_s.unwrap() - delay_s).abs() < 1e-9, "{delay_s}: {arrived_s:?}");
        }
    }

    #[test]
    fn twelve_bits_divide_the_range_of_the_torque() {
        let machine = Machine::load("coarse".as_ref()).unwrap();
        let step = torque_step_nm(&machine.axes[0]);
        assert!((step - 60.0 / 4096.0).abs() < 1e-15);
        for torque in [-29.99, -0.01, 0.0, 0.3, 17.0] {
            let stepped = in_steps(torque, step);
            assert!((stepped - torque).abs() <= 0.5 * step && (stepped / step).fract() == 0.0, "{torque}");
        }
    }
}
