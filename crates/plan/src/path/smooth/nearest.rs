//! The point of a smooth curve nearest to a given point.
//!
//! With `f(s)` half the squared distance from the point `p` to `C(s)`, and `n` the curve's normal,
//!
//! `f' = (C - p) . t`, `f'' = 1 + k (C - p) . n`
//!
//! Newton from the middle of the range finds a foot `s0`, at distance `b`. Along a curve whose
//! curvature stays below `k`, for `k d < pi / 2`, the tangent turns by at most `k d` within the
//! length `d`, so `|(C(s0 + d) - C(s0)) . n|` is at most `(1 - cos(k d)) / k`, and `f'' >= cos(k
//! d) - k b`. Where that is positive over the whole range, f is convex and the foot is the nearest
//! point. Otherwise all cells are searched, skipping those that the point's distance from their
//! ends puts out of reach.

use super::{Cell, MIN_SPEED_MM, Smooth};
use crate::vector::{Vector, distance, dot, norm, sub};
use std::f64::consts::FRAC_PI_2;

/// Distances that differ by less are equal, and a foot wins over the end of a cell: rounding of a
/// distance must not move the foot.
const TIE_MM: f64 = 1e-12;

/// Steps for a foot within a cell: halvings alone would need about 40.
const MAX_NEWTON_STEPS: usize = 100;

/// Steps for a foot without brackets; from a few mm on a gentle curve it takes four.
const FREE_NEWTON_STEPS: usize = 8;

/// A Newton step this small leaves an error of its square times the curvature, which is below 1e-12
/// mm on any real curve.
const LAST_STEP_MM: f64 = 1e-7;

/// Curvatures of cells are sampled at five points, over which the tangent turns by 0.3 rad at most:
/// what lies between may be a little larger.
const CURVATURE_MARGIN: f64 = 1.2;

/// Derivatives of half the squared distance by arc length, and the distance.
struct Slope {
    first: f64,
    second: f64,
    distance_mm: f64,
}

impl Smooth {
    /// Arc length of the nearest point between the bounds.
    pub(crate) fn nearest(&self, point_mm: [f64; 3], lo_mm: f64, hi_mm: f64) -> f64 {
        self.sole_foot(point_mm, lo_mm, hi_mm)
            .unwrap_or_else(|| self.search(point_mm, lo_mm, hi_mm))
    }

    /// The foot, where the distance is convex over the range.
    fn sole_foot(&self, point_mm: Vector, lo_mm: f64, hi_mm: f64) -> Option<f64> {
        let mut s_mm = 0.5 * (lo_mm + hi_mm);
        for _ in 0..FREE_NEWTON_STEPS {
            let slope = self.slope(&self.cells[self.cell_of(s_mm)], s_mm, point_mm);
            // Far from convex, Newton runs away; the tangent does not.
            let step = if slope.second > 0.25 {
                slope.first / slope.second
            } else {
                slope.first
            };
            let next = (s_mm - step).min(hi_mm).max(lo_mm);
            let moved_mm = (next - s_mm).abs();
            s_mm = next;
            if moved_mm < LAST_STEP_MM {
                let reach_mm = (hi_mm - s_mm).max(s_mm - lo_mm);
                return self
                    .is_convex(lo_mm, hi_mm, reach_mm, slope.distance_mm + LAST_STEP_MM)
                    .then_some(s_mm);
            }
        }
        None
    }

    fn is_convex(&self, lo_mm: f64, hi_mm: f64, reach_mm: f64, distance_mm: f64) -> bool {
        let cells = &self.cells[self.cell_of(lo_mm)..=self.cell_of(hi_mm)];
        let sharpest = cells
            .iter()
            .fold(0.0, |k: f64, cell| k.max(cell.curvature_1_mm));
        let curvature = CURVATURE_MARGIN * sharpest;
        curvature * reach_mm < FRAC_PI_2
            && libm::cos(curvature * reach_mm) > curvature * distance_mm
    }

    #[cold]
    fn search(&self, point_mm: Vector, lo_mm: f64, hi_mm: f64) -> f64 {
        let mut s_mm = 0.5 * (lo_mm + hi_mm);
        // Along the tangent as far as the point lies ahead, to begin near a foot.
        for _ in 0..3 {
            let here = self.at(s_mm);
            let step = dot(sub(point_mm, here.position_mm), here.tangent);
            s_mm = (s_mm + step).min(hi_mm).max(lo_mm);
        }
        let first = self.cell_of(lo_mm);
        let last = self.cell_of(hi_mm);
        let middle = self.cell_of(s_mm).clamp(first, last);
        let mut best = Best {
            s_mm,
            distance_mm: f64::INFINITY,
        };
        self.offer(middle, point_mm, lo_mm, hi_mm, &mut best);
        let mut cell = middle;
        while cell < last {
            let end_mm = self.cell_end_mm(cell);
            let reach_mm = end_mm + self.distance(point_mm, end_mm) - best.distance_mm;
            cell += 1;
            while cell < last && self.cell_end_mm(cell) < reach_mm {
                cell += 1;
            }
            if hi_mm >= reach_mm {
                self.offer(cell, point_mm, lo_mm, hi_mm, &mut best);
            }
        }
        let mut cell = middle;
        while cell > first {
            let start_mm = self.cells[cell].s_mm;
            let reach_mm = start_mm - (self.distance(point_mm, start_mm) - best.distance_mm);
            cell -= 1;
            while cell > first && self.cells[cell].s_mm > reach_mm {
                cell -= 1;
            }
            if lo_mm <= reach_mm {
                self.offer(cell, point_mm, lo_mm, hi_mm, &mut best);
            }
        }
        best.s_mm
    }

    fn slope(&self, cell: &Cell, s_mm: f64, point_mm: Vector) -> Slope {
        let jet = self.jet_in(cell, s_mm);
        let away = sub(jet.position_mm, point_mm);
        let speed = norm(jet.first).max(MIN_SPEED_MM);
        let first = dot(away, jet.first) / speed;
        let bend = dot(away, jet.second) - first * dot(jet.first, jet.second) / speed;
        Slope {
            first,
            second: 1.0 + bend / (speed * speed),
            distance_mm: norm(away),
        }
    }

    fn distance(&self, point_mm: Vector, s_mm: f64) -> f64 {
        distance(self.jet_at(s_mm).position_mm, point_mm)
    }

    /// Nearest point within one cell: where `(C - p).C'` changes from negative to positive, or an
    /// end.
    fn offer(&self, index: usize, point_mm: Vector, lo_mm: f64, hi_mm: f64, best: &mut Best) {
        let cell = &self.cells[index];
        let mut lo = cell.s_mm.max(lo_mm);
        let mut hi = self.cell_end_mm(index).min(hi_mm);
        if lo > hi {
            return;
        }
        let slope = |s_mm: f64| self.slope(cell, s_mm, point_mm);
        let at_lo = slope(lo);
        let at_hi = slope(hi);
        if at_lo.first >= 0.0 || at_hi.first <= 0.0 {
            for (s_mm, distance_mm) in [(lo, at_lo.distance_mm), (hi, at_hi.distance_mm)] {
                if distance_mm < best.distance_mm - TIE_MM {
                    *best = Best { s_mm, distance_mm };
                }
            }
            return;
        }
        let mut s_mm = lo + (hi - lo) * at_lo.first / (at_lo.first - at_hi.first);
        for _ in 0..MAX_NEWTON_STEPS {
            let Slope { first, second, .. } = slope(s_mm);
            if first < 0.0 {
                lo = s_mm;
            } else {
                hi = s_mm;
            }
            let newton = s_mm - first / second;
            let inside = newton > lo && newton < hi;
            let next = if inside { newton } else { 0.5 * (lo + hi) };
            let moved = (next - s_mm).abs();
            s_mm = next;
            if inside && moved < LAST_STEP_MM || moved < TIE_MM {
                break;
            }
        }
        let distance_mm = slope(s_mm).distance_mm;
        if distance_mm <= best.distance_mm + TIE_MM {
            *best = Best { s_mm, distance_mm };
        }
    }
}

/// Nearest point so far.
struct Best {
    s_mm: f64,
    distance_mm: f64,
}
