//! Learning while cutting does no harm: not on a straight line of minutes, not with another seed of
//! the training.

use crate::sweep::part_or_whole;
use feedwright::{Choices, Setup};
use feedwright_gcode::canon::{AuxiliaryAxes, Canon, Corner, Motion, MotionKind, Plane, Shape};
use feedwright_lab::CONTROLLERS;
use feedwright_sim::{Machine, Row, Run, Sink, path_steps};
use rayon::prelude::*;

/// Controller that learns how much weight a measurement deserves.
const REGULATOR: &str = "lqg-identified";
const FEED_MM_S: f64 = 50.0;
/// A minute at that feedrate in the suite, ten in the sweep.
const LONG_LINE_MM: [f64; 2] = [60.0 * FEED_MM_S, 600.0 * FEED_MM_S];
const SHORT_LINE_MM: f64 = 20.0;

/// Squares of the contour error of one line of the program.
struct LineError {
    line: u32,
    square_um2: f64,
    rows: u64,
}

impl LineError {
    fn rms_um(&self) -> f64 {
        (self.square_um2 / self.rows as f64).sqrt()
    }
}

impl Sink for LineError {
    fn row(&mut self, row: &Row) -> std::io::Result<()> {
        if row.line == self.line && row.cutting {
            self.square_um2 += (row.contour_error_mm * 1e3).powi(2);
            self.rows += 1;
        }
        Ok(())
    }
}

/// A line along x, and a circle of 10 mm.
fn line_and_circle(length_mm: f64) -> Vec<Canon> {
    let motion = |line: u32, from_x: f64, to_x: f64, shape| {
        Canon::Motion(Motion {
            line,
            kind: MotionKind::Feed,
            start_mm: [from_x, 0.0, 0.0],
            end_mm: [to_x, 0.0, 0.0],
            shape,
            feed_mm_s: FEED_MM_S,
            corner: Corner::Continuous {
                tolerance_mm: None,
                merge_mm: None,
            },
            others: AuxiliaryAxes::default(),
        })
    };
    let circle = Shape::Arc {
        plane: Plane::Xy,
        center_mm: [length_mm, 10.0, 0.0],
        turns: 1,
    };
    vec![
        motion(1, 0.0, length_mm, Shape::Line),
        motion(2, length_mm, length_mm, circle),
    ]
}

/// RMS contour error of the circle behind a line of this length, um, with a controller that was
/// identified on tnv40. It knows what the drives of the machine that it cuts on are set to.
fn circle_behind(length_mm: f64, machine: &Machine, seed: u64) -> f64 {
    let nominal = Machine::load("tnv40".as_ref()).unwrap();
    let choices = Choices {
        seed,
        ..Choices::default()
    };
    let mut setup = Setup::new(&nominal, &choices);
    setup.known = machine.known();
    let mut controller = CONTROLLERS.find(REGULATOR).unwrap().in_plane(&mut setup);
    let mut error = LineError {
        line: 2,
        square_um2: 0.0,
        rows: 0,
    };
    let program = || Ok(path_steps(line_and_circle(length_mm)));
    let run = Run::on(machine)
        .cut(program, &mut *controller, &mut [&mut error])
        .unwrap();
    assert_eq!(run.faded_out, None);
    error.rms_um()
}

#[test]
fn nothing_drifts_on_a_long_straight_line() {
    let long_mm = part_or_whole(LONG_LINE_MM[0], LONG_LINE_MM[1]);
    ["tnv40", "coarse"].par_iter().for_each(|name| {
        let machine = Machine::load(name.as_ref()).unwrap();
        let behind_um = |length_mm: f64| circle_behind(length_mm, &machine, 1);
        // What an unknown machine has been learnt of differs from one short line to the next, too.
        let short_um = [1.0, 1.5, 2.5].map(|times| behind_um(times * SHORT_LINE_MM));
        eprintln!("{name}: circle behind short lines {short_um:.3?} um");
        let short_um = short_um.into_iter().fold(0.0, f64::max);
        let long_um = behind_um(long_mm);
        eprintln!(
            "{name}: circle behind a short line {short_um:.3} um, behind a long one {long_um:.3} um"
        );
        assert!(
            long_um <= 1.5 * short_um + 0.05,
            "{name}: {short_um} um, then {long_um} um"
        );
    });
}

#[test]
fn the_worst_of_many_seeds_is_near_the_median() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let seeds = part_or_whole(4, 10);
    let mut errors_um: Vec<f64> = (1..=seeds)
        .into_par_iter()
        .map(|seed| circle_behind(SHORT_LINE_MM, &machine, seed))
        .collect();
    errors_um.sort_by(f64::total_cmp);
    let half = errors_um.len() / 2;
    let median_um = 0.5 * (errors_um[half - 1] + errors_um[half]);
    eprintln!("{seeds} seeds: {errors_um:.3?} um");
    assert!(
        errors_um[errors_um.len() - 1] <= 1.5 * median_um,
        "{errors_um:?}"
    );
}
