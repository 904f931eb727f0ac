//! Blend: from the programmed path to the path that is planned.
//!
//! What is planned need not be what is programmed: within a tolerance a corner may be rounded, short lines may be joined. Both
//! paths go on from here. The command runs along the planned one; contour errors are measured to the programmed one. Each planned
//! piece says for which part of the programmed path it stands ([`ProgrammedPart`]), so that line, arc length and contour error of a
//! plan time are those of the program.
//!
//! Blends are a family: this file has the contract and the table [`BLENDS`], each member one file.
//!
//! | File | What |
//! |---|---|
//! | `exact.rs` | null member: the planned path is the programmed one |
//! | `aligned.rs` | no member: the path of another program, beside the programmed one |

pub(crate) mod exact;
pub(crate) mod aligned;

use feedwright_gcode::canon::Event;

use crate::constraints::Constraints;
use crate::path::{PathError, Piece, Rest, Steps};

/// A piece of the planned path.
#[derive(Debug, Clone)]
pub struct PlannedPiece {
    /// Curve, feedrate and what else the program says; its `s_mm` is the arc length of the planned path.
    pub piece: Piece,
    /// For which part of the programmed path it stands.
    pub origin: ProgrammedPart,
}

/// Part of the programmed path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ProgrammedPart {
    /// The programmed piece of this number, from 0, unchanged.
    Unchanged(u64),
    /// From one arc length of the programmed path to another, mm, evenly along the planned piece.
    Part {
        /// Where it begins.
        from_mm: f64,
        /// Where it ends, not before its beginning.
        to_mm: f64,
    },
}

/// One step of both paths.
#[derive(Debug, Clone)]
pub enum BlendedStep {
    /// The next piece of the programmed path. It comes before all planned pieces that stand for a part of it.
    Programmed(Piece),
    /// The next piece of the planned path; where the tool does not stop, it begins where the one before ended.
    Planned(PlannedPiece),
    /// Something else happens.
    Event(Event),
    /// The tool stands still.
    Rest(Rest),
}

/// Steps in program order; the first error ends both paths.
pub type BlendedSteps<'p> = Box<dyn Iterator<Item = Result<BlendedStep, PathError>> + Send + 'p>;

/// A row of [`BLENDS`].
#[derive(Debug, Clone, Copy)]
pub struct BlendMember {
    /// Name.
    pub name: &'static str,
    /// What it does, for lists.
    pub about: &'static str,
    /// Blends the steps of a program, on a machine with these constraints.
    pub make: for<'p> fn(Steps<'p>, &Constraints) -> BlendedSteps<'p>,
}

/// All blends; the first is the default.
pub const BLENDS: &[BlendMember] = &[BlendMember {
    name: "exact",
    about: "the programmed path, corners included",
    make: |steps, _| Box::new(exact::ExactBlend::new(steps)),
}];
