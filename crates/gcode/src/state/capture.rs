//! The blocks N(P) to N(Q) of a lathe cycle of Fanuc while they are read: their motions are kept
//! instead of handed out.

use crate::canon::{Canon, Motion, Plane, Shape};
use crate::state::Interpreter;
use crate::state::frame::Position;
use crate::state::modal::Modal;
use crate::text::block::Block;
use crate::text::codes::spelled;
use crate::text::diagnostic::LineFault;
use crate::text::source::Mark;

/// Motions of a profile: they are kept in memory, and a drawing has far fewer.
const MAX_MOTIONS: usize = 100_000;

/// Operation of a cycle on its profile, mm.
#[derive(Debug, Clone, Copy)]
pub(crate) enum ProfileWork {
    /// G70.
    Finish,
    /// G71, G72: passes of a depth; the allowance along X (radius) and Z moves the profile.
    Rough {
        is_facing: bool,
        depth_mm: f64,
        escape_mm: f64,
        allowance_mm: [f64; 2],
    },
    /// G73: the profile itself, moved.
    Pattern {
        shift_mm: [f64; 2],
        passes: u32,
        allowance_mm: [f64; 2],
    },
}

/// A cycle that asks for its profile.
#[derive(Debug)]
pub(crate) struct ProfileBlocks {
    /// First and last block.
    pub(crate) numbers: [u64; 2],
    pub(crate) work: ProfileWork,
    pub(crate) code: u16,
    pub(crate) block: Block,
    pub(crate) line: u32,
    /// Start of the cycle in machine coordinates, and its modes.
    pub(crate) start: Position,
    pub(crate) modal: Modal,
}

/// The profile under way.
#[derive(Debug)]
pub(crate) struct Capture {
    pub(crate) wanted: ProfileBlocks,
    pub(crate) motions: Vec<Motion>,
    /// Words of the first block: X and Z both let the profile have pockets.
    pub(crate) first_words: u32,
    /// Line of the cycle, and where the program goes on, if not behind the profile.
    pub(crate) mark: Mark,
    pub(crate) back: Option<Mark>,
    /// First motion that does not belong in a profile: its line and the message.
    pub(crate) fault: Option<(u32, &'static str)>,
}

impl Capture {
    pub(super) const fn keeps(&self) -> bool {
        !matches!(self.wanted.work, ProfileWork::Finish)
    }

    /// Number of the last block.
    pub(crate) const fn last(&self) -> u64 {
        self.wanted.numbers[1]
    }

    /// Takes a motion; what else the blocks say belongs to G70.
    pub(super) fn keep(&mut self, step: Canon) {
        let Canon::Motion(motion) = step else { return };
        let line = motion.line;
        let fault = match &motion {
            _ if self.motions.len() >= MAX_MOTIONS => {
                Some("the profile has more than 100000 motions")
            }
            Motion { others, .. } if !others.is_none() => Some("it moves other axes than X and Z"),
            Motion {
                start_mm, end_mm, ..
            } if start_mm[1] != end_mm[1] => Some("it moves Y; only X and Z form a profile"),
            Motion {
                shape:
                    Shape::Line
                    | Shape::Arc {
                        plane: Plane::Zx,
                        turns: 1 | -1,
                        ..
                    },
                ..
            } => None,
            _ => Some("a profile has straight lines and arcs of up to one turn in G18"),
        };
        match fault {
            Some(fault) if self.fault.is_none() => self.fault = Some((line, fault)),
            Some(_) => {}
            None => self.motions.push(motion),
        }
    }

    /// Returns the error that refuses the profile; `line` is the line of the unfit block.
    pub(crate) fn refuse(&self, line: u32, message: &str) -> Box<LineFault> {
        let place = if line == self.wanted.line {
            String::new()
        } else {
            format!("line {line}: ")
        };
        let message = format!(
            "the profile of {} cannot be cut: {place}{message}",
            spelled(self.wanted.code)
        );
        LineFault::new("gcode::lathe", self.wanted.block.at(b'p'), message)
    }
}

impl Interpreter {
    /// Keeps a step of a profile, where one is being read.
    #[cold]
    pub(super) fn keep_own(&mut self, step: Canon) {
        if let Some(capture) = &mut self.fanuc.capture {
            capture.keep(step);
        }
    }
}
