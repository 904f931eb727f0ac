//! Reference: the point of the planned path at each plan time, and the point of the programmed path
//! nearest to a given point.
//!
//! Plan time `tau` runs in seconds from 0 at the start of the program. [`Reference`] reads as much
//! of the program as it is asked for, keeps what has not been forgotten, and looks up.
//!
//! | File | What |
//! |---|---|
//! | `reference/kept.rs` | pieces and phases that are kept, and looking them up by time and arc length |
//! | `reference/nearest.rs` | nearest point over several pieces |

mod nearest;
mod kept;

use feedwright_gcode::canon::Canon;
use feedwright_plan::vector::sub;
use feedwright_plan::{
    Constraints, FEED_PLANNERS, KeptPlan, LimitsError, PathError, Phase, Piece, Pieces, Plan,
    Planned, Plc, Step, Steps, TimedEvent, signed_distance_mm,
};
use kept::KeptPath;
use std::collections::VecDeque;

/// State of the reference at a plan time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Point of the planned path, mm.
    pub position_mm: [f64; 3],
    /// Unit tangent of the planned path. At rest it is the tangent of the motion before, at the
    /// start the tangent of the first motion.
    pub tangent: [f64; 3],
    /// Arc length of the programmed path from its start, mm.
    pub s_mm: f64,
    /// Point of the programmed path there, mm.
    pub programmed_mm: [f64; 3],
    /// Planned feedrate, mm/s.
    pub feed_mm_s: f64,
    /// Line of the program that is under way; in a dwell, the dwell's.
    pub line: u32,
    /// True for a motion that cuts; rapids, dwells and rests do not.
    pub cutting: bool,
    /// True for a rapid. In a dwell or after the end, the value of the motion before.
    pub rapid: bool,
    /// True in a dwell or after the end.
    pub resting: bool,
}

/// A point of the programmed path nearest to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Foot {
    /// Arc length from the start of the path, mm.
    pub s_mm: f64,
    /// The point, mm.
    pub position_mm: [f64; 3],
    /// Unit tangent there.
    pub tangent: [f64; 3],
    /// Line of the program.
    pub line: u32,
    /// Distance, mm.
    pub distance_mm: f64,
    /// [Distance with a sign](signed_distance_mm): positive where the other point lies left of
    /// travel in the XY plane.
    pub signed_mm: f64,
    /// True if the motion cuts.
    pub cutting: bool,
    /// Programmed feedrate, mm/s; of a rapid 0.
    pub(crate) programmed_mm_s: f64,
}

/// The plan of a program, looked up by plan time.
///
/// Everything that is looked up depends on the program, the limits and the arguments only, not on
/// earlier calls, as long as it has not been forgotten. Without [`Reference::forget_before`], what
/// has been read stays in memory.
pub struct Reference<'p> {
    plan: Plan<'p>,
    kept: KeptPath,
    events: VecDeque<TimedEvent>,
    /// Plan time up to which all phases are in the window, s.
    planned_s: f64,
    ended: bool,
}

impl<'p> Reference<'p> {
    /// The reference of a plan.
    pub fn new(plan: Plan<'p>) -> Self {
        Self {
            plan,
            kept: KeptPath::default(),
            events: VecDeque::new(),
            planned_s: 0.0,
            ended: false,
        }
    }

    /// All of the plan, where it was [kept](Plan::keeping) and read to its end.
    pub(crate) fn into_kept(self) -> Option<KeptPlan> {
        self.plan.into_kept()
    }

    /// Reference of a program, without a PLC, by the first of [`FEED_PLANNERS`].
    ///
    /// # Errors
    /// Fails if a limit is outside its allowed range. An error in the program does not fail here:
    /// it ends the path early, see [`Reference::fault`].
    pub fn of_program(
        source: impl IntoIterator<Item = Canon, IntoIter: Send + 'p>,
        constraints: impl Into<Constraints>,
    ) -> Result<Self, LimitsError> {
        Self::planned(
            Box::new(Pieces::new(source.into_iter())),
            &constraints.into(),
        )
    }

    /// Returns the reference of a path that is given as steps; otherwise as
    /// [`Reference::of_program`].
    ///
    /// # Errors
    /// Fails if a limit is outside its allowed range.
    pub fn of_steps(
        steps: impl IntoIterator<Item = Step, IntoIter: Send + 'p>,
        constraints: impl Into<Constraints>,
    ) -> Result<Self, LimitsError> {
        Self::planned(Box::new(steps.into_iter().map(Ok)), &constraints.into())
    }

    fn planned(steps: Steps<'p>, constraints: &Constraints) -> Result<Self, LimitsError> {
        Ok(Self::new(Plan::new(
            steps,
            constraints,
            &FEED_PLANNERS[0],
            Plc::default(),
        )?))
    }

    /// Returns the reference at `tau_s`. Before the start (or before the part that is still kept)
    /// it returns the first point, after the end the last one.
    #[inline]
    pub fn at(&mut self, tau_s: f64) -> Sample {
        self.read_until(tau_s);
        self.kept.at(tau_s)
    }

    /// The point of the path nearest to `point_mm` among those that the reference passes from
    /// `tau_lo_s` to `tau_hi_s`.
    #[inline]
    pub fn nearest(&mut self, point_mm: [f64; 3], tau_lo_s: f64, tau_hi_s: f64) -> Foot {
        self.read_until(tau_hi_s);
        self.kept
            .nearest(point_mm, tau_lo_s, tau_hi_s.max(tau_lo_s))
    }

    /// The point of the path at arc length `s_mm`, seen from `point_mm`; of what has been read and
    /// not forgotten.
    #[inline]
    pub(crate) fn at_length(&self, point_mm: [f64; 3], s_mm: f64) -> Foot {
        self.kept.nearest_along(point_mm, s_mm, s_mm)
    }

    /// The point of the path nearest to `point_mm` between two arc lengths; of what has been read
    /// and not forgotten.
    #[inline]
    pub fn nearest_along(&self, point_mm: [f64; 3], lo_mm: f64, hi_mm: f64) -> Foot {
        self.kept.nearest_along(point_mm, lo_mm, hi_mm.max(lo_mm))
    }

    /// Start and end of the rest at `tau_s`, in plan time, s: a dwell, or the time that a PLC
    /// takes. `None` if `tau_s` is not in a rest.
    pub(crate) fn rest(&mut self, tau_s: f64) -> Option<(f64, f64)> {
        self.read_until(tau_s);
        self.kept.rest(tau_s)
    }

    /// Total plan time, s, once the end of the program has been read.
    pub fn end_s(&self) -> Option<f64> {
        self.ended.then_some(self.planned_s)
    }

    /// Reads the whole program and returns its plan time, s. What is read stays in memory: not for
    /// endless programs.
    pub fn read_to_end_s(&mut self) -> f64 {
        self.read_until(f64::INFINITY);
        self.planned_s
    }

    /// Why the path ends before the program does, once the end of the path has been read.
    pub const fn fault(&self) -> Option<&PathError> {
        self.plan.fault()
    }

    /// Takes the next event that happens at `until_s` or before, in order.
    pub fn next_event(&mut self, until_s: f64) -> Option<TimedEvent> {
        self.read_until(until_s);
        if self.events.front()?.tau_s <= until_s {
            self.events.pop_front()
        } else {
            None
        }
    }

    /// Drops what ends before `tau_s`: pieces, phases, and events that were not taken.
    pub fn forget_before(&mut self, tau_s: f64) {
        self.kept.forget_before(tau_s);
        while self.events.front().is_some_and(|event| event.tau_s < tau_s) {
            self.events.pop_front();
        }
    }

    /// Number of planned pieces and phases in memory.
    pub fn kept(&self) -> (usize, usize) {
        self.kept.kept()
    }

    /// Reads until all phases up to `tau_s` are known, and at least the first: what comes before
    /// the start, NaN too, looks at that one.
    #[inline]
    fn read_until(&mut self, tau_s: f64) {
        let tau_s = tau_s.max(0.0);
        if self.planned_s <= tau_s && !self.ended {
            self.read_on(tau_s);
        }
    }

    #[cold]
    fn read_on(&mut self, tau_s: f64) {
        while self.planned_s <= tau_s && !self.ended {
            match self.plan.next() {
                Some(Planned::Programmed(piece)) => self.kept.push_programmed(piece),
                Some(Planned::Piece(piece)) => self.kept.push_planned(piece),
                Some(Planned::Phase(phase)) => self.push_phase(phase),
                Some(Planned::Event(event)) => self.events.push_back(event),
                None => self.ended = true,
            }
        }
    }

    fn push_phase(&mut self, phase: Phase) {
        self.planned_s = phase.tau_s + phase.duration_s;
        self.kept.push_phase(phase);
    }
}

#[inline]
fn foot(piece: &Piece, local_mm: f64, point_mm: [f64; 3]) -> Foot {
    let at = piece.curve.at(local_mm);
    let signed_mm = signed_distance_mm(at.tangent, sub(point_mm, at.position_mm));
    Foot {
        s_mm: piece.s_mm + local_mm,
        position_mm: at.position_mm,
        tangent: at.tangent,
        line: piece.line,
        distance_mm: signed_mm.abs(),
        signed_mm,
        cutting: piece.cutting,
        programmed_mm_s: if piece.cutting { piece.feed_mm_s } else { 0.0 },
    }
}
