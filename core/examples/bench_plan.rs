//! The table of the time-optimal planner: for each program the bound, each path from rest to rest planned as a whole, and the streaming
//! planner in the same run; how much of each limit is used, sampled at 0.1 ms; the deviation; blocks a second.
//!
//!     cargo run --release -p feedwright --example bench_plan [PROGRAM.ngc...]
//!
//! Without arguments: parts/, and ../shared/planner where it is. All axes 200 mm/s, 2000 mm/s2, 50,000 mm/s3, tolerance 10 um. Whole
//! programs, lead-in included; rests are left out of both times.

use std::path::{Path, PathBuf};
use std::time::Instant;

use feedwright::cycle_time::cycle_time;
use feedwright::gcode::{Reader, Settings};
use feedwright::machine::Machine;
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
        "{:<18} {:>7} {:>9} {:>9} {:>7} {:>10} {:>8} {:>9} {:>9}",
        "", "blocks", "bound s", "time s", "ratio", "of limits", "um", "blocks/s", "x real"
    );
    for program in programs {
        let steps = || Ok(pieces(Reader::open(&program, Settings::default())?.map_while(Result::ok)));
        let begun = Instant::now();
        let found = cycle_time(&machine, false, steps, &())?;
        let took_s = begun.elapsed().as_secs_f64();
        let bound_s = cycle_time(&machine, true, steps, &())?.bound_s.unwrap_or(f64::NAN);
        let time_s = found.cutting_s + found.rapid_s;
        println!(
            "{:<18} {:>7} {bound_s:>9.4} {time_s:>9.4} {:>7.4} {:>10.7} {:>8.3} {:>9.0} {:>9.1}",
            program.file_stem().unwrap_or_default().to_string_lossy(),
            found.blocks,
            time_s / bound_s,
            found.largest_violation.unwrap_or(f64::NAN),
            found.largest_deviation_um,
            found.blocks as f64 / took_s,
            time_s / took_s
        );
    }
    Ok(())
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
