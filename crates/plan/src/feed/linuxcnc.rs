//! What LinuxCNC 2.9 makes of a program: its own trajectory planner, servo period by servo period.
//!
//! A model of a target control: what it will do with a program, not what would be best. In each
//! servo period of 1 ms at most one block comes into the queue, is joined to the one before, and
//! the look-ahead goes back over the last 50; then the segment under way moves on (`period.rs` has
//! the equations). Speeds change in steps of `a T`; jerk has no bound.
//!
//! Written from the behaviour of `tp.c`, `tc.c`, `blendmath.c` and `emccanon.cc` of LinuxCNC
//! 2.9.0~pre1 (GPL; facts and formulas, no code) and from its commands at 1 kHz, which it
//! reproduces to the 1e-6 mm that were recorded (`oracle_linuxcnc_planner`).
//!
//! What its modes mean, and how that differs from [`time_optimal`](super::time_optimal):
//!
//! | Mode | LinuxCNC |
//! |---|---|
//! | `G61.1` | rest at the end of each block |
//! | `G61` | rest at corners; a tenth of the acceleration is kept for corners all the same, so it takes longer than `G61.1` |
//! | `G64 Pp` | arcs within p of corners between lines and circles in one plane; elsewhere a parabola, or slowly through the corner |
//! | `G64` | no tolerance at all: blends take up to half of each block, here too |
//! | Q | lines that keep within Q (P without Q, none with Q0) are one line, up to 100 of them; arcs flatter than Q are two lines |
//! | rapids | are blended with rapids, stop before feeds |
//! | last block | in `G64` half the acceleration before every rest, since the block might still be blended with a next one |
//!
//! The tolerance P bounds blends alone: Q comes on top. A block takes at least 1.02 servo periods.
//! Corners are laid out for an override of 200 %.
//!
//! LinuxCNC repeats the beginning of a line that has begun and is then taken into the blend behind
//! it, which happens to lines of a few um at the beginning of a motion, and so ends up to 1 um
//! beside the path, measured on the real one. The model does the same, and comes to the end of the
//! path in the last servo period.
//!
//! Not modelled: overrides and holds while it moves, spindle synchronisation, probing, UVW as a
//! path of their own; a computer that is late with a block (the queue is then shorter, and the
//! motion slower, for some periods); `G5` as LinuxCNC cuts it into arcs: here a spline is lines
//! within 1 um of it, which came out 7.5 um off.
//!
//! | File | What |
//! |---|---|
//! | `limits.rs` | settings of the INI file, limits along directions |
//! | `shape.rs` | curves of segments |
//! | `blocks.rs` | pieces of the path to blocks: short lines joined |
//! | `segment.rs` | a segment of the queue |
//! | `arc_blend.rs` | the arc that blends a corner |
//! | `joint_choice.rs` | how two segments are joined |
//! | `queue.rs` | the queue and its look-ahead |
//! | `period.rs` | one servo period |
//! | `joint_spline.rs` | from servo periods to motion |

mod limits;
mod shape;
mod blocks;
mod segment;
mod arc_blend;
mod joint_choice;
mod queue;
mod period;
mod joint_spline;

use super::{FeedPlanner, Span, feed_mm_s};
use crate::constraints::Constraints;
use crate::path::Piece;
use crate::vector::{Vector, add_scaled, distance};
use blocks::{BlockMaker, BlockMode, PlannerBlock};
use joint_spline::{JointSpline, PeriodMotion, PeriodPoint};
use limits::{DirectionLimits, PERIOD_S};
use queue::SegmentQueue;
use std::collections::VecDeque;

/// The queue takes no block while it holds this many segments. LinuxCNC's queue holds 2000
/// segments; its look-ahead goes back over 50.
const MOST_SEGMENTS: usize = 200;

/// Rounding of sums over many periods.
const BESIDE_MM: f64 = 1e-8;

/// Servo periods in which a segment may stand still.
const MOST_STILL: u32 = 1000;

/// Input of the queue.
#[derive(Debug)]
enum QueueInput {
    /// The tool starts from rest, at a point.
    Start(Vector),
    /// A block.
    Block(Box<PlannerBlock>),
    /// The tool comes to rest, at this end of the path.
    Rest(PeriodPoint),
}

/// A piece that has been pushed.
#[derive(Debug, Clone, Copy)]
struct PushedPiece {
    number: u64,
    /// Number of rests before it.
    rests: u64,
    /// Arc length since the rest before it.
    s_mm: f64,
    length_mm: f64,
}

/// See the module's page.
#[derive(Debug)]
pub(crate) struct Linuxcnc {
    constraints: Constraints,
    blocks: BlockMaker,
    inputs: VecDeque<QueueInput>,
    /// Pieces that are not over.
    pieces: VecDeque<PushedPiece>,
    pushed: u64,
    /// Rests so far, of what was pushed.
    rests: u64,
    /// Arc length behind the last rest, and where the path ends, of what was pushed.
    s_mm: f64,
    end_mm: Vector,
    queue: SegmentQueue,
    spline: JointSpline,
    at: PeriodPoint,
    still: u32,
    ready: VecDeque<Span>,
}

impl Linuxcnc {
    /// Creates the planner at rest before the first piece.
    pub(crate) fn new(constraints: &Constraints) -> Self {
        let limits = DirectionLimits::new(constraints);
        let at = PeriodPoint {
            position_mm: [0.0; 3],
            station_mm: 0.0,
        };
        Self {
            constraints: constraints.clone(),
            blocks: BlockMaker::new(limits.clone()),
            inputs: VecDeque::new(),
            pieces: VecDeque::new(),
            pushed: 0,
            rests: 0,
            s_mm: 0.0,
            end_mm: [0.0; 3],
            queue: SegmentQueue::new(limits),
            spline: JointSpline::at_rest(at),
            at,
            still: 0,
            ready: VecDeque::new(),
        }
    }

    /// Hands blocks on to the queue.
    fn take_blocks(&mut self) {
        self.inputs.extend(
            self.blocks
                .ready
                .drain(..)
                .map(|block| QueueInput::Block(Box::new(block))),
        );
    }

    /// The tool comes to rest behind what was pushed.
    fn rest(&mut self) {
        self.blocks.flush();
        self.take_blocks();
        if self.s_mm > 0.0 {
            let end = PeriodPoint {
                position_mm: self.end_mm,
                station_mm: self.s_mm,
            };
            self.inputs.push_back(QueueInput::Rest(end));
            self.rests += 1;
        }
        self.s_mm = 0.0;
    }

    /// Does the next thing that is certain: a servo period, or a rest. Whether there was one.
    fn advance(&mut self) -> bool {
        match self.inputs.front() {
            None => return false,
            Some(QueueInput::Start(at_mm)) => {
                self.at = PeriodPoint {
                    position_mm: *at_mm,
                    station_mm: 0.0,
                };
                self.spline = JointSpline::at_rest(self.at);
                self.inputs.pop_front();
            }
            Some(QueueInput::Block(_)) => {
                if self.queue.segments.len() < MOST_SEGMENTS
                    && let Some(QueueInput::Block(block)) = self.inputs.pop_front()
                {
                    self.queue.append(*block);
                }
                self.run_period();
            }
            Some(QueueInput::Rest(end)) if self.queue.segments.is_empty() => {
                // The spline rests two periods after its points; one more where LinuxCNC's motion
                // ends beside the path.
                let beside = distance(self.at.position_mm, end.position_mm) > BESIDE_MM;
                self.at = *end;
                self.inputs.pop_front();
                for _ in 0..if beside { 3 } else { 2 } {
                    let motion = self.spline.next(self.at);
                    self.hand_out(&motion);
                }
                let rests = self.pieces.front().map_or(0, |piece| piece.rests);
                while self
                    .pieces
                    .front()
                    .is_some_and(|piece| piece.rests == rests)
                {
                    self.pieces.pop_front();
                }
            }
            Some(QueueInput::Rest(_)) => self.run_period(),
        }
        true
    }

    /// One servo period.
    fn run_period(&mut self) {
        let before_mm = self
            .queue
            .segments
            .front()
            .map(|segment| segment.progress_mm);
        let step = self.queue.run_period();
        self.at.position_mm = add_scaled(self.at.position_mm, 1.0, step.way_mm);
        self.at.station_mm += step.station_mm.max(0.0);
        let motion = self.spline.next(self.at);
        self.hand_out(&motion);
        let after_mm = self
            .queue
            .segments
            .front()
            .map(|segment| segment.progress_mm);
        self.still = if before_mm == after_mm {
            self.still + 1
        } else {
            0
        };
        if self.still > MOST_STILL {
            // Rounding left a way that no period goes.
            self.queue.segments.pop_front();
            self.still = 0;
        }
    }

    /// A servo period as spans: one for each piece that it passes.
    fn hand_out(&mut self, motion: &PeriodMotion) {
        let [s_mm, speed_mm_s, accel_mm_s2, jerk_mm_s3] = motion.station;
        let place =
            |t: f64| s_mm + t * (speed_mm_s + t * (0.5 * accel_mm_s2 + t * jerk_mm_s3 / 6.0));
        let mut from_s = 0.0;
        while from_s < PERIOD_S {
            let Some(piece) = self.pieces.front().copied() else {
                return;
            };
            let end_mm = piece.s_mm + piece.length_mm;
            let is_last = self
                .pieces
                .get(1)
                .is_none_or(|next| next.rests != piece.rests);
            let until_s = if is_last || place(PERIOD_S) <= end_mm {
                PERIOD_S
            } else {
                time_of(place, end_mm, from_s)
            };
            if until_s > from_s {
                self.ready.push_back(Span {
                    piece: piece.number,
                    from_mm: (place(from_s) - piece.s_mm).clamp(0.0, piece.length_mm),
                    duration_s: until_s - from_s,
                    speed_mm_s: (speed_mm_s + from_s * (accel_mm_s2 + 0.5 * from_s * jerk_mm_s3))
                        .max(0.0),
                    accel_mm_s2: accel_mm_s2 + from_s * jerk_mm_s3,
                    jerk_mm_s3,
                    motion: Some(motion.axes.after(from_s)),
                });
                from_s = until_s;
            }
            if from_s < PERIOD_S {
                self.pieces.pop_front();
            }
        }
    }
}

/// Returns the time within this period at which a place that does not go back reaches a bound, s.
fn time_of(place: impl Fn(f64) -> f64, bound_mm: f64, from_s: f64) -> f64 {
    let (mut lo_s, mut hi_s) = (from_s, PERIOD_S);
    for _ in 0..60 {
        let middle_s = 0.5 * (lo_s + hi_s);
        if place(middle_s) < bound_mm {
            lo_s = middle_s;
        } else {
            hi_s = middle_s;
        }
    }
    lo_s
}

impl FeedPlanner for Linuxcnc {
    fn push(&mut self, piece: &Piece, from_rest: bool) {
        if from_rest {
            self.rest();
        }
        if self.s_mm == 0.0 {
            self.blocks.begin(piece.start_mm);
            self.inputs.push_back(QueueInput::Start(piece.start_mm));
        }
        let along_mm_s = self
            .constraints
            .along_mm_s(piece.turn_deg_mm, piece.further_mm_mm);
        let mode = BlockMode {
            is_rapid: !piece.cutting,
            is_rotary: piece.turn_deg_mm > 0.0 || piece.further_mm_mm > 0.0,
            feed_mm_s: feed_mm_s(piece, &self.constraints),
            along_mm_s,
            corner: piece.corner,
        };
        self.blocks.push(piece, mode, self.s_mm);
        let (number, rests, s_mm) = (self.pushed, self.rests, self.s_mm);
        self.pieces.push_back(PushedPiece {
            number,
            rests,
            s_mm,
            length_mm: piece.length_mm,
        });
        self.pushed += 1;
        self.s_mm += piece.length_mm;
        self.end_mm = piece.curve.at(piece.length_mm).position_mm;
        self.take_blocks();
    }

    fn finish(&mut self) {
        self.rest();
    }

    fn pop(&mut self) -> Option<Span> {
        while self.ready.is_empty() {
            if !self.advance() {
                return None;
            }
        }
        self.ready.pop_front()
    }
}
