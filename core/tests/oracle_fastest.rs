//! Least time within a tolerance of the tool, against the least time of a nonlinear program for the same servo.
//!
//! The servo is linear, `x' = v`, `v' = a (k (r - x) - v)` with k = 50 and a = 194 and 167 1/s. The published times are those of the
//! command on the path, as fast as leaves the tool within 10 um.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

use feedwright::fastest::fastest;
use feedwright::gcode::canon::Corner;
use feedwright::machine::Machine;
use feedwright::path::contour::contour;
use feedwright_control::controller::open_loop::OpenLoop;

fn linear() -> Machine {
    let mut machine = Machine::load("tnv40".as_ref()).unwrap();
    machine.period.servo_s = 1e-4;
    machine.period.mechanics_s = 1e-4;
    machine.period.mechanics_per_servo = 1;
    machine.limits.rapid_mm_s = 200.0;
    for axis in &mut machine.axes {
        (axis.viscous_friction_nm_s, axis.coulomb_friction_nm, axis.disturbance_nm) = (0.0, 0.0, 0.0);
        axis.torque_limit_nm = 1e3;
        axis.max_velocity_mm_s = Some(200.0);
        axis.max_accel_mm_s2 = Some(2000.0);
        axis.max_jerk_mm_s3 = Some(50_000.0);
    }
    machine
}

#[test]
#[ignore = "plans and cuts a circle some twenty times: cargo test --release --test oracle_fastest -- --ignored"]
fn a_circle_is_cut_in_the_least_time_of_open_loop() {
    let steps =
        contour("circle").unwrap().steps(200.0, Corner::Continuous { tolerance_mm: None, merge_mm: None }).unwrap();
    let machine = linear();
    let all = || Ok(Box::new(steps.iter().cloned().map(Ok)) as feedwright::path::Steps<'_>);
    let plan = fastest::<2>(&machine, 10.0, all, &mut OpenLoop, 1, &()).unwrap();
    let time_s = plan.cycle.cutting_s;
    assert!(plan.largest_um <= 10.0, "{}", plan.largest_um);
    assert!((0.99..1.03).contains(&(time_s / 1.921)), "{time_s} s in {} rounds", plan.rounds);
}

#[test]
fn a_machine_without_limits_of_its_axes_is_refused() {
    let steps =
        contour("circle").unwrap().steps(200.0, Corner::Continuous { tolerance_mm: None, merge_mm: None }).unwrap();
    let all = || Ok(Box::new(steps.iter().cloned().map(Ok)) as feedwright::path::Steps<'_>);
    let mut bare = linear();
    bare.axes[1].max_jerk_mm_s3 = None;
    let error = fastest::<2>(&bare, 10.0, all, &mut OpenLoop, 1, &()).unwrap_err();
    assert!(error.to_string().contains("no limits of their own"), "{error}");
}
