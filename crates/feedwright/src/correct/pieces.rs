//! A long program in pieces, so that the rows of a cut fit in memory.
//!
//! Each piece is corrected by itself, with budgets of blocks and time of its own. Before and after
//! its own steps it has a lead: steps of the program that are corrected with it, but belong to
//! another piece. They do not count in any budget. The lead is as long as the loop remembers, plus
//! the time in which the control stops from its highest feedrate, which bounds its look-ahead. So
//! the tool and the control behave as in the whole program. A program that is short enough is one
//! piece, without a lead.
//!
//! A piece ends where the machine stands or moves rapidly; where there is no such place, at a
//! corner. Where there is no corner either, it ends where the path bends least, and the commands of
//! both pieces meet in a [seam](super::seams).

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use feedwright_gcode::canon::{Canon, Motion, MotionKind, Shape};
use feedwright_plan::{Pieces, Step, vector::angle};
use feedwright_sim::{Machine, RunError, Watch};

use super::exported::{ExportedCut, length_mm};
use super::file_prior::FileModel;
use super::rounds::{JudgedPart, RoundsResult, rounds, steps_of};
use super::seams::{Seam, is_parted, meet};
use super::stretches::{NewMotions, ProgramPart, directions, parts, stretches};
use super::target::PrintedTarget;
use super::unchanged::UnchangedReason;
use super::workers::Workers;

/// Servo periods of a piece: their rows take some 100 MB. A program of up to [`WHOLE_PIECES`]
/// pieces is one piece.
pub(super) const PIECE_PERIODS: u64 = 500_000;
const WHOLE_PIECES: u64 = 2;
/// A piece ends within these parts of its length.
const ENDS_WITHIN: [f64; 2] = [0.75, 1.25];
/// Time constants of the position loop after which less than 1e-8 of the tool's starting error
/// remains.
const MEMORY: f64 = 20.0;
/// A motion takes no longer than its time at the programmed feedrate plus this, s. With this
/// estimate, short programs need no plan.
const STOP_S: f64 = 0.2;
/// Tolerance for assigning the rest at the end of a step to the next step, mm, so that rounding
/// does not decide.
const AT_END_MM: f64 = 1e-6;
/// Progress of a piece, steps.
const STEPS: u64 = 1000;

/// Steps that are corrected together.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct ProgramPiece {
    /// Its own steps.
    own: Range<usize>,
    /// Its own steps and the leads.
    cut: Range<usize>,
}

impl ProgramPiece {
    /// All steps of a program as one piece.
    pub(super) const fn whole(steps: usize) -> Self {
        Self {
            own: 0..steps,
            cut: 0..steps,
        }
    }
}

/// Returns the first steps of all pieces but the first.
pub(super) fn splits(pieces: &[ProgramPiece]) -> Vec<usize> {
    pieces.iter().skip(1).map(|piece| piece.own.start).collect()
}

/// Splits a program into pieces of about `periods` servo periods each, as the control plans it.
pub(super) fn pieces(
    cut: &ExportedCut<'_>,
    program: &[Canon],
    periods: u64,
) -> Result<Vec<ProgramPiece>, RunError> {
    let servo_s = cut.machine.period.servo_s;
    let whole = WHOLE_PIECES * periods;
    if cut.programmed_s(STOP_S) <= whole as f64 * servo_s {
        return Ok(vec![ProgramPiece::whole(program.len())]);
    }
    let numbered = program.iter().enumerate().map(|(step, canon)| match canon {
        Canon::Motion(motion) => Canon::Motion(Motion {
            line: step as u32,
            ..motion.clone()
        }),
        Canon::Event(event) => Canon::Event(event.clone()),
    });
    let numbered: Vec<Step> = Pieces::new(numbered).collect::<Result<_, _>>()?;
    let until = cut.periods(&numbered, program.len())?;
    if until.last().is_none_or(|&all| all <= whole) {
        return Ok(vec![ProgramPiece::whole(program.len())]);
    }
    let lead = (lead_s(cut.machine) / servo_s).ceil() as u64;
    let begins = begins(program, &until, periods);
    let ends = begins.iter().skip(1).copied().chain([program.len()]);
    Ok(begins
        .iter()
        .zip(ends)
        .map(|(&from, to)| with_leads(from..to, &until, lead))
        .collect())
}

/// Computes the length of a lead, s.
fn lead_s(machine: &Machine) -> f64 {
    let limits = &machine.limits;
    let fastest_mm_s = limits.rapid_mm_s.max(limits.max_feed_mm_s);
    MEMORY / machine.slowest_kp_1_s() + fastest_mm_s / limits.tangential_accel_mm_s2
}

/// Own steps between leads of at least one step, where there is any.
fn with_leads(own: Range<usize>, until: &[u64], lead: u64) -> ProgramPiece {
    let before = |step: usize| if step == 0 { 0 } else { until[step - 1] };
    let (from, to) = (before(own.start), before(own.end));
    let first = until
        .partition_point(|&until| until + lead < from)
        .min(own.start.saturating_sub(1));
    let last = until.partition_point(|&until| until < to + lead) + 1;
    ProgramPiece {
        cut: first..last.max(own.end + 1).min(until.len()),
        own,
    }
}

/// The first steps of all pieces.
fn begins(program: &[Canon], until: &[u64], periods: u64) -> Vec<usize> {
    let mut corner = vec![false; program.len()];
    let mut step = 0;
    for part in parts(program, &[]) {
        corner[step] = true;
        step += if let ProgramPart::Stretch(stretch) = part {
            stretch.motions.len()
        } else {
            1
        };
    }
    let all = until.last().copied().unwrap_or(0);
    let mut begins = vec![0];
    let mut from = 0;
    while (all - from) as f64 > ENDS_WITHIN[1] * periods as f64 {
        let [earliest, latest] = ENDS_WITHIN.map(|part| from + (part * periods as f64) as u64);
        let first = until.partition_point(|&until| until < earliest) + 1;
        let last = (until.partition_point(|&until| until <= latest) + 1).min(program.len());
        // A step that is longer than the whole range ends its piece.
        let best = (first..last.max(first + 1)).filter(|&step| step < program.len());
        let Some(best) = best
            .max_by(|&a, &b| fitness(program, &corner, a).total_cmp(&fitness(program, &corner, b)))
        else {
            break;
        };
        begins.push(best);
        from = until[best - 1];
    }
    begins
}

/// Rates a step as the start of a piece: 3 before a rapid or an event, 2 after one, 1 at a corner,
/// less where the path continues smoothly.
fn fitness(program: &[Canon], corner: &[bool], step: usize) -> f64 {
    let rests = |step: usize| !matches!(&program[step], Canon::Motion(motion) if motion.kind == MotionKind::Feed);
    match (&program[step - 1], &program[step]) {
        _ if rests(step) && !rests(step - 1) => 3.0,
        _ if rests(step) || rests(step - 1) => 2.0,
        _ if corner[step] => 1.0,
        (Canon::Motion(last), Canon::Motion(next)) => {
            let is_straight = last.shape == Shape::Line && next.shape == Shape::Line;
            let turn_rad = directions(last)
                .zip(directions(next))
                .map_or(0.0, |(last, next)| angle(last[1], next[0]));
            f64::from(u8::from(is_straight)) - 1.0 - turn_rad
        }
        _ => 0.0,
    }
}

/// Finds commands for the stretches of all pieces; the stretches are those of the program split
/// where pieces begin.
pub(super) fn rounds_of_pieces(
    cut: &ExportedCut<'_>,
    program: &LongProgram<'_>,
    target: PrintedTarget<'_>,
    file: Option<&FileModel>,
    workers: &Workers,
) -> Result<RoundsResult, RunError> {
    let LongProgram { parts, pieces, .. } = program;
    if pieces.len() == 1 {
        return rounds(cut, parts, target, file, &JudgedPart::whole(parts));
    }
    cut.watch.begin(
        &format!("correcting in {} pieces", pieces.len()),
        STEPS * pieces.len() as u64,
    );
    let all = workers.each("piece", pieces.len(), usize::MAX, |k| {
        program.rounds(k, cut, target, file)
    })?;
    let mut whole = RoundsResult::default();
    for piece in all {
        whole.commands.extend(piece.commands);
        whole.reasons.extend(piece.reasons);
        whole.rests_s.extend(piece.rests_s);
        whole.dwell_s = whole.dwell_s.max(piece.dwell_s);
        whole.rounds += piece.rounds;
    }
    meet(&mut whole.commands, parts, &splits(pieces));
    Ok(whole)
}

/// A program and its pieces.
pub(super) struct LongProgram<'a> {
    pub(super) steps: &'a [Canon],
    /// Split where pieces begin.
    pub(super) parts: &'a [ProgramPart],
    pub(super) pieces: &'a [ProgramPiece],
}

impl LongProgram<'_> {
    /// Returns true if the program has several stretches, before it is split.
    fn of_several(&self) -> bool {
        let splits = splits(self.pieces);
        stretches(self.parts)
            .filter(|stretch| !is_parted(stretch, &splits))
            .nth(1)
            .is_some()
    }

    /// Finds commands for the stretches of a piece, as far as they are in it.
    fn rounds(
        &self,
        number: usize,
        cut: &ExportedCut<'_>,
        target: PrintedTarget<'_>,
        file: Option<&FileModel>,
    ) -> Result<RoundsResult, RunError> {
        let piece = &self.pieces[number];
        let (from, steps) = (piece.cut.start, &self.steps[piece.cut.clone()]);
        let own = piece.own.start - from..piece.own.end - from;
        let original = steps_of(steps)?;
        let watch = PieceWatch {
            of_all: cut.watch,
            done: AtomicU64::new(0),
        };
        let parts = parts(steps, &[]);
        let count = |is: &dyn Fn(&[usize; 2]) -> bool| {
            stretches(&parts)
                .take_while(|stretch| is(&stretch.steps))
                .count()
        };
        let inside = count(&|[_, last]| *last < own.start)..count(&|[first, _]| *first < own.end);
        let until_mm =
            |step: usize| Ok::<f64, RunError>(length_mm(&steps_of(&steps[..step])?) - AT_END_MM);
        let path_mm = until_mm(own.start)?..until_mm(own.end)?;
        let judged = JudgedPart {
            stretches: inside.clone(),
            path_mm,
            of_several: self.of_several(),
        };
        let cut = ExportedCut {
            original: &original,
            watch: &watch,
            ..*cut
        };
        let mut found = rounds(&cut, &parts, target, file, &judged)?;
        cut.watch
            .advance(STEPS.saturating_sub(watch.done.load(Ordering::Relaxed)));
        let seams = [own.start, own.end].map(|step| seam(steps, step));
        for (k, stretch) in stretches(&parts)
            .enumerate()
            .filter(|(k, _)| inside.contains(k))
        {
            let [begins, ends] = [stretch.steps[0] < own.start, stretch.steps[1] >= own.end];
            let sides = [seams[0].filter(|_| begins), seams[1].filter(|_| ends)];
            let Some(command) = found.commands[k].take() else {
                continue;
            };
            found.commands[k] = within(command, sides);
            found.reasons[k] = found.commands[k]
                .is_none()
                .then_some(UnchangedReason::LeavesPath);
        }
        Ok(RoundsResult {
            commands: found.commands[inside.clone()].to_vec(),
            reasons: found.reasons[inside.clone()].to_vec(),
            rests_s: found.rests_s[inside].to_vec(),
            ..found
        })
    }
}

/// The seam before a step.
fn seam(steps: &[Canon], step: usize) -> Option<Seam> {
    match steps.get(step) {
        Some(Canon::Motion(motion)) => Seam::before(motion),
        _ => None,
    }
}

/// Returns the part of a command between the seams; none if it does not cross one of them.
fn within(mut command: NewMotions, [first, last]: [Option<Seam>; 2]) -> Option<NewMotions> {
    if let Some(seam) = first {
        (command.motions, command.approach) = (seam.behind_it(&command.motions)?, None);
    }
    if let Some(seam) = last {
        (command.motions, command.settles) = (seam.before_it(&command.motions)?, false);
    }
    Some(command)
}

/// Adds the progress of a piece to the progress of the whole program.
struct PieceWatch<'a> {
    of_all: &'a dyn Watch,
    done: AtomicU64,
}

impl Watch for PieceWatch<'_> {
    fn advance(&self, steps: u64) {
        self.done.fetch_add(steps, Ordering::Relaxed);
        self.of_all.advance(steps);
    }

    fn is_cancelled(&self) -> bool {
        self.of_all.is_cancelled()
    }

    fn clock(&self) -> Duration {
        self.of_all.clock()
    }
}
