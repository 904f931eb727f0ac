//! What Fanuc and Haas keep from line to line.

use std::collections::HashMap;

use crate::geometry::plane::PlaneArc;
use crate::state::capture::{Capture, ProfileBlocks};
use crate::state::carried_over::Pecks;
use crate::state::frame::Position;
use crate::text::block::Block;
use crate::text::block::corner::CornerWord;

/// Words behind which the control puts its own values where a program has none.
#[derive(Debug, Default)]
pub(crate) struct Fanuc {
    /// S of G50 or G92: bound of the spindle speed, rev/min.
    pub(crate) highest_rpm: Option<f64>,
    /// S of the last G96.
    pub(crate) surface_speed: Option<f64>,
    pub(crate) turning: TurningWords,
    pub(crate) repetitive: RepetitiveWords,
    /// The profile that is being read, and the one that a block asks for.
    pub(crate) capture: Option<Box<Capture>>,
    pub(crate) wanted: Option<Box<ProfileBlocks>>,
    /// Pecks of the hole under way, where they grow smaller.
    pub(crate) pecks: Option<Pecks>,
    /// The motion that waits for the block behind its corner, and where that block leads.
    pub(crate) pending: Option<Box<Pending>>,
    pub(crate) resolved: Option<Goal>,
    /// G16: X is a radius and Y an angle.
    pub(crate) is_polar: bool,
    /// Offsets of the systems of G54.1 P and G154 P.
    pub(super) systems: HashMap<usize, Position>,
    pub(crate) points: Points,
    /// Number N of the line under way.
    pub(crate) block_number: u64,
    /// Codes of the warnings that were already given.
    pub(super) warned: Vec<&'static str>,
}

/// Words of the last G90, G92 or G94 of a lathe, by axis: a place, or a distance from where the
/// cycle begins, mm.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct TurningWords {
    pub(crate) code: u16,
    pub(crate) place_mm: [Option<f64>; 3],
    pub(crate) step_mm: [Option<f64>; 3],
    pub(crate) taper_mm: f64,
}

/// Words of the first blocks of G70 to G76, mm.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct RepetitiveWords {
    /// Depth of a pass of G71 and of G72.
    pub(crate) depth_mm: [Option<f64>; 2],
    /// Distance that a pass of G71, G72 retracts before it returns.
    pub(crate) escape_mm: Option<f64>,
    /// Values of G73: distance from the first pass to the last along X (radius) and Z, and number
    /// of passes.
    pub(crate) pattern: Option<([f64; 2], u32)>,
    /// Retraction of a peck of G74, G75.
    pub(crate) back_mm: f64,
    pub(crate) thread: Option<ThreadingWords>,
}

/// Values of the first block of G76.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ThreadingWords {
    pub(crate) finishing: u32,
    /// Length of the run-out, in leads.
    pub(crate) run_out: f64,
    pub(crate) angle_deg: f64,
    pub(crate) least_mm: f64,
    pub(crate) allowance_mm: f64,
}

/// A motion whose end is not known yet.
#[derive(Debug)]
pub(crate) struct Pending {
    pub(crate) block: Block,
    /// Target of the motion without its corner, and its circle.
    pub(crate) goal: Goal,
    pub(crate) corner: CornerWord,
    pub(crate) line: u32,
    pub(crate) feed: (f64, f64),
}

/// Target of a motion, in program coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Goal {
    pub(crate) target: Position,
    pub(crate) round: Option<PlaneArc>,
}

/// Count of the lengths without a decimal point in a program, and whether any length has one.
#[derive(Debug, Default)]
pub(crate) struct Points {
    pub(crate) has_point: bool,
    pub(crate) count: u64,
    /// Line, word and value in mm of the first.
    pub(crate) first: Option<(u32, String, f64)>,
}
