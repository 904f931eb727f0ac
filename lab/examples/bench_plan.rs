//! The table of the time-optimal planner: for each program the bound, each path from rest to rest
//! as a whole, the streaming planner and the model of LinuxCNC's planner in the same run; how much
//! of each limit is used, sampled at 0.1 ms; the deviation; what planning takes.
//!
//!     cargo run --release -p feedwright-lab --example bench_plan [PROGRAM.ngc...]
//!
//! Without arguments: parts/, and ../shared/planner where it is. All axes 200 mm/s, 2000 mm/s2,
//! 50,000 mm/s3, tolerance 10 um. The motion alone: rests are left out of all times, and so are
//! rapids that lead from the origin to a rest before the first cut. `bound` holds the tolerance at
//! the nodes of the whole path only, `whole` everywhere. `blocks/s`, `x real`, `latest` and `MiB`
//! describe the planner alone on one core: `push` and `pop`, without reading and sampling, in
//! processor time where the system reports it. `latest` is the 99.9th percentile, over all calls
//! that committed motion, of the time of a call divided by the motion that it committed: below 0.5
//! the motion never waits for a planner that begins when half of it is left. `MiB` is the most
//! memory that the planner has at a time.

use std::path::{Path, PathBuf};
use std::time::Instant;

use feedwright::{CycleTimeOptions, cycle_time, cycle_time_by};
use feedwright_gcode::{Reader, Settings};
use feedwright_lab::limited_machine;
use feedwright_plan::{
    Constraints, FeedPlanner, Piece, PlanCounts, Step, Steps, TimeOptimal, feed_planner,
};
use feedwright_sim::{Machine, Stages, path_steps};

/// Programs of which only the motion of the first seconds by LinuxCNC counts.
const BEGINNINGS_S: [(&str, f64); 1] = [("trochoidal", 12.0)];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut programs: Vec<PathBuf> = std::env::args().skip(1).map(PathBuf::from).collect();
    if programs.is_empty() {
        for folder in ["parts", "../shared/planner"] {
            programs.extend(programs_in(Path::new(folder)));
        }
    }
    let machine = limited_machine(10.0);
    println!(
        "| Program | blocks | bound s | whole s | time s | / bound | / whole | largest use of a limit | deviation um | LinuxCNC s | blocks/s \
         | x real time | latest | MiB | windows | failed |"
    );
    println!("|---|{}", "--:|".repeat(15));
    for program in programs {
        row(&program, &machine)?;
    }
    Ok(())
}

fn row(program: &Path, machine: &Machine) -> Result<(), Box<dyn std::error::Error>> {
    let name = program.file_stem().unwrap_or_default().to_string_lossy();
    let constraints = Constraints::from(machine);
    let canon = Reader::open(program, Settings::default())?.map_while(Result::ok);
    let mut read: Vec<Step> = path_steps(canon).map_while(Result::ok).collect();
    leave_out_the_way_there(&mut read);
    if let Some((_, until_s)) = BEGINNINGS_S
        .iter()
        .find(|(beginning, _)| *beginning == name)
    {
        leave_out_what_is_later(&mut read, &constraints, *until_s);
    }
    let steps = || Ok(Box::new(read.iter().cloned().map(Ok)) as Steps<'_>);
    let found = cycle_time(machine, true, steps, &())?;
    let planner = feed_planner("linuxcnc").ok_or("no linuxcnc")?;
    let (stages, options) = (Stages { planner }, CycleTimeOptions::default());
    let linuxcnc = cycle_time_by(stages, machine, &constraints, options, steps, &())?;
    let whole_s = planned(&mut TimeOptimal::whole_within(&constraints), &read);
    let alone = Alone::of(&constraints, &read);
    let bound_s = found.bound_s.unwrap_or(f64::NAN);
    let time_s = found.cutting_s + found.rapid_s;
    let PlanCounts {
        windows, failed, ..
    } = alone.counts;
    println!(
        "| {name} | {} | {bound_s:.4} | {whole_s:.4} | {time_s:.4} | {:.4} | {:.4} | {:.7} | {:.3} | {:.3} | {:.0} | {:.1} | {:.3} | {:.1} \
         | {windows} | {failed} |",
        found.blocks,
        time_s / bound_s,
        time_s / whole_s,
        found.largest_violation.unwrap_or(f64::NAN),
        found.largest_deviation_um,
        linuxcnc.cutting_s + linuxcnc.rapid_s,
        found.blocks as f64 / alone.took_s,
        alone.motion_s / alone.took_s,
        alone.latest,
        alone.most_bytes as f64 / f64::from(1 << 20),
    );
    Ok(())
}

/// Leaves out rapids before the first cut, where the tool rests between.
fn leave_out_the_way_there(steps: &mut Vec<Step>) {
    let cuts = |step: &Step| matches!(step, Step::Piece(Piece { cutting: true, .. }));
    let before = &steps[..steps.iter().position(cuts).unwrap_or(0)];
    let rest = before
        .iter()
        .rposition(|step| !matches!(step, Step::Piece(_)));
    steps.drain(..rest.map_or(0, |rest| rest + 1));
}

/// Leaves out what LinuxCNC has not come to after a time.
fn leave_out_what_is_later(steps: &mut Vec<Step>, constraints: &Constraints, until_s: f64) {
    let Some(member) = feed_planner("linuxcnc") else {
        return;
    };
    let mut linuxcnc = (member.make)(constraints);
    push_all(linuxcnc.as_mut(), steps, |_| {});
    let mut time_s = 0.0;
    let last = std::iter::from_fn(|| linuxcnc.pop()).take_while(|span| {
        time_s += span.duration_s;
        time_s <= until_s
    });
    let pieces = last.last().map_or(0, |span| span.piece + 1);
    let mut count = 0;
    steps.retain(|step| {
        count += u64::from(matches!(step, Step::Piece(_)));
        count <= pieces
    });
}

/// Gives a planner everything.
fn push_all(
    planner: &mut dyn FeedPlanner,
    steps: &[Step],
    mut after: impl FnMut(&mut dyn FeedPlanner),
) {
    let mut from_rest = true;
    for step in steps {
        let Step::Piece(piece) = step else {
            from_rest = true;
            continue;
        };
        planner.push(piece, from_rest);
        from_rest = false;
        after(planner);
    }
    planner.finish();
    after(planner);
}

/// Time of all motion.
fn planned(planner: &mut dyn FeedPlanner, steps: &[Step]) -> f64 {
    let mut time_s = 0.0;
    push_all(planner, steps, |planner| time_s += popped_s(planner));
    time_s
}

fn popped_s(planner: &mut dyn FeedPlanner) -> f64 {
    let spans = std::iter::from_fn(|| planner.pop());
    spans.map(|span| span.duration_s).sum()
}

/// Results of the planner alone.
struct Alone {
    motion_s: f64,
    took_s: f64,
    latest: f64,
    most_bytes: u64,
    counts: PlanCounts,
}

impl Alone {
    fn of(constraints: &Constraints, steps: &[Step]) -> Self {
        let (begun, begun_s) = (Instant::now(), processor_s());
        let mut planner = TimeOptimal::new(constraints);
        let motion_s = planned(&mut planner, steps);
        let used_s = processor_s()
            .zip(begun_s)
            .map(|(now_s, begun_s)| now_s - begun_s);
        let took_s = used_s.unwrap_or_else(|| begun.elapsed().as_secs_f64());
        // Once more for the time of each call: asking for it takes as long as most calls.
        let mut again = TimeOptimal::new(constraints);
        let mut latenesses = Vec::new();
        let mut before_s = processor_s();
        push_all(&mut again, steps, |planner| {
            let motion_s = popped_s(planner);
            let now_s = processor_s();
            if let (Some(now_s), Some(before_s), true) = (now_s, before_s, motion_s > 0.0) {
                latenesses.push((now_s - before_s) / motion_s);
            }
            before_s = now_s;
        });
        latenesses.sort_by(f64::total_cmp);
        let rank = (latenesses.len() * 999).div_ceil(1000).saturating_sub(1);
        let latest = latenesses.get(rank).copied().unwrap_or(f64::NAN);
        let memory = allocation_counter::measure(|| {
            planned(&mut TimeOptimal::new(constraints), steps);
        });
        Self {
            motion_s,
            took_s,
            latest,
            most_bytes: memory.bytes_max,
            counts: planner.counts(),
        }
    }
}

/// Returns the processor time of this thread, s, where the system reports it (Linux).
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
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut found: Vec<PathBuf> = paths.collect();
    found.retain(|path| path.extension().is_some_and(|extension| extension == "ngc"));
    found.sort();
    found
}
