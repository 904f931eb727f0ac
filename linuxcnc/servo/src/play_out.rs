//! Replacement for a link that failed: plays out its delay, without a correction.
//!
//! ```text
//! drive = c(n - D) + o     o: the offset at the failure, which fades to zero
//! ```
//!
//! The delay D ends after the command has rested for longer than the delay, so nothing leaps. This
//! state is kept apart from the state of the link, so that a failure in the link leaves it whole.

use feedwright_control::vector::{add_scaled, norm, sub};

use crate::fading::Fading;
use crate::history::{History, NEWER};
use crate::servo::LinkInputs;
use crate::through::{PassedThrough, Through};

/// Acceleration with which the offset fades, mm/s2: as a pin has it where none is set.
const FADE_MM_S2: f64 = 400.0;

/// Commands of a link, and where it left the drive.
#[derive(Debug, Clone)]
pub struct PlayOut<const N: usize> {
    servo_s: f64,
    history: History<N>,
    /// Servo periods of delay.
    delay: u64,
    offset: Fading<N>,
    has_failed: bool,
    command_mm: [f64; N],
    actual_mm: [f64; N],
    drive_mm: [f64; N],
    through: Through,
}

/// Outputs to the drive and to the control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlayedOut<const N: usize> {
    /// Command of the drive, mm.
    pub drive_mm: [f64; N],
    /// Actual position reported to the control, mm.
    pub feedback_mm: [f64; N],
    /// Offset of the command from the path, mm.
    pub correction_mm: [f64; N],
    /// Channels that pass through.
    pub through: PassedThrough,
    /// Servo periods of delay.
    pub delay_periods: u32,
}

impl<const N: usize> Default for PlayOut<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> PlayOut<N> {
    /// Starts without a command, for a link that has not run yet.
    pub fn new() -> Self {
        Self {
            servo_s: 0.001,
            history: History::EMPTY,
            delay: 0,
            offset: Fading::NONE,
            has_failed: false,
            command_mm: [0.0; N],
            actual_mm: [0.0; N],
            drive_mm: [0.0; N],
            through: Through::NONE,
        }
    }

    /// The servo period of the thread, s.
    pub fn runs_at(&mut self, servo_s: f64) {
        self.servo_s = servo_s;
    }

    /// Keeps what a servo period of the link came to: its inputs, its drive's command and its
    /// delay.
    pub fn keep(&mut self, inputs: &LinkInputs<N>, drive_mm: [f64; N], delay_periods: u32) {
        self.push(inputs);
        (self.drive_mm, self.delay) = (drive_mm, u64::from(delay_periods));
    }

    fn push(&mut self, inputs: &LinkInputs<N>) {
        self.through.receive(&inputs.through);
        if norm(inputs.command_mm).is_finite() {
            self.command_mm = inputs.command_mm;
        }
        if inputs.powered {
            self.history.push(self.command_mm, &self.through, false);
        } else {
            self.history.clear();
        }
    }

    /// One servo period in place of the link.
    pub fn step(&mut self, inputs: &LinkInputs<N>) -> PlayedOut<N> {
        let powered = inputs.powered;
        if norm(inputs.actual_mm).is_finite() {
            self.actual_mm = inputs.actual_mm;
        }
        if !self.has_failed && powered {
            self.offset = Fading::from_rest(sub(self.drive_mm, self.path_mm()));
        }
        self.has_failed = true;
        self.push(inputs);
        if !powered {
            (self.delay, self.offset) = (0, Fading::NONE);
            return self.out(self.actual_mm, self.actual_mm, self.through.off());
        }
        if self.history.at_rest() > self.delay + NEWER {
            self.delay = 0;
        }
        self.offset.step(self.servo_s, FADE_MM_S2);
        let path_mm = self.path_mm();
        let drive_mm = add_scaled(path_mm, 1.0, self.offset.value_mm());
        let before = (self.delay > 0).then(|| self.history.through(self.delayed()));
        let through = self.through.passed(before, self.offset.value_mm());
        self.out(
            drive_mm,
            add_scaled(self.command_mm, 1.0, sub(self.actual_mm, path_mm)),
            through,
        )
    }

    /// Number of the command that is due.
    fn delayed(&self) -> u64 {
        self.history.newest().saturating_sub(self.delay)
    }

    fn path_mm(&self) -> [f64; N] {
        if self.delay == 0 {
            return self.command_mm;
        }
        self.history.position_mm(self.delayed())
    }

    fn out(
        &self,
        drive_mm: [f64; N],
        feedback_mm: [f64; N],
        through: PassedThrough,
    ) -> PlayedOut<N> {
        let delay_periods = self.delay as u32;
        PlayedOut {
            drive_mm,
            feedback_mm,
            correction_mm: self.offset.value_mm(),
            through,
            delay_periods,
        }
    }
}
