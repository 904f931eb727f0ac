//! Feed plan: speed over the arc length of the planned path, and so over plan time.
//!
//! A [`FeedPlanner`] is given the planned path piece by piece: curves with their derivatives by arc
//! length ([`Curve::derivatives`](crate::path::Curve::derivatives)), programmed feedrates and
//! corners, under the [`Constraints`] of the machine, those of the path and those of each axis. It
//! answers with [`Span`]s of constant jerk; [`plan::Plan`] puts them on the clock as [`Phase`]s,
//! with the events between them.
//!
//! Planners are a family: this file has the contract and the table [`FEED_PLANNERS`], each member
//! one file. Those that need no more than a bound on the square of the speed take the path as
//! [`sections::Section`]s. Those that choose the path too, within its tolerance, say with each span
//! what the axes do ([`AxisMotion`]).
//!
//! | File | What |
//! |---|---|
//! | `corner_speed.rs` | the speed at a joint of two pieces |
//! | `sections.rs` | the path to sections with a bound on the square of the speed |
//! | `trapezoid.rs` | member: constant accelerations, time-optimal |
//! | `unlimited.rs` | null member: every section at its bound |
//! | `time_optimal.rs` | member: speed and path within the tolerance, axis by axis, with jerk |
//! | `linuxcnc.rs` | member: what LinuxCNC's own planner makes of the path |
//! | `feed_override.rs` | feed override and feed hold on a published plan |
//! | `plan.rs` | pieces, spans and events on the clock |

pub(crate) mod corner_speed;
pub(crate) mod plan;
pub(crate) mod sections;
pub(crate) mod trapezoid;
pub(crate) mod unlimited;
pub(crate) mod time_optimal;
pub(crate) mod linuxcnc;
pub(crate) mod feed_override;
use feedwright_gcode::canon::Event;

use crate::constraints::{Constraints, PathLimits};
use crate::path::Piece;
use sections::Capped;

/// Motion of the axes from a moment on, at a constant jerk of each.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisMotion {
    /// Position at its start, mm.
    pub position_mm: [f64; 3],
    /// Velocity at its start.
    pub velocity_mm_s: [f64; 3],
    /// Acceleration at its start.
    pub accel_mm_s2: [f64; 3],
    /// Jerk.
    pub jerk_mm_s3: [f64; 3],
}

impl AxisMotion {
    /// Rest at the origin.
    pub const REST: Self = Self {
        position_mm: [0.0; 3],
        velocity_mm_s: [0.0; 3],
        accel_mm_s2: [0.0; 3],
        jerk_mm_s3: [0.0; 3],
    };

    /// The same motion from `t` seconds later on.
    #[inline]
    pub fn after(&self, t: f64) -> Self {
        let Self {
            position_mm: p,
            velocity_mm_s: v,
            accel_mm_s2: a,
            jerk_mm_s3: j,
        } = self;
        Self {
            position_mm: std::array::from_fn(|k| {
                p[k] + t * (v[k] + t * (0.5 * a[k] + t * j[k] / 6.0))
            }),
            velocity_mm_s: std::array::from_fn(|k| v[k] + t * (a[k] + 0.5 * t * j[k])),
            accel_mm_s2: std::array::from_fn(|k| a[k] + t * j[k]),
            jerk_mm_s3: *j,
        }
    }
}

/// Motion at constant jerk along a piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Number of the piece, from 0.
    pub piece: u64,
    /// Start in the piece, mm.
    pub from_mm: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// Speed at its start.
    pub speed_mm_s: f64,
    /// Acceleration at its start.
    pub accel_mm_s2: f64,
    /// Jerk.
    pub jerk_mm_s3: f64,
    /// Motion of the axes where it leaves the piece within its tolerance. The values above then
    /// give the place of the piece that stands for each moment.
    pub motion: Option<AxisMotion>,
}

/// A span on the clock, or a rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Phase {
    /// Plan time at its start, s.
    pub tau_s: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// Number of the piece.
    pub piece: u64,
    /// Start in the piece, mm.
    pub from_mm: f64,
    /// Speed at its start.
    pub speed_mm_s: f64,
    /// Acceleration at its start.
    pub accel_mm_s2: f64,
    /// Jerk.
    pub jerk_mm_s3: f64,
    /// Motion of the axes, where it differs from the piece.
    pub motion: Option<AxisMotion>,
    /// Line of the event that makes the tool rest; `None` when it moves.
    pub rest: Option<u32>,
}

impl Phase {
    /// Place in the piece after `along_s` of the phase, mm: `s + v t + a t^2 / 2 + j t^3 / 6`.
    #[inline]
    pub fn place_mm(&self, along_s: f64) -> f64 {
        let bend = 0.5 * self.accel_mm_s2 + self.jerk_mm_s3 / 6.0 * along_s;
        self.from_mm + along_s * (self.speed_mm_s + along_s * bend)
    }

    /// Speed after `along_s` of the phase: `v + a t + j t^2 / 2`; rounding does not take it below
    /// zero.
    #[inline]
    pub fn speed_mm_s(&self, along_s: f64) -> f64 {
        (self.speed_mm_s + along_s * (self.accel_mm_s2 + 0.5 * self.jerk_mm_s3 * along_s)).max(0.0)
    }
}

/// An event with the plan time at which it happens.
#[derive(Debug, Clone, PartialEq)]
pub struct TimedEvent {
    /// Plan time, s.
    pub tau_s: f64,
    /// Time that the tool rests for the event, s.
    pub duration_s: f64,
    /// The event.
    pub event: Event,
}

/// Plans speeds over the pieces of a path: from rest before the first to rest after the last, with
/// bounded look-ahead.
///
/// Spans come out as soon as no later piece can change them, in order, without gaps; they are the
/// same however the calls of `pop` are spread over the calls of `push`.
pub trait FeedPlanner: Send {
    /// Adds a piece behind those before; where it starts `from_rest`, so does the motion.
    fn push(&mut self, piece: &Piece, from_rest: bool);

    /// Ends the path: no more pieces follow, and the motion ends at rest.
    fn finish(&mut self);

    /// Takes the next span that is final.
    fn pop(&mut self) -> Option<Span>;
}

/// Highest speed on a piece before its curvature limits it, mm/s.
///
/// A cutting piece has its programmed feedrate, capped at the machine's largest feedrate. A rapid
/// has the rapid speed. The axes that move along may lower both.
pub fn feed_mm_s(piece: &Piece, constraints: &Constraints) -> f64 {
    let PathLimits {
        max_feed_mm_s,
        rapid_mm_s,
        ..
    } = constraints.path;
    let feed_mm_s = if piece.cutting {
        piece.feed_mm_s.min(max_feed_mm_s)
    } else {
        rapid_mm_s
    };
    feed_mm_s.min(constraints.along_mm_s(piece.turn_deg_mm, piece.further_mm_mm))
}

/// A row of [`FEED_PLANNERS`].
#[derive(Debug, Clone, Copy)]
pub struct FeedMember {
    /// Name.
    pub name: &'static str,
    /// One-line description, for lists.
    pub about: &'static str,
    /// True where the planner needs velocity, acceleration and jerk of each axis. Otherwise it
    /// keeps the bounds along and across the path.
    pub needs_axes: bool,
    /// True where the planner keeps the jerk of each axis.
    pub limits_jerk: bool,
    /// Makes one for constraints that have been checked.
    pub make: fn(&Constraints) -> Box<dyn FeedPlanner>,
}

/// All feed planners; the first is the default.
pub const FEED_PLANNERS: &[FeedMember] = &[
    FeedMember {
        name: "trapezoid",
        about: "constant tangential acceleration, time-optimal",
        needs_axes: false,
        limits_jerk: false,
        make: |constraints| {
            let planner = trapezoid::Trapezoid::new(constraints.path.tangential_accel_mm_s2);
            Box::new(Capped::new(constraints, planner))
        },
    },
    FeedMember {
        name: "unlimited",
        about: "no bound on tangential acceleration: the least time that any plan can take",
        needs_axes: false,
        limits_jerk: false,
        make: |constraints| Box::new(Capped::new(constraints, unlimited::Unlimited::default())),
    },
    FeedMember {
        name: "time-optimal",
        about: "speed and path within the tolerance in least time, with velocity, acceleration and jerk of each axis",
        needs_axes: true,
        limits_jerk: true,
        make: |constraints| Box::new(time_optimal::TimeOptimal::new(constraints)),
    },
    FeedMember {
        name: "linuxcnc",
        about: "as LinuxCNC 2.9 plans: velocity and acceleration of each axis without a bound on jerk, its blends of G64",
        needs_axes: true,
        limits_jerk: false,
        make: |constraints| Box::new(linuxcnc::Linuxcnc::new(constraints)),
    },
];

/// The bound that `time-optimal` is measured by: each path from rest to rest as a whole, with the
/// tolerance held at nodes only. Memory grows with the program, so it is no member.
pub const WHOLE_PROGRAM: FeedMember = FeedMember {
    name: "whole",
    about: "time-optimal, each path from rest to rest as a whole",
    needs_axes: true,
    limits_jerk: true,
    make: |constraints| Box::new(time_optimal::TimeOptimal::whole(constraints)),
};

/// The planner of that name.
pub fn feed_planner(name: &str) -> Option<&'static FeedMember> {
    FEED_PLANNERS.iter().find(|member| member.name == name)
}
