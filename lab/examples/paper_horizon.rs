//! What a horizon does to the paper's inversion: `just paper-horizon`, the table of "The paper's
//! inversion over a horizon" in examples/02_contours.
//!
//! Times are of whole decisions, medians over a cut.

use std::time::{Duration, Instant};

use feedwright::{Statistics, identified};
use feedwright_control::{Gradient, INVERSION_PERIOD_S, InvertingSettings, TwoDimensional};
use feedwright_ident::{Excitation, Training};
use feedwright_lab::compare::FEED_MM_S;
use feedwright_lab::{CORNER, contour};
use feedwright_sim::{Machine, Run, Watch};

/// Seed of all training.
const SEED: u64 = 1;
/// Knots of the paper's inversion.
const KNOTS: [usize; 3] = [1, 3, 5];

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let machine = Machine::load("tnv40".as_ref())?;
    let circle = contour("circle").ok_or("there is no circle")?;
    let steps = circle.steps(FEED_MM_S, CORNER)?;
    let (excitation, training) = (Excitation::paper(), Training::default());
    let trained = identified::<2>(&machine, &excitation, &training, SEED, &mut |_| {});
    let name = &machine.name;
    println!("| {name}, circle: knots | gradient | RMS / max, um | time, s | decision, us |");
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
            let (mut statistics, watch) = (Statistics::new(), Timer(Instant::now()));
            let run = Run::on(&machine).watched(&watch);
            let run = run.cut_steps(&steps, &mut controller, &mut [&mut statistics])?;
            let [rms_um, max_um] = [statistics.rms_um(), statistics.max_um()];
            print!("| {knots} | {name} | {rms_um:.2} / {max_um:.1}");
            match run.faded_out {
                // From then on nothing is decided.
                Some(_) => println!(", taken out | {:.3} | |", run.time_s),
                None => println!(" | {:.3} | {:.1} |", run.time_s, run.ticks.quantile_us(0.5)),
            }
        }
    }
    Ok(())
}

/// Times the decisions.
struct Timer(Instant);

impl Watch for Timer {
    fn clock(&self) -> Duration {
        self.0.elapsed()
    }
}
