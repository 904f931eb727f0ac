//! A corrected program for a control that gets no feedback from us: the error that repeats, taken out of the program itself.
//!
//! A controller of [`crate::controllers`] sees the tool while it cuts. A program that is taken to another control is cut open loop, planned by that control. So the
//! correction is computed for that: the machine is simulated without what does not repeat ([`deterministic`]), along the plan of the
//! target's own planner, and the program is changed until the simulated program itself holds:
//!
//! 1. The program falls into stretches that are cut without a corner, and all else, which stays.
//! 2. A round plans and cuts the program as it now is. With `e` from the tool to its foot on the original path, the command becomes
//!    `c + e + T1 e' + T2 e''` with the lags of the loop, smoothed; arcs and lines are fitted to it, and the next round begins. The best of each
//!    stretch is kept.
//! 3. At true corners and beside rapids the tool comes to rest, by a dwell of some ten milliseconds.
//! 4. The text is written with the lines of the original wherever they need no change, read again, compared, planned and cut with what disturbs, and
//!    measured against the original path. These figures are what is told, and a program that is no better is not written.
//!
//! Source: the iteration is that of model-based iterative learning (Moore 1993), on the path of blocks rather than on samples.
//!
//! | File | What |
//! |---|---|
//! | `nominal.rs` | the machine without what does not repeat |
//! | `loop_lag.rs` | how an axis lags behind its command |
//! | `target.rs` | the controls that programs are for |
//! | `source.rs` | the program with its text and modes |
//! | `stretches.rs` | stretches without a corner, and all else |
//! | `arc_fit.rs` | points to arcs and lines |
//! | `exported.rs` | a program as the other control cuts it |
//! | `command_update.rs` | a better command from the errors of a cut |
//! | `stretch_cut.rs` | what each stretch comes to in a cut |
//! | `rounds.rs` | cut, change, fit, until it gets no better |
//! | `block_words.rs` | motions and events as blocks |
//! | `source_line.rs` | a line without its motion |
//! | `program_text.rs` | the text |
//! | `verified.rs` | what the text says when it is read again |

mod nominal;
mod loop_lag;
mod target;
mod source;
mod stretches;
pub(crate) mod arc_fit;
pub mod exported;
mod command_update;
mod stretch_cut;
mod rounds;
mod block_words;
mod source_line;
mod program_text;
mod verified;

use std::path::PathBuf;

use crate::gcode::canon::Canon;
use crate::gcode::{self, Settings};
use crate::job::{JobError, axes_that_move};
use crate::machine::Machine;
use crate::path::Step;
use crate::watch::Watch;
use exported::{ExportedCut, ExportedFigures};
pub use nominal::deterministic;
use program_text::TextParts;
use rounds::{RoundsResult, rounds, steps_of};
use source::SourceProgram;
use stretches::{ProgramPart, assembled, parts, stretches};
pub use target::{TARGETS, TargetControl};

/// An RMS or a largest error that is less by no more than this part is no better.
const LEAST_GAIN: f64 = 0.02;
/// The largest error may grow by this, um: it is that of one moment, of cuts that differ by what disturbs them.
const MAX_SLACK_UM: f64 = 0.5;
/// The uncut path may grow by this, um: what the end of a program is off while the tool settles.
const UNCUT_UM: f64 = 5.0;

/// A program, a machine, and a control that the corrected program is for.
#[derive(Debug, Clone)]
pub struct CorrectJob {
    /// The G-code program.
    pub part: PathBuf,
    /// The machine that cuts it.
    pub machine: Machine,
    /// What the correction believes of the machine; none is the machine itself.
    pub believed: Option<Machine>,
    /// The control that the corrected program is for.
    pub target: &'static TargetControl,
    /// Settings of the reader.
    pub reader: Settings,
}

/// What came of it.
#[derive(Debug, Clone)]
pub struct CorrectOutcome {
    /// The original as the control cuts it.
    pub original: ExportedFigures,
    /// The corrected program as the control cuts it, read from its own text.
    pub corrected: ExportedFigures,
    /// The text of the corrected program, where it is better.
    pub program: Option<String>,
    /// Why there is none.
    pub refusal: Option<String>,
    /// Stretches, and those that have another command.
    pub stretches: [usize; 2],
    /// Whether loops and subroutines had to be written out.
    pub expanded: bool,
    /// Cuts that the correction was found in.
    pub rounds: u32,
    /// Longest rest that was put in, s.
    pub dwell_s: f64,
    /// What the reader warned of.
    pub warnings: Vec<gcode::Diagnostic>,
}

/// A text and the path that it says.
struct WrittenProgram {
    text: String,
    steps: Vec<Step>,
    expanded: bool,
}

impl CorrectJob {
    /// Corrects it and verifies the text.
    ///
    /// # Errors
    /// A program with mistakes, more axes than the machine has, or an end from outside.
    pub fn run(&self, watch: &dyn Watch) -> Result<CorrectOutcome, JobError> {
        watch.begin("reading the program", 1);
        let summary = gcode::check(&self.part, self.reader.clone())?;
        let axes = axes_that_move(&self.part, &summary, &self.machine)?;
        let source = SourceProgram::read(&self.part, &self.reader)?;
        let path_error = |fault| JobError::Path { part: self.part.clone(), fault };
        let original = steps_of(&source.steps).map_err(path_error)?;
        let nominal = deterministic(self.believed.as_ref().unwrap_or(&self.machine));
        let stages = self.target.stages(&self.machine);
        if stages.planner.needs_axes && !self.machine.has_axis_limits() {
            let (control, machine) = (self.target.name, self.machine.name.clone());
            return Err(JobError::NoAxisLimits { control, machine });
        }
        let on = |machine| ExportedCut { machine, stages, original: &original, axes, watch };
        let of_run = |error| JobError::of_run(&self.part, error);
        let parts = parts(&source.steps);
        let found = rounds(&on(&nominal), &parts, self.target).map_err(of_run)?;
        watch.begin("cutting the original", 1);
        let uncorrected = on(&self.machine).figures(&original).map_err(of_run)?;
        let written = self.written(&source, &parts, &found);
        watch.begin("cutting as exported", 1);
        let corrected = match &written {
            Some(written) => on(&self.machine).figures(&written.steps).map_err(of_run)?,
            None => uncorrected,
        };
        let changed = found.commands.iter().flatten().count();
        let refusal = self.refusal(&uncorrected, &corrected, written.is_some(), changed);
        let expanded = written.as_ref().is_some_and(|written| written.expanded);
        Ok(CorrectOutcome {
            original: uncorrected,
            corrected,
            program: written.filter(|_| refusal.is_none()).map(|written| written.text),
            refusal,
            stretches: [stretches(&parts).count(), changed],
            expanded,
            rounds: found.rounds,
            dwell_s: found.dwell_s,
            warnings: summary.warnings.iter().cloned().chain(summary.uncontrolled()).collect(),
        })
    }

    /// A text that says what was found, with as many lines of the original as can be; none where no text does.
    fn written(&self, source: &SourceProgram, parts: &[ProgramPart], found: &RoundsResult) -> Option<WrittenProgram> {
        let RoundsResult { commands, dwell_s, .. } = found;
        let notes = [
            format!("corrected by feedwright for the machine {}, control {}", self.machine.name, self.target.name),
            format!("{} of {} stretches have other blocks", commands.iter().flatten().count(), commands.len()),
        ];
        let text = TextParts { source, parts, commands, dwell_s: *dwell_s, target: self.target, notes: &notes };
        let wanted = assembled(parts, commands, *dwell_s);
        let step_mm = 1.0 / self.target.steps_per_mm();
        let try_one = |text: Option<String>, expanded: bool| {
            let text = text?;
            let fits = text
                .lines()
                .all(|line| line.len() <= self.target.columns || source.lines.iter().any(|kept| kept == line));
            let read: Vec<Canon> = verified::read(&text, &self.reader, source.dialect)?;
            let steps = steps_of(&read).ok()?;
            (fits && verified::same(&read, &wanted, step_mm)).then_some(WrittenProgram { text, steps, expanded })
        };
        try_one(text.kept(), false).or_else(|| try_one(text.expanded(), true))
    }

    /// Why a program is not to be used.
    fn refusal(
        &self,
        original: &ExportedFigures,
        corrected: &ExportedFigures,
        written: bool,
        changed: usize,
    ) -> Option<String> {
        let ExportedFigures { rms_um, max_um, uncut_um, .. } = *corrected;
        if changed == 0 {
            return Some("no stretch of the program gets better by another command".to_owned());
        }
        if !written {
            let kept =
                "axes beside X, Y and Z, threads, probing, splines or lathe modes between loops or compensated motions";
            return Some(format!("the corrected program cannot be written in blocks of the control: {kept}"));
        }
        if !corrected.completed {
            return Some("the servo loop is unstable".to_owned());
        }
        let worse = |what: &str, was: f64, is: f64| {
            Some(format!("{what} is {is:.2} um as exported, and {was:.2} um of the original"))
        };
        if rms_um > (1.0 - LEAST_GAIN) * original.rms_um {
            return worse("the RMS error", original.rms_um, rms_um);
        }
        if max_um > (1.0 + LEAST_GAIN) * original.max_um + MAX_SLACK_UM {
            return worse("the largest error", original.max_um, max_um);
        }
        if uncut_um > original.uncut_um + UNCUT_UM {
            return worse("the uncut path", original.uncut_um, uncut_um);
        }
        None
    }
}
