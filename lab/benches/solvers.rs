//! Solvers of the receding horizon side by side, on the problem of one tick: `just solvers`. The figures to look at are
//! medians.
//!
//! First what is exact must agree. Then the times: rolling the plan out, with and without what the tool feels of every
//! acceleration, which the recursion of Riccati does not ask for; and solving, without limits and within tight ones.

mod solvers {
    pub(crate) mod material;
    pub(crate) mod model;
    pub(crate) mod riccati;
}

use divan::{Bencher, black_box};
use feedwright_lab::{GaussNewton, HorizonProblem, Solver};
use solvers::material::Material;
use solvers::riccati::{AGREEMENT, Riccati, apart_from_gauss_newton};

/// Knots of the horizon.
const KNOTS: usize = 20;
/// Tight limits of the acceleration of the offset, mm/s^2.
const TIGHT_MM_S2: f64 = 200.0;

fn main() {
    agree::<2>();
    agree::<3>();
    divan::main();
}

/// Stops where the exact solvers differ.
fn agree<const N: usize>() {
    let apart = apart_from_gauss_newton(&Material::<N>::new(KNOTS));
    assert!(apart < AGREEMENT, "Riccati and Gauss-Newton differ by {apart:e}");
    println!("{N} axes, {KNOTS} knots: Riccati and Gauss-Newton agree to {apart:.0e}");
}

/// Rolling the plan out, with the derivative to all accelerations.
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

/// Limits that bind in most knots: every iteration takes one more factorisation.
#[divan::bench(consts = [2, 3])]
fn solve_gauss_newton_within_limits<const N: usize>(bencher: Bencher<'_, '_>) {
    improve(bencher, &mut GaussNewton::default(), &Material::<N>::within(KNOTS, TIGHT_MM_S2));
}

#[divan::bench(consts = [2, 3])]
fn solve_riccati<const N: usize>(bencher: Bencher<'_, '_>) {
    let material = Material::<N>::new(KNOTS);
    let (problem, slopes) = material.roll_out(true);
    let mut riccati = Riccati::default();
    bencher.bench_local(|| riccati.solve(black_box(&problem), black_box(&slopes), black_box(&material.plan)));
}

fn improve<const N: usize>(bencher: Bencher<'_, '_>, solver: &mut impl Solver<N>, material: &Material<N>) {
    let (problem, _): (HorizonProblem<N>, _) = material.roll_out(true);
    bencher.bench_local(|| {
        let mut plan = *black_box(&material.plan);
        solver.improve(black_box(&problem), &mut plan);
        plan
    });
}
