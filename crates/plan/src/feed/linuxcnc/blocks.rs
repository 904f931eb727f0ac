//! Blocks as LinuxCNC's planner gets them: short lines are joined as long as every point between
//! keeps the tolerance Q of `G64` (P where there is no Q), and arcs flatter than that count as two
//! lines.

use std::collections::VecDeque;

use feedwright_gcode::canon::Corner;

use super::limits::{DirectionLimits, NORMAL_RATIO};
use super::shape::{CircleShape, LineShape, SegmentShape};
use crate::path::Piece;
use crate::vector::{add_scaled, distance, dot, norm, sub};

/// Most points of a line that is joined.
const MOST_POINTS: usize = 101;

/// Distance of the chords that stand for a spline, mm.
const CHORD_MM: f64 = 1e-3;

/// Most chords of a spline.
const MOST_CHORDS: f64 = 1e6;

/// Turned more than this out of the plane of X and Y a circle is not flat enough to be two lines.
const IN_XY: f64 = 1.0 - 1e-9;

/// Parts of a spiral turn by the same angle, to this part of it, and meet within a milliradian.
const SAME_ANGLE: f64 = 1e-3;
const SAME_DIRECTION: f64 = 1.0 - 5e-7;

/// Most parts of a spiral.
const MOST_PARTS: usize = 4096;

/// A block.
#[derive(Debug, Clone)]
pub(super) struct PlannerBlock {
    /// Its curve.
    pub(crate) shape: SegmentShape,
    /// Places along it, and the arc lengths of the program that they stand for, mm.
    pub(crate) places_mm: Vec<[f64; 2]>,
    /// True for a rapid.
    pub(crate) is_rapid: bool,
    /// True where an axis other than X, Y and Z moves along.
    pub(crate) is_rotary: bool,
    /// Speed asked for.
    pub(crate) feed_mm_s: f64,
    /// Highest speed that the axes allow.
    pub(crate) highest_mm_s: f64,
    /// Acceleration.
    pub(crate) accel_mm_s2: f64,
    /// Corner mode at its end.
    pub(crate) corner: Corner,
}

/// Mode that all joined lines share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BlockMode {
    /// True for rapids.
    pub(crate) is_rapid: bool,
    /// True where an axis other than X, Y and Z moves along.
    pub(crate) is_rotary: bool,
    /// Speed asked for.
    pub(crate) feed_mm_s: f64,
    /// Highest speed of what moves along.
    pub(crate) along_mm_s: f64,
    /// Corner mode at their ends.
    pub(crate) corner: Corner,
}

impl BlockMode {
    /// Returns the largest distance of points from the line that they are joined to, mm.
    fn joins_within_mm(&self) -> f64 {
        match self.corner {
            Corner::Continuous {
                tolerance_mm,
                merge_mm,
            } if !self.is_rapid && !self.is_rotary => merge_mm.or(tolerance_mm).unwrap_or(0.0),
            _ => 0.0,
        }
    }
}

/// Circles of one line of the program, each tangent to the one before: an arc with unequal radii.
#[derive(Debug, Default)]
struct ArcParts {
    parts: Vec<CircleShape>,
    line: u32,
    /// Start and end, as arc length of the program.
    s_mm: [f64; 2],
    end_mm: [f64; 3],
}

impl ArcParts {
    /// Returns true if a circle is the next part. Circles with the same radius are motions of their
    /// own.
    fn goes_on(&self, next: &CircleShape, line: u32) -> bool {
        self.parts.last().is_some_and(|last| {
            line == self.line
                && last.radius_mm != next.radius_mm
                && dot(last.normal, next.normal) > IN_XY
                && (last.angle - next.angle).abs() < SAME_ANGLE * next.angle
                && dot(last.tangent(last.angle), next.tangent(0.0)) > SAME_DIRECTION
                && self.parts.len() < MOST_PARTS
        })
    }
}

/// Makes blocks of pieces.
#[derive(Debug)]
pub(super) struct BlockMaker {
    limits: DirectionLimits,
    mode: Option<BlockMode>,
    /// Start of the next block, and the arc length of the program there.
    from: ([f64; 3], f64),
    /// Points that are joined.
    chain: Vec<([f64; 3], f64)>,
    /// Circles that may be parts of a spiral.
    arcs: ArcParts,
    /// Blocks that are made.
    pub(crate) ready: VecDeque<PlannerBlock>,
}

impl BlockMaker {
    /// None yet.
    pub(super) fn new(limits: DirectionLimits) -> Self {
        Self {
            limits,
            mode: None,
            from: ([0.0; 3], 0.0),
            chain: Vec::new(),
            arcs: ArcParts::default(),
            ready: VecDeque::new(),
        }
    }

    /// The tool rests at a point; arc length begins again.
    pub(super) fn begin(&mut self, at_mm: [f64; 3]) {
        self.chain.clear();
        self.arcs = ArcParts::default();
        self.from = (at_mm, 0.0);
    }

    /// Adds a piece that begins at this arc length.
    pub(super) fn push(&mut self, piece: &Piece, mode: BlockMode, s_mm: f64) {
        if self.mode != Some(mode) {
            self.flush();
            self.mode = Some(mode);
        }
        let end_mm = piece.curve.at(piece.length_mm).position_mm;
        let end_s_mm = s_mm + piece.length_mm;
        if let Some(circle) = CircleShape::of(piece) {
            if !self.arcs.goes_on(&circle, piece.line) {
                self.finish_arc();
                self.arcs = ArcParts {
                    line: piece.line,
                    s_mm: [s_mm, s_mm],
                    ..ArcParts::default()
                };
            }
            self.arcs.parts.push(circle);
            self.arcs.s_mm[1] = end_s_mm;
            self.arcs.end_mm = end_mm;
            return;
        }
        self.finish_arc();
        let chords = if piece.curve.is_straight() {
            1
        } else {
            chords(piece)
        };
        for i in 1..chords {
            let along_mm = piece.length_mm * i as f64 / chords as f64;
            self.see(&mode, piece.curve.at(along_mm).position_mm, s_mm + along_mm);
        }
        self.see(&mode, end_mm, end_s_mm);
    }

    /// The circles that wait are a whole motion.
    fn finish_arc(&mut self) {
        let ArcParts {
            parts,
            s_mm,
            end_mm,
            ..
        } = std::mem::take(&mut self.arcs);
        let (Some(circle), Some(mode)) = (CircleShape::spiral(&parts), self.mode) else {
            return;
        };
        let away_mm = circle.radius_mm * (1.0 - libm::cos(0.5 * circle.angle));
        if circle.normal[2].abs() > IN_XY && away_mm < mode.joins_within_mm() {
            let middle = CircleShape {
                growth: 0.0,
                ..circle
            }
            .at(0.5 * circle.angle);
            self.see(&mode, middle, 0.5 * (s_mm[0] + s_mm[1]));
            self.see(&mode, end_mm, s_mm[1]);
        } else {
            self.flush_lines();
            self.circle(circle, &mode, s_mm);
            self.from = (end_mm, s_mm[1]);
        }
    }

    /// The next point.
    fn see(&mut self, mode: &BlockMode, point: [f64; 3], s_mm: f64) {
        if !self.chain.is_empty() && !self.is_linkable(point, mode.joins_within_mm()) {
            self.flush_lines();
        }
        self.chain.push((point, s_mm));
        if mode.is_rotary || mode.is_rapid {
            self.flush_lines();
        }
    }

    /// Returns true if all points in between lie close enough to the line to this one.
    fn is_linkable(&self, point: [f64; 3], within_mm: f64) -> bool {
        if within_mm <= 0.0 || self.chain.len() >= MOST_POINTS {
            return false;
        }
        let way = sub(point, self.from.0);
        let square = dot(way, way);
        square > 0.0
            && self.chain.iter().all(|(between, _)| {
                let from = sub(*between, self.from.0);
                let part = (dot(way, from) / square).clamp(0.0, 1.0);
                norm(add_scaled(from, -part, way)) <= within_mm
            })
    }

    /// Makes blocks of all that waits.
    pub(super) fn flush(&mut self) {
        self.finish_arc();
        self.flush_lines();
    }

    /// Makes a line of the points that wait.
    fn flush_lines(&mut self) {
        let (Some(&(end_mm, end_s_mm)), Some(mode)) = (self.chain.last(), self.mode) else {
            return;
        };
        if let Some(line) = LineShape::new(self.from.0, end_mm) {
            let mut places_mm = vec![[0.0, self.from.1]];
            let mut furthest_mm: f64 = 0.0;
            for (point, s_mm) in &self.chain[..self.chain.len() - 1] {
                let along_mm = dot(sub(*point, self.from.0), line.direction);
                furthest_mm = furthest_mm.max(along_mm.min(line.length_mm));
                places_mm.push([furthest_mm, *s_mm]);
            }
            places_mm.push([line.length_mm, end_s_mm]);
            let highest_mm_s = self.limits.speed_mm_s(line.direction);
            let accel_mm_s2 = self.limits.accel_along_mm_s2(line.direction);
            self.block(
                SegmentShape::Line(line),
                places_mm,
                &mode,
                [highest_mm_s, accel_mm_s2],
            );
            self.from = (end_mm, end_s_mm);
        } else {
            // Points that lead back to their start make no line: the next block includes them.
            self.from.0 = end_mm;
        }
        self.chain.clear();
    }

    /// A circle keeps the limits of the plane in every direction, and those of the chord for what
    /// goes along.
    fn circle(&mut self, circle: CircleShape, mode: &BlockMode, s_mm: [f64; 2]) {
        let [axes_mm_s, axes_mm_s2] = self.limits.of_plane(circle.normal);
        let least_mm = circle.radius_mm.min(circle.end_radius_mm());
        let round_mm_s =
            (NORMAL_RATIO * axes_mm_s2 * libm::hypot(least_mm, circle.growth_mm())).sqrt();
        let chord = sub(circle.at(circle.angle), circle.at(0.0));
        let of_chord = |limits: [f64; 3]| {
            (0..3)
                .map(|k| chord[k].abs() / limits[k])
                .fold(0.0, f64::max)
        };
        let flat_mm = libm::hypot(least_mm * circle.angle, circle.growth * circle.radius_mm);
        let way_mm = libm::hypot(flat_mm, norm(circle.rise_mm));
        let highest_mm_s =
            way_mm / (flat_mm / axes_mm_s.min(round_mm_s)).max(of_chord(self.limits.velocity_mm_s));
        let accel_mm_s2 = way_mm / (flat_mm / axes_mm_s2).max(of_chord(self.limits.accel_mm_s2));
        let length_mm = circle.length_mm();
        let places_mm = vec![[0.0, s_mm[0]], [length_mm, s_mm[1]]];
        self.block(
            SegmentShape::Circle(circle),
            places_mm,
            mode,
            [highest_mm_s, accel_mm_s2],
        );
    }

    fn block(
        &mut self,
        shape: SegmentShape,
        places_mm: Vec<[f64; 2]>,
        mode: &BlockMode,
        [highest_mm_s, accel_mm_s2]: [f64; 2],
    ) {
        let highest_mm_s = highest_mm_s.min(mode.along_mm_s);
        let feed_mm_s = mode.feed_mm_s.min(highest_mm_s);
        let highest_mm_s = if mode.is_rapid {
            feed_mm_s
        } else {
            highest_mm_s
        };
        let BlockMode {
            is_rapid,
            is_rotary,
            corner,
            ..
        } = *mode;
        self.ready.push_back(PlannerBlock {
            shape,
            places_mm,
            is_rapid,
            is_rotary,
            feed_mm_s,
            highest_mm_s,
            accel_mm_s2,
            corner,
        });
    }
}

/// Returns the number of chords that stand for a spline.
fn chords(piece: &Piece) -> usize {
    let at = |i: u32| piece.curve.curvature(piece.length_mm * f64::from(i) / 64.0);
    let curvature = (0..=64).map(at).fold(0.0, f64::max);
    let chord_mm = (8.0 * CHORD_MM / curvature.max(1e-9)).sqrt();
    let ends_mm = [0.0, piece.length_mm].map(|s_mm| piece.curve.at(s_mm).position_mm);
    let least = if distance(ends_mm[0], ends_mm[1]) > 0.0 {
        1.0
    } else {
        2.0
    };
    (piece.length_mm / chord_mm)
        .ceil()
        .clamp(least, MOST_CHORDS) as usize
}
