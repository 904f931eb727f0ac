//! Curves against brute force: arc length, tangent, curvature, nearest point.

use crate::programs::{BLEND, Random, distance};
use feedwright_gcode::canon::{AuxiliaryAxes, Canon, Motion, MotionKind, Plane, Shape};
use feedwright_lab::{CONTOURS, contour};
use feedwright_plan::{Curve, Piece, Pieces, Step};
use proptest::prelude::*;

fn pieces(canon: Vec<Canon>) -> Vec<Piece> {
    steps(Pieces::new(canon.into_iter()).map(Result::unwrap).collect())
}

fn steps(steps: Vec<Step>) -> Vec<Piece> {
    let piece = |step| match step {
        Step::Piece(piece) => piece,
        other => panic!("{other:?}"),
    };
    steps.into_iter().map(piece).collect()
}

fn arc(plane: Plane, radius: f64, from: f64, sweep: f64, rise: f64, turns: i32) -> Piece {
    let [first, second, normal] = plane.axes();
    let center = [5.0, -3.0, 2.0];
    let at = |angle: f64, rise: f64| {
        let mut point = center;
        point[first] += radius * angle.cos();
        point[second] += radius * angle.sin();
        point[normal] += rise;
        point
    };
    let sense = f64::from(turns).signum();
    let motion = Motion {
        line: 1,
        kind: MotionKind::Feed,
        start_mm: at(from, 0.0),
        end_mm: at(from + sense * sweep, rise),
        shape: Shape::Arc {
            plane,
            center_mm: center,
            turns,
        },
        feed_mm_s: 10.0,
        corner: BLEND,
        others: AuxiliaryAxes::default(),
    };
    let mut pieces = pieces(vec![Canon::Motion(motion)]);
    assert_eq!(pieces.len(), 1, "radii are equal to rounding");
    pieces.remove(0)
}

/// Distance of the nearest of many samples between the bounds, refined by golden section.
fn brute_force(curve: &Curve, point: [f64; 3], lo: f64, hi: f64) -> f64 {
    const SAMPLES: usize = 2000;
    let at = |s: f64| distance(curve.at(s).position_mm, point);
    let sample = |i: usize| lo + (hi - lo) * i as f64 / SAMPLES as f64;
    let best = (0..=SAMPLES)
        .min_by(|&i, &j| at(sample(i)).total_cmp(&at(sample(j))))
        .expect("there are samples");
    let (mut a, mut b) = (
        sample(best.saturating_sub(1)),
        sample((best + 1).min(SAMPLES)),
    );
    let ratio = 0.5 * (5.0f64.sqrt() - 1.0);
    while b - a > 1e-9 {
        let (c, d) = (b - ratio * (b - a), a + ratio * (b - a));
        if at(c) < at(d) { b = d } else { a = c }
    }
    at(0.5 * (a + b)).min(at(sample(best)))
}

fn check_curve(curve: &Curve, random: &mut Random) {
    let length = curve.length_mm();
    let h = 1e-4 * length.min(1.0);
    for _ in 0..20 {
        let s = random.between(h, length - h);
        let (before, here, after) = (curve.at(s - h), curve.at(s), curve.at(s + h));
        // Central differences: error of the order of h^2 times the derivative of the curvature.
        for k in 0..3 {
            let slope = (after.position_mm[k] - before.position_mm[k]) / (2.0 * h);
            assert!(
                (slope - here.tangent[k]).abs() < 1e-5,
                "{s} {slope} {:?}",
                here.tangent
            );
        }
        let turn = distance(after.tangent, before.tangent) / (2.0 * h);
        assert!(
            (turn - curve.curvature(s)).abs() < 1e-4 * (1.0 + turn),
            "{s} {turn} {}",
            curve.curvature(s)
        );
        let derivatives = curve.derivatives(s);
        assert!(
            distance(derivatives.first, here.tangent) < 1e-14,
            "{s} {derivatives:?} {here:?}"
        );
        for k in 0..3 {
            let bend = (after.tangent[k] - before.tangent[k]) / (2.0 * h);
            assert!(
                (bend - derivatives.second_1_mm[k]).abs() < 1e-4 * (1.0 + turn),
                "{s} {bend} {derivatives:?}"
            );
        }
        let second = |s: f64| curve.derivatives(s).second_1_mm;
        let (before, after) = (second(s - h), second(s + h));
        let third = derivatives.third_1_mm2;
        let size = distance(third, [0.0; 3]);
        for k in 0..3 {
            let twist = (after[k] - before[k]) / (2.0 * h);
            assert!(
                (twist - third[k]).abs() < 1e-3 * (1.0 + size),
                "{s} {twist} {derivatives:?}"
            );
        }
        let unit = distance(here.tangent, [0.0; 3]);
        assert!((unit - 1.0).abs() < 1e-14);
    }
}

fn check_nearest(curve: &Curve, random: &mut Random, away_mm: f64) {
    let length = curve.length_mm();
    let mut lo = random.between(0.0, length);
    let mut hi = random.between(0.0, length);
    if lo > hi {
        std::mem::swap(&mut lo, &mut hi);
    }
    let mut point = curve.at(random.between(0.0, length)).position_mm;
    for value in &mut point {
        *value += random.between(-away_mm, away_mm);
    }
    let s = curve.nearest(point, lo, hi);
    assert!((lo..=hi).contains(&s), "{lo} {s} {hi}");
    let found = distance(curve.at(s).position_mm, point);
    let brute = brute_force(curve, point, lo, hi);
    assert!(
        found <= brute + 1e-12,
        "{found} {brute} at {s} of {lo}..{hi}, {point:?}"
    );
}

/// Checks that the offset at an inner nearest point is normal to the curve: this, not the distance,
/// shows errors of arc length.
fn check_foot(curve: &Curve, random: &mut Random, away_mm: f64) {
    let length = curve.length_mm();
    let s = random.between(0.3 * length, 0.7 * length);
    let mut point = curve.at(s).position_mm;
    for value in &mut point {
        *value += random.between(-away_mm, away_mm);
    }
    let found = curve.nearest(point, s - 0.2 * length, s + 0.2 * length);
    let foot = curve.at(found);
    let along: f64 = (0..3)
        .map(|k| (point[k] - foot.position_mm[k]) * foot.tangent[k])
        .sum();
    assert!(along.abs() < 1e-9, "{along} at {found}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn arcs_and_helices(
        radius in 0.01..200.0f64, from in -4.0..4.0f64, sweep in 0.05..6.2f64,
        rise in prop_oneof![Just(0.0), -50.0..50.0f64], turns in prop::sample::select(vec![-4, -2, -1, 1, 2, 3]),
        plane in prop::sample::select(vec![Plane::Xy, Plane::Zx, Plane::Yz]), seed in 1u64..u64::MAX,
    ) {
        let curve = arc(plane, radius, from, sweep, rise, turns).curve;
        let mut random = Random(seed);
        // Differences over 1e-4 mm resolve radii from 1 mm on.
        if radius > 1.0 {
            check_curve(&curve, &mut random);
        }
        for away in [0.01 * radius, radius, 20.0 * radius] {
            check_nearest(&curve, &mut random, away);
        }
        check_foot(&curve, &mut random, 1e-3 * radius);
    }
}

#[test]
fn contours_are_what_they_say() {
    let mut random = Random(7);
    for contour in CONTOURS {
        for piece in steps(contour.steps(50.0, BLEND).unwrap()) {
            check_curve(&piece.curve, &mut random);
            for away in [0.01, 1.0, 20.0] {
                for _ in 0..100 {
                    check_nearest(&piece.curve, &mut random, away);
                }
            }
            for _ in 0..100 {
                check_foot(&piece.curve, &mut random, 0.05);
            }
        }
    }
}

#[test]
fn contours_join_and_close() {
    for contour in CONTOURS {
        let pieces = steps(contour.steps(50.0, BLEND).unwrap());
        let mut here = pieces[0].start_mm;
        let mut s_mm = 0.0;
        for piece in &pieces {
            assert!(distance(here, piece.start_mm) < 1e-12, "{}", contour.name);
            assert!((piece.s_mm - s_mm).abs() < 1e-12);
            here = piece.curve.at(piece.length_mm).position_mm;
            s_mm += piece.length_mm;
        }
        if contour.name != "line-line-circle" {
            // The butterfly is tabulated to 1 um, and its first and last point differ by that.
            let gap_mm = if contour.name == "butterfly" {
                1.001e-3
            } else {
                1e-9
            };
            assert!(
                distance(here, pieces[0].start_mm) < gap_mm,
                "{}",
                contour.name
            );
        }
    }
}

/// Perimeter of an ellipse by the arithmetic-geometric mean (Gauss), and circles by their radius.
#[test]
fn lengths_are_those_of_the_closed_form() {
    let length = |name: &str| -> f64 {
        steps(contour(name).unwrap().steps(50.0, BLEND).unwrap())
            .iter()
            .map(|piece| piece.length_mm)
            .sum()
    };
    // Hu et al. (2023) give 382.859 mm.
    assert!(
        (length("butterfly") - 382.859).abs() < 1e-3,
        "{}",
        length("butterfly")
    );
    let (mut a, mut g): (f64, f64) = (20.0, 10.0);
    let (mut sum, mut power) = (0.5 * (a * a - g * g), 0.5);
    // Converges quadratically: ten rounds are plenty.
    for _ in 0..10 {
        let c = 0.5 * (a - g);
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
        power *= 2.0;
        sum += power * c * c;
    }
    let perimeter = 2.0 * std::f64::consts::PI * (400.0 - sum) / a;
    assert!(
        (length("ellipse") - perimeter).abs() < 1e-9,
        "{} {perimeter}",
        length("ellipse")
    );
    assert!((length("circle") - 20.0 * std::f64::consts::PI).abs() < 1e-12);
    assert!((length("square") - 80.0).abs() < 1e-12);
    assert!((length("line-line-circle") - 70.0 - 60.0 * std::f64::consts::PI).abs() < 1e-12);
    // The other two against a sum of 10 million chords, whose error is far below 1e-9 mm.
    for (name, x, y) in [
        (
            "eight",
            (|a| 15.0 * f64::sin(a)) as fn(f64) -> f64,
            (|a| 10.0 * f64::sin(2.0 * a)) as fn(f64) -> f64,
        ),
        (
            "star",
            |a| (12.0 + 4.0 * (5.0 * a).cos()) * a.cos(),
            |a| (12.0 + 4.0 * (5.0 * a).cos()) * a.sin(),
        ),
    ] {
        // Chords err by the square of their number: extrapolate from two numbers.
        let chords = |count: u32| {
            let at = |i: u32| 2.0 * std::f64::consts::PI * f64::from(i) / f64::from(count);
            (0..count)
                .map(|i| (x(at(i + 1)) - x(at(i))).hypot(y(at(i + 1)) - y(at(i))))
                .sum::<f64>()
        };
        let (coarse, fine) = (chords(20_000), chords(40_000));
        let sum = fine + (fine - coarse) / 3.0;
        assert!(
            (length(name) - sum).abs() < 1e-9,
            "{name} {} {sum}",
            length(name)
        );
    }
}

proptest! {
    #[test]
    fn the_reader_measures_an_arc_as_the_path_does(
        change in -0.028..0.028_f64,
        to in 0.0..std::f64::consts::TAU,
        turns in prop::sample::select(vec![1, -1, 4, -7]),
    ) {
        let motion = Motion {
            line: 1,
            kind: MotionKind::Feed,
            start_mm: [1.0, 0.0, 0.0],
            end_mm: [(1.0 + change) * to.cos(), (1.0 + change) * to.sin(), 2.0],
            shape: Shape::Arc { plane: Plane::Xy, center_mm: [0.0; 3], turns },
            feed_mm_s: 1.0,
            corner: BLEND,
            others: AuxiliaryAxes::default(),
        };
        let length_mm = motion.length_mm();
        let path_mm: f64 = pieces(vec![Canon::Motion(motion)]).iter().map(|piece| piece.length_mm).sum();
        prop_assert!((length_mm - path_mm).abs() < 1e-6, "{length_mm} {path_mm}");
    }
}
