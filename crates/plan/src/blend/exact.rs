//! The null member: the planned path is the programmed one, corners included.

use super::{BlendedStep, PlannedPiece, ProgrammedPart};
use crate::path::{PathError, Piece, Step, Steps};

/// See the module's page.
pub(crate) struct ExactBlend<'p> {
    steps: Steps<'p>,
    /// Pieces so far.
    pieces: u64,
    /// A piece that was programmed and is to be planned next.
    next: Option<Piece>,
}

impl<'p> ExactBlend<'p> {
    /// Of the steps of a program.
    pub(crate) const fn new(steps: Steps<'p>) -> Self {
        Self { steps, pieces: 0, next: None }
    }
}

impl Iterator for ExactBlend<'_> {
    type Item = Result<BlendedStep, PathError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(piece) = self.next.take() {
            let origin = ProgrammedPart::Unchanged(self.pieces);
            self.pieces += 1;
            return Some(Ok(BlendedStep::Planned(PlannedPiece { piece, origin })));
        }
        Some(self.steps.next()?.map(|step| match step {
            Step::Piece(piece) => {
                self.next = Some(piece.clone());
                BlendedStep::Programmed(piece)
            }
            Step::Event(event) => BlendedStep::Event(event),
            Step::Rest(rest) => BlendedStep::Rest(rest),
        }))
    }
}
