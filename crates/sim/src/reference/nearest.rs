//! Nearest point over several pieces.
//!
//! From a joint at distance `d` of the point, no point of the path nearer than `best` can come
//! before an arc length of `d - best` has passed. So the search starts at a piece near the foot,
//! and from there goes both ways, skipping all pieces out of reach: near a smooth path the skips
//! double, and hundreds of tiny pieces cost a few evaluations. The answer is exact: nothing is
//! skipped that could be nearer.

use feedwright_plan::Piece;
use feedwright_plan::vector::{distance, dot, sub};

use super::{Foot, foot};
use std::collections::VecDeque;

/// Joints meet only to rounding; a reach is shortened by this, far more than that and far less than
/// any piece.
const SLACK_MM: f64 = 1e-6;

/// Steps from a piece near the middle towards the foot; each halves the distance at worst on a
/// gentle path.
const WALK_STEPS: usize = 3;

/// Part of the path: pieces from `first` to `last`, from `lo_mm` in the first to `hi_mm` in the
/// last.
#[derive(Debug, Clone, Copy)]
pub(super) struct Range {
    pub(super) first: usize,
    pub(super) last: usize,
    pub(super) lo_mm: f64,
    pub(super) hi_mm: f64,
}

/// Nearest point within the range; of two equally near, the one found first.
pub(super) fn nearest(pieces: &VecDeque<Piece>, range: Range, point_mm: [f64; 3]) -> Foot {
    let Range { first, last, .. } = range;
    let middle = if last - first < 4 {
        (first + last) / 2
    } else {
        walk(pieces, range, point_mm)
    };
    let mut best = offer(pieces, range, middle, point_mm);
    let mut index = middle;
    while index < last {
        let joint = &pieces[index + 1];
        let reach_mm =
            joint.s_mm + distance(joint.start_mm, point_mm) - best.distance_mm - SLACK_MM;
        index = skip(pieces, index + 1, last, |piece| {
            piece.s_mm + piece.length_mm < reach_mm
        });
        if pieces[index].s_mm + pieces[index].length_mm >= reach_mm {
            take(&mut best, offer(pieces, range, index, point_mm));
        }
    }
    let mut index = middle;
    while index > first {
        let joint = &pieces[index];
        let reach_mm =
            joint.s_mm - distance(joint.start_mm, point_mm) + best.distance_mm + SLACK_MM;
        index -= 1;
        while index > first && pieces[index].s_mm > reach_mm {
            index = back(pieces, index, first, reach_mm);
        }
        if pieces[index].s_mm <= reach_mm || index == first {
            take(&mut best, offer(pieces, range, index, point_mm));
        }
    }
    best
}

fn take(best: &mut Foot, other: Foot) {
    if other.distance_mm < best.distance_mm {
        *best = other;
    }
}

fn offer(pieces: &VecDeque<Piece>, range: Range, index: usize, point_mm: [f64; 3]) -> Foot {
    let piece = &pieces[index];
    let lo_mm = if index == range.first {
        range.lo_mm
    } else {
        0.0
    };
    let hi_mm = if index == range.last {
        range.hi_mm
    } else {
        piece.length_mm
    };
    foot(piece, piece.curve.nearest(point_mm, lo_mm, hi_mm), point_mm)
}

/// First piece from `index` on for which `out` does not hold, at most `last`; `out` holds up to
/// some piece and not beyond.
fn skip(
    pieces: &VecDeque<Piece>,
    index: usize,
    last: usize,
    out: impl Fn(&Piece) -> bool,
) -> usize {
    let mut step = 1;
    let mut lo = index;
    // Gallop, then halve.
    while lo < last && out(&pieces[lo]) {
        let next = (lo + step).min(last);
        if next == last || !out(&pieces[next]) {
            let mut hi = next;
            while hi - lo > 1 {
                let middle = lo + (hi - lo) / 2;
                if out(&pieces[middle]) {
                    lo = middle;
                } else {
                    hi = middle;
                }
            }
            return hi;
        }
        lo = next;
        step *= 2;
    }
    lo
}

/// The last piece before `index` that starts at `reach_mm` or before, or `first`.
fn back(pieces: &VecDeque<Piece>, index: usize, first: usize, reach_mm: f64) -> usize {
    let mut step = 1;
    let mut hi = index;
    loop {
        let lo = hi.saturating_sub(step).max(first);
        if lo == first || pieces[lo].s_mm <= reach_mm {
            let mut lo = lo;
            while hi - lo > 1 {
                let middle = lo + (hi - lo) / 2;
                if pieces[middle].s_mm <= reach_mm {
                    lo = middle;
                } else {
                    hi = middle;
                }
            }
            return lo;
        }
        hi = lo;
        step *= 2;
    }
}

/// A piece near the foot: from the middle of the range, along the tangent as far as the point lies
/// ahead, a few times.
fn walk(pieces: &VecDeque<Piece>, range: Range, point_mm: [f64; 3]) -> usize {
    let Range { first, last, .. } = range;
    let mut index = (first + last) / 2;
    for _ in 0..WALK_STEPS {
        let piece = &pieces[index];
        let at = piece.curve.at(0.5 * piece.length_mm);
        let s_mm =
            piece.s_mm + 0.5 * piece.length_mm + dot(sub(point_mm, at.position_mm), at.tangent);
        let next = if s_mm < piece.s_mm {
            if index == first {
                first
            } else {
                back(pieces, index, first, s_mm)
            }
        } else {
            skip(pieces, index, last, |piece| {
                piece.s_mm + piece.length_mm < s_mm
            })
        };
        if next == index {
            break;
        }
        index = next;
    }
    index
}
