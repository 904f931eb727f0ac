//! Checks plans by their results: positions every 0.1 ms, and nothing else of the planner.
//! Velocity, acceleration and jerk are finite differences of the positions; the programmed path is
//! rebuilt from the lines and arcs of the reader, as chords of 1e-5 mm.
//!
//!     cargo run --release -p feedwright-lab --example check_plan -- [--machine NAME] [--tolerance UM] [--bound] [--seed S --count N] [PROGRAM...]
//!
//! A row for each program, and the largest and median values behind them. `use` is the largest
//! share of a limit; `off um` the largest distance of the plan from the path, `uncut um` of the
//! path from the plan, `of it` the first over the tolerance there. Programs come from files, and
//! from the generator of the sweeps with `--seed`. A long program is shortened to its first motions
//! of 60 s. Programs that are not read, or have splines or rotary axes, are named and left out.

use std::path::PathBuf;
use std::sync::mpsc;
use std::time::{Duration, Instant};

use feedwright_gcode::canon::{Canon, Corner, Motion, MotionKind, Shape};
use feedwright_gcode::{Reader, Settings};
use feedwright_lab::{Class, draw};
use feedwright_plan::{Constraints, Phase, Plan, Planned, Plc, WHOLE_PROGRAM};
use feedwright_sim::{Machine, Stages, path_steps};

/// Time between two positions, s.
const H: f64 = 1e-4;

/// Distance of chords from their arc, mm.
const CHORD_MM: f64 = 1e-5;

/// Way along the path that the nearest point is looked for in, in tolerances, beside the way of a
/// step.
const WINDOW: f64 = 20.0;

/// Most motion of a program, s.
const MOST_S: f64 = 60.0;

/// Longest search for a bound.
const BOUND: Duration = Duration::from_secs(60);

type Point = [f64; 3];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut machine = Machine::load("workshop".as_ref())?;
    let (mut tolerance_um, mut bound, mut seed, mut count) = (10.0, false, None, 50);
    let mut programs: Vec<(String, String)> = Vec::new();
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{argument} lacks a value"));
        match argument.as_str() {
            "--machine" => machine = Machine::load(value()?.as_ref())?,
            "--tolerance" => tolerance_um = value()?.parse()?,
            "--bound" => bound = true,
            "--seed" => seed = Some(value()?.parse()?),
            "--count" => count = value()?.parse()?,
            path => {
                let path = PathBuf::from(path);
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                let text = std::fs::read(&path)?;
                programs.push((
                    name.into_owned(),
                    String::from_utf8_lossy(&text).into_owned(),
                ));
            }
        }
    }
    if let Some(seed) = seed {
        let drawn = draw(seed, count, 1, Class::Any)?.into_iter();
        programs.extend(drawn.map(|made| (made.job.program.name.clone(), made.text)));
    }
    let machine = machine.planned_by_axes(tolerance_um);
    println!(
        "| Program | motions | time s | / bound | use | of | off um | of it | uncut um | x real time | blocks/s |"
    );
    println!("|---|--:|--:|--:|--:|---|--:|--:|--:|--:|--:|");
    let mut rows = Vec::new();
    for (name, text) in programs {
        match Row::of(&name, &text, &machine, bound) {
            Ok(row) => {
                println!("| {name} | {} |", row.cells());
                rows.push(row);
            }
            Err(why) => eprintln!("{name}: left out: {why}"),
        }
    }
    summary(&rows);
    Ok(())
}

/// A number of a row, by its name.
type Number = (&'static str, fn(&Row) -> f64);

fn summary(rows: &[Row]) {
    println!("\n{} programs; median, smallest and largest:", rows.len());
    let numbers: [Number; 7] = [
        ("time / bound", |row| row.time_s / row.bound_s),
        ("use of a limit", |row| row.used),
        ("off, um", |row| 1e3 * row.off_mm),
        ("off / tolerance", |row| row.off_share),
        ("uncut, um", |row| 1e3 * row.uncut_mm),
        ("x real time", |row| row.time_s / row.took_s),
        ("blocks/s", |row| row.motions as f64 / row.took_s),
    ];
    for (name, number) in numbers {
        let mut values: Vec<f64> = rows.iter().map(number).filter(|n| n.is_finite()).collect();
        values.sort_by(f64::total_cmp);
        let count = values.len();
        let at = |place: usize| values.get(place).copied().unwrap_or(f64::NAN);
        let [median, least, most] = [count / 2, 0, count.saturating_sub(1)].map(at);
        println!("{name:<16} {median:>12.5} {least:>12.5} {most:>12.5}   ({count} of them)");
    }
}

/// Result of a plan.
struct Row {
    motions: usize,
    time_s: f64,
    bound_s: f64,
    used: f64,
    /// Limit that is used most.
    limit: String,
    off_mm: f64,
    off_share: f64,
    uncut_mm: f64,
    took_s: f64,
}

impl Row {
    fn of(
        name: &str,
        text: &str,
        machine: &Machine,
        bound: bool,
    ) -> Result<Self, Box<dyn std::error::Error>> {
        let read = Reader::from_text(name, text, Settings::default())?;
        let mut canon = read.collect::<Result<Vec<_>, _>>()?;
        let constraints = Constraints::from(machine);
        let motions = shortened(&mut canon, &constraints)?;
        let path = WantedPath::of(&canon)?;
        let begun = Instant::now();
        let (steps, planner) = (path_steps(canon.clone()), Stages::of(machine).planner);
        let plan = Plan::new(steps, &constraints, planner, Plc::default())?;
        let phases: Vec<Phase> = plan.filter_map(|planned| moving(&planned)).collect();
        let took_s = begun.elapsed().as_secs_f64();
        let mut ruler = Ruler::new(&path, &constraints);
        runs(&phases, |positions| ruler.run(positions));
        Ok(Self {
            motions,
            time_s: phases.iter().map(|phase| phase.duration_s).sum(),
            bound_s: if bound {
                bound_s(canon, machine)
            } else {
                f64::NAN
            },
            used: ruler.used,
            off_mm: ruler.off_mm,
            off_share: ruler.off_share,
            uncut_mm: ruler.uncut_mm(),
            limit: ruler.limit,
            took_s,
        })
    }

    fn cells(&self) -> String {
        format!(
            "{} | {:.3} | {:.4} | {:.6} | {} | {:.3} | {:.4} | {:.3} | {:.1} | {:.0}",
            self.motions,
            self.time_s,
            self.time_s / self.bound_s,
            self.used,
            self.limit,
            1e3 * self.off_mm,
            self.off_share,
            1e3 * self.uncut_mm,
            self.time_s / self.took_s,
            self.motions as f64 / self.took_s
        )
    }
}

fn moving(planned: &Planned) -> Option<Phase> {
    match planned {
        Planned::Phase(phase) if phase.rest.is_none() => Some(*phase),
        _ => None,
    }
}

/// Keeps the first motions that take [`MOST_S`] at their feedrates; how many motions there are.
fn shortened(canon: &mut Vec<Canon>, constraints: &Constraints) -> Result<usize, &'static str> {
    let (mut time_s, mut motions) = (0.0, 0);
    let mut until = canon.len();
    for (i, step) in canon.iter().enumerate() {
        let Canon::Motion(motion) = step else {
            continue;
        };
        if motion.others.axes.is_some() {
            return Err("rotary axes");
        }
        motions += 1;
        time_s += distance(motion.start_mm, motion.end_mm) / allowed_mm_s(motion, constraints);
        if time_s > MOST_S {
            until = i + 1;
            break;
        }
    }
    canon.truncate(until);
    if motions == 0 {
        Err("no motion")
    } else {
        Ok(motions)
    }
}

fn allowed_mm_s(motion: &Motion, constraints: &Constraints) -> f64 {
    match motion.kind {
        MotionKind::Feed => motion.feed_mm_s.min(constraints.path.max_feed_mm_s),
        _ => constraints.path.rapid_mm_s,
    }
}

/// Time of each path from rest to rest as a whole, s; not a number where it takes too long to find.
fn bound_s(canon: Vec<Canon>, machine: &Machine) -> f64 {
    let (sender, receiver) = mpsc::channel();
    let machine = machine.clone();
    std::thread::spawn(move || {
        let constraints = Constraints::from(&machine);
        let plan = Plan::new(
            path_steps(canon),
            &constraints,
            &WHOLE_PROGRAM,
            Plc::default(),
        );
        let time_s = plan.map(|plan| {
            let phases = plan.filter_map(|planned| moving(&planned));
            phases.map(|phase| phase.duration_s).sum()
        });
        // The other end is gone where the time was over.
        let _ = sender.send(time_s.unwrap_or(f64::NAN));
    });
    receiver.recv_timeout(BOUND).unwrap_or(f64::NAN)
}

/// Positions every [`H`] of each run of phases that join.
fn runs(phases: &[Phase], mut each: impl FnMut(&[Point])) {
    let mut positions: Vec<Point> = Vec::new();
    let (mut left_s, mut end_s) = (0.0, f64::NEG_INFINITY);
    for phase in phases {
        let Some(motion) = phase.motion else { continue };
        if phase.tau_s > end_s + 1e-9 && !positions.is_empty() {
            each(&positions);
            positions.clear();
            left_s = 0.0;
        }
        while left_s <= phase.duration_s {
            positions.push(motion.after(left_s).position_mm);
            left_s += H;
        }
        left_s -= phase.duration_s;
        end_s = phase.tau_s + phase.duration_s;
    }
    if !positions.is_empty() {
        each(&positions);
    }
}

/// The programmed path as chords.
#[derive(Default)]
struct WantedPath {
    points: Vec<Point>,
    /// Arc length at each point, mm, and the motion that leads there.
    at_mm: Vec<f64>,
    motion: Vec<usize>,
    /// Feedrate and tolerance in the program of each motion.
    motions: Vec<(Motion, Option<f64>)>,
}

impl WantedPath {
    fn of(canon: &[Canon]) -> Result<Self, &'static str> {
        let mut path = Self::default();
        let motions = canon.iter().filter_map(|step| match step {
            Canon::Motion(motion) => Some(motion),
            _ => None,
        });
        for motion in motions {
            let number = path.motions.len();
            if path.points.is_empty() {
                path.push(motion.start_mm, number);
            }
            match &motion.shape {
                Shape::Line => path.push(motion.end_mm, number),
                Shape::Arc { .. } => path.arc(motion, number),
                Shape::Spline(_) => return Err("a spline"),
            }
            let tolerance_mm = match motion.corner {
                Corner::Continuous { tolerance_mm, .. } => tolerance_mm,
                _ => Some(1e-3),
            };
            path.motions.push((motion.clone(), tolerance_mm));
        }
        Ok(path)
    }

    fn push(&mut self, point: Point, motion: usize) {
        let way = self
            .points
            .last()
            .map_or(0.0, |last| distance(*last, point));
        self.at_mm
            .push(self.at_mm.last().copied().unwrap_or(0.0) + way);
        self.points.push(point);
        self.motion.push(motion);
    }

    fn arc(&mut self, motion: &Motion, number: usize) {
        let Shape::Arc {
            plane,
            center_mm: center,
            turns,
        } = motion.shape
        else {
            return;
        };
        let [a, b, n] = plane.axes();
        let polar = |point: Point| {
            let [x, y] = [point[a] - center[a], point[b] - center[b]];
            (x.hypot(y), y.atan2(x))
        };
        let ((r0, from), (r1, to)) = (polar(motion.start_mm), polar(motion.end_mm));
        let full = std::f64::consts::TAU;
        let sense = f64::from(turns.signum());
        let mut angle = (sense * (to - from)).rem_euclid(full);
        // An arc that ends where it begins is a full turn.
        if angle < 1e-9 || full - angle < 1e-9 {
            angle = full;
        }
        angle += full * f64::from(turns.abs() - 1);
        let chords = angle * (r0.max(r1) / (8.0 * CHORD_MM)).sqrt();
        let count = chords.ceil().max(1.0);
        for i in 1..count as u32 {
            let part = f64::from(i) / count;
            let (r, turned) = (r0 + part * (r1 - r0), from + sense * part * angle);
            let mut point = [0.0; 3];
            point[a] = center[a] + r * turned.cos();
            point[b] = center[b] + r * turned.sin();
            point[n] = motion.start_mm[n] + part * (motion.end_mm[n] - motion.start_mm[n]);
            self.push(point, number);
        }
        self.push(motion.end_mm, number);
    }
}

/// Measures positions by the path and the limits.
struct Ruler<'a> {
    path: &'a WantedPath,
    constraints: &'a Constraints,
    /// Chord of the path that the tool was nearest to, and the arc length there, mm.
    nearest: usize,
    at_mm: f64,
    used: f64,
    limit: String,
    off_mm: f64,
    /// The largest distance over the tolerance there.
    off_share: f64,
    /// Least distance of each point of the path from the plan.
    reached_mm: Vec<f64>,
}

impl<'a> Ruler<'a> {
    fn new(path: &'a WantedPath, constraints: &'a Constraints) -> Self {
        let reached_mm = vec![f64::INFINITY; path.points.len()];
        Self {
            path,
            constraints,
            nearest: 0,
            at_mm: 0.0,
            used: 0.0,
            limit: String::new(),
            off_mm: 0.0,
            off_share: 0.0,
            reached_mm,
        }
    }

    fn uses(&mut self, share: f64, limit: impl FnOnce() -> String) {
        if share > self.used {
            (self.used, self.limit) = (share, limit());
        }
    }

    /// Positions from rest to rest.
    fn run(&mut self, positions: &[Point]) {
        let mut feeds = Vec::with_capacity(positions.len());
        for pair in positions.windows(2) {
            feeds.push(self.place(pair[0], pair[1]));
        }
        for (pair, feed_mm_s) in positions.windows(2).zip(feeds) {
            let share = distance(pair[0], pair[1]) / H / feed_mm_s;
            self.uses(share, || "feedrate".to_owned());
        }
        let axes = &self.constraints.axes;
        for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
            let Some(limits) = axes.get(k).or(axes.last()) else {
                return;
            };
            for w in positions.windows(4) {
                let [p, q, r, s] = [w[0][k], w[1][k], w[2][k], w[3][k]];
                let velocity_mm_s = (q - p).abs() / H;
                let accel_mm_s2 = (r - 2.0 * q + p).abs() / (H * H);
                let jerk_mm_s3 = (s - 3.0 * r + 3.0 * q - p).abs() / (H * H * H);
                for (share, what) in [
                    (velocity_mm_s / limits.velocity_mm_s, "velocity"),
                    (accel_mm_s2 / limits.accel_mm_s2, "acceleration"),
                    (jerk_mm_s3 / limits.jerk_mm_s3, "jerk"),
                ] {
                    self.uses(share, || format!("{name} {what}"));
                }
            }
        }
    }

    /// Finds a position on the path and records its distance from the path, and the distance of the
    /// path from the step behind it. Returns the highest feedrate programmed within a tolerance of
    /// that place, mm/s.
    fn place(&mut self, point: Point, next: Point) -> f64 {
        let (points, at_mm) = (&self.path.points, &self.path.at_mm);
        let last = points.len() - 1;
        let motion_to = |point: usize| &self.path.motions[self.path.motion[point.min(last)]];
        let machine_mm = self.constraints.path_tolerance_mm.unwrap_or(0.01);
        let tolerance_mm = |chord: usize| motion_to(chord + 1).1.unwrap_or(machine_mm);
        let step_mm = distance(point, next);
        let near_mm = tolerance_mm(self.nearest);
        let window_mm = WINDOW * near_mm.max(machine_mm) + 2.0 * step_mm;
        let from_mm = self.at_mm;
        let first = at_mm
            .partition_point(|at| *at < from_mm - window_mm)
            .saturating_sub(1);
        let (mut least, mut places) = (f64::INFINITY, Vec::new());
        let mut i = first;
        while i + 1 < points.len() && at_mm[i] <= from_mm + window_mm {
            // Only what lies in the window: a long chord may pass near the tool elsewhere.
            let length = (at_mm[i + 1] - at_mm[i]).max(f64::MIN_POSITIVE);
            let part = |side: f64| (from_mm + side * window_mm - at_mm[i]) / length;
            let parts = [-1.0, 1.0].map(|side| part(side).clamp(0.0, 1.0));
            let (away, part) = from_segment(point, points[i], points[i + 1], parts);
            least = least.min(away);
            places.push((away, i, at_mm[i] + part * length));
            let (reached, _) = from_segment(points[i], point, next, [0.0, 1.0]);
            self.reached_mm[i] = self.reached_mm[i].min(reached);
            i += 1;
        }
        // Where a path goes back on itself, several places are within the tolerance: the tool is
        // where its way since the last place that was the only one leads to.
        places.retain(|(away, ..)| *away <= least.max(near_mm));
        let expected = |(_, _, at): &(f64, usize, f64)| (at - from_mm).abs();
        let by_way = |a: &&_, b: &&_| expected(a).total_cmp(&expected(b));
        let Some(&(.., about)) = places.iter().min_by(by_way) else {
            return f64::INFINITY;
        };
        let near = |(.., at): &&(f64, usize, f64)| (at - about).abs() < 4.0 * (step_mm + near_mm);
        let there = places
            .iter()
            .filter(near)
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let (_, nearest, at) = there.copied().unwrap_or((0.0, self.nearest, from_mm));
        let is_clear = places.iter().all(|place| near(&place));
        self.at_mm = step_mm + if is_clear { at } else { from_mm };
        if i >= last {
            let (reached, _) = from_segment(points[last], point, next, [0.0, 1.0]);
            self.reached_mm[last] = self.reached_mm[last].min(reached);
        }
        self.nearest = nearest;
        self.off_mm = self.off_mm.max(least);
        let tolerance_mm = tolerance_mm(nearest);
        self.off_share = self.off_share.max(least / tolerance_mm);
        let reach_mm = 4.0 * tolerance_mm + distance(points[nearest], point);
        let [lo, hi] = [-1.0, 1.0].map(|side| {
            let at = at_mm[nearest] + side * reach_mm;
            at_mm.partition_point(|place| *place < at).min(last)
        });
        let feed = |i: usize| allowed_mm_s(&motion_to(i).0, self.constraints);
        (lo..=hi + 1).map(feed).fold(0.0, f64::max)
    }

    fn uncut_mm(&self) -> f64 {
        self.reached_mm.iter().copied().fold(0.0, f64::max)
    }
}

fn distance(a: Point, b: Point) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// Distance of a point from a segment between two parts of it, and the part at which it is nearest.
fn from_segment(point: Point, a: Point, b: Point, [first, last]: [f64; 2]) -> (f64, f64) {
    let along: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
    let square: f64 = along.iter().map(|part| part * part).sum();
    let dot: f64 = (0..3).map(|k| along[k] * (point[k] - a[k])).sum();
    let part = if square > 0.0 {
        (dot / square).clamp(first, last)
    } else {
        first
    };
    let nearest = std::array::from_fn(|k| a[k] + part * along[k]);
    (distance(point, nearest), part)
}
