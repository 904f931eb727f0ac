//! Time-optimal plans against closed forms and published numbers.
//!
//! A straight line from rest to rest with bounds of velocity, acceleration and jerk: seven phases
//! (Biagiotti and Melchiorri 2008, section 3.4). A long circle: a steady speed of `sqrt(a R)` keeps
//! the acceleration of each axis, `(j R^2)^(1/3)` its jerk; where both axes are used, accelerations
//! and jerks are at most sqrt(2) times as long, so the mean speed is at most `2^(1/4)` times that.
//! The circle of 10 mm from rest to rest within 10 um: 0.5516 s by a nonlinear program that shares
//! nothing with this one (IPOPT).

use crate::programs::{BLEND, LIMITS, arc, distance, line, polyline};
use feedwright_gcode::canon::Canon;
use feedwright_plan::{
    AxisLimits, Constraints, FEED_PLANNERS, FeedMember, PathLimits, Span, Step, WHOLE_PROGRAM,
    feed_planner,
};
use feedwright_sim::path_steps;

fn constraints(velocity_mm_s: f64, accel_mm_s2: f64, jerk_mm_s3: f64) -> Constraints {
    let axis = AxisLimits {
        velocity_mm_s,
        accel_mm_s2,
        jerk_mm_s3,
    };
    let path = PathLimits {
        max_feed_mm_s: 1e3,
        ..LIMITS
    };
    Constraints {
        axes: vec![axis; 3],
        path_tolerance_mm: Some(0.01),
        ..Constraints::from(&path)
    }
}

fn spans(member: &FeedMember, constraints: &Constraints, canon: Vec<Canon>) -> Vec<Span> {
    let mut planner = (member.make)(constraints);
    for (i, step) in path_steps(canon).enumerate() {
        let Ok(Step::Piece(piece)) = step else {
            panic!("motions only")
        };
        planner.push(&piece, i == 0);
    }
    planner.finish();
    std::iter::from_fn(|| planner.pop()).collect()
}

fn time_s(spans: &[Span]) -> f64 {
    spans.iter().map(|span| span.duration_s).sum()
}

/// Least time over a length from rest to rest.
fn closed_form_s(length_mm: f64, v: f64, a: f64, j: f64) -> f64 {
    // Speeding up to v: with or without a phase of constant acceleration.
    let up_s = |v: f64| {
        if v * j >= a * a {
            v / a + a / j
        } else {
            2.0 * (v / j).sqrt()
        }
    };
    if v * up_s(v) <= length_mm {
        return 2.0 * up_s(v) + (length_mm - v * up_s(v)) / v;
    }
    let (mut lo, mut hi) = (0.0, v);
    for _ in 0..200 {
        let middle = 0.5 * (lo + hi);
        if middle * up_s(middle) < length_mm {
            lo = middle;
        } else {
            hi = middle;
        }
    }
    2.0 * up_s(lo)
}

#[test]
fn a_straight_line_takes_the_time_of_the_closed_form() {
    let (v, a, j) = (200.0, 2000.0, 50_000.0);
    let time_optimal = feed_planner("time-optimal").unwrap();
    for length_mm in [1e-6, 0.01, 1.0, 5.0, 12.0, 40.0, 300.0] {
        let one = line([0.0; 3], [length_mm, 0.0, 0.0], 1e3, BLEND);
        let exact_s = closed_form_s(length_mm, v, a, j);
        let found_s = time_s(&spans(time_optimal, &constraints(v, a, j), vec![one]));
        // Longer than the look-ahead it is planned in windows.
        let over = if length_mm < 100.0 { 1e-9 } else { 1e-4 };
        assert!(
            (found_s / exact_s - 1.0).abs() < over,
            "{length_mm}: {found_s} {exact_s}"
        );
        // In three parts it is a path for the solver, and no single line.
        let points: Vec<[f64; 3]> = [0.0, 0.3, 0.65, 1.0]
            .map(|part| [part * length_mm, 0.0, 0.0])
            .to_vec();
        let parts = polyline(&points, 1e3, BLEND);
        let found_s = time_s(&spans(time_optimal, &constraints(v, a, j), parts));
        assert!(
            found_s < 1.003 * exact_s && found_s > 0.999 * exact_s,
            "{length_mm}: {found_s} {exact_s}"
        );
    }
}

#[test]
fn a_circle_runs_between_the_speeds_that_one_axis_and_both_allow() {
    let time_optimal = feed_planner("time-optimal").unwrap();
    for (a, j, radius_mm) in [
        (2000.0, 50_000.0, 20.0_f64),
        (2000.0, 1e6, 5.0),
        (1e5, 50_000.0, 5.0),
    ] {
        let steady = (a * radius_mm)
            .sqrt()
            .min((j * radius_mm * radius_mm).cbrt());
        let circle = vec![arc([0.0; 3], [0.0; 3], [radius_mm, 0.0, 0.0], 4, 1e3)];
        let spans = spans(time_optimal, &constraints(1e3, a, j), circle);
        let total_s = time_s(&spans);
        let mut clock_s = 0.0;
        let (mut way_mm, mut middle_s) = (0.0, 0.0);
        for span in &spans {
            if (0.4..0.6).contains(&(clock_s / total_s)) {
                way_mm += distance(span.motion.unwrap().velocity_mm_s, [0.0; 3]) * span.duration_s;
                middle_s += span.duration_s;
            }
            clock_s += span.duration_s;
        }
        // And a little more, by the tolerance as a part of the radius.
        let ratio = way_mm / middle_s / steady;
        assert!(
            (0.999..1.2).contains(&ratio),
            "a {a}, j {j}, R {radius_mm}: {ratio}"
        );
    }
}

#[test]
fn the_circle_of_the_bound_takes_its_time() {
    let circle = || vec![arc([0.0; 3], [0.0; 3], [10.0, 0.0, 0.0], 1, 200.0)];
    let constraints = constraints(200.0, 2000.0, 50_000.0);
    let whole_s = time_s(&spans(&WHOLE_PROGRAM, &constraints, circle()));
    assert!((whole_s / 0.5516 - 1.0).abs() < 5e-4, "{whole_s}");
    let streamed_s = time_s(&spans(
        feed_planner("time-optimal").unwrap(),
        &constraints,
        circle(),
    ));
    assert!(
        streamed_s < 1.002 * whole_s && streamed_s > 0.9999 * whole_s,
        "{streamed_s} {whole_s}"
    );
}

#[test]
fn limits_of_axes_are_asked_for() {
    use feedwright_plan::{Plan, Plc};
    let none = Constraints::from(&LIMITS);
    for member in FEED_PLANNERS.iter().filter(|member| member.needs_axes) {
        let plan = Plan::new(Box::new(std::iter::empty()), &none, member, Plc::default());
        let message = plan.err().unwrap().to_string();
        assert!(message.contains("max_velocity_mm_s"), "{message}");
        let mut bad = constraints(200.0, 2000.0, 50_000.0);
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            bad.axes[1].jerk_mm_s3 = value;
            let plan = Plan::new(Box::new(std::iter::empty()), &bad, member, Plc::default());
            assert!(
                plan.err().unwrap().to_string().contains("max_jerk_mm_s3"),
                "{value}"
            );
        }
    }
}
