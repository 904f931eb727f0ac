//! A corrected program for a control without feedback: the program itself compensates the error
//! that repeats.
//!
//! A controller of [`crate::controllers`] sees the tool while it cuts. Another control plans and
//! cuts the program without that feedback, so the correction is computed for this case. The machine
//! is simulated without what does not repeat ([`deterministic`]), along the plan of the target's
//! own planner. Four steps correct the program:
//!
//! 1. The program is split into stretches that are cut without a corner. All else stays as it is.
//! 2. Each round plans and cuts the current program. With `e` from the tool to its foot on the
//!    original path, the command becomes `c + e + T1 e' + T2 e''`, smoothed, with the lags of the
//!    loop. Arcs and lines are fitted to it, and the next round begins. The best command of each
//!    stretch is kept.
//! 3. At true corners and beside rapids, a dwell of some tens of milliseconds lets the tool come to
//!    rest.
//! 4. The text is written; it keeps the lines of the original that need no change. It is read
//!    again, compared, planned, cut with disturbances, and measured against the original path. The
//!    outcome reports these figures. A program that is no better is not written.
//!
//! Source: model-based iterative learning (Moore 1993), applied to the path of blocks rather than
//! to samples.
//!
//! | File | What |
//! |---|---|
//! | `nominal.rs` | the machine without effects that do not repeat |
//! | `file_prior.rs` | what a machine file most probably describes |
//! | `loop_lag.rs` | how an axis lags behind its command |
//! | `target.rs` | the controls that programs are for |
//! | `source.rs` | the program with its text and modes |
//! | `stretches.rs` | stretches without a corner, and all else |
//! | `arc_fit.rs` | points to arcs and lines |
//! | `learned.rs` | what logs of cuts of the part tell |
//! | `exported.rs` | a program as the other control cuts it |
//! | `slow_end.rs` | slow ways to where the tool would run over |
//! | `command_update.rs` | a better command from the errors of a cut |
//! | `stretch_cut.rs` | errors and time of each stretch in a cut |
//! | `budget.rs` | how many blocks and how much time a program may have |
//! | `unchanged.rs` | why stretches stay as they are |
//! | `rounds.rs` | cut, change, fit, until it gets no better |
//! | `block_words.rs` | motions and events as blocks |
//! | `source_line.rs` | a line without its motion |
//! | `program_text.rs` | the text |
//! | `expanded_text.rs` | the text of a program with loops, subroutines and jumps written out |
//! | `verified.rs` | what the text says when it is read again |
//! | `predicted.rs` | what logs predict of the next cut |
//! | `outcome.rs` | the result, and why a corrected program is refused |
//! | `advise.rs` | the feedrates at which a tolerance is held |
//! | `advise/feed_cuts.rs` | a program at other feedrates |
//! | `advise/feed_search.rs` | the search of the feedrates that hold |
//! | `advise/page.rs` | its figure and its page |

mod nominal;
mod file_prior;
mod loop_lag;
mod target;
mod source;
mod stretches;
pub(crate) mod arc_fit;
pub(crate) mod learned;
pub(crate) mod exported;
mod slow_end;
mod command_update;
mod stretch_cut;
mod budget;
mod unchanged;
mod rounds;
mod block_words;
mod source_line;
mod program_text;
mod expanded_text;
mod verified;
mod predicted;
mod outcome;
pub(crate) mod advise;
use feedwright_gcode::{Program, Settings};
use feedwright_plan::Step;
use feedwright_sim::{Machine, Watch};

use crate::compensation::GeometryChoice;
use crate::job_error::{JobError, axes_that_move};
use crate::measured::MeasuredLog;
use exported::ExportedCut;
pub use file_prior::{AssumedValue, FileAssumption};
use file_prior::{FILE_ERROR, FileModel};
pub use learned::{
    CutProgram, LearnError, LearnedLog, LearnedOutcome, LearnedValue, ModelValue, PlaceError, PredictedCut,
};
use learned::{LearnedMachine, LoggedProgram};
pub use nominal::deterministic;
pub use outcome::CorrectOutcome;
use outcome::{UnwrittenProgram, WrittenProgram, refusal};
use predicted::{no_gain, predicted_cut};
use program_text::TextParts;
use rounds::{RoundsResult, rounds, steps_of};
use source::SourceProgram;
use stretches::{ProgramPart, assembled, parts, stretches};
pub use target::{MacroLanguage, TARGETS, TargetControl};
pub use unchanged::UnchangedStretch;
use unchanged::unchanged_stretches;

/// A program, a machine, and a control that the corrected program is for.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct CorrectJob {
    /// The G-code program.
    pub program: Program,
    /// The machine that cuts it.
    pub machine: Machine,
    /// What the correction believes of the machine; none is the machine itself.
    pub believed: Option<Machine>,
    /// The geometry that the program compensates.
    pub compensation: GeometryChoice,
    /// The control that the corrected program is for.
    pub target: &'static TargetControl,
    /// Replaces every programmed feedrate, mm/s.
    pub feed_mm_s: Option<f64>,
    /// Settings of the reader.
    pub reader: Settings,
    /// Logs of cuts of the part, by this program or by corrected ones.
    pub logs: Vec<MeasuredLog>,
    /// Standard deviation of each value of the machine, as a fraction of it; 0 where it is exact. With logs or `believed` it is ignored.
    pub file_error: f64,
}

impl CorrectJob {
    /// Corrects a program for a control, as the machine is and with the feedrates of the program.
    pub fn new(program: Program, machine: Machine, target: &'static TargetControl) -> Self {
        Self {
            program,
            machine,
            believed: None,
            compensation: GeometryChoice::default(),
            target,
            feed_mm_s: None,
            reader: Settings::default(),
            logs: Vec::new(),
            file_error: FILE_ERROR,
        }
    }

    /// The error of a machine, as a fraction, where the user states none: a file is uncertain, and a built-in machine is simulated as it is
    /// written.
    pub const fn usual_file_error(is_file: bool) -> f64 {
        if is_file { FILE_ERROR } else { 0.0 }
    }

    /// Corrects it and verifies the text.
    ///
    /// # Errors
    /// A program with mistakes, more axes than the machine has, a geometry that cannot be compensated, or an end from outside.
    pub fn run(&self, watch: &dyn Watch) -> Result<CorrectOutcome, JobError> {
        watch.begin("reading the program", 1);
        let summary = self.program.check(self.reader.clone())?;
        let axes = axes_that_move(&self.program, &summary, &self.machine)?;
        let source = SourceProgram::read(&self.program, &self.reader, self.feed_mm_s)?;
        let path_error = |fault| JobError::Path { part: self.program.name(), fault };
        let original = steps_of(&source.steps).map_err(path_error)?;
        let stages = self.target.stages(&self.machine);
        let learned = self.learned(&original, axes, watch)?;
        let file = learned.is_none().then(|| self.uncertain_file(axes)).flatten();
        let machine = learned.as_ref().map(|learned| &learned.machine);
        let machine = machine.or(file.as_ref().map(|file| &file.machine)).unwrap_or(&self.machine);
        let nominal = deterministic(self.believed.as_ref().unwrap_or(machine));
        let compensated = self.compensation.on(&self.machine, summary.box_mm)?.compensated;
        let error = learned.as_ref().map(|learned| &learned.error);
        let on = |machine| ExportedCut { machine, tool: None, error, stages, original: &original, axes, watch };
        let of_run = |error| JobError::of_run(&self.program, error);
        let parts = parts(&source.steps);
        let predicted = ExportedCut { tool: compensated.as_ref(), ..on(&nominal) };
        let found = rounds(&predicted, &parts, self.target, file.as_ref()).map_err(of_run)?;
        watch.begin("cutting the uncorrected program", 1);
        let uncorrected = on(machine).figures(&original).map_err(of_run)?;
        let (written, unwritten) = match self.written(&source, &parts, &found) {
            Ok(written) => (Some(written), None),
            Err(fault) => (None, Some(fault)),
        };
        watch.begin("cutting as exported", 1);
        let corrected =
            written.as_ref().map(|written| on(machine).figures(&written.steps).map_err(of_run)).transpose()?;
        let predict = |learned: &LearnedMachine| {
            let next = |written: &WrittenProgram| predicted_cut(learned, &on(machine), &written.steps).map_err(of_run);
            let predicted = written.as_ref().map(next).transpose()?;
            Ok::<_, JobError>(LearnedOutcome { predicted, ..learned.outcome.clone() })
        };
        let learned = learned.as_ref().map(predict).transpose()?;
        let changed = found.commands.iter().flatten().count();
        let unchanged = unchanged_stretches(&parts, &found.reasons);
        let no_gain = learned.as_ref().and_then(|learned| no_gain(learned, &uncorrected));
        Ok(CorrectOutcome {
            control: self.target.name,
            planner: stages.planner.name,
            refusal: refusal(&uncorrected, corrected.as_ref(), changed, unwritten.as_ref()).or(no_gain),
            hint: unwritten.and_then(|fault| fault.hint()),
            uncorrected,
            corrected: corrected.unwrap_or(uncorrected),
            stretches: stretches(&parts).count(),
            stretches_changed: changed,
            unchanged,
            expanded: written.as_ref().is_some_and(|written| written.expanded),
            rounds: found.rounds,
            dwell_s: found.dwell_s,
            warnings: summary.warnings.iter().cloned().chain(summary.uncontrolled()).collect(),
            written,
            learned,
            machine: machine.clone(),
            assumed: file.map(|file| file.assumption),
            original_steps: original,
            axes,
        })
    }

    /// The machines that an uncertain file may describe.
    fn uncertain_file(&self, axes: usize) -> Option<FileModel> {
        let is_uncertain = self.believed.is_none() && self.file_error > 0.0;
        is_uncertain.then(|| FileModel::new(&self.machine, axes, self.file_error))
    }

    /// What the logs tell, where there are any.
    fn learned(&self, original: &[Step], axes: usize, watch: &dyn Watch) -> Result<Option<LearnedMachine>, JobError> {
        if self.logs.is_empty() {
            return Ok(None);
        }
        watch.begin("learning from the logs", 1);
        let program =
            LoggedProgram { machine: &self.machine, stages: self.target.stages(&self.machine), original, axes, watch };
        let learned = program.learned(&self.logs);
        learned.map(Some).map_err(|(log, error)| JobError::of_part_log(&log, &self.program, &error))
    }

    /// A text that says what was found, with as many lines of the original as can be.
    fn written(
        &self,
        source: &SourceProgram,
        parts: &[ProgramPart],
        found: &RoundsResult,
    ) -> Result<WrittenProgram, UnwrittenProgram> {
        let RoundsResult { commands, dwell_s, .. } = found;
        let notes = [
            format!("corrected by feedwright for the machine {}, control {}", self.machine.name, self.target.name),
            format!(
                "{} of {} stretches between corners were changed",
                commands.iter().flatten().count(),
                commands.len()
            ),
        ];
        let text = TextParts { source, parts, commands, dwell_s: *dwell_s, target: self.target, notes: &notes };
        let wanted = assembled(parts, commands, *dwell_s);
        let step_mm = 1.0 / self.target.steps_per_mm();
        let checked = |text: String, expanded: bool| {
            let is_own = |line: &str| source.lines.iter().any(|kept| kept == line);
            if text.lines().any(|line| line.len() > self.target.columns && !is_own(line)) {
                return Err(UnwrittenProgram::Columns(self.target.columns));
            }
            let (read, modes) =
                verified::read(&text, &self.reader, source.dialect).ok_or(UnwrittenProgram::ReadOtherwise)?;
            let steps = steps_of(&read).map_err(|_| UnwrittenProgram::ReadOtherwise)?;
            let frames = verified::same_frames(read.iter().zip(&modes), source.steps_and_modes());
            let same = frames && verified::same(&read, &wanted, step_mm);
            if same { Ok(WrittenProgram { text, steps, expanded }) } else { Err(UnwrittenProgram::ReadOtherwise) }
        };
        if let Some(Ok(written)) = text.kept().map(|text| checked(text, false)) {
            return Ok(written);
        }
        checked(text.expanded().map_err(UnwrittenProgram::Line)?, true)
    }
}
