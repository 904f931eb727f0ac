//! The path as sections with a bound on the speed, for planners that need no more of it.
//!
//! Within a section the square of the speed stays below a straight line over arc length (constant
//! on lines and arcs, following `a_n / curvature` on other curves); at the joint before it, below a
//! cap of its own.
//!
//! On a line or an arc the bound `f = min(feed^2, a_n / curvature)` on the square of the speed is
//! constant: one section. On other curves the piece is halved until the straight line between the
//! bounds at both ends of a section lies no more than `OVER` above `f`, so that v^2 times curvature
//! keeps a_n to 0.1 %, and no more than `UNDER` below it, so that no time is given away.
//! Neighbouring sections that are both bounded by the same feedrate alone are joined.

use feedwright_gcode::canon::Corner;

use super::corner_speed::{JointSide, joint_cap};
use super::{FeedPlanner, Span, feed_mm_s};
use crate::constraints::Constraints;
use crate::path::smooth::{MAX_CURVATURE_1_MM, Smooth};
use crate::path::{Curve, Piece};

/// The bound may be exceeded by this at the points where it is compared; between them it then stays
/// below 0.1 %.
const OVER: f64 = 2.5e-4;

/// The bound may be missed by this.
const UNDER: f64 = 5e-3;

/// Sections of less than this are not halved any more: the speed cannot change noticeably over a
/// nanometre.
const MIN_SECTION_MM: f64 = 1e-6;

/// Nor are sections of less than this part of a cell of the curve's table, over which the tangent
/// turns by 0.3 rad at most: five or six halvings do for curves, twelve for their inflections, and
/// no more where curvature is mere rounding.
const MIN_PART: f64 = 1.0 / 4096.0;

/// Part of a piece with a bound on the speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Number of the piece, from 0.
    pub piece: u64,
    /// Start in the piece, mm.
    pub from_mm: f64,
    /// Length, mm, more than 0.
    pub length_mm: f64,
    /// Bound on the square of the speed at the joint before it, mm2/s2.
    pub joint_cap: f64,
    /// Bound on the square of the speed just after its start, mm2/s2, more than 0; straight over
    /// arc length to
    pub start_cap: f64,
    /// the bound just before its end.
    pub end_cap: f64,
}

/// Plans speeds over sections, as a [`FeedPlanner`] does over pieces.
pub trait SectionPlanner: Send {
    /// Adds a section behind those before.
    fn push(&mut self, section: Section);

    /// Ends the path: no more sections follow, and the motion ends at rest.
    fn finish(&mut self);

    /// Takes the next span that is final.
    fn pop(&mut self) -> Option<Span>;
}

/// A planner of sections as one of pieces.
#[derive(Debug)]
pub(crate) struct Capped<P> {
    constraints: Constraints,
    planner: P,
    /// End of the last piece, and its corner mode.
    last: Option<(JointSide, Corner)>,
    /// Pieces so far.
    pieces: u64,
}

impl<P> Capped<P> {
    /// Creates the planner at rest before the first piece.
    pub(crate) fn new(constraints: &Constraints, planner: P) -> Self {
        Self {
            constraints: constraints.clone(),
            planner,
            last: None,
            pieces: 0,
        }
    }
}

impl<P: SectionPlanner> FeedPlanner for Capped<P> {
    fn push(&mut self, piece: &Piece, from_rest: bool) {
        let end = piece.curve.at(piece.length_mm);
        let side = |tangent, s_mm| JointSide {
            tangent,
            curvature_1_mm: piece.curve.curvature(s_mm),
            length_mm: piece.length_mm,
        };
        let cap = match &self.last {
            Some((before, corner)) if !from_rest => joint_cap(
                before,
                &side(piece.curve.at(0.0).tangent, 0.0),
                *corner,
                &self.constraints.path,
            ),
            _ => 0.0,
        };
        sections(piece, self.pieces, cap, &self.constraints, |section| {
            self.planner.push(section);
        });
        self.last = Some((side(end.tangent, piece.length_mm), piece.corner));
        self.pieces += 1;
    }

    fn finish(&mut self) {
        self.planner.finish();
    }

    fn pop(&mut self) -> Option<Span> {
        self.planner.pop()
    }
}

/// Hands the sections of a piece to `push`, in order; `joint_cap` belongs to the first.
pub(crate) fn sections(
    piece: &Piece,
    number: u64,
    joint_cap: f64,
    constraints: &Constraints,
    mut push: impl FnMut(Section),
) {
    let feed = feed_mm_s(piece, constraints).powi(2);
    let normal_accel_mm_s2 = constraints.path.normal_accel_mm_s2;
    let bound =
        |curvature: f64| feed.min(normal_accel_mm_s2 / curvature.clamp(0.0, MAX_CURVATURE_1_MM));
    match &piece.curve {
        Curve::Line(_) | Curve::Arc(_) => {
            let cap = bound(piece.curve.curvature(0.0));
            push(Section {
                piece: number,
                from_mm: 0.0,
                length_mm: piece.length_mm,
                joint_cap,
                start_cap: cap,
                end_cap: cap,
            });
        }
        Curve::Smooth(smooth) => {
            let mut joined: Option<Section> = None;
            divide(smooth, bound, |from_mm, to_mm, start_cap, end_cap| {
                let flat = start_cap == feed && end_cap == feed;
                if let Some(open) = &mut joined {
                    if flat && open.start_cap == feed && open.end_cap == feed {
                        open.length_mm = to_mm - open.from_mm;
                        return;
                    }
                    push(*open);
                }
                let joint_cap = if joined.is_none() {
                    joint_cap
                } else {
                    f64::INFINITY
                };
                let length_mm = to_mm - from_mm;
                joined = Some(Section {
                    piece: number,
                    from_mm,
                    length_mm,
                    joint_cap,
                    start_cap,
                    end_cap,
                });
            });
            if let Some(open) = joined {
                push(open);
            }
        }
    }
}

/// Calls `take(from, to, bound at from, bound at to)` for each section of a curve, in order.
fn divide(smooth: &Smooth, bound: impl Fn(f64) -> f64, mut take: impl FnMut(f64, f64, f64, f64)) {
    let mut todo = Vec::new();
    for cell in 0..smooth.cells() {
        // Each cell with its own bounds at its ends: between two spans of a spline the curvature
        // may jump.
        let bound = |s_mm: f64| bound(smooth.curvature_in(cell, s_mm));
        let (from_mm, to_mm) = smooth.cell_mm(cell);
        let shortest_mm = MIN_SECTION_MM.max((to_mm - from_mm) * MIN_PART);
        let mut from = (from_mm, bound(from_mm));
        todo.push((to_mm, bound(to_mm)));
        while let Some(&to) = todo.last() {
            let length_mm = to.0 - from.0;
            let good = [0.25, 0.5, 0.75].iter().all(|&part: &f64| {
                let ratio = (from.1 + part * (to.1 - from.1)) / bound(from.0 + part * length_mm);
                (1.0 - UNDER..=1.0 + OVER).contains(&ratio)
            });
            if good || length_mm <= shortest_mm {
                if length_mm > 0.0 {
                    take(from.0, to.0, from.1, to.1);
                    from = to;
                }
                todo.pop();
            } else {
                let middle_mm = 0.5 * (from.0 + to.0);
                todo.push((middle_mm, bound(middle_mm)));
            }
        }
    }
}
