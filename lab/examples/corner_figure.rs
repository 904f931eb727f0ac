//! A corner of 90 degrees as `time-optimal` plans it within 10 um: `just corner-figure`, the figure
//! of examples/04_planner.
//!
//! `corner_figure FILE.svg`: velocity, acceleration and jerk of both axes over time, and the
//! planned path beside the programmed one.

use feedwright::{COLORS, Figure, LineStyle, Panel, Polyline};
use feedwright_gcode::canon::Corner;
use feedwright_lab::{contour, limited_machine};
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
        .min_by(|a, b| away(&a.1).total_cmp(&away(&b.1)))
        .ok_or("there is no motion")?;
    println!(
        "at the corner: {:.2} mm/s, {:.2} um away",
        speed_mm_s(&nearest.1),
        1e3 * away(&nearest.1)
    );
    std::fs::write(file, figure(&samples, nearest.0).to_svg())?;
    Ok(())
}

fn speed_mm_s(motion: &AxisMotion) -> f64 {
    motion.velocity_mm_s[0].hypot(motion.velocity_mm_s[1])
}

/// Returns the motion of the axes every 0.1 ms on the square of 20 mm at 200 mm/s.
fn samples() -> Result<Vec<(f64, AxisMotion)>, Failure> {
    let machine = limited_machine(10.0);
    let corner = Corner::Continuous {
        tolerance_mm: None,
        merge_mm: None,
    };
    let steps = contour("square")
        .ok_or("there is no square")?
        .steps(200.0, corner)?;
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
    let near: Vec<&(f64, AxisMotion)> = samples
        .iter()
        .filter(|(t_s, _)| (t_s - corner_s).abs() < AROUND_S)
        .collect();
    let over_time = |title: &str, y_title: &str, value: fn(&AxisMotion) -> [f64; 3]| {
        let curve = |k: usize| Polyline {
            label: AXES[k].to_owned(),
            points: near
                .iter()
                .map(|(t_s, motion)| [1e3 * (t_s - corner_s), value(motion)[k]])
                .collect(),
            color: COLORS[k + 1].to_owned(),
            ..Polyline::default()
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

/// The corner from above, um from it.
fn plane(samples: &[(f64, AxisMotion)]) -> Panel {
    let um = |point_mm: [f64; 2]| [0, 1].map(|k| 1e3 * (point_mm[k] - CORNER_MM[k]));
    let planned = samples
        .iter()
        .map(|(_, motion)| [motion.position_mm[0], motion.position_mm[1]]);
    let near = planned.filter(|p| (0..2).all(|k| (p[k] - CORNER_MM[k]).abs() < AROUND_MM));
    let range = Some([-1e3 * AROUND_MM, 0.4e3 * AROUND_MM]);
    Panel {
        title: "(d) In the plane".to_owned(),
        x_title: "x from the corner [µm]".to_owned(),
        y_title: "y from the corner [µm]".to_owned(),
        curves: vec![
            Polyline {
                label: "programmed".to_owned(),
                points: [[-AROUND_MM, 0.0], [0.0, 0.0], [0.0, AROUND_MM]]
                    .map(|p| p.map(|x| 1e3 * x))
                    .to_vec(),
                line: LineStyle::Thin,
                color: COLORS[0].to_owned(),
            },
            Polyline {
                label: "planned".to_owned(),
                points: near.map(um).collect(),
                color: COLORS[3].to_owned(),
                ..Polyline::default()
            },
        ],
        equal_axes: true,
        x_range: range,
        y_range: Some([-0.4e3 * AROUND_MM, 1e3 * AROUND_MM]),
        ..Panel::default()
    }
}
