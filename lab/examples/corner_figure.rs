//! A corner of 90 degrees as `time-optimal` plans it within 10 um: `just corner-figure`, the figure
//! of examples/04_planner.
//!
//! `corner_figure FILE.svg`: velocity, acceleration and jerk of both axes over time, and the
//! planned path beside the programmed one.

use feedwright::{COLORS, Figure, LineStyle, Panel, Polyline};
use feedwright_lab::{CORNER, contour, limited_machine};
use feedwright_plan::{AxisMotion, Constraints, Plan, Planned, Plc};
use feedwright_sim::Stages;

/// Time between two points, s, and how much is shown before and behind the corner.
const SAMPLE_S: f64 = 1e-4;
const AROUND_S: f64 = 0.06;
const AROUND_MM: f64 = 0.06;
/// The first corner of the square, mm.
const CORNER_MM: [f64; 2] = [20.0, 0.0];
const AXES: [&str; 2] = ["x", "y"];

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let file = std::env::args()
        .nth(1)
        .ok_or("usage: corner_figure FILE.svg")?;
    let samples = samples()?;
    let away = |motion: &AxisMotion| {
        (motion.position_mm[0] - CORNER_MM[0]).hypot(motion.position_mm[1] - CORNER_MM[1])
    };
    let nearest = samples
        .iter()
        .min_by(|a, b| away(&a.1).total_cmp(&away(&b.1)));
    let (corner_s, motion) = nearest.ok_or("there is no motion")?;
    let speed_mm_s = motion.velocity_mm_s[0].hypot(motion.velocity_mm_s[1]);
    println!(
        "at the corner: {speed_mm_s:.2} mm/s, {:.2} um away",
        1e3 * away(motion)
    );
    Ok(std::fs::write(file, figure(&samples, *corner_s).to_svg())?)
}

/// Returns the motion of the axes every 0.1 ms on the square of 20 mm at 200 mm/s.
fn samples() -> Result<Vec<(f64, AxisMotion)>, Failure> {
    let machine = limited_machine(10.0);
    let square = contour("square").ok_or("there is no square")?;
    let steps = square.steps(200.0, CORNER)?;
    let (constraints, stages) = (Constraints::from(&machine), Stages::of(&machine));
    let steps = Box::new(steps.into_iter().map(Ok));
    let mut found = Vec::new();
    for planned in Plan::new(steps, &constraints, stages.planner, Plc::default())? {
        let Planned::Phase(phase) = planned else {
            continue;
        };
        let Some(motion) = phase.motion else { continue };
        let mut t_s = 0.0;
        while t_s < phase.duration_s {
            found.push((phase.tau_s + t_s, motion.after(t_s)));
            t_s += SAMPLE_S;
        }
    }
    Ok(found)
}

fn figure(samples: &[(f64, AxisMotion)], corner_s: f64) -> Figure {
    let near = samples
        .iter()
        .filter(|(t_s, _)| (t_s - corner_s).abs() < AROUND_S);
    let over_time = |title: &str, y_title: &str, value: fn(&AxisMotion) -> [f64; 3]| {
        let curve = |k: usize| {
            let point =
                |(t_s, motion): &(f64, AxisMotion)| [1e3 * (t_s - corner_s), value(motion)[k]];
            curve(
                AXES[k],
                near.clone().map(point).collect(),
                LineStyle::Solid,
                k + 1,
            )
        };
        Panel {
            title: title.to_owned(),
            x_title: "Time from the corner [ms]".to_owned(),
            y_title: y_title.to_owned(),
            curves: vec![curve(0), curve(1)],
            ..Panel::default()
        }
    };
    Figure {
        panels: vec![
            over_time("(a) Velocity", "Velocity [mm/s]", |motion| {
                motion.velocity_mm_s
            }),
            over_time("(b) Acceleration", "Acceleration [mm/s²]", |motion| {
                motion.accel_mm_s2
            }),
            over_time("(c) Jerk", "Jerk [mm/s³]", |motion| motion.jerk_mm_s3),
            plane(samples),
        ],
        columns: 2,
        aspect: 0.62,
    }
}

fn curve(label: &str, points: Vec<[f64; 2]>, line: LineStyle, color: usize) -> Polyline {
    Polyline {
        label: label.to_owned(),
        points,
        line,
        color: COLORS[color].to_owned(),
    }
}

/// The corner from above, um from it.
fn plane(samples: &[(f64, AxisMotion)]) -> Panel {
    let um = |point_mm: [f64; 2]| [0, 1].map(|k| 1e3 * (point_mm[k] - CORNER_MM[k]));
    let planned = samples
        .iter()
        .map(|(_, motion)| [0, 1].map(|k| motion.position_mm[k]));
    let near = planned.filter(|p| (0..2).all(|k| (p[k] - CORNER_MM[k]).abs() < AROUND_MM));
    let programmed = [[-AROUND_MM, 0.0], [0.0, 0.0], [0.0, AROUND_MM]].map(|p| p.map(|x| 1e3 * x));
    Panel {
        title: "(d) In the plane".to_owned(),
        x_title: "x from the corner [µm]".to_owned(),
        y_title: "y from the corner [µm]".to_owned(),
        curves: vec![
            curve("programmed", programmed.to_vec(), LineStyle::Thin, 0),
            curve("planned", near.map(um).collect(), LineStyle::Solid, 3),
        ],
        equal_axes: true,
        x_range: Some([-1e3 * AROUND_MM, 0.4e3 * AROUND_MM]),
        y_range: Some([-0.4e3 * AROUND_MM, 1e3 * AROUND_MM]),
        ..Panel::default()
    }
}
