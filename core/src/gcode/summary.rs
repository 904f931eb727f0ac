//! A run through a whole program ahead of all others: every fault at once, or what the program amounts to.

use std::path::Path;

use super::canon::{Canon, Motion, MotionKind, Shape};
use super::diagnostic::{Diagnostic, Severity};
use super::reader::{ReadError, Reader};
use super::settings::{Dialect, Settings};

/// What a program amounts to.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// Motions.
    pub motions: u64,
    /// Events.
    pub events: u64,
    /// Which of X, Y and Z move.
    pub moves: [bool; 3],
    /// Whether A B C U V W or an extruder moves.
    pub moves_others: bool,
    /// Length of all feed motions, mm.
    pub feed_mm: f64,
    /// Length of all rapids, mm.
    pub rapid_mm: f64,
    /// Lines carried out.
    pub lines: u64,
    /// Corners of the box around all end points and arcs, mm.
    pub box_mm: [[f64; 3]; 2],
    /// Dialect and why it was chosen.
    pub dialect: (Dialect, &'static str),
    /// What deserves a look.
    pub warnings: Vec<Diagnostic>,
}

/// Why a program must not run.
#[derive(Debug)]
pub enum CheckError {
    /// It cannot be read at all.
    Read(ReadError),
    /// Its faults, in program order.
    Faults(Vec<Diagnostic>),
}

/// Runs through the program in a file.
///
/// # Errors
/// All faults of the program, up to [`Settings::max_errors`].
pub fn check(path: &Path, settings: Settings) -> Result<Summary, CheckError> {
    summarize(Reader::open(path, settings).map_err(CheckError::Read)?)
}

/// Runs through the program that `reader` has just opened.
///
/// # Errors
/// All faults of the program.
pub fn summarize(mut reader: Reader) -> Result<Summary, CheckError> {
    let mut summary = Summary {
        motions: 0,
        events: 0,
        moves: [false; 3],
        moves_others: false,
        feed_mm: 0.0,
        rapid_mm: 0.0,
        lines: 0,
        box_mm: [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]],
        dialect: reader.dialect(),
        warnings: Vec::new(),
    };
    let mut faults = Vec::new();
    for step in &mut reader {
        match step {
            Ok(Canon::Motion(motion)) => summary.add(&motion),
            Ok(Canon::Event(_)) => summary.events += 1,
            Err(fault) => faults.push(fault),
        }
    }
    if summary.motions == 0 && faults.is_empty() {
        let message = "the program has no motion".to_owned();
        faults.push(Diagnostic::of_file(Severity::Error, "gcode::no_motion", reader.name(), message));
    }
    if !faults.is_empty() {
        return Err(CheckError::Faults(faults));
    }
    summary.lines = reader.lines();
    summary.warnings = reader.warnings().to_vec();
    Ok(summary)
}

impl Summary {
    fn add(&mut self, motion: &Motion) {
        self.motions += 1;
        self.moves_others |= !motion.others.is_none();
        let length = motion.length_mm();
        match motion.kind {
            MotionKind::Feed => self.feed_mm += length,
            MotionKind::Rapid => self.rapid_mm += length,
        }
        self.include(motion.start_mm);
        self.include(motion.end_mm);
        for axis in 0..3 {
            self.moves[axis] |= motion.start_mm[axis] != motion.end_mm[axis];
        }
        match &motion.shape {
            Shape::Line => {}
            Shape::Arc { plane, center_mm, turns } => {
                let [first, second, _] = plane.axes();
                self.moves[first] = true;
                self.moves[second] = true;
                for point in arc_extremes(motion, *center_mm, [first, second], *turns) {
                    self.include(point);
                }
            }
            Shape::Spline(spline) => {
                // The curve lies within the box of its control points.
                for &point in &spline.control_mm {
                    self.include(point);
                    for axis in 0..3 {
                        self.moves[axis] |= point[axis] != motion.start_mm[axis];
                    }
                }
            }
        }
    }

    fn include(&mut self, point: [f64; 3]) {
        let [low, high] = &mut self.box_mm;
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
}

/// The points of an arc that lie farthest out along the plane's axes.
fn arc_extremes(motion: &Motion, center: [f64; 3], plane: [usize; 2], turns: i32) -> Vec<[f64; 3]> {
    use std::f64::consts::{FRAC_PI_2, TAU};
    let [first, second] = plane;
    let angle_of = |point: [f64; 3]| (point[second] - center[second]).atan2(point[first] - center[first]);
    let radius = (motion.start_mm[first] - center[first]).hypot(motion.start_mm[second] - center[second]);
    let (from, to) = if turns > 0 { (motion.start_mm, motion.end_mm) } else { (motion.end_mm, motion.start_mm) };
    let begin = angle_of(from);
    let sweep = (angle_of(to) - begin).rem_euclid(TAU);
    let whole = turns.abs() > 1 || sweep * radius < super::arc::FULL_TURN_WITHIN_MM;
    (0..4)
        .map(|quarter| f64::from(quarter) * FRAC_PI_2)
        .filter(|quarter| whole || (quarter - begin).rem_euclid(TAU) <= sweep)
        .map(|quarter| {
            let mut point = motion.start_mm;
            point[first] = center[first] + radius * quarter.cos();
            point[second] = center[second] + radius * quarter.sin();
            point
        })
        .collect()
}
