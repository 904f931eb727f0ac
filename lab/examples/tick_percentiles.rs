//! Percentiles of the time of a decision of the regulator, which decides in every servo period:
//! `just tick`.
//!
//! `tick_percentiles TICKS RUNS`. Timed is the servo period in which the controller decides, whole:
//! reference, register, preview, contour error, plan, supervisor, command. The tool follows the
//! command, so that the observer works on what it did. Caches are warm, which after a sleep of 1 ms
//! they are not.
//!
//! What else runs on the machine only ever makes a tick longer. Of several runs, the one with the
//! least 99.9 % is therefore the nearest to an idle core; the maximum over all runs stands beside
//! it.

#![expect(clippy::unwrap_used, reason = "an example that only the recipe calls")]

#[path = "../benches/rig.rs"]
#[expect(dead_code, reason = "the benches use the rest")]
mod rig;

use std::hint::black_box;
use std::time::Instant;

use feedwright_control::Controller;

/// The servo period that the times are a share of.
const SERVO_US: f64 = 1000.0;
/// Shares of the ticks that take no longer, per mille.
const PER_MILLE: [usize; 4] = [500, 990, 999, 1000];

fn main() {
    let mut arguments = std::env::args()
        .skip(1)
        .map(|a| a.parse::<usize>().unwrap());
    let (ticks, runs) = (arguments.next().unwrap(), arguments.next().unwrap());
    println!("{ticks} decisions, best of {runs} runs: us (share of a servo period of 1 ms)");
    println!(
        "{:34}  median           99 %         99.9 %        maximum   maximum of all runs",
        "controller, axes"
    );
    for (name, gives) in [
        ("regulator", false),
        ("regulator, ball screw that gives", true),
    ] {
        report(
            name,
            2,
            &measure(|| rig::regulator::<2>(gives), ticks, runs),
        );
        report(
            name,
            3,
            &measure(|| rig::regulator::<3>(gives), ticks, runs),
        );
    }
}

/// The percentiles of each run, us.
fn measure<const N: usize, C: Controller<N>>(
    controller: impl Fn() -> C,
    ticks: usize,
    runs: usize,
) -> Vec<[f64; 4]> {
    (0..runs)
        .map(|_| percentiles(run_us(controller(), ticks)))
        .collect()
}

/// The times of `ticks` decisions, us.
fn run_us<const N: usize, C: Controller<N>>(controller: C, ticks: usize) -> Vec<f64> {
    let mut rig = rig::Rig::new(controller, rig::Tool::Follows);
    let mut times_us = Vec::with_capacity(ticks);
    while times_us.len() < ticks {
        let start = Instant::now();
        let setpoint = black_box(&mut rig).servo_period();
        let time_us = start.elapsed().as_secs_f64() * 1e6;
        if black_box(setpoint).decided {
            times_us.push(time_us);
        }
    }
    rig.expect_in_the_loop();
    times_us
}

/// Returns the percentiles by nearest rank.
fn percentiles(mut times_us: Vec<f64>) -> [f64; 4] {
    times_us.sort_by(f64::total_cmp);
    PER_MILLE.map(|share| times_us[(times_us.len() * share).div_ceil(1000) - 1])
}

fn report(name: &str, axes: usize, runs: &[[f64; 4]]) {
    let best = runs.iter().min_by(|a, b| a[2].total_cmp(&b[2])).unwrap();
    let longest_us = runs.iter().map(|run| run[3]).fold(0.0, f64::max);
    print!("{:34}", format!("{name}, {axes}"));
    best.iter()
        .for_each(|us| print!(" {us:6.1} ({:4.1} %)", 100.0 * us / SERVO_US));
    println!(" {longest_us:6.1}");
}
