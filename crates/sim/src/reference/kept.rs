//! Pieces and phases that are kept: the planned path looked up by plan time, the programmed one by
//! arc length.

use feedwright_plan::vector::{norm, scale};
use feedwright_plan::{
    AxisMotion, Phase, Piece, PlannedPiece, Point, ProgrammedPart, signed_distance_mm,
};

use super::nearest::{Range, nearest};
use super::{Foot, Sample};
use std::collections::VecDeque;

/// Times that a servo period looks at: two or three samples, and both ends of the range for the
/// nearest point.
const HINTS: usize = 6;

/// Speed, mm/s, above which the tangent is the direction of the velocity. At lower speed that
/// direction would be rounding error, so the tangent comes from the piece.
const MIN_DIRECTED_MM_S: f64 = 1e-6;

/// Pieces and phases in order, the oldest forgotten.
#[derive(Debug, Default)]
pub(super) struct KeptPath {
    programmed: VecDeque<Piece>,
    planned: VecDeque<PlannedPiece>,
    /// Numbers of the first pieces kept.
    first_programmed: u64,
    first_planned: u64,
    phases: VecDeque<Phase>,
    /// Indices of phases found before: where to look first, never what to answer. A control loop
    /// looks at a few times that move on together; each comes to have a hint of its own.
    hints: [usize; HINTS],
}

impl KeptPath {
    pub(super) fn push_programmed(&mut self, piece: Piece) {
        self.programmed.push_back(piece);
    }

    pub(super) fn push_planned(&mut self, piece: PlannedPiece) {
        self.planned.push_back(piece);
    }

    pub(super) fn push_phase(&mut self, phase: Phase) {
        self.phases.push_back(phase);
    }

    pub(super) fn kept(&self) -> (usize, usize) {
        (self.planned.len(), self.phases.len())
    }

    /// Drops phases that end before `tau_s` and pieces that no phase kept needs; the last of each
    /// stays.
    pub(super) fn forget_before(&mut self, tau_s: f64) {
        while self.phases.len() > 1 && self.phases[1].tau_s <= tau_s {
            self.phases.pop_front();
            for hint in &mut self.hints {
                *hint = hint.saturating_sub(1);
            }
        }
        let Some(first) = self.phases.front() else {
            return;
        };
        while self.first_planned < first.piece && self.planned.len() > 1 {
            self.planned.pop_front();
            self.first_planned += 1;
        }
        let keeps =
            |piece: &Piece, number: u64| match self.planned.front().map(|planned| planned.origin) {
                Some(ProgrammedPart::Unchanged(first)) => number >= first,
                Some(ProgrammedPart::Part { from_mm, .. }) => {
                    piece.s_mm + piece.length_mm > from_mm
                }
                None => true,
            };
        while self.programmed.len() > 1 && !keeps(&self.programmed[0], self.first_programmed) {
            self.programmed.pop_front();
            self.first_programmed += 1;
        }
    }

    #[inline]
    pub(super) fn at(&mut self, tau_s: f64) -> Sample {
        let Some((phase, index)) = self.phase_at(tau_s) else {
            return Sample::nowhere();
        };
        let ended = index + 1 == self.phases.len() && tau_s >= phase.tau_s + phase.duration_s;
        let Some(PlannedPiece { piece, origin }) = self.planned(phase.piece) else {
            return Sample::nowhere();
        };
        let along_s = along(&phase, tau_s);
        let local_mm = local_mm(&phase, piece, along_s);
        let at = piece.curve.at(local_mm);
        let (s_mm, programmed_mm) = match *origin {
            ProgrammedPart::Unchanged(_) => (piece.s_mm + local_mm, at.position_mm),
            ProgrammedPart::Part { from_mm, to_mm } => {
                let s_mm = from_mm + local_mm / piece.length_mm * (to_mm - from_mm);
                (
                    s_mm,
                    self.nearest_along(at.position_mm, s_mm, s_mm).position_mm,
                )
            }
        };
        if let Some(motion) = phase.motion {
            let stands = Point {
                position_mm: programmed_mm,
                tangent: at.tangent,
            };
            return beside(piece, s_mm, stands, &motion.after(along_s), ended);
        }
        let resting = ended || phase.rest.is_some();
        Sample {
            position_mm: at.position_mm,
            tangent: at.tangent,
            s_mm,
            programmed_mm,
            feed_mm_s: if resting {
                0.0
            } else {
                phase.speed_mm_s(along_s)
            },
            line: phase.rest.unwrap_or(piece.line),
            cutting: piece.cutting && !resting,
            rapid: !piece.cutting,
            resting,
        }
    }

    #[inline]
    pub(super) fn nearest(&mut self, point_mm: [f64; 3], tau_lo_s: f64, tau_hi_s: f64) -> Foot {
        let (Some((first, lo_mm)), Some((last, hi_mm))) =
            (self.place_at(tau_lo_s), self.place_at(tau_hi_s))
        else {
            return Foot::nowhere(point_mm);
        };
        self.nearest_within(
            Range {
                first,
                last,
                lo_mm,
                hi_mm,
            },
            point_mm,
        )
    }

    /// Index of the programmed piece at a plan time, and the place in it.
    fn place_at(&mut self, tau_s: f64) -> Option<(usize, f64)> {
        let (phase, _) = self.phase_at(tau_s)?;
        let PlannedPiece { piece, origin } = self.planned(phase.piece)?;
        let local_mm = local_mm(&phase, piece, along(&phase, tau_s));
        Some(match *origin {
            ProgrammedPart::Unchanged(number) => {
                ((number - self.first_programmed) as usize, local_mm)
            }
            ProgrammedPart::Part { from_mm, to_mm } => {
                self.place_of(from_mm + local_mm / piece.length_mm * (to_mm - from_mm))
            }
        })
    }

    /// Returns the nearest point between two arc lengths of the path.
    #[inline]
    pub(super) fn nearest_along(&self, point_mm: [f64; 3], lo_mm: f64, hi_mm: f64) -> Foot {
        if self.programmed.is_empty() {
            return Foot::nowhere(point_mm);
        }
        let (first, lo_mm) = self.place_of(lo_mm);
        let (last, hi_mm) = if hi_mm > lo_mm {
            self.place_of(hi_mm)
        } else {
            (first, lo_mm)
        };
        self.nearest_within(
            Range {
                first,
                last,
                lo_mm,
                hi_mm,
            },
            point_mm,
        )
    }

    fn nearest_within(&self, range: Range, point_mm: [f64; 3]) -> Foot {
        if range.first == range.last {
            let piece = &self.programmed[range.first];
            let hi_mm = range.hi_mm.max(range.lo_mm);
            return super::foot(
                piece,
                piece.curve.nearest(point_mm, range.lo_mm, hi_mm),
                point_mm,
            );
        }
        nearest(&self.programmed, range, point_mm)
    }

    /// Index of the piece at an arc length, and the place in it.
    fn place_of(&self, s_mm: f64) -> (usize, f64) {
        let index = self
            .programmed
            .partition_point(|piece| piece.s_mm <= s_mm)
            .saturating_sub(1);
        let piece = &self.programmed[index];
        (index, (s_mm - piece.s_mm).max(0.0).min(piece.length_mm))
    }

    /// Start and end of the rest at a plan time.
    pub(super) fn rest(&mut self, tau_s: f64) -> Option<(f64, f64)> {
        let (phase, _) = self.phase_at(tau_s)?;
        let end_s = phase.tau_s + phase.duration_s;
        (phase.rest.is_some() && tau_s < end_s).then_some((phase.tau_s, end_s))
    }

    fn planned(&self, number: u64) -> Option<&PlannedPiece> {
        self.planned
            .get(number.checked_sub(self.first_planned)? as usize)
    }

    /// The last phase that starts at `tau_s` or before, or else the first.
    ///
    /// Looks ahead from the hint nearest before, in steps that double, and then halves.
    #[inline]
    fn phase_at(&mut self, tau_s: f64) -> Option<(Phase, usize)> {
        let starts_by = |index: usize| {
            self.phases
                .get(index)
                .is_some_and(|phase| phase.tau_s <= tau_s)
        };
        let mut slot = None;
        let mut lo = 0;
        for (candidate, &hint) in self.hints.iter().enumerate() {
            if hint >= lo && starts_by(hint) {
                (slot, lo) = (Some(candidate), hint);
            }
        }
        let mut step = 1;
        while starts_by(lo + step) {
            lo += step;
            step *= 2;
        }
        while step > 1 {
            step /= 2;
            if starts_by(lo + step) {
                lo += step;
            }
        }
        if let Some(slot) = slot {
            self.hints[slot] = lo;
        }
        self.phases.get(lo).map(|phase| (*phase, lo))
    }
}

/// Returns the reference where it leaves its piece. `at`, at `s_mm`, is the matching point of the
/// programmed path.
fn beside(piece: &Piece, s_mm: f64, at: Point, motion: &AxisMotion, ended: bool) -> Sample {
    let speed_mm_s = norm(motion.velocity_mm_s);
    Sample {
        position_mm: motion.position_mm,
        tangent: if speed_mm_s > MIN_DIRECTED_MM_S {
            scale(1.0 / speed_mm_s, motion.velocity_mm_s)
        } else {
            at.tangent
        },
        s_mm,
        programmed_mm: at.position_mm,
        feed_mm_s: if ended { 0.0 } else { speed_mm_s },
        line: piece.line,
        cutting: piece.cutting && !ended,
        rapid: !piece.cutting,
        resting: ended,
    }
}

/// Time since the start of the phase, kept within it; NaN counts as its start.
#[inline]
fn along(phase: &Phase, tau_s: f64) -> f64 {
    (tau_s - phase.tau_s).max(0.0).min(phase.duration_s)
}

#[inline]
fn local_mm(phase: &Phase, piece: &Piece, along: f64) -> f64 {
    phase.place_mm(along).min(piece.length_mm)
}

impl Sample {
    /// A program without motion rests at the origin.
    const fn nowhere() -> Self {
        Self {
            position_mm: [0.0; 3],
            tangent: [1.0, 0.0, 0.0],
            s_mm: 0.0,
            programmed_mm: [0.0; 3],
            feed_mm_s: 0.0,
            line: 0,
            cutting: false,
            rapid: false,
            resting: true,
        }
    }
}

impl Foot {
    /// A program without motion has its origin only.
    fn nowhere(point_mm: [f64; 3]) -> Self {
        let tangent = [1.0, 0.0, 0.0];
        let signed_mm = signed_distance_mm(tangent, point_mm);
        Self {
            s_mm: 0.0,
            position_mm: [0.0; 3],
            tangent,
            line: 0,
            distance_mm: signed_mm.abs(),
            signed_mm,
            cutting: false,
            programmed_mm_s: 0.0,
        }
    }
}
