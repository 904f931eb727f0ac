//! The controllers that decide in every servo period serve at any: settings follow from the period,
//! not from a millisecond.

use crate::sweep::part_or_whole;
use feedwright::{BASELINE, Choices, Setup, Statistics};
use feedwright_lab::{CONTROLLERS, Workpiece};
use feedwright_sim::{Machine, Period, Run};
use rayon::prelude::*;

/// Servo periods, s, and the mechanics periods in them.
const PERIODS: [(f64, u32); 5] = [
    (0.25e-3, 5),
    (0.5e-3, 5),
    (2e-3, 20),
    (4e-3, 40),
    (10e-3, 100),
];
/// RMS against the uncorrected cut's at the most: up to 2 ms, and beyond, where a corner lasts less
/// than a period.
const RATIO: f64 = 0.1;
const SLOW_RATIO: f64 = 0.6;

/// RMS and largest contour error, um.
fn cut_um(machine: &Machine, workpiece: &Workpiece, name: &str) -> [f64; 2] {
    let choices = Choices::default();
    let mut setup = Setup::new(machine, &choices);
    let mut controller = CONTROLLERS.find(name).unwrap().in_plane(&mut setup);
    let mut statistics = Statistics::new();
    let run = Run::on(machine)
        .cut_steps(&workpiece.steps, &mut *controller, &mut [&mut statistics])
        .unwrap();
    assert_eq!(
        run.faded_out, None,
        "{name}, {} on {}",
        workpiece.name, machine.name
    );
    [statistics.rms_um(), statistics.max_um()]
}

#[test]
fn the_regulator_corrects_at_every_servo_period() {
    let shapes: Vec<Workpiece> = Workpiece::contours()
        .into_iter()
        .filter(|w| ["circle", "square"].contains(&w.name.as_str()))
        .collect();
    assert_eq!(shapes.len(), 2);
    // The shorter the period, the longer the cut takes.
    PERIODS[part_or_whole(1, 0)..]
        .par_iter()
        .for_each(|&(servo_s, mechanics_per_servo)| {
            let mut machine = Machine::load("tnv40".as_ref()).unwrap();
            machine.name = format!("tnv40 at {} ms", 1e3 * servo_s);
            machine.period = Period {
                servo_s,
                mechanics_s: servo_s / f64::from(mechanics_per_servo),
                mechanics_per_servo,
            };
            for workpiece in &shapes {
                let [open_um, corrected_um] =
                    [BASELINE, "lqg-identified"].map(|name| cut_um(&machine, workpiece, name));
                eprintln!(
                    "{}, {}: {open_um:.2?} um uncorrected, {corrected_um:.2?} um",
                    machine.name, workpiece.name
                );
                let ratio = if servo_s > 2e-3 { SLOW_RATIO } else { RATIO };
                assert!(
                    corrected_um[0] <= ratio * open_um[0],
                    "{}, {}",
                    machine.name,
                    workpiece.name
                );
                assert!(
                    corrected_um[1] <= open_um[1],
                    "{}, {}",
                    machine.name,
                    workpiece.name
                );
            }
        });
}
