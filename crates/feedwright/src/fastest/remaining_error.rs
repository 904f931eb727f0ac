//! Errors that a lower speed does not reduce: noise, friction, geometry.
//!
//! An error of the servo loop falls with the speed, in proportion to it or faster. Let it be e1 in
//! one cut, and e2 in another that is slower there by the factor r. A line through both leaves
//! `n = (e2 - r e1) / (1 - r)` at rest, which is zero or negative for an error of the servo loop.
//! Some errors are as large as they can get: a tool is no further from a small circle than its
//! radius. They do not fall at first, so one comparison is not enough.

use super::cut_places::{CutPlace, CutPlaces};

/// Largest speed ratio r of two cuts that are compared.
const SLOWER: f64 = 0.5;

/// Time before and after a place within which the speed may cause an error at that place, s: as
/// long as a servo loop remembers.
const AROUND_S: f64 = 0.03;

/// No speed helps if more than [`LEFT`] tolerances remain at rest in [`IN_A_ROW`] comparisons of
/// one place in a row. The largest of many noise values differs from cut to cut. It does not come
/// out larger three times in a row while the speed falls to an eighth.
const LEFT: f64 = 1.25;
const IN_A_ROW: u32 = 3;

/// Reference for later cuts, place by place.
#[derive(Debug, Default)]
pub(super) struct RemainingError {
    places: Vec<ComparedPlace>,
}

/// A place at its last comparison.
#[derive(Debug, Clone, Copy)]
struct ComparedPlace {
    speed_mm_s: f64,
    error_mm: f64,
    /// Number of successive comparisons with too much remaining error.
    in_a_row: u32,
}

impl RemainingError {
    /// Adds a cut. Returns true if speed no longer matters at some place.
    pub(super) fn take_in(&mut self, cut: &CutPlaces, tolerance_mm: f64) -> bool {
        let place_of = |place: &CutPlace, in_a_row: u32| ComparedPlace {
            speed_mm_s: place.speed_mm_s,
            error_mm: place.error_mm,
            in_a_row,
        };
        if self.places.is_empty() {
            self.places = cut.places.iter().map(|place| place_of(place, 0)).collect();
        }
        let compared: Vec<_> = cut
            .places
            .iter()
            .enumerate()
            .map(|(i, place)| (place, self.left_mm(cut, i, tolerance_mm)))
            .collect();
        for (before, (place, left_mm)) in self.places.iter_mut().zip(compared) {
            if let Some(left_mm) = left_mm {
                *before = place_of(
                    place,
                    if left_mm > LEFT * tolerance_mm {
                        before.in_a_row + 1
                    } else {
                        0
                    },
                );
            }
        }
        self.places.iter().any(|place| place.in_a_row >= IN_A_ROW)
    }

    /// Returns n at a place that is out of tolerance and slower, mm.
    fn left_mm(&self, cut: &CutPlaces, i: usize, tolerance_mm: f64) -> Option<f64> {
        let (now, before) = (&cut.places[i], &self.places[i]);
        if now.error_mm <= tolerance_mm || now.speed_mm_s > SLOWER * before.speed_mm_s {
            return None;
        }
        let around = (AROUND_S * before.speed_mm_s / cut.spacing_mm).ceil() as usize;
        let near = i.saturating_sub(around)..(i + around + 1).min(cut.places.len());
        let pairs = cut.places[near.clone()].iter().zip(&self.places[near]);
        let [r, e1, e2] = pairs.fold([0.0_f64; 3], |[r, e1, e2], (now, before)| {
            [
                r.max(now.speed_mm_s / before.speed_mm_s),
                e1.max(before.error_mm),
                e2.max(now.error_mm),
            ]
        });
        (r <= SLOWER).then(|| (e2 - r * e1) / (1.0 - r))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE_MM: f64 = 0.01;

    /// Returns true if speed no longer matters after four cuts, each slower than the one before by
    /// the factor `slower`.
    fn given_up(slower: f64, error_mm: impl Fn(f64) -> f64) -> bool {
        let mut remaining = RemainingError::default();
        (0..4)
            .map(|cut| 50.0 / slower.powi(cut))
            .fold(false, |_, speed_mm_s| {
                let mut cut = CutPlaces::new(0.1, 100);
                for place in &mut cut.places {
                    (place.speed_mm_s, place.error_mm) = (speed_mm_s, error_mm(speed_mm_s));
                }
                remaining.take_in(&cut, TOLERANCE_MM)
            })
    }

    #[test]
    fn what_falls_with_the_speed_is_not_given_up_and_what_stays_is() {
        assert!(!given_up(2.0, |v| 0.01 * v), "in proportion");
        assert!(!given_up(3.0, |v| 1e-3 * v * v), "with its square");
        assert!(
            !given_up(4.0, |v| (0.01 * v).min(0.3)),
            "as large as it gets in the first cut"
        );
        assert!(
            given_up(2.0, |v| 0.013 + 0.01 * v),
            "1.3 tolerances at rest"
        );
        assert!(!given_up(2.0, |v| 0.012 + 0.01 * v), "less than that");
        assert!(!given_up(1.5, |_| 0.1), "what has not been tried slowly");
    }
}
