//! Values that get the same delay as the corrected axes and otherwise stay unchanged: rotary
//! joints, second motors, signals of a program.
//!
//! ```text
//! drive    = c(n - D) + o     o: the correction of the axis that the channel is in tandem with; none otherwise
//! feedback = c(n) + (a - c(n - D))
//! ```
//!
//! The link sets the delay D, and whether there is one. It changes only while the command rests:
//! the command of a joint counts for this, the command of a signal does not.

/// Channels at the most.
pub const CHANNELS: usize = 6;

/// Kind of value that a channel carries.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carries {
    /// Nothing, or a number that may change while the joints rest.
    Signal,
    /// Position of a joint.
    Joint,
    /// Position of a second motor of this corrected axis, whose correction it gets.
    Tandem(usize),
}

/// Inputs from the control and the drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Through {
    /// Commands, mm or degrees.
    pub command: [f64; CHANNELS],
    /// Actual positions; the command of a signal.
    pub actual: [f64; CHANNELS],
    /// Kind of value of each channel.
    pub carries: [Carries; CHANNELS],
}

/// Outputs to the drives and the control.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PassedThrough {
    /// Commands of the drives.
    pub drive: [f64; CHANNELS],
    /// Actual positions reported to the control.
    pub feedback: [f64; CHANNELS],
}

impl Through {
    /// No channels.
    pub const NONE: Self = Self {
        command: [0.0; CHANNELS],
        actual: [0.0; CHANNELS],
        carries: [Carries::Signal; CHANNELS],
    };

    /// Takes over what is a number, and keeps the last one of what is not. Returns whether every
    /// command is a number.
    pub fn receive(&mut self, inputs: &Self) -> bool {
        let take = |kept: &mut [f64; CHANNELS], heard: [f64; CHANNELS]| {
            kept.iter_mut()
                .zip(heard)
                .filter(|(_, heard)| heard.is_finite())
                .for_each(|(kept, heard)| *kept = heard);
        };
        take(&mut self.command, inputs.command);
        take(&mut self.actual, inputs.actual);
        self.carries = inputs.carries;
        inputs.command.iter().all(|command| command.is_finite())
    }

    /// Returns true if a joint has moved since these commands.
    pub fn has_moved(&self, since: &[f64; CHANNELS]) -> bool {
        let is_joint = |carries: &Carries| *carries != Carries::Signal;
        (0..CHANNELS).any(|i| is_joint(&self.carries[i]) && self.command[i] != since[i])
    }

    /// Returns the outputs while the amplifiers are off.
    pub fn off(&self) -> PassedThrough {
        PassedThrough {
            drive: self.actual,
            feedback: self.actual,
        }
    }

    /// Returns the outputs with the delayed commands `before`, or without a delay, plus the
    /// corrections of the axes.
    pub fn passed<const N: usize>(
        &self,
        before: Option<[f64; CHANNELS]>,
        correction_mm: [f64; N],
    ) -> PassedThrough {
        let passed = before.unwrap_or(self.command);
        let offset = |i: usize| match self.carries[i] {
            Carries::Tandem(axis) => correction_mm.get(axis).copied(),
            Carries::Signal | Carries::Joint => None,
        };
        PassedThrough {
            drive: core::array::from_fn(|i| {
                offset(i).map_or(passed[i], |offset| passed[i] + offset)
            }),
            feedback: before.map_or(self.actual, |before| {
                core::array::from_fn(|i| self.command[i] + (self.actual[i] - before[i]))
            }),
        }
    }
}
