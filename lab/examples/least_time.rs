//! Least times in which the tool stays within 10 um of the contours: `just least-time`, the second
//! table of examples/04_planner.
//!
//! `least_time [CONTOUR..]` looks for them uncorrected on the linear servo of `oracle_fastest`, and
//! with the default controller on `tnv40`, each with axes of 200 mm/s, 2000 mm/s2 and 50,000 mm/s3.

use std::time::Instant;

use feedwright::{BASELINE, Choices, FastestError, Make, Setup, fastest};
use feedwright_lab::{
    CONTROLLERS, CORNER, LIMITED_FEED_MM_S, contour, limited_machine, linear_machine,
};
use feedwright_plan::Steps;
use feedwright_sim::Machine;

const CONTOURS: [&str; 5] = ["circle", "square", "eight", "star", "butterfly"];
/// The controller that `run` takes.
const DEFAULT: &str = "lqg-identified";
const TOLERANCE_UM: f64 = 10.0;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut names: Vec<String> = std::env::args().skip(1).collect();
    if names.is_empty() {
        names = CONTOURS.map(str::to_owned).to_vec();
    }
    let (tnv40, linear) = (limited_machine(TOLERANCE_UM), linear_machine(TOLERANCE_UM));
    println!(
        "| Contour | Controller | bound s | time s | ratio | largest error um | path's um | cuts | took s |"
    );
    println!("|---|---|--:|--:|--:|--:|--:|--:|--:|");
    for name in &names {
        for (machine, controller) in [(&linear, BASELINE), (&tnv40, DEFAULT)] {
            let row = row(name, machine, controller)?;
            println!("| {name} | {controller} | {row} |");
        }
    }
    Ok(())
}

fn row(name: &str, machine: &Machine, controller: &str) -> Result<String, Failure> {
    let begun = Instant::now();
    let contour = contour(name).ok_or("there is no such contour")?;
    let steps = contour.steps(LIMITED_FEED_MM_S, CORNER)?;
    let all = || Ok(Box::new(steps.iter().cloned().map(Ok)) as Steps<'_>);
    let choices = Choices::default();
    let entry = CONTROLLERS
        .find(controller)
        .ok_or("there is no such controller")?;
    let mut controller = entry.make(&mut Setup::new(machine, &choices), 2);
    let plan = match fastest(machine, TOLERANCE_UM, all, &mut controller, entry.laps, &()) {
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
