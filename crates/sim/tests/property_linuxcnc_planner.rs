//! What holds of a plan of the member `linuxcnc` whatever the program: motion without jumps from
//! rest to rest, along all pieces in order, near the path; the same however calls are spread; spans
//! that come while pieces do.

use crate::programs::{LIMITS, Random, arc, distance, line, polyline};
use feedwright_gcode::canon::{Canon, Corner, MotionKind};
use feedwright_plan::{
    AxisLimits, AxisMotion, Constraints, FeedPlanner, PathLimits, Piece, Span, Step, feed_planner,
};
use feedwright_sim::path_steps;

const AXIS: AxisLimits = AxisLimits {
    velocity_mm_s: 200.0,
    accel_mm_s2: 2000.0,
    jerk_mm_s3: 1e9,
};
const EXACT: Corner = Corner::ExactPath;
const STOP: Corner = Corner::ExactStop;

fn constraints(axes: [AxisLimits; 3]) -> Constraints {
    let path = PathLimits {
        rapid_mm_s: 200.0,
        ..LIMITS
    };
    Constraints {
        axes: axes.to_vec(),
        path_tolerance_mm: Some(0.01),
        ..Constraints::from(&path)
    }
}

fn within(tolerance_mm: f64, merge_mm: Option<f64>) -> Corner {
    Corner::Continuous {
        tolerance_mm: Some(tolerance_mm),
        merge_mm,
    }
}

fn made(constraints: &Constraints) -> Box<dyn FeedPlanner> {
    (feed_planner("linuxcnc").unwrap().make)(constraints)
}

fn path(canon: Vec<Canon>) -> Vec<Piece> {
    let steps = path_steps(canon).map(|step| step.unwrap());
    steps
        .map(|step| {
            if let Step::Piece(piece) = step {
                piece
            } else {
                panic!("motions only")
            }
        })
        .collect()
}

/// Spans of all pieces, popped after every `every` pushes.
fn spans(constraints: &Constraints, path: &[Piece], every: usize) -> Vec<Span> {
    let mut planner = made(constraints);
    let mut spans = Vec::new();
    for (i, piece) in path.iter().enumerate() {
        planner.push(piece, i == 0);
        if i % every == 0 {
            spans.extend(std::iter::from_fn(|| planner.pop()));
        }
    }
    planner.finish();
    spans.extend(std::iter::from_fn(|| planner.pop()));
    spans
}

/// Everything that has to hold; the largest distance from the path, mm.
fn check(name: &str, constraints: &Constraints, path: &[Piece]) -> f64 {
    let spans = spans(constraints, path, 1);
    let mut last = AxisMotion {
        position_mm: path[0].start_mm,
        ..AxisMotion::REST
    };
    let (mut number, mut furthest_mm) = (0, 0.0_f64);
    for span in &spans {
        assert!(
            span.duration_s > 0.0 && span.duration_s <= 1e-3,
            "{name}: {span:?}"
        );
        assert!(
            span.piece >= number && (span.piece as usize) < path.len(),
            "{name}: pieces in order"
        );
        number = span.piece;
        let piece = &path[number as usize];
        assert!(
            (0.0..=piece.length_mm).contains(&span.from_mm) && span.speed_mm_s >= 0.0,
            "{name}: {span:?}"
        );
        let motion = span.motion.unwrap();
        assert!(
            distance(last.position_mm, motion.position_mm) < 1e-9,
            "{name}: {last:?} {motion:?}"
        );
        assert!(
            distance(last.velocity_mm_s, motion.velocity_mm_s) < 1e-6,
            "{name}: {last:?} {motion:?}"
        );
        for k in 0..3 {
            let limits = constraints.axes[k];
            assert!(
                motion.velocity_mm_s[k].abs() <= 1.01 * limits.velocity_mm_s,
                "{name}: {motion:?}"
            );
            assert!(
                motion.accel_mm_s2[k].abs() <= 2.0 * limits.accel_mm_s2,
                "{name}: {motion:?}"
            );
        }
        let near = number.saturating_sub(30) as usize..(number as usize + 30).min(path.len());
        let away = |piece: &Piece| {
            let s_mm = piece
                .curve
                .nearest(motion.position_mm, 0.0, piece.length_mm);
            distance(piece.curve.at(s_mm).position_mm, motion.position_mm)
        };
        furthest_mm = furthest_mm.max(path[near].iter().map(away).fold(f64::INFINITY, f64::min));
        last = motion.after(span.duration_s);
    }
    let end = path.last().unwrap();
    let end_mm = end.curve.at(end.length_mm).position_mm;
    assert_eq!(number as usize, path.len() - 1, "{name}");
    assert!(
        distance(last.position_mm, end_mm) < 1e-7,
        "{name}: ends at {:?}, not {end_mm:?}",
        last.position_mm
    );
    assert!(
        distance(last.velocity_mm_s, [0.0; 3]) < 1e-6,
        "{name}: ends at {:?}",
        last.velocity_mm_s
    );
    furthest_mm
}

/// Lines and arcs of all sizes, feeds and modes.
fn random_program(seed: u64, count: usize, modes: &[Corner]) -> Vec<Canon> {
    let mut random = Random(seed * 7919 + 1);
    let mut at = [0.0; 3];
    let mut canon = Vec::new();
    for number in 0..count {
        let corner = modes[(random.next() * modes.len() as f64) as usize];
        let feed_mm_s = 10f64.powf(random.between(0.5, 2.3));
        let size_mm = 10f64.powf(random.between(-2.5, 1.3));
        let to = [0, 1, 2]
            .map(|k| at[k] + size_mm * random.between(-1.0, 1.0) * if k == 2 { 0.3 } else { 1.0 });
        let mut motion = if random.next() < 0.3 {
            let center = [
                at[0] + size_mm * random.between(0.2, 1.0),
                at[1] + size_mm * random.between(-0.5, 0.5),
                at[2],
            ];
            let (sin, cos) = random.between(0.1, 6.0).sin_cos();
            let from = [at[0] - center[0], at[1] - center[1]];
            let end = [
                center[0] + cos * from[0] - sin * from[1],
                center[1] + sin * from[0] + cos * from[1],
                at[2],
            ];
            arc(
                at,
                end,
                center,
                if random.next() < 0.5 { 1 } else { -1 },
                feed_mm_s,
            )
        } else {
            line(at, to, feed_mm_s, corner)
        };
        if let Canon::Motion(motion) = &mut motion {
            motion.line = number as u32;
            motion.corner = corner;
            if random.next() < 0.1 && matches!(motion.shape, feedwright_gcode::canon::Shape::Line) {
                motion.kind = MotionKind::Rapid;
            }
            at = motion.end_mm;
        }
        canon.push(motion);
    }
    canon
}

#[test]
fn random_programs_move_without_jumps_near_their_path() {
    for seed in 1..25 {
        let tolerance_mm = [0.005, 0.02, 0.1][seed as usize % 3];
        let merge_mm = [None, Some(0.0), Some(0.03)][seed as usize % 4 % 3];
        let modes = [
            within(tolerance_mm, merge_mm),
            within(tolerance_mm, merge_mm),
            EXACT,
            STOP,
        ];
        let slower = AxisLimits {
            velocity_mm_s: 80.0,
            accel_mm_s2: 500.0,
            jerk_mm_s3: 1e9,
        };
        let constraints = constraints([AXIS, AXIS, if seed % 2 == 0 { AXIS } else { slower }]);
        let program = path(random_program(seed, 150, &modes));
        let away_mm = check(&format!("seed {seed}"), &constraints, &program);
        let most_mm = tolerance_mm + merge_mm.unwrap_or(tolerance_mm);
        // A parabola is only about within the tolerance.
        assert!(
            away_mm < 2.0 * most_mm + 0.002,
            "seed {seed}: {away_mm} {tolerance_mm} {merge_mm:?}"
        );
    }
}

#[test]
fn exact_modes_keep_to_the_path() {
    for (seed, mode) in [(31, EXACT), (32, STOP), (33, EXACT)] {
        let away_mm = check(
            "exact",
            &constraints([AXIS; 3]),
            &path(random_program(seed, 100, &[mode])),
        );
        // What the spline of the joints leaves out while the speed changes by `a T`.
        assert!(away_mm < 1e-3, "{seed}: {away_mm}");
    }
}

#[test]
fn how_calls_are_spread_changes_nothing() {
    let program = path(random_program(
        77,
        400,
        &[within(0.01, None), within(0.01, Some(0.0)), EXACT],
    ));
    let one = spans(&constraints([AXIS; 3]), &program, 1);
    for every in [7, 10_000] {
        assert_eq!(
            one,
            spans(&constraints([AXIS; 3]), &program, every),
            "{every}"
        );
    }
}

#[test]
fn spans_come_while_pieces_do() {
    let points: Vec<[f64; 3]> = (0..20_000)
        .map(|i| f64::from(i) * 0.05)
        .map(|x| [x, x.sin(), 0.0])
        .collect();
    for merge_mm in [Some(0.0), None] {
        let program = path(polyline(&points, 150.0, within(0.01, merge_mm)));
        let mut planner = made(&constraints([AXIS; 3]));
        let mut last = 0;
        for (i, piece) in program.iter().enumerate() {
            planner.push(piece, i == 0);
            while let Some(span) = planner.pop() {
                last = span.piece;
            }
            // Two hundred segments, each of up to a hundred pieces.
            assert!(i as u64 - last < 5000, "{i} {last}");
        }
    }
}

#[test]
fn odd_programs_come_to_their_end() {
    let corner = within(0.01, None);
    let fast = constraints([AXIS; 3]);
    let unlike = constraints([
        AXIS,
        AxisLimits {
            velocity_mm_s: 0.2,
            accel_mm_s2: 2.0,
            jerk_mm_s3: 1.0,
        },
        AXIS,
    ]);
    let there_and_back: Vec<[f64; 3]> = (0..40).map(|i| [f64::from(i % 2), 0.0, 0.0]).collect();
    let tiny: Vec<[f64; 3]> = (0..3000).map(|i| [f64::from(i) * 2e-9, 0.0, 0.0]).collect();
    let short: Vec<[f64; 3]> = (0..5000)
        .map(|i| [f64::from(i) * 1e-3, f64::from(i % 3) * 1e-3, 0.0])
        .collect();
    for (name, points) in [
        ("there and back", &there_and_back),
        ("2 pm", &tiny),
        ("1 um", &short),
    ] {
        for mode in [
            corner,
            within(0.01, Some(0.0)),
            Corner::Continuous {
                tolerance_mm: None,
                merge_mm: None,
            },
            EXACT,
        ] {
            check(name, &fast, &path(polyline(points, 100.0, mode)));
        }
    }
    check(
        "slow",
        &fast,
        &path(polyline(
            &[[0.0; 3], [0.01, 0.0, 0.0], [0.01, 0.02, 0.0]],
            0.01,
            corner,
        )),
    );
    check(
        "unlike axes",
        &unlike,
        &path(polyline(
            &[[0.0; 3], [1.0, 0.1, 0.0], [0.0, 0.1, 1.0]],
            100.0,
            corner,
        )),
    );
    assert!(spans(&fast, &[], 1).is_empty());
}
