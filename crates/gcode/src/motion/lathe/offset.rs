//! The curve at a distance from a profile, on the side of the stock.
//!
//! The profile never goes back along the passes, so all below it is part, and all within the
//! distance of the part lies below the uppermost of these: its curves moved to their left, and
//! circles about its outer corners. The pieces come one by one; one that begins below those before
//! it is left out up to where it comes through them, and what it covers goes.

use crate::geometry::plane::{
    PlaneCurve, PlanePoint, SLACK_MM, add, cross, dot, left_of, length, minus, scaled, shifted,
    unit,
};
use crate::motion::lathe::corners::SMOOTH_RAD;
use crate::motion::lathe::profile::{Profile, goes_back};
use crate::state::lathe::LatheCycle;
use crate::text::diagnostic::Read;

/// Curves that cross at less than this, rad, touch: where pieces are 1 mm off, lines that bend less
/// end within [`SLACK_MM`].
const TOUCH_RAD: f64 = 1e-9;
/// Corners that turn back on themselves but for this, rad, leave walls that are one to rounding.
const REVERSAL_RAD: f64 = 1e-6;
/// Distance below which two lines meet in a corner instead of an arc, mm: between their ends along
/// the passes, after the offset. LinuxCNC does the same (measured).
const SHARP_MM: f64 = 0.01;
/// Largest bend at which two lines meet in such a corner, rad; sharper corners are always rounded.
/// At this bend the corner lies 3 % farther away than the arc.
const SHARP_RAD: f64 = 0.5;
/// Search range for the start of the first line and the end of the last line where neighboring
/// pieces cover them, in offset distances before or behind the line.
const GO_ON: f64 = 4.0;
/// Comparisons of pieces with those before them: a distance much larger than the details of a long
/// profile makes their number grow with its square.
const MAX_COMPARISONS: usize = 10_000_000;

impl Profile {
    /// The profile at `distance_mm` from itself.
    pub(super) fn offset(&self, lathe: &LatheCycle, distance_mm: f64) -> Read<Self> {
        if distance_mm <= SLACK_MM {
            return Ok(self.clone());
        }
        let mut above = UpperEnvelope {
            curves: Vec::with_capacity(2 * self.curves.len()),
            is_below: false,
            is_lost: false,
            comparisons: 0,
            distance_mm,
            first: self.entry(),
        };
        let mut before: Option<&PlaneCurve> = None;
        for curve in &self.curves {
            // An inner arc that would vanish lies below what is beside it.
            let mut moved = shifted(curve, distance_mm);
            let corner = curve.start();
            let to = curve.direction(corner);
            if let Some(from) = before.map(|before| before.direction(corner)) {
                let bend = libm::atan2(cross(from, to), dot(from, to));
                // A wall that is its own way back has no side to be at a distance from.
                above.is_lost |= bend.abs() > std::f64::consts::PI - REVERSAL_RAD;
                let [start, end] =
                    [from, to].map(|along| add(corner, scaled(left_of(along), distance_mm)));
                let is_sharp = -bend < SHARP_RAD && end[0] - start[0] < SHARP_MM;
                if bend < -SMOOTH_RAD && !(is_sharp && above.meet_sharply(moved.as_mut(), corner)) {
                    above.push(PlaneCurve::Arc {
                        start,
                        end,
                        center: corner,
                        turn: -1.0,
                    });
                }
            }
            match moved {
                Some(moved) => above.push(moved),
                None => above.is_below = true,
            }
            before = Some(curve);
        }
        if let Some(last) = self.curves.last() {
            above.end_on(last);
        }
        let is_found = !above.is_below
            && !above.is_lost
            && above.comparisons <= MAX_COMPARISONS
            && !above.curves.iter().any(goes_back);
        above.curves.retain(|curve| curve.chord() > SLACK_MM);
        if !is_found || above.curves.is_empty() {
            let message =
                format!("the distance of {distance_mm:.4} mm to it is too large for its details");
            return Err(lathe
                .refuse(lathe.line, &message)
                .hint("make D (and E) smaller"));
        }
        Ok(Self {
            plane: self.plane,
            start: self.start,
            curves: above.curves,
        })
    }
}

/// The uppermost pieces so far.
struct UpperEnvelope {
    curves: Vec<PlaneCurve>,
    /// The last piece ended below them.
    is_below: bool,
    /// A piece that is not found above goes round their beginning: what is above is not known.
    is_lost: bool,
    comparisons: usize,
    distance_mm: f64,
    /// Start of the profile.
    first: PlanePoint,
}

impl UpperEnvelope {
    pub(super) fn push(&mut self, mut piece: PlaneCurve) {
        let end = self.curves.last().map(PlaneCurve::end);
        let goes_on =
            !self.is_below && end.is_none_or(|end| length(minus(piece.start(), end)) <= SLACK_MM);
        if !goes_on {
            let through = self
                .comes_through(&piece)
                .or_else(|| self.comes_before(&piece));
            self.is_below = through.is_none();
            let Some((kept, point)) = through else {
                self.is_lost |= self
                    .curves
                    .first()
                    .is_none_or(|first| piece.start()[0] < first.start()[0] - SLACK_MM);
                return;
            };
            self.shorten(kept, point);
            piece.set_start(point);
        }
        self.curves.push(piece);
    }

    /// Keeps the first `kept` pieces and ends the last of them at `point`.
    fn shorten(&mut self, kept: usize, point: PlanePoint) {
        self.curves.truncate(kept);
        if let Some(last) = self.curves.last_mut() {
            last.set_end(point);
        }
    }

    /// Lets two lines meet at an outer corner, if both are lines.
    fn meet_sharply(&mut self, next: Option<&mut PlaneCurve>, corner: PlanePoint) -> bool {
        let (Some(last @ PlaneCurve::Line { .. }), Some(next @ PlaneCurve::Line { .. })) =
            (self.curves.last_mut(), next)
        else {
            return false;
        };
        let point = if self.is_below {
            None
        } else {
            last.meet(next, corner)
        };
        if let Some(point) = point {
            last.set_end(point);
            next.set_start(point);
        }
        point.is_some()
    }

    /// Ends what is above where the last line, were it longer, would come through.
    fn end_on(&mut self, last: &PlaneCurve) {
        if self.is_below
            && let Some(PlaneCurve::Line { start, end }) = shifted(last, self.distance_mm)
        {
            let longer = PlaneCurve::Line {
                start,
                end: add(
                    end,
                    scaled(unit(minus(end, start)), GO_ON * self.distance_mm),
                ),
            };
            if let Some((kept, point)) = self.comes_through(&longer)
                && length(minus(point, last.end())) >= self.distance_mm - SLACK_MM
            {
                self.shorten(kept, point);
                self.is_below = false;
            }
        }
    }

    /// Returns the point where a piece meets the first line, extended backward. No existing piece
    /// is kept then, so the number is 0.
    fn comes_before(&self, piece: &PlaneCurve) -> Option<(usize, PlanePoint)> {
        let Some(&PlaneCurve::Line { start, end }) = self.curves.first() else {
            return None;
        };
        let earlier = PlaneCurve::Line {
            start: add(
                start,
                scaled(unit(minus(start, end)), GO_ON * self.distance_mm),
            ),
            end: start,
        };
        let point = earlier.first_crossing(piece)?;
        (length(minus(point, self.first)) >= self.distance_mm - SLACK_MM).then_some((0, point))
    }

    /// Returns where a piece that begins below the others first rises through them, and how many of
    /// them are kept.
    fn comes_through(&mut self, piece: &PlaneCurve) -> Option<(usize, PlanePoint)> {
        let mut found: Option<(usize, PlanePoint, f64)> = None;
        for (number, curve) in self.curves.iter().enumerate().rev() {
            self.comparisons += 1;
            if self.comparisons > MAX_COMPARISONS || curve.end()[0] < piece.start()[0] - SLACK_MM {
                break;
            }
            // What is left of a curve may be a point, which has no direction.
            let has_length = curve.chord() > SLACK_MM;
            if let Some(point) = has_length.then(|| curve.first_crossing(piece)).flatten() {
                let way = piece.way_to(point);
                if found.is_none_or(|(_, _, first)| way < first) {
                    found = Some((number, point, way));
                }
            }
        }
        let (number, point, _) = found?;
        // It must come from below, not touch or go down.
        let rises = cross(self.curves[number].direction(point), piece.direction(point)) > TOUCH_RAD;
        rises.then_some((number + 1, point))
    }
}
