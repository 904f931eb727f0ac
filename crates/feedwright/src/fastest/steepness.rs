//! The steepness of errors over the speed, from one cut to the next.
//!
//! A servo loop alone makes errors that grow with the square q of the speed. A controller that
//! corrects less under a higher load makes errors that grow with a higher power p of q. With p
//! taken as 1, speeds fall much too far and oscillate from cut to cut. For errors near the
//! tolerance, p is the slope of the logarithm of the error over the logarithm of q. A least-squares
//! fit over all places of two cuts gives this slope.

use super::cut_places::CutPlace;

/// A place counts if the larger of its two errors exceeds this fraction of the tolerance, and the
/// logarithm of its q changes by more than [`CHANGED`].
const ERROR_PART: f64 = 0.7;
const CHANGED: f64 = 0.02;

/// Error of a place that has none, as a fraction of the tolerance.
const LEAST_PART: f64 = 0.01;

/// Largest p: beyond it, errors do not follow from the speed at their place.
const MOST: f64 = 6.0;

/// Computes p from two cuts; none if too little has changed.
pub(super) fn steepness(before: &[CutPlace], now: &[CutPlace], tolerance_mm: f64) -> Option<f64> {
    let logarithms = before.iter().zip(now).filter_map(|(before, now)| {
        let counts = before.error_mm.max(now.error_mm) > ERROR_PART * tolerance_mm;
        let of_q = 2.0 * libm::log(now.speed_mm_s / before.speed_mm_s);
        let error = |place: &CutPlace| place.error_mm.max(LEAST_PART * tolerance_mm);
        (counts && of_q.is_finite() && of_q.abs() > CHANGED)
            .then(|| (of_q, libm::log(error(now) / error(before))))
    });
    let [both, square] = logarithms.fold([0.0; 2], |[both, square], (q, e)| {
        [both + q * e, square + q * q]
    });
    (square > 0.0).then(|| (both / square).clamp(1.0, MOST))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE_MM: f64 = 0.01;

    /// A cut at these speeds whose errors grow with the square of the speed to a power, and are the
    /// tolerance at 50 mm/s.
    fn cut(speeds_mm_s: impl Iterator<Item = f64>, power: f64) -> Vec<CutPlace> {
        let error_mm = |speed_mm_s: f64| TOLERANCE_MM * libm::pow(speed_mm_s / 50.0, 2.0 * power);
        speeds_mm_s
            .map(|speed_mm_s| CutPlace {
                speed_mm_s,
                error_mm: error_mm(speed_mm_s),
                ..CutPlace::default()
            })
            .collect()
    }

    #[test]
    fn the_power_of_the_squares_is_found_within_its_bounds() {
        for (power, found) in [(1.0, 1.0), (4.0, 4.0), (0.5, 1.0), (9.0, MOST)] {
            let speeds = |factor: f64| (0..20).map(move |i| factor * (50.0 + f64::from(i)));
            let p = steepness(
                &cut(speeds(1.1), power),
                &cut(speeds(1.0), power),
                TOLERANCE_MM,
            );
            assert!(p.is_some_and(|p| (p - found).abs() < 1e-9), "{p:?} {found}");
        }
    }

    #[test]
    fn where_nothing_changed_or_nothing_is_near_the_tolerance_nothing_is_said() {
        let at = |speed_mm_s: f64| cut(std::iter::repeat_n(speed_mm_s, 5), 1.0);
        assert_eq!(steepness(&at(50.0), &at(50.0), TOLERANCE_MM), None);
        assert_eq!(steepness(&at(30.0), &at(20.0), TOLERANCE_MM), None);
        assert_eq!(steepness(&[], &at(50.0), TOLERANCE_MM), None);
    }
}
