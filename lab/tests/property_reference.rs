//! The reference against brute force: nearest point over many pieces, order of calls, memory.

use crate::programs::{BLEND, LIMITS, Random, arc, distance, line, polyline};
use feedwright_gcode::canon::{Canon, Event, EventKind};
use feedwright_lab::CONTOURS;
use feedwright_sim::Reference;
use proptest::prelude::*;

/// Lines and arcs of very different lengths with corners of any angle, with events between.
fn program(seed: u64, count: usize, size_mm: f64) -> Vec<Canon> {
    let mut random = Random(seed);
    let mut here = [0.0; 3];
    let mut steps = Vec::new();
    for _ in 0..count {
        let size = size_mm * 10f64.powf(random.between(-2.0, 0.0));
        let end = [0, 1, 2].map(|k: usize| here[k] + random.between(-size, size));
        if random.next() < 0.6 {
            steps.push(line(here, end, 40.0, BLEND));
            here = end;
        } else {
            let center = [here[0] - size, here[1] + 0.3 * size, here[2]];
            let turns = if random.next() < 0.5 { 1 } else { -1 };
            steps.push(arc(here, here, center, turns, 40.0));
        }
        if random.next() < 0.1 {
            steps.push(Canon::Event(Event {
                line: 7,
                kind: EventKind::Dwell { seconds: 0.01 },
            }));
        }
    }
    steps
}

fn check_nearest(reference: &mut Reference<'_>, random: &mut Random, span_s: f64, away_mm: f64) {
    const SAMPLES: usize = 4000;
    let end_s = reference.read_to_end_s();
    let lo = random.between(0.0, end_s);
    let hi = lo + random.between(0.0, span_s.min(end_s - lo));
    let mut point = reference.at(random.between(lo, hi)).position_mm;
    for value in &mut point {
        *value += random.between(-away_mm, away_mm);
    }
    let foot = reference.nearest(point, lo, hi);
    assert!((distance(foot.position_mm, point) - foot.distance_mm).abs() < 1e-12);
    assert!(foot.signed_mm.abs() == foot.distance_mm);
    let (s_lo, s_hi) = (reference.at(lo).s_mm, reference.at(hi).s_mm);
    assert!(
        foot.s_mm >= s_lo - 1e-12 && foot.s_mm <= s_hi + 1e-12,
        "{s_lo} {} {s_hi}",
        foot.s_mm
    );
    let brute = (0..=SAMPLES)
        .map(|i| {
            distance(
                reference
                    .at(lo + (hi - lo) * i as f64 / SAMPLES as f64)
                    .position_mm,
                point,
            )
        })
        .fold(f64::INFINITY, f64::min);
    // At no more than 50 mm/s, a sample is at most half a step from the foot.
    let step = 0.5 * 50.0 * (hi - lo) / SAMPLES as f64;
    assert!(
        foot.distance_mm <= brute + 1e-12,
        "{} {brute}",
        foot.distance_mm
    );
    assert!(
        brute <= foot.distance_mm + step + 1e-12,
        "{} {brute} {step}",
        foot.distance_mm
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn nearest_over_pieces_is_the_nearest(seed in 1u64..u64::MAX, size in prop::sample::select(vec![0.01, 0.3, 5.0])) {
        let mut random = Random(seed);
        let mut reference = Reference::of_program(program(seed, 120, size), &LIMITS).unwrap();
        for span_s in [0.02, 0.2, 5.0] {
            for away_mm in [1e-3, 0.03, 1.0] {
                check_nearest(&mut reference, &mut random, span_s, away_mm);
            }
        }
    }

    #[test]
    fn order_of_calls_does_not_matter(seed in 1u64..u64::MAX) {
        let mut random = Random(seed);
        let times: Vec<f64> = (0..300).map(|_| random.between(-0.1, 12.0)).collect();
        let mut all = Reference::of_program(program(seed, 60, 3.0), &LIMITS).unwrap();
        all.read_to_end_s();
        let mut lazy = Reference::of_program(program(seed, 60, 3.0), &LIMITS).unwrap();
        for &tau in &times {
            prop_assert_eq!(all.at(tau), lazy.at(tau));
        }
        let mut once = Reference::of_program(program(seed, 60, 3.0), &LIMITS).unwrap();
        prop_assert_eq!(once.at(times[0]), all.at(times[0]));
        for tau in times {
            let point = [random.next(), random.next(), 0.0];
            let mut fresh = Reference::of_program(program(seed, 60, 3.0), &LIMITS).unwrap();
            prop_assert_eq!(fresh.nearest(point, tau, tau + 0.1), all.nearest(point, tau, tau + 0.1));
            if tau > 11.0 { break; }
        }
    }
}

#[test]
fn nearest_on_contours() {
    let mut random = Random(3);
    for contour in CONTOURS {
        let mut reference =
            Reference::of_steps(contour.steps(50.0, BLEND).unwrap(), &LIMITS).unwrap();
        for _ in 0..50 {
            check_nearest(&mut reference, &mut random, 0.1, 0.03);
            check_nearest(&mut reference, &mut random, 10.0, 5.0);
        }
    }
}

#[test]
fn sign_is_left_of_travel() {
    let mut reference =
        Reference::of_program(vec![line([0.0; 3], [10.0, 0.0, 0.0], 10.0, BLEND)], &LIMITS)
            .unwrap();
    assert_eq!(reference.nearest([5.0, 0.5, 0.0], 0.0, 2.0).signed_mm, 0.5);
    assert_eq!(
        reference.nearest([5.0, -0.5, 0.0], 0.0, 2.0).signed_mm,
        -0.5
    );
    // Clockwise circle of the paper: its inside is on the right.
    let mut reference =
        Reference::of_steps(CONTOURS[0].steps(50.0, BLEND).unwrap(), &LIMITS).unwrap();
    assert!(reference.nearest([10.0, 9.9, 0.0], 0.0, 2.0).signed_mm < 0.0);
}

#[test]
fn before_the_start_is_the_start() {
    for tau in [-1.0, f64::NAN, f64::NEG_INFINITY] {
        let mut reference = Reference::of_program(program(5, 10, 3.0), &LIMITS).unwrap();
        let first = reference.at(tau);
        assert_eq!(first, reference.at(0.0));
        assert!(first.cutting && !first.resting);
        let mut reference = Reference::of_program(program(5, 10, 3.0), &LIMITS).unwrap();
        assert_eq!(reference.nearest([0.1, 0.0, 0.0], tau, tau).s_mm, 0.0);
    }
}

/// Chords of a wavy line, endless in effect.
fn tiny_segments(count: u32) -> impl Iterator<Item = Canon> + Send {
    let at = |i: u32| [0.002 * f64::from(i), (0.002 * f64::from(i)).sin(), 0.0];
    (0..count).map(move |i| line(at(i), at(i + 1), 50.0, BLEND))
}

#[test]
fn memory_does_not_grow_with_the_program() {
    let mut reference = Reference::of_program(tiny_segments(100_000), &LIMITS).unwrap();
    let mut most = (0, 0);
    let mut tau = 0.0;
    let mut s_mm = 0.0;
    while reference.end_s().is_none_or(|end_s| tau < end_s) {
        let here = reference.at(tau);
        assert!(here.s_mm >= s_mm);
        s_mm = here.s_mm;
        reference.at(tau + 0.1);
        reference.forget_before(tau - 0.1);
        most = (
            most.0.max(reference.kept().0),
            most.1.max(reference.kept().1),
        );
        tau += 1e-3;
    }
    // 12.5 mm to stop from 50 mm/s: 6250 blocks of 2 um; twice that between passes; the window is
    // 0.3 s or 7500 blocks.
    assert!(most.0 < 30_000 && most.1 < 30_000, "{most:?}");
    let at_end = reference.at(tau).position_mm;
    assert!(distance(at_end, [200.0, 200.0f64.sin(), 0.0]) < 1e-9);
}

#[test]
fn forgetting_changes_nothing_that_is_kept() {
    let program = program(99, 400, 2.0);
    let mut all = Reference::of_program(program.clone(), &LIMITS).unwrap();
    let end_s = all.read_to_end_s();
    let mut forgetful = Reference::of_program(program, &LIMITS).unwrap();
    let mut tau = 0.0;
    while tau < end_s {
        forgetful.forget_before(tau - 0.05);
        assert_eq!(forgetful.at(tau), all.at(tau));
        let point = [0.3, 0.1, 0.0];
        assert_eq!(
            forgetful.nearest(point, tau - 0.05, tau),
            all.nearest(point, tau - 0.05, tau)
        );
        tau += 0.013;
    }
}

#[test]
fn a_polyline_of_one_point_has_no_length() {
    let mut reference = Reference::of_program(
        polyline(&[[1.0, 2.0, 3.0], [1.0, 2.0, 3.0]], 10.0, BLEND),
        &LIMITS,
    )
    .unwrap();
    assert_eq!(reference.read_to_end_s(), 0.0);
    assert_eq!(reference.at(0.0).s_mm, 0.0);
}
