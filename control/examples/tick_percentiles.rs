//! Percentiles of the time of a decision of the receding horizon: `just tick`.
//!
//! `tick_percentiles TICKS RUNS`. Timed is the servo period in which the controller decides, whole: reference, register,
//! preview, contour error, plan, safety layer, command. The tool follows the command, so that the plan and the adaptation
//! work on what they did. Caches are warm, which after a sleep of 1 ms they are not.
//!
//! What else runs on the machine only ever makes a tick longer. Of several runs, the one with the least 99.9 % is
//! therefore the nearest to an idle core; the maximum over all runs stands beside it.

#![expect(clippy::unwrap_used, reason = "an example that only the recipe calls")]

#[path = "../benches/rig.rs"]
#[expect(dead_code, reason = "the benches use the rest")]
mod rig;

use std::hint::black_box;
use std::time::Instant;

/// The servo period that the times are a share of.
const SERVO_US: f64 = 1000.0;
/// Shares of the ticks that take no longer, per mille.
const PER_MILLE: [usize; 4] = [500, 990, 999, 1000];

fn main() {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<usize>().unwrap());
    let (ticks, runs) = (arguments.next().unwrap(), arguments.next().unwrap());
    println!("{ticks} decisions, best of {runs} runs: us (share of a servo period of 1 ms)");
    println!("axes knots        median           99 %         99.9 %        maximum   maximum of all runs");
    for knots in [10, 20] {
        report(2, knots, &measure::<2>(knots, ticks, runs));
        report(3, knots, &measure::<3>(knots, ticks, runs));
    }
}

/// The percentiles of each run, us.
fn measure<const N: usize>(knots: usize, ticks: usize, runs: usize) -> Vec<[f64; 4]> {
    (0..runs).map(|_| percentiles(run_us::<N>(knots, ticks))).collect()
}

/// The times of so many decisions, us.
fn run_us<const N: usize>(knots: usize, ticks: usize) -> Vec<f64> {
    let mut rig = rig::Rig::<N, _>::new(rig::horizon(knots), rig::Tool::Follows);
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

/// By nearest rank.
fn percentiles(mut times_us: Vec<f64>) -> [f64; 4] {
    times_us.sort_by(f64::total_cmp);
    PER_MILLE.map(|share| times_us[(times_us.len() * share).div_ceil(1000) - 1])
}

fn report(axes: usize, knots: usize, runs: &[[f64; 4]]) {
    let best = runs.iter().min_by(|a, b| a[2].total_cmp(&b[2])).unwrap();
    let longest_us = runs.iter().map(|run| run[3]).fold(0.0, f64::max);
    print!("{axes:4} {knots:5}");
    best.iter().for_each(|us| print!(" {us:6.1} ({:4.1} %)", 100.0 * us / SERVO_US));
    println!(" {longest_us:6.1}");
}
