//! A program with its text, and the modes in force behind each step.

use std::path::Path;

use crate::gcode::canon::Canon;
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
    modes: Vec<ModesInForce>,
    /// Which of them are in force behind each step.
    in_force: Vec<usize>,
}

impl SourceProgram {
    /// The program in a file, which has been checked.
    pub(super) fn read(part: &Path, settings: &Settings) -> Result<Self, ReadError> {
        let bytes = input::read(part).map_err(|cause| ReadError::Io { path: part.to_owned(), cause })?;
        let mut reader = Reader::open(part, settings.clone())?;
        let dialect = reader.dialect().0;
        let (mut steps, mut modes, mut in_force) = (Vec::new(), Vec::<ModesInForce>::new(), Vec::new());
        while let Some(Ok(step)) = reader.next() {
            let now = reader.modes();
            if modes.last() != Some(&now) {
                modes.push(now);
            }
            in_force.push(modes.len() - 1);
            steps.push(step);
        }
        let lines = String::from_utf8_lossy(&bytes).lines().map(str::to_owned).collect();
        Ok(Self { lines, steps, dialect, modes, in_force })
    }

    /// Modes behind a step.
    pub(super) fn modes(&self, step: usize) -> &ModesInForce {
        &self.modes[self.in_force[step]]
    }
}
