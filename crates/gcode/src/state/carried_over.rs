//! What motions leave to be known by the lines behind them.

use crate::canon::Canon;
use crate::geometry::plane::{PlaneCurve, PlanePoint};
use crate::state::frame::Position;

/// State that earlier lines pass on to later ones.
#[derive(Debug, Default)]
pub(crate) struct CarriedOver {
    /// Cutter compensation, if it is on.
    pub(crate) compensation: Option<Compensation>,
    /// Cutter compensation has ended and nothing has moved since.
    pub(crate) left_compensation: bool,
    /// Steps that wait until compensation knows where the first of them ends.
    pub(crate) held: Vec<Canon>,
    /// State of the canned cycles from line to line.
    pub(crate) cycle: Cycle,
    /// The NURBS that is being collected.
    pub(crate) collected: Option<Collected>,
    /// P and Q of the last G5, if the line before was one.
    pub(crate) bezier_end: Option<[f64; 2]>,
}

/// Compensation under way.
#[derive(Debug, Clone)]
pub(crate) struct Compensation {
    /// 1 left, -1 right.
    pub(crate) side: f64,
    pub(crate) radius_mm: f64,
    /// The offset curve of the last motion in the plane, and its direction at its end; none before
    /// the entry.
    pub(crate) last: Option<(PlaneCurve, PlanePoint)>,
}

/// A length of a cycle, in mm and as it was written.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct CycleLength {
    pub(crate) mm: f64,
    pub(crate) written: f64,
    /// Unit of `written`, mm.
    pub(crate) unit_mm: f64,
}

impl CycleLength {
    /// Returns the length in this unit. If it was written in this unit, returns the written number,
    /// because a conversion through mm would round it.
    pub(crate) fn in_unit(self, unit_mm: f64) -> f64 {
        if unit_mm == self.unit_mm {
            self.written
        } else {
            self.mm / unit_mm
        }
    }
}

/// Values that a canned cycle keeps for the next line, mm and seconds.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Cycle {
    /// The code; 0 before the first.
    pub(crate) code: u16,
    pub(crate) bottom: CycleLength,
    pub(crate) clearance: CycleLength,
    pub(crate) peck: Option<CycleLength>,
    pub(crate) dwell_s: Option<f64>,
    /// Height at which the series of cycles began (G98).
    pub(crate) began_at: f64,
}

impl Cycle {
    /// The code of the series; 0 where none is under way.
    pub(crate) const fn code(&self) -> u16 {
        self.code
    }
}

/// Pecks of G83 with I, J and K, mm: the first, how much smaller each is than the one before, the
/// smallest.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Pecks {
    pub(crate) first_mm: f64,
    pub(crate) less_mm: f64,
    pub(crate) least_mm: f64,
}

/// A NURBS whose points are still being collected, in machine coordinates.
#[derive(Debug)]
pub(crate) struct Collected {
    pub(crate) code: u16,
    pub(crate) order: usize,
    /// Start point, in program coordinates.
    pub(crate) start: Position,
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) weights: Vec<f64>,
    /// G6.2 only.
    pub(crate) knots: Vec<f64>,
}
