//! A program as stretches that are cut without a corner, and the parts between them.
//!
//! A stretch is the unit that a correction may bend: feed motions of X, Y and Z, one after the
//! other, that meet within [`CORNER_RAD`], without anything between them. At its ends the tool must
//! be where the program says, so the command rests there until the tool has arrived: a dwell at
//! true corners and next to rapids.

use std::f64::consts::PI;

use feedwright_gcode::canon::{Canon, Corner, Event, EventKind, Motion, MotionKind, Plane, Shape};
use feedwright_plan::vector::{Vector, angle};
use feedwright_plan::{Piece, Pieces, Step};
use serde::{Deserialize, Serialize};

/// A sharper turn is a corner: no arc may replace it.
pub(super) const CORNER_RAD: f64 = 25.0 / 180.0 * PI;
/// A turn from which G61 stops, as in feed planners.
const TANGENT_RAD: f64 = 1e-3;

/// Fraction of a dwell for which the tool rests where it arrives slowly.
const SETTLED: f64 = 0.25;

/// Part of a program.
#[derive(Debug, Clone)]
pub(super) enum ProgramPart {
    /// Stays as programmed.
    Kept(Canon),
    /// May be bent.
    Stretch(SmoothStretch),
}

/// Feed motions that are cut without a corner.
#[derive(Debug, Clone)]
pub(super) struct SmoothStretch {
    /// Motions as programmed.
    pub(super) motions: Vec<Motion>,
    /// Numbers of its first and last step in the program.
    pub(super) steps: [usize; 2],
    /// True where the tool has to come to rest before and after the stretch.
    pub(super) rests: [bool; 2],
    /// True where the previous motion belongs to the previous stretch.
    pub(super) follows: bool,
    /// The straight rapid that leads to its start, and its step in the program.
    pub(super) rapid: Option<(usize, Motion)>,
    pub(super) ends: [Vector; 2],
}

/// The pieces of the path of a motion.
pub(super) fn pieces(motion: &Motion) -> Vec<Piece> {
    let alone = Motion {
        feed_mm_s: motion.feed_mm_s.max(1.0),
        ..motion.clone()
    };
    let steps = Pieces::new(std::iter::once(Canon::Motion(alone)));
    steps
        .filter_map(|step| {
            if let Ok(Step::Piece(piece)) = step {
                Some(piece)
            } else {
                None
            }
        })
        .collect()
}

/// Returns the length of the path of a motion, mm.
pub(super) fn length_mm(motion: &Motion) -> f64 {
    pieces(motion).iter().map(|piece| piece.length_mm).sum()
}

/// Returns the direction of travel at both ends of a motion; none if it has no length.
pub(super) fn directions(motion: &Motion) -> Option<[Vector; 2]> {
    let pieces = pieces(motion);
    let (first, last) = (pieces.first()?, pieces.last()?);
    Some([
        first.curve.at(0.0).tangent,
        last.curve.at(last.length_mm).tangent,
    ])
}

/// Splits a program into its parts, in order. A stretch ends before each step of `splits`, which is
/// sorted; the tool does not rest there.
pub(super) fn parts(program: &[Canon], splits: &[usize]) -> Vec<ProgramPart> {
    let mut parts: Vec<ProgramPart> = Vec::new();
    // Direction at the end of the last motion, and whether nothing has happened since.
    let (mut before, mut adjacent) = (None::<Vector>, false);
    let mut rapid = None;
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
        let mut corner = turn_rad.is_some();
        if bends && let Some(ProgramPart::Stretch(stretch)) = parts.last_mut().filter(|_| adjacent)
        {
            let mode = stretch
                .motions
                .last()
                .map_or(motion.corner, |last| last.corner);
            let smooth = turn_rad.is_some_and(|turn| turn < most_turn_rad(mode));
            corner &= !smooth;
            if smooth && splits.binary_search(&index).is_err() {
                stretch.motions.push(motion.clone());
                stretch.ends[1] = ends;
                stretch.steps[1] = index;
                before = Some(ends);
                continue;
            }
        }
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
                rapid: rapid.take(),
                ends: [starts, ends],
            })
        } else {
            ProgramPart::Kept(step.clone())
        });
        let leads = motion.kind == MotionKind::Rapid
            && motion.shape == Shape::Line
            && motion.others.is_none();
        rapid = leads.then(|| (index, motion.clone()));
        (before, adjacent) = (Some(ends), true);
    }
    parts
}

/// Returns the stretch that the last motion belongs to.
fn last_stretch(parts: &mut [ProgramPart]) -> Option<&mut SmoothStretch> {
    let last = parts
        .iter_mut()
        .rev()
        .find(|part| !matches!(part, ProgramPart::Kept(Canon::Event(_))))?;
    if let ProgramPart::Stretch(stretch) = last {
        Some(stretch)
    } else {
        None
    }
}

/// Returns the turn at which a motion that ends by `corner` ends a stretch, rad.
fn most_turn_rad(corner: Corner) -> f64 {
    match corner {
        Corner::ExactStop => 0.0,
        Corner::ExactPath => TANGENT_RAD,
        Corner::Continuous { .. } => CORNER_RAD,
    }
}

impl SmoothStretch {
    /// Returns the start of the stretch, mm.
    pub(super) fn start_mm(&self) -> Vector {
        self.motions[0].start_mm
    }

    /// Returns the end of the stretch, mm.
    pub(super) fn end_mm(&self) -> Vector {
        self.motions[self.motions.len() - 1].end_mm
    }

    /// Returns the directions of travel at both ends.
    pub(super) const fn directions(&self) -> [Vector; 2] {
        self.ends
    }

    /// Returns the plane of the arcs that may replace its motions: the plane that its arcs and
    /// splines share, or XY if they share none.
    pub(super) fn plane(&self) -> Plane {
        let shares = |plane: &Plane| self.motions.iter().all(|motion| has_plane(motion, *plane));
        let bends = self
            .motions
            .iter()
            .any(|motion| motion.shape != Shape::Line);
        [Plane::Xy, Plane::Zx, Plane::Yz]
            .into_iter()
            .find(|plane| bends && shares(plane))
            .unwrap_or(Plane::Xy)
    }
}

/// Returns true if a motion is straight, or bends in this plane.
fn has_plane(motion: &Motion, plane: Plane) -> bool {
    match &motion.shape {
        Shape::Line => true,
        Shape::Arc { plane: own, .. } => *own == plane,
        Shape::Spline(spline) => {
            let [.., normal] = plane.axes();
            spline
                .control_mm
                .iter()
                .all(|point_mm| point_mm[normal] == motion.start_mm[normal])
        }
    }
}

/// Motions that replace the motions of a stretch.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct NewMotions {
    /// Motions that replace the motions of the stretch.
    pub(super) motions: Vec<Motion>,
    /// Motions that replace the rapid to the stretch: a rapid for most of the way, and a slow feed
    /// motion to its end.
    pub(super) approach: Option<[Motion; 2]>,
    /// True where the last motion is so slow that the tool has settled at its end.
    pub(super) settles: bool,
}

/// New command of a stretch; none if it stays as programmed.
pub(super) type StretchCommand = Option<NewMotions>;

/// Returns the program with new motions for its stretches, and dwells where the tool has to come to
/// rest.
///
/// The line of a motion is the number of its stretch, from 1; it is 0 for all motions that are
/// kept.
pub(super) fn assembled(
    parts: &[ProgramPart],
    commands: &[StretchCommand],
    rests_s: &[f64],
) -> Vec<Canon> {
    let (mut program, mut number) = (Vec::new(), 0);
    let rest = |seconds: f64| {
        Canon::Event(Event {
            line: 0,
            kind: EventKind::Dwell { seconds },
        })
    };
    let numbered = |motion: &Motion, line: u32| {
        Canon::Motion(Motion {
            line,
            ..motion.clone()
        })
    };
    for part in parts {
        match part {
            ProgramPart::Kept(Canon::Motion(motion)) => program.push(numbered(motion, 0)),
            ProgramPart::Kept(event) => program.push(event.clone()),
            ProgramPart::Stretch(stretch) => {
                let [before, behind] = dwells(stretch, commands, number, rests_s);
                let command = commands[number].as_ref();
                let motions = command.map_or(&stretch.motions, |command| &command.motions);
                if let Some(approach) = command.and_then(|command| command.approach.as_ref()) {
                    slow_down(&mut program, approach);
                }
                number += 1;
                program.extend(before.map(rest));
                program.extend(motions.iter().map(|motion| numbered(motion, number as u32)));
                program.extend(behind.map(rest));
            }
        }
    }
    join(&mut program);
    program
}

/// Replaces the last rapid by an approach.
fn slow_down(program: &mut Vec<Canon>, approach: &[Motion; 2]) {
    if let Some(at) = program
        .iter()
        .rposition(|step| matches!(step, Canon::Motion(_)))
    {
        let slow = approach.iter().map(|motion| {
            Canon::Motion(Motion {
                line: 0,
                ..motion.clone()
            })
        });
        program.splice(at..=at, slow);
    }
}

/// Returns the time of a dwell, s. It is shorter if the tool arrives slowly.
pub(super) fn rest_s(comes_slowly: bool, dwell_s: f64) -> f64 {
    if comes_slowly {
        (SETTLED * dwell_s * 1e3).round().max(1.0) / 1e3
    } else {
        dwell_s
    }
}

/// Returns the times for which the tool rests before and after a stretch, s. It rests if the
/// stretch, or the one before it, has another command. The time is a full dwell, or less if the
/// tool arrives so slowly that it has settled. `rests_s` has a dwell for each stretch.
pub(super) fn dwells(
    stretch: &SmoothStretch,
    commands: &[StretchCommand],
    number: usize,
    rests_s: &[f64],
) -> [Option<f64>; 2] {
    let dwell_s = rests_s[number];
    let command = commands[number].as_ref();
    let before = if number > 0 && stretch.follows {
        commands[number - 1].as_ref()
    } else {
        None
    };
    let comes_slowly = command.is_some_and(|command| command.approach.is_some());
    let comes_slowly = comes_slowly || before.is_some_and(|before| before.settles);
    let goes_slowly = command.is_some_and(|command| command.settles);
    let rests_before = stretch.rests[0] && (command.is_some() || before.is_some());
    let rests_behind = stretch.rests[1] && command.is_some();
    [
        rests_before.then(|| rest_s(comes_slowly, dwell_s)),
        rests_behind.then(|| rest_s(goes_slowly, dwell_s)),
    ]
}

/// Makes each motion begin where the previous one ended: printed ends may differ from the program
/// in the last digit.
fn join(program: &mut [Canon]) {
    let mut here_mm = None;
    for step in program {
        if let Canon::Motion(motion) = step {
            motion.start_mm = here_mm.unwrap_or(motion.start_mm);
            here_mm = Some(motion.end_mm);
        }
    }
}

/// Returns the stretches among the parts.
pub(super) fn stretches(parts: &[ProgramPart]) -> impl Iterator<Item = &SmoothStretch> {
    parts.iter().filter_map(|part| {
        if let ProgramPart::Stretch(stretch) = part {
            Some(stretch)
        } else {
            None
        }
    })
}
