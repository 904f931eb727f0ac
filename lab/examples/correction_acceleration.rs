//! How the contour error depends on what the correction may accelerate: `just correction-acceleration`, the table and the figure of
//! "Acceleration of the correction" in examples/02_horizon.
//!
//! `correction_acceleration FILE.svg` cuts contours on `tnv40` with `correction_accel_mm_s2` at each value, and uncorrected.

use feedwright::{BASELINE, COLORS, Choices, Figure, LineStyle, Make, Panel, Polyline, Setup, Statistics};
use feedwright_lab::{CONTROLLERS, HORIZON, Workpiece};
use feedwright_sim::{Machine, Run};

const CONTOURS: [&str; 4] = ["square", "circle", "star", "butterfly"];
/// What the correction may accelerate in each axis, mm/s2; the default on tnv40 is 400.
const ACCELERATIONS_MM_S2: [f64; 6] = [100.0, 200.0, 400.0, 1000.0, 2000.0, 4000.0];
/// The least possible largest error of the square at the first of these, um, by a linear program: a reference, not made here.
const OPTIMUM_UM: [f64; 3] = [0.77, 0.12, 0.004];

type Failure = Box<dyn std::error::Error>;

/// RMS and largest contour error of a cut, um.
type Errors = [f64; 2];

fn main() -> Result<(), Failure> {
    let file = std::env::args().nth(1).ok_or("usage: correction_acceleration FILE.svg")?;
    let machine = Machine::load("tnv40".as_ref())?;
    let all = Workpiece::contours();
    let workpieces: Vec<&Workpiece> = CONTOURS.iter().filter_map(|name| all.iter().find(|w| w.name == *name)).collect();
    let open = row(&machine, &workpieces, BASELINE)?;
    let mut rows = Vec::new();
    for acceleration_mm_s2 in ACCELERATIONS_MM_S2 {
        let mut machine = machine.clone();
        machine.axes.iter_mut().for_each(|axis| axis.correction_accel_mm_s2 = Some(acceleration_mm_s2));
        rows.push(row(&machine, &workpieces, HORIZON)?);
    }
    print_table(&open, &rows);
    std::fs::write(file, figure(&open, &rows).to_svg())?;
    Ok(())
}

/// Errors of one controller on every contour.
fn row(machine: &Machine, workpieces: &[&Workpiece], name: &str) -> Result<Vec<Errors>, Failure> {
    let choices = Choices::default();
    let mut setup = Setup::new(machine, &choices);
    let entry = CONTROLLERS.find(name).ok_or("there is no such controller")?;
    let mut controller = Make::<2>::make(entry, &mut setup);
    let cut = |workpiece: &&Workpiece| -> Result<Errors, Failure> {
        let mut statistics = Statistics::new();
        Run::on(machine).cut_steps(&workpiece.steps, &mut *controller, &mut [&mut statistics])?;
        Ok([statistics.rms_um(), statistics.max_um()])
    };
    workpieces.iter().map(cut).collect()
}

fn print_table(open: &[Errors], rows: &[Vec<Errors>]) {
    println!("| RMS / max, µm | {} | square at best, max |", CONTOURS.join(" | "));
    println!("|---|{}", "--:|".repeat(CONTOURS.len() + 1));
    let cells = |row: &[Errors]| {
        let cells: Vec<String> = row.iter().map(|[rms_um, max_um]| format!("{rms_um:.3} / {max_um:.2}")).collect();
        cells.join(" | ")
    };
    println!("| uncorrected | {} | |", cells(open));
    for (k, row) in rows.iter().enumerate() {
        let optimum = OPTIMUM_UM.get(k).map_or(String::new(), |um| format!("{um} "));
        println!("| {} mm/s² | {} | {optimum}|", ACCELERATIONS_MM_S2[k], cells(row));
    }
}

/// Largest and RMS errors over the acceleration, as powers of ten on both axes.
fn figure(open: &[Errors], rows: &[Vec<Errors>]) -> Figure {
    let curve = |contour: usize, which: usize, line: LineStyle| {
        let points = rows.iter().zip(ACCELERATIONS_MM_S2);
        let at = |errors: Errors, acceleration: f64| [acceleration.log10(), errors[which].log10()];
        let points = match line {
            LineStyle::Dashed => ACCELERATIONS_MM_S2.iter().map(|a| at(open[contour], *a)).collect(),
            _ => points.map(|(row, a)| at(row[contour], a)).collect(),
        };
        let label = format!("{}{}", CONTOURS[contour], if line == LineStyle::Dashed { ", uncorrected" } else { "" });
        Polyline { label, points, line, color: COLORS[contour].to_owned() }
    };
    let panel = |which: usize, title: &str| {
        let mut curves: Vec<Polyline> =
            (0..CONTOURS.len()).map(|contour| curve(contour, which, LineStyle::Dashed)).collect();
        curves.extend((0..CONTOURS.len()).map(|contour| curve(contour, which, LineStyle::Solid)));
        Panel {
            title: title.to_owned(),
            x_title: "log10 of the acceleration [mm/s²]".to_owned(),
            y_title: "log10 of the contour error [µm]".to_owned(),
            curves,
            ..Panel::default()
        }
    };
    let mut largest = panel(1, "(b) Largest");
    let optimum = ACCELERATIONS_MM_S2.iter().zip(OPTIMUM_UM).map(|(a, um)| [a.log10(), um.log10()]).collect();
    largest.curves.push(Polyline {
        label: "square, optimum".to_owned(),
        points: optimum,
        line: LineStyle::Dotted,
        color: COLORS[0].to_owned(),
    });
    Figure { panels: vec![panel(0, "(a) RMS"), largest], columns: 2, aspect: 0.9 }
}
