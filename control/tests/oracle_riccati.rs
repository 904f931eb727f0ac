//! The dense solution of a tick against another way to solve the same problem: a recursion over time that shares no code
//! with it, not even the derivative of the tool to the rates.

#[path = "../benches/solvers"]
mod solvers {
    pub(crate) mod material;
    pub(crate) mod model;
    pub(crate) mod riccati;
}

use feedwright_control::horizon::gauss_newton::GaussNewton;
use feedwright_control::horizon::gradient::Gradient;
use solvers::material::{Material, difference};
use solvers::riccati::{AGREEMENT, apart_from_gauss_newton};

fn riccati_and_gauss_newton_agree<const N: usize>() {
    for knots in [1, 2, 3, 10, 20] {
        let material = Material::<N>::new(knots);
        let (problem, _) = material.roll_out(true);
        let exact = material.improved(&mut GaussNewton::default(), &problem);
        let apart = apart_from_gauss_newton(&material);
        assert!(apart < AGREEMENT, "{N} axes, {knots} knots: {apart:e}");
        assert!(difference(&exact, &material.rates) > 0.1, "the solution is not what it started from");
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
    let (problem, _) = material.roll_out(true);
    let exact = material.improved(&mut GaussNewton::default(), &problem);
    let least = material.cost(&problem, &exact);
    for knot in 0..problem.knots {
        for axis in 0..3 {
            for step in [-0.1, 0.1] {
                let mut beside = exact;
                beside[knot][axis] += step;
                assert!(material.cost(&problem, &beside) > least, "{knot} {axis} {step}");
            }
        }
    }
}

#[test]
fn the_gradient_comes_nearer_with_every_step_it_is_given() {
    let material = Material::<2>::new(20);
    let (problem, _) = material.roll_out(true);
    let costs = [
        material.cost(&problem, &material.rates),
        material.cost(&problem, &material.improved(&mut Gradient::<1>, &problem)),
        material.cost(&problem, &material.improved(&mut Gradient::<5>, &problem)),
        material.cost(&problem, &material.improved(&mut Gradient::<20>, &problem)),
        material.cost(&problem, &material.improved(&mut GaussNewton::default(), &problem)),
    ];
    assert!(costs.is_sorted_by(|more, less| more > less), "{costs:?}");
}
