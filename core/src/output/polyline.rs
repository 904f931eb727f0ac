//! A stream of points as a polyline of few vertices within a tolerance.
//!
//! From the last vertex on, each segment covers as many points as any segment from there can (`stab`, verified by `passes`),
//! and ends where it suits the next one. Guarantee: Fréchet distance between the points' own polyline and the result at most
//! the tolerance, with the vertices as they are printed. The number of vertices is not the proven minimum, which would need
//! the whole path at once; tests compare it with the optimum over vertices on the points themselves.

use super::stab::{passes, stab};
use crate::vector::{Vector, dot, norm, sub};

/// Points that a segment covers at most: bounds the memory, and costs one block in 16 s of straight motion at 1 ms.
const MAX_POINTS: usize = 1 << 14;

/// Above this turn of the path at a point (cosine of 0.1 rad) the point is a corner: a vertex stands on it exactly.
const CORNER_COS: f64 = 0.995;

/// Makes vertices from points; vertices are whole multiples of the printed step.
pub(super) struct Simplifier {
    tolerance_mm: f64,
    /// Points per mm of the printed grid.
    steps_per_mm: f64,
    anchor: Option<Vector>,
    /// Points after the last vertex that no segment covers yet.
    pending: Vec<Vector>,
    /// The longest prefix of `pending` known to fit one segment, and an end for it.
    fits: Option<(usize, Vector)>,
}

/// A segment to `end_mm` that covers `points` points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Segment {
    pub(super) end_mm: Vector,
    pub(super) points: usize,
}

impl Simplifier {
    pub(super) fn new(tolerance_mm: f64, steps_per_mm: f64) -> Self {
        Self { tolerance_mm, steps_per_mm, anchor: None, pending: Vec::new(), fits: None }
    }

    /// Takes the next point; hands segments that are finished to `emit`.
    pub(super) fn push(&mut self, point: Vector, emit: &mut impl FnMut(Segment)) {
        if self.anchor.is_none() {
            self.anchor = Some(self.printed(point));
            return;
        }
        self.pending.push(point);
        // A prefix is tried once the point behind it is known, at lengths that double: the last try costs as much as all before.
        while self.pending.len() > self.next_try() {
            self.advance(self.next_try(), emit);
        }
    }

    /// A new polyline from `point` on, which has no points that wait; gives its vertex.
    pub(super) fn restart(&mut self, point: Vector) -> Vector {
        let vertex = self.printed(point);
        self.anchor = Some(vertex);
        vertex
    }

    /// No more points: covers those that wait.
    pub(super) fn finish(&mut self, emit: &mut impl FnMut(Segment)) {
        while !self.pending.is_empty() {
            self.advance(self.pending.len(), emit);
            if self.fits.is_some_and(|(covered, _)| covered == self.pending.len()) {
                self.close(emit);
            }
        }
    }

    fn next_try(&self) -> usize {
        self.fits.map_or(1, |(covered, _)| 2 * covered).min(MAX_POINTS)
    }

    /// Tries a prefix of `length`; where it does not fit, or is the longest allowed, finishes the longest that does.
    fn advance(&mut self, length: usize, emit: &mut impl FnMut(Segment)) {
        if let Some(end) = self.end_of(length) {
            self.fits = Some((length, end));
            if length == MAX_POINTS {
                self.close(emit);
            }
            return;
        }
        // What fits a point less fits with a truncated segment, so the longest prefix is found by bisection.
        let (mut good, mut bad) = (self.fits.map_or(0, |(covered, _)| covered), length);
        while bad - good > 1 {
            let middle = good + (bad - good) / 2;
            match self.end_of(middle) {
                Some(end) => {
                    good = middle;
                    self.fits = Some((middle, end));
                }
                None => bad = middle,
            }
        }
        self.close(emit);
    }

    /// Emits the longest fitting prefix; a single point always fits, by a vertex upon it.
    fn close(&mut self, emit: &mut impl FnMut(Segment)) {
        let (points, end_mm) = self.fits.take().unwrap_or_else(|| (1, self.printed(self.pending[0])));
        self.pending.drain(..points);
        // A prefix that stays within the tolerance of the last vertex needs no motion.
        emit(Segment { end_mm, points });
        self.anchor = Some(end_mm);
    }

    /// A printed end for a segment past the first `length` points.
    fn end_of(&self, length: usize) -> Option<Vector> {
        let anchor = self.anchor?;
        let points = &self.pending[..length];
        let next = self.pending.get(length).copied();
        let last = points[length - 1];
        let on_point = || Some(self.printed(last)).filter(|end| passes(anchor, *end, points, self.tolerance_mm));
        if next.is_none_or(|next| self.is_corner(length, next))
            && let Some(end) = on_point()
        {
            return Some(end);
        }
        // Half a printed step on each axis may be lost to rounding.
        let room = self.tolerance_mm - 0.5 * 3.0_f64.sqrt() / self.steps_per_mm;
        stab(anchor, points, next, room)
            .map(|end| self.printed(end))
            .filter(|end| passes(anchor, *end, points, self.tolerance_mm))
            .or_else(on_point)
    }

    fn is_corner(&self, length: usize, next: Vector) -> bool {
        let last = self.pending[length - 1];
        let before = if length > 1 { self.pending[length - 2] } else { self.anchor.unwrap_or(last) };
        let (arriving, leaving) = (sub(last, before), sub(next, last));
        dot(arriving, leaving) < CORNER_COS * norm(arriving) * norm(leaving)
    }

    /// A point as it is printed.
    pub(super) fn printed(&self, point: Vector) -> Vector {
        point.map(|c| (c * self.steps_per_mm).round() / self.steps_per_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const TOLERANCE: f64 = 1e-3;
    const STEPS: f64 = 1e5;

    fn simplified(points: &[Vector]) -> Vec<Segment> {
        let mut simplifier = Simplifier::new(TOLERANCE, STEPS);
        let mut segments = Vec::new();
        for point in points {
            simplifier.push(*point, &mut |segment| segments.push(segment));
        }
        simplifier.finish(&mut |segment| segments.push(segment));
        segments
    }

    /// Every segment passes its points in order within the tolerance, and together they cover all points.
    fn assert_guarantee(points: &[Vector], segments: &[Segment]) {
        let printed = points[0].map(|c| (c * STEPS).round() / STEPS);
        let (mut at, mut covered) = (printed, 1);
        for segment in segments {
            assert!(passes(at, segment.end_mm, &points[covered..covered + segment.points], TOLERANCE));
            at = segment.end_mm;
            covered += segment.points;
        }
        assert_eq!(covered, points.len());
    }

    /// Fewest segments of any polyline whose vertices are printed points of the path, by dynamic programming.
    fn optimum_on_points(points: &[Vector]) -> usize {
        let printed: Vec<Vector> = points.iter().map(|p| p.map(|c| (c * STEPS).round() / STEPS)).collect();
        let mut fewest = vec![0; points.len()];
        for j in 1..points.len() {
            fewest[j] = (0..j)
                .filter(|&i| passes(printed[i], printed[j], &points[i + 1..=j], TOLERANCE))
                .map(|i| fewest[i] + 1)
                .min()
                .unwrap();
        }
        fewest[points.len() - 1]
    }

    fn circle(count: usize, radius: f64, step: f64) -> Vec<Vector> {
        (0..count).map(|k| (k as f64 * step / radius).sin_cos()).map(|(s, c)| [radius * c, radius * s, 0.0]).collect()
    }

    #[test]
    fn a_straight_line_is_one_block_and_a_corner_is_exact() {
        let line: Vec<Vector> = (0..=5000).map(|k| [f64::from(k) * 0.05, f64::from(k) * 0.01, 0.0]).collect();
        assert_eq!(simplified(&line), [Segment { end_mm: [250.0, 50.0, 0.0], points: 5000 }]);
        let corner: Vec<Vector> = (0..=100).map(|k| [f64::from(k.min(50)), f64::from((k - 50).max(0)), 0.0]).collect();
        let ends: Vec<Vector> = simplified(&corner).iter().map(|segment| segment.end_mm).collect();
        assert_eq!(ends, [[50.0, 0.0, 0.0], [50.0, 50.0, 0.0]]);
    }

    #[test]
    fn on_a_circle_segments_are_as_long_as_two_sided_tolerance_allows() {
        // A chord with its ends on the outer circle R + r that touches the inner one R - r is 2 sqrt(4 R r) long.
        let (radius, step) = (10.0_f64, 0.002);
        let points = circle(20_000, radius, step);
        let segments = simplified(&points);
        assert_guarantee(&points, &segments);
        let longest = 2.0 * (4.0 * radius * TOLERANCE).sqrt();
        let fewest = (step * 20_000.0 / longest).ceil() as usize;
        // Whole points and the printed step cost up to one point in 200 at either end.
        assert!(segments.len() <= fewest + fewest / 50 + 1, "{} blocks, at best {fewest}", segments.len());
    }

    #[test]
    fn standing_still_needs_no_motion() {
        let still = vec![[1.0, 2.0, 3.0]; 300];
        let segments = simplified(&still);
        assert!(segments.iter().all(|segment| segment.end_mm == [1.0, 2.0, 3.0]));
    }

    #[test]
    fn a_long_line_is_split_to_bound_the_memory() {
        let line: Vec<Vector> = (0..=40_000).map(|k| [f64::from(k) * 0.05, 0.0, 0.0]).collect();
        let segments = simplified(&line);
        assert_guarantee(&line, &segments);
        assert_eq!(segments.len(), 3);
    }

    #[test]
    fn over_many_paths_there_are_no_more_blocks_than_the_optimum_on_points() {
        let (mut ours, mut optimum) = (0, 0);
        for case in 0..60 {
            let (radius, step) = (2.0 + f64::from(case), 0.01 + 0.002 * f64::from(case % 13));
            let mut points = circle(60, radius, step);
            for (k, point) in points.iter_mut().enumerate() {
                point[2] = 0.002 * f64::from(case % 5) * (0.3 * k as f64).sin();
            }
            let segments = simplified(&points);
            assert_guarantee(&points, &segments);
            let best = optimum_on_points(&points);
            assert!(segments.len() <= best + 1, "case {case}: {} against {best}", segments.len());
            ours += segments.len();
            optimum += best;
        }
        assert!(ours <= optimum, "{ours} against {optimum}");
    }

    proptest! {
        #[test]
        fn the_tolerance_holds_for_any_path(
            steps in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, -1.0..1.0_f64), 1..200),
            size in prop::sample::select(vec![1e-5, 1e-4, 1e-3, 1e-2, 1.0]),
            drift in 0.0..0.05_f64,
        ) {
            let mut at = [0.0; 3];
            let mut points = vec![at];
            for step in steps {
                at = [at[0] + size * step.0 + drift, at[1] + size * step.1, at[2] + size * step.2];
                points.push(at);
            }
            let segments = simplified(&points);
            assert_guarantee(&points, &segments);
        }
    }
}
