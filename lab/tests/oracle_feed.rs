//! Plan times that have a closed form.

use crate::programs::{BLEND, LIMITS, arc, line, polyline};
use feedwright_gcode::canon::{
    AuxiliaryAxes, Canon, Corner, Event, EventKind, Motion, MotionKind, Shape,
};
use feedwright_gcode::{Reader, Settings};
use feedwright_lab::contour;
use feedwright_plan::{Constraints, Durations, FEED_PLANNERS, PathLimits, Plan, Plc};
use feedwright_sim::{Reference, path_steps};
use std::f64::consts::PI;

/// Sums of a few hundred durations of order 1 s.
const ROUNDING_S: f64 = 1e-11;

fn plan_s(canon: Vec<Canon>, limits: &PathLimits) -> f64 {
    let mut reference = Reference::of_program(canon, limits).expect("limits are sound");
    let end_s = reference.read_to_end_s();
    assert_eq!(reference.fault(), None);
    end_s
}

#[test]
fn circle_takes_its_length_over_the_feed_and_one_ramp() {
    let circle = vec![arc([0.0; 3], [0.0; 3], [10.0, 0.0, 0.0], -1, 50.0)];
    let expected = 2.0 * PI * 10.0 / 50.0 + 0.5;
    assert!((plan_s(circle, &LIMITS) - expected).abs() < ROUNDING_S);
    let mut contour = Reference::of_steps(
        contour("circle").unwrap().steps(50.0, BLEND).unwrap(),
        &LIMITS,
    )
    .unwrap();
    assert!((contour.read_to_end_s() - expected).abs() < ROUNDING_S);
}

#[test]
fn circle_too_tight_for_its_feed_runs_at_the_normal_limit() {
    // sqrt(400 * 1) = 20 mm/s on a radius of 1 mm.
    let circle = vec![arc([0.0; 3], [0.0; 3], [1.0, 0.0, 0.0], -1, 50.0)];
    assert!((plan_s(circle, &LIMITS) - (2.0 * PI / 20.0 + 0.2)).abs() < ROUNDING_S);
}

#[test]
fn short_line_is_a_triangle() {
    let short = vec![line([0.0; 3], [1.0, 0.0, 0.0], 50.0, BLEND)];
    assert!((plan_s(short, &LIMITS) - 2.0 * (1.0f64 / 100.0).sqrt()).abs() < ROUNDING_S);
}

#[test]
fn square_with_exact_stops_is_four_times_its_side() {
    for corner in [Corner::ExactStop, Corner::ExactPath] {
        let square = contour("square").unwrap().steps(20.0, corner).unwrap();
        let mut reference = Reference::of_steps(square, &LIMITS).unwrap();
        // Each side: 20 mm at 20 mm/s and one ramp of 0.2 s.
        assert!((reference.read_to_end_s() - 4.0 * 1.2).abs() < ROUNDING_S);
    }
}

#[test]
fn square_in_continuous_mode_passes_corners_at_the_jump() {
    // At a right angle the jump is v sqrt(2).
    let v = 8.0 / 2.0f64.sqrt();
    let square = contour("square").unwrap().steps(20.0, BLEND).unwrap();
    let mut reference = Reference::of_steps(square, &LIMITS).unwrap();
    // Time lost against 20 mm/s by a ramp between u and 20: (20 - u)^2 / (2 a 20).
    let lost = |u: f64| (20.0 - u).powi(2) / (2.0 * 100.0 * 20.0);
    let expected = 4.0 + 2.0 * lost(0.0) + 6.0 * lost(v);
    assert!((reference.read_to_end_s() - expected).abs() < ROUNDING_S);
    let corner_s = 20.0 / 20.0 + lost(0.0) + lost(v);
    let feed = reference.at(corner_s).feed_mm_s;
    assert!((feed - v).abs() < 1e-9, "{feed} {v}");
}

#[test]
fn rapid_runs_at_the_rapid_rate() {
    let rapid = Motion {
        line: 3,
        kind: MotionKind::Rapid,
        start_mm: [0.0; 3],
        end_mm: [0.0, 300.0, 0.0],
        shape: Shape::Line,
        feed_mm_s: f64::NAN,
        corner: BLEND,
        others: AuxiliaryAxes::default(),
    };
    assert!((plan_s(vec![Canon::Motion(rapid)], &LIMITS) - 4.0).abs() < ROUNDING_S);
}

#[test]
fn feed_is_capped_by_the_machine() {
    let limits = PathLimits {
        max_feed_mm_s: 10.0,
        ..LIMITS
    };
    let long = vec![line([0.0; 3], [10.0, 0.0, 0.0], 50.0, BLEND)];
    assert!((plan_s(long, &limits) - 1.1).abs() < ROUNDING_S);
}

#[test]
fn straight_line_in_a_thousand_blocks_is_a_straight_line() {
    let points: Vec<[f64; 3]> = (0..=1000).map(|i| [0.1 * f64::from(i), 0.0, 0.0]).collect();
    assert!((plan_s(polyline(&points, 50.0, BLEND), &LIMITS) - 2.5).abs() < 1e-9);
}

#[test]
fn circle_in_chords_takes_as_long_as_the_circle() {
    // Radius 1 mm: the normal limit holds the feed at 20 mm/s, hidden in the joints of 2000 chords.
    let points: Vec<[f64; 3]> = (0..=2000)
        .map(|i| 2.0 * PI * f64::from(i) / 2000.0)
        .map(|a: f64| [1.0 - a.cos(), a.sin(), 0.0])
        .collect();
    let time = plan_s(polyline(&points, 50.0, BLEND), &LIMITS);
    // Between joints nothing bounds the speed but the joints ahead and behind: chords rise 0.3
    // mm2/s2 above 400.
    assert!(
        (time / (2.0 * PI / 20.0 + 0.2) - 1.0).abs() < 1e-3,
        "{time}"
    );
}

#[test]
fn dwell_stops_and_holds() {
    let event = |line, kind| Canon::Event(Event { line, kind });
    let program = vec![
        event(
            1,
            EventKind::MCode {
                code: 3,
                p: None,
                q: None,
            },
        ),
        event(2, EventKind::Dwell { seconds: 0.25 }),
        line([0.0; 3], [10.0, 0.0, 0.0], 10.0, BLEND),
        event(4, EventKind::SpindleSpeed { rpm: 1000.0 }),
        line([10.0, 0.0, 0.0], [20.0, 0.0, 0.0], 10.0, BLEND),
        event(6, EventKind::Dwell { seconds: 2.0 }),
        line([20.0, 0.0, 0.0], [30.0, 0.0, 0.0], 10.0, BLEND),
        event(8, EventKind::ProgramEnd),
    ];
    let mut reference = Reference::of_program(program, &LIMITS).unwrap();
    // 0.25 s, 20 mm at 10 mm/s with a ramp of 0.1 s, 2 s, 10 mm with a ramp.
    assert!((reference.read_to_end_s() - (0.25 + 2.1 + 2.0 + 1.1)).abs() < ROUNDING_S);
    let mut events = Vec::new();
    while let Some(event) = reference.next_event(f64::INFINITY) {
        events.push((event.event.line, event.tau_s));
    }
    let expected = [(1, 0.0), (2, 0.0), (4, 0.25 + 1.05), (6, 2.35), (8, 5.45)];
    assert_eq!(events.len(), expected.len());
    for ((line, tau), (expected_line, expected_tau)) in events.into_iter().zip(expected) {
        assert_eq!(line, expected_line);
        assert!((tau - expected_tau).abs() < ROUNDING_S, "{line} {tau}");
    }
    let first = reference.at(0.1);
    assert!(first.resting && !first.cutting && first.line == 2 && first.tangent == [1.0, 0.0, 0.0]);
    let held = reference.at(3.0);
    assert!(held.resting && !held.cutting && held.line == 6);
    assert_eq!(held.position_mm, [20.0, 0.0, 0.0]);
    let end = reference.at(1e9);
    assert!(
        end.resting
            && end.position_mm == [30.0, 0.0, 0.0]
            && end.s_mm == 30.0
            && end.feed_mm_s == 0.0
    );
}

#[test]
fn empty_program_rests_at_the_origin() {
    let mut reference = Reference::of_program(vec![], &LIMITS).unwrap();
    assert!(reference.at(1.0).resting);
    assert_eq!(reference.end_s(), Some(0.0));
    assert_eq!(
        reference.nearest([3.0, 4.0, 0.0], 0.0, 1.0).distance_mm,
        5.0
    );
}

#[test]
fn a_fault_ends_the_path_where_it_occurs() {
    let program = vec![
        line([0.0; 3], [10.0, 0.0, 0.0], 10.0, BLEND),
        line([10.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0], 10.0, BLEND),
    ];
    let mut reference = Reference::of_program(program, &LIMITS).unwrap();
    assert!((reference.read_to_end_s() - 1.1).abs() < ROUNDING_S);
    assert!(reference.fault().is_some());
    assert_eq!(reference.at(5.0).position_mm, [10.0, 0.0, 0.0]);
}

#[test]
fn the_tool_rests_while_something_else_moves() {
    let others = AuxiliaryAxes {
        extruder_mm: -2.0,
        axes: None,
    };
    let turn = AuxiliaryAxes {
        extruder_mm: 0.0,
        axes: Some(Box::new([[0.0; 6], [90.0, 0.0, 0.0, 0.0, 0.0, 0.0]])),
    };
    let standing = |others, feed_mm_s| {
        let Canon::Motion(motion) = line([10.0, 0.0, 0.0], [10.0, 0.0, 0.0], feed_mm_s, BLEND)
        else {
            panic!()
        };
        Canon::Motion(Motion {
            others,
            line: 9,
            ..motion
        })
    };
    let program = vec![
        line([0.0; 3], [10.0, 0.0, 0.0], 10.0, BLEND),
        standing(others, 40.0),
        standing(turn, 30.0),
        line([10.0, 0.0, 0.0], [20.0, 0.0, 0.0], 10.0, BLEND),
    ];
    let mut reference = Reference::of_program(program, &LIMITS).unwrap();
    // 2 mm of filament at 40 mm/s, 90 degrees at 30 degrees/s.
    assert!((reference.read_to_end_s() - (1.1 + 0.05 + 3.0 + 1.1)).abs() < ROUNDING_S);
    let standing = reference.at(2.0);
    assert!(standing.resting && standing.line == 9 && standing.position_mm == [10.0, 0.0, 0.0]);
}

/// Plan time of a program on a machine whose rotary axes have a limit.
fn program_s(text: &str, rotary_deg_s: f64) -> f64 {
    let reader = Reader::from_text("test", text, Settings::default()).expect("it is a program");
    let canon: Vec<Canon> = reader
        .map(|step| step.expect("it has no mistakes"))
        .collect();
    let plc = Plc::new(Durations {
        rotary_deg_s,
        ..Durations::default()
    });
    let rotary_deg_s = if rotary_deg_s > 0.0 {
        rotary_deg_s
    } else {
        f64::INFINITY
    };
    let constraints = Constraints {
        rotary_deg_s,
        ..Constraints::from(&LIMITS)
    };
    let plan = Plan::new(path_steps(canon), &constraints, &FEED_PLANNERS[0], plc)
        .expect("limits are sound");
    let mut reference = Reference::new(plan);
    let end_s = reference.read_to_end_s();
    assert_eq!(reference.fault(), None);
    end_s
}

#[test]
fn the_slowest_axis_of_a_motion_bounds_it() {
    // Time at constant speed, plus one ramp at 100 mm/s2 up and down: v / a.
    let at_speed = |length_mm: f64, seconds: f64| seconds + length_mm / seconds / 100.0;
    for (program, rotary_deg_s, expected) in [
        // 90 degrees at 30 degrees/s, in feed and in rapid; F would do it in 0.1 s.
        ("G1 X10 A90 F6000", 30.0, at_speed(10.0, 3.0)),
        ("G0 X10 A90", 30.0, at_speed(10.0, 3.0)),
        // The largest angle of several.
        ("G1 X6 Y8 A-90 B120 C30 F6000", 30.0, at_speed(10.0, 4.0)),
        // F applies to X, Y and Z, and is slower than the limit of the rotary axis.
        ("G1 X10 A9 F60", 30.0, at_speed(10.0, 10.0)),
        // No limit: up to the middle and down again.
        ("G1 X10 A90 F60000", 0.0, 2.0 * (10.0f64 / 100.0).sqrt()),
        // Inverse time: 6 s are enough, 1 s is not.
        ("G93 G1 X10 A90 F10", 30.0, at_speed(10.0, 6.0)),
        ("G93 G1 X10 A90 F60", 30.0, at_speed(10.0, 3.0)),
        // Half a circle, half a turn.
        ("G2 X20 I10 B180 F6000", 60.0, at_speed(10.0 * PI, 3.0)),
        // U beside X at the rapid rate of 100 mm/s.
        ("G1 X3 U300 F6000", 0.0, at_speed(3.0, 3.0)),
        // A way of nearly nothing.
        ("G1 X0.000002 A360 F6000", 60.0, 6.0),
        // Where X, Y and Z rest, F is degrees a minute, and the limit holds.
        ("G1 A90 F1800", 60.0, 3.0),
        ("G1 A90 F180000", 60.0, 1.5),
    ] {
        let time = program_s(&format!("G21 G90\n{program}\nM2\n"), rotary_deg_s);
        assert!(
            (time - expected).abs() < 1e-8,
            "{program}: {time} s, not {expected} s"
        );
    }
    // A block with a turn before one without: from the slow speed u to 10 mm/s within the second.
    let u = 10.0_f64 / 3.0;
    let expected = 3.0 + u / 200.0 + 1.0 + (10.0 - u).powi(2) / 2000.0 + 0.05;
    let time = program_s("G21 G90 G64 F600\nG1 X10 A90\nX20\nM2\n", 30.0);
    assert!((time - expected).abs() < 1e-8, "{time} s, not {expected} s");
}
