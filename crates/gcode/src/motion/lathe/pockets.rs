//! Where a profile goes down and comes up again: falling stretches, their crossings with a level,
//! and pockets that are left standing.

use crate::geometry::plane::{PlaneCurve, PlanePoint, SLACK_MM, length, minus};

/// Returns true if a curve goes down from its start.
pub(crate) fn falls(curve: &PlaneCurve) -> bool {
    match *curve {
        PlaneCurve::Line { start, end } => end[1] < start[1] - SLACK_MM,
        // Towards growing coordinates, a left turn is the lower half of a circle and a right turn
        // the upper one.
        PlaneCurve::Arc {
            start,
            center,
            turn,
            ..
        } if turn > 0.0 => start[0] < center[0] - SLACK_MM,
        PlaneCurve::Arc { start, center, .. } => start[0] >= center[0] - SLACK_MM,
    }
}

/// Returns true if a curve goes down all the way to its end. A hollow that rises again does not.
pub(super) fn ends_falling(curve: &PlaneCurve) -> bool {
    falls(curve) && bottom(curve).is_none()
}

/// The lowest point of an arc that has one between its ends.
pub(super) fn bottom(curve: &PlaneCurve) -> Option<PlanePoint> {
    match *curve {
        PlaneCurve::Arc {
            start,
            end,
            center,
            turn,
        } if turn > 0.0 && start[0] < center[0] - SLACK_MM && end[0] > center[0] + SLACK_MM => {
            Some([center[0], center[1] - length(minus(start, center))])
        }
        _ => None,
    }
}

/// The curves with arcs parted at their highest points.
pub(crate) fn parted_at_tops(curves: Vec<PlaneCurve>) -> Vec<PlaneCurve> {
    let mut parted = Vec::with_capacity(curves.len() + 1);
    for curve in curves {
        match curve {
            PlaneCurve::Arc {
                start,
                end,
                center,
                turn,
            } if turn < 0.0 && start[0] < center[0] - SLACK_MM && end[0] > center[0] + SLACK_MM => {
                let top = [center[0], center[1] + length(minus(start, center))];
                parted.push(PlaneCurve::Arc {
                    start,
                    end: top,
                    center,
                    turn,
                });
                parted.push(PlaneCurve::Arc {
                    start: top,
                    end,
                    center,
                    turn,
                });
            }
            _ => parted.push(curve),
        }
    }
    parted
}

/// Half of the circle's chord at `level`.
fn half_chord(start: PlanePoint, center: PlanePoint, level: f64) -> f64 {
    let radius = length(minus(start, center));
    (radius * radius - (level - center[1]).powi(2))
        .max(0.0)
        .sqrt()
}

/// Returns the point where a falling curve crosses `level`. Its start counts, its end does not.
pub(crate) fn falls_through(curve: &PlaneCurve, level: f64) -> Option<PlanePoint> {
    let (start, end) = (curve.start(), curve.end());
    if !falls(curve) || level > start[1] + SLACK_MM {
        return None;
    }
    let is_reached = bottom(curve).map_or(level > end[1] + SLACK_MM, |bottom| {
        level >= bottom[1] - SLACK_MM
    });
    if !is_reached {
        return None;
    }
    if level >= start[1] - SLACK_MM {
        return Some(start);
    }
    let along = match *curve {
        PlaneCurve::Line { .. } => {
            start[0] + (end[0] - start[0]) * ((level - start[1]) / (end[1] - start[1]))
        }
        PlaneCurve::Arc { center, turn, .. } => center[0] - turn * half_chord(start, center, level),
    };
    // Rounding may leave the start behind the end, which clamp does not take.
    Some([along.min(end[0]).max(start[0]), level])
}

/// Returns the coordinate along the passes where a curve that starts below `level`, or falls from
/// it, rises to it.
fn rises_to(curve: &PlaneCurve, level: f64) -> f64 {
    let (start, end) = (curve.start(), curve.end());
    match *curve {
        PlaneCurve::Line { .. } if start[1] >= level - SLACK_MM => start[0],
        PlaneCurve::Line { .. } => {
            start[0] + (end[0] - start[0]) * ((level - start[1]) / (end[1] - start[1])).min(1.0)
        }
        // Rising, a left turn is on the right of its centre and a right turn on the left.
        PlaneCurve::Arc { center, turn, .. } => (center[0]
            + turn * half_chord(start, center, level))
        .min(end[0])
        .max(start[0]),
    }
}

/// Returns the first curve that rises to `level`, and the coordinate along the passes where it
/// does.
pub(crate) fn first_at(curves: &[PlaneCurve], level: f64) -> Option<(usize, f64)> {
    let number = curves
        .iter()
        .position(|curve| curve.end()[1] >= level - SLACK_MM)?;
    let curve = &curves[number];
    let begins_there = curve.start()[1] >= level - SLACK_MM && !falls(curve);
    Some((
        number,
        if begins_there {
            curve.start()[0]
        } else {
            rises_to(curve, level)
        },
    ))
}

/// The curves without their pockets: each is bridged at the height of its lip, and what does not
/// come up to it again is left out.
///
/// As in LinuxCNC, what falls at once from the entry is no pocket.
pub(super) fn bridged(curves: &[PlaneCurve], entry_falls: bool) -> Vec<PlaneCurve> {
    let mut bridged: Vec<PlaneCurve> = Vec::with_capacity(curves.len());
    let mut before_falls = entry_falls;
    let mut number = 0;
    while let Some(&curve) = curves.get(number) {
        if before_falls || !falls(&curve) {
            before_falls = ends_falling(&curve);
            bridged.push(curve);
            number += 1;
            continue;
        }
        let lip = curve.start();
        // A hollow comes up to its own lip again, and so does, to rounding, an arc that hardly
        // falls: it is found itself.
        let Some((ahead, along)) = first_at(&curves[number..], lip[1]) else {
            break;
        };
        let end = [along, lip[1]];
        if along > lip[0] + SLACK_MM {
            bridged.push(PlaneCurve::Line { start: lip, end });
        }
        let mut rest = curves[number + ahead];
        rest.set_start(end);
        before_falls = false;
        if length(minus(rest.end(), end)) > SLACK_MM {
            before_falls = ends_falling(&rest);
            bridged.push(rest);
        }
        // What is left of a curve is never a pocket again: every round takes a curve, so there is
        // an end.
        number += ahead + 1;
    }
    bridged
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found by mutation: an arc that falls by less than rounding was its own bridge for ever.
    #[test]
    fn an_arc_that_hardly_falls_is_bridged_once() {
        let arc = PlaneCurve::Arc {
            start: [0.0, 0.0],
            end: [1e-3, -5e-13],
            center: [0.0, -1e6],
            turn: -1.0,
        };
        assert!(falls(&arc));
        assert!(bridged(&[arc, arc], false).len() <= 4);
    }
}
