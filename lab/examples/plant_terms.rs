//! Effect of each term of the plant on a circle: `just plant-terms`, the figure of
//! docs/machine-file.md.
//!
//! `plant_terms FILE.svg` cuts the circle of radius 10 mm uncorrected on tnv40 with one term more,
//! and draws the deviation as a ball bar shows it. Slowly, where the lag of the loops does not
//! cover what friction and torque do.

use feedwright::{COLORS, Figure, LineStyle, Panel, Polyline};
use feedwright_control::Uncorrected;
use feedwright_gcode::canon::Corner;
use feedwright_lab::contour;
use feedwright_sim::{Machine, Row, Run, Sink};

type Failure = Box<dyn std::error::Error>;

/// Centre and radius of the circle, mm.
const RADIUS_MM: f64 = 10.0;
/// Panels in a row.
const COLUMNS: usize = 4;
/// Points of a curve that are drawn, at most.
const POINTS: usize = 800;

/// A term: title of its panel; feedrate, mm/s; deviation that is drawn as long as the bar, half the
/// radius, um; and keys of both axes.
type Term = (&'static str, f64, f64, &'static str);

/// Slow enough for the lag to be small, mm/s.
const SLOW: f64 = 10.0;
/// Usual feedrate of programs, mm/s.
const FAST: f64 = 50.0;
/// The other tables of the term with geometry.
const GEOMETRY: &str = "[geometry]\nsquareness_xy_urad = 200\n";

// A PI speed loop takes the constant part of friction back: what is left is how it turns its sign.
#[rustfmt::skip]
const TERMS: [Term; 20] = [
    ("tnv40 as it is", SLOW, 10.0, ""),
    ("PI speed loop", SLOW, 10.0, "speed_integral_s = 0.02\n"),
    ("Presliding, Stribeck", SLOW, 10.0, "speed_integral_s = 0.02\npresliding_um = 10\nstribeck_nm = 0.1\nstribeck_mm_s = 2"),
    ("Stick-slip", 0.2, 10.0, "presliding_um = 1\nstribeck_nm = 0.6\nstribeck_mm_s = 0.3\nspeed_integral_s = 0.01"),
    ("Asymmetric friction", SLOW, 10.0, "coulomb_asymmetry_nm = 0.15"),
    ("Cogging", SLOW, 10.0, "cogging_nm = 0.2\ncogging_per_rev = 24"),
    ("Torque ripple", SLOW, 10.0, "ripple = 0.3\nripple_per_rev = 8"),
    ("Broadband torque", SLOW, 10.0, "torque_noise_nm = 0.2\ntorque_noise_s = 0.005"),
    ("Wandering 25 Hz", SLOW, 10.0, "disturbance_nm = 0.5\ndisturbance_wander = 0.2"),
    ("Encoder steps, 5 um", SLOW, 10.0, "encoder_step_um = 5"),
    ("Encoder noise, 2 um", SLOW, 10.0, "encoder_noise_um = 2"),
    ("Interpolation error", SLOW, 10.0, "interpolation_error_um = 3\nsignal_period_um = 1000"),
    ("Speed of the encoder", SLOW, 10.0, "encoder_step_um = 5\nspeed_from_encoder = 1"),
    ("Scale, pitch, square", SLOW, 10.0, "scale_um_m = 200\npitch_error_um = 2"),
    ("Feedforward 0.95", FAST, 50.0, "velocity_feedforward = 0.95"),
    ("and of acceleration", FAST, 50.0, "velocity_feedforward = 0.95\nacceleration_feedforward = 1"),
    ("Torque filter, 15 Hz", FAST, 50.0, "torque_filter_hz = 15"),
    ("References 10 ms late", FAST, 50.0, "drive_delay_s = 0.01"),
    ("Positions 10 ms late", FAST, 50.0, "measurement_delay_s = 0.01"),
    ("Speed limit, 49.5", FAST, 50.0, "speed_limit_mm_s = 49.5"),
];

fn main() -> Result<(), Failure> {
    let file = std::env::args()
        .nth(1)
        .ok_or("usage: plant_terms FILE.svg")?;
    let figure = Figure {
        panels: TERMS.iter().map(panel).collect::<Result<_, Failure>>()?,
        columns: COLUMNS,
        aspect: 1.0,
    };
    Ok(std::fs::write(file, figure.to_svg())?)
}

/// Positions of the tool, mm.
#[derive(Default)]
struct Tool(Vec<[f64; 2]>);

impl Sink for Tool {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        if row.cutting {
            self.0.push([row.act_mm[0], row.act_mm[1]]);
        }
        Ok(())
    }
}

fn panel(&(title, feed_mm_s, scale_um, keys): &Term) -> Result<Panel, Failure> {
    let [x, y] = ["x", "y"].map(|axis| format!("[axis.{axis}]\n{keys}\n"));
    let more = if keys.starts_with("scale") {
        GEOMETRY
    } else {
        ""
    };
    let head = "base = \"tnv40\"\nname = \"term\"\ndescription = \"tnv40 with one term\"\nsource = \"made up\"\n";
    let machine = Machine::parse("term.toml", &format!("{head}{x}{y}{more}"))?;
    let circle = contour("circle").ok_or("there is a circle")?;
    let steps = circle.steps(feed_mm_s, Corner::ExactPath)?;
    let mut tool = Tool::default();
    Run::on(&machine).cut_steps::<2>(&steps, &mut Uncorrected, &mut [&mut tool])?;
    let kept = tool.0.len().div_ceil(POINTS).max(1);
    let enlargement = 0.5 * RADIUS_MM / (1e-3 * scale_um);
    let drawn = tool.0.iter().step_by(kept).map(|&[x, y]| {
        let (dx, dy) = (x - RADIUS_MM, y);
        let radius = dx.hypot(dy);
        let at = RADIUS_MM + enlargement * (radius - RADIUS_MM);
        [dx / radius * at, dy / radius * at]
    });
    let around = (0..=360).map(|degree| {
        let (sin, cos) = f64::from(degree).to_radians().sin_cos();
        [RADIUS_MM * cos, RADIUS_MM * sin]
    });
    let curve = |label: &str, points, line, color: usize| Polyline {
        label: label.to_owned(),
        points,
        line,
        color: COLORS[color].to_owned(),
    };
    let bar = vec![[0.0, 0.0], [0.5 * RADIUS_MM, 0.0]];
    let range = Some([-1.6 * RADIUS_MM, 1.6 * RADIUS_MM]);
    Ok(Panel {
        title: title.to_owned(),
        x_title: format!("{feed_mm_s} mm/s, bar {scale_um} um"),
        curves: vec![
            curve("programmed", around.collect(), LineStyle::Thin, 0),
            curve("tool", drawn.collect(), LineStyle::Solid, 1),
            curve("bar", bar, LineStyle::Solid, 0),
        ],
        equal_axes: true,
        x_range: range,
        y_range: range,
        ..Panel::default()
    })
}
