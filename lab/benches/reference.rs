//! Cost of the reference in a servo period, and speed of planning.

#[expect(dead_code, reason = "the benches use a part")]
#[path = "../../crates/plan/tests/common/programs.rs"]
mod common;

use common::{BLEND, LIMITS, Random, line};
use divan::Bencher;
use divan::counter::ItemsCount;
use feedwright_gcode::canon::{AuxiliaryAxes, Canon, Motion, MotionKind, Shape, Spline};
use feedwright_lab::contour;
use feedwright_sim::Reference;
use std::sync::Arc;

fn main() {
    divan::main();
}

const NAMES: [&str; 6] = [
    "line",
    "circle",
    "ellipse",
    "star",
    "spline",
    "10 um chords",
];

/// Returns chords of 10 um along a gentle wave.
fn chords(count: u32) -> impl Iterator<Item = Canon> + Send {
    let at = |i: u32| [0.01 * f64::from(i), (0.01 * f64::from(i)).sin(), 0.0];
    (0..count).map(move |i| line(at(i), at(i + 1), 50.0, BLEND))
}

/// Returns a cubic spline through a wave of 5 mm, 100 mm long.
fn wave() -> Canon {
    const POINTS: usize = 40;
    let control_mm: Vec<[f64; 3]> = (0..POINTS)
        .map(|i| i as f64)
        .map(|i| [2.5 * i, 5.0 * (0.5 * i).sin(), 0.0])
        .collect();
    let knots = (0..POINTS + 4)
        .map(|i| (i.clamp(3, POINTS) - 3) as f64)
        .collect();
    Canon::Motion(Motion {
        line: 1,
        kind: MotionKind::Feed,
        start_mm: control_mm[0],
        end_mm: control_mm[POINTS - 1],
        shape: Shape::Spline(Arc::new(Spline {
            degree: 3,
            knots,
            control_mm,
            weights: vec![1.0; POINTS],
        })),
        feed_mm_s: 50.0,
        corner: BLEND,
        others: AuxiliaryAxes::default(),
    })
}

fn reference(name: &str) -> Reference<'static> {
    let reference = match name {
        "line" => Reference::of_program(
            vec![line([0.0; 3], [100.0, 50.0, 0.0], 50.0, BLEND)],
            &LIMITS,
        ),
        "spline" => Reference::of_program([wave()], &LIMITS),
        "10 um chords" => Reference::of_program(chords(10_000), &LIMITS),
        _ => Reference::of_steps(
            contour(name)
                .expect("a name of the table")
                .steps(50.0, BLEND)
                .expect("a feed"),
            &LIMITS,
        ),
    };
    reference.expect("limits are sound")
}

/// 1,000 servo periods with three reads each: at the present time and up to 50 ms ahead.
#[divan::bench(args = NAMES)]
fn at(bencher: Bencher<'_, '_>, name: &str) {
    let mut reference = reference(name);
    reference.read_to_end_s();
    bencher.counter(ItemsCount::new(3000usize)).bench_local(|| {
        let mut sum = 0.0;
        for i in 0..1000 {
            let tau_s = 0.5 + 5e-4 * f64::from(i);
            for ahead_s in [0.0, 0.01, 0.05] {
                sum += reference.at(tau_s + ahead_s).position_mm[0];
            }
        }
        sum
    });
}

/// 1,000 servo periods: nearest point, within 50 ms before and after, to a point up to 20 um off
/// the path.
#[divan::bench(args = NAMES)]
fn nearest(bencher: Bencher<'_, '_>, name: &str) {
    let mut reference = reference(name);
    reference.read_to_end_s();
    let mut random = Random(1);
    let points: Vec<(f64, [f64; 3])> = (0..1000)
        .map(|i| 0.5 + 5e-4 * f64::from(i))
        .map(|tau_s| {
            // A drive lags by about 20 ms.
            let here = reference.at(tau_s - 0.02).position_mm;
            (tau_s, here.map(|x| x + random.between(-0.02, 0.02)))
        })
        .collect();
    bencher.counter(ItemsCount::new(1000usize)).bench_local(|| {
        points
            .iter()
            .map(|&(tau_s, point)| {
                reference
                    .nearest(point, tau_s - 0.05, tau_s + 0.05)
                    .distance_mm
            })
            .sum::<f64>()
    });
}

/// Reads and plans in steps of 10 ms, and forgets the path behind.
#[divan::bench(args = [1_000, 10_000, 100_000])]
fn plan_chords(bencher: Bencher<'_, '_>, count: u32) {
    bencher.counter(ItemsCount::new(count)).bench_local(|| {
        let mut reference =
            Reference::of_program(chords(count), &LIMITS).expect("limits are sound");
        let mut tau_s = 0.0;
        while reference.end_s().is_none() {
            reference.at(tau_s);
            reference.forget_before(tau_s - 0.1);
            tau_s += 1e-2;
        }
        tau_s
    });
}

/// Computes the tables of arc length and the sections of a smooth curve.
#[divan::bench(args = ["ellipse", "eight", "star", "spline"])]
fn plan_contour(name: &str) -> f64 {
    reference(name).read_to_end_s()
}
