//! A corrected program for a control without feedback: the program itself compensates the error
//! that repeats.
//!
//! A controller of [`crate::controllers`] measures the tool while it cuts. The target control plans
//! and cuts the program without that feedback, so the correction is computed for this case. The
//! machine is simulated without the effects that do not repeat ([`deterministic`]), along the plan
//! of the target's own planner. Four steps correct the program:
//!
//! 1. The program is split into stretches that are cut without a corner. The rest stays unchanged.
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
//! | File | Content |
//! |---|---|
//! | `nominal.rs` | the machine without effects that do not repeat |
//! | `file_prior.rs` | the machine that a machine file most probably describes |
//! | `loop_lag.rs` | lag of an axis behind its command |
//! | `target.rs` | the controls that programs are written for |
//! | `workers.rs` | long work in parts, on threads, kept in a folder |
//! | `source.rs` | the program with its text and modes |
//! | `stretches.rs` | stretches without a corner, and the parts between them |
//! | `learned.rs` | learning from logs of cuts of the part |
//! | `exported.rs` | a program as the target control cuts it |
//! | `seams.rs` | places where the commands of two pieces meet |
//! | `slow_end.rs` | slow ways to ends that the tool would overshoot |
//! | `command_update.rs` | a better command from the errors of a cut |
//! | `stretch_cut.rs` | errors and time of each stretch in a cut |
//! | `budget.rs` | limits on the blocks and the time of a program |
//! | `unchanged.rs` | reasons why stretches stay as programmed |
//! | `stretch_rounds.rs` | a stretch under way |
//! | `given_up.rs` | commands that are given up after a cut of all together |
//! | `rounds.rs` | cut, change, fit, until the result no longer improves |
//! | `pieces.rs` | a long program in pieces |
//! | `block_words.rs` | motions and events as blocks |
//! | `source_line.rs` | a line without its motion |
//! | `program_text.rs` | the text |
//! | `expanded_text.rs` | the text of a program with loops, subroutines and jumps written out |
//! | `verified.rs` | the text, read again and compared |
//! | `feed_overrides.rs` | feed overrides at which a program is better or worse |
//! | `predicted.rs` | prediction of the next cut from logs |
//! | `outcome.rs` | the result, and reasons to reject a corrected program |
//! | `advise.rs` | the feedrates at which a tolerance is held |
//! | `advise/feed_cuts.rs` | a program at other feedrates |
//! | `advise/feed_search.rs` | search for the feedrates that hold |
//! | `advise/page.rs` | its figure and its page |

mod nominal;
mod file_prior;
mod loop_lag;
mod target;
mod workers;
mod source;
mod stretches;
pub(crate) mod learned;
pub(crate) mod exported;
mod seams;
mod slow_end;
mod command_update;
mod stretch_cut;
mod budget;
mod unchanged;
mod stretch_rounds;
mod given_up;
mod rounds;
mod pieces;
mod block_words;
mod source_line;
mod program_text;
mod expanded_text;
mod verified;
pub(crate) mod feed_overrides;
mod predicted;
mod outcome;
pub(crate) mod advise;
use std::io::{BufRead, BufReader};
#[cfg(feature = "files")]
use std::path::{Path, PathBuf};
use std::sync::Arc;

use feedwright_gcode::canon::Canon;
use feedwright_gcode::{Dialect, Program, Settings, Summary};
use feedwright_plan::Step;
use feedwright_sim::{Machine, RunError, Watch};
#[cfg(feature = "files")]
use serde_json::{Value, json};

use crate::compensation::GeometryChoice;
#[cfg(feature = "files")]
use crate::identifier_cache::geometry_content;
use crate::job_error::{JobError, axes_that_move};
use crate::measured::MeasuredLog;
#[cfg(feature = "files")]
use crate::store::{Store, content_key};
use exported::ExportedCut;
pub use feed_overrides::OverrideVerdict;
use feed_overrides::override_note;
pub(crate) use file_prior::FileAssumption;
use file_prior::{FILE_ERROR, FileModel};
pub use learned::PredictedCut;
pub(crate) use learned::{CutProgram, LearnedOutcome, LearnedValue};
use learned::{LearnedMachine, LoggedProgram};
pub use nominal::deterministic;
pub use outcome::CorrectOutcome;
use outcome::{UnwrittenProgram, WrittenProgram, refusal};
use pieces::{LongProgram, PIECE_PERIODS, ProgramPiece, pieces, rounds_of_pieces, splits};
use predicted::{learned_outcome, no_gain};
use program_text::{TextParts, UnkeptLines};
use rounds::{RoundsResult, steps_of};
use source::SourceProgram;
use stretches::{ProgramPart, assembled, parts};
pub use target::{TARGETS, TargetControl};
pub(crate) use unchanged::UnchangedStretch;
use unchanged::unchanged_stretches;
use verified::{TextComparison, TextFault};
use workers::Workers;

/// Program, machine, and control that the corrected program is for.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct CorrectJob {
    /// The G-code program.
    pub(crate) program: Program,
    /// The machine that cuts it.
    pub machine: Machine,
    /// Machine that the correction assumes; none means `machine` itself.
    pub assumed: Option<Machine>,
    /// The geometry that the program compensates.
    pub(crate) compensation: GeometryChoice,
    /// The control that the corrected program is for.
    pub(crate) target: &'static TargetControl,
    /// Replaces every programmed feedrate, mm/s.
    pub feed_mm_s: Option<f64>,
    /// Settings of the reader.
    pub reader: Settings,
    /// Logs of cuts of the part, with this program or with corrected ones.
    pub logs: Vec<MeasuredLog>,
    /// Standard deviation of each value of the machine, as a fraction of it; 0 if the machine is
    /// exact. Ignored if there are logs, or if `assumed` is set.
    pub file_error: f64,
    /// Servo periods of a piece. A program of more than twice as many is corrected in pieces.
    pub piece_periods: u64,
    /// Threads that correct pieces. The result is the same with any number.
    pub threads: usize,
    /// Folder in which finished pieces of a long program are kept, in case the run ends early. See
    /// [`CorrectJob::forget_pieces`].
    #[cfg(feature = "files")]
    pub keep: Option<PathBuf>,
}

/// Largest number of motions and events of a program: they are all in memory when the text is
/// verified.
const MOST_MOTIONS: u64 = 2_000_000;

/// First words of the note in a corrected program; machine and control follow.
const CORRECTED_FOR: &str = "corrected by feedwright for the machine";
/// Note of feed overrides before they are simulated.
const NO_OVERRIDES: &str = "feed override: not simulated";
/// Number of lines in which the note is searched for.
const NOTED_WITHIN: usize = 100;

/// Returns the control that a corrected program was made for, from its note; none if it has no such
/// note or cannot be read.
pub(crate) fn corrected_for(program: &Program) -> Option<&'static TargetControl> {
    let (text, _) = program.text().ok()?;
    let lines = BufReader::new(text)
        .lines()
        .take(NOTED_WITHIN)
        .map_while(Result::ok);
    let mut controls = lines.filter_map(|line| {
        let (_, control) = line
            .split_once(CORRECTED_FOR)?
            .1
            .rsplit_once(", control ")?;
        TargetControl::find(control.trim_end().trim_end_matches(')'))
    });
    controls.next()
}

/// The machines of a correction.
struct JobMachines {
    /// The machine of the job with what its control compensates.
    of_job: Machine,
    /// The machine as logs show it.
    learned: Option<LearnedMachine>,
    /// The machines that an uncertain file may describe.
    file: Option<FileModel>,
    /// The machine that the command is computed for.
    nominal: Machine,
}

impl JobMachines {
    /// Returns the machine on which programs are judged.
    fn machine(&self) -> &Machine {
        let learned = self.learned.as_ref().map(|learned| &learned.machine);
        learned
            .or(self.file.as_ref().map(|file| &file.machine))
            .unwrap_or(&self.of_job)
    }
}

/// Commands of all stretches, and their text.
struct FoundProgram {
    rounds: RoundsResult,
    unchanged: Vec<UnchangedStretch>,
    written: Option<WrittenProgram>,
    unwritten: Option<UnwrittenProgram>,
    pieces: usize,
}

/// Largest number of pieces that are corrected at the same time, each with its rows in memory.
const MOST_THREADS: usize = 2;

impl CorrectJob {
    /// Creates a job that corrects a program for a control, with the machine as it is and the
    /// feedrates of the program.
    pub fn new(program: Program, machine: Machine, target: &'static TargetControl) -> Self {
        Self {
            program,
            machine,
            assumed: None,
            compensation: GeometryChoice::default(),
            target,
            feed_mm_s: None,
            reader: Settings::default(),
            logs: Vec::new(),
            file_error: FILE_ERROR,
            piece_periods: PIECE_PERIODS,
            threads: std::thread::available_parallelism()
                .map_or(1, |cores| cores.get().min(MOST_THREADS)),
            #[cfg(feature = "files")]
            keep: None,
        }
    }

    /// Returns the error of a machine, as a fraction, if the user states none: a file is uncertain,
    /// and a built-in machine is simulated as it is written.
    pub const fn usual_file_error(is_file: bool) -> f64 {
        if is_file { FILE_ERROR } else { 0.0 }
    }

    /// Corrects the program and verifies the text.
    ///
    /// # Errors
    /// A program with mistakes, more axes than the machine has, a geometry that cannot be
    /// compensated, or a run that was cancelled.
    pub fn run(&self, watch: &dyn Watch) -> Result<CorrectOutcome, JobError> {
        watch.begin("reading the program", 1);
        let summary = self.program.check(self.reader.clone())?;
        let axes = axes_that_move(&self.program, &summary, &self.machine)?;
        self.check_motions(&summary)?;
        let source = SourceProgram::read(&self.program, &self.reader, self.feed_mm_s)?;
        let path_error = |fault| JobError::Path {
            part: self.program.name(),
            fault,
        };
        let original = steps_of(&source.steps).map_err(path_error)?;
        let stages = self.target.stages(&self.machine);
        let machines = self.machines(&original, axes, summary.box_mm, watch)?;
        let (machine, learned) = (machines.machine(), machines.learned.as_ref());
        let error = learned.map(|learned| &learned.error);
        let on = |machine| ExportedCut {
            machine,
            error,
            stages,
            original: &original,
            axes,
            watch,
        };
        let of_run = |error| JobError::of_run(&self.program, error);
        let (mut found, workers) = self
            .found(source, &on(&machines.nominal), machines.file.as_ref())
            .map_err(of_run)?;
        let figures = |program: &[Step], stage: &str| {
            on(machine)
                .figures_by(program, stage, &workers)
                .map_err(of_run)
        };
        let uncorrected = figures(&original, "cutting the uncorrected program")?;
        let corrected = found
            .written
            .as_ref()
            .map(|written| figures(&written.steps, "cutting as exported"))
            .transpose()?;
        let steps = found
            .written
            .as_ref()
            .map(|written| written.steps.as_slice());
        let predict = |learned: &LearnedMachine| {
            learned_outcome(learned, &on(machine), steps).map_err(of_run)
        };
        let learned = learned.map(predict).transpose()?;
        let no_gain = learned
            .as_ref()
            .and_then(|learned| no_gain(learned, &uncorrected));
        let changed = found.rounds.commands.iter().flatten().count();
        let refusal = refusal(
            &uncorrected,
            corrected.as_ref(),
            changed,
            found.unwritten.as_ref(),
        )
        .or(no_gain);
        let mut feed_overrides = Vec::new();
        if let (Some(written), Some(corrected), None) = (&mut found.written, corrected, &refusal) {
            let programs = [original.as_slice(), written.steps.as_slice()];
            feed_overrides = on(machine)
                .at_overrides(programs, [uncorrected, corrected], &workers)
                .map_err(of_run)?;
            written.text = written
                .text
                .replacen(NO_OVERRIDES, &override_note(&feed_overrides), 1);
        }
        Ok(CorrectOutcome {
            control: self.target.name,
            planner: stages.planner.name,
            refusal,
            hint: found.unwritten.and_then(|fault| fault.hint()),
            uncorrected,
            corrected: corrected.unwrap_or(uncorrected),
            feed_overrides,
            stretches: found.rounds.commands.len(),
            stretches_changed: changed,
            unchanged: found.unchanged,
            expanded: found
                .written
                .as_ref()
                .is_some_and(|written| written.expanded),
            rounds: found.rounds.rounds,
            pieces: found.pieces,
            is_lost: workers.is_lost(),
            dwell_s: found.rounds.dwell_s,
            warnings: summary
                .warnings
                .iter()
                .cloned()
                .chain(summary.uncontrolled())
                .collect(),
            written: found.written,
            learned,
            machine: machine.clone(),
            assumed: machines.file.map(|file| file.assumption),
            original_steps: original,
            axes,
        })
    }

    /// Prepares the machines of the correction.
    fn machines(
        &self,
        original: &[Step],
        axes: usize,
        box_mm: [[f64; 3]; 2],
        watch: &dyn Watch,
    ) -> Result<JobMachines, JobError> {
        let of_job = self.compensation.on(&self.machine, box_mm)?;
        let learned = self.learned(&of_job, original, axes, watch)?;
        let is_uncertain = learned.is_none() && self.assumed.is_none();
        let file = is_uncertain
            .then(|| FileModel::uncertain(&of_job, axes, self.file_error))
            .flatten();
        let assumed = self.assumed.as_ref();
        let compensated = of_job.compensated.clone();
        let assumed = assumed.map(|machine| Machine {
            compensated,
            ..machine.clone()
        });
        let mut machines = JobMachines {
            nominal: of_job.clone(),
            of_job,
            learned,
            file,
        };
        machines.nominal = deterministic(assumed.as_ref().unwrap_or(machines.machine()));
        Ok(machines)
    }

    /// Finds the commands of all stretches and writes the text.
    fn found(
        &self,
        source: SourceProgram,
        cut: &ExportedCut<'_>,
        file: Option<&FileModel>,
    ) -> Result<(FoundProgram, Workers), RunError> {
        let pieces = self.pieces(cut, &source.steps)?;
        let parts = parts(&source.steps, &splits(&pieces));
        let workers = self.workers(&source, pieces.len());
        let target = self.target.printed(source.largest_unit_mm());
        let program = LongProgram {
            steps: &source.steps,
            parts: &parts,
            pieces: &pieces,
        };
        let mut rounds = rounds_of_pieces(cut, &program, target, file, &workers)?;
        let written = self.written(&source, &parts, &mut rounds);
        let (written, unwritten) =
            written.map_or_else(|fault| (None, Some(fault)), |written| (Some(written), None));
        let unchanged = unchanged_stretches(&parts, &rounds.reasons);
        Ok((
            FoundProgram {
                rounds,
                unchanged,
                written,
                unwritten,
                pieces: pieces.len(),
            },
            workers,
        ))
    }

    /// Rejects a program that does not fit in memory, before it is loaded.
    fn check_motions(&self, summary: &Summary) -> Result<(), JobError> {
        let motions = summary.motions + summary.events;
        if motions > MOST_MOTIONS {
            return Err(JobError::TooManyMotions {
                part: self.program.name(),
                motions,
                most: MOST_MOTIONS,
            });
        }
        Ok(())
    }

    /// Splits a program into pieces. Errors that logs show lie along the whole path: with logs
    /// there is one piece.
    fn pieces(
        &self,
        cut: &ExportedCut<'_>,
        program: &[Canon],
    ) -> Result<Vec<ProgramPiece>, RunError> {
        if self.logs.is_empty() {
            return pieces(cut, program, self.piece_periods);
        }
        Ok(vec![ProgramPiece::whole(program.len())])
    }

    /// Creates the workers that do the work in pieces.
    fn workers(&self, source: &SourceProgram, pieces: usize) -> Workers {
        #[cfg(feature = "files")]
        if let Some(folder) = self.keep.as_ref().filter(|_| pieces > 1)
            && let Some(work) = content_key(&(&source.lines, &source.steps, self.depends_on()))
        {
            return Workers::keeping(self.threads, folder, work);
        }
        #[cfg(not(feature = "files"))]
        let _ = (source, pieces);
        Workers::new(self.threads)
    }

    /// Lists all inputs that the commands of pieces depend on, beside the program. With logs there
    /// is one piece.
    #[cfg(feature = "files")]
    fn depends_on(&self) -> Value {
        // Names all fields, without `..`, so that a new field is not forgotten.
        let Self {
            program: _,
            machine,
            assumed,
            compensation,
            target,
            feed_mm_s,
            reader,
            logs: _,
            file_error,
            piece_periods,
            threads: _,
            keep: _,
        } = self;
        let content = |machine: &Machine| json!([machine.text(), geometry_content(machine)]);
        json!([
            content(machine),
            assumed.as_ref().map(content),
            compensation,
            target.name,
            feed_mm_s,
            reader,
            file_error,
            piece_periods
        ])
    }

    /// Returns the folder of finished pieces, if there are any to continue with.
    #[cfg(feature = "files")]
    pub(crate) fn kept_pieces(&self) -> Option<&Path> {
        let has_pieces = |folder: &&Path| {
            let files = Store::new(folder.to_path_buf()).files();
            files.is_ok_and(|files| !files.is_empty())
        };
        self.keep.as_deref().filter(has_pieces)
    }

    /// Removes the finished pieces that were kept, after the job is done.
    ///
    /// # Errors
    /// A file that exists and cannot be removed.
    #[cfg(feature = "files")]
    pub fn forget_pieces(&self) -> std::io::Result<()> {
        match &self.keep {
            Some(folder) if folder.is_dir() => Store::new(folder.clone()).clear().map(drop),
            _ => Ok(()),
        }
    }

    /// Learns the machine from the logs, if there are any.
    fn learned(
        &self,
        machine: &Machine,
        original: &[Step],
        axes: usize,
        watch: &dyn Watch,
    ) -> Result<Option<LearnedMachine>, JobError> {
        if self.logs.is_empty() {
            return Ok(None);
        }
        watch.begin("learning from the logs", 1);
        let program = LoggedProgram {
            machine,
            stages: self.target.stages(machine),
            original,
            axes,
            watch,
        };
        let learned = program.learned(&self.logs);
        learned
            .map(Some)
            .map_err(|(log, error)| JobError::of_part_log(&log, &self.program, &error))
    }

    /// Writes a text with the commands that were found, with as many lines of the original as
    /// possible. If the program cannot be written out, stretches whose lines cannot be replaced are
    /// given up, as long as others remain.
    fn written(
        &self,
        source: &SourceProgram,
        parts: &[ProgramPart],
        found: &mut RoundsResult,
    ) -> Result<WrittenProgram, UnwrittenProgram> {
        loop {
            match self.written_as_found(source, parts, found) {
                Ok(written) => return Ok(written),
                Err((_, UnkeptLines::Stretches(unkept))) if found.has_other_commands(&unkept) => {
                    found.give_up(&unkept);
                }
                Err((fault, _)) => return Err(fault),
            }
        }
    }

    /// Writes a text with all commands that were found. The error says why the program cannot be
    /// written out, and why the original lines cannot stay.
    fn written_as_found(
        &self,
        source: &SourceProgram,
        parts: &[ProgramPart],
        found: &RoundsResult,
    ) -> Result<WrittenProgram, (UnwrittenProgram, UnkeptLines)> {
        let RoundsResult {
            commands, rests_s, ..
        } = found;
        let notes = [
            format!(
                "{CORRECTED_FOR} {}, control {}",
                self.machine.name, self.target.name
            ),
            format!(
                "{} of {} stretches between corners were changed",
                commands.iter().flatten().count(),
                commands.len()
            ),
            NO_OVERRIDES.to_owned(),
        ];
        let text = TextParts {
            source,
            parts,
            commands,
            rests_s,
            target: self.target,
            notes: &notes,
        };
        let wanted = assembled(parts, commands, rests_s);
        let verify = |text: &str| self.verified(text, source, &wanted);
        let checked = |text: String, expanded: bool| {
            let is_own = |line: &str| source.lines.iter().any(|kept| kept == line);
            if text
                .lines()
                .any(|line| line.len() > self.target.columns && !is_own(line))
            {
                return Err(UnwrittenProgram::Columns(self.target.columns));
            }
            verify(&text)
                .map(|steps| WrittenProgram {
                    text,
                    steps,
                    expanded,
                })
                .map_err(UnwrittenProgram::Text)
        };
        let unkept = match text.kept() {
            Ok(text) => match checked(text, false) {
                Ok(written) => return Ok(written),
                Err(_) => UnkeptLines::Program,
            },
            Err(unkept) => unkept,
        };
        let expanded = text.expanded().map_err(UnwrittenProgram::Line);
        expanded
            .and_then(|text| checked(text, true))
            .map_err(|fault| (fault, unkept))
    }

    /// Returns the path of a text as the control reads it, if it equals the wanted path.
    fn verified(
        &self,
        text: &str,
        source: &SourceProgram,
        wanted: &[Canon],
    ) -> Result<Vec<Step>, TextFault> {
        let dialect = self.target.reads_as(source.dialect);
        let step_mm = self.target.step_mm(source.largest_unit_mm());
        let comparison = TextComparison {
            step_mm,
            of_linuxcnc: dialect == Dialect::LinuxCnc,
        };
        let (read, modes) = verified::read(text, &self.reader, dialect)?;
        comparison.frames(
            read.iter().zip(modes.iter().map(Arc::as_ref)),
            source.steps_and_modes(),
        )?;
        comparison.steps(&read, wanted)?;
        steps_of(&read).map_err(|fault| TextFault::Unreadable {
            text: self.program.name(),
            fault: fault.to_string(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_of_another_uncertainty_of_the_file_are_other_work() {
        let work = |file_error: f64| {
            let machine = Machine::load("tnv40".as_ref()).unwrap();
            let job = CorrectJob::new(Program::from_text("part.ngc", "M2\n"), machine, &TARGETS[0]);
            CorrectJob { file_error, ..job }.depends_on()
        };
        assert_eq!(work(0.1), work(0.1));
        assert_ne!(work(0.1), work(0.0));
    }
}
