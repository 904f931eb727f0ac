//! Seams: places in the middle of a stretch where the commands of two pieces meet.
//!
//! Both pieces correct the path around the seam, and each has a lead on its other side. The seam is
//! the plane through a programmed point, normal to the direction of travel there. Each command is
//! cut where it crosses that plane. Then the second begins where the first ends. If one of the two
//! stays as programmed, the other meets it in the programmed point.

use feedwright_gcode::canon::{Motion, Shape};
use feedwright_plan::vector::{Vector, add_scaled, distance, dot, sub};

use super::stretches::{ProgramPart, SmoothStretch, StretchCommand, directions, pieces, stretches};

/// A command crosses the seam no further than this from the programmed point, mm.
const NEAR_MM: f64 = 1.0;
/// A block that is cut to less than this is left out, mm.
const SLIVER_MM: f64 = 0.02;
/// Halvings of a block to find the crossing: to 1e-9 of its length.
const HALVINGS: u32 = 30;

/// A plane across a path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seam {
    at_mm: Vector,
    direction: Vector,
}

/// Ends of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum MotionEnd {
    Start,
    End,
}

impl Seam {
    /// Returns the seam at the start of a programmed motion; none if the motion has no length.
    pub(super) fn before(motion: &Motion) -> Option<Self> {
        let [direction, _] = directions(motion)?;
        Some(Self {
            at_mm: motion.start_mm,
            direction,
        })
    }

    /// Returns the distance of a point behind the plane, mm.
    fn behind_mm(&self, at_mm: Vector) -> f64 {
        dot(sub(at_mm, self.at_mm), self.direction)
    }

    /// Returns the point at which a motion crosses the plane forwards.
    fn crossing_mm(&self, motion: &Motion) -> Option<Vector> {
        if matches!(motion.shape, Shape::Spline(_))
            || self.behind_mm(motion.start_mm) > 0.0
            || self.behind_mm(motion.end_mm) <= 0.0
        {
            return None;
        }
        let pieces = pieces(motion);
        let piece = pieces
            .iter()
            .find(|piece| self.behind_mm(piece.curve.at(piece.length_mm).position_mm) > 0.0)?;
        let (mut low, mut high) = (0.0, piece.length_mm);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.behind_mm(piece.curve.at(middle).position_mm) > 0.0 {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some(piece.curve.at(high).position_mm)
    }

    /// Returns the motion that crosses the plane nearest to the programmed point, and the point of
    /// crossing.
    fn crossing(&self, motions: &[Motion]) -> Option<(usize, Vector)> {
        let crossings = motions
            .iter()
            .enumerate()
            .filter_map(|(k, motion)| Some((k, self.crossing_mm(motion)?)));
        let off_mm = |at_mm: Vector| distance(at_mm, self.at_mm);
        crossings
            .filter(|&(_, at_mm)| off_mm(at_mm) < NEAR_MM)
            .min_by(|&(_, a), &(_, b)| off_mm(a).total_cmp(&off_mm(b)))
    }

    /// Returns the motions before the plane; none if they do not cross it.
    pub(super) fn before_it(&self, motions: &[Motion]) -> Option<Vec<Motion>> {
        let (last, at_mm) = self.crossing(motions)?;
        let mut kept = motions[..=last].to_vec();
        if last > 0 && distance(motions[last].start_mm, at_mm) < SLIVER_MM {
            kept.pop();
        } else {
            end_at(kept.last_mut()?, MotionEnd::End, at_mm);
        }
        Some(kept)
    }

    /// Returns the motions behind the plane; none if they do not cross it.
    pub(super) fn behind_it(&self, motions: &[Motion]) -> Option<Vec<Motion>> {
        let (mut first, at_mm) = self.crossing(motions)?;
        let is_sliver = distance(at_mm, motions[first].end_mm) < SLIVER_MM;
        first += usize::from(is_sliver && first + 1 < motions.len());
        let mut kept = motions[first..].to_vec();
        end_at(kept.first_mut()?, MotionEnd::Start, at_mm);
        Some(kept)
    }
}

/// Moves an end of a motion. The center of an arc moves by the smallest distance that keeps it
/// equally far from both ends.
fn end_at(motion: &mut Motion, end: MotionEnd, at_mm: Vector) {
    match end {
        MotionEnd::Start => motion.start_mm = at_mm,
        MotionEnd::End => motion.end_mm = at_mm,
    }
    if let Shape::Arc {
        plane, center_mm, ..
    } = &mut motion.shape
    {
        let [.., normal] = plane.axes();
        let mut chord = sub(motion.end_mm, motion.start_mm);
        chord[normal] = 0.0;
        let square_mm2 = dot(chord, chord);
        if square_mm2 > 0.0 {
            let middle_mm = add_scaled(motion.start_mm, 0.5, chord);
            let off = dot(sub(middle_mm, *center_mm), chord) / square_mm2;
            *center_mm = add_scaled(*center_mm, off, chord);
        }
        center_mm[normal] = motion.start_mm[normal];
    }
}

/// Returns true if a stretch and the one before it are one stretch that was split at `splits`. At a
/// corner the tool rests.
pub(super) fn is_parted(stretch: &SmoothStretch, splits: &[usize]) -> bool {
    stretch.follows && !stretch.rests[0] && splits.binary_search(&stretch.steps[0]).is_ok()
}

/// Lets commands meet where stretches of a program were split at `splits`.
pub(super) fn meet(commands: &mut [StretchCommand], parts: &[ProgramPart], splits: &[usize]) {
    for (number, stretch) in stretches(parts).enumerate().skip(1) {
        if !is_parted(stretch, splits) {
            continue;
        }
        let (before, behind) = commands.split_at_mut(number);
        let last = before[number - 1]
            .as_mut()
            .and_then(|command| command.motions.last_mut());
        let first = behind[0]
            .as_mut()
            .and_then(|command| command.motions.first_mut());
        match (last, first) {
            (Some(last), Some(first)) => end_at(first, MotionEnd::Start, last.end_mm),
            (Some(last), None) => end_at(last, MotionEnd::End, stretch.start_mm()),
            (None, Some(first)) => end_at(first, MotionEnd::Start, stretch.start_mm()),
            (None, None) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use feedwright_gcode::canon::{AuxiliaryAxes, Corner, MotionKind, Plane};

    fn motion(start_mm: Vector, end_mm: Vector, shape: Shape) -> Motion {
        let corner = Corner::Continuous {
            tolerance_mm: None,
            merge_mm: None,
        };
        let (kind, others) = (MotionKind::Feed, AuxiliaryAxes::default());
        Motion {
            line: 1,
            kind,
            start_mm,
            end_mm,
            shape,
            feed_mm_s: 10.0,
            corner,
            others,
        }
    }

    /// A quarter turn around the origin from X10, and a line from its end.
    fn quarter_and_line() -> Vec<Motion> {
        let arc = Shape::Arc {
            plane: Plane::Xy,
            center_mm: [0.0; 3],
            turns: 1,
        };
        vec![
            motion([10.0, 0.0, 0.0], [0.0, 10.0, 0.0], arc),
            motion([0.0, 10.0, 0.0], [-10.0, 10.0, 0.0], Shape::Line),
        ]
    }

    #[test]
    fn a_command_is_cut_where_it_crosses_the_seam() {
        let motions = quarter_and_line();
        let root = 50_f64.sqrt();
        let seam = Seam {
            at_mm: [root + 0.03, root + 0.03, 0.0],
            direction: [-1.0, 1.0, 0.0],
        };
        let (before, behind) = (
            seam.before_it(&motions).unwrap(),
            seam.behind_it(&motions).unwrap(),
        );
        assert_eq!((before.len(), behind.len()), (1, 2));
        assert!(
            distance(before[0].end_mm, [root, root, 0.0]) < 1e-6,
            "{:?}",
            before[0]
        );
        assert!(
            distance(behind[0].start_mm, [root, root, 0.0]) < 1e-6,
            "{:?}",
            behind[0]
        );
        // The seam is next to the end of the arc: nothing of the arc is left behind it.
        let seam = Seam {
            at_mm: [0.01, 10.0, 0.0],
            direction: [-1.0, 0.0, 0.0],
        };
        assert_eq!(seam.behind_it(&motions).unwrap().len(), 1);
        let far = Seam {
            at_mm: [-5.0, 12.0, 0.0],
            ..seam
        };
        assert!(far.before_it(&motions).is_none());
    }

    #[test]
    fn an_arc_that_begins_elsewhere_has_both_ends_as_far_from_its_center() {
        let mut arc = quarter_and_line().remove(0);
        end_at(&mut arc, MotionEnd::Start, [10.001, -0.002, 0.5]);
        let Shape::Arc { center_mm, .. } = arc.shape else {
            panic!("{arc:?}")
        };
        let radius_mm =
            |at_mm: Vector| libm::hypot(at_mm[0] - center_mm[0], at_mm[1] - center_mm[1]);
        assert!(
            (radius_mm(arc.start_mm) - radius_mm(arc.end_mm)).abs() < 1e-12,
            "{center_mm:?}"
        );
        assert!(
            radius_mm([0.0; 3]) < 0.002 && center_mm[2] == 0.5,
            "{center_mm:?}"
        );
    }
}
