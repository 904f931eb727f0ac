//! Least times in which the tool stays within 10 um of the contours: `just least-time`, the second table of examples/04_planner.
//!
//! `least_time [CONTOUR..]` looks for them uncorrected on the linear servo of `oracle_fastest`, and with two controllers on `tnv40`, each with axes of
//! 200 mm/s, 2000 mm/s2 and 50,000 mm/s3.

use std::time::Instant;

use feedwright::{BASELINE, Choices, FastestError, Make, Setup, fastest};
use feedwright_gcode::canon::Corner;
use feedwright_lab::{CONTROLLERS, HORIZON, contour};
use feedwright_plan::Steps;
use feedwright_sim::Machine;

const CONTOURS: [&str; 5] = ["circle", "square", "eight", "star", "butterfly"];
/// The controller that `run` takes.
const DEFAULT: &str = "lqg-identified";
const TOLERANCE_UM: f64 = 10.0;
const FEED_MM_S: f64 = 200.0;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut names: Vec<String> = std::env::args().skip(1).collect();
    if names.is_empty() {
        names = CONTOURS.map(str::to_owned).to_vec();
    }
    let tnv40 = with_limits(Machine::load("tnv40".as_ref())?);
    let linear = linear(tnv40.clone());
    println!("| Contour | Controller | bound s | time s | ratio | largest error um | path's um | cuts | took s |");
    println!("|---|---|--:|--:|--:|--:|--:|--:|--:|");
    for name in &names {
        for (machine, controller) in [(&linear, BASELINE), (&tnv40, HORIZON), (&tnv40, DEFAULT)] {
            println!("| {name} | {controller} | {} |", row(name, machine, controller)?);
        }
    }
    Ok(())
}

/// 200 mm/s, 2000 mm/s2 and 50,000 mm/s3 in each axis.
fn with_limits(mut machine: Machine) -> Machine {
    machine.limits.rapid_mm_s = FEED_MM_S;
    machine.limits.max_feed_mm_s = FEED_MM_S;
    machine.limits.path_tolerance_um = Some(TOLERANCE_UM);
    for axis in &mut machine.axes {
        axis.max_velocity_mm_s = Some(200.0);
        axis.max_accel_mm_s2 = Some(2000.0);
        axis.max_jerk_mm_s3 = Some(50_000.0);
    }
    machine
}

/// `x' = v`, `v' = a (k (r - x) - v)` at 10 kHz: nothing but the two loops.
fn linear(mut machine: Machine) -> Machine {
    (machine.period.servo_s, machine.period.mechanics_s, machine.period.mechanics_per_servo) = (1e-4, 1e-4, 1);
    for axis in &mut machine.axes {
        (axis.viscous_friction_nm_s, axis.coulomb_friction_nm, axis.disturbance_nm) = (0.0, 0.0, 0.0);
        axis.torque_limit_nm = 1e3;
    }
    machine
}

fn row(name: &str, machine: &Machine, controller: &str) -> Result<String, Failure> {
    let begun = Instant::now();
    let corner = Corner::Continuous { tolerance_mm: None, merge_mm: None };
    let steps = contour(name).ok_or("there is no such contour")?.steps(FEED_MM_S, corner)?;
    let all = || Ok(Box::new(steps.iter().cloned().map(Ok)) as Steps<'_>);
    let choices = Choices::default();
    let entry = CONTROLLERS.find(controller).ok_or("there is no such controller")?;
    let mut controller = Make::<2>::make(entry, &mut Setup::new(machine, &choices));
    let plan = match fastest::<2>(machine, TOLERANCE_UM, all, &mut *controller, entry.laps, &()) {
        Err(error @ FastestError::Impossible { .. }) => return Ok(error.to_string()),
        plan => plan?,
    };
    let (bound_s, time_s) = (plan.cycle.bound_s.unwrap_or(f64::NAN), plan.cycle.cutting_s);
    Ok(format!(
        "{bound_s:.4} | {time_s:.4} | {:.4} | {:.3} | {:.2} | {} | {:.0}",
        time_s / bound_s,
        plan.largest_um,
        plan.machine.limits.path_tolerance_um.unwrap_or(f64::NAN),
        plan.rounds,
        begun.elapsed().as_secs_f64()
    ))
}
