//! Solvers of the receding horizon side by side, on the problem of one tick: `just solvers`. The figures to look at are
//! medians.
//!
//! First what is exact must agree, and how far the gradient gets in as many steps is said. Then the times: rolling the plan
//! out, with and without what the tool feels of every rate, which the recursion of Riccati does not ask for; and solving.

mod solvers {
    pub(crate) mod material;
    pub(crate) mod model;
    pub(crate) mod riccati;
}

use divan::{Bencher, black_box};
use feedwright_control::horizon::Solver;
use feedwright_control::horizon::gauss_newton::GaussNewton;
use feedwright_control::horizon::gradient::Gradient;
use feedwright_control::horizon::problem::Problem;
use solvers::material::Material;
use solvers::riccati::{AGREEMENT, Riccati, apart_from_gauss_newton};

/// Knots of the horizon.
const KNOTS: usize = 20;

fn main() {
    agree::<2>();
    agree::<3>();
    divan::main();
}

/// Stops where the exact solvers differ; says how far the gradient gets.
fn agree<const N: usize>() {
    let material = Material::<N>::new(KNOTS);
    let (problem, _) = material.roll_out(true);
    let exact = material.improved(&mut GaussNewton::default(), &problem);
    let apart = apart_from_gauss_newton(&material);
    assert!(apart < AGREEMENT, "Riccati and Gauss-Newton differ by {apart:e}");
    println!("{N} axes, {KNOTS} knots: Riccati and Gauss-Newton agree to {apart:.0e}");
    let [before, best] = [&material.rates, &exact].map(|rates| material.cost(&problem, rates));
    let left = |rates| 100.0 * (material.cost(&problem, &rates) - best) / (before - best);
    println!(
        "    of what they save, the gradient leaves {:.1} % after 1 step, {:.1} % after 5, {:.1} % after 20",
        left(material.improved(&mut Gradient::<1>, &problem)),
        left(material.improved(&mut Gradient::<5>, &problem)),
        left(material.improved(&mut Gradient::<20>, &problem)),
    );
}

/// Rolling the plan out, with the derivative to all rates.
#[divan::bench(consts = [2, 3])]
fn roll_out_dense<const N: usize>(bencher: Bencher<'_, '_>) {
    let material = Material::<N>::new(KNOTS);
    bencher.bench_local(|| black_box(&material).roll_out(true));
}

/// Rolling the plan out, with the slopes of each knot alone.
#[divan::bench(consts = [2, 3])]
fn roll_out_slopes<const N: usize>(bencher: Bencher<'_, '_>) {
    let material = Material::<N>::new(KNOTS);
    bencher.bench_local(|| black_box(&material).roll_out(false));
}

#[divan::bench(consts = [2, 3])]
fn solve_gauss_newton<const N: usize>(bencher: Bencher<'_, '_>) {
    improve(bencher, &mut GaussNewton::default(), &Material::<N>::new(KNOTS));
}

#[divan::bench(consts = [2, 3])]
fn solve_gradient_01<const N: usize>(bencher: Bencher<'_, '_>) {
    improve(bencher, &mut Gradient::<1>, &Material::<N>::new(KNOTS));
}

#[divan::bench(consts = [2, 3])]
fn solve_gradient_05<const N: usize>(bencher: Bencher<'_, '_>) {
    improve(bencher, &mut Gradient::<5>, &Material::<N>::new(KNOTS));
}

#[divan::bench(consts = [2, 3])]
fn solve_gradient_20<const N: usize>(bencher: Bencher<'_, '_>) {
    improve(bencher, &mut Gradient::<20>, &Material::<N>::new(KNOTS));
}

#[divan::bench(consts = [2, 3])]
fn solve_riccati<const N: usize>(bencher: Bencher<'_, '_>) {
    let material = Material::<N>::new(KNOTS);
    let (problem, slopes) = material.roll_out(true);
    let mut riccati = Riccati::default();
    bencher.bench_local(|| riccati.solve(black_box(&problem), black_box(&slopes), black_box(&material.rates)));
}

fn improve<const N: usize>(bencher: Bencher<'_, '_>, solver: &mut impl Solver<N>, material: &Material<N>) {
    let (problem, _): (Problem<N>, _) = material.roll_out(true);
    bencher.bench_local(|| {
        let mut rates = *black_box(&material.rates);
        solver.improve(black_box(&problem), &mut rates);
        rates
    });
}
