//! Motions of the program to pieces of the path.
//!
//! Each piece starts where the one before ended, to the last bit for lines and arcs: motions too
//! short to matter vanish without leaving a gap, however many there are. The first error ends the
//! path.

use feedwright_gcode::canon::{Canon, Event, EventKind, Motion, MotionKind, Shape};

use super::arcs::{Request, arcs};
use super::line::Line;
use super::spline::curves;
use super::{
    Curve, MAX_COORDINATE_MM, MAX_GAP_MM, MAX_REST_S, MIN_FEED_MM_S, MIN_LENGTH_MM, PathError,
    Piece, Rest, Step,
};
use crate::vector::{Vector, distance};
use std::collections::VecDeque;
use std::sync::Arc;

/// Steps of a path from what the program asks for.
pub struct Pieces<I> {
    source: I,
    /// End of the last piece.
    here_mm: Option<Vector>,
    length: ArcLength,
    ready: VecDeque<Step>,
    failed: bool,
}

impl<I: Iterator<Item = Canon>> Pieces<I> {
    /// The path of `source`.
    pub fn new(source: I) -> Self {
        Self {
            source,
            here_mm: None,
            length: ArcLength::default(),
            ready: VecDeque::new(),
            failed: false,
        }
    }

    fn motion(&mut self, motion: &Motion) -> Result<(), PathError> {
        let here_mm = self.check(motion)?;
        let ready = self.ready.len();
        match &motion.shape {
            Shape::Line => {
                if let Some(line) = Line::new(here_mm, motion.end_mm) {
                    self.keep(motion, here_mm, Curve::Line(line), motion.end_mm);
                }
            }
            Shape::Arc {
                plane,
                center_mm,
                turns,
            } => {
                let request = Request {
                    line: motion.line,
                    start_mm: here_mm,
                    end_mm: motion.end_mm,
                    plane: *plane,
                    center_mm: *center_mm,
                    turns: *turns,
                };
                for (start_mm, arc) in arcs(&request)? {
                    let end_mm = arc.at(arc.length_mm()).position_mm;
                    self.keep(motion, start_mm, Curve::Arc(arc), end_mm);
                }
                // The last arc ends there up to rounding: later pieces start at the programmed
                // point itself.
                if self
                    .here_mm
                    .is_some_and(|here| distance(here, motion.end_mm) < MIN_LENGTH_MM)
                {
                    self.here_mm = Some(motion.end_mm);
                }
            }
            Shape::Spline(spline) => {
                let mut at_mm = here_mm;
                for (start_mm, smooth) in curves(spline, motion.line)? {
                    Self::join(motion.line, at_mm, start_mm)?;
                    at_mm = smooth.at(smooth.length_mm()).position_mm;
                    self.keep(motion, start_mm, Curve::Smooth(Arc::new(smooth)), at_mm);
                }
                Self::join(motion.line, at_mm, motion.end_mm)?;
            }
        }
        if self.ready.len() == ready && !motion.others.is_none() {
            self.ready.push_back(rest(motion));
        } else if let Some(axes) = &motion.others.axes {
            self.take_along(ready, axes);
        }
        Ok(())
    }

    /// Distributes the motion of the other axes evenly over the length of the pieces from `first`
    /// on.
    fn take_along(&mut self, first: usize, axes: &[[f64; 6]; 2]) {
        let lengths = self.ready.range(first..).map(|step| {
            if let Step::Piece(piece) = step {
                piece.length_mm
            } else {
                0.0
            }
        });
        let length_mm: f64 = lengths.sum();
        for step in self.ready.range_mut(first..) {
            if let Step::Piece(piece) = step {
                piece.turn_deg_mm = turn_deg(axes) / length_mm;
                piece.further_mm_mm = further_mm(axes) / length_mm;
            }
        }
    }

    /// Checks a motion and returns where it really starts.
    fn check(&self, motion: &Motion) -> Result<Vector, PathError> {
        let line = motion.line;
        let center = match &motion.shape {
            Shape::Arc { center_mm, .. } => *center_mm,
            _ => motion.end_mm,
        };
        for value_mm in motion
            .start_mm
            .into_iter()
            .chain(motion.end_mm)
            .chain(center)
        {
            // NaN is in no range.
            if !(-MAX_COORDINATE_MM..=MAX_COORDINATE_MM).contains(&value_mm) {
                return Err(PathError::Coordinate { line, value_mm });
            }
        }
        if motion.kind == MotionKind::Feed
            && !(MIN_FEED_MM_S..=f64::MAX).contains(&motion.feed_mm_s)
        {
            return Err(PathError::Feed {
                line,
                feed_mm_s: motion.feed_mm_s,
            });
        }
        let here_mm = self.here_mm.unwrap_or(motion.start_mm);
        Self::join(line, here_mm, motion.start_mm)?;
        Ok(here_mm)
    }

    /// Two points that should be one.
    fn join(line: u32, a_mm: Vector, b_mm: Vector) -> Result<(), PathError> {
        let gap_mm = distance(a_mm, b_mm);
        if gap_mm > MAX_GAP_MM {
            return Err(PathError::Gap { line, gap_mm });
        }
        Ok(())
    }

    fn keep(&mut self, motion: &Motion, start_mm: Vector, curve: Curve, end_mm: Vector) {
        let length_mm = curve.length_mm();
        if length_mm < MIN_LENGTH_MM {
            self.here_mm.get_or_insert(start_mm);
            return;
        }
        self.here_mm = Some(end_mm);
        self.ready.push_back(Step::Piece(Piece {
            curve,
            start_mm,
            length_mm,
            s_mm: self.length.advance(length_mm),
            line: motion.line,
            cutting: motion.kind == MotionKind::Feed,
            feed_mm_s: motion.feed_mm_s,
            corner: motion.corner,
            turn_deg_mm: 0.0,
            further_mm_mm: 0.0,
        }));
    }
}

impl<I: Iterator<Item = Canon>> Iterator for Pieces<I> {
    type Item = Result<Step, PathError>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(step) = self.ready.pop_front() {
                return Some(Ok(step));
            }
            if self.failed {
                return None;
            }
            let outcome = match self.source.next()? {
                Canon::Motion(motion) => self.motion(&motion),
                Canon::Event(event) => {
                    check_event(&event).map(|()| self.ready.push_back(Step::Event(event)))
                }
            };
            if let Err(error) = outcome {
                self.failed = true;
                self.ready.clear();
                return Some(Err(error));
            }
        }
    }
}

/// Returns the rest of X, Y and Z during which only other axes move. The feedrate refers to U, V, W
/// in mm if they move, else to A, B, C in degrees, else to the extruder.
fn rest(motion: &Motion) -> Step {
    let still = [[0.0; 6]; 2];
    let axes = motion.others.axes.as_deref().unwrap_or(&still);
    let [start, end] = axes;
    let turned = distance([start[0], start[1], start[2]], [end[0], end[1], end[2]]);
    let ways = [further_mm(axes), turned, motion.others.extruder_mm.abs()];
    let way = ways.into_iter().find(|&way| way > 0.0).unwrap_or(0.0);
    let is_rapid = motion.kind == MotionKind::Rapid;
    Step::Rest(Rest {
        line: motion.line,
        seconds: if is_rapid {
            0.0
        } else {
            (way / motion.feed_mm_s).min(MAX_REST_S)
        },
        turn_deg: turn_deg(axes),
        further_mm: further_mm(axes),
    })
}

/// Largest angle that one of A, B and C turns, degrees.
fn turn_deg([start, end]: &[[f64; 6]; 2]) -> f64 {
    (0..3)
        .map(|axis| (end[axis] - start[axis]).abs())
        .fold(0.0, f64::max)
}

/// Way of U, V and W, mm.
fn further_mm([start, end]: &[[f64; 6]; 2]) -> f64 {
    distance([start[3], start[4], start[5]], [end[3], end[4], end[5]])
}

fn check_event(event: &Event) -> Result<(), PathError> {
    match event.kind {
        EventKind::Dwell { seconds } if !(0.0..=MAX_REST_S).contains(&seconds) => {
            Err(PathError::Dwell {
                line: event.line,
                seconds,
            })
        }
        _ => Ok(()),
    }
}

/// Running sum of lengths, with the rounding of each addition carried along (Kahan), so that
/// millions of pieces do not drift.
#[derive(Debug, Clone, Default)]
pub(crate) struct ArcLength {
    sum: f64,
    carry: f64,
}

impl ArcLength {
    /// Adds `length`; returns the sum before.
    pub(crate) fn advance(&mut self, length: f64) -> f64 {
        let before = self.sum;
        let term = length - self.carry;
        let sum = self.sum + term;
        self.carry = (sum - self.sum) - term;
        self.sum = sum;
        before
    }

    /// The sum so far.
    pub(crate) fn total(&self) -> f64 {
        self.sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use feedwright_gcode::canon::{Corner, Plane};

    fn motion(start_mm: Vector, end_mm: Vector, shape: Shape) -> Canon {
        let corner = Corner::Continuous {
            tolerance_mm: None,
            merge_mm: None,
        };
        Canon::Motion(Motion {
            line: 1,
            kind: MotionKind::Feed,
            start_mm,
            end_mm,
            shape,
            feed_mm_s: 10.0,
            corner,
            others: feedwright_gcode::canon::AuxiliaryAxes::default(),
        })
    }

    fn pieces(motions: Vec<Canon>) -> Result<Vec<Piece>, PathError> {
        Pieces::new(motions.into_iter())
            .map(|step| {
                step.map(|step| match step {
                    Step::Piece(piece) => piece,
                    other => panic!("{other:?}"),
                })
            })
            .collect()
    }

    #[test]
    fn a_million_vanishing_motions_lose_nothing() {
        let steps = (0..1_000_000).map(|i| {
            let x = |i: i32| 1e-12 * f64::from(i);
            motion([x(i), 0.0, 0.0], [x(i + 1), 0.0, 0.0], Shape::Line)
        });
        let mut last: Option<Piece> = None;
        let mut total = 0.0;
        for step in Pieces::new(steps) {
            let Ok(Step::Piece(piece)) = step else {
                panic!()
            };
            if let Some(before) = &last {
                let end = before.curve.at(before.length_mm).position_mm;
                assert!(distance(end, piece.start_mm) < 1e-15);
            }
            total += piece.length_mm;
            last = Some(piece);
        }
        // 1 um in steps of 1 pm: what is missing at the end is shorter than a motion that is kept.
        assert!((total - 1e-6).abs() <= MIN_LENGTH_MM, "{total}");
    }

    #[test]
    fn equal_points_make_no_piece() {
        assert!(
            pieces(vec![motion([1.0; 3], [1.0; 3], Shape::Line)])
                .unwrap()
                .is_empty()
        );
    }

    #[test]
    fn extreme_values_are_refused_by_name() {
        for value in [f64::NAN, f64::INFINITY, 1e300, -2e9] {
            let error = pieces(vec![motion([0.0; 3], [value, 0.0, 0.0], Shape::Line)]).unwrap_err();
            assert!(matches!(error, PathError::Coordinate { .. }), "{error}");
        }
        let gap = vec![
            motion([0.0; 3], [1.0, 0.0, 0.0], Shape::Line),
            motion([1.1, 0.0, 0.0], [2.0, 0.0, 0.0], Shape::Line),
        ];
        assert!(matches!(pieces(gap).unwrap_err(), PathError::Gap { .. }));
    }

    #[test]
    fn a_line_after_an_arc_starts_at_the_programmed_point() {
        let arc = Shape::Arc {
            plane: Plane::Xy,
            center_mm: [0.0; 3],
            turns: 1,
        };
        let end = [0.0, 10.0, 0.0];
        let pieces = pieces(vec![
            motion([10.0, 0.0, 0.0], end, arc),
            motion(end, [0.0; 3], Shape::Line),
        ])
        .unwrap();
        assert_eq!(pieces[1].start_mm, end);
        assert_eq!(pieces[1].curve.at(5.0).tangent, [0.0, -1.0, 0.0]);
    }
}
