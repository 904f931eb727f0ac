//! The dense solution of a tick against another way to solve the same problem: a recursion over
//! time that shares no code with it, not even the derivative of the tool to the accelerations.
//! Within limits, against a slow descent along one acceleration after the other.

mod material;
mod model;
mod riccati;

use feedwright_control::vector::{add_scaled, dot, sub};
use feedwright_lab::{Accelerations, END_WEIGHT, HorizonProblem, HorizonSettings};
use material::{Material, difference};
use riccati::{AGREEMENT, apart_from_gauss_newton};

/// Largest excess of J, here some 0.4 mm^2, over its minimum, mm^2: a tenth of a micrometre in one
/// knot. Where the solver does not reach its own tolerance within its iterations, it exceeds it by
/// a little; one iteration more would be enough here.
const NEAR_ENOUGH_MM2: f64 = 6e-9;

/// J of the problem linearised about the plan of the tick before, term by term as it is written,
/// mm^2.
fn cost<const N: usize>(
    material: &Material<N>,
    problem: &HorizonProblem<N>,
    plan: &Accelerations<N>,
) -> f64 {
    let HorizonSettings {
        rate_weight,
        change_weight,
        ..
    } = problem.settings;
    let square = |v: [f64; N]| dot(v, v);
    let changed: Accelerations<N> =
        std::array::from_fn(|knot| sub(plan[knot], material.plan[knot]));
    let mut cost = 0.0;
    let (mut faster_mm_s, mut further_mm) = ([0.0; N], [0.0; N]);
    for knot in 0..problem.knots {
        let end = &problem.ends[knot];
        let mut tool_mm = [0.0; N];
        for (sensitivity, changed) in problem.sensitivity[knot]
            .iter()
            .zip(&changed)
            .take(knot + 1)
        {
            tool_mm = std::array::from_fn(|axis| tool_mm[axis] + sensitivity[axis] * changed[axis]);
        }
        for (d, direction) in end.directions.iter().enumerate() {
            let weight = problem.error_weight(knot, d);
            cost += 0.5 * (weight * (end.off_mm[d] + dot(*direction, tool_mm))).powi(2);
        }
        further_mm = add_scaled(further_mm, problem.knot_s, faster_mm_s);
        further_mm = add_scaled(further_mm, 0.5 * problem.knot_s.powi(2), changed[knot]);
        faster_mm_s = add_scaled(faster_mm_s, problem.knot_s, changed[knot]);
        cost += 0.5 * rate_weight * square(add_scaled(end.offset_mm_s, 1.0, faster_mm_s));
        cost += 0.5 * change_weight * problem.knot_s.powi(2) * square(plan[knot]);
    }
    let end = &problem.ends[problem.knots - 1];
    let last_mm = add_scaled(end.offset_mm, 1.0, further_mm);
    let last_mm_s = add_scaled(end.offset_mm_s, 1.0, faster_mm_s);
    cost + 0.5 * END_WEIGHT.powi(2) * square(add_scaled(last_mm, problem.lag_s, last_mm_s))
}

fn riccati_and_gauss_newton_agree<const N: usize>() {
    for knots in [1, 2, 3, 10, 20] {
        let material = Material::<N>::new(knots);
        let (problem, _) = material.roll_out();
        let exact = material.improved(&problem);
        let apart = apart_from_gauss_newton(&material);
        assert!(apart < AGREEMENT, "{N} axes, {knots} knots: {apart:e}");
        assert!(
            difference(&exact, &material.plan) > 0.1,
            "the solution is not what it started from"
        );
    }
}

#[test]
fn riccati_and_gauss_newton_agree_in_two_and_three_axes() {
    riccati_and_gauss_newton_agree::<2>();
    riccati_and_gauss_newton_agree::<3>();
}

#[test]
fn nothing_beside_the_solution_costs_less() {
    let material = Material::<3>::new(20);
    let (problem, _) = material.roll_out();
    let exact = material.improved(&problem);
    let least = cost(&material, &problem, &exact);
    for knot in 0..problem.knots {
        for axis in 0..3 {
            for step in [-10.0, 10.0] {
                let mut beside = exact;
                beside[knot][axis] += step;
                assert!(
                    cost(&material, &problem, &beside) > least,
                    "{knot} {axis} {step}"
                );
            }
        }
    }
}

/// The problem in accelerations alone, from nothing but its cost: that is a quadratic, of which
/// differences are exact.
struct KnotSource {
    curvature: Vec<Vec<f64>>,
    /// Slopes at the plan.
    slopes: Vec<f64>,
}

/// A step of the differences, mm/s^2.
const STEP_MM_S2: f64 = 1000.0;

impl KnotSource {
    fn new<const N: usize>(material: &Material<N>, problem: &HorizonProblem<N>) -> Self {
        let moved_cost = |moved: &[(usize, f64)]| {
            let mut plan = material.plan;
            moved
                .iter()
                .for_each(|(i, step)| plan.as_flattened_mut()[*i] += step);
            cost(material, problem, &plan)
        };
        let (unknowns, h) = (problem.unknowns(), STEP_MM_S2);
        let entry = |i, j| {
            let [both, less] = [h, -h].map(|other| moved_cost(&[(i, h), (j, other)]));
            let [more, neither] = [h, -h].map(|other| moved_cost(&[(i, -h), (j, other)]));
            (both - less - more + neither) / (4.0 * h * h)
        };
        let curvature = (0..unknowns)
            .map(|i| (0..unknowns).map(|j| entry(i, j)).collect())
            .collect();
        let slopes = (0..unknowns)
            .map(|i| (moved_cost(&[(i, h)]) - moved_cost(&[(i, -h)])) / (2.0 * h))
            .collect();
        Self { curvature, slopes }
    }

    /// The slopes after a change of the plan.
    fn slopes_after(&self, change: &[f64]) -> Vec<f64> {
        let moved = |row: &Vec<f64>| row.iter().zip(change).map(|(h, x)| h * x).sum::<f64>();
        self.slopes
            .iter()
            .zip(&self.curvature)
            .map(|(slope, row)| slope + moved(row))
            .collect()
    }

    /// Coordinate descent: `sweeps` times, moves one acceleration after the other to its minimum
    /// within the limit.
    fn descend<const N: usize>(&self, plan: &mut Accelerations<N>, most_mm_s2: f64, sweeps: usize) {
        let mut slopes = self.slopes.clone();
        for _ in 0..sweeps {
            for (i, row) in self.curvature.iter().enumerate() {
                let now = &mut plan.as_flattened_mut()[i];
                let to = (*now - slopes[i] / row[i]).clamp(-most_mm_s2, most_mm_s2);
                slopes
                    .iter_mut()
                    .zip(row)
                    .for_each(|(slope, h)| *slope += h * (to - *now));
                *now = to;
            }
        }
    }
}

fn the_plan_within_limits_is_the_best<const N: usize>(most_mm_s2: f64) {
    let material = Material::<N>::within(20, most_mm_s2);
    let (problem, _) = material.roll_out();
    let plan = material.improved(&problem);
    let reference = KnotSource::new(&material, &problem);
    let case = format!("{N} axes, {most_mm_s2} mm/s^2");

    // By duality J is above its minimum by no more than what the slopes could still gain within the
    // limits.
    let change: Vec<f64> = plan
        .as_flattened()
        .iter()
        .zip(material.plan.as_flattened())
        .map(|(to, from)| to - from)
        .take(problem.unknowns())
        .collect();
    let (mut gain, mut bound) = (0.0, 0);
    for (slope, a) in reference
        .slopes_after(&change)
        .iter()
        .zip(plan.as_flattened())
    {
        assert!(a.abs() <= most_mm_s2, "{case}: {a}");
        gain += slope * a + slope.abs() * most_mm_s2;
        bound += usize::from(a.abs() > 0.999 * most_mm_s2);
    }
    let mut descended = material.plan;
    reference.descend(&mut descended, most_mm_s2, 20_000);
    let [found, slow] = [&plan, &descended].map(|plan| cost(&material, &problem, plan));
    assert!(bound > 0, "{case}: the limits do not bind");
    assert!(gain < NEAR_ENOUGH_MM2, "{case}: {gain:e}");
    assert!(found < slow + NEAR_ENOUGH_MM2, "{case}: {found:e} {slow:e}");
}

#[test]
fn no_plan_within_the_limits_costs_less() {
    for most_mm_s2 in [100.0, 300.0, 1000.0, 3000.0, 10_000.0, 30_000.0] {
        the_plan_within_limits_is_the_best::<2>(most_mm_s2);
        the_plan_within_limits_is_the_best::<3>(most_mm_s2);
    }
}
