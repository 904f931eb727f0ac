//! The minimum of a convex quadratic within bounds, by a primal-dual interior-point method.
//!
//! ```text
//! minimise 1/2 x'Hx + g'x     least <= x <= most
//!
//! (H + Z/S + Y/T) dx = c/S - d/T     S = x - least, T = most - x; Z, Y: their multipliers
//! ```
//!
//! Where the minimum without bounds is within them, that is the answer, for one factorisation.
//! Otherwise every iteration takes one more: a predictor, and with the same factors a corrector.
//! The number of iterations hardly depends on the problem, and is bounded; x is within the bounds
//! after each. An active set takes about as many factorisations where it ends, but it need not: the
//! last accelerations of a horizon hardly move the tool, H has a condition number of 1e10, and the
//! sets cycled.
//!
//! Source: Mehrotra (1992), "On the implementation of a primal-dual interior point method"; for
//! horizons, Rao, Wright and Rawlings (1998).

use feedwright_control::vector::bounded;

use super::super::least_squares::{BLOCK, add_products, cholesky, substitute};
use super::MAX_UNKNOWNS;

/// Iterations at the most.
const MAX_ITERATIONS: usize = 12;
/// Largest excess of J over its minimum, mm^2: three nanometres of contour error in one knot.
const NEAR_ENOUGH_MM2: f64 = 1e-11;
/// Part of the way to the nearest bound that a step goes.
const PART_OF_THE_WAY: f64 = 0.995;
/// The first point is this far within the bounds, in parts of their distance.
const WELL_WITHIN: f64 = 0.05;

type Unknowns = [f64; MAX_UNKNOWNS];

/// H, of which the lower half is used, and g.
#[derive(Debug, Clone)]
pub(crate) struct Quadratic {
    number: usize,
    curvature: [Unknowns; MAX_UNKNOWNS],
    gradient: Unknowns,
    factors: [Unknowns; MAX_UNKNOWNS],
}

impl Default for Quadratic {
    fn default() -> Self {
        Self {
            number: 0,
            curvature: [[0.0; MAX_UNKNOWNS]; MAX_UNKNOWNS],
            gradient: [0.0; MAX_UNKNOWNS],
            factors: [[0.0; MAX_UNKNOWNS]; MAX_UNKNOWNS],
        }
    }
}

/// A point between the bounds, what it is away from them, and the multipliers.
#[derive(Debug, Clone)]
struct Iterate {
    x: Unknowns,
    /// x - least, most - x.
    room: [Unknowns; 2],
    multipliers: [Unknowns; 2],
}

impl Quadratic {
    /// Clears H and g for a problem with `number` unknowns.
    pub(crate) fn clear(&mut self, number: usize) {
        self.number = number;
        let number = self.number();
        for (r, row) in self.curvature.iter_mut().enumerate().take(number) {
            row[..=r].fill(0.0);
        }
        self.gradient[..number].fill(0.0);
    }

    /// Adds `1/2 (error + row x)^2` for a block of rows, whose first entries count.
    #[inline]
    pub(crate) fn add_rows(
        &mut self,
        rows: &[Unknowns; BLOCK],
        errors: &[f64; BLOCK],
        entries: usize,
    ) {
        let entries = entries.min(self.number());
        for (r, sums) in self.curvature.iter_mut().enumerate().take(entries) {
            let factors = rows.each_ref().map(|row| row[r]);
            add_products(
                &mut sums[..=r],
                factors,
                rows.each_ref().map(|row| &row[..=r]),
            );
        }
        add_products(
            &mut self.gradient[..entries],
            *errors,
            rows.each_ref().map(|row| &row[..entries]),
        );
    }

    /// Adds to an entry of H in its lower half.
    #[inline]
    pub(crate) fn add(&mut self, row: usize, column: usize, curvature: f64) {
        if let Some(entry) = self
            .curvature
            .get_mut(row)
            .and_then(|row| row.get_mut(column))
        {
            *entry += curvature;
        }
    }

    /// Adds to an entry of g.
    #[inline]
    pub(crate) fn add_gradient(&mut self, row: usize, slope: f64) {
        if let Some(entry) = self.gradient.get_mut(row) {
            *entry += slope;
        }
    }

    /// Unknowns: no more than there is room for.
    #[inline]
    fn number(&self) -> usize {
        self.number.min(MAX_UNKNOWNS)
    }

    /// The minimum within the bounds, between which zero is.
    pub(crate) fn minimum(&mut self, least: &Unknowns, most: &Unknowns) -> Unknowns {
        let number = self.number();
        let mut x = self.gradient.map(|slope| -slope);
        for (factors, row) in self.factors.iter_mut().zip(&self.curvature).take(number) {
            factors.copy_from_slice(row);
        }
        cholesky(&mut self.factors, &mut x, number);
        if (0..number).all(|i| x[i] >= least[i] && x[i] <= most[i]) {
            return x;
        }
        let mut point = self.first_point(least, most);
        for _ in 0..MAX_ITERATIONS {
            let gap = point.gap(number);
            if gap.is_nan() || gap < NEAR_ENOUGH_MM2 {
                break;
            }
            self.iterate(&mut point, gap);
        }
        point.x
    }

    /// Near zero, with multipliers that satisfy H x + g = z - y.
    fn first_point(&self, least: &Unknowns, most: &Unknowns) -> Iterate {
        let mut point = Iterate {
            x: [0.0; MAX_UNKNOWNS],
            room: [[1.0; MAX_UNKNOWNS]; 2],
            multipliers: [[1.0; MAX_UNKNOWNS]; 2],
        };
        for i in 0..self.number() {
            let within = WELL_WITHIN * (most[i] - least[i]);
            point.x[i] = bounded(0.0, least[i] + within, most[i] - within);
            point.room[0][i] = point.x[i] - least[i];
            point.room[1][i] = most[i] - point.x[i];
        }
        let slopes = self.slopes(&point.x);
        let mean = slopes[..self.number()]
            .iter()
            .map(|slope| slope.abs())
            .sum::<f64>()
            / self.number().max(1) as f64;
        for i in 0..self.number() {
            point.multipliers[0][i] = slopes[i].max(0.0) + 0.1 * mean;
            point.multipliers[1][i] = (-slopes[i]).max(0.0) + 0.1 * mean;
        }
        point
    }

    fn iterate(&mut self, point: &mut Iterate, gap: f64) {
        let number = self.number();
        let [z, y] = point.multipliers;
        let [s, t] = point.room;
        for (r, (factors, row)) in self
            .factors
            .iter_mut()
            .zip(&self.curvature)
            .enumerate()
            .take(number)
        {
            factors.copy_from_slice(row);
            factors[r] += z[r] / s[r] + y[r] / t[r];
        }
        let mut predicted: Unknowns = core::array::from_fn(|i| y[i] - z[i]);
        cholesky(&mut self.factors, &mut predicted, number);
        let rates: [Unknowns; 2] = [
            core::array::from_fn(|i| -z[i] - z[i] / s[i] * predicted[i]),
            core::array::from_fn(|i| -y[i] + y[i] / t[i] * predicted[i]),
        ];
        let ahead = point
            .after(
                &predicted,
                &rates,
                point.longest(&predicted, &rates, number),
            )
            .gap(number)
            / gap;
        let centre = ahead * ahead * ahead * gap / (2 * number.max(1)) as f64;
        // What the products of room and multiplier are to become, less what they are, and what the
        // predictor makes of them.
        let c: Unknowns =
            core::array::from_fn(|i| centre - s[i] * z[i] - predicted[i] * rates[0][i]);
        let d: Unknowns =
            core::array::from_fn(|i| centre - t[i] * y[i] + predicted[i] * rates[1][i]);
        let mut step: Unknowns = core::array::from_fn(|i| c[i] / s[i] - d[i] / t[i]);
        substitute(&self.factors, &mut step, number);
        let rates: [Unknowns; 2] = [
            core::array::from_fn(|i| (c[i] - z[i] * step[i]) / s[i]),
            core::array::from_fn(|i| (d[i] + y[i] * step[i]) / t[i]),
        ];
        let length = PART_OF_THE_WAY * point.longest(&step, &rates, number);
        *point = point.after(&step, &rates, length);
    }

    /// H x + g.
    fn slopes(&self, x: &Unknowns) -> Unknowns {
        let mut slopes = self.gradient;
        for r in 0..self.number() {
            let row = &self.curvature[r];
            let mut sum = 0.0;
            for c in 0..r {
                sum += row[c] * x[c];
                slopes[c] += row[c] * x[r];
            }
            slopes[r] += sum + row[r] * x[r];
        }
        slopes
    }
}

impl Iterate {
    /// Sum of the products of room and multiplier: J is above its minimum by no more.
    fn gap(&self, number: usize) -> f64 {
        let mut sum = 0.0;
        for side in 0..2 {
            for i in 0..number.min(MAX_UNKNOWNS) {
                sum += self.room[side][i] * self.multipliers[side][i];
            }
        }
        sum
    }

    /// The longest part of a step, up to all of it, that leaves room and multipliers above zero.
    fn longest(&self, step: &Unknowns, rates: &[Unknowns; 2], number: usize) -> f64 {
        let mut shrinks = 1.0_f64;
        for side in 0..2 {
            let sign = if side == 0 { -1.0 } else { 1.0 };
            for i in 0..number.min(MAX_UNKNOWNS) {
                shrinks = shrinks.max(sign * step[i] / self.room[side][i]);
                shrinks = shrinks.max(-rates[side][i] / self.multipliers[side][i]);
            }
        }
        1.0 / shrinks
    }

    fn after(&self, step: &Unknowns, rates: &[Unknowns; 2], length: f64) -> Self {
        let add =
            |a: &Unknowns, part: f64, b: &Unknowns| core::array::from_fn(|i| a[i] + part * b[i]);
        Self {
            x: add(&self.x, length, step),
            room: [
                add(&self.room[0], length, step),
                add(&self.room[1], -length, step),
            ],
            multipliers: [0, 1].map(|side| add(&self.multipliers[side], length, &rates[side])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NUMBER: usize = 12;

    fn quadratic(seed: f64) -> Quadratic {
        let mut quadratic = Quadratic::default();
        quadratic.clear(NUMBER);
        for r in 0..NUMBER {
            quadratic.add(r, r, 0.05 * libm::pow(10.0, -0.5 * r as f64));
            quadratic.add_gradient(r, 1e-3 * libm::sin(seed + 3.0 * r as f64));
        }
        let rows = core::array::from_fn(|k| {
            core::array::from_fn(|i| libm::cos(seed * (k + 1) as f64 + (i * k) as f64))
        });
        quadratic.add_rows(&rows, &[0.03, -0.02, 0.01, 0.05], NUMBER);
        quadratic
    }

    /// Checks the bound by duality: J is above its minimum by no more than the slopes could still
    /// gain within the bounds.
    #[test]
    fn no_point_within_the_bounds_is_better_by_more_than_the_tolerance() {
        let mut binding = 0;
        for case in 0..200 {
            let mut quadratic = quadratic(0.37 * f64::from(case));
            let width = 0.002 + 0.02 * f64::from(case % 17);
            let (least, most) = ([-width; MAX_UNKNOWNS], [0.7 * width; MAX_UNKNOWNS]);
            let x = quadratic.minimum(&least, &most);
            let slopes = quadratic.slopes(&x);
            let mut gain = 0.0;
            for i in 0..NUMBER {
                assert!(x[i] >= least[i] && x[i] <= most[i], "{case} {i}: {}", x[i]);
                gain += slopes[i] * (x[i] - if slopes[i] > 0.0 { least[i] } else { most[i] });
                binding += i32::from((x[i] - least[i]).min(most[i] - x[i]) < 1e-6);
            }
            assert!(gain < 2.0 * NEAR_ENOUGH_MM2, "{case}: {gain}");
        }
        assert!(binding > 200, "the bounds hardly bind: {binding}");
    }
}
