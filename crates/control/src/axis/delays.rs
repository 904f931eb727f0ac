//! Delays of the loops of an axis, and the queue of commands before a position loop that is in the
//! drive.
//!
//! ```text
//! c(m) is sent at m Ts; the position loop has it at (m + n) Ts          n = round(command delay / Ts), at most 8
//! ```
//!
//! A drive that closes the position loop itself gets its commands over a bus, one to three bus
//! cycles late. A synchronous bus delays by whole cycles, so n is a whole number of servo periods;
//! put any remainder into the drive delay. The position comes back over the same bus. The control
//! sees only the round trip: an axis whose commands are late by i periods and whose positions by j
//! behaves, from outside, like one whose commands are late by i + j. One number is therefore
//! enough.
//!
//! Source: Franklin, Powell and Workman (1998), Digital Control of Dynamic Systems, chapter 4, for
//! delays of whole periods.

use super::Parameters;

/// Largest number of servo periods by which commands are late: the controller looks one servo
/// period ahead for each. A bus takes one to three.
pub const MAX_COMMAND_PERIODS: usize = 8;

impl Parameters {
    /// Returns the servo periods from a command until the position loop has it.
    pub fn command_periods(&self, servo_s: f64) -> usize {
        // The cast saturates to zero where the float is negative or NaN.
        (libm::round(self.command_delay_s / servo_s) as usize).min(MAX_COMMAND_PERIODS)
    }
}

/// Position commands on their way to the position loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CommandQueue {
    /// Sent commands, the newest first.
    sent: [f64; MAX_COMMAND_PERIODS + 1],
    periods: usize,
}

impl CommandQueue {
    /// Creates a queue of `periods` servo periods in which every earlier command was `command`.
    pub fn resting(periods: usize, command: f64) -> Self {
        Self {
            sent: [command; MAX_COMMAND_PERIODS + 1],
            periods: periods.min(MAX_COMMAND_PERIODS),
        }
    }

    /// Creates a queue of `periods` servo periods on an even motion: `next` is the next command to
    /// send, `change` its change over a servo period.
    pub fn moving(periods: usize, next: f64, change: f64) -> Self {
        let mut queue = Self::resting(periods, next);
        let ago = (1..).zip(&mut queue.sent);
        ago.for_each(|(periods, sent)| *sent -= f64::from(periods) * change);
        queue
    }

    /// Returns the servo periods by which commands are late.
    pub fn periods(&self) -> usize {
        self.periods
    }

    /// Sends a command. Returns the one that the position loop has now.
    #[inline]
    pub fn pass(&mut self, command: f64) -> f64 {
        self.sent.copy_within(..MAX_COMMAND_PERIODS, 1);
        self.sent[0] = command;
        self.arrived()
    }

    /// Returns the command that the position loop has.
    #[inline]
    pub fn arrived(&self) -> f64 {
        self.sent.get(self.periods).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_command_arrives_after_its_servo_periods() {
        for periods in [0, 1, 3, 8] {
            let mut queue = CommandQueue::resting(periods, 5.0);
            for sent in 0..20_u32 {
                let arrived = queue.pass(f64::from(sent));
                let wanted = (sent as usize)
                    .checked_sub(periods)
                    .map_or(5.0, |sent| sent as f64);
                assert_eq!(
                    (arrived, queue.arrived()),
                    (wanted, wanted),
                    "{periods} periods, command {sent}"
                );
            }
        }
    }

    #[test]
    fn an_even_motion_has_been_commanded_until_now() {
        let mut queue = CommandQueue::moving(3, 7.0, 2.0);
        assert_eq!(
            [7.0, 9.0, 11.0, 13.0].map(|command| queue.pass(command)),
            [1.0, 3.0, 5.0, 7.0]
        );
    }

    #[test]
    fn delays_are_rounded_to_whole_servo_periods_and_bounded() {
        let periods = |command_delay_s| {
            Parameters {
                command_delay_s,
                ..Parameters::NOTHING
            }
            .command_periods(0.001)
        };
        assert_eq!(
            [0.0, 0.0004, 0.0019, 0.003, 0.02, -1.0, f64::NAN].map(periods),
            [0, 0, 2, 3, 8, 0, 0]
        );
    }
}
