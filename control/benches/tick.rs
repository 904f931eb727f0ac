//! Times of what runs in the servo thread: `cargo bench -p feedwright-control`. The figures to look at are medians.

#![expect(clippy::unwrap_used, reason = "a bench may stop")]

mod rig;

use divan::{Bencher, black_box};
use feedwright_control::contour_error::{ContourError, Estimator};
use feedwright_control::window::Register;
use feedwright_control::{Knot, Measured, Reference, Window};

fn main() {
    divan::main();
}

/// A register filled by the circle, the window at its end, and the tool that lags behind.
fn surroundings<const N: usize>() -> (Register<N>, [Knot<N>; 2], Measured<N>) {
    let mut register = Register::default();
    for i in 0..300 {
        register.push(rig::Circle.knot(f64::from(i) * 0.001));
    }
    let preview = [rig::Circle.knot(0.299), rig::Circle.knot(0.309)];
    let mut tool: Knot<N> = rig::Circle.knot(0.279);
    tool.position_mm[0] += 0.02;
    let contour = Estimator::default().estimate(&register, tool.position_mm);
    (register, preview, Measured { position_mm: tool.position_mm, contour })
}

/// Five inversion steps and one back-propagation.
#[divan::bench(consts = [2, 3])]
fn paper_tick<const N: usize>(bencher: Bencher<'_, '_>) {
    let (register, preview, measured) = surroundings::<N>();
    let mut controller = rig::paper();
    bencher.bench_local(|| {
        let window = Window { register: &register, preview: &preview, feed_period_s: 0.01, offset_mm: [0.0; N] };
        rig::decide(&mut controller, black_box(&window), black_box(&measured))
    });
}

#[divan::bench(consts = [2, 3])]
fn contour_error<const N: usize>(bencher: Bencher<'_, '_>) {
    let (register, _, measured) = surroundings::<N>();
    let mut estimator = Estimator::default();
    let mut last = ContourError::NONE;
    bencher.bench_local(|| {
        last = estimator.estimate(black_box(&register), black_box(measured.position_mm));
        last.entries
    });
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
    let error: [f64; N] = inputs.iter().map(|axis| axis[0]).collect::<Vec<_>>().try_into().unwrap();
    bencher.bench_local(|| net.learn(black_box(&inputs), black_box(error), 0.01));
}

/// A servo period of the whole: reference, register, and in every tenth the contour error and the decision.
#[divan::bench(consts = [2, 3])]
fn servo_period<const N: usize>(bencher: Bencher<'_, '_>) {
    let mut rig = rig::Rig::<N>::new();
    bencher.bench_local(|| rig.servo_period());
}
