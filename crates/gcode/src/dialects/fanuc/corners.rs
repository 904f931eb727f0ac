//! `,R` and `,C`: the corner at the end of a block is rounded by a radius, or cut off that far from
//! it on both sides.
//!
//! Where a motion with such a word ends is known only when the next one is read: it waits until
//! then. The next block starts where the corner ends, and its distances count from the corner as it
//! is programmed.

use std::ops::Range;

use crate::geometry::plane::{PlaneArc, PlaneCurve, SLACK_MM, add, length, minus, scaled, unit};
use crate::state::Interpreter;
use crate::state::fanuc::{Goal, Pending};
use crate::state::frame::Position;
use crate::state::lathe::CornerCut;
use crate::text::block::Block;
use crate::text::block::corner::CornerWord;
use crate::text::codes::{Group, bit, letter, slot, spelled};
use crate::text::diagnostic::{LineFault, Read};

impl Interpreter {
    /// G1 to G3 with a corner at their end, or behind one.
    pub(crate) fn own_corner(&mut self, block: &Block, code: u16) -> Read<()> {
        let goal = match self.fanuc.resolved.take() {
            Some(goal) => goal,
            None => self.goal(block, code)?,
        };
        let Some(corner) = block.corner.clone() else {
            return self.go_to_goal(block, goal, code != 0);
        };
        if code == 0 {
            let message = format!(
                "`,{}` stands on a rapid; corners are cut between G1, G2 and G3",
                shown(&corner)
            );
            return Err(
                LineFault::new("gcode::corner", corner.at, message).hint("write G1 on this line")
            );
        }
        let feed = (self.modal.feed, self.modal.feed_unit_mm);
        self.fanuc.pending = Some(Box::new(Pending {
            block: block.clone(),
            goal,
            corner,
            line: self.line,
            feed,
        }));
        Ok(())
    }

    /// Returns true if the motion of a line begins or ends at a corner.
    pub(crate) fn has_own_corner(&self, block: &Block) -> bool {
        block.corner.is_some() || self.fanuc.resolved.is_some()
    }

    fn goal(&self, block: &Block, code: u16) -> Read<Goal> {
        let target = self.target(block)?;
        let round = matches!(code, 20 | 30)
            .then(|| self.round(block, &target, code == 30))
            .transpose()?;
        Ok(Goal { target, round })
    }

    fn go_to_goal(&mut self, block: &Block, goal: Goal, is_feed: bool) -> Read<()> {
        match goal.round {
            Some(round) => self.arc_as(block, &goal.target, round, 0.0),
            None => self.straight_as(block, &goal.target, is_feed, 0.0),
        }
    }

    /// A motion that waits must not be forgotten at the end of a program or profile.
    pub(crate) fn check_pending(&mut self, at: Range<usize>) -> Read<()> {
        match self.fanuc.pending.take() {
            Some(pending) => Err(no_second_side(&pending, at)),
            None => Ok(()),
        }
    }

    /// The block behind a corner has been read: moves up to it and around it.
    pub(super) fn finish_corner(&mut self, block: &Block) -> Read<()> {
        if block.set == 0 && block.g.is_empty() && block.m.is_empty() {
            return Ok(()); // A comment.
        }
        let Some(pending) = self.fanuc.pending.take() else {
            return Ok(());
        };
        let code = block
            .code(Group::Motion)
            .map_or(self.modal.motion, |word| word.number);
        let is_plain = block
            .g
            .iter()
            .all(|word| matches!(word.number, 10 | 20 | 30 | 900 | 910));
        if !matches!(code, 10 | 20 | 30) || !is_plain || !block.has_axes() {
            return Err(no_second_side(&pending, block.whole()));
        }
        let start = std::mem::replace(&mut self.at, pending.goal.target);
        // G90 and G91 of the block already count for it.
        let was_incremental = self.modal.incremental;
        self.modal.incremental = block
            .code(Group::Distance)
            .map_or(was_incremental, |word| word.number == 910);
        let next = self.goal(block, code);
        self.modal.incremental = was_incremental;
        self.at = start;
        let next = next?;
        let [before, piece] = self.pieces(block, &pending, &start, &next)?;
        self.fanuc.resolved = Some(next);
        // Up to the corner and around it with the feed and from the line of the first block.
        let line = std::mem::replace(&mut self.line, pending.line);
        let feed = (self.modal.feed, self.modal.feed_unit_mm);
        (self.modal.feed, self.modal.feed_unit_mm) = pending.feed;
        let moved = [before, piece]
            .into_iter()
            .flatten()
            .try_for_each(|goal| self.go_to_goal(&pending.block, goal, true));
        self.line = line;
        (self.modal.feed, self.modal.feed_unit_mm) = feed;
        moved
    }

    /// The motion up to the corner and the corner itself, where they have a length.
    fn pieces(
        &self,
        block: &Block,
        pending: &Pending,
        start: &Position,
        next: &Goal,
    ) -> Read<[Option<Goal>; 2]> {
        let corner = pending.goal.target;
        let [first, second, normal] = self.modal.plane.axes();
        if corner[normal] != start[normal] || next.target[normal] != corner[normal] {
            let message = format!(
                "`,{}` lies between motions that leave the plane",
                shown(&pending.corner)
            );
            return Err(LineFault::new("gcode::corner", block.whole(), message)
                .hint("corners are cut in the plane of G17, G18 or G19"));
        }
        let in_plane = |position: &Position| [position[first], position[second]];
        let curve = |from: &Position, goal: &Goal| {
            let (start, end) = (in_plane(from), in_plane(&goal.target));
            match goal.round {
                Some(PlaneArc { center, turns }) => PlaneCurve::Arc {
                    start,
                    end,
                    center,
                    turn: f64::from(turns.signum()),
                },
                None => PlaneCurve::Line { start, end },
            }
        };
        let (mut before, mut behind) = (curve(start, &pending.goal), curve(&corner, next));
        let size_mm = pending.corner.value * self.modal.unit_mm;
        let cut = if pending.corner.is_round {
            CornerCut {
                radius_mm: size_mm.abs(),
                is_round: true,
            }
            .cut(&mut before, &mut behind)
        } else {
            chamfer(&mut before, &mut behind, size_mm)
        };
        let Some(piece) = cut.filter(|_| size_mm > 0.0) else {
            let (word, value) = (shown(&pending.corner), pending.corner.value);
            let message = format!(
                "`,{word}{value}` does not fit between this motion and the one on line {}",
                pending.line
            );
            return Err(LineFault::new("gcode::corner", block.whole(), message)
                .hint("it must be above 0 and shorter than both; a chamfer is cut between straight lines"));
        };
        let place = |point: [f64; 2]| {
            let mut position = corner;
            (position[first], position[second]) = (point[0], point[1]);
            position
        };
        let has_length = length(minus(before.end(), before.start())) > SLACK_MM;
        let up_to = has_length.then(|| Goal {
            target: place(before.end()),
            ..pending.goal
        });
        let around = piece.map(|piece| {
            let round = match piece {
                PlaneCurve::Arc { center, turn, .. } => Some(PlaneArc {
                    center,
                    turns: if turn > 0.0 { 1 } else { -1 },
                }),
                PlaneCurve::Line { .. } => None,
            };
            Goal {
                target: place(piece.end()),
                round,
            }
        });
        Ok([up_to, around])
    }

    /// C on a straight motion of a lathe is a chamfer on some controls and an axis on others.
    pub(super) fn check_lathe_chamfer(&self, block: &Block) -> Read<()> {
        let plain = block
            .code(Group::Motion)
            .map_or(self.modal.motion, |word| word.number)
            == 10;
        let moves = block.set & (bit(b'x') | bit(b'z') | bit(b'u') | bit(b'w')) != 0;
        if plain && moves && block.has(b'c') && block.code(Group::NonModal).is_none() {
            let message = "C on a straight motion is a chamfer on some lathes and an axis on others: it is not read";
            return Err(
                LineFault::new("gcode::unsupported", block.at(b'c'), message)
                    .hint("write the chamfer as ,C"),
            );
        }
        if plain
            && moves
            && let Some(word) = [b'r', b'i', b'k'].into_iter().find(|&word| block.has(word))
        {
            let name = letter(slot(word));
            let message =
                format!("{name} on a straight motion, a corner on some lathes, is not read");
            return Err(
                LineFault::new("gcode::unsupported", block.at(word), message)
                    .hint("write a rounded corner as ,R and a chamfer as ,C"),
            );
        }
        Ok(())
    }
}

/// Cuts two straight lines off at the same distance from where they meet.
fn chamfer(
    before: &mut PlaneCurve,
    behind: &mut PlaneCurve,
    size_mm: f64,
) -> Option<Option<PlaneCurve>> {
    let (&mut PlaneCurve::Line { start, end: corner }, &mut PlaneCurve::Line { end, .. }) =
        (&mut *before, &mut *behind)
    else {
        return None;
    };
    let (to, from) = (minus(corner, start), minus(end, corner));
    if length(to) < size_mm - SLACK_MM || length(from) < size_mm - SLACK_MM {
        return None;
    }
    let [first, second] = [
        add(corner, scaled(unit(to), -size_mm)),
        add(corner, scaled(unit(from), size_mm)),
    ];
    before.set_end(first);
    behind.set_start(second);
    Some(Some(PlaneCurve::Line {
        start: first,
        end: second,
    }))
}

fn shown(corner: &CornerWord) -> char {
    if corner.is_round { 'R' } else { 'C' }
}

fn no_second_side(pending: &Pending, at: Range<usize>) -> Box<LineFault> {
    let code = spelled(10);
    let message = format!(
        "the corner `,{}` of line {} has no second side: no G1, G2 or G3 follows",
        shown(&pending.corner),
        pending.line
    );
    LineFault::new("gcode::corner", at, message).hint(format!(
        "the next block is {code}, G2 or G3 in the same plane, with no other G-code than G90 or G91"
    ))
}
