//! Identifies the geometry of simulated machines from a simulated ball bar, and compares it with
//! the truth.
//!
//! ```text
//! cargo run --release -p feedwright-ident --example ball_bar -- [SEEDS] [RADIUS_MM] [FEED_MM_MIN] [0|1] [MACHINE...]
//! ```
//!
//! With 1 the bar is recorded together with the encoders. The columns are truth, value of the first
//! seed, its standard deviation, mean and largest deviation, and in how many seeds the truth is
//! within one and two standard deviations. Below them stands the error that the geometry leaves on
//! a circle of 50 mm about the center, by the first seed.

#![expect(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "an example stops at what it did not expect"
)]

use std::f64::consts::TAU;

use feedwright_ident::{
    BallBarProgram, FoundGeometry, GeometryInput, SimulatedBallBar, fit_geometry,
};
use feedwright_sim::{AxisGeometry, GeometryFile, Machine, MeasuredSquareness};
use rayon::prelude::*;

/// Standard deviation of a sample, um.
const NOISE_UM: f64 = 0.3;
/// Radius of the circle that is predicted, mm.
const CIRCLE_MM: f64 = 25.0;

fn truth(machine: &Machine) -> GeometryFile {
    let axis = |i: usize| {
        let axis = machine.axis(i);
        AxisGeometry {
            scale_um_m: axis.scale_um_m,
            pitch_error_um: axis.pitch_error_um,
            lead_mm_per_rev: axis.lead_mm_per_rev,
            backlash_um: axis.transmission.map_or(0.0, |screw| screw.backlash_um),
            ..AxisGeometry::default()
        }
    };
    let squareness = MeasuredSquareness {
        squareness_xy_urad: machine.geometry.squareness_xy_urad,
        ..MeasuredSquareness::default()
    };
    GeometryFile {
        axes: [axis(0), axis(1), AxisGeometry::default()],
        squareness,
        ..GeometryFile::default()
    }
}

/// Radial errors on the circle: root mean square about their mean, and their mean, um.
fn on_circle_um(truth: &GeometryFile, found: &GeometryFile) -> [f64; 2] {
    let radial = |i: u32| {
        let (sin, cos) = libm::sincos(TAU * f64::from(i) / 3600.0 + 1e-6);
        let at = |file: &GeometryFile| {
            file.error_um(
                [CIRCLE_MM * cos, CIRCLE_MM * sin, 0.0],
                [-sin.signum(), cos.signum(), 0.0],
            )
        };
        let (truth, found) = (at(truth), at(found));
        cos * (truth[0] - found[0]) + sin * (truth[1] - found[1])
    };
    let errors: Vec<f64> = (0..3600).map(radial).collect();
    let mean = errors.iter().sum::<f64>() / 3600.0;
    [
        (errors
            .iter()
            .map(|error| (error - mean) * (error - mean))
            .sum::<f64>()
            / 3600.0)
            .sqrt(),
        mean,
    ]
}

fn found(machine: &Machine, bar: SimulatedBallBar) -> FoundGeometry {
    let GeometryInput::Sets(sets) =
        GeometryInput::parse("bar", &bar.text(machine).unwrap(), None).unwrap()
    else {
        unreachable!("a bar")
    };
    fit_geometry(sets, &machine.axes, "a simulated bar").unwrap()
}

/// The true value of a found one.
fn of_name(truth: &GeometryFile, name: &str) -> f64 {
    let (kind, axis) = name.rsplit_once(' ').unwrap();
    let axis = &truth.axes[usize::from(axis == "y")];
    match kind {
        "scale" => axis.scale_um_m,
        "backlash" => axis.backlash_um,
        "pitch error" => axis.pitch_error_um,
        "pitch phase" => axis.pitch_phase_deg,
        _ => truth.squareness.squareness_xy_urad,
    }
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let number = |at: usize, default: f64| {
        arguments
            .get(at)
            .map_or(default, |text| text.parse().unwrap())
    };
    let (seeds, radius_mm, feed_mm_min) =
        (number(0, 40.0) as u64, number(1, 100.0), number(2, 500.0));
    let has_encoders = number(3, 0.0) > 0.0;
    let machines: Vec<&str> = arguments.iter().skip(4).map(String::as_str).collect();
    for name in if machines.is_empty() {
        vec!["workshop", "stiff", "router"]
    } else {
        machines
    } {
        let machine = Machine::load(name.as_ref()).unwrap();
        let truth = truth(&machine);
        let program = BallBarProgram {
            radius_mm,
            feed_mm_min,
            plane: [0, 1],
        };
        let bar = |seed| SimulatedBallBar {
            program,
            center_mm: [0.0; 3],
            noise_um: NOISE_UM,
            samples: 3600,
            calibrated: true,
            has_encoders,
            seed,
        };
        let all: Vec<FoundGeometry> = (1..=seeds)
            .into_par_iter()
            .map(|seed| found(&machine, bar(seed)))
            .collect();
        let by = if has_encoders {
            "tool against encoders"
        } else {
            "tool alone"
        };
        println!("{name}, radius {radius_mm} mm, {feed_mm_min} mm/min, {by}, {seeds} seeds");
        println!(
            "{:<16} {:>9} {:>9} {:>8} {:>9} {:>9} {:>7} {:>7}",
            "", "truth", "found", "std", "mean off", "largest", "1 std", "2 std"
        );
        for value in &all[0].values {
            let true_value = of_name(&truth, &value.name);
            let of_seeds: Vec<_> = all
                .iter()
                .filter_map(|found| found.values.iter().find(|of| of.name == value.name))
                .collect();
            let off: Vec<f64> = of_seeds.iter().map(|of| of.value - true_value).collect();
            let within = |stds: f64| {
                of_seeds
                    .iter()
                    .zip(&off)
                    .filter(|(of, off)| off.abs() <= stds * of.std)
                    .count()
            };
            println!(
                "{:<16} {true_value:>9} {:>9.3} {:>8.3} {:>9.3} {:>9.3} {:>7} {:>7}",
                value.name,
                value.value,
                value.std,
                off.iter().sum::<f64>() / off.len() as f64,
                off.iter().fold(0.0, |most, off| off.abs().max(most)),
                within(1.0),
                within(2.0)
            );
        }
        let ([before, before_mean], [after, after_mean]) = (
            on_circle_um(&truth, &GeometryFile::default()),
            on_circle_um(&truth, &all[0].file),
        );
        println!(
            "circle of 50 mm: {before:.3} um RMS and radius {before_mean:+.3} um before; {after:.3} and {after_mean:+.3} um after"
        );
        println!("{}\n", all[0].lines().join("\n"));
    }
}
