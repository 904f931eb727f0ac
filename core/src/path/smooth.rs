//! A smooth parametric curve by arc length.
//!
//! The curve `C(u)` is exact; only the parameter `u(s)` at a given arc length is approximated. The domain is cut into cells;
//! within a cell `u(s)` is the quintic polynomial that matches `u`, `u' = 1/|C'|` and `u'' = -(C'.C'')/|C'|^4` at both
//! ends. Lengths of cells come from 5-point Gauss-Legendre quadrature of `|C'|`; a cell is halved until quadrature and
//! polynomial are right to `CELL_TOLERANCE_MM` and the tangent turns little enough for the nearest point to be unique.

use super::Point;
use super::vector::{Vector, angle, cross, distance, dot, norm, scale, sub};
use std::fmt::Debug;

/// Arc length within a cell is right to this: a tenth of what the path promises, and far above rounding.
const CELL_TOLERANCE_MM: f64 = 1e-10;

/// The tangent turns by no more than this in a cell, so that the curve is a gentle arc there.
const CELL_TURN_RAD: f64 = 0.3;

/// Halvings before a cell is taken as it is: at a cusp, where no cell is short enough, 2^-40 of a span is below 1 pm.
const MAX_HALVINGS: u32 = 40;

/// Distances that differ by less are equal, and a foot wins over the end of a cell: rounding of a distance must not move the
/// foot.
const TIE_MM: f64 = 1e-12;

/// Steps for a foot: halvings alone would need about 40.
const MAX_NEWTON_STEPS: usize = 100;

/// Curvature above this is a corner, not a curve: a radius of 1 nm.
pub const MAX_CURVATURE_1_MM: f64 = 1e6;

/// A speed |C'| below this fraction of a mm per unit of the parameter counts as this, so that a cusp divides by no zero.
const MIN_SPEED_MM: f64 = 1e-12;

/// Position and the first two derivatives at a parameter.
#[derive(Debug, Clone, Copy)]
pub struct Jet {
    /// C(u), mm.
    pub position_mm: Vector,
    /// C'(u).
    pub first: Vector,
    /// C''(u).
    pub second: Vector,
}

/// A curve over a parameter.
pub trait Parametric: Debug + Send + Sync {
    /// Parameters at which to cut, ascending: the domain's ends and all places where a derivative jumps.
    fn breaks(&self) -> Vec<f64>;

    /// Position and derivatives at `u`.
    fn jet(&self, u: f64) -> Jet;
}

#[derive(Debug, Clone, Copy)]
struct Cell {
    s_mm: f64,
    u: f64,
    /// Coefficients of `u(s) - u` in powers 1 to 5 of `s - s_mm`.
    powers: [f64; 5],
    /// Largest curvature seen in the cell.
    curvature_1_mm: f64,
}

/// Smooth curve over its arc length.
#[derive(Debug)]
pub struct Smooth {
    shape: Box<dyn Parametric>,
    cells: Vec<Cell>,
    /// Cell at the start of each of `bins.len()` equal parts of the length.
    bins: Vec<u32>,
    length_mm: f64,
}

impl Smooth {
    /// Tables the arc length of `shape`.
    pub fn new(shape: Box<dyn Parametric>) -> Self {
        let mut cells = Vec::new();
        let mut s_mm = 0.0;
        let breaks = shape.breaks();
        for pair in breaks.windows(2) {
            let mut todo = vec![(pair[0], pair[1], 0)];
            while let Some((lo, hi, halvings)) = todo.pop() {
                let (cell, length_mm, good) = make_cell(shape.as_ref(), s_mm, lo, hi);
                if good || halvings >= MAX_HALVINGS {
                    cells.push(cell);
                    s_mm += length_mm;
                } else {
                    let middle = 0.5 * (lo + hi);
                    todo.push((middle, hi, halvings + 1));
                    todo.push((lo, middle, halvings + 1));
                }
            }
        }
        let bins = bins(&cells, s_mm);
        Self {
            shape,
            cells,
            bins,
            length_mm: s_mm,
        }
    }

    /// Length, mm.
    pub const fn length_mm(&self) -> f64 {
        self.length_mm
    }

    /// Position and tangent at `s_mm`.
    pub fn at(&self, s_mm: f64) -> Point {
        let jet = self.jet_at(s_mm);
        Point {
            position_mm: jet.position_mm,
            tangent: unit(jet.first),
        }
    }

    /// Curvature at `s_mm`, 1/mm.
    pub fn curvature(&self, s_mm: f64) -> f64 {
        curvature(&self.jet_at(s_mm))
    }

    /// Arc lengths at which the table's cells start: between two of them the curve is gentle.
    pub fn cells_mm(&self) -> impl Iterator<Item = f64> + '_ {
        self.cells.iter().map(|cell| cell.s_mm)
    }

    fn jet_at(&self, s_mm: f64) -> Jet {
        let cell = &self.cells[self.cell_of(s_mm)];
        self.shape.jet(cell.parameter(s_mm))
    }

    fn cell_of(&self, s_mm: f64) -> usize {
        let last = self.bins.len() - 1;
        // A cast of a negative number or NaN to an unsigned integer gives 0.
        let bin = (s_mm / self.length_mm * self.bins.len() as f64) as usize;
        let mut index = self.bins[bin.min(last)] as usize;
        while index + 1 < self.cells.len() && self.cells[index + 1].s_mm <= s_mm {
            index += 1;
        }
        index
    }

    fn cell_end_mm(&self, index: usize) -> f64 {
        self.cells
            .get(index + 1)
            .map_or(self.length_mm, |cell| cell.s_mm)
    }

    /// Arc length of the nearest point between the bounds.
    ///
    /// Walks to a foot first. Where the range is so short and the point so near that the distance is convex over it
    /// (curvature times the largest possible distance below 1), that foot is the answer; otherwise all other cells are
    /// searched, skipping those that the point's distance from their ends puts out of reach.
    pub fn nearest(&self, point_mm: [f64; 3], lo_mm: f64, hi_mm: f64) -> f64 {
        let mut s_mm = 0.5 * (lo_mm + hi_mm);
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

        let sharpest = self.cells[first..=last]
            .iter()
            .fold(0.0, |k: f64, cell| k.max(cell.curvature_1_mm));
        // 1.5: the curvature was sampled, not bounded.
        let inside = best.s_mm > self.cells[middle].s_mm.max(lo_mm)
            && best.s_mm < self.cell_end_mm(middle).min(hi_mm);
        if 1.5 * sharpest * (best.distance_mm + hi_mm - lo_mm) < 1.0 && inside {
            return best.s_mm;
        }
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

    fn distance(&self, point_mm: Vector, s_mm: f64) -> f64 {
        distance(self.jet_at(s_mm).position_mm, point_mm)
    }

    /// Nearest point within one cell: where `(C - p).C'` changes from negative to positive, or an end.
    fn offer(&self, index: usize, point_mm: Vector, lo_mm: f64, hi_mm: f64, best: &mut Best) {
        let cell = &self.cells[index];
        let mut lo = cell.s_mm.max(lo_mm);
        let mut hi = self.cell_end_mm(index).min(hi_mm);
        if lo > hi {
            return;
        }
        let slope = |s_mm: f64| {
            let jet = self.shape.jet(cell.parameter(s_mm));
            let away = sub(jet.position_mm, point_mm);
            let speed = norm(jet.first).max(MIN_SPEED_MM);
            // d/ds of half the squared distance, and an approximation of its derivative that is right near the curve.
            let first = dot(away, jet.first) / speed;
            let second = 1.0
                + (dot(away, jet.second) - first * dot(jet.first, jet.second) / speed)
                    / (speed * speed);
            (first, second, norm(away))
        };
        let at_lo = slope(lo);
        let at_hi = slope(hi);
        if at_lo.0 >= 0.0 || at_hi.0 <= 0.0 {
            for (s_mm, distance_mm) in [(lo, at_lo.2), (hi, at_hi.2)] {
                if distance_mm < best.distance_mm - TIE_MM {
                    *best = Best { s_mm, distance_mm };
                }
            }
            return;
        }
        let mut s_mm = lo + (hi - lo) * at_lo.0 / (at_lo.0 - at_hi.0);
        for _ in 0..MAX_NEWTON_STEPS {
            let (first, second, _) = slope(s_mm);
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
            // Quadratic convergence: after a step this small the error is of the order of its square.
            if inside && moved < 1e-7 || moved < 1e-12 {
                break;
            }
        }
        let distance_mm = slope(s_mm).2;
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

impl Cell {
    fn parameter(&self, s_mm: f64) -> f64 {
        let d = s_mm - self.s_mm;
        let [a, b, c, e, f] = self.powers;
        self.u + d * (a + d * (b + d * (c + d * (e + d * f))))
    }
}

fn unit(a: Vector) -> Vector {
    scale(1.0 / norm(a).max(MIN_SPEED_MM), a)
}

fn curvature(jet: &Jet) -> f64 {
    let speed = norm(jet.first).max(MIN_SPEED_MM);
    (norm(cross(jet.first, jet.second)) / (speed * speed * speed)).min(MAX_CURVATURE_1_MM)
}

/// Length of the curve between two parameters, 5-point Gauss-Legendre.
fn gauss(shape: &dyn Parametric, lo: f64, hi: f64) -> f64 {
    let root = (10.0f64 / 7.0).sqrt();
    let near = (5.0 - 2.0 * root).sqrt() / 3.0;
    let far = (5.0 + 2.0 * root).sqrt() / 3.0;
    let weight = 13.0 * 70.0f64.sqrt();
    let (near_weight, far_weight) = ((322.0 + weight) / 900.0, (322.0 - weight) / 900.0);
    let half = 0.5 * (hi - lo);
    let middle = 0.5 * (hi + lo);
    let speed = |x: f64| norm(shape.jet(middle + half * x).first);
    half * (128.0 / 225.0 * speed(0.0)
        + near_weight * (speed(near) + speed(-near))
        + far_weight * (speed(far) + speed(-far)))
}

/// The cell between two parameters, its length, and whether it is good enough.
fn make_cell(shape: &dyn Parametric, s_mm: f64, lo: f64, hi: f64) -> (Cell, f64, bool) {
    let quarter = |i: u32| lo + (hi - lo) * 0.25 * f64::from(i);
    let mut lengths = [0.0; 5];
    for i in 0..4 {
        lengths[i + 1] = lengths[i] + gauss(shape, quarter(i as u32), quarter(i as u32 + 1));
    }
    let length_mm = lengths[4];
    let jets = [0, 1, 2, 3, 4].map(|i| shape.jet(quarter(i)));
    let cell = Cell {
        s_mm,
        u: lo,
        powers: hermite(lo, hi, length_mm, &jets[0], &jets[4]),
        curvature_1_mm: jets.iter().map(curvature).fold(0.0, f64::max),
    };
    let mut good = (gauss(shape, lo, hi) - length_mm).abs() <= CELL_TOLERANCE_MM;
    for i in 1..4 {
        let miss_mm =
            (cell.parameter(s_mm + lengths[i]) - quarter(i as u32)).abs() * norm(jets[i].first);
        good &= miss_mm <= CELL_TOLERANCE_MM + 1e-15 * s_mm;
    }
    for i in 0..4 {
        good &= angle(jets[i].first, jets[i + 1].first) <= 0.25 * CELL_TURN_RAD;
    }
    (cell, length_mm, good)
}

/// Quintic through value, slope and second derivative of `u(s)` at both ends.
fn hermite(lo: f64, hi: f64, length: f64, at_lo: &Jet, at_hi: &Jet) -> [f64; 5] {
    let slopes = |jet: &Jet| {
        let speed = norm(jet.first).max(MIN_SPEED_MM);
        (1.0 / speed, -dot(jet.first, jet.second) / speed.powi(4))
    };
    let (a1, a2) = slopes(at_lo);
    let (b1, b2) = slopes(at_hi);
    let h = length.max(f64::MIN_POSITIVE);
    // What a quadratic from the start misses at the end, in value, slope and second derivative, scaled by h.
    let value = hi - lo - a1 * h - 0.5 * a2 * h * h;
    let slope = (b1 - a1 - a2 * h) * h;
    let bend = (b2 - a2) * h * h;
    let cubic = 10.0 * value - 4.0 * slope + 0.5 * bend;
    let quartic = -15.0 * value + 7.0 * slope - bend;
    let quintic = 6.0 * value - 3.0 * slope + 0.5 * bend;
    let h3 = h * h * h;
    [
        a1,
        0.5 * a2,
        cubic / h3,
        quartic / (h3 * h),
        quintic / (h3 * h * h),
    ]
}

fn bins(cells: &[Cell], length_mm: f64) -> Vec<u32> {
    let count = cells.len().max(1);
    let mut index = 0;
    (0..count)
        .map(|bin| {
            let start_mm = length_mm * bin as f64 / count as f64;
            while index + 1 < cells.len() && cells[index + 1].s_mm <= start_mm {
                index += 1;
            }
            index as u32
        })
        .collect()
}
