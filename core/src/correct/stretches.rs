//! A program as stretches that are cut without a corner, and all else.
//!
//! A stretch is what a correction may bend as a whole: feed motions of X, Y and Z, one behind the other, that meet within
//! [`CORNER_RAD`], without anything between them. At its ends the tool is to be where the program says, so the command rests there
//! until the tool has come: a dwell at true corners and beside rapids.

use std::f64::consts::PI;

use crate::gcode::canon::{Canon, Corner, Event, EventKind, Motion, MotionKind};
use crate::path::pieces::Pieces;
use crate::path::{Piece, Step};
use crate::vector::{Vector, angle};

/// A sharper turn is a corner: no arc is to replace it.
pub(super) const CORNER_RAD: f64 = 25.0 / 180.0 * PI;
/// A turn from which G61 stops, as in feed planners.
const TANGENT_RAD: f64 = 1e-3;

/// Part of a program.
#[derive(Debug, Clone)]
pub(super) enum ProgramPart {
    /// Stays what it is.
    Kept(Canon),
    /// May be bent.
    Stretch(SmoothStretch),
}

/// Feed motions that are cut without a corner.
#[derive(Debug, Clone)]
pub(super) struct SmoothStretch {
    /// As they are programmed.
    pub(super) motions: Vec<Motion>,
    /// Numbers of its first and last step in the program.
    pub(super) steps: [usize; 2],
    /// Whether the tool has to come to rest before and behind.
    pub(super) rests: [bool; 2],
    /// Whether the motion before belongs to the stretch before.
    pub(super) follows: bool,
    ends: [Vector; 2],
}

/// Direction of travel at both ends of a motion; none of one without length.
fn directions(motion: &Motion) -> Option<[Vector; 2]> {
    let alone = Motion { feed_mm_s: motion.feed_mm_s.max(1.0), ..motion.clone() };
    let pieces: Vec<Piece> = Pieces::new(std::iter::once(Canon::Motion(alone)))
        .filter_map(|step| if let Ok(Step::Piece(piece)) = step { Some(piece) } else { None })
        .collect();
    let (first, last) = (pieces.first()?, pieces.last()?);
    Some([first.curve.at(0.0).tangent, last.curve.at(last.length_mm).tangent])
}

/// The parts of a program, in order.
pub(super) fn parts(program: &[Canon]) -> Vec<ProgramPart> {
    let mut parts: Vec<ProgramPart> = Vec::new();
    // Direction at the end of the last motion, and whether nothing has happened since.
    let (mut before, mut adjacent) = (None::<Vector>, false);
    for (index, step) in program.iter().enumerate() {
        let Canon::Motion(motion) = step else {
            parts.push(ProgramPart::Kept(step.clone()));
            adjacent = false;
            continue;
        };
        let Some([starts, ends]) = directions(motion) else {
            parts.push(ProgramPart::Kept(step.clone()));
            continue;
        };
        let turn_rad = before.map(|before| angle(before, starts));
        let bends = motion.kind == MotionKind::Feed && motion.others.is_none();
        if bends && let Some(ProgramPart::Stretch(stretch)) = parts.last_mut().filter(|_| adjacent) {
            let corner = stretch.motions.last().map_or(motion.corner, |last| last.corner);
            if turn_rad.is_some_and(|turn| turn < most_turn_rad(corner)) {
                stretch.motions.push(motion.clone());
                stretch.ends[1] = ends;
                stretch.steps[1] = index;
                before = Some(ends);
                continue;
            }
        }
        let corner = turn_rad.is_some();
        let mut follows = false;
        if let Some(last) = last_stretch(&mut parts) {
            last.rests[1] = !bends;
            follows = true;
        }
        parts.push(if bends {
            let motions = vec![motion.clone()];
            ProgramPart::Stretch(SmoothStretch {
                motions,
                steps: [index; 2],
                rests: [corner, false],
                follows,
                ends: [starts, ends],
            })
        } else {
            ProgramPart::Kept(step.clone())
        });
        (before, adjacent) = (Some(ends), true);
    }
    parts
}

/// The stretch that the last motion belongs to.
fn last_stretch(parts: &mut [ProgramPart]) -> Option<&mut SmoothStretch> {
    let last = parts.iter_mut().rev().find(|part| !matches!(part, ProgramPart::Kept(Canon::Event(_))))?;
    if let ProgramPart::Stretch(stretch) = last { Some(stretch) } else { None }
}

/// Turn at which a motion that ends by `corner` ends a stretch.
fn most_turn_rad(corner: Corner) -> f64 {
    match corner {
        Corner::ExactStop => 0.0,
        Corner::ExactPath => TANGENT_RAD,
        Corner::Continuous { .. } => CORNER_RAD,
    }
}

impl SmoothStretch {
    /// Where it starts.
    pub(super) fn start_mm(&self) -> Vector {
        self.motions[0].start_mm
    }

    /// Where it ends.
    pub(super) fn end_mm(&self) -> Vector {
        self.motions[self.motions.len() - 1].end_mm
    }

    /// Directions of travel at both ends.
    pub(super) const fn directions(&self) -> [Vector; 2] {
        self.ends
    }
}

/// Motions in place of those of a stretch; none where it stays as it is.
pub(super) type StretchCommand = Option<Vec<Motion>>;

/// The program with other motions in place of its stretches, and dwells where the tool has to come to rest.
///
/// The line of a motion is the number of its stretch, from 1, and 0 of all that is kept.
pub(super) fn assembled(parts: &[ProgramPart], commands: &[StretchCommand], dwell_s: f64) -> Vec<Canon> {
    let (mut program, mut number) = (Vec::new(), 0);
    let rest = || Canon::Event(Event { line: 0, kind: EventKind::Dwell { seconds: dwell_s } });
    let numbered = |motion: &Motion, line: u32| Canon::Motion(Motion { line, ..motion.clone() });
    for part in parts {
        match part {
            ProgramPart::Kept(Canon::Motion(motion)) => program.push(numbered(motion, 0)),
            ProgramPart::Kept(event) => program.push(event.clone()),
            ProgramPart::Stretch(stretch) => {
                let [before, behind] = dwells(parts, commands, number);
                let motions = commands[number].as_ref().unwrap_or(&stretch.motions);
                number += 1;
                program.extend(before.then(rest));
                program.extend(motions.iter().map(|motion| numbered(motion, number as u32)));
                program.extend(behind.then(rest));
            }
        }
    }
    join(&mut program);
    program
}

/// Whether a dwell is needed before and behind a stretch: where it, or the stretch before, has another command.
pub(super) fn dwells(parts: &[ProgramPart], commands: &[StretchCommand], number: usize) -> [bool; 2] {
    let Some(stretch) = stretches(parts).nth(number) else { return [false; 2] };
    let changed = commands[number].is_some();
    let before_changed = number > 0 && commands[number - 1].is_some() && stretch.follows;
    [stretch.rests[0] && (changed || before_changed), stretch.rests[1] && changed]
}

/// Printed ends need not be those of the program to the last digit: each motion begins where the one before has ended.
fn join(program: &mut [Canon]) {
    let mut here_mm = None;
    for step in program {
        if let Canon::Motion(motion) = step {
            motion.start_mm = here_mm.unwrap_or(motion.start_mm);
            here_mm = Some(motion.end_mm);
        }
    }
}

/// The stretches among the parts.
pub(super) fn stretches(parts: &[ProgramPart]) -> impl Iterator<Item = &SmoothStretch> {
    parts.iter().filter_map(|part| if let ProgramPart::Stretch(stretch) = part { Some(stretch) } else { None })
}
