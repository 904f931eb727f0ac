//! What a G-code program asks for, once modes, units, offsets and expressions are resolved.
//!
//! Lengths in millimetres, feeds in mm/s, times in seconds, in machine coordinates: offsets and
//! tool lengths are added.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

/// One step of a program, in program order.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Canon {
    /// The tool moves.
    Motion(Motion),
    /// Something other than a motion happens.
    Event(Event),
}

/// A motion from `start_mm` to `end_mm`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// Line of the program, from 1.
    pub line: u32,
    /// Rapid or cutting feed.
    pub kind: MotionKind,
    /// Start point, machine coordinates, mm.
    pub start_mm: [f64; 3],
    /// End point, machine coordinates, mm.
    pub end_mm: [f64; 3],
    /// The curve between the two.
    pub shape: Shape,
    /// Programmed feedrate, mm/s; not used by a rapid.
    pub feed_mm_s: f64,
    /// Corner mode at the end of this motion.
    pub corner: Corner,
    /// Motion of the other axes and the extruder.
    #[serde(default, skip_serializing_if = "AuxiliaryAxes::is_none")]
    pub others: AuxiliaryAxes,
}

/// Axes that move along with X, Y and Z during a motion. `AuxiliaryAxes::default()` moves none.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct AuxiliaryAxes {
    /// Filament pushed during the motion (E of 3D printers), mm; negative pulls back.
    pub extruder_mm: f64,
    /// Start and end of A, B, C in degrees and U, V, W in mm; present only where one of them moves.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axes: Option<Box<[[f64; 6]; 2]>>,
}

impl AuxiliaryAxes {
    /// Returns true if no other axis and no extruder moves.
    pub fn is_none(&self) -> bool {
        self.extruder_mm == 0.0 && self.axes.is_none()
    }
}

/// Rapid or cutting feed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MotionKind {
    /// G0: at the machine's rapid rate, not cutting.
    Rapid,
    /// G1, G2, G3 and splines: at the programmed feedrate.
    Feed,
}

/// The curve of a motion.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// Straight.
    Line,
    /// Circular in `plane` about `center_mm`, with a linear motion along the plane's normal
    /// (helix).
    Arc {
        /// Plane of the circle.
        plane: Plane,
        /// Centre; its component along the plane's normal is the start's.
        center_mm: [f64; 3],
        /// Sign: positive is counter-clockwise seen from the positive normal. Magnitude: 1 is at
        /// most one full turn, each further unit adds a full turn.
        turns: i32,
    },
    /// Rational B-spline.
    Spline(Arc<Spline>),
}

/// Plane of an arc: G17 is XY, G18 is ZX, G19 is YZ.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Plane {
    /// G17, normal +Z.
    Xy,
    /// G18, normal +Y.
    Zx,
    /// G19, normal +X.
    Yz,
}

impl Plane {
    /// Indices of the first axis, the second axis and the normal: a right-handed triple.
    pub const fn axes(self) -> [usize; 3] {
        match self {
            Self::Xy => [0, 1, 2],
            Self::Zx => [2, 0, 1],
            Self::Yz => [1, 2, 0],
        }
    }
}

/// Non-uniform rational B-spline with `control_mm.len() + degree + 1` knots.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spline {
    /// Polynomial degree, at least 1.
    pub degree: usize,
    /// Knot values, non-decreasing.
    pub knots: Vec<f64>,
    /// Control points.
    pub control_mm: Vec<[f64; 3]>,
    /// One positive weight for each control point.
    pub weights: Vec<f64>,
}

/// Corner mode.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Corner {
    /// G61.1: a full stop at the end of every motion, corner or not.
    ExactStop,
    /// G61: the programmed path exactly, stopping where the direction changes.
    ExactPath,
    /// G64: corners at a speed, the path within `tolerance_mm` where one is given (P word).
    Continuous {
        /// P of G64.
        tolerance_mm: Option<f64>,
        /// Q of G64: how far points may lie from a line that stands for several short ones.
        #[serde(skip_serializing_if = "Option::is_none")]
        merge_mm: Option<f64>,
    },
}

/// Something other than a motion.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Event {
    /// Line of the program, from 1.
    pub line: u32,
    /// Kind of the event.
    pub kind: EventKind,
}

/// Kind of an [`Event`].
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EventKind {
    /// G4: the tool rests.
    Dwell {
        /// Seconds.
        seconds: f64,
    },
    /// S word: commanded spindle speed, rev/min.
    SpindleSpeed {
        /// Revolutions per minute.
        rpm: f64,
    },
    /// Any M-code, with its number: kept, timed and drawn by later stages.
    MCode {
        /// Number behind M.
        code: u16,
        /// Its P word.
        #[serde(skip_serializing_if = "Option::is_none")]
        p: Option<f64>,
        /// Its Q word.
        #[serde(skip_serializing_if = "Option::is_none")]
        q: Option<f64>,
    },
    /// T word: the tool that the next M6 loads.
    ToolSelect {
        /// Tool number.
        tool: u32,
    },
    /// A message to the operator: (MSG, ...), (PRINT, ...), (DEBUG, ...).
    Message {
        /// The text, with the values of its parameters.
        text: String,
    },
    /// Spindle and feed are coupled from here on: threads and rigid tapping.
    SpindleSync {
        /// Way per revolution; `None` ends the coupling.
        pitch_mm: Option<f64>,
    },
    /// The next motion ends where a probe trips; here it goes all the way.
    Probe,
    /// M2, M30 or % at the end.
    ProgramEnd,
}
