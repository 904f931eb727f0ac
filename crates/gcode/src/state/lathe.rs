//! The profile of a lathe cycle of LinuxCNC while its subroutine is read: its motions are kept
//! instead of handed out.

use crate::canon::{Canon, Motion, Plane, Shape};
use crate::state::Interpreter;
use crate::state::frame::{Frame, Position};
use crate::state::modal::FeedMode;
use crate::text::block::Block;
use crate::text::source::Mark;

/// Motions of a profile, and of all passes along it: they are kept in memory, and a drawing has far
/// fewer.
pub(crate) const MAX_MOTIONS: usize = 100_000;

pub(crate) const CHANGED: &str = "it changes the unit, the plane, offsets, G90 or G91, G7 or G8, G90.1, cutter compensation or the mode of F";

/// Operation that the words of the cycle request, mm.
#[derive(Debug, Clone, Copy)]
pub(crate) enum LatheWork {
    /// G70: passes from one distance off the profile to another.
    Finish {
        first_mm: f64,
        last_mm: f64,
        passes: u32,
    },
    /// G71, G72: passes of a depth, and what is left on the profile.
    Rough {
        depth_mm: f64,
        retraction_mm: f64,
        left_mm: f64,
    },
}

/// A cycle whose profile is being read.
#[derive(Debug)]
pub(crate) struct LatheCycle {
    pub(crate) code: u16,
    pub(crate) block: Block,
    /// Line of the cycle, its place, and the depth of calls it stands at.
    pub(crate) line: u32,
    pub(crate) mark: Mark,
    pub(crate) level: usize,
    /// Start of the cycle in machine coordinates.
    pub(crate) start: Position,
    pub(crate) feed: (f64, f64),
    pub(crate) modes: ProfileModes,
    pub(crate) work: LatheWork,
    pub(crate) motions: Vec<Motion>,
    /// Corner words, each with the number of the motion before the corner.
    pub(crate) corners: Vec<(usize, CornerCut)>,
    /// The corner word of the block under way.
    pub(crate) corner: Option<CornerCut>,
    /// First line that does not belong in a profile, and the message.
    pub(crate) fault: Option<(u32, String)>,
}

/// Modes that give the words of a profile their meaning. LinuxCNC passes over codes in a profile
/// that change them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ProfileModes {
    pub(super) plane: Plane,
    pub(super) unit_mm: f64,
    pub(super) incremental: bool,
    pub(super) arc_absolute: bool,
    pub(super) diameter: bool,
    pub(super) feed_mode: FeedMode,
    pub(super) compensates: bool,
    pub(super) frame: Frame,
}

/// Label and place of the subroutine that a lathe cycle asks for.
#[derive(Debug)]
pub(crate) struct ProfileCall {
    pub(crate) label: Vec<u8>,
    pub(crate) at: std::ops::Range<usize>,
}

/// A corner word.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CornerCut {
    pub(crate) radius_mm: f64,
    /// A, not C.
    pub(crate) is_round: bool,
}

impl Interpreter {
    pub(crate) fn lathe_modes(&self) -> ProfileModes {
        ProfileModes {
            plane: self.modal.plane,
            unit_mm: self.modal.unit_mm,
            incremental: self.modal.incremental,
            arc_absolute: self.modal.arc_absolute,
            diameter: self.modal.diameter,
            feed_mode: self.modal.feed_mode,
            compensates: self.compensates(),
            frame: self.frame.clone(),
        }
    }

    /// Keeps a step of the profile.
    #[cold]
    pub(super) fn keep(&mut self, step: Canon) {
        let modes = self.lathe_modes();
        let Some(lathe) = &mut self.lathe else { return };
        if lathe.fault.is_some() {
            return;
        }
        let fault = match &step {
            Canon::Motion(_) if modes != lathe.modes => Some(CHANGED.to_owned()),
            Canon::Event(_) => Some("only motions belong in a profile".to_owned()),
            Canon::Motion(motion) if !motion.others.is_none() => {
                Some("the profile moves other axes than X and Z".to_owned())
            }
            Canon::Motion(motion) if motion.start_mm[1] != motion.end_mm[1] => {
                Some("the profile moves Y; only X and Z form a profile".to_owned())
            }
            Canon::Motion(Motion {
                shape:
                    Shape::Arc {
                        plane: Plane::Zx,
                        turns: 1 | -1,
                        ..
                    }
                    | Shape::Line,
                ..
            }) => None,
            Canon::Motion(_) => {
                Some("a profile has straight lines and arcs of up to one turn in G18".to_owned())
            }
        };
        match (fault, step) {
            (Some(fault), _) => lathe.fault = Some((self.line, fault)),
            (None, Canon::Motion(_)) if lathe.motions.len() >= MAX_MOTIONS => {
                lathe.fault = Some((
                    self.line,
                    format!("the profile has more than {MAX_MOTIONS} motions"),
                ));
            }
            (None, Canon::Motion(motion)) => {
                lathe.corners.extend(
                    lathe
                        .corner
                        .take()
                        .map(|corner| (lathe.motions.len(), corner)),
                );
                lathe.motions.push(motion);
            }
            (None, Canon::Event(_)) => {}
        }
    }
}
