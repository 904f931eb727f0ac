//! Properties of overrides and feed holds on any plan: the tool stays on the planned path, the
//! limits hold, and a hold stops as soon as closed forms allow.

use crate::programs::{BLEND, LIMITS, Random, arc, distance, polyline};
use feedwright_gcode::canon::Canon;
use feedwright_plan::{
    AxisLimits, Constraints, FeedPlanner, PathLimits, Phase, PublishedPlan, ScaledStep,
    ScalingLimits, Span, Step, TimeOptimal, TimeScaling, shortest_stop_mm,
};
use feedwright_sim::path_steps;

const AXIS: AxisLimits = AxisLimits {
    velocity_mm_s: 200.0,
    accel_mm_s2: 2000.0,
    jerk_mm_s3: 50_000.0,
};

/// Part by which a limit may be exceeded: 0.1 %.
const OVER: f64 = 1e-3;

/// The shortest way of a hold that a ratio is taken of. Next to rest the way is a rounding error.
const LEAST_WAY_MM: f64 = 1e-3;

fn limits() -> ScalingLimits {
    ScalingLimits {
        axes: [AXIS; 3],
        speed_mm_s: 200.0,
        period_s: 1e-3,
    }
}

fn published(canon: Vec<Canon>) -> PublishedPlan {
    let path = PathLimits {
        rapid_mm_s: 200.0,
        max_feed_mm_s: 200.0,
        ..LIMITS
    };
    let constraints = Constraints {
        axes: vec![AXIS; 3],
        path_tolerance_mm: Some(0.01),
        ..Constraints::from(&path)
    };
    let mut planner = TimeOptimal::new(&constraints);
    for (i, step) in path_steps(canon).enumerate() {
        let Step::Piece(piece) = step.unwrap() else {
            panic!("motions only")
        };
        planner.push(&piece, i == 0);
    }
    planner.finish();
    let mut plan = PublishedPlan::new();
    while let Some(Span {
        piece,
        from_mm,
        duration_s,
        motion,
        ..
    }) = planner.pop()
    {
        let phase = Phase {
            tau_s: 0.0,
            duration_s,
            piece,
            from_mm,
            speed_mm_s: 0.0,
            accel_mm_s2: 0.0,
            jerk_mm_s3: 0.0,
            motion,
            rest: None,
        };
        assert!(plan.push(&phase, true));
    }
    plan
}

fn square(feed_mm_s: f64) -> PublishedPlan {
    let corners = [
        [0.0; 3],
        [20.0, 0.0, 0.0],
        [20.0, 20.0, 0.0],
        [0.0, 20.0, 0.0],
        [0.0; 3],
    ];
    published(polyline(&corners, feed_mm_s, BLEND))
}

fn circle(feed_mm_s: f64) -> PublishedPlan {
    published(vec![arc(
        [0.0; 3],
        [0.0; 3],
        [10.0, 0.0, 0.0],
        1,
        feed_mm_s,
    )])
}

/// Everything that has to hold in a step.
fn check(name: &str, plan: &PublishedPlan, step: &ScaledStep, most_mm_s: f64) {
    for m in 0..=10 {
        let t = step.duration_s * f64::from(m) / 10.0;
        let (now, motion) = (step.after(t), step.motion(plan, t));
        let planned_mm = plan.at(now.tau_s).position_mm;
        assert!(
            distance(planned_mm, motion.position_mm) < 1e-9,
            "{name}: the path differs from the plan"
        );
        assert!(now.rate >= -1e-12, "{name}: {now:?}");
        for k in 0..3 {
            assert!(
                motion.velocity_mm_s[k].abs() <= (1.0 + OVER) * AXIS.velocity_mm_s,
                "{name}: {motion:?}"
            );
            assert!(
                motion.accel_mm_s2[k].abs() <= (1.0 + OVER) * AXIS.accel_mm_s2,
                "{name}: {motion:?} {step:?}"
            );
            assert!(
                motion.jerk_mm_s3[k].abs() <= (1.0 + OVER) * AXIS.jerk_mm_s3,
                "{name}: {motion:?} {step:?}"
            );
        }
        let speed_mm_s = distance(motion.velocity_mm_s, [0.0; 3]);
        assert!(
            speed_mm_s <= (1.0 + OVER) * most_mm_s,
            "{name}: {speed_mm_s} of {most_mm_s} mm/s, {now:?}"
        );
    }
}

fn stops(scaling: &TimeScaling<'_>) -> bool {
    let now = scaling.now();
    (now.rate == 0.0 && now.slope_1_s == 0.0) || scaling.has_ended()
}

#[test]
fn a_hold_keeps_the_path_and_the_limits_and_comes_to_rest() {
    let mut random = Random(5);
    let points: Vec<[f64; 3]> = (0..12)
        .map(|_| [0, 1, 2].map(|_| random.between(0.0, 9.0)))
        .collect();
    let plans = [
        ("square", square(200.0)),
        ("circle", circle(200.0)),
        ("slow", square(30.0)),
        ("space", published(polyline(&points, 120.0, BLEND))),
    ];
    for (name, plan) in plans {
        for i in 0..6 {
            let mut scaling = TimeScaling::from_moment(
                &plan,
                limits(),
                plan.end_s() * (f64::from(i) + 0.5) / 6.0,
            );
            let mut steps = 0;
            while !stops(&scaling) {
                let from = scaling.now();
                let step = scaling.step(1.0, true);
                assert_eq!(step.from, from, "{name}: steps join");
                check(name, &plan, &step, 200.0);
                steps += 1;
                assert!(
                    steps < 5000,
                    "{name} {i}: does not come to rest: {:?}",
                    scaling.now()
                );
            }
        }
    }
}

#[test]
fn a_hold_at_a_steady_feedrate_takes_the_way_of_the_closed_form() {
    // On a line from F to rest: v^2 / 2 a + v a / 2 j, or v sqrt(v / j) where the acceleration is
    // not reached.
    let line = published(polyline(&[[0.0; 3], [60.0, 0.0, 0.0]], 100.0, BLEND));
    let slow = published(polyline(&[[0.0; 3], [60.0, 0.0, 0.0]], 50.0, BLEND));
    for (plan, v) in [(line, 100.0), (slow, 50.0_f64)] {
        let (a, j) = (AXIS.accel_mm_s2, AXIS.jerk_mm_s3);
        let closed_mm = if v * j > a * a {
            v * v / (2.0 * a) + v * a / (2.0 * j)
        } else {
            v * (v / j).sqrt()
        };
        let tau_s = 0.5 * plan.end_s();
        assert!((shortest_stop_mm(&plan, &[AXIS; 3], tau_s) / closed_mm - 1.0).abs() < 5e-3);
        let mut scaling = TimeScaling::from_moment(&plan, limits(), tau_s);
        while !stops(&scaling) {
            scaling.step(1.0, true);
        }
        let way_mm = plan.length_mm(tau_s, scaling.now().tau_s);
        assert!(
            (0.999..1.01).contains(&(way_mm / closed_mm)),
            "{v}: {way_mm} {closed_mm}"
        );
    }
}

#[test]
fn a_hold_at_the_feedrate_on_a_circle_is_within_five_per_cent_of_the_least_way() {
    let plan = circle(50.0);
    for i in (2..18).step_by(3) {
        let tau_s = plan.end_s() * f64::from(i) / 20.0;
        let mut scaling = TimeScaling::from_moment(&plan, limits(), tau_s);
        while !stops(&scaling) {
            scaling.step(1.0, true);
        }
        let ratio =
            plan.length_mm(tau_s, scaling.now().tau_s) / shortest_stop_mm(&plan, &[AXIS; 3], tau_s);
        assert!((0.99..1.05).contains(&ratio), "{i}: {ratio}");
    }
}

/// Checks a hold from rest on a line at constant jerk j: the shortest stop takes -j for twice the
/// time that has passed, then j for that time once more.
#[test]
fn a_hold_while_the_speed_rises_is_within_five_per_cent_or_six_micrometres_of_the_least_way() {
    let plan = published(polyline(&[[0.0; 3], [60.0, 0.0, 0.0]], 200.0, BLEND));
    for t in [
        0.001, 0.002, 0.005, 0.008, 0.009, 0.01, 0.012, 0.02, 0.03, 0.05,
    ] {
        let mut scaling = TimeScaling::from_moment(
            &plan,
            ScalingLimits {
                period_s: 2.5e-4,
                ..limits()
            },
            t,
        );
        while !stops(&scaling) {
            let step = scaling.step(1.0, true);
            check("line", &plan, &step, 200.0);
        }
        let way_mm = plan.length_mm(t, scaling.now().tau_s);
        let least_mm = shortest_stop_mm(&plan, &[AXIS; 3], t);
        if 4.0 * t < 0.1 {
            let closed_mm = AXIS.jerk_mm_s3 * t.powi(3) * (2.0 - 1.0 / 6.0);
            assert!(
                (least_mm / closed_mm - 1.0).abs() < 0.1,
                "{t}: {least_mm} {closed_mm}"
            );
        }
        assert!(
            way_mm < 1.05 * least_mm || way_mm < least_mm + 0.006,
            "{t}: {way_mm} {least_mm}"
        );
    }
}

#[test]
fn overrides_change_the_time_alone() {
    for (name, plan) in [("circle", circle(60.0))] {
        let mut times = Vec::new();
        for override_of_feeds in [0.1, 0.5, 1.0, 1.4, 2.0] {
            let mut scaling = TimeScaling::new(&plan, limits());
            let mut time_s = 0.0;
            while !scaling.has_ended() {
                let step = scaling.step(override_of_feeds, false);
                check(name, &plan, &step, 60.0 * override_of_feeds);
                time_s += step.duration_s;
            }
            times.push(time_s);
        }
        let ratios: Vec<f64> = times.iter().map(|time_s| time_s / plan.end_s()).collect();
        assert!(
            (ratios[0] - 10.0).abs() < 0.02 && (ratios[1] - 2.0).abs() < 0.02,
            "{name}: {ratios:?}"
        );
        assert!(
            (ratios[2] - 1.0).abs() < 2e-3 && ratios[3] < 0.95 && ratios[4] < ratios[3],
            "{name}: {ratios:?}"
        );
    }
}

#[test]
fn after_a_hold_the_motion_goes_on_to_the_end() {
    let plan = circle(60.0);
    let mut scaling = TimeScaling::new(&plan, limits());
    let mut time_s = 0.0;
    while !scaling.has_ended() {
        // Override up and down, and a hold of a tenth of a second now and then.
        let hold = (0.3..0.7).contains(&time_s) || (0.9..1.1).contains(&time_s);
        let override_of_feeds = if ((time_s * 4.0) as u32).is_multiple_of(2) {
            0.6
        } else {
            1.6
        };
        let step = scaling.step(override_of_feeds, hold);
        check("up and down", &plan, &step, 60.0 * 1.6);
        time_s += step.duration_s;
        assert!(time_s < 10.0, "does not end: {:?}", scaling.now());
    }
    assert!(time_s > plan.end_s() + 0.2);
}

/// Sequences of overrides and holds at random moments, and those of the sweep.
const SEQUENCES: u64 = 16;
const MANY_SEQUENCES: u64 = 1000;
/// Regression seeds: 606 and 678 once exceeded a jerk limit at the end of a plan; in 504 the least
/// distance was once computed for an axis at rest.
const ONCE_BEYOND: [u64; 3] = [606, 678, 504];

/// Returns, for each hold from 100 % in a sequence, the stopping distance divided by the distance
/// that the axes need, each by itself.
fn sequence(name: &str, plan: &PublishedPlan, feed_mm_s: f64, seed: u64) -> Vec<f64> {
    let mut random = Random(seed);
    let mut scaling = TimeScaling::new(plan, limits());
    let (mut override_of_feeds, mut hold, mut until_s, mut time_s, mut holds) =
        (1.0, false, 0.0, 0.0, Vec::new());
    let (mut most, mut began): (f64, Option<(f64, f64)>) = (1.0, None);
    while !scaling.has_ended() {
        if time_s >= until_s {
            // From the twentieth second on it is let go, so that it ends.
            let goes_on = time_s > 20.0;
            hold = !goes_on && random.between(0.0, 1.0) < 0.3;
            let is_whole = goes_on || random.between(0.0, 1.0) < 0.3;
            override_of_feeds = if is_whole {
                1.0
            } else {
                random.between(0.0, 2.0)
            };
            until_s = time_s + random.between(0.0, 0.3);
            most = most.max(override_of_feeds);
            let now = scaling.now();
            let steady = now.rate == 1.0 && now.slope_1_s == 0.0;
            began = (hold && steady)
                .then(|| (now.tau_s, shortest_stop_mm(plan, &[AXIS; 3], now.tau_s)))
                .filter(|&(_, least_mm)| least_mm > LEAST_WAY_MM);
        }
        let step = scaling.step(override_of_feeds, hold);
        check(name, plan, &step, feed_mm_s * most);
        time_s += step.duration_s;
        // A hold that the end of the plan overtakes has no way of its own.
        if let Some((tau_s, least_mm)) = began.filter(|_| stops(&scaling) && !scaling.has_ended()) {
            let way_mm = plan.length_mm(tau_s, scaling.now().tau_s);
            holds.push(way_mm / least_mm);
            began = None;
        }
        assert!(
            time_s < 200.0,
            "{name}, seed {seed}: does not end: {:?}",
            scaling.now()
        );
    }
    holds
}

fn sequences(seeds: impl Iterator<Item = u64>) {
    let (mut holds, mut count) = (Vec::new(), 0);
    for seed in seeds {
        count += 1;
        let mut random = Random(1000 + seed);
        let feed_mm_s = random.between(5.0, 200.0);
        let plan = match seed % 4 {
            0 => square(feed_mm_s),
            1 => circle(feed_mm_s),
            2 => {
                let points: Vec<[f64; 3]> = (0..8)
                    .map(|_| [0, 1, 2].map(|_| random.between(0.0, 9.0)))
                    .collect();
                published(polyline(&points, feed_mm_s, BLEND))
            }
            _ => {
                let zigzag: Vec<[f64; 3]> = (0..12)
                    .map(|i| [f64::from(i), f64::from(i % 2) * 0.7, 0.0])
                    .collect();
                published(polyline(&zigzag, feed_mm_s, BLEND))
            }
        };
        holds.extend(sequence("random", &plan, feed_mm_s, seed));
    }
    holds.sort_by(f64::total_cmp);
    let parts =
        [0.0, 0.25, 0.5, 0.75, 1.0].map(|part| holds[(part * (holds.len() - 1) as f64) as usize]);
    eprintln!(
        "{count} sequences, {} holds, {} of them above 1.05, ways over the least: {parts:.3?} (least, quartiles, largest)",
        holds.len(),
        holds.iter().filter(|&&ratio| ratio > 1.05).count()
    );
    assert!(
        parts[0] > 0.99,
        "no way is shorter than the least: {parts:?}"
    );
}

#[test]
fn overrides_and_holds_at_random_moments_keep_the_path_and_the_limits() {
    sequences((1..=SEQUENCES).chain(ONCE_BEYOND));
}

#[test]
#[ignore = "a sweep, minutes: just sweep"]
fn a_thousand_sequences_of_overrides_and_holds_keep_the_path_and_the_limits() {
    sequences(1..=MANY_SEQUENCES);
}
