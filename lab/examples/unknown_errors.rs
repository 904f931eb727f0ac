//! What compensated geometry leaves of errors that it does not have: angular errors and growth by heat.
//!
//! ```text
//! cargo run --release -p feedwright-lab --example unknown_errors
//! ```
//!
//! The machining center of the independent plant has roll, pitch and yaw of 10 urad over 400 mm, an Abbe arm of 150, 100 and -200
//! mm, and grows by 10 um/m with a time constant of 30 min. A grid encoder of 200 mm with 0.1 um of noise is read while it is cold.
//! The geometry that is found is compensated, and the grid is read again cold, and after 30 and 120 min. Rows have the deviations
//! of the tool from the grid, um RMS and largest, about their mean.

#![expect(clippy::unwrap_used, clippy::print_stdout, reason = "an example stops at what it did not expect")]

use std::fmt::Write;

use feedwright_control::KnownGeometry;
use feedwright_ident::{GeometryInput, KnownScrew, fit_geometry};
use feedwright_lab::independent_plant::IndependentPlant;
use feedwright_lab::independent_plant::machines::IndependentMachine;
use feedwright_lab::independent_plant::tool_errors::ToolErrors;
use feedwright_sim::Mechanism;

/// Points to a side, distance of points, mm, and servo periods of a move and a rest.
const POINTS: u32 = 11;
const STEP_MM: f64 = 20.0;
const MOVE: u32 = 1000;
const REST: u32 = 500;

const ANGULAR_RAD: f64 = 1e-5;
const ARM_MM: [f64; 3] = [150.0, 100.0, -200.0];
const GROWTH: f64 = 1e-5;
const WARMS_S: f64 = 1800.0;

/// Command and tool at each point of the grid, row by row, each row there and back.
fn grid(errors: ToolErrors, warm_s: f64, known: Option<&KnownGeometry<3>>) -> Vec<[[f64; 3]; 2]> {
    let machine = IndependentMachine::named("machining-center").unwrap();
    let mut plant = IndependentPlant::new(&machine.axes, [0.0; 3]).with_errors(errors, warm_s);
    let (mut from_mm, mut seen) = ([0.0; 3], Vec::new());
    for row in 0..POINTS {
        for point in (0..POINTS).chain((0..POINTS).rev()) {
            let to_mm = [f64::from(point) * STEP_MM, f64::from(row) * STEP_MM, 0.0];
            let mut tool_mm = from_mm;
            for n in 1..=MOVE + REST {
                let part = f64::from(n.min(MOVE)) / f64::from(MOVE);
                let at_mm = [0, 1, 2].map(|i| from_mm[i] + part * (to_mm[i] - from_mm[i]));
                tool_mm = plant.step(known.map_or(at_mm, |known| known.joints_mm(at_mm))).position_mm;
            }
            seen.push([to_mm, tool_mm]);
            from_mm = to_mm;
        }
    }
    seen
}

/// Deviations about their mean: root mean square and largest, um.
fn left_um(seen: &[[[f64; 3]; 2]]) -> [f64; 2] {
    let off = |i: usize| seen.iter().map(move |[to, tool]| 1e3 * (tool[i] - to[i]));
    let mean = [0, 1].map(|i| off(i).sum::<f64>() / seen.len() as f64);
    let squares: Vec<f64> = off(0).zip(off(1)).map(|(x, y)| (x - mean[0]).powi(2) + (y - mean[1]).powi(2)).collect();
    let most = squares.iter().copied().fold(0.0, f64::max);
    [(squares.iter().sum::<f64>() / squares.len() as f64).sqrt(), most.sqrt()]
}

fn main() {
    let angular = ToolErrors {
        angular_rad: [[ANGULAR_RAD; 3], [-ANGULAR_RAD; 3], [0.0; 3]],
        period_mm: [400.0; 3],
        arm_mm: ARM_MM,
        ..ToolErrors::default()
    };
    let heat = ToolErrors { growth: [GROWTH; 3], warms_s: WARMS_S, ..ToolErrors::default() };
    let both = ToolErrors { growth: heat.growth, warms_s: heat.warms_s, ..angular };
    println!("{:<10} {:>16} {:>16} {:>16} {:>16}", "errors", "not compensated", "cold", "30 min", "120 min");
    for (name, errors) in [("none", ToolErrors::default()), ("angular", angular), ("heat", heat), ("both", both)] {
        let cold = grid(errors, 0.0, None);
        let mut text = "# origin_mm: 0 0 0\nx_mm,y_mm,x_measured_mm,y_measured_mm\n".to_owned();
        for (n, [to_mm, tool_mm]) in cold.iter().enumerate() {
            // A sine of any frequency is noise to the fit.
            let noise_mm = 1.4e-4 * libm::sin(1.7 * (n * n) as f64);
            writeln!(text, "{},{},{:.6},{:.6}", to_mm[0], to_mm[1], tool_mm[0] + noise_mm, tool_mm[1] - noise_mm)
                .unwrap();
        }
        let GeometryInput::Sets(sets) = GeometryInput::parse("grid", &text, None).unwrap() else {
            unreachable!("a grid")
        };
        let screws = [Some(KnownScrew { lead_mm: 16.0, windup_um: 0.0 }); 3];
        let known = fit_geometry(sets, screws, "a simulated grid").map(|found| found.file.known().unwrap());
        let known = known.ok();
        let shown = |[rms, most]: [f64; 2]| format!("{rms:.2} / {most:.2}");
        let after = |warm_s: f64| shown(left_um(&grid(errors, warm_s, known.as_ref())));
        let row = [shown(left_um(&cold)), after(0.0), after(1800.0), after(7200.0)];
        println!("{name:<10} {:>16} {:>16} {:>16} {:>16}", row[0], row[1], row[2], row[3]);
    }
}
