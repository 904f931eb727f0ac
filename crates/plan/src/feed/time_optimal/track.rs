//! The programmed path from one rest to the next, as far as it is known, with what bounds the speed
//! at places of it.

use super::steps::AxisCaps;
use crate::constraints::speed_caps::SpeedCaps;
use crate::path::{Curve, Piece};
use crate::vector::{angle, distance, norm, sub};
use std::collections::VecDeque;
use std::sync::Arc;

/// Angle between two pieces above which a node lies on their joint, rad.
const SHARP_RAD: f64 = 0.2;

/// Widest span over which the path is looked at as a whole, mm; so much of it has to be known
/// beyond a place.
const WIDEST_MM: f64 = 2.56;

/// Ratio of the width of each span to the width of the span before it.
const WIDER: f64 = 1.5;

/// Distance of places, in tolerances, near the ends of pieces.
const GRID: f64 = 2.0;

/// A piece with what holds on it.
#[derive(Debug, Clone)]
pub(super) struct TrackPiece {
    pub(super) number: u64,
    pub(super) curve: Curve,
    /// Start: position, arc length from the start of the program and from the rest.
    pub(super) start_mm: [f64; 3],
    pub(super) program_mm: f64,
    pub(super) s_mm: f64,
    pub(super) length_mm: f64,
    pub(super) feed_mm_s: f64,
    pub(super) tolerance_mm: f64,
}

/// A place with a bound on the speed.
#[derive(Debug, Clone, Copy)]
pub(super) struct TrackPlace {
    pub(super) s_mm: f64,
    pub(super) cap_mm_s: f64,
    pub(super) tangent: [f64; 3],
    /// Time from the start at these bounds.
    pub(super) at_cap_s: f64,
}

/// See the module's page.
#[derive(Debug, Default)]
pub(super) struct Track {
    pieces: VecDeque<TrackPiece>,
    places: VecDeque<TrackPlace>,
    /// Joints where a node has to be.
    joints: VecDeque<f64>,
    /// Bounds on the speed by the arc length from the start of the program.
    caps: Option<Arc<SpeedCaps>>,
    pub(super) end_mm: f64,
    /// The tool rests behind the last piece.
    pub(super) ended: bool,
}

impl Track {
    /// Creates a track without pieces.
    pub(super) fn new(caps: Option<Arc<SpeedCaps>>) -> Self {
        Self {
            caps,
            ..Self::default()
        }
    }

    /// Bound on the speed at a place beside its feedrate, mm/s.
    pub(super) fn cap_mm_s(&self, s_mm: f64) -> f64 {
        let Some(caps) = &self.caps else {
            return f64::INFINITY;
        };
        let piece = self.piece(s_mm);
        caps.at(piece.program_mm + (s_mm - piece.s_mm))
    }

    /// The smallest bound and feedrate between two places, mm/s.
    pub(super) fn least_mm_s(&self, lo_mm: f64, hi_mm: f64) -> f64 {
        let feeds = self
            .between(lo_mm, hi_mm)
            .map(|piece| piece.feed_mm_s)
            .fold(f64::INFINITY, f64::min);
        let Some(caps) = &self.caps else {
            return feeds;
        };
        let piece = self.piece(lo_mm);
        let from_mm = piece.program_mm + (lo_mm - piece.s_mm);
        feeds.min(caps.least(from_mm, from_mm + (hi_mm - lo_mm)))
    }

    /// Adds a piece.
    pub(super) fn push(&mut self, number: u64, piece: &Piece, feed_mm_s: f64, tolerance_mm: f64) {
        let Piece {
            curve, length_mm, ..
        } = piece;
        if let Some(before) = self.pieces.back() {
            let turn = angle(
                before.curve.at(before.length_mm).tangent,
                curve.at(0.0).tangent,
            );
            let long = before.length_mm.min(*length_mm) > 2.0 * tolerance_mm;
            if (turn > SHARP_RAD && long)
                || before.feed_mm_s != feed_mm_s
                || before.tolerance_mm != tolerance_mm
            {
                self.joints.push_back(self.end_mm);
            }
        }
        let (curve, length_mm) = (curve.clone(), *length_mm);
        let (start_mm, s_mm) = (curve.at(0.0).position_mm, self.end_mm);
        let program_mm = piece.s_mm;
        self.pieces.push_back(TrackPiece {
            number,
            curve,
            start_mm,
            program_mm,
            s_mm,
            length_mm,
            feed_mm_s,
            tolerance_mm,
        });
        self.end_mm += length_mm;
    }

    /// Returns true if there is no piece yet.
    pub(super) fn is_empty(&self) -> bool {
        self.pieces.is_empty()
    }

    /// The only piece of a path that has ended.
    pub(super) fn only(&self) -> Option<&TrackPiece> {
        if self.pieces.len() == 1 && self.ended {
            self.pieces.front().filter(|piece| piece.s_mm == 0.0)
        } else {
            None
        }
    }

    fn index(&self, s_mm: f64) -> usize {
        self.pieces
            .partition_point(|piece| piece.s_mm <= s_mm)
            .saturating_sub(1)
    }

    /// The piece at a place; at a joint the one behind it.
    pub(super) fn piece(&self, s_mm: f64) -> &TrackPiece {
        &self.pieces[self.index(s_mm)]
    }

    /// Pieces that overlap a part of the path.
    pub(super) fn between(&self, lo_mm: f64, hi_mm: f64) -> impl Iterator<Item = &TrackPiece> {
        self.pieces
            .range(self.index(lo_mm)..)
            .take_while(move |piece| piece.s_mm < hi_mm || piece.s_mm <= lo_mm)
    }

    /// Position and tangent at a place.
    pub(super) fn at(&self, s_mm: f64) -> crate::path::Point {
        let piece = self.piece(s_mm);
        piece
            .curve
            .at((s_mm - piece.s_mm).max(0.0).min(piece.length_mm))
    }

    /// The first joint with a node between two places.
    pub(super) fn joint(&self, lo_mm: f64, hi_mm: f64) -> Option<f64> {
        let first = self.joints.partition_point(|&s_mm| s_mm <= lo_mm);
        self.joints
            .get(first)
            .copied()
            .filter(|&s_mm| s_mm <= hi_mm)
    }

    /// Places from a place on, with one at it or before.
    pub(super) fn places(&self, from_mm: f64) -> impl Iterator<Item = &TrackPlace> + Clone {
        let first = self
            .places
            .partition_point(|place| place.s_mm <= from_mm)
            .saturating_sub(1);
        self.places.range(first..)
    }

    /// Least time from a place to the last place known.
    pub(super) fn ahead_s(&self, from_mm: f64) -> f64 {
        let here = self
            .places(from_mm)
            .next()
            .map_or(0.0, |place| place.at_cap_s);
        self.places
            .back()
            .map_or(0.0, |place| place.at_cap_s - here)
    }

    /// Drops what lies behind.
    pub(super) fn forget_before(&mut self, s_mm: f64) {
        while self.pieces.len() > 1 && self.pieces[1].s_mm < s_mm - WIDEST_MM {
            self.pieces.pop_front();
        }
        while self.places.len() > 1 && self.places[1].s_mm <= s_mm {
            self.places.pop_front();
        }
        while self.joints.front().is_some_and(|&joint| joint < s_mm) {
            self.joints.pop_front();
        }
    }

    /// Looks at all places that can be looked at now.
    pub(super) fn look(&mut self, caps: &AxisCaps) {
        let reach_mm = if self.ended {
            self.end_mm
        } else {
            self.end_mm - WIDEST_MM
        };
        loop {
            let s_mm = match self.places.back() {
                None if self.ended || reach_mm >= 0.0 => 0.0,
                Some(last) if self.ended && last.s_mm >= self.end_mm => return,
                Some(last) => {
                    let next_mm = last.s_mm + self.spacing(last.s_mm);
                    if self.ended {
                        next_mm.min(self.end_mm)
                    } else {
                        next_mm
                    }
                }
                None => return,
            };
            if s_mm > reach_mm {
                return;
            }
            let place = self.place(s_mm, caps);
            self.places.push_back(place);
        }
    }

    /// Finer near the ends of pieces than within them.
    fn spacing(&self, s_mm: f64) -> f64 {
        let piece = self.piece(s_mm);
        let least = GRID * piece.tolerance_mm;
        let local_mm = s_mm - piece.s_mm;
        let ahead_mm = piece.length_mm - local_mm;
        let most: f64 = if matches!(piece.curve, Curve::Line(_)) {
            2.0
        } else {
            0.2
        };
        let step_mm = (0.2 * local_mm.min(ahead_mm).max(0.0)).clamp(least, most.max(least));
        if ahead_mm > least {
            step_mm.min(0.8 * ahead_mm)
        } else {
            step_mm
        }
    }

    /// Bound on the speed at a place: the turn over the widest span over which the tube lets a
    /// motion go straight on takes its time by acceleration; the part of it that does not grow with
    /// the span, a corner, by jerk as well; the other, a bend, by the jerk of an acceleration that
    /// turns. An estimate: it decides how far nodes are apart, not what the axes do.
    fn place(&self, s_mm: f64, caps: &AxisCaps) -> TrackPlace {
        let piece = self.piece(s_mm);
        let here = self.at(s_mm);
        let tolerance_mm = piece.tolerance_mm;
        let first_mm = self.pieces.front().map_or(0.0, |piece| piece.s_mm);
        let (mut turn, mut used_mm, mut narrower) = ([0.0_f64; 3], 0.0, [0.0_f64; 3]);
        let mut width_mm = 2.0 * tolerance_mm;
        while width_mm <= WIDEST_MM && s_mm - width_mm >= first_mm && s_mm + width_mm <= self.end_mm
        {
            let before = sub(here.position_mm, self.at(s_mm - width_mm).position_mm);
            let after = sub(self.at(s_mm + width_mm).position_mm, here.position_mm);
            let (b, a) = (norm(before).max(1e-12), norm(after).max(1e-12));
            let this: [f64; 3] = std::array::from_fn(|k| after[k] / a - before[k] / b);
            if used_mm > 0.0 && norm(this) * width_mm > 6.0 * tolerance_mm {
                break;
            }
            narrower = if used_mm > 0.0 { turn } else { [0.0; 3] };
            (turn, used_mm) = (this, width_mm);
            width_mm *= WIDER;
        }
        let mut cap_mm_s = piece.feed_mm_s.min(self.cap_mm_s(s_mm));
        cap_mm_s = cap_mm_s.min(caps.along(here.tangent, |limits| limits.velocity_mm_s));
        let bend = norm(turn) / used_mm.max(1e-12);
        for (k, limits) in caps.axes.iter().enumerate() {
            // turn = corner + bend * span, by the last two spans.
            let corner = (turn[k] - (turn[k] - narrower[k]) / (1.0 - 1.0 / WIDER))
                .abs()
                .min(turn[k].abs());
            let turn = turn[k].abs();
            if turn > 1e-9 {
                cap_mm_s = cap_mm_s.min((limits.accel_mm_s2 * used_mm / turn).sqrt());
                cap_mm_s = cap_mm_s.min(libm::cbrt(limits.jerk_mm_s3 / (bend * bend)));
            }
            if corner > 1e-9 {
                cap_mm_s = cap_mm_s.min(libm::cbrt(limits.jerk_mm_s3 * used_mm * used_mm / corner));
            }
        }
        let at_cap_s = self.places.back().map_or(0.0, |last| {
            last.at_cap_s + (s_mm - last.s_mm) / cap_mm_s.max(last.cap_mm_s)
        });
        TrackPlace {
            s_mm,
            cap_mm_s,
            tangent: here.tangent,
            at_cap_s,
        }
    }

    /// Distance of a point from the part of the path between two places.
    pub(super) fn distance(&self, point_mm: [f64; 3], lo_mm: f64, hi_mm: f64) -> f64 {
        let mut least = f64::INFINITY;
        for piece in self.between(lo_mm, hi_mm) {
            // No point of it is nearer than its start by more than its length.
            if distance(piece.start_mm, point_mm) - piece.length_mm > least {
                continue;
            }
            let lo = (lo_mm - piece.s_mm).max(0.0).min(piece.length_mm);
            let hi = (hi_mm - piece.s_mm).max(0.0).min(piece.length_mm);
            for s_mm in [piece.curve.nearest(point_mm, lo, hi), lo, hi] {
                least = least.min(distance(piece.curve.at(s_mm).position_mm, point_mm));
            }
        }
        least
    }
}
