//! Another program in place of the programmed one: the command runs along the other, errors are
//! those to the programmed path.
//!
//! Along the other path a foot runs on the programmed one, which never goes back: from where it was
//! it reaches all places up to the first whose distance is more than `HILL` times the least on the
//! way, and a little more; the nearest of them is the next foot, but for a little that it may be
//! further away where it is nearer to an even pace (`LEAN`). What the other program leaves out at
//! its end has no foot: its distance from the other path is [`AlignedPaths::left_out_mm`].

use super::{PairedStep, PairedSteps, PlannedPiece, ProgrammedPart};
use crate::path::{Piece, Step};
use crate::vector::{Vector, distance};

/// Distance of places on the other path at which a foot is looked for, mm.
const STEP_MM: f64 = 0.25;
/// Largest ratio of the distance on the way to a nearer place to the smallest distance so far. At a
/// right angle the ratio is sqrt(2).
const HILL: f64 = 1.5;
/// Search range ahead of the last foot, in steps and in distances of the last foot.
const AHEAD_STEPS: f64 = 8.0;
const AHEAD_DISTANCES: f64 = 4.0;
/// Least part of a step in which places are looked at, mm.
const LEAST_MM: f64 = 1e-3;
/// Cost of a deviation from an even pace, mm of distance per mm. It selects the pass that is due on
/// a line there and back, or on two laps over each other.
const LEAN: f64 = 0.05;
/// Distances that differ by less are equal, mm.
const TIE_MM: f64 = 1e-9;
/// A cutting path that is left out by less has been cut, mm: a usual in-position width.
const CUT_MM: f64 = 0.01;
/// Places at which what is left out is measured.
const LEFT_OUT_PLACES: u32 = 200;

/// Two programs, one beside the other.
#[derive(Debug, Clone)]
pub struct AlignedPaths {
    steps: Vec<PairedStep>,
    /// Largest distance from the other path of the programmed cutting path that the other program
    /// leaves out at its end, mm; 0 if it leaves out nothing.
    pub left_out_mm: f64,
}

impl AlignedPaths {
    /// The steps of `other`, beside those of the program that errors are measured to.
    pub fn new(programmed: &[Step], other: &[Step]) -> Self {
        let (programmed, planned) = (ProgrammedPath(pieces(programmed)), pieces(other));
        let mut steps: Vec<PairedStep> = programmed
            .0
            .iter()
            .cloned()
            .map(PairedStep::Programmed)
            .collect();
        let mut foot_mm = 0.0;
        for step in other {
            steps.push(match step {
                Step::Piece(piece) => {
                    let from_mm = foot_mm;
                    foot_mm = programmed.along(piece, from_mm);
                    let origin = ProgrammedPart::Part {
                        from_mm,
                        to_mm: foot_mm,
                    };
                    PairedStep::Planned(PlannedPiece {
                        piece: piece.clone(),
                        origin,
                    })
                }
                Step::Event(event) => PairedStep::Event(event.clone()),
                Step::Rest(rest) => PairedStep::Rest(*rest),
            });
        }
        Self {
            left_out_mm: programmed.left_out_mm(foot_mm, &planned),
            steps,
        }
    }

    /// The steps of both paths.
    pub fn steps(&self) -> PairedSteps<'_> {
        Box::new(self.steps.iter().cloned().map(Ok))
    }
}

fn pieces(steps: &[Step]) -> Vec<Piece> {
    let piece = |step: &Step| {
        if let Step::Piece(piece) = step {
            Some(piece.clone())
        } else {
            None
        }
    };
    steps.iter().filter_map(piece).collect()
}

/// The path that feet run on.
struct ProgrammedPath(Vec<Piece>);

impl ProgrammedPath {
    fn end_mm(&self) -> f64 {
        self.0
            .last()
            .map_or(0.0, |piece| piece.s_mm + piece.length_mm)
    }

    /// The piece at an arc length.
    fn piece(&self, s_mm: f64) -> Option<&Piece> {
        self.0.get(
            self.0
                .partition_point(|piece| piece.s_mm <= s_mm)
                .saturating_sub(1),
        )
    }

    fn distance_mm(&self, point_mm: Vector, s_mm: f64) -> f64 {
        self.piece(s_mm).map_or(f64::INFINITY, |piece| {
            let local_mm = (s_mm - piece.s_mm).clamp(0.0, piece.length_mm);
            distance(piece.curve.at(local_mm).position_mm, point_mm)
        })
    }

    /// The foot at the end of a piece of the other path, from that at its start.
    fn along(&self, piece: &Piece, mut foot_mm: f64) -> f64 {
        let count = (piece.length_mm / STEP_MM).ceil().max(1.0);
        let way_mm = piece.length_mm / count;
        for k in 1..=count as u64 {
            let point_mm = piece.curve.at(way_mm * k as f64).position_mm;
            foot_mm = self.next(point_mm, foot_mm, way_mm);
        }
        foot_mm
    }

    /// The foot of a point that is `way_mm` on from the one whose foot was at `foot_mm`.
    fn next(&self, point_mm: Vector, foot_mm: f64, way_mm: f64) -> f64 {
        let expected_mm = (foot_mm + way_mm).min(self.end_mm());
        let cost_mm = |s_mm: f64, away_mm: f64| away_mm + LEAN * (s_mm - expected_mm).abs();
        let first_mm = self.distance_mm(point_mm, foot_mm);
        let (mut nearest_mm, mut best) = (first_mm, (foot_mm, cost_mm(foot_mm, first_mm)));
        let step_mm = (0.25 * way_mm).max(LEAST_MM);
        let end_mm = (foot_mm + AHEAD_STEPS * way_mm.max(LEAST_MM) + AHEAD_DISTANCES * nearest_mm)
            .min(self.end_mm());
        let mut at_mm = foot_mm;
        while at_mm < end_mm {
            at_mm = (at_mm + step_mm).min(end_mm);
            let away_mm = self.distance_mm(point_mm, at_mm);
            if away_mm > HILL * nearest_mm + way_mm {
                break;
            }
            nearest_mm = nearest_mm.min(away_mm);
            if cost_mm(at_mm, away_mm) < best.1 - TIE_MM {
                best = (at_mm, cost_mm(at_mm, away_mm));
            }
        }
        let around = [
            (best.0 - step_mm).max(foot_mm),
            (best.0 + step_mm).min(end_mm),
        ];
        self.refined(point_mm, around, best, cost_mm)
    }

    /// The best of the nearest places on pieces between two places, or a place that is known where
    /// that is better.
    fn refined(
        &self,
        point_mm: Vector,
        [from_mm, to_mm]: [f64; 2],
        mut best: (f64, f64),
        cost_mm: impl Fn(f64, f64) -> f64,
    ) -> f64 {
        let first = self
            .0
            .partition_point(|piece| piece.s_mm <= from_mm)
            .saturating_sub(1);
        for piece in self.0[first..]
            .iter()
            .take_while(|piece| piece.s_mm <= to_mm)
        {
            let within = |s_mm: f64| (s_mm - piece.s_mm).clamp(0.0, piece.length_mm);
            let local_mm = piece
                .curve
                .nearest(point_mm, within(from_mm), within(to_mm));
            let away_mm = distance(piece.curve.at(local_mm).position_mm, point_mm);
            let s_mm = piece.s_mm + local_mm;
            if cost_mm(s_mm, away_mm) < best.1 - TIE_MM {
                best = (s_mm, cost_mm(s_mm, away_mm));
            }
        }
        best.0
    }

    /// Returns the largest distance of the cutting path behind a place from another path, mm.
    fn left_out_mm(&self, foot_mm: f64, other: &[Piece]) -> f64 {
        let end_mm = self.end_mm();
        if end_mm - foot_mm < CUT_MM {
            return 0.0;
        }
        let places = (1..=LEFT_OUT_PLACES)
            .map(|k| foot_mm + (end_mm - foot_mm) * f64::from(k) / f64::from(LEFT_OUT_PLACES));
        let away_mm = |s_mm: f64| {
            let Some(piece) = self.piece(s_mm).filter(|piece| piece.cutting) else {
                return 0.0;
            };
            let point_mm = piece
                .curve
                .at((s_mm - piece.s_mm).min(piece.length_mm))
                .position_mm;
            let nearest_mm = |other: &Piece| {
                distance(
                    other
                        .curve
                        .at(other.curve.nearest(point_mm, 0.0, other.length_mm))
                        .position_mm,
                    point_mm,
                )
            };
            other.iter().map(nearest_mm).fold(f64::INFINITY, f64::min)
        };
        let largest_mm = places.map(away_mm).fold(0.0, f64::max);
        if largest_mm < CUT_MM { 0.0 } else { largest_mm }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path::pieces::Pieces;
    use feedwright_gcode::{Reader, Settings};

    fn steps(text: &str) -> Vec<Step> {
        let program = Reader::from_text("part.ngc", text, Settings::default())
            .unwrap()
            .map(Result::unwrap);
        Pieces::new(program).map(Result::unwrap).collect()
    }

    /// Ends of the parts of the programmed path that the pieces of the other stand for.
    fn ends(aligned: &AlignedPaths) -> Vec<f64> {
        let end = |step: &PairedStep| match step {
            PairedStep::Planned(PlannedPiece {
                origin: ProgrammedPart::Part { to_mm, .. },
                ..
            }) => Some(*to_mm),
            _ => None,
        };
        aligned.steps.iter().filter_map(end).collect()
    }

    #[test]
    fn a_program_stands_for_itself() {
        let text = "G21 F600\nG1 X10\nY10\nX0\nY0\nG2 X0 Y0 I5\nX0 Y0 I5\nG1 X10\nX0\nM2\n";
        let program = steps(text);
        let aligned = AlignedPaths::new(&program, &program);
        let wanted: Vec<f64> = pieces(&program)
            .iter()
            .map(|piece| piece.s_mm + piece.length_mm)
            .collect();
        for (found, wanted) in ends(&aligned).iter().zip(&wanted) {
            assert!((found - wanted).abs() < 2e-3, "{found} {wanted}");
        }
        assert_eq!(aligned.left_out_mm, 0.0);
    }

    #[test]
    fn a_rounded_corner_is_passed_and_a_cut_off_spike_too() {
        let square = steps("G21 F600\nG1 X10\nY10\nM2\n");
        let rounded = steps("G21 F600\nG1 X9\nG3 X10 Y1 J1\nG1 Y10\nM2\n");
        let found = ends(&AlignedPaths::new(&square, &rounded));
        assert!(
            (found[0] - 9.0).abs() < 1e-6
                && (found[1] - 11.0).abs() < 0.02
                && (found[2] - 20.0).abs() < 1e-6,
            "{found:?}"
        );
        let spike = steps("G21 F600\nG1 X10\nX0\nM2\n");
        let short = steps("G21 F600\nG1 X9.99\nX0\nM2\n");
        let found = ends(&AlignedPaths::new(&spike, &short));
        assert!((found[1] - 20.0).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn half_a_program_leaves_the_other_half_out() {
        let whole = steps("G21 F600\nG1 X10\nY10\nX0\nY0\nM2\n");
        let half = steps("G21 F600\nG1 X10\nY10\nM2\n");
        let aligned = AlignedPaths::new(&whole, &half);
        assert!(
            (aligned.left_out_mm - 10.0 * 0.5).abs() < 5.1,
            "{}",
            aligned.left_out_mm
        );
        assert!(aligned.left_out_mm > 4.0, "{}", aligned.left_out_mm);
    }
}
