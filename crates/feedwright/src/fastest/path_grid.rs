//! The programmed path at evenly spaced places: its tangent, and the turn of the tangent.

use feedwright_plan::vector::{add_scaled, scale, sub};
use feedwright_plan::{Step, Steps};

/// Largest number of places: a path that has more gets twice the spacing.
const MOST: usize = 1 << 20;

/// Tangents at evenly spaced places.
#[derive(Debug, Default)]
pub(super) struct PathGrid {
    pub(super) spacing_mm: f64,
    tangents: Vec<[f64; 3]>,
}

impl PathGrid {
    /// Samples a path, as far as it can be read. If it ends early, the cut reports the reason.
    pub(super) fn of(steps: Steps<'_>, mut spacing_mm: f64) -> Self {
        let mut tangents: Vec<[f64; 3]> = Vec::new();
        let mut last = [0.0; 3];
        for piece in steps.map_while(Result::ok) {
            let Step::Piece(piece) = piece else { continue };
            let until_mm = piece.s_mm + piece.length_mm;
            while tangents.len() as f64 * spacing_mm < until_mm {
                let local_mm = tangents.len() as f64 * spacing_mm - piece.s_mm;
                tangents.push(piece.curve.at(local_mm.max(0.0)).tangent);
                if tangents.len() == MOST {
                    tangents = tangents.into_iter().step_by(2).collect();
                    spacing_mm *= 2.0;
                }
            }
            last = piece.curve.at(piece.length_mm).tangent;
        }
        tangents.push(last);
        Self {
            spacing_mm,
            tangents,
        }
    }

    /// Returns the number of places: the last is at the end of the path or after it.
    pub(super) const fn len(&self) -> usize {
        self.tangents.len()
    }

    /// Returns the acceleration at a place, `a = t (v^2)' / 2 + t' v^2`, as factors on the squares
    /// of the speeds at the place before, at the place itself, and after it.
    pub(super) fn acceleration(&self, i: usize) -> [[f64; 3]; 3] {
        let (lo, hi) = (i.saturating_sub(1), (i + 1).min(self.len() - 1));
        let way_mm = (hi - lo).max(1) as f64 * self.spacing_mm;
        let turn = scale(1.0 / way_mm, sub(self.tangents[hi], self.tangents[lo]));
        let along = scale(0.5 / way_mm, self.tangents[i]);
        let mut parts = [[0.0; 3], turn, [0.0; 3]];
        parts[lo + 1 - i] = add_scaled(parts[lo + 1 - i], -1.0, along);
        parts[hi + 1 - i] = add_scaled(parts[hi + 1 - i], 1.0, along);
        parts
    }
}

#[cfg(test)]
mod tests {
    use feedwright_gcode::{Reader, Settings};
    use feedwright_plan::vector::norm;
    use feedwright_sim::path_steps;

    use super::*;

    #[test]
    fn acceleration_agrees_with_a_circle_at_a_speed_that_rises() {
        let circle = Reader::from_text(
            "circle.ngc",
            "G17 G21 G90 G61 F600\nG2 X0 Y0 I10 J0\nM2\n",
            Settings::default(),
        );
        let grid = PathGrid::of(path_steps(circle.unwrap().map(Result::unwrap)), 0.1);
        assert_eq!(grid.len(), 630, "63 mm and the end");
        // v^2 = 100 + 40 s: 20 mm/s2 along the path, and v^2 / 10 mm across it.
        let square = |i: usize| 100.0 + 40.0 * 0.1 * i as f64;
        for i in [1, 50, 300] {
            let parts = grid.acceleration(i);
            let accel = (0..3).fold([0.0; 3], |sum, part| {
                add_scaled(sum, square(i + part - 1), parts[part])
            });
            let expected = libm::hypot(20.0, 0.1 * square(i));
            assert!(
                (norm(accel) / expected - 1.0).abs() < 1e-3,
                "{accel:?} {expected}"
            );
        }
    }
}
