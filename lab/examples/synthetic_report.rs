//! Writes report pages from made-up runs: a tool that follows a path with a first-order lag, once as it is and once with
//! less lag. For work on the page itself; nothing here is a prediction of a machine.
//!
//! `cargo run -p feedwright-lab --example synthetic_report -- DIRECTORY`

use std::f64::consts::TAU;
use std::fs::File;
use std::io::{self, BufWriter};
use std::path::Path;

use feedwright::{Assumptions, Report, ReportedRun, RunFacts, Series, Statistics, TimelineEvent, write_html};
use feedwright_plan::signed_distance_mm;
use feedwright_sim::{Commanded, Row, Sink};

const DT_S: f64 = 1e-3;
/// Step along the path that gives its tangent, mm.
const STEP_MM: f64 = 1e-6;

/// A made-up job: where the command is after an arc length.
struct Job {
    name: &'static str,
    axes: usize,
    length_mm: f64,
    feed_mm_s: f64,
    /// Length of a program line, mm.
    block_mm: f64,
    at: fn(f64) -> [f64; 3],
}

fn circle(s_mm: f64) -> [f64; 3] {
    let angle = s_mm / 10.0;
    [10.0 * angle.cos(), 10.0 * angle.sin(), 0.0]
}

/// Five-pointed star with corners on a circle of radius 20 mm.
fn star(s_mm: f64) -> [f64; 3] {
    let side = 40.0 * (TAU / 5.0).sin();
    let corner = |k: f64| [20.0 * (TAU * (0.4 * k + 0.25)).cos(), 20.0 * (TAU * (0.4 * k + 0.25)).sin()];
    let k = (s_mm / side).floor();
    let (a, b, w) = (corner(k), corner(k + 1.0), s_mm / side - k);
    [a[0] + w * (b[0] - a[0]), a[1] + w * (b[1] - a[1]), 0.0]
}

fn helix(s_mm: f64) -> [f64; 3] {
    let angle = s_mm / 15.0;
    [15.0 * angle.cos(), 15.0 * angle.sin() + 2.0 * (7.0 * angle).sin(), 0.12 * s_mm]
}

/// A pocket cleared in zigzag, 600 s long.
fn pocket(s_mm: f64) -> [f64; 3] {
    let (width, step) = (80.0, 0.5);
    let row = (s_mm / (width + step)).floor();
    let along = s_mm - row * (width + step);
    let x = if row % 2.0 == 0.0 { along.min(width) } else { width - along.min(width) };
    [x, row * step + (along - width).max(0.0), 0.0]
}

fn run(job: &Job, name: &str, lag_s: [f64; 3]) -> io::Result<ReportedRun> {
    let (mut series, mut statistics) = (Series::new(), Statistics::new());
    let (mut act, mut speed) = ((job.at)(0.0), [0.0; 3]);
    let rows = (job.length_mm / job.feed_mm_s / DT_S) as u32;
    let mut foot_mm = 0.0;
    for k in 0..rows {
        let t_s = f64::from(k) * DT_S;
        // A rapid at the beginning, along the path.
        let s_mm = t_s * job.feed_mm_s;
        let path_mm = (job.at)(s_mm);
        let mut torque_nm = [0.0; 3];
        for axis in 0..job.axes {
            let wanted = (path_mm[axis] - act[axis]) / lag_s[axis];
            let acceleration = (wanted - speed[axis]) / 0.004;
            speed[axis] += acceleration * DT_S;
            act[axis] += speed[axis] * DT_S;
            torque_nm[axis] = 1e-4 * acceleration + 0.01 * (speed[axis] / 5.0).tanh();
        }
        foot_mm = nearest(job, act, foot_mm, s_mm);
        series.row(&row(job, t_s, s_mm, foot_mm, (path_mm, act, torque_nm)))?;
        statistics.row(&row(job, t_s, s_mm, foot_mm, (path_mm, act, torque_nm)))?;
    }
    let time_s = f64::from(rows) * DT_S;
    let facts = RunFacts {
        controller: name.to_owned(),
        machine: "made-up lag".to_owned(),
        part: job.name.to_owned(),
        axes: job.axes,
        measured: false,
        run: feedwright_sim::RunResult { time_s, ..Default::default() },
    };
    let text = |line: u32| format!("N{line} G1 X1 Y2 (</script><img src=x onerror=alert(1)> & \"quoted\")");
    let event = |t_s: f64, duration_s: f64, row: &str, label: &str| TimelineEvent {
        t_s,
        duration_s,
        line: 3,
        row: row.to_owned(),
        label: label.to_owned(),
    };
    let events = vec![
        event(0.0, 0.0, "tool", "tool 3"),
        event(0.0, 0.0, "spindle", "spindle 12000 rev/min"),
        event(0.6 * time_s, 0.05 * time_s, "dwell", "dwell"),
        event(time_s, 0.0, "stop", "end of program"),
    ];
    let (spectrum, roundness) = (Vec::new(), Vec::new());
    Ok(ReportedRun { summary: statistics.summary(facts, text), series, spectrum, roundness, events })
}

/// Arc length of the path point nearest to `point`, from a little behind `before_mm` up to `newest_mm`.
fn nearest(job: &Job, point: [f64; 3], before_mm: f64, newest_mm: f64) -> f64 {
    let distance = |s: f64| {
        let p = (job.at)(s);
        (p[0] - point[0]).hypot(p[1] - point[1]).hypot(p[2] - point[2])
    };
    let (low, high) = ((before_mm - 1.0).max(0.0), newest_mm.max(1e-6));
    let coarse = (0..=200).map(|i| low + (high - low) * f64::from(i) / 200.0);
    let mut best = coarse.min_by(|a, b| distance(*a).total_cmp(&distance(*b))).unwrap_or(low);
    let mut width = (high - low) / 200.0;
    while width > 1e-7 {
        best = [best - width, best, best + width]
            .into_iter()
            .map(|s| s.clamp(0.0, newest_mm))
            .min_by(|a, b| distance(*a).total_cmp(&distance(*b)))
            .unwrap_or(best);
        width *= 0.6;
    }
    best
}

fn row(
    job: &Job,
    t_s: f64,
    s_mm: f64,
    foot_s_mm: f64,
    (path_mm, act_mm, torque_nm): ([f64; 3], [f64; 3], [f64; 3]),
) -> Row {
    let foot = (job.at)(foot_s_mm);
    let ahead = (job.at)(foot_s_mm + STEP_MM);
    let tangent = [0, 1, 2].map(|k| (ahead[k] - foot[k]) / STEP_MM);
    let signed_mm = signed_distance_mm(tangent, [0, 1, 2].map(|k| act_mm[k] - foot[k]));
    Row {
        t_s,
        s_mm,
        line: 4 + (foot_s_mm / job.block_mm) as u32,
        feed_plan_mm_s: job.feed_mm_s,
        programmed_mm_s: 0.0,
        cutting: s_mm > 0.04 * job.length_mm.min(200.0),
        commanded: Commanded::Cut,
        path_mm,
        cmd_mm: [path_mm[0] + 0.01, path_mm[1], path_mm[2]],
        corrected_mm: [path_mm[0] + 0.01, path_mm[1], path_mm[2]],
        act_mm,
        torque_nm,
        foot_mm: foot,
        tangent,
        contour_error_mm: if job.axes == 2 { signed_mm } else { signed_mm.abs() },
    }
}

fn main() -> io::Result<()> {
    let directory = std::env::args().nth(1).unwrap_or_else(|| ".".to_owned());
    let star_mm = 5.0 * 40.0 * (TAU / 5.0).sin();
    let jobs = [
        Job { name: "circle", axes: 2, length_mm: 10.0 * TAU, feed_mm_s: 50.0, block_mm: 30.0, at: circle },
        Job { name: "star", axes: 2, length_mm: star_mm, feed_mm_s: 40.0, block_mm: star_mm / 5.0, at: star },
        Job { name: "helix", axes: 3, length_mm: 300.0, feed_mm_s: 50.0, block_mm: 20.0, at: helix },
        Job { name: "pocket", axes: 2, length_mm: 12_000.0, feed_mm_s: 20.0, block_mm: 80.5, at: pocket },
    ];
    for job in &jobs {
        let report = Report {
            geometry: None,
            assumed: Assumptions { machine: "a lag that was made up".to_owned(), ..Assumptions::default() },
            title: format!("{} <b>&</b>", job.name),
            part: format!("{}.ngc", job.name),
            machine: vec![("axes".to_owned(), job.axes.to_string()), ("servo period".to_owned(), "1 ms".to_owned())],
            settings: vec![("controllers".to_owned(), "uncorrected, less lag".to_owned())],
            program: Vec::new(),
            circles: Vec::new(),
            tolerance_um: Some(20.0),
            limits: None,
            axis_limits: Vec::new(),
            band: None,
            runs: vec![run(job, "uncorrected", [0.012, 0.015, 0.012])?, run(job, "less lag", [0.006, 0.0065, 0.006])?],
        };
        let path = Path::new(&directory).join(format!("{}.report.html", job.name));
        write_html(&mut BufWriter::new(File::create(&path)?), &report)?;
        println!(
            "{}: {} bytes, {} points",
            path.display(),
            path.metadata()?.len(),
            report.runs[0].series.points().len()
        );
    }
    Ok(())
}
