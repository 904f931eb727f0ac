//! Writes a page of figures with made-up curves, for work on the figures themselves.
//!
//! `cargo run -p feedwright-lab --example synthetic_figures -- FILE`

use std::f64::consts::TAU;
use std::fs::File;
use std::io::{self, BufWriter};

use feedwright::{COLORS, CaptionedFigure, Figure, LineStyle, Panel, Polyline, write_figure_page};

fn curve(label: &str, color: usize, line: LineStyle, count: u32, at: impl Fn(f64) -> [f64; 2]) -> Polyline {
    let points = (0..=count).map(|k| at(f64::from(k) / f64::from(count))).collect();
    Polyline { label: label.to_owned(), points, line, color: COLORS[color].to_owned() }
}

fn panel(title: &str, x_title: &str, y_title: &str, curves: Vec<Polyline>) -> Panel {
    Panel {
        title: title.to_owned(),
        x_title: x_title.to_owned(),
        y_title: y_title.to_owned(),
        curves,
        ..Panel::default()
    }
}

fn main() -> io::Result<()> {
    let error = |size: f64| move |u: f64| [1.76 * u, size * (40.0 * u).sin() * (1.0 + 0.3 * (170.0 * u).sin())];
    let wobbly = |deviation: f64| {
        move |u: f64| {
            let r = 10.0 + deviation * (10.0 * TAU * u).sin();
            [r * (TAU * u).cos(), r * (TAU * u).sin()]
        }
    };
    let path = || {
        vec![
            curve("programmed path", 0, LineStyle::Thin, 400, wobbly(0.0)),
            curve("without correction", 1, LineStyle::Dashed, 2000, wobbly(0.8)),
            curve("with correction", 2, LineStyle::Solid, 2000, wobbly(0.2)),
        ]
    };
    let mut whole = panel("(a) Path, deviation ×50", "X [mm]", "Y [mm]", path());
    whole.equal_axes = true;
    let mut detail = panel("(b) Detail", "X [mm]", "Y [mm]", path());
    detail.equal_axes = true;
    (detail.x_range, detail.y_range) = (Some([5.0, 9.0]), Some([5.0, 9.0]));
    let errors = vec![
        curve("without correction", 1, LineStyle::Dashed, 20_000, error(25.0)),
        curve("with correction", 2, LineStyle::Solid, 20_000, error(5.0)),
    ];
    let torque =
        |k: f64| vec![curve("with correction", 2, LineStyle::Solid, 2000, move |u| [1.76 * u, 0.2 * (k * u).sin()])];
    let figures = [
        CaptionedFigure {
            figure: Figure { panels: vec![whole, detail], columns: 2, aspect: 1.0 },
            number: "Figure 7".to_owned(),
            caption: "Tool paths with the deviation enlarged fifty times, and a detail of the upper right.".to_owned(),
        },
        CaptionedFigure {
            figure: Figure {
                panels: vec![
                    panel("", "Time [s]", "Contour error [µm]", errors),
                    panel("", "Time [s]", "Torque X [N m]", torque(20.0)),
                    panel("", "Time [s]", "Torque Y [N m]", torque(31.0)),
                ],
                columns: 1,
                aspect: 0.26,
            },
            number: "Figure 8".to_owned(),
            caption: "Contour error and torque over time.".to_owned(),
        },
    ];
    let file = std::env::args().nth(1).unwrap_or_else(|| "figures.report.html".to_owned());
    write_figure_page(&mut BufWriter::new(File::create(file)?), "Figures", "Made-up curves.", &figures)
}
