//! Outline: the programmed path as a polyline of bounded length.
//!
//! Rows come at every servo period, far denser than a drawing needs. A vertex stays where the path
//! would otherwise leave its chord by more than a tolerance; when the vertices are too many, the
//! tolerance doubles and they are thinned again, so that the outline is within twice the last
//! tolerance of the path.

use feedwright_plan::vector::{add_scaled, dot, sub};

/// Most vertices kept. A page holds one outline; deflated, this many are some 60 kB of it.
const MAX_VERTICES: usize = 20_000;

/// Initial tolerance, mm: a tenth of the smallest contour error that a drawing shows.
const FIRST_TOLERANCE_MM: f64 = 1e-5;

/// Points between two vertices that are checked against the chord. More points make longer chords
/// on straight lines and cost time with their square.
const MAX_SPAN: usize = 32;

/// Vertex of an outline; `cutting` says how the path came to it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Vertex {
    pub(crate) point_mm: [f64; 3],
    pub(crate) cutting: bool,
}

/// Collects an outline.
#[derive(Debug, Clone)]
pub(super) struct OutlineBuilder {
    tolerance_mm: f64,
    vertices: Vec<Vertex>,
    /// Points since the last vertex, all closer than the tolerance to the chord that leads to the
    /// last of them.
    open: Vec<Vertex>,
}

impl Default for OutlineBuilder {
    fn default() -> Self {
        Self {
            tolerance_mm: FIRST_TOLERANCE_MM,
            vertices: Vec::new(),
            open: Vec::new(),
        }
    }
}

impl OutlineBuilder {
    pub(super) fn push(&mut self, vertex: Vertex) {
        self.extend(vertex);
        while self.vertices.len() >= MAX_VERTICES {
            self.tolerance_mm *= 2.0;
            let all = std::mem::take(&mut self.vertices);
            let open = std::mem::take(&mut self.open);
            for v in all.into_iter().chain(open) {
                self.extend(v);
            }
        }
    }

    /// Returns the vertices, including the newest point.
    pub(super) fn vertices(&self) -> impl Iterator<Item = Vertex> {
        self.vertices.iter().chain(self.open.last()).copied()
    }

    fn extend(&mut self, vertex: Vertex) {
        let Some(&start) = self.vertices.last() else {
            self.vertices.push(vertex);
            return;
        };
        let Some(&newest) = self.open.last() else {
            if vertex != start {
                self.open.push(vertex);
            }
            return;
        };
        if newest == vertex {
            return;
        }
        // A change between rapid and cut is a vertex, unless it is smaller than the tolerance:
        // otherwise a record might never become short enough.
        let same_kind = newest.cutting == vertex.cutting
            || self.near(newest.point_mm, newest.point_mm, vertex.point_mm);
        let fits = same_kind
            && self.open.len() < MAX_SPAN
            && self
                .open
                .iter()
                .all(|v| self.near(start.point_mm, vertex.point_mm, v.point_mm));
        if !fits {
            self.vertices.push(newest);
            self.open.clear();
        }
        self.open.push(vertex);
    }

    /// Returns true if `p` is within the tolerance of the chord from `a` to `b`.
    fn near(&self, a: [f64; 3], b: [f64; 3], p: [f64; 3]) -> bool {
        let (chord, to_p) = (sub(b, a), sub(p, a));
        let length2 = dot(chord, chord);
        let along = if length2 > 0.0 {
            (dot(to_p, chord) / length2).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let away = add_scaled(to_p, -along, chord);
        dot(away, away) <= self.tolerance_mm * self.tolerance_mm
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_stay_and_straight_lines_thin_out() {
        let mut outline = OutlineBuilder::default();
        for k in 0..=100_i32 {
            let d = 0.1 * f64::from(k);
            let point_mm = if k <= 50 {
                [d, 0.0, 0.0]
            } else {
                [5.0, d - 5.0, 0.0]
            };
            outline.push(Vertex {
                point_mm,
                cutting: true,
            });
        }
        let vertices: Vec<_> = outline.vertices().map(|v| v.point_mm).collect();
        assert!(vertices.contains(&[5.0, 0.0, 0.0]), "{vertices:?}");
        assert!(vertices.len() < 10, "{}", vertices.len());
    }

    #[test]
    fn a_long_path_stays_bounded_and_true() {
        let mut outline = OutlineBuilder::default();
        // A rosette: curved everywhere, so that nothing thins out for free.
        let at = |k: u32| {
            let a = f64::from(k) * 2e-3;
            [50.0 * libm::cos(1.01 * a), 50.0 * libm::sin(a), 0.0]
        };
        for k in 0..200_000 {
            outline.push(Vertex {
                point_mm: at(k),
                cutting: true,
            });
        }
        assert!(outline.vertices().count() <= MAX_VERTICES + 1);
        let vertices: Vec<_> = outline.vertices().map(|v| v.point_mm).collect();
        // Thinned again and again, with tolerances that add up to less than twice the last.
        outline.tolerance_mm *= 2.0;
        let mut i = 0;
        for k in 0..200_000 {
            let p = at(k);
            while i + 1 < vertices.len()
                && vertices[i] != p
                && !outline.near(vertices[i], vertices[i + 1], p)
            {
                i += 1;
            }
            assert!(
                i + 1 < vertices.len() || vertices[i] == p,
                "point {k} is off the outline"
            );
        }
        assert!(outline.tolerance_mm < 0.02, "{}", outline.tolerance_mm);
    }

    #[test]
    fn endless_changes_between_rapid_and_cut_stay_bounded() {
        let mut outline = OutlineBuilder::default();
        for k in 0..100_000_u32 {
            let (hole, depth) = (f64::from(k / 2), f64::from(k % 2));
            outline.push(Vertex {
                point_mm: [hole, 0.0, depth],
                cutting: k % 2 == 0,
            });
        }
        assert!(outline.vertices().count() <= MAX_VERTICES + 1);
    }
}
