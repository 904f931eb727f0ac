//! One step of Gauss and Newton: the minimum of the linearised problem within the limits of the
//! accelerations.
//!
//! ```text
//! minimise 1/2 da'(G'G + W) da + (G'r + W a)'da     -A <= a + da <= A
//! ```
//!
//! Source: Gauss-Newton with a fixed number of steps a tick as in Diehl, Bock and Schloeder (2005).

use feedwright_control::vector::add_scaled;

use super::super::least_squares::BLOCK;
use super::interior_point::Quadratic;
use super::problem::{GradientRow, HorizonProblem};
use super::{Accelerations, MAX_KNOTS, MAX_UNKNOWNS};

/// The normal equations of a tick. Kept between ticks so that none has to clear what it does not
/// use.
#[derive(Debug, Clone, Default)]
pub struct GaussNewton {
    quadratic: Quadratic,
}

impl GaussNewton {
    /// Changes the accelerations of a plan whose problem is this, within the limits. They are
    /// within them before.
    pub fn improve<const N: usize>(
        &mut self,
        problem: &HorizonProblem<N>,
        accelerations_mm_s2: &mut Accelerations<N>,
    ) {
        let unknowns = problem.unknowns();
        self.quadratic.clear(unknowns);
        self.add_errors(problem);
        self.add_speeds(problem, accelerations_mm_s2);
        self.add_offsets(problem);
        let limits = &problem.settings.limits.acceleration_mm_s2;
        let (mut least, mut most) = ([0.0; MAX_UNKNOWNS], [0.0; MAX_UNKNOWNS]);
        let bounds = least.iter_mut().zip(&mut most).enumerate().take(unknowns);
        for ((i, (least, most)), now) in bounds.zip(accelerations_mm_s2.as_flattened()) {
            (*least, *most) = (-limits[i % N] - now, limits[i % N] - now);
        }
        let change = self.quadratic.minimum(&least, &most);
        for (now, change) in accelerations_mm_s2
            .as_flattened_mut()
            .iter_mut()
            .zip(change)
            .take(unknowns)
        {
            *now += change;
        }
    }

    /// G'G and G'r, a block of rows of G at a time.
    fn add_errors<const N: usize>(&mut self, problem: &HorizonProblem<N>) {
        let mut rows: [GradientRow; BLOCK] = [[0.0; MAX_UNKNOWNS]; BLOCK];
        let mut errors = [0.0; BLOCK];
        let (mut held, mut entries) = (0, 0);
        problem.rows(|knot, error, fill| {
            // Behind its entries a row of an earlier block has none either, and is zero: rows come
            // in the order of the knots. Of a block that is full nothing is held.
            let at = held % BLOCK;
            fill(&mut rows[at]);
            errors[at] = error;
            entries = (knot + 1) * N;
            held += 1;
            if held == BLOCK {
                self.quadratic.add_rows(&rows, &errors, entries);
                held = 0;
            }
        });
        if held > 0 {
            for (row, error) in rows.iter_mut().zip(&mut errors).skip(held) {
                row.fill(0.0);
                *error = 0.0;
            }
            self.quadratic.add_rows(&rows, &errors, entries);
        }
    }

    /// q: an acceleration in knot r moves the offset at the end of knot i by m_(i-r), so that the
    /// products of two knots differ from those of the next two by one term.
    fn add_offsets<const N: usize>(&mut self, problem: &HorizonProblem<N>) {
        let (knots, weight) = (problem.knots.min(MAX_KNOTS), problem.settings.offset_weight);
        if weight <= 0.0 {
            return;
        }
        let moved = |since: usize| {
            problem
                .moved_s2
                .get(knots - 1 - since)
                .copied()
                .unwrap_or(0.0)
        };
        for r in 0..knots {
            for axis in 0..N {
                let ends = problem.ends.iter().take(knots).enumerate().skip(r);
                let slope: f64 = ends
                    .map(|(i, end)| moved(i - r) * end.offset_mm[axis])
                    .sum();
                self.quadratic.add_gradient(r * N + axis, weight * slope);
            }
        }
        for apart in 0..knots {
            let mut sum = 0.0;
            for r in (apart..knots).rev() {
                sum += moved(knots - 1 - r) * moved(knots - 1 - r + apart);
                for axis in 0..N {
                    self.quadratic
                        .add(r * N + axis, (r - apart) * N + axis, weight * sum);
                }
            }
        }
    }

    /// W: the speed v_j of the offset after knot j is the same sum of accelerations for all m <= j.
    fn add_speeds<const N: usize>(
        &mut self,
        problem: &HorizonProblem<N>,
        accelerations_mm_s2: &Accelerations<N>,
    ) {
        let (knots, knot_s) = (problem.knots.min(MAX_KNOTS), problem.knot_s);
        let change = problem.settings.change_weight * knot_s * knot_s;
        let rate = problem.settings.rate_weight * knot_s;
        let mut sum_mm_s = [[0.0; N]; MAX_KNOTS];
        for knot in (0..knots).rev() {
            let later = if knot + 1 < knots {
                sum_mm_s[knot + 1]
            } else {
                [0.0; N]
            };
            sum_mm_s[knot] = add_scaled(later, 1.0, problem.ends[knot].offset_mm_s);
        }
        for r in 0..knots {
            let further = rate * knot_s * (knots - r) as f64;
            for axis in 0..N {
                let slope = rate * sum_mm_s[r][axis] + change * accelerations_mm_s2[r][axis];
                self.quadratic.add_gradient(r * N + axis, slope);
                self.quadratic.add(r * N + axis, r * N + axis, change);
                for c in 0..=r {
                    self.quadratic.add(r * N + axis, c * N + axis, further);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::peers::model_predictive::horizon::{
        CommandedPeriod, CorrectionLimits, HorizonSettings, Predictor, Sensitivity,
    };
    use feedwright_control::{Knot, KnotSource, Preview, Register, Window};

    const KNOTS: usize = 6;

    struct Line;

    impl KnotSource<2> for Line {
        fn knot(&mut self, tau_s: f64) -> Knot<2> {
            Knot {
                position_mm: [10.0 * tau_s, 0.0],
                tangent: [1.0, 0.0],
                feed_mm_s: 10.0,
                cutting: true,
            }
        }
    }

    /// A machine that does not respond to the offset, so that only the cost of the offset remains.
    #[derive(Clone)]
    struct Deaf;

    impl Predictor<2> for Deaf {
        fn lag_s(&self) -> f64 {
            0.0
        }

        fn advance(
            &mut self,
            window: &Window<'_, 2>,
            stretch: &CommandedPeriod<2>,
            _: &mut Sensitivity<2>,
        ) -> [f64; 2] {
            window.ahead(stretch.period + 1).position_mm
        }
    }

    const SETTINGS: HorizonSettings<2> = HorizonSettings {
        knots: KNOTS,
        rate_weight: 0.0,
        change_weight: 1e-12,
        offset_weight: 0.7,
        last_weight: 0.1,
        limits: CorrectionLimits {
            acceleration_mm_s2: [1e6; 2],
            ..CorrectionLimits::NONE
        },
        ..HorizonSettings::EXAMPLE
    };

    fn window<'a>(register: &'a Register<2>, preview: &'a Preview<2>) -> Window<'a, 2> {
        let (offset_mm, offset_mm_s) = ([0.2, -0.1], [3.0, 5.0]);
        Window {
            register,
            preview,
            tau_s: 0.0,
            feed_period_s: 0.003,
            offset_mm,
            offset_mm_s,
        }
    }

    /// q/2 sum |o|^2 + d/2 sum |T a|^2 of a plan, rolled out.
    fn cost(window: &Window<'_, 2>, accelerations: &Accelerations<2>) -> f64 {
        let problem = HorizonProblem::new(&Deaf, window, accelerations, &SETTINGS);
        let squares = |all: &mut dyn Iterator<Item = f64>| all.map(|x| x * x).sum::<f64>();
        let offsets = squares(&mut problem.ends[..KNOTS].iter().flat_map(|end| end.offset_mm));
        let changes = squares(
            &mut accelerations[..KNOTS]
                .as_flattened()
                .iter()
                .map(|a| a * problem.knot_s),
        );
        0.5 * (SETTINGS.offset_weight * offsets + SETTINGS.change_weight * changes)
    }

    #[test]
    fn a_step_finds_the_least_cost_of_the_offsets() {
        let (mut register, mut preview) = (Register::default(), Preview::new(0.001));
        register.push(Line.knot(0.0));
        preview.fill(&mut Line, 0.0, 0.1);
        let window = window(&register, &preview);
        let mut accelerations = [[0.0; 2]; MAX_KNOTS];
        let problem = HorizonProblem::new(&Deaf, &window, &accelerations, &SETTINGS);
        GaussNewton::default().improve(&problem, &mut accelerations);
        let least = cost(&window, &accelerations);
        for knot in 0..KNOTS {
            for axis in 0..2 {
                for step in [-1.0, 1.0] {
                    let mut other = accelerations;
                    other[knot][axis] += step;
                    assert!(cost(&window, &other) > least, "{knot} {axis}");
                }
            }
        }
    }
}
