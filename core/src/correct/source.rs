//! A program with its text, and the modes in force behind each step.

use std::path::Path;

use crate::gcode::canon::{Canon, MotionKind};
use crate::gcode::{Dialect, ModesInForce, ReadError, Reader, Settings, input};

/// A program that is to be corrected.
#[derive(Debug, Clone)]
pub(super) struct SourceProgram {
    /// Its lines, without their ends.
    pub(super) lines: Vec<String>,
    /// What it asks for.
    pub(super) steps: Vec<Canon>,
    /// Whose G-code it is.
    pub(super) dialect: Dialect,
    /// Feedrate in place of every programmed one, mm/s.
    pub(super) feed_mm_s: Option<f64>,
    /// Modes before its first line.
    start: ModesInForce,
    modes: Vec<ModesInForce>,
    /// Which of them are in force behind each step.
    in_force: Vec<usize>,
}

impl SourceProgram {
    /// The program in a file, which has been checked, with another feedrate where one is given.
    pub(super) fn read(part: &Path, settings: &Settings, feed_mm_s: Option<f64>) -> Result<Self, ReadError> {
        let bytes = input::read(part).map_err(|cause| ReadError::Io { path: part.to_owned(), cause })?;
        let mut reader = Reader::open(part, settings.clone())?;
        let (dialect, start) = (reader.dialect().0, reader.modes());
        let (mut steps, mut modes, mut in_force) = (Vec::new(), Vec::<ModesInForce>::new(), Vec::new());
        while let Some(Ok(mut step)) = reader.next() {
            if let (Canon::Motion(motion), Some(feed_mm_s)) = (&mut step, feed_mm_s)
                && motion.kind == MotionKind::Feed
            {
                motion.feed_mm_s = feed_mm_s;
            }
            let now = reader.modes();
            if modes.last() != Some(&now) {
                modes.push(now);
            }
            in_force.push(modes.len() - 1);
            steps.push(step);
        }
        let lines = String::from_utf8_lossy(&bytes).lines().map(str::to_owned).collect();
        Ok(Self { lines, steps, dialect, feed_mm_s, start, modes, in_force })
    }

    /// The steps, each with the modes behind it.
    pub(super) fn steps_and_modes(&self) -> impl Iterator<Item = (&Canon, &ModesInForce)> {
        self.steps.iter().zip(self.in_force.iter().map(|&modes| &self.modes[modes]))
    }

    /// Modes before a step.
    pub(super) fn modes_before(&self, step: usize) -> &ModesInForce {
        step.checked_sub(1).map_or(&self.start, |before| self.modes(before))
    }

    /// Modes behind a step.
    pub(super) fn modes(&self, step: usize) -> &ModesInForce {
        &self.modes[self.in_force[step]]
    }
}
