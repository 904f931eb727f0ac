//! A plain program is corrected for every control, or refused by its figures: units, planes and
//! modes keep no text from being written.

use std::fmt::Write;

use feedwright::{CorrectJob, TARGETS, TargetControl};
use feedwright_gcode::canon::{Canon, EventKind};
use feedwright_gcode::{Dialect, INCH_MM, Program, Reader, Settings};
use feedwright_sim::Machine;

use crate::sweep::part_or_whole;

/// Programs that are drawn: in the suite, and in the sweep.
const PROGRAMS: [u64; 2] = [3, 100];
/// Largest distance between the ends of a corrected program and of the original, mm: two printed
/// steps of `fanuc` in inches.
const END_MM: f64 = 2.0 * INCH_MM * 1e-4;
/// Reasons that come from figures and from no text.
const FIGURES: [&str; 3] = [
    "it is worse",
    "it is no better",
    "no stretch of the program gets better",
];

/// Numbers from a seed.
struct SeededNumbers(u64);

impl SeededNumbers {
    /// A whole number below `count`.
    fn below(&mut self, count: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % count
    }
}

/// Writes a program in units and modes that change.
struct MotionWriter {
    text: String,
    unit_mm: f64,
    is_incremental: bool,
    is_inverse: bool,
    at_mm: [f64; 3],
}

impl MotionWriter {
    fn length(&self, mm: f64) -> String {
        format!("{:.4}", mm / self.unit_mm)
    }

    /// The words of a position and of the feed, mm/s, of a way of this length to it, mm.
    fn to(&mut self, code: &str, end_mm: [f64; 3], center: &str, [feed_mm_s, way_mm]: [f64; 2]) {
        let from_mm = if self.is_incremental {
            self.at_mm
        } else {
            [0.0; 3]
        };
        let words: Vec<String> = (0..3)
            .map(|i| {
                format!(
                    "{}{}",
                    ["X", "Y", "Z"][i],
                    self.length(end_mm[i] - from_mm[i])
                )
            })
            .collect();
        let feed = 60.0
            * if self.is_inverse {
                feed_mm_s / way_mm
            } else {
                feed_mm_s / self.unit_mm
            };
        let _ = writeln!(self.text, "{code} {} {center} F{feed:.3}", words.join(" "));
        self.at_mm = end_mm;
    }

    fn line(&mut self, by_mm: [f64; 3], feed_mm_s: f64) {
        let end_mm = std::array::from_fn(|i| self.at_mm[i] + by_mm[i]);
        let way_mm = by_mm.iter().map(|mm| mm * mm).sum::<f64>().sqrt();
        self.to("G1", end_mm, "", [feed_mm_s, way_mm]);
    }

    /// A quarter of a circle in a plane, to the left.
    fn quarter(&mut self, plane: usize, radius_mm: f64, feed_mm_s: f64) {
        let ([a, b], word) = [([0, 1], "G17"), ([2, 0], "G18"), ([1, 2], "G19")][plane];
        let mut end_mm = self.at_mm;
        (end_mm[a], end_mm[b]) = (end_mm[a] + radius_mm, end_mm[b] + radius_mm);
        let zero = self.length(0.0);
        let center = format!(
            "{}{zero} {}{}",
            ["I", "J", "K"][a],
            ["I", "J", "K"][b],
            self.length(radius_mm)
        );
        self.to(
            &format!("{word} G3"),
            end_mm,
            &center,
            [feed_mm_s, 0.5 * std::f64::consts::PI * radius_mm],
        );
    }
}

/// A program of lines and arcs.
fn program(seed: u64) -> String {
    let mut draw = SeededNumbers(seed);
    let is_inch = draw.below(2) == 0;
    let mut words = MotionWriter {
        text: String::new(),
        unit_mm: if is_inch { INCH_MM } else { 1.0 },
        is_incremental: draw.below(2) == 0,
        is_inverse: draw.below(3) == 0,
        at_mm: [0.0; 3],
    };
    let (unit, distance) = (
        if is_inch { 20 } else { 21 },
        if words.is_incremental { 91 } else { 90 },
    );
    let feed = if words.is_inverse { 93 } else { 94 };
    let _ = writeln!(
        words.text,
        "G{unit} G90 G17 G94 G64\nG0 X0.0 Y0.0 Z0.0\nG{distance} G{feed}"
    );
    let feed_mm_s = 20.0 + draw.below(20) as f64;
    let switches = draw.below(3) == 0;
    for block in 0..4 {
        if switches && block == 2 {
            (words.unit_mm, words.text) = (
                if is_inch { 1.0 } else { INCH_MM },
                format!("{}G{}\n", words.text, if is_inch { 21 } else { 20 }),
            );
        }
        let mm = (4 + draw.below(8)) as f64 * 0.254;
        match draw.below(4) {
            3 => words.line([mm, 0.5 * mm, 0.0], feed_mm_s),
            plane => words.quarter(plane as usize, mm, feed_mm_s),
        }
    }
    words.text + "M2\n"
}

/// A machine that LinuxCNC, too, can plan for.
fn machine() -> Machine {
    let axis = |name: &str| {
        format!(
            "[axis.{name}]\nmax_velocity_mm_s = 200\nmax_accel_mm_s2 = 2000\nmax_jerk_mm_s3 = 50000\n"
        )
    };
    let head = "base = \"tnv40\"\nname = \"limited\"\ndescription = \"tnv40 with limits\"\nsource = \"a test\"\n";
    let axes: String = ["x", "y", "z"].map(axis).concat();
    Machine::parse(
        "limited",
        &format!("{head}{axes}[limits]\npath_tolerance_um = 10\n"),
    )
    .unwrap()
}

/// Reads a text as the control does: its end, mm, and the time of all dwells, s.
fn end_and_dwells(text: &str, target: &TargetControl) -> ([f64; 3], f64) {
    let settings = Settings {
        dialect: target.dialect.or(Some(Dialect::LinuxCnc)),
        ..Settings::default()
    };
    let (mut end_mm, mut dwells_s) = ([0.0; 3], 0.0);
    for step in Reader::from_text("part.ngc", text, settings).unwrap() {
        match step.unwrap() {
            Canon::Motion(motion) => end_mm = motion.end_mm,
            Canon::Event(event) => {
                if let EventKind::Dwell { seconds } = event.kind {
                    dwells_s += seconds;
                }
            }
        }
    }
    (end_mm, dwells_s)
}

/// Corrects a text; returns whether it was written.
fn check(text: &str, target: &'static TargetControl) -> bool {
    let mut job = CorrectJob::new(Program::from_text("part.ngc", text), machine(), target);
    job.file_error = 0.0;
    let outcome = job.run(&()).unwrap();
    let Some(written) = outcome.program() else {
        let refusal = outcome.refusal.unwrap_or_default();
        assert!(
            FIGURES.iter().any(|reason| refusal.starts_with(reason)),
            "{}: {refusal}\n{text}",
            target.name
        );
        return false;
    };
    let ((end_mm, _), (found_mm, dwells_s)) = (
        end_and_dwells(text, &TARGETS[0]),
        end_and_dwells(written, target),
    );
    let off_mm = end_mm
        .iter()
        .zip(found_mm)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(
        off_mm < END_MM && dwells_s < 1.0,
        "{}: {off_mm} mm off, {dwells_s} s of dwells\n{text}{written}",
        target.name
    );
    assert!(
        written.lines().all(|line| line.len() <= target.columns),
        "{written}"
    );
    true
}

#[test]
fn a_plain_program_is_written_for_every_control_whatever_its_units_planes_and_modes() {
    let programs = part_or_whole(PROGRAMS[0], PROGRAMS[1]);
    let written = (1..=programs).flat_map(|seed| {
        TARGETS
            .iter()
            .map(move |target| check(&program(seed), target))
    });
    let written = written.filter(|written| *written).count();
    assert!(written > programs as usize, "{written} written");
}

/// Programs in inches, along an axis, with arcs of another plane, and with a change of the unit.
#[test]
fn inch_programs_are_written_for_every_control() {
    for text in [
        "G20\nG0 X0 Y0 Z0.1\nG1 Z-0.1 F40\nX1\nY0.5\nM2\n",
        "G20 G91 G18\nG0 X0 Y0 Z0\nG2 X0 Z0 I0.25 K0 F90\nG1 Y0.4\nM2\n",
        "G21 G90\nG0 X0 Y0\nG2 X0 Y0 I6 J0 F2400\nG20\nG1 X1 Y0.5 F90\nG3 X1 Y0.5 I0.2 J0\nM2\n",
    ] {
        for target in TARGETS {
            assert!(check(text, target), "{}: {text}", target.name);
        }
    }
}
