//! What a horizon does to the paper's inversion: `just paper-horizon`, the table of "The paper's
//! inversion over a horizon" in examples/02_contours.
//!
//! Times are of whole decisions, medians over a cut.

use std::time::{Duration, Instant};

use feedwright::{Statistics, identified};
use feedwright_control::{
    Controller, Gradient, INVERSION_PERIOD_S, InvertingSettings, TwoDimensional,
};
use feedwright_ident::{Excitation, Training};
use feedwright_lab::Workpiece;
use feedwright_sim::{Machine, Run, RunResult, Watch};

/// Seed of all training.
const SEED: u64 = 1;
/// Knots of the paper's inversion.
const KNOTS: [usize; 3] = [1, 3, 5];

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let machine = Machine::load("tnv40".as_ref())?;
    let all = Workpiece::contours();
    let circle = all
        .iter()
        .find(|workpiece| workpiece.name == "circle")
        .ok_or("there is no circle")?;
    inversions(&machine, circle)
}

/// The paper's inversion over several knots.
fn inversions(machine: &Machine, workpiece: &Workpiece) -> Result<(), Failure> {
    let trained = identified::<2>(
        machine,
        &Excitation::paper(),
        &Training::default(),
        SEED,
        &mut |_| {},
    );
    println!(
        "| {}, {}: knots | gradient | RMS / max, um | time, s | decision, us |",
        machine.name, workpiece.name
    );
    println!("|--:|---|--:|--:|--:|");
    for (name, gradient) in [("printed", Gradient::Printed), ("exact", Gradient::Exact)] {
        for knots in KNOTS {
            let mut settings = InvertingSettings {
                knots,
                ..InvertingSettings::DEFAULT
            };
            settings.servo_periods = machine.period.servo_periods(INVERSION_PERIOD_S.default);
            settings.inversion.gradient = gradient;
            let mut controller = TwoDimensional::untried(trained.net.clone(), settings);
            let (statistics, run) = cut(machine, workpiece, &mut controller)?;
            print!("| {knots} | {name} | {}", errors(&statistics));
            match run.faded_out {
                // From then on nothing is decided.
                Some(_) => println!(", taken out | {:.3} | |", run.time_s),
                None => println!(" | {:.3} | {:.1} |", run.time_s, run.ticks.quantile_us(0.5)),
            }
        }
    }
    Ok(())
}

fn cut(
    machine: &Machine,
    workpiece: &Workpiece,
    controller: &mut dyn Controller<2>,
) -> Result<(Statistics, RunResult), Failure> {
    let mut statistics = Statistics::new();
    let watch = Timer(Instant::now());
    let run = Run::on(machine).watched(&watch).cut_steps(
        &workpiece.steps,
        controller,
        &mut [&mut statistics],
    )?;
    Ok((statistics, run))
}

/// Times the decisions.
struct Timer(Instant);

impl Watch for Timer {
    fn clock(&self) -> Duration {
        self.0.elapsed()
    }
}

fn errors(statistics: &Statistics) -> String {
    format!("{:.2} / {:.1}", statistics.rms_um(), statistics.max_um())
}
