//! Feed plan: speed over arc length, and so over plan time.
//!
//! The path is cut into [`Section`]s. Within a section, the square of the speed stays below a straight line over arc
//! length (constant on lines and arcs, following `a_n / curvature` on other curves); at the joint before it, below a cap of
//! its own. A [`FeedPlanner`] turns sections into [`Span`]s of constant acceleration; [`plan::Plan`] puts them on the clock
//! as [`Phase`]s, with the events between them.
//!
//! Planners are a family: this file has the contract and the table [`MEMBERS`], each member one file.
//!
//! | File | What |
//! |---|---|
//! | `sections.rs` | a piece of the path to sections |
//! | `joint.rs` | the speed at a joint of two pieces |
//! | `trapezoid.rs` | member: constant accelerations, time-optimal |
//! | `unlimited.rs` | null member: every section at its bound |
//! | `plan.rs` | pieces, spans and events on the clock |

pub mod joint;
pub mod plan;
pub mod sections;
pub mod trapezoid;
pub mod unlimited;

use crate::gcode::canon::Event;
use crate::machine;

/// What bounds the speed, the same in all directions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Speed of rapids.
    pub rapid_mm_s: f64,
    /// Programmed feedrates above this are lowered to it.
    pub max_feed_mm_s: f64,
    /// Acceleration along the path.
    pub tangential_accel_mm_s2: f64,
    /// Acceleration across the path, v^2 times curvature.
    pub normal_accel_mm_s2: f64,
    /// Length of the jump of the velocity vector allowed at a corner in continuous mode (G64); 0 stops at each corner.
    pub corner_jump_mm_s: f64,
}

/// A limit that is none.
#[derive(Debug, Clone, PartialEq, thiserror::Error, miette::Diagnostic)]
#[error("limit {name} is {value}, it must be a finite number {bound}")]
pub struct LimitsError {
    /// Name of the limit, with its unit.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// What it must be.
    pub bound: &'static str,
}

impl From<&machine::Limits> for Limits {
    fn from(limits: &machine::Limits) -> Self {
        Self {
            rapid_mm_s: limits.rapid_mm_s,
            max_feed_mm_s: limits.max_feed_mm_s,
            tangential_accel_mm_s2: limits.tangential_accel_mm_s2,
            normal_accel_mm_s2: limits.normal_accel_mm_s2,
            corner_jump_mm_s: limits.corner_jump_mm_s,
        }
    }
}

impl Limits {
    /// Checks that every limit is finite and of use.
    ///
    /// # Errors
    /// The first limit that is not.
    pub fn check(&self) -> Result<(), LimitsError> {
        let positive = [
            ("rapid_mm_s", self.rapid_mm_s),
            ("max_feed_mm_s", self.max_feed_mm_s),
            ("tangential_accel_mm_s2", self.tangential_accel_mm_s2),
            ("normal_accel_mm_s2", self.normal_accel_mm_s2),
        ];
        // From 1e-6 to 1e9 nothing under- or overflows, and no machine lies outside.
        for (name, value) in positive {
            if !(1e-6..=1e9).contains(&value) {
                return Err(LimitsError { name, value, bound: "from 1e-6 to 1e9" });
            }
        }
        if !(0.0..=1e9).contains(&self.corner_jump_mm_s) {
            let value = self.corner_jump_mm_s;
            return Err(LimitsError { name: "corner_jump_mm_s", value, bound: "from 0 to 1e9" });
        }
        Ok(())
    }
}

/// Part of a piece with a bound on the speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Number of the piece, from 0.
    pub piece: u64,
    /// Where it starts in the piece, mm.
    pub from_mm: f64,
    /// How long it is, mm, more than 0.
    pub length_mm: f64,
    /// Bound on the square of the speed at the joint before it, mm2/s2.
    pub joint_cap: f64,
    /// Bound on the square of the speed just after its start, mm2/s2, more than 0; straight over arc length to
    pub start_cap: f64,
    /// the bound just before its end.
    pub end_cap: f64,
}

/// Motion at constant acceleration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Number of the section, counted from 0 in the order in which they were pushed.
    pub section: u64,
    /// Number of the piece.
    pub piece: u64,
    /// Where it starts in the piece, mm.
    pub from_mm: f64,
    /// How long it takes, s.
    pub duration_s: f64,
    /// Speed at its start.
    pub speed_mm_s: f64,
    /// Acceleration.
    pub accel_mm_s2: f64,
}

/// A span on the clock, or a rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Plan time at its start, s.
    pub tau_s: f64,
    /// How long it takes, s.
    pub duration_s: f64,
    /// Number of the piece.
    pub piece: u64,
    /// Where it starts in the piece, mm.
    pub from_mm: f64,
    /// Speed at its start.
    pub speed_mm_s: f64,
    /// Acceleration.
    pub accel_mm_s2: f64,
    /// Line of the event that makes the tool rest; `None` when it moves.
    pub rest: Option<u32>,
}

/// An event with the plan time at which it happens.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedEvent {
    /// Plan time, s.
    pub tau_s: f64,
    /// How long the tool rests for it, s.
    pub duration_s: f64,
    /// What happens.
    pub event: Event,
}

/// Plans speeds over sections: from rest before the first to rest after the last, with bounded look-ahead.
///
/// Spans come out as soon as no later section can change them, in order, without gaps; they are the same however the calls
/// of `pop` are spread over the calls of `push`.
pub trait FeedPlanner: Send {
    /// Adds a section behind those before.
    fn push(&mut self, section: Section);

    /// There are no more sections: the motion ends at rest.
    fn finish(&mut self);

    /// Takes the next span that is final.
    fn pop(&mut self) -> Option<Span>;
}

/// A row of [`MEMBERS`].
#[derive(Debug, Clone, Copy)]
pub struct Member {
    /// Name.
    pub name: &'static str,
    /// What it does, for lists.
    pub about: &'static str,
    /// Makes one for limits that have been checked.
    pub make: fn(&Limits) -> Box<dyn FeedPlanner>,
}

/// All planners; the first is the one to take when nobody chooses.
pub const MEMBERS: &[Member] = &[
    Member {
        name: "trapezoid",
        about: "constant tangential acceleration, time-optimal",
        make: |limits| Box::new(trapezoid::Trapezoid::new(limits.tangential_accel_mm_s2)),
    },
    Member {
        name: "unlimited",
        about: "no bound on tangential acceleration: the least time that any plan can take",
        make: |_| Box::new(unlimited::Unlimited::default()),
    },
];

/// The planner of that name.
pub fn planner(name: &str) -> Option<&'static Member> {
    MEMBERS.iter().find(|member| member.name == name)
}
