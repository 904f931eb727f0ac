//! The planned path is the programmed one, corners included.

use super::{PairedStep, PlannedPiece, ProgrammedPart};
use crate::path::{PathError, Piece, Step, Steps};

/// The steps of a program as those of both paths.
pub(crate) struct UnchangedSteps<'p> {
    steps: Steps<'p>,
    /// Pieces so far.
    pieces: u64,
    /// A piece that was programmed and is to be planned next.
    next: Option<Piece>,
}

impl<'p> UnchangedSteps<'p> {
    /// Creates the steps of both paths from the steps of a program.
    pub(crate) const fn new(steps: Steps<'p>) -> Self {
        Self {
            steps,
            pieces: 0,
            next: None,
        }
    }
}

impl Iterator for UnchangedSteps<'_> {
    type Item = Result<PairedStep, PathError>;

    fn next(&mut self) -> Option<Self::Item> {
        if let Some(piece) = self.next.take() {
            let origin = ProgrammedPart::Unchanged(self.pieces);
            self.pieces += 1;
            return Some(Ok(PairedStep::Planned(PlannedPiece { piece, origin })));
        }
        Some(self.steps.next()?.map(|step| match step {
            Step::Piece(piece) => {
                self.next = Some(piece.clone());
                PairedStep::Programmed(piece)
            }
            Step::Event(event) => PairedStep::Event(event),
            Step::Rest(rest) => PairedStep::Rest(rest),
        }))
    }
}
