//! What further steps of the solver of the receding horizon do to the cut, and what a horizon does to the paper's inversion: `just solvers`,
//! the tables of "Which solver" in examples/02_horizon.
//!
//! The controller is made from `tnv40`; `heavy` meets it unseen. Times are of whole decisions, medians over a cut.

use std::time::{Duration, Instant};

use feedwright::{Statistics, identified};
use feedwright_control::{Controller, Gradient, INVERTING_FEED_PERIOD_S, InvertingSettings, TwoDimensional};
use feedwright_ident::{Excitation, SERVO_FEED_PERIOD_S, Training, train_servo};
use feedwright_lab::{CorrectionLimits, RecedingHorizon, RecedingHorizonSettings, Workpiece};
use feedwright_sim::{Machine, Run, RunResult, Watch};

const CONTOURS: [&str; 3] = ["circle", "star", "square"];
const MACHINES: [&str; 2] = ["tnv40", "heavy"];
/// Seed of all training.
const SEED: u64 = 1;
/// Steps of Gauss and Newton in a tick, each rolled out anew.
const STEPS: [usize; 3] = [1, 2, 5];
/// Knots of the paper's inversion.
const KNOTS: [usize; 3] = [1, 3, 5];

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let machines = MACHINES.map(|name| Machine::load(name.as_ref()));
    let machines = machines.into_iter().collect::<Result<Vec<_>, _>>()?;
    let all = Workpiece::contours();
    let workpieces: Vec<&Workpiece> = CONTOURS.iter().filter_map(|name| all.iter().find(|w| w.name == *name)).collect();
    horizons(&machines, &workpieces)?;
    inversions(&machines[0], workpieces[0])
}

/// Every number of steps of Gauss and Newton on every machine and contour.
fn horizons(machines: &[Machine], workpieces: &[&Workpiece]) -> Result<(), Failure> {
    print!("| RMS / max, um: steps |");
    for machine in machines {
        workpieces.iter().for_each(|workpiece| print!(" {} {} |", machine.name, workpiece.name));
    }
    println!(" decision, us |\n|--:|{}--:|", "--:|".repeat(machines.len() * workpieces.len()));
    for steps in STEPS {
        row(steps, machines, workpieces)?;
    }
    println!();
    Ok(())
}

fn row(steps: usize, machines: &[Machine], workpieces: &[&Workpiece]) -> Result<(), Failure> {
    print!("| {steps} |");
    let mut longest_us = 0.0_f64;
    for machine in machines {
        // What is known of the machine is the first's; the periods of the control are never a secret.
        let known = Machine { period: machine.period, ..machines[0].clone() };
        let identified = train_servo::<2>(&Excitation::servo().record(&known, SEED).0);
        let mut settings = RecedingHorizonSettings { steps, ..RecedingHorizonSettings::DEFAULT };
        settings.horizon.limits = CorrectionLimits::of(&known.known());
        settings.servo_periods = machine.period.servo_periods(SERVO_FEED_PERIOD_S);
        for workpiece in workpieces {
            let mut controller: RecedingHorizon<2> =
                RecedingHorizon::new(identified.net.clone(), &identified.spread, settings);
            let (statistics, run) = cut(machine, workpiece, &mut controller)?;
            print!(" {}{} |", errors(&statistics), if run.faded_out.is_some() { ", taken out" } else { "" });
            longest_us = longest_us.max(run.ticks.quantile_us(0.5));
        }
    }
    println!(" {longest_us:.0} |");
    Ok(())
}

/// The paper's inversion over several knots.
fn inversions(machine: &Machine, workpiece: &Workpiece) -> Result<(), Failure> {
    let trained = identified::<2>(machine, &Excitation::paper(), &Training::default(), SEED, &mut |_| {});
    println!("| {}, {}: knots | gradient | RMS / max, um | time, s | decision, us |", machine.name, workpiece.name);
    println!("|--:|---|--:|--:|--:|");
    for (name, gradient) in [("printed", Gradient::Printed), ("exact", Gradient::Exact)] {
        for knots in KNOTS {
            let mut settings = InvertingSettings { knots, ..InvertingSettings::DEFAULT };
            settings.servo_periods = machine.period.servo_periods(INVERTING_FEED_PERIOD_S);
            settings.inversion.gradient = gradient;
            let mut controller = TwoDimensional::new(trained.net.clone(), settings);
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
    let run = Run::on(machine).watched(&watch).cut_steps(&workpiece.steps, controller, &mut [&mut statistics])?;
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
