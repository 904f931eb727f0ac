//! A smooth parametric curve by arc length.
//!
//! The curve `C(u)` is exact; only the parameter `u(s)` at a given arc length is approximated. The
//! domain is cut into cells; within a cell `u(s)` is the quintic polynomial that matches `u`, `u' =
//! 1/|C'|` and `u'' = -(C'.C'')/|C'|^4` at both ends. Lengths of cells come from 5-point
//! Gauss-Legendre quadrature of `|C'|`; a cell is halved until quadrature and polynomial are right
//! to `CELL_TOLERANCE_MM` and the tangent turns little enough for the nearest point to be unique.

mod nearest;

use super::{Derivatives, Point};
use crate::vector::{Vector, add_scaled, angle, cross, dot, norm, scale};
use std::fmt::Debug;

/// Arc length within a cell is right to this: a tenth of what the path promises, and far above
/// rounding.
const CELL_TOLERANCE_MM: f64 = 1e-10;

/// The tangent turns by no more than this in a cell, so that the curve is a gentle arc there.
const CELL_TURN_RAD: f64 = 0.3;

/// Halvings before a cell is taken as it is: at a cusp, where no cell is short enough, 2^-40 of a
/// span is below 1 pm.
const MAX_HALVINGS: u32 = 40;

/// A cell no longer than this many times the rounding of its coordinates shows rounding rather than
/// a curve.
const ROUNDINGS: f64 = 1e3;

/// Cells of one span before the rest is taken as it is: hundreds of times more than any curve of
/// use needs, and an end to those that no table fits.
const MAX_CELLS_OF_SPAN: usize = 1 << 14;

/// Curvature above this is a corner, not a curve: a radius of 1 nm.
pub(crate) const MAX_CURVATURE_1_MM: f64 = 1e6;

/// A speed |C'| below this fraction of a mm per unit of the parameter counts as this, so that a
/// cusp divides by no zero.
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

/// A curve in spans, each over a parameter `u` from 0 to 1.
///
/// Within a span all derivatives exist; where two spans meet, position and direction agree, the
/// rest may jump.
pub trait Parametric: Debug + Send + Sync {
    /// Number of spans.
    fn spans(&self) -> usize;

    /// Position and derivatives at `u` of a span.
    fn jet(&self, span: usize, u: f64) -> Jet;

    /// C'''(u) of a span.
    fn third(&self, span: usize, u: f64) -> Vector;
}

#[derive(Debug, Clone, Copy)]
struct Cell {
    s_mm: f64,
    span: usize,
    /// Parameters at both ends.
    u: [f64; 2],
    /// Coefficients of `u(s) - u[0]` in powers 1 to 5 of `s - s_mm`.
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
        for span in 0..shape.spans() {
            let mut todo = vec![([0.0, 1.0], 0)];
            let most = cells.len() + MAX_CELLS_OF_SPAN;
            while let Some((u, halvings)) = todo.pop() {
                let (cell, length_mm, good) = make_cell(shape.as_ref(), s_mm, span, u);
                if good || halvings >= MAX_HALVINGS || cells.len() >= most {
                    if length_mm > 0.0 {
                        cells.push(cell);
                        s_mm += length_mm;
                    }
                } else {
                    let middle = 0.5 * (u[0] + u[1]);
                    todo.push(([middle, u[1]], halvings + 1));
                    todo.push(([u[0], middle], halvings + 1));
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
    pub(crate) fn at(&self, s_mm: f64) -> Point {
        let cell = &self.cells[self.cell_of(s_mm)];
        let u = cell.parameter(s_mm);
        let jet = self.shape.jet(cell.span, u);
        let speed = norm(jet.first);
        let tangent = if speed > MIN_SPEED_MM {
            scale(1.0 / speed, jet.first)
        } else {
            self.tangent_of_cusp(cell.span, u)
        };
        Point {
            position_mm: jet.position_mm,
            tangent,
        }
    }

    /// Unit tangent at a cusp, where |C'| vanishes: the direction of C' slightly further inside the
    /// span. Returns +X if C' is zero there, too.
    #[cold]
    fn tangent_of_cusp(&self, span: usize, u: f64) -> Vector {
        let inside = self.shape.jet(span, u + 1e-6 * (0.5 - u)).first;
        let speed = norm(inside);
        if speed > 0.0 {
            scale(1.0 / speed, inside)
        } else {
            [1.0, 0.0, 0.0]
        }
    }

    /// Curvature at `s_mm`, 1/mm.
    pub(crate) fn curvature(&self, s_mm: f64) -> f64 {
        curvature(&self.jet_at(s_mm))
    }

    /// Derivatives at `s_mm`. With `u' = 1/|C'|`, `g = C'.C''` and
    ///
    /// `u'' = -g u'^4`, `u''' = (4 g^2 u'^2 - C''.C'' - C'.C''') u'^5`:
    ///
    /// `p'' = C'' u'^2 + C' u''`, `p''' = C''' u'^3 + 3 C'' u' u'' + C' u'''`. At a cusp there are
    /// none.
    pub(crate) fn derivatives(&self, s_mm: f64) -> Derivatives {
        let cell = &self.cells[self.cell_of(s_mm)];
        let u = cell.parameter(s_mm);
        let Jet { first, second, .. } = self.shape.jet(cell.span, u);
        let third = self.shape.third(cell.span, u);
        let u1 = 1.0 / norm(first).max(MIN_SPEED_MM);
        let g = dot(first, second);
        let u2 = -g * u1.powi(4);
        let u3 = (4.0 * g * g * u1 * u1 - dot(second, second) - dot(first, third)) * u1.powi(5);
        Derivatives {
            first: self.at(s_mm).tangent,
            second_1_mm: add_scaled(scale(u1 * u1, second), u2, first),
            third_1_mm2: add_scaled(
                add_scaled(scale(u1.powi(3), third), 3.0 * u1 * u2, second),
                u3,
                first,
            ),
        }
    }

    /// Number of cells of the table; within each, the curve is gentle.
    pub fn cells(&self) -> usize {
        self.cells.len()
    }

    /// Arc lengths at both ends of a cell.
    pub(crate) fn cell_mm(&self, index: usize) -> (f64, f64) {
        (self.cells[index].s_mm, self.cell_end_mm(index))
    }

    /// Curvature at `s_mm` seen from a cell: where two cells meet, it may differ.
    pub(crate) fn curvature_in(&self, index: usize, s_mm: f64) -> f64 {
        curvature(&self.jet_in(&self.cells[index], s_mm))
    }

    fn jet_at(&self, s_mm: f64) -> Jet {
        self.jet_in(&self.cells[self.cell_of(s_mm)], s_mm)
    }

    fn jet_in(&self, cell: &Cell, s_mm: f64) -> Jet {
        self.shape.jet(cell.span, cell.parameter(s_mm))
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
}

impl Cell {
    fn parameter(&self, s_mm: f64) -> f64 {
        let d = s_mm - self.s_mm;
        let [a, b, c, e, f] = self.powers;
        let u = self.u[0] + d * (a + d * (b + d * (c + d * (e + d * f))));
        u.min(self.u[1]).max(self.u[0])
    }
}

fn curvature(jet: &Jet) -> f64 {
    let speed = norm(jet.first).max(MIN_SPEED_MM);
    (norm(cross(jet.first, jet.second)) / (speed * speed * speed)).min(MAX_CURVATURE_1_MM)
}

/// Length of the curve between two parameters, 5-point Gauss-Legendre.
fn gauss(shape: &dyn Parametric, span: usize, lo: f64, hi: f64) -> f64 {
    let root = (10.0f64 / 7.0).sqrt();
    let near = (5.0 - 2.0 * root).sqrt() / 3.0;
    let far = (5.0 + 2.0 * root).sqrt() / 3.0;
    let weight = 13.0 * 70.0f64.sqrt();
    let (near_weight, far_weight) = ((322.0 + weight) / 900.0, (322.0 - weight) / 900.0);
    let half = 0.5 * (hi - lo);
    let middle = 0.5 * (hi + lo);
    let speed = |x: f64| norm(shape.jet(span, middle + half * x).first);
    half * (128.0 / 225.0 * speed(0.0)
        + near_weight * (speed(near) + speed(-near))
        + far_weight * (speed(far) + speed(-far)))
}

/// The cell between two parameters, its length, and whether it is good enough.
fn make_cell(shape: &dyn Parametric, s_mm: f64, span: usize, u: [f64; 2]) -> (Cell, f64, bool) {
    let [lo, hi] = u;
    let quarter = |i: u32| lo + (hi - lo) * 0.25 * f64::from(i);
    let mut lengths = [0.0; 5];
    for i in 0..4 {
        lengths[i + 1] = lengths[i] + gauss(shape, span, quarter(i as u32), quarter(i as u32 + 1));
    }
    let length_mm = lengths[4];
    let jets = [0, 1, 2, 3, 4].map(|i| shape.jet(span, quarter(i)));
    let cell = Cell {
        s_mm,
        span,
        u,
        powers: hermite(lo, hi, length_mm, &jets[0], &jets[4]),
        curvature_1_mm: jets.iter().map(curvature).fold(0.0, f64::max),
    };
    let extent_mm = jets[0]
        .position_mm
        .iter()
        .fold(0.0, |extent: f64, x| extent.max(x.abs()));
    let rounding_mm = f64::EPSILON * extent_mm;
    let tolerance_mm = CELL_TOLERANCE_MM.max(ROUNDINGS * rounding_mm);
    if length_mm <= tolerance_mm {
        return (cell, length_mm, true);
    }
    let mut good = (gauss(shape, span, lo, hi) - length_mm).abs() <= tolerance_mm;
    for i in 1..4 {
        let miss_mm =
            (cell.parameter(s_mm + lengths[i]) - quarter(i as u32)).abs() * norm(jets[i].first);
        good &= miss_mm <= tolerance_mm + 1e-15 * s_mm;
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
    // What a quadratic from the start misses at the end, in value, slope and second derivative,
    // scaled by h.
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
