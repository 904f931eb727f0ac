//! Splines against numbers made by `oracle_data/spline.py`, and the butterfly against the
//! literature.

use crate::programs::{BLEND, LIMITS, Random, distance};
use feedwright_gcode::canon::{AuxiliaryAxes, Canon, Motion, MotionKind, Shape, Spline};
use feedwright_gcode::{Reader, Settings};
use feedwright_plan::{Piece, Pieces, Step};
use feedwright_sim::Reference;
use serde_json::Value;
use std::path::Path;
use std::sync::Arc;

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .expect("array")
        .iter()
        .map(|x| x.as_f64().expect("number"))
        .collect()
}

fn vector(value: &Value) -> [f64; 3] {
    let numbers = numbers(value);
    [0, 1, 2].map(|k| numbers.get(k).copied().unwrap_or(0.0))
}

fn points(value: &Value) -> Vec<[f64; 3]> {
    value
        .as_array()
        .expect("array")
        .iter()
        .map(vector)
        .collect()
}

fn motion(spline: Spline, start_mm: [f64; 3], end_mm: [f64; 3]) -> Canon {
    Canon::Motion(Motion {
        line: 1,
        kind: MotionKind::Feed,
        start_mm,
        end_mm,
        shape: Shape::Spline(Arc::new(spline)),
        feed_mm_s: 50.0,
        corner: BLEND,
        others: AuxiliaryAxes::default(),
    })
}

fn pieces(canon: Canon) -> Vec<Piece> {
    Pieces::new([canon].into_iter())
        .map(|step| match step {
            Ok(Step::Piece(piece)) => piece,
            other => panic!("{other:?}"),
        })
        .collect()
}

#[test]
fn splines_agree_with_25_digits() {
    let cases: Value = serde_json::from_str(include_str!("oracle_data/spline.json")).unwrap();
    for case in cases.as_array().unwrap() {
        let spline = Spline {
            degree: case["degree"].as_u64().unwrap() as usize,
            knots: numbers(&case["knots"]),
            control_mm: points(&case["control_mm"]),
            weights: numbers(&case["weights"]),
        };
        let name = case["name"].as_str().unwrap();
        let (start, end) = ends(&spline);
        let pieces = pieces(motion(spline, start, end));
        assert_eq!(pieces.len(), 1, "{name}");
        let curve = &pieces[0].curve;
        let length = case["length_mm"].as_f64().unwrap();
        assert!(
            (curve.length_mm() - length).abs() < 1e-9,
            "{name}: {} {length}",
            curve.length_mm()
        );
        for sample in case["samples"].as_array().unwrap() {
            let s_mm = sample["s_mm"].as_f64().unwrap();
            let at = curve.at(s_mm);
            assert!(
                distance(at.position_mm, vector(&sample["position_mm"])) < 1e-9,
                "{name} {s_mm}"
            );
            assert!(
                distance(at.tangent, vector(&sample["tangent"])) < 1e-9,
                "{name} {s_mm}"
            );
            let curvature = sample["curvature_1_mm"].as_f64().unwrap();
            assert!(
                (curve.curvature(s_mm) / curvature - 1.0).abs() < 1e-8,
                "{name} {s_mm}"
            );
            let derivatives = curve.derivatives(s_mm);
            let [second, third] = [
                vector(&sample["second_1_mm"]),
                vector(&sample["third_1_mm2"]),
            ];
            let size = distance(third, [0.0; 3]);
            assert!(
                distance(derivatives.second_1_mm, second) < 1e-8 * curvature,
                "{name} {s_mm} {derivatives:?}"
            );
            assert!(
                distance(derivatives.third_1_mm2, third) < 1e-7 * size,
                "{name} {s_mm} {derivatives:?} {third:?}"
            );
        }
    }
}

/// Ends of a spline by the recursion of Cox and de Boor.
fn ends(spline: &Spline) -> ([f64; 3], [f64; 3]) {
    fn basis(i: usize, p: usize, u: f64, knots: &[f64], span: usize) -> f64 {
        if p == 0 {
            return f64::from(i == span);
        }
        let part = |over: f64, under: f64| if under > 0.0 { over / under } else { 0.0 };
        part(u - knots[i], knots[i + p] - knots[i]) * basis(i, p - 1, u, knots, span)
            + part(knots[i + p + 1] - u, knots[i + p + 1] - knots[i + 1])
                * basis(i + 1, p - 1, u, knots, span)
    }
    let count = spline.control_mm.len();
    let at = |u: f64, span: usize| {
        let mut sum = [0.0; 4];
        for i in 0..count {
            let weight = spline.weights[i] * basis(i, spline.degree, u, &spline.knots, span);
            for k in 0..3 {
                sum[k] += weight * spline.control_mm[i][k];
            }
            sum[3] += weight;
        }
        [0, 1, 2].map(|k| sum[k] / sum[3])
    };
    (
        at(spline.knots[spline.degree], spline.degree),
        at(spline.knots[count], count - 1),
    )
}

fn butterfly() -> Option<Spline> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../../shared/corpus/curves/butterfly_nurbs_degree3_51cp.json");
    let Ok(text) = std::fs::read_to_string(&path) else {
        eprintln!("SKIPPED: {} is missing", path.display());
        return None;
    };
    let case: Value = serde_json::from_str(&text).expect("JSON");
    Some(Spline {
        degree: 3,
        knots: numbers(&case["knots"]),
        control_mm: points(&case["control_points"]),
        weights: numbers(&case["weights"]),
    })
}

#[test]
fn butterfly_has_its_published_length_and_curvature() {
    let Some(spline) = butterfly() else { return };
    let (start, end) = ends(&spline);
    let pieces = pieces(motion(spline, start, end));
    let length: f64 = pieces.iter().map(|piece| piece.length_mm).sum();
    let mut sharpest: f64 = 0.0;
    for piece in &pieces {
        for i in 0..=1_000_000 {
            sharpest = sharpest.max(piece.curve.curvature(piece.length_mm * f64::from(i) * 1e-6));
        }
    }
    // Published with three digits behind the point, cut off rather than rounded; chords
    // extrapolated give 382.8595583.
    assert!((length - 382.859).abs() < 1e-3, "{length}");
    assert!((length - 382.859_558_3).abs() < 1e-7, "{length}");
    assert!((sharpest - 43.25).abs() < 0.01, "{sharpest}");
}

#[test]
fn butterfly_keeps_the_normal_limit_and_its_feet() {
    let Some(spline) = butterfly() else { return };
    let (start, end) = ends(&spline);
    let motion = motion(spline, start, end);
    let pieces = pieces(motion.clone());
    let mut reference = Reference::of_program([motion], &LIMITS).unwrap();
    let end_s = reference.read_to_end_s();
    let mut random = Random(4);
    for _ in 0..50_000 {
        let here = reference.at(random.between(0.0, end_s));
        let piece = &pieces[pieces
            .partition_point(|piece| piece.s_mm <= here.s_mm)
            .max(1)
            - 1];
        let normal = here.feed_mm_s.powi(2) * piece.curve.curvature(here.s_mm - piece.s_mm);
        assert!(normal <= 400.0 * 1.001, "{normal} at {}", here.s_mm);
    }
    for _ in 0..300 {
        let tau = random.between(0.0, end_s);
        let point = reference
            .at(tau)
            .position_mm
            .map(|x| x + random.between(-0.02, 0.02));
        let foot = reference.nearest(point, tau - 0.05, tau + 0.05);
        let brute = (0..=20_000)
            .map(|i| {
                distance(
                    reference.at(tau - 0.05 + 5e-6 * f64::from(i)).position_mm,
                    point,
                )
            })
            .fold(f64::INFINITY, f64::min);
        assert!(
            foot.distance_mm <= brute + 1e-12,
            "{} {brute}",
            foot.distance_mm
        );
        assert!(
            foot.distance_mm >= brute - 50.0 * 5e-6,
            "{} {brute}",
            foot.distance_mm
        );
    }
}

/// Point of a rational B-spline by de Boor's corner cutting in homogeneous coordinates, from the
/// words of the program.
fn de_boor(order: usize, knots: &[f64], points: &[[f64; 3]], u: f64) -> [f64; 3] {
    let degree = order - 1;
    let span = (degree..points.len())
        .rev()
        .find(|&i| knots[i] <= u && knots[i] < knots[i + 1])
        .expect("a span");
    let mut cut: Vec<[f64; 3]> = (span - degree..=span)
        .map(|i| {
            [
                points[i][0] * points[i][2],
                points[i][1] * points[i][2],
                points[i][2],
            ]
        })
        .collect();
    for level in 1..=degree {
        for j in (level..=degree).rev() {
            let i = span - degree + j;
            let share = (u - knots[i]) / (knots[i + order - level] - knots[i]);
            for k in 0..3 {
                cut[j][k] = (1.0 - share) * cut[j - 1][k] + share * cut[j][k];
            }
        }
    }
    [
        cut[degree][0] / cut[degree][2],
        cut[degree][1] / cut[degree][2],
        0.0,
    ]
}

/// G5, G5.1, G5.2 and G6.2 as read from a program: points of the curve that the words define lie on
/// the path, and the path is as long as the chords through them.
#[test]
fn splines_of_a_program_are_the_curves_of_their_words() {
    // Order, knots, and x, y, weight of the control points, worked out by hand from the program.
    type Curve = (&'static str, usize, &'static [f64], &'static [[f64; 3]]);
    const BEZIER_3: &[f64] = &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    const CURVES: &[Curve] = &[
        (
            "G5 X10 Y5 I3 J6 P-4 Q1",
            4,
            BEZIER_3,
            &[
                [0.0, 0.0, 1.0],
                [3.0, 6.0, 1.0],
                [6.0, 6.0, 1.0],
                [10.0, 5.0, 1.0],
            ],
        ),
        (
            // Without I and J it goes on in the direction of the curve before.
            "G5 X22 Y3 P-3 Q-5",
            4,
            BEZIER_3,
            &[
                [10.0, 5.0, 1.0],
                [14.0, 4.0, 1.0],
                [19.0, -2.0, 1.0],
                [22.0, 3.0, 1.0],
            ],
        ),
        (
            "G5.1 X30 Y5 I2 J8",
            3,
            &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            &[[22.0, 3.0, 1.0], [24.0, 11.0, 1.0], [30.0, 5.0, 1.0]],
        ),
        (
            "G5.2 X33 Y12 P1.5\nX40 Y15 P0.7\nX45 Y2 P2\nX52 Y4 P1\nG5.3",
            3,
            &[0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0],
            &[
                [30.0, 5.0, 1.0],
                [33.0, 12.0, 1.5],
                [40.0, 15.0, 0.7],
                [45.0, 2.0, 2.0],
                [52.0, 4.0, 1.0],
            ],
        ),
        (
            "G6.2 P4 K0 X52 Y4 R1\nK0 X55 Y14 R0.6\nK0 X60 Y12 R3\nK0 X66 Y0 R1\nK0.3 X70 Y3 R2\nG6.2 K2\nG6.2 K2\nG6.2 K2\nG6.2 K2",
            4,
            &[0.0, 0.0, 0.0, 0.0, 0.3, 2.0, 2.0, 2.0, 2.0],
            &[
                [52.0, 4.0, 1.0],
                [55.0, 14.0, 0.6],
                [60.0, 12.0, 3.0],
                [66.0, 0.0, 1.0],
                [70.0, 3.0, 2.0],
            ],
        ),
    ];
    const SAMPLES: u32 = 20_000;
    let words: Vec<&str> = CURVES.iter().map(|curve| curve.0).collect();
    let text = format!("G21 G17 G90 F600\n{}\nM2\n", words.join("\n"));
    let motions: Vec<Canon> = Reader::from_text("splines", text, Settings::default())
        .unwrap()
        .map(|step| step.unwrap())
        .filter(|step| matches!(step, Canon::Motion(_)))
        .collect();
    assert_eq!(motions.len(), CURVES.len());
    for ((words, order, knots, points), motion) in CURVES.iter().zip(motions) {
        let pieces = pieces(motion);
        let (first, last) = (knots[0], knots[points.len()]);
        let mut before = [points[0][0], points[0][1], 0.0];
        let (mut chords, mut worst) = (0.0, 0.0f64);
        for number in 1..=SAMPLES {
            // The last knot itself is in no span.
            let u = first + (last - first) * f64::from(number) / f64::from(SAMPLES) * (1.0 - 1e-15);
            let point = de_boor(*order, knots, points, u);
            chords += distance(before, point);
            before = point;
            if number % 100 == 0 {
                let away = pieces.iter().map(|piece| {
                    let foot = piece.curve.nearest(point, 0.0, piece.length_mm);
                    distance(piece.curve.at(foot).position_mm, point)
                });
                worst = worst.max(away.fold(f64::INFINITY, f64::min));
            }
        }
        let length: f64 = pieces.iter().map(|piece| piece.length_mm).sum();
        assert!(worst < 1e-8, "{words}: {worst}");
        assert!((length - chords).abs() < 1e-6, "{words}: {length} {chords}");
    }
}
