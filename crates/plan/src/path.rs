//! Path: exact curves by arc length.
//!
//! A motion of the program becomes one or more [`Piece`]s, each an exact [`Curve`] over its own arc
//! length `s` in mm, from 0 to its length. No curve is replaced by chords: positions, tangents and
//! curvatures are those of the programmed curve, and the nearest point is exact to 1e-9 mm.
//!
//! | File | What |
//! |---|---|
//! | `line.rs` | straight line |
//! | `arc.rs` | circular arc and helix |
//! | `smooth.rs` | any smooth parametric curve, by a table of arc length |
//! | `spline.rs` | rational B-spline, as smooth curves |
//! | `contour.rs` | the closed-form contours of the benchmark |
//! | `pieces.rs` | motions to pieces |
//! | `arcs.rs` | an arc motion to arcs that meet both of its ends |
//! | `arc_fit.rs` | fit of arcs and lines to points |

pub(crate) mod arc;
mod arcs;
pub(crate) mod arc_fit;
pub(crate) mod smooth;
pub(crate) mod spline;
pub(crate) mod line;
pub(crate) mod pieces;
use feedwright_gcode::canon::{Corner, Event};

use crate::vector::norm;
use arc::Arc;
use line::Line;
use smooth::Smooth;

/// Motions shorter than this vanish: 1 pm, a thousandth of what any encoder resolves; the next
/// motion starts where the last kept one ended, so that nothing is lost or shifted.
pub(crate) const MIN_LENGTH_MM: f64 = 1e-9;

/// A coordinate further out than this is refused: 1000 km, where a double still resolves 0.1 um.
pub(crate) const MAX_COORDINATE_MM: f64 = 1e9;

/// Two motions that should join may be this far apart; more is an error of whoever made the
/// motions.
pub(crate) const MAX_GAP_MM: f64 = 1e-6;

/// Feedrates below this are refused: 1 mm would take eleven days.
pub const MIN_FEED_MM_S: f64 = 1e-6;

/// The tool rests for no longer than this at a time, s: thirty years, beyond which plan time would
/// lose its milliseconds.
pub(crate) const MAX_REST_S: f64 = 1e9;

/// Signed length of `away_mm`, mm: negative if, seen along `tangent` in the XY plane, it points to
/// the right; positive otherwise.
///
/// Gives the contour error of simulation and measurement its sign. `tangent` is the tangent of the
/// path at the point nearest to the tool; `away_mm` runs from that point to the tool.
#[inline]
pub fn signed_distance_mm(tangent: [f64; 3], away_mm: [f64; 3]) -> f64 {
    let left = tangent[0] * away_mm[1] - tangent[1] * away_mm[0];
    let distance_mm = norm(away_mm);
    if left < 0.0 {
        -distance_mm
    } else {
        distance_mm
    }
}

/// Position and unit tangent at one arc length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Position, mm.
    pub position_mm: [f64; 3],
    /// Unit tangent in the direction of travel.
    pub tangent: [f64; 3],
}

/// Derivatives of a curve by its arc length, for planners that bound what each axis does: with the
/// speed v along the path and its acceleration a and jerk j, an axis has the velocity `p' v`, the
/// acceleration `p'' v^2 + p' a` and the jerk `p''' v^3 + 3 p'' v a + p' j`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Derivatives {
    /// p': the unit tangent.
    pub first: [f64; 3],
    /// p'': towards the centre of curvature, as long as the curvature, 1/mm.
    pub second_1_mm: [f64; 3],
    /// p''', 1/mm2.
    pub third_1_mm2: [f64; 3],
}

/// One exact curve, parameterised by its arc length.
#[derive(Debug, Clone)]
pub enum Curve {
    /// Straight.
    Line(Line),
    /// Circular arc or helix.
    Arc(Arc),
    /// Any other smooth curve; shared, because its table is large.
    Smooth(std::sync::Arc<Smooth>),
}

impl Curve {
    /// Length, mm.
    pub fn length_mm(&self) -> f64 {
        match self {
            Self::Line(line) => line.length_mm(),
            Self::Arc(arc) => arc.length_mm(),
            Self::Smooth(smooth) => smooth.length_mm(),
        }
    }

    /// Returns true if the curve is a straight line.
    pub const fn is_straight(&self) -> bool {
        matches!(self, Self::Line(_))
    }

    /// Position and unit tangent at arc length `s_mm` from the start.
    #[inline]
    pub fn at(&self, s_mm: f64) -> Point {
        match self {
            Self::Line(line) => line.at(s_mm),
            Self::Arc(arc) => arc.at(s_mm),
            Self::Smooth(smooth) => smooth.at(s_mm),
        }
    }

    /// Curvature at `s_mm`, 1/mm, not negative.
    pub fn curvature(&self, s_mm: f64) -> f64 {
        match self {
            Self::Line(_) => 0.0,
            Self::Arc(arc) => arc.curvature(),
            Self::Smooth(smooth) => smooth.curvature(s_mm),
        }
    }

    /// Derivatives at `s_mm`.
    pub fn derivatives(&self, s_mm: f64) -> Derivatives {
        match self {
            Self::Line(line) => line.derivatives(),
            Self::Arc(arc) => arc.derivatives(s_mm),
            Self::Smooth(smooth) => smooth.derivatives(s_mm),
        }
    }

    /// Arc length, between `lo_mm` and `hi_mm`, of the point nearest to `point_mm`.
    #[inline]
    pub fn nearest(&self, point_mm: [f64; 3], lo_mm: f64, hi_mm: f64) -> f64 {
        match self {
            Self::Line(line) => line.nearest(point_mm, lo_mm, hi_mm),
            Self::Arc(arc) => arc.nearest(point_mm, lo_mm, hi_mm),
            Self::Smooth(smooth) => smooth.nearest(point_mm, lo_mm, hi_mm),
        }
    }
}

/// A curve of the program with what the program says about it.
#[derive(Debug, Clone)]
pub struct Piece {
    /// The curve.
    pub curve: Curve,
    /// Start point of the curve.
    pub start_mm: [f64; 3],
    /// Its length, mm.
    pub length_mm: f64,
    /// Arc length of the path at the start of this piece, mm.
    pub s_mm: f64,
    /// Line of the program.
    pub line: u32,
    /// True for a cutting piece, false for a rapid.
    pub cutting: bool,
    /// Programmed feedrate, mm/s; not used by a rapid.
    pub feed_mm_s: f64,
    /// Corner mode at the end of the piece.
    pub corner: Corner,
    /// Largest angle that one of A, B and C turns in a millimetre of this piece, degrees/mm; 0
    /// where none turns.
    pub turn_deg_mm: f64,
    /// Way of U, V and W in a millimetre of this piece, mm/mm; 0 where none moves.
    pub further_mm_mm: f64,
}

/// One step of a path: a piece, or an event between pieces.
#[derive(Debug, Clone)]
pub enum Step {
    /// The tool moves.
    Piece(Piece),
    /// Something else happens.
    Event(Event),
    /// The tool stands still while something else moves: a rotary axis, an extruder.
    Rest(Rest),
}

/// A rest of the tool while something else moves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rest {
    /// Line of the program.
    pub(crate) line: u32,
    /// Duration by the programmed feedrate, s; 0 for a rapid.
    pub(crate) seconds: f64,
    /// Largest angle that one of A, B and C turns, degrees: at the machine's rate it takes no less.
    pub(crate) turn_deg: f64,
    /// Way of U, V and W, mm: at the machine's rapid rate it takes no less.
    pub(crate) further_mm: f64,
}

/// Steps in program order; the first error ends the path.
pub type Steps<'p> = Box<dyn Iterator<Item = Result<Step, PathError>> + Send + 'p>;

/// Why a motion has no path.
#[derive(Debug, Clone, PartialEq, thiserror::Error, miette::Diagnostic)]
pub enum PathError {
    /// A coordinate is not a number, or too large.
    #[error("line {line}: coordinate {value_mm} mm is not within +-{MAX_COORDINATE_MM:e} mm")]
    #[diagnostic(help("check the units (G20/G21) and the offsets in force"))]
    Coordinate {
        /// Line of the program.
        line: u32,
        /// The coordinate.
        value_mm: f64,
    },
    /// The motion does not start where the one before ended.
    #[error(
        "line {line}: the motion starts {gap_mm} mm away from the end of the one before, limit {MAX_GAP_MM:e} mm"
    )]
    Gap {
        /// Line of the program.
        line: u32,
        /// Distance.
        gap_mm: f64,
    },
    /// The feedrate is zero, negative, or not a number.
    #[error("line {line}: feedrate {feed_mm_s} mm/s is below {MIN_FEED_MM_S:e} mm/s")]
    #[diagnostic(help("program a feedrate with F"))]
    Feed {
        /// Line of the program.
        line: u32,
        /// The feedrate.
        feed_mm_s: f64,
    },
    /// The centre of an arc lies on its start or end.
    #[error("line {line}: the arc's radius {radius_mm} mm is below {MIN_LENGTH_MM:e} mm")]
    #[diagnostic(help("check I, J and K, and G90.1/G91.1"))]
    ArcRadius {
        /// Line of the program.
        line: u32,
        /// Radius at the start or the end, the smaller one.
        radius_mm: f64,
    },
    /// An arc of no turns.
    #[error("line {line}: the arc makes 0 turns, it needs at least 1")]
    ArcTurns {
        /// Line of the program.
        line: u32,
    },
    /// A spline that is not one.
    #[error("line {line}: {what}")]
    Spline {
        /// Line of the program.
        line: u32,
        /// Description of the fault.
        what: String,
    },
    /// A dwell that is negative, endless, or not a number.
    #[error("line {line}: a dwell of {seconds} s is not between 0 and {MAX_REST_S:e} s")]
    Dwell {
        /// Line of the program.
        line: u32,
        /// Its seconds.
        seconds: f64,
    },
}
