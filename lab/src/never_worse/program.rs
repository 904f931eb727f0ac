//! A program as it is cut: read once, its path shared by all machines, long ones shortened to the
//! first part of their machining time.

use std::fmt::Write;
use std::path::Path;
use std::sync::mpsc;

use feedwright::JobError;
use feedwright_gcode::{ReadError, Reader, Settings, summarize};
use feedwright_plan::{
    Constraints, FEED_PLANNERS, LimitsError, PathError, Pieces, Plan, Planned, Plc, Step, Steps,
};
use feedwright_sim::Machine;

/// A program, ready to be cut on any machine.
#[derive(Debug, Clone)]
pub struct SweepProgram {
    /// Name in tables.
    pub name: String,
    /// Axes that it needs, 2 or 3.
    pub axes: usize,
    /// Planned time on the machine that it was shortened for, rests included, s.
    pub machining_s: f64,
    /// True if the rest of the program was left out.
    pub shortened: bool,
    /// Content of the path, hashed.
    pub key: String,
    /// The path.
    pub steps: Vec<Step>,
}

/// The part of a program that is cut: a machine, and the most machining time on it, s. The same part
/// is then cut on all other machines.
#[derive(Debug, Clone, Copy)]
pub struct Length<'a>(pub &'a Machine, pub f64);

impl SweepProgram {
    /// The program in a file.
    ///
    /// # Errors
    /// A program with mistakes, without motion or without a path.
    pub fn read(file: &Path, settings: &Settings, length: Length<'_>) -> Result<Self, JobError> {
        let name = file.display().to_string();
        Self::new(name, || Reader::open(file, settings.clone()), length)
    }

    /// The program in a text.
    ///
    /// # Errors
    /// As [`SweepProgram::read`].
    pub fn from_text(name: &str, text: &str, length: Length<'_>) -> Result<Self, JobError> {
        Self::new(
            name.to_owned(),
            || Reader::from_text(name, text, Settings::default()),
            length,
        )
    }

    fn new(
        name: String,
        open: impl Fn() -> Result<Reader, ReadError>,
        length: Length<'_>,
    ) -> Result<Self, JobError> {
        let axes = if summarize(open()?)?.moves[2] { 3 } else { 2 };
        let steps = Box::new(Pieces::new(open()?.map_while(Result::ok)));
        let mut program = Self {
            name,
            axes,
            machining_s: 0.0,
            shortened: false,
            key: String::new(),
            steps: Vec::new(),
        };
        if let Some(fault) = program.plan(steps, length)? {
            let part = program.name;
            return Err(JobError::Path { part, fault });
        }
        program.key = key(axes, &program.steps);
        Ok(program)
    }

    /// Plans the path until its time is over, and keeps it as far as the end of the motion that is
    /// under way then.
    fn plan(
        &mut self,
        steps: Steps<'_>,
        Length(machine, limit_s): Length<'_>,
    ) -> Result<Option<PathError>, LimitsError> {
        let (keep, kept) = mpsc::channel();
        let mut ended = false;
        let read = steps
            .map(move |step| step.map(|step| first_part(step, limit_s, &mut ended)))
            .take_while(|step| !matches!(step, Ok(None)))
            .filter_map(Result::transpose)
            .inspect(move |step| {
                if let Ok(step) = step {
                    // The other end is there as long as the plan is.
                    let _ = keep.send(step.clone());
                }
            });
        let constraints = Constraints::from(machine);
        let (planner, plc) = (&FEED_PLANNERS[0], Plc::from(machine));
        let mut plan = Plan::new(Box::new(read), &constraints, planner, plc)?;
        let mut last = None;
        for planned in &mut plan {
            if let Planned::Phase(phase) = planned {
                self.machining_s = phase.tau_s + phase.duration_s;
                if self.machining_s > limit_s {
                    last = Some(phase.piece);
                    break;
                }
            }
        }
        let fault = plan.fault().cloned();
        drop(plan);
        // The plan looks ahead: what it has read beyond that motion is left out.
        let mut pieces = 0;
        let within = |step: &Step| {
            let is_within = last.is_none_or(|last| pieces <= last);
            pieces += u64::from(matches!(step, Step::Piece(_)));
            is_within
        };
        self.steps = kept.into_iter().take_while(within).collect();
        self.shortened = last.is_some();
        Ok(fault)
    }
}

/// A step, or the first part of a motion that takes longer than the limit by itself and ends the
/// path.
fn first_part(step: Step, limit_s: f64, ended: &mut bool) -> Option<Step> {
    if *ended {
        return None;
    }
    let Step::Piece(mut piece) = step else {
        return Some(step);
    };
    // Curves are looked up by arc length: a shorter one is the same curve, left earlier.
    let most_mm = piece.feed_mm_s * limit_s;
    if piece.cutting && piece.length_mm > most_mm {
        piece.length_mm = most_mm;
        *ended = true;
    }
    Some(Step::Piece(piece))
}

/// The content of a path: equal for equal paths, whatever the name of the program.
fn key(axes: usize, steps: &[Step]) -> String {
    let mut hasher = blake3::Hasher::new();
    let mut text = String::new();
    hasher.update(&[axes as u8]);
    for step in steps {
        text.clear();
        // Numbers are written so that they round-trip; writing to a string does not fail.
        let _ = write!(text, "{step:?}");
        hasher.update(text.as_bytes());
    }
    hasher.finalize().to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "G21 G90 F600\nG1 X10\nG1 X20\nG1 X30\nG4 P1\nG1 X40\nM2\n";

    fn program(limit_s: f64) -> SweepProgram {
        let machine = Machine::load("tnv40".as_ref()).expect("built in");
        SweepProgram::from_text("lines", TEXT, Length(&machine, limit_s)).expect("a program")
    }

    #[test]
    fn a_long_program_is_cut_for_the_first_part_of_its_time() {
        let (whole, part) = (program(600.0), program(1.5));
        assert!(
            !whole.shortened && (5.0..6.0).contains(&whole.machining_s),
            "{whole:?}"
        );
        assert!(part.shortened && part.machining_s > 1.5, "{part:?}");
        assert!(part.steps.len() < whole.steps.len(), "{part:?}");
        assert_ne!(part.key, whole.key);
    }

    #[test]
    fn a_motion_that_takes_longer_than_the_limit_is_left_early() {
        let machine = Machine::load("tnv40".as_ref()).expect("built in");
        let length = Length(&machine, 10.0);
        let slow = SweepProgram::from_text("slow", "G21 F60\nG2 X0 Y0 I5 J0\nG1 X10\nM2\n", length)
            .expect("a program");
        assert!(
            slow.shortened && (9.9..10.5).contains(&slow.machining_s),
            "{slow:?}"
        );
        assert_eq!(slow.steps.len(), 1);
    }

    #[test]
    fn the_key_follows_from_the_content() {
        assert_eq!(program(600.0).key, program(700.0).key);
    }

    #[test]
    fn a_program_with_mistakes_is_refused() {
        let machine = Machine::load("tnv40".as_ref()).expect("built in");
        let length = Length(&machine, 1.0);
        assert!(SweepProgram::from_text("wrong", "G1 X[oops\nM2\n", length).is_err());
        assert!(SweepProgram::from_text("still", "M2\n", length).is_err());
    }
}
