//! Plans keep every limit, and bounded look-ahead gives what unlimited look-ahead gives.

use crate::programs::{BLEND, LIMITS, Random, arc, distance, line, polyline};
use feedwright_gcode::canon::{Canon, Corner};
use feedwright_lab::CONTOURS;
use feedwright_plan::{PathLimits, Piece, Pieces, Section, SectionPlanner, Span, Step, Trapezoid};
use feedwright_sim::Reference;
use proptest::prelude::*;

/// Rounding of a speed squared of order 1e4 mm2/s2.
const ROUNDING: f64 = 1e-9;

fn random_sections(seed: u64, count: usize) -> Vec<Section> {
    let mut random = Random(seed);
    let mut cap = 100.0;
    (0..count)
        .map(|i| {
            // Sections from 1 um to 30 mm, bounds that are flat, that ramp, and that jump.
            let length_mm = 10f64.powf(random.between(-3.0, 1.5));
            let start_cap = if random.next() < 0.7 {
                cap
            } else {
                10f64.powf(random.between(0.0, 4.0))
            };
            let end_cap = if random.next() < 0.5 {
                start_cap
            } else {
                10f64.powf(random.between(0.0, 4.0))
            };
            cap = end_cap;
            let joint_cap = match random.next() {
                r if r < 0.05 => 0.0,
                r if r < 0.2 => 10f64.powf(random.between(-2.0, 4.0)),
                _ => f64::INFINITY,
            };
            Section {
                piece: i as u64,
                from_mm: 0.0,
                length_mm,
                joint_cap,
                start_cap,
                end_cap,
            }
        })
        .collect()
}

fn plan(mut planner: Trapezoid, sections: &[Section]) -> Vec<Span> {
    let mut spans = Vec::new();
    for section in sections {
        planner.push(*section);
        while let Some(span) = planner.pop() {
            spans.push(span);
        }
    }
    planner.finish();
    while let Some(span) = planner.pop() {
        spans.push(span);
    }
    spans
}

/// Squares of the speeds at the joints with unlimited look-ahead, straight from the equations.
fn joints(sections: &[Section], accel: f64) -> Vec<f64> {
    let count = sections.len();
    let cap = |i: usize| match i {
        0 => 0.0,
        i if i == count => 0.0,
        i => sections[i]
            .joint_cap
            .min(sections[i].start_cap)
            .min(sections[i - 1].end_cap),
    };
    let mut forward = vec![0.0; count + 1];
    for i in 1..=count {
        forward[i] = cap(i).min(forward[i - 1] + 2.0 * accel * sections[i - 1].length_mm);
    }
    let mut joints = vec![0.0; count + 1];
    let mut backward = 0.0;
    for i in (0..count).rev() {
        backward = cap(i).min(backward + 2.0 * accel * sections[i].length_mm);
        joints[i] = forward[i].min(backward);
    }
    joints
}

fn check_limits(spans: &[Span], sections: &[Section], accel: f64) {
    let mut speed: f64 = 0.0;
    let mut place = (0, 0.0);
    for span in spans {
        let section = &sections[span.piece as usize];
        assert!(
            (span.speed_mm_s.powi(2) - speed.powi(2)).abs() <= ROUNDING,
            "speed jumps: {speed} {span:?}"
        );
        assert!(span.accel_mm_s2.abs() <= accel * (1.0 + 1e-12), "{span:?}");
        if place.0 == span.piece {
            assert!(
                (span.from_mm - place.1).abs() < 1e-9,
                "gap: {place:?} {span:?}"
            );
        } else {
            assert!(span.piece == place.0 + 1 && span.from_mm.abs() < 1e-9);
        }
        for i in 0..=4 {
            let t = span.duration_s * f64::from(i) / 4.0;
            let at = span.from_mm + t * (span.speed_mm_s + 0.5 * span.accel_mm_s2 * t);
            let cap =
                section.start_cap + (section.end_cap - section.start_cap) * at / section.length_mm;
            let square = (span.speed_mm_s + span.accel_mm_s2 * t).powi(2);
            let slack =
                ROUNDING + 1e-12 * (section.end_cap - section.start_cap).abs() / section.length_mm;
            assert!(
                square <= cap + slack,
                "{square} > {cap}: {span:?} {section:?}"
            );
        }
        speed = (span.speed_mm_s + span.accel_mm_s2 * span.duration_s).max(0.0);
        let t = span.duration_s;
        place = (
            span.piece,
            span.from_mm + t * (span.speed_mm_s + 0.5 * span.accel_mm_s2 * t),
        );
    }
    assert!(speed.powi(2) < ROUNDING, "ends at rest: {speed}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn limits_hold_and_look_ahead_does_not_matter(seed in 1u64..u64::MAX, count in 1usize..2000) {
        let accel = LIMITS.tangential_accel_mm_s2;
        let sections = random_sections(seed, count);
        let spans = plan(Trapezoid::new(accel), &sections);
        check_limits(&spans, &sections, accel);
        let joints = joints(&sections, accel);
        let mut last = u64::MAX;
        for span in &spans {
            if span.piece != last {
                // The same bits as with unlimited look-ahead.
                prop_assert_eq!(span.speed_mm_s, joints[span.piece as usize].sqrt());
            }
            last = span.piece;
        }
    }

    #[test]
    fn a_full_look_ahead_is_safe_and_slower(seed in 1u64..u64::MAX, bound in 2usize..40) {
        let accel = LIMITS.tangential_accel_mm_s2;
        let sections = random_sections(seed, 500);
        let time = |spans: &[Span]| spans.iter().map(|span| span.duration_s).sum::<f64>();
        let short = plan(Trapezoid::with_max_waiting(accel, bound), &sections);
        check_limits(&short, &sections, accel);
        let far = plan(Trapezoid::new(accel), &sections);
        prop_assert!(time(&short) >= time(&far) * (1.0 - 1e-12));
    }
}

fn random_program(seed: u64, count: usize, corner: Corner) -> Vec<Canon> {
    let mut random = Random(seed);
    let mut here = [0.0; 3];
    let mut motions = Vec::new();
    for _ in 0..count {
        let size = 10f64.powf(random.between(-2.0, 1.0));
        let feed = random.between(5.0, 80.0);
        let end = [0, 1, 2].map(|k: usize| here[k] + random.between(-size, size));
        if random.next() < 0.5 {
            motions.push(line(here, end, feed, corner));
            here = end;
        } else {
            let center = [here[0] + size, here[1] - 0.5 * size, here[2]];
            let angle = random.between(0.1, 6.0);
            let from = [here[0] - center[0], here[1] - center[1]];
            let end = [
                center[0] + from[0] * angle.cos() - from[1] * angle.sin(),
                center[1] + from[0] * angle.sin() + from[1] * angle.cos(),
                here[2] + 0.1 * size,
            ];
            motions.push(arc(here, end, center, 1, feed));
            here = end;
        }
    }
    motions
}

/// Speed, curvature limit and feed at many times of a whole program.
fn check_program(reference: &mut Reference<'_>, pieces: &[Piece], limits: &PathLimits) {
    let end_s = reference.read_to_end_s();
    let steps = 20_000;
    let dt = end_s / f64::from(steps);
    let mut before = reference.at(0.0);
    for i in 1..=steps {
        let here = reference.at(dt * f64::from(i));
        let piece = &pieces[pieces
            .partition_point(|piece| piece.s_mm <= here.s_mm)
            .max(1)
            - 1];
        assert!(here.feed_mm_s <= piece.feed_mm_s.min(limits.max_feed_mm_s) * (1.0 + 1e-12));
        let curvature = piece.curve.curvature(here.s_mm - piece.s_mm);
        let normal = here.feed_mm_s.powi(2) * curvature;
        assert!(
            normal <= limits.normal_accel_mm_s2 * 1.001,
            "{normal} at {}",
            here.s_mm
        );
        let change = (here.feed_mm_s - before.feed_mm_s).abs();
        assert!(
            change <= limits.tangential_accel_mm_s2 * dt * (1.0 + 1e-9) + 1e-9,
            "{change} at {}",
            here.s_mm
        );
        let way = here.s_mm - before.s_mm;
        assert!(
            (way - 0.5 * dt * (here.feed_mm_s + before.feed_mm_s)).abs()
                <= 0.25 * 200.0 * dt * dt + 1e-9
        );
        before = here;
    }
}

fn pieces_of(steps: &[Step]) -> Vec<Piece> {
    let piece = |step: &Step| match step {
        Step::Piece(piece) => Some(piece.clone()),
        _ => None,
    };
    steps.iter().filter_map(piece).collect()
}

#[test]
fn programs_keep_every_limit() {
    for (seed, corner) in [
        (11, BLEND),
        (12, Corner::ExactPath),
        (13, Corner::ExactStop),
        (14, BLEND),
    ] {
        let program = random_program(seed, 200, corner);
        let steps: Vec<Step> = Pieces::new(program.into_iter())
            .map(Result::unwrap)
            .collect();
        let pieces = pieces_of(&steps);
        check_program(
            &mut Reference::of_steps(steps, &LIMITS).unwrap(),
            &pieces,
            &LIMITS,
        );
    }
}

#[test]
fn contours_keep_every_limit_and_waste_no_time() {
    for contour in CONTOURS {
        for feed in [20.0, 50.0, 150.0] {
            let steps = contour.steps(feed, BLEND).unwrap();
            let pieces = pieces_of(&steps);
            let mut reference = Reference::of_steps(steps, &LIMITS).unwrap();
            check_program(&mut reference, &pieces, &LIMITS);
            // Against the same equations on a fine uniform grid of the exact bound.
            if pieces.len() == 1 {
                let grid = 100_000;
                let step = pieces[0].length_mm / f64::from(grid);
                let bound = |i: i32| {
                    let curvature = pieces[0].curve.curvature(step * f64::from(i));
                    (feed * feed).min(LIMITS.normal_accel_mm_s2 / curvature)
                };
                let fine: Vec<Section> = (0..grid)
                    .map(|i| Section {
                        piece: 0,
                        from_mm: 0.0,
                        length_mm: step,
                        joint_cap: f64::INFINITY,
                        start_cap: bound(i),
                        end_cap: bound(i + 1),
                    })
                    .collect();
                let best: f64 = plan(Trapezoid::new(100.0), &fine)
                    .iter()
                    .map(|span| span.duration_s)
                    .sum();
                let time = reference.read_to_end_s();
                assert!(
                    (time / best - 1.0).abs() < 2e-3,
                    "{} at {feed}: {time} {best}",
                    contour.name
                );
            }
        }
    }
}

/// Average acceleration of the tool over a time that is short against the corner, on a circle
/// hidden in chords.
#[test]
fn chords_of_a_curve_do_not_escape_the_normal_limit() {
    let mut random = Random(5);
    let mut angle: f64 = 0.0;
    let mut points = Vec::new();
    while angle < 20.0 {
        points.push([2.0 * angle.cos(), 2.0 * angle.sin(), 0.0]);
        angle += random.between(0.002, 0.006);
    }
    let mut reference = Reference::of_program(polyline(&points, 80.0, BLEND), &LIMITS).unwrap();
    let end_s = reference.read_to_end_s();
    // sqrt(400 * 2) = 28.3 mm/s.
    let window_s = 2e-3;
    let mut tau = 0.5;
    let mut fastest: f64 = 0.0;
    while tau < end_s - 0.5 {
        let at = |reference: &mut Reference<'_>, tau| reference.at(tau).position_mm;
        let (a, b, c) = (
            at(&mut reference, tau - window_s),
            at(&mut reference, tau),
            at(&mut reference, tau + window_s),
        );
        let accel =
            distance([0, 1, 2].map(|k| a[k] + c[k] - 2.0 * b[k]), [0.0; 3]) / (window_s * window_s);
        // The window sees three to ten joints, so single joints show by some percent.
        assert!(accel < 400.0 * 1.25, "{accel} at {tau}");
        fastest = fastest.max(reference.at(tau).feed_mm_s);
        tau += 1.37e-3;
    }
    assert!((fastest / 800f64.sqrt() - 1.0).abs() < 0.05, "{fastest}");
}
