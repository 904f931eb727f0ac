//! Benchmarks of the code that runs in the servo thread: `cargo bench -p feedwright-lab --bench
//! tick`. The medians are the figures to read.

#![expect(clippy::unwrap_used, reason = "a bench may stop")]

mod rig;

use divan::{Bencher, black_box};
use feedwright_control::{ContourModel, Estimator};

fn main() {
    divan::main();
}

/// Five inversion steps and one back-propagation.
#[divan::bench(consts = [2, 3])]
fn paper_tick<const N: usize>(bencher: Bencher<'_, '_>) {
    let surroundings = rig::Surroundings::<N>::new();
    let (window, measured) = (surroundings.window(), surroundings.measured());
    let mut controller = rig::paper();
    bencher.bench_local(|| rig::decide(&mut controller, black_box(&window), black_box(&measured)));
}

/// Kalman filter, regulator and inverse of each axis; with `gives`, also for a ball screw with
/// backlash.
#[divan::bench(consts = [2, 3], args = [false, true])]
fn regulator_tick<const N: usize>(bencher: Bencher<'_, '_>, gives: bool) {
    let surroundings = rig::Surroundings::<N>::new();
    let (window, measured) = (surroundings.window(), surroundings.measured());
    let mut controller = rig::regulator(gives);
    bencher.bench_local(|| rig::decide(&mut controller, black_box(&window), black_box(&measured)));
}

#[divan::bench(consts = [2, 3])]
fn contour_error<const N: usize>(bencher: Bencher<'_, '_>) {
    let surroundings = rig::Surroundings::<N>::new();
    let window = surroundings.window();
    let mut estimator = Estimator::default();
    bencher.bench_local(|| estimator.estimate(black_box(&window), black_box(surroundings.tool_mm)));
}

#[divan::bench(consts = [2, 3])]
fn forward<const N: usize>(bencher: Bencher<'_, '_>) {
    let (net, inputs) = rig::network::<N>();
    bencher.bench_local(|| net.predict(black_box(&inputs)));
}

#[divan::bench(consts = [2, 3])]
fn forward_and_jacobian<const N: usize>(bencher: Bencher<'_, '_>) {
    let (net, inputs) = rig::network::<N>();
    bencher.bench_local(|| net.jacobian(&net.predict(black_box(&inputs))));
}

#[divan::bench(consts = [2, 3])]
fn back_propagation<const N: usize>(bencher: Bencher<'_, '_>) {
    let (mut net, inputs) = rig::network::<N>();
    let error: [f64; N] = inputs
        .iter()
        .map(|axis| axis[0])
        .collect::<Vec<_>>()
        .try_into()
        .unwrap();
    bencher.bench_local(|| net.learn(black_box(&inputs), black_box(error), 0.01));
}

/// One servo period of the whole loop: reference and register, and in every tenth servo period the
/// contour error and the decision. The mean over whole feed periods.
#[divan::bench(consts = [2, 3], sample_size = 1000)]
fn servo_period<const N: usize>(bencher: Bencher<'_, '_>) {
    let mut rig = rig::Rig::<N, _>::new(rig::paper(), rig::Tool::OnThePath);
    bencher.bench_local(|| rig.servo_period());
    rig.expect_in_the_loop();
}

/// The same with the regulator, which decides in every servo period.
#[divan::bench(consts = [2, 3], args = [false, true], sample_size = 1000)]
fn servo_period_of_regulator<const N: usize>(bencher: Bencher<'_, '_>, gives: bool) {
    let mut rig = rig::Rig::<N, _>::new(rig::regulator(gives), rig::Tool::Follows);
    bencher.bench_local(|| rig.servo_period());
    rig.expect_in_the_loop();
}
