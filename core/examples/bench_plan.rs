//! The table of the time-optimal planner: for each program the bound, each path from rest to rest planned as a whole, and the streaming
//! planner in the same run; how much of each limit is used, sampled at 0.1 ms; the deviation; what planning takes.
//!
//!     cargo run --release -p feedwright --example bench_plan [PROGRAM.ngc...]
//!
//! Without arguments: parts/, and ../shared/planner where it is. All axes 200 mm/s, 2000 mm/s2, 50,000 mm/s3, tolerance 10 um. Whole
//! programs, lead-in included; rests are left out of both times. `blocks/s` and `x real` are those of the planner alone on one core:
//! `push` and `pop`, without reading and sampling, in processor time where the system tells it. `latest` is the 99.9th percentile, over all calls that committed motion, of the time
//! of a call by the motion that it committed: below 0.5 the motion never waits for a planner that begins when half of it is left.

use std::path::{Path, PathBuf};
use std::time::Instant;

use feedwright::constraints::Constraints;
use feedwright::cycle_time::cycle_time;
use feedwright::feed::FeedPlanner;
use feedwright::feed::time_optimal::{PlanCounts, TimeOptimal};
use feedwright::gcode::{Reader, Settings};
use feedwright::machine::Machine;
use feedwright::path::Step;
use feedwright::pipeline::pieces;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut programs: Vec<PathBuf> = std::env::args().skip(1).map(PathBuf::from).collect();
    if programs.is_empty() {
        for folder in ["parts", "../shared/planner"] {
            programs.extend(programs_in(Path::new(folder)));
        }
    }
    let mut machine = Machine::load("tnv40".as_ref())?;
    machine.limits.rapid_mm_s = 200.0;
    machine.limits.max_feed_mm_s = 200.0;
    machine.limits.path_tolerance_um = Some(10.0);
    for axis in &mut machine.axes {
        axis.max_velocity_mm_s = Some(200.0);
        axis.max_accel_mm_s2 = Some(2000.0);
        axis.max_jerk_mm_s3 = Some(50_000.0);
    }
    println!(
        "{:<16} {:>7} {:>9} {:>9} {:>7} {:>10} {:>7} {:>9} {:>7} {:>7} {:>8} {:>7} {:>6}",
        "",
        "blocks",
        "bound s",
        "time s",
        "ratio",
        "of limits",
        "um",
        "blocks/s",
        "x real",
        "latest",
        "windows",
        "steps",
        "failed"
    );
    for program in programs {
        let steps = || {
            Ok::<_, feedwright::gcode::ReadError>(pieces(
                Reader::open(&program, Settings::default())?.map_while(Result::ok),
            ))
        };
        let read: Vec<Step> = steps()?.map_while(Result::ok).collect();
        let alone = Alone::of(&Constraints::from(&machine), &read);
        let found = cycle_time(&machine, true, steps, &())?;
        let bound_s = found.bound_s.unwrap_or(f64::NAN);
        let time_s = found.cutting_s + found.rapid_s;
        let PlanCounts { windows, iterations, failed, .. } = alone.counts;
        println!(
            "{:<16} {:>7} {bound_s:>9.4} {time_s:>9.4} {:>7.4} {:>10.7} {:>7.3} {:>9.0} {:>7.1} {:>7.3} {windows:>8} {iterations:>7} \
             {failed:>6}",
            program.file_stem().unwrap_or_default().to_string_lossy(),
            found.blocks,
            time_s / bound_s,
            found.largest_violation.unwrap_or(f64::NAN),
            found.largest_deviation_um,
            found.blocks as f64 / alone.took_s,
            alone.motion_s / alone.took_s,
            alone.latest,
        );
    }
    Ok(())
}

/// What the planner does, and nothing else.
struct Alone {
    motion_s: f64,
    took_s: f64,
    latest: f64,
    counts: PlanCounts,
}

impl Alone {
    fn of(constraints: &Constraints, steps: &[Step]) -> Self {
        let mut planner = TimeOptimal::new(constraints);
        let mut alone = Self { motion_s: 0.0, took_s: 0.0, latest: f64::NAN, counts: PlanCounts::default() };
        let mut latenesses = Vec::new();
        let mut from_rest = true;
        let (begun, begun_s) = (Instant::now(), processor_s());
        for step in steps {
            let Step::Piece(piece) = step else {
                from_rest = true;
                continue;
            };
            alone.call(&mut planner, &mut latenesses, |planner| planner.push(piece, from_rest));
            from_rest = false;
        }
        alone.call(&mut planner, &mut latenesses, FeedPlanner::finish);
        let used_s = processor_s().zip(begun_s).map(|(now_s, begun_s)| now_s - begun_s);
        alone.took_s = used_s.unwrap_or_else(|| begun.elapsed().as_secs_f64());
        latenesses.sort_by(f64::total_cmp);
        alone.latest =
            latenesses.get((latenesses.len() * 999).div_ceil(1000).saturating_sub(1)).copied().unwrap_or(f64::NAN);
        alone.counts = planner.counts();
        alone
    }

    fn call(&mut self, planner: &mut TimeOptimal, latenesses: &mut Vec<f64>, call: impl FnOnce(&mut TimeOptimal)) {
        let begun = Instant::now();
        call(planner);
        let motion_s: f64 = std::iter::from_fn(|| planner.pop()).map(|span| span.duration_s).sum();
        self.motion_s += motion_s;
        if motion_s > 0.0 {
            latenesses.push(begun.elapsed().as_secs_f64() / motion_s);
        }
    }
}

/// Processor time of this thread, s, where the system tells it (Linux).
fn processor_s() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(1e-9 * text.split_whitespace().next()?.parse::<f64>().ok()?)
}

/// The programs of a folder by name; none where it is not there.
fn programs_in(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = std::fs::read_dir(folder) else {
        eprintln!("no programs at {}", folder.display());
        return Vec::new();
    };
    let mut found: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    found.retain(|path| path.extension().is_some_and(|extension| extension == "ngc"));
    found.sort();
    found
}
