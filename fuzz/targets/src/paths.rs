//! Programmed paths as chords, and distances from them.

use std::f64::consts::TAU;

use feedwright_gcode::canon::{Motion, Shape};

/// A point, mm.
pub(crate) type Point = [f64; 3];

/// Largest distance of chords from their arc, mm.
pub(crate) const CHORD_MM: f64 = 1e-3;
/// Largest number of chords of an arc.
const MOST_CHORDS: f64 = 5_000.0;
/// Angle below which an arc is a full turn, rad.
const FULL_TURN_RAD: f64 = 1e-9;

/// Points of a path.
#[derive(Debug, Default)]
pub(crate) struct Chords {
    pub(crate) points: Vec<Point>,
}

impl Chords {
    /// Appends a line or an arc; of a spline, appends only the end.
    pub(crate) fn add(&mut self, motion: &Motion) {
        if self.points.is_empty() {
            self.points.push(motion.start_mm);
        }
        if let Shape::Arc {
            plane,
            center_mm,
            turns,
        } = &motion.shape
        {
            let [a, b, n] = plane.axes();
            let polar = |point: Point| {
                let [x, y] = [point[a] - center_mm[a], point[b] - center_mm[b]];
                (x.hypot(y), y.atan2(x))
            };
            let ((r0, from), (r1, to)) = (polar(motion.start_mm), polar(motion.end_mm));
            let sense = f64::from(turns.signum());
            let part_rad = (sense * (to - from)).rem_euclid(TAU);
            let is_full = part_rad < FULL_TURN_RAD || TAU - part_rad < FULL_TURN_RAD;
            let rad = if is_full { TAU } else { part_rad } + TAU * f64::from(turns.abs() - 1);
            let count = (rad * (r0.max(r1) / (8.0 * CHORD_MM)).sqrt())
                .ceil()
                .clamp(1.0, MOST_CHORDS);
            for i in 1..count as u32 {
                let part = f64::from(i) / count;
                let (r, turned) = (r0 + part * (r1 - r0), from + sense * part * rad);
                let mut point = [0.0; 3];
                point[a] = center_mm[a] + r * turned.cos();
                point[b] = center_mm[b] + r * turned.sin();
                point[n] = motion.start_mm[n] + part * (motion.end_mm[n] - motion.start_mm[n]);
                self.points.push(point);
            }
        }
        self.points.push(motion.end_mm);
    }

    /// Returns the smallest distance of a point from the path, mm.
    pub(crate) fn distance(&self, point: Point) -> f64 {
        self.points
            .windows(2)
            .map(|pair| from_chord(point, pair[0], pair[1]))
            .fold(f64::INFINITY, f64::min)
    }
}

/// Returns the distance between two points, mm.
pub(crate) fn distance(a: Point, b: Point) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

fn from_chord(point: Point, a: Point, b: Point) -> f64 {
    let along: Point = std::array::from_fn(|k| b[k] - a[k]);
    let square: f64 = along.iter().map(|part| part * part).sum();
    let dot: f64 = (0..3).map(|k| along[k] * (point[k] - a[k])).sum();
    let part = if square > 0.0 {
        (dot / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    distance(point, std::array::from_fn(|k| a[k] + part * along[k]))
}
