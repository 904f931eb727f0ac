//! A run through a whole program ahead of all others: every fault at once, or what the program
//! amounts to.

use std::sync::Arc;

use crate::canon::{Canon, Motion, MotionKind, Shape};
use crate::flow::reader::Reader;
use crate::geometry::spiral::Spiral;
use crate::settings::Dialect;
use crate::text::diagnostic::{Diagnostic, Severity};
use crate::text::read_error::ReadError;

/// Totals of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct Summary {
    /// File as the user named it.
    pub(crate) name: Arc<str>,
    /// Motions.
    pub motions: u64,
    /// Events.
    pub events: u64,
    /// True for each of X, Y and Z that moves.
    pub moves: [bool; 3],
    /// True where A, B, C, U, V, W or an extruder moves.
    pub moves_others: bool,
    /// First line in which each of A, B, C, U, V and W moves.
    pub(crate) others_move: [Option<u32>; 6],
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
    /// Warnings, which do not stop the program.
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

/// Runs through the program that `reader` has just opened.
///
/// # Errors
/// All faults of the program.
pub fn summarize(mut reader: Reader) -> Result<Summary, CheckError> {
    let mut summary = Summary {
        name: reader.name(),
        motions: 0,
        events: 0,
        moves: [false; 3],
        moves_others: false,
        others_move: [None; 6],
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
        let mut fault =
            Diagnostic::of_file(Severity::Error, "gcode::no_motion", reader.name(), message);
        fault.hint = Some(NO_MOTION_HINT.to_owned());
        faults.push(fault);
    }
    let counted = |mut diagnostic: Diagnostic| {
        let times = reader.times(&diagnostic);
        if times > 1 {
            diagnostic.message += &format!(" ({times} times)");
        }
        diagnostic
    };
    if !faults.is_empty() {
        return Err(CheckError::Faults(
            faults.into_iter().map(counted).collect(),
        ));
    }
    summary.lines = reader.lines();
    summary.warnings = reader.warnings().iter().cloned().map(counted).collect();
    Ok(summary)
}

/// Why a program may have no motion although none of its lines is wrong.
const NO_MOTION_HINT: &str = "an early M2, M30 or %, a subroutine that nothing calls, and a comment around everything leave nothing to do; \
                              is this the right file?";

impl Summary {
    fn add(&mut self, motion: &Motion) {
        self.motions += 1;
        self.moves_others |= !motion.others.is_none();
        if let Some([start, end]) = motion.others.axes.as_deref() {
            for axis in (0..6).filter(|&axis| start[axis] != end[axis]) {
                self.others_move[axis].get_or_insert(motion.line);
            }
        }
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
            Shape::Arc {
                plane,
                center_mm,
                turns,
            } => {
                let [first, second, _] = plane.axes();
                self.moves[first] = true;
                self.moves[second] = true;
                let spiral =
                    Spiral::new(motion.start_mm, motion.end_mm, *center_mm, *plane, *turns);
                for point in spiral.extremes(motion.start_mm) {
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

    /// A warning where axes move that nothing behind the reader simulates or controls.
    pub fn uncontrolled(&self) -> Option<Diagnostic> {
        let line = self.others_move.iter().flatten().min()?;
        let moving = "ABCUVW"
            .chars()
            .zip(self.others_move)
            .filter(|(_, line)| line.is_some());
        let names = moving
            .map(|(name, _)| name.to_string())
            .collect::<Vec<_>>()
            .join(", ");
        let message =
            format!("line {line}: {names} moves; only X, Y and Z are simulated and controlled");
        let mut warning = Diagnostic::of_file(
            Severity::Warning,
            "gcode::other_axes",
            self.name.clone(),
            message,
        );
        warning.hint = Some(
            "where it moves alone it takes its time; together with X, Y or Z it slows them down to its rate, which is rotary_deg_s in [plc]"
                .to_owned(),
        );
        Some(warning)
    }

    fn include(&mut self, point: [f64; 3]) {
        let [low, high] = &mut self.box_mm;
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
}
