//! Foot points: where on the programmed path the tool is.
//!
//! The tool lags the command by milliseconds, so that `act - path` of one row is mostly lag along the path. What a
//! drawing enlarges is the deviation across the path: from the foot point, the nearest point of the path near by, to
//! the tool. The path near by is the polyline through the latest path points of the rows.

use std::collections::VecDeque;

use crate::trace::Row;

/// Path points kept. At a row per millisecond this covers a lag of half a second, some twenty times what a feed drive
/// lags; with fewer, a slow drive's foot would be pinned to the oldest point.
const KEPT_POINTS: usize = 512;

/// Segments searched behind the last foot: the tool may turn back a little at a corner.
const SEGMENTS_BACK: usize = 8;

/// Below this the direction from foot to tool is rounding, and the sign of the contour error gives the side, mm.
const DIRECTION_FLOOR_MM: f64 = 1e-9;

/// Finds the foot points of a run, row by row.
#[derive(Debug, Clone, Default)]
pub(super) struct FootFinder {
    points_mm: VecDeque<[f64; 3]>,
    /// Segment of the last foot; segment i runs from point i to point i + 1.
    segment: usize,
}

/// A foot point and the deviation across the path.
#[derive(Debug, Clone, Copy)]
pub(super) struct Foot {
    pub foot_mm: [f64; 3],
    /// From the foot to the tool; as long as the row's contour error where the row cuts.
    pub deviation_mm: [f64; 3],
}

impl FootFinder {
    pub(super) fn find(&mut self, row: &Row) -> Foot {
        self.push(row.path_mm);
        let (segment, foot_mm) = self.nearest(row.act_mm);
        self.segment = segment;
        let from_foot_mm = sub(row.act_mm, foot_mm);
        let deviation_mm = if row.cutting { self.scaled(from_foot_mm, row.contour_error_mm) } else { from_foot_mm };
        Foot { foot_mm, deviation_mm }
    }

    fn push(&mut self, point_mm: [f64; 3]) {
        if self.points_mm.back() == Some(&point_mm) {
            return;
        }
        if self.points_mm.len() == KEPT_POINTS {
            self.points_mm.pop_front();
            self.segment = self.segment.saturating_sub(1);
        }
        self.points_mm.push_back(point_mm);
    }

    /// Nearest point from a little behind the last foot up to the newest path point. The newest segment is prolonged:
    /// a tool that follows without lag is one period ahead of the path point of its row.
    fn nearest(&self, point_mm: [f64; 3]) -> (usize, [f64; 3]) {
        let Some(last) = self.points_mm.len().checked_sub(2) else {
            return (0, self.points_mm.front().copied().unwrap_or(point_mm));
        };
        let first = self.segment.saturating_sub(SEGMENTS_BACK).min(last);
        let mut best = (f64::INFINITY, first, self.points_mm[first]);
        for i in first..=last {
            let (start, along) = (self.points_mm[i], sub(self.points_mm[i + 1], self.points_mm[i]));
            let end = if i == last { f64::INFINITY } else { 1.0 };
            let u = (dot(sub(point_mm, start), along) / dot(along, along)).clamp(0.0, end);
            let foot = [0, 1, 2].map(|k| start[k] + u * along[k]);
            let away = sub(point_mm, foot);
            let distance = dot(away, away);
            if distance < best.0 {
                best = (distance, i, foot);
            }
        }
        (best.1, best.2)
    }

    /// `from_foot_mm`, made as long as the contour error that the run measured on the exact path.
    fn scaled(&self, from_foot_mm: [f64; 3], error_mm: f64) -> [f64; 3] {
        let length = dot(from_foot_mm, from_foot_mm).sqrt();
        if length > DIRECTION_FLOOR_MM {
            return from_foot_mm.map(|x| x * (error_mm.abs() / length));
        }
        let i = self.segment;
        if i + 1 >= self.points_mm.len() {
            return [0.0; 3];
        }
        let along = sub(self.points_mm[i + 1], self.points_mm[i]);
        let length = along[0].hypot(along[1]);
        if length > 0.0 { [-along[1] * error_mm / length, along[0] * error_mm / length, 0.0] } else { [0.0; 3] }
    }
}

fn sub(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::series::tests::row;

    #[test]
    fn on_a_circle_the_deviation_is_radial_whatever_the_lag() {
        let (radius, error) = (10.0, 0.02);
        for lag in [0.0, 0.1, 1.0] {
            let mut finder = FootFinder::default();
            for k in 0..2000 {
                let angle = 0.005 * f64::from(k);
                let behind = (angle - lag).max(0.0);
                let found = finder.find(&Row {
                    path_mm: [radius * angle.cos(), radius * angle.sin(), 0.0],
                    act_mm: [(radius - error) * behind.cos(), (radius - error) * behind.sin(), 0.0],
                    contour_error_mm: error,
                    ..row(f64::from(k) * 1e-3)
                });
                if k > 300 {
                    // Half a chord of 50 µm seen from the centre: the polyline's normal is off by at most 2.5 mrad.
                    let sideways = found.deviation_mm[0] * -behind.sin() + found.deviation_mm[1] * behind.cos();
                    assert!(sideways.abs() < error * 3e-3, "lag {lag}: {sideways}");
                    let radial = found.deviation_mm[0] * behind.cos() + found.deviation_mm[1] * behind.sin();
                    assert!((radial + error).abs() < 1e-6, "lag {lag}: {radial}");
                }
            }
        }
    }

    #[test]
    fn the_foot_passes_a_reversal() {
        let mut finder = FootFinder::default();
        let path = |k: i32| {
            if k < 100 { 0.05 * f64::from(k) } else { 0.05 * f64::from(200 - k) }
        };
        for k in 0..200 {
            let act = [path((k - 20).max(0)), 0.01, 0.0];
            let found = finder.find(&Row { path_mm: [path(k), 0.0, 0.0], act_mm: act, ..row(f64::from(k) * 1e-3) });
            assert!((found.foot_mm[0] - act[0]).abs() < 1e-9, "row {k}: {found:?}");
        }
    }

    #[test]
    fn a_tool_on_the_path_deviates_to_the_side_that_the_sign_says() {
        let mut finder = FootFinder::default();
        finder.find(&row(0.0));
        let on_path = Row { path_mm: [1.0, 0.0, 0.0], act_mm: [1.0, 0.0, 0.0], contour_error_mm: 1e-4, ..row(1e-3) };
        assert_eq!(finder.find(&on_path).deviation_mm, [0.0, 1e-4, 0.0]);
    }
}
