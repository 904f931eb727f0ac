//! The way from the position loop to the motor: delay of the reference speed, steps of the torque
//! command.
//!
//! ```text
//! w_ref(t) reaches the speed loop at t + d + j r        u = q round(u / q),   q = 2 Tmax / 2^bits
//! ```
//!
//! with j the jitter and r a random number from 0 to 1 for each servo period, the same for all
//! axes: one frame, sent by one thread, takes the references of all of them. In whole mechanics
//! periods: floor(r (m + 1)) of them, m = j / dt.
//!
//! The delay stands between the position loop, which runs in the control, and the speed loop, which
//! runs in the drive: a fieldbus and its two buffers. The torque command is a whole number of steps
//! of the drive's current loop.
//!
//! Source: transport delay and amplitude quantisation as in Franklin, Powell and Workman (1998),
//! chapters 4 and 10.

use feedwright_control::DriveReference;

use super::noise::{RandomStream, RandomUse};
use crate::machine::{Axis, Period};

/// Longest delay, in servo periods.
const MAX_PERIODS: usize = 64;

/// References on their way to the drive; one for each axis.
#[derive(Debug, Clone)]
pub(super) struct Delay {
    /// A ring, one reference a servo period.
    sent: [DriveReference; MAX_PERIODS],
    /// Extra delay of each reference beyond the fixed delay, mechanics periods.
    late: [u32; MAX_PERIODS],
    newest: usize,
    /// Whole servo periods of the delay, and the mechanics periods beyond.
    periods: usize,
    substeps: u32,
    per_servo: u32,
    /// Values that the lateness can have: the jitter in mechanics periods, and none.
    latenesses: u32,
    stream: RandomStream,
}

impl Delay {
    pub(super) fn new(axis: &Axis, period: &Period, seed: u64) -> Self {
        let total = (axis.drive_delay_s / period.mechanics_s).round();
        // The reader of machine files keeps it below the ring; what is made by hand is held to it.
        let most = ((MAX_PERIODS - 3) as u64 * u64::from(period.mechanics_per_servo)) as f64;
        let total = total.clamp(0.0, most) as u64;
        let per_servo = u64::from(period.mechanics_per_servo);
        let jitter = (axis.jitter_s / period.mechanics_s)
            .round()
            .clamp(0.0, per_servo as f64) as u32;
        Self {
            sent: [DriveReference::default(); MAX_PERIODS],
            late: [0; MAX_PERIODS],
            newest: 0,
            periods: (total / per_servo) as usize,
            substeps: (total % per_servo) as u32,
            per_servo: period.mechanics_per_servo,
            latenesses: jitter + 1,
            stream: RandomStream::new(seed, 0, RandomUse::Jitter),
        }
    }

    /// A new reference leaves the position loop in a servo period.
    pub(super) fn send(&mut self, reference: DriveReference, period: u64) {
        self.newest = (self.newest + 1) % MAX_PERIODS;
        self.sent[self.newest] = reference;
        if self.latenesses > 1 {
            self.late[self.newest] =
                (self.stream.uniform(period) * f64::from(self.latenesses)) as u32;
        }
    }

    /// The reference at the drive in a mechanics period of this servo period: the newest that has
    /// arrived.
    #[inline]
    pub(super) fn arrived(&self, substep: u32) -> DriveReference {
        let age = self.periods + usize::from(substep < self.substeps);
        if self.latenesses > 1 {
            self.arrived_late(substep, age)
        } else {
            self.sent[self.at(age)]
        }
    }

    /// Returns the newest reference that has arrived, as [`Self::arrived`] does, for an axis with
    /// jitter. Without jitter it would be the reference of this age.
    fn arrived_late(&self, substep: u32, mut age: usize) -> DriveReference {
        let mut since = if substep < self.substeps {
            substep + self.per_servo
        } else {
            substep
        } - self.substeps;
        // A reference is late by at most a servo period, so this ends at the next reference but
        // one.
        while self.late[self.at(age)] > since {
            age += 1;
            since += self.per_servo;
        }
        self.sent[self.at(age)]
    }

    #[inline]
    fn at(&self, age: usize) -> usize {
        (self.newest + MAX_PERIODS - age) % MAX_PERIODS
    }
}

/// Step of the torque command, N m; 0 where it has none.
pub(super) fn torque_step_nm(axis: &Axis) -> f64 {
    axis.torque_bits.map_or(0.0, |bits| {
        2.0 * axis.torque_limit_nm / 2.0_f64.powi(bits as i32)
    })
}

/// The nearest whole number of steps.
#[inline]
pub(super) fn in_steps(value: f64, step: f64) -> f64 {
    if step > 0.0 {
        (value / step).round() * step
    } else {
        value
    }
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
            let axis = Axis {
                drive_delay_s: delay_s,
                ..machine.axes[0]
            };
            let mut delay = Delay::new(&axis, &machine.period, 0);
            let mut arrived_s = None;
            for period in 0..40_u32 {
                let speed_rad_s = if period >= 10 { 1.0 } else { 0.0 };
                delay.send(
                    DriveReference {
                        speed_rad_s,
                        torque_nm: 2.0 * speed_rad_s,
                    },
                    u64::from(period),
                );
                for substep in 0..substeps {
                    let now_s = f64::from((period - 10.min(period)) * substeps + substep)
                        * machine.period.mechanics_s;
                    if delay.arrived(substep)
                        == (DriveReference {
                            speed_rad_s: 1.0,
                            torque_nm: 2.0,
                        })
                        && arrived_s.is_none()
                    {
                        arrived_s = Some(now_s);
                    }
                }
            }
            assert!(
                (arrived_s.unwrap() - delay_s).abs() < 1e-9,
                "{delay_s}: {arrived_s:?}"
            );
        }
    }

    #[test]
    fn jitter_spreads_the_arrival_evenly_and_never_turns_the_order() {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let axis = Axis {
            drive_delay_s: 0.0013,
            jitter_s: 0.001,
            ..machine.axes[0]
        };
        let mut delay = Delay::new(&axis, &machine.period, 1);
        let (mut counts, mut last) = ([0_u32; 11], 0.0);
        for period in 0..110_000_u64 {
            delay.send(
                DriveReference {
                    speed_rad_s: period as f64,
                    torque_nm: 0.0,
                },
                period,
            );
            for substep in 0..10 {
                let arrived = delay.arrived(substep).speed_rad_s;
                assert!(
                    arrived >= last,
                    "{period}: {last} was there before {arrived}"
                );
                if arrived > last {
                    let age = (period as f64 - arrived) * 10.0 + f64::from(substep) - 13.0;
                    counts[age as usize] += 1;
                }
                last = arrived;
            }
        }
        // Each of the eleven latenesses has 10,000 of 110,000, standard error 95; one that arrives
        // with the next one is passed over.
        assert!(
            counts[..10]
                .iter()
                .all(|&count| count.abs_diff(10_000) < 400),
            "{counts:?}"
        );
        assert!(counts[10] > 8_000, "{counts:?}");
    }

    #[test]
    fn twelve_bits_divide_the_range_of_the_torque() {
        let machine = Machine::load("coarse".as_ref()).unwrap();
        let step = torque_step_nm(&machine.axes[0]);
        assert!((step - 60.0 / 4096.0).abs() < 1e-15);
        for torque in [-29.99, -0.01, 0.0, 0.3, 17.0] {
            let stepped = in_steps(torque, step);
            assert!(
                (stepped - torque).abs() <= 0.5 * step && (stepped / step).fract() == 0.0,
                "{torque}"
            );
        }
    }
}
