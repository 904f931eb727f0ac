//! Least time within a tolerance of the tool, against the least time of a nonlinear program for the
//! same servo.
//!
//! The servo is linear, `x' = v`, `v' = a (k (r - x) - v)` with k = 50 and a = 194 and 167 1/s. The
//! published times are those of the command on the path, as fast as leaves the tool within 10 um.

use feedwright::{FastestPlan, fastest};
use feedwright_gcode::canon::Corner;
use feedwright_lab::{contour, linear_machine};
use feedwright_plan::Steps;
use feedwright_sim::BoxedController;

/// Least times of the nonlinear program, s; of the butterfly the best that was found.
const LEAST_S: [(&str, f64); 4] = [
    ("circle", 1.921),
    ("star", 4.385),
    ("eight", 2.599),
    ("butterfly", 9.957),
];

fn planned(name: &str, tolerance_um: f64) -> FastestPlan {
    let corner = Corner::Continuous {
        tolerance_mm: None,
        merge_mm: None,
    };
    let steps = contour(name).unwrap().steps(200.0, corner).unwrap();
    let all = || Ok(Box::new(steps.iter().cloned().map(Ok)) as Steps<'_>);
    let plan = fastest(
        &linear_machine(10.0),
        tolerance_um,
        all,
        &mut BoxedController::uncorrected(2),
        1,
        &(),
    )
    .unwrap();
    assert!(
        plan.largest_um <= tolerance_um,
        "{name}: {} um",
        plan.largest_um
    );
    plan
}

/// Planned and cut some twenty times, within 3 % of the nonlinear program.
fn is_cut_in_the_least_time(name: &str, least_s: f64) {
    let plan = planned(name, 10.0);
    let ratio = plan.cycle.cutting_s / least_s;
    assert!(
        (0.99..1.03).contains(&ratio),
        "{name}: {ratio} in {} rounds",
        plan.rounds
    );
}

#[test]
fn the_circle_is_cut_in_the_least_time_of_uncorrected() {
    let [(name, least_s), ..] = LEAST_S;
    is_cut_in_the_least_time(name, least_s);
}

#[test]
#[ignore = "a sweep, the butterfly alone takes minutes: just sweep"]
fn contours_are_cut_in_the_least_time_of_uncorrected() {
    for (name, least_s) in LEAST_S {
        is_cut_in_the_least_time(name, least_s);
    }
}

/// A steady circle of radius R at w lets an axis of gain `|G(jw)|`, `G = 1 / (1 + s / k + s^2 /
/// ak)`, cut inside by `(1 - |G|) R`: the speed at which the better axis is at the tolerance is
/// faster than any steady one, the other's slower.
#[test]
fn a_circle_takes_as_long_as_at_the_speed_of_its_error() {
    let tolerance_um = 100.0;
    let machine = linear_machine(10.0);
    let turn_s = machine.axes.iter().take(2).map(|axis| {
        let (k, a) = (axis.kp_1_s, axis.kv_nm_s_per_rad / axis.inertia_kg_m2);
        let missed_um = |w: f64| 1e4 * (1.0 - 1.0 / (1.0 - w * w / (a * k)).hypot(w / k));
        let (mut low, mut high) = (0.1, 100.0);
        for _ in 0..60 {
            let w = 0.5 * (low + high);
            if missed_um(w) > tolerance_um {
                high = w;
            } else {
                low = w;
            }
        }
        std::f64::consts::TAU / low
    });
    let [fast_s, slow_s] = turn_s
        .collect::<Vec<_>>()
        .try_into()
        .map(|[x, y]: [f64; 2]| [x.min(y), x.max(y)])
        .unwrap();
    let time_s = planned("circle", tolerance_um).cycle.cutting_s;
    // From rest to a speed v and back takes v / a + a / j more than the way at v, with acceleration
    // a and jerk j of one axis.
    let with_ends =
        |turn_s: f64| turn_s + 10.0 * std::f64::consts::TAU / turn_s / 2000.0 + 2000.0 / 50_000.0;
    let [fast_s, slow_s] = [fast_s, slow_s].map(with_ends);
    assert!(
        (0.97 * fast_s..1.03 * slow_s).contains(&time_s),
        "{time_s} s, {fast_s} to {slow_s} s"
    );
}

#[test]
fn a_missing_jerk_is_the_one_that_reaches_the_acceleration_in_40_ms() {
    let steps = contour("circle")
        .unwrap()
        .steps(
            200.0,
            Corner::Continuous {
                tolerance_mm: None,
                merge_mm: None,
            },
        )
        .unwrap();
    let all = || Ok(Box::new(steps.iter().cloned().map(Ok)) as Steps<'_>);
    let mut bare = linear_machine(10.0);
    let jerk_mm_s3 = bare.axes[1].max_jerk_mm_s3.take().unwrap();
    assert_eq!(jerk_mm_s3, bare.axes[1].max_accel_mm_s2.unwrap() / 0.04);
    let [found, known] = [bare, linear_machine(10.0)].map(|machine| {
        fastest(
            &machine,
            10.0,
            all,
            &mut BoxedController::uncorrected(2),
            1,
            &(),
        )
        .unwrap()
    });
    assert_eq!(found.cycle, known.cycle);
}
