//! The planned path beside the programmed one.
//!
//! What is planned need not be what is programmed: a correction commands another path. Both paths
//! go on from here. The command runs along the planned one; contour errors are measured to the
//! programmed one. Each planned piece says for which part of the programmed path it stands
//! ([`ProgrammedPart`]), so that line, arc length and contour error of a plan time are those of the
//! program.
//!
//! | File | What |
//! |---|---|
//! | `unchanged.rs` | the planned path is the programmed one, corners included |
//! | `aligned.rs` | the path of another program, beside the programmed one |

pub(crate) mod unchanged;
pub(crate) mod aligned;

use feedwright_gcode::canon::Event;

use crate::path::{PathError, Piece, Rest};

/// A piece of the planned path.
#[derive(Debug, Clone)]
pub struct PlannedPiece {
    /// Curve, feedrate and what else the program says; its `s_mm` is the arc length of the planned
    /// path.
    pub piece: Piece,
    /// Part of the programmed path for which the piece stands.
    pub origin: ProgrammedPart,
}

/// Part of the programmed path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProgrammedPart {
    /// The programmed piece of this number, from 0, unchanged.
    Unchanged(u64),
    /// Part from one arc length of the programmed path to another, mm, evenly along the planned
    /// piece.
    Part {
        /// Start of the part, mm.
        from_mm: f64,
        /// End of the part, mm, not before its start.
        to_mm: f64,
    },
}

/// One step of both paths.
#[derive(Debug, Clone)]
pub enum PairedStep {
    /// The next piece of the programmed path. It comes before all planned pieces that stand for a
    /// part of it.
    Programmed(Piece),
    /// The next piece of the planned path; where the tool does not stop, it begins where the one
    /// before ended.
    Planned(PlannedPiece),
    /// Something else happens.
    Event(Event),
    /// The tool stands still.
    Rest(Rest),
}

/// Steps in program order; the first error ends both paths.
pub type PairedSteps<'p> = Box<dyn Iterator<Item = Result<PairedStep, PathError>> + Send + 'p>;
