//! TODO front page

pub mod vector;
mod plc;
mod constraints;
mod path;
mod blend;
mod feed;

pub use blend::aligned::AlignedPaths;
pub use blend::{BLENDS, BlendMember, BlendedStep, BlendedSteps, PlannedPiece, ProgrammedPart};
pub use constraints::speed_caps::SpeedCaps;
pub use constraints::{AxisLimits, Constraints, LimitsError, PathLimits};
pub use feed::plan::{Plan, PlanSink, Planned};
pub use feed::sections::{Section, SectionPlanner};
pub use feed::time_optimal::{PlanCounts, TimeOptimal};
pub use feed::time_scaling::{
    MOST_OVERRIDE, PublishedPlan, PublishedSpan, ScaledStep, ScalingLimits, TimeScaling, shortest_stop_mm,
};
pub use feed::trapezoid::Trapezoid;
pub use feed::unlimited::Unlimited;
pub use feed::{
    AxisMotion, FEED_PLANNERS, FeedMember, FeedPlanner, Phase, Span, TimedEvent, WHOLE_PROGRAM, feed_mm_s, feed_planner,
};
pub use path::arc::Arc;
pub use path::pieces::{ArcLength, Pieces};
pub use path::smooth::{Jet, Parametric, Smooth};
pub use path::{Curve, MIN_FEED_MM_S, PathError, Piece, Point, Rest, Step, Steps, signed_distance_mm};
pub use plc::{Durations, EventName, Plc, PlcEvent, named};
