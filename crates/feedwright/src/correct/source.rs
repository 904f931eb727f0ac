//! A program with its text, and the modes in force behind each step.

use std::collections::BTreeMap;
use std::io::Read;

use feedwright_gcode::canon::{Canon, MotionKind};
use feedwright_gcode::{Dialect, ModesInForce, Program, ReadError, Settings};

/// A program to be corrected.
#[derive(Debug, Clone)]
pub(super) struct SourceProgram {
    /// Its lines, without their ends.
    pub(super) lines: Vec<String>,
    /// Motions and events of the program.
    pub(super) steps: Vec<Canon>,
    /// Dialect of its G-code.
    pub(super) dialect: Dialect,
    /// Feedrate in place of every programmed one, mm/s.
    pub(super) feed_mm_s: Option<f64>,
    /// Modes before its first line.
    start: ModesInForce,
    modes: Vec<ModesInForce>,
    /// Index into `modes` of the modes in force after each step.
    in_force: Vec<usize>,
    /// Text of the lines before a step that set offsets, for those steps that have any.
    offset_lines: BTreeMap<usize, Vec<String>>,
}

impl SourceProgram {
    /// Reads a program that has been checked, with another feedrate if one is given.
    pub(super) fn read(
        program: &Program,
        settings: &Settings,
        feed_mm_s: Option<f64>,
    ) -> Result<Self, ReadError> {
        let mut bytes = Vec::new();
        let copied = program
            .text()
            .and_then(|(mut text, _)| text.read_to_end(&mut bytes));
        copied.map_err(|cause| ReadError::Io {
            path: program.name().into(),
            cause,
        })?;
        let mut reader = program.reader(settings.clone())?;
        let (dialect, start) = (reader.dialect().0, reader.modes());
        let (mut steps, mut modes, mut in_force) =
            (Vec::new(), Vec::<ModesInForce>::new(), Vec::new());
        let mut offset_lines = BTreeMap::new();
        while let Some(Ok(mut step)) = reader.next() {
            if !reader.offset_lines().is_empty() {
                offset_lines.insert(steps.len(), reader.offset_lines().to_vec());
            }
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
        let lines = String::from_utf8_lossy(&bytes)
            .lines()
            .map(str::to_owned)
            .collect();
        Ok(Self {
            lines,
            steps,
            dialect,
            feed_mm_s,
            start,
            modes,
            in_force,
            offset_lines,
        })
    }

    /// The steps, each with the modes behind it.
    pub(super) fn steps_and_modes(&self) -> impl Iterator<Item = (&Canon, &ModesInForce)> {
        self.steps
            .iter()
            .zip(self.in_force.iter().map(|&modes| &self.modes[modes]))
    }

    /// Returns the lines, executed between the previous step and this one, that write offsets or
    /// put others in force.
    pub(super) fn offset_lines(&self, step: usize) -> &[String] {
        self.offset_lines.get(&step).map_or(&[], Vec::as_slice)
    }

    /// Returns true if offsets are written or put in force after the first of some steps and before
    /// the last.
    pub(super) fn sets_offsets_within(&self, [first, last]: [usize; 2]) -> bool {
        self.offset_lines
            .range(first + 1..)
            .next()
            .is_some_and(|(&step, _)| step <= last)
    }

    /// The largest unit of length that is in force somewhere, mm.
    pub(super) fn largest_unit_mm(&self) -> f64 {
        self.modes
            .iter()
            .map(|modes| modes.unit_mm)
            .fold(1.0, f64::max)
    }

    /// Modes before a step.
    pub(super) fn modes_before(&self, step: usize) -> &ModesInForce {
        step.checked_sub(1)
            .map_or(&self.start, |before| self.modes(before))
    }

    /// Modes behind a step.
    pub(super) fn modes(&self, step: usize) -> &ModesInForce {
        &self.modes[self.in_force[step]]
    }
}
