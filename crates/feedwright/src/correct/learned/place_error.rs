//! Carries learned errors over from the samples of a record to the samples of another command along
//! the same path.
//!
//! Samples correspond if the command has come equally far along the programmed path; in a rest, if
//! they are equally long after its start. The error of a model depends on how the command moves, so
//! it is carried over only as far as both commands move alike: with the commanded speeds `u` and
//! `v`, the factor is
//!
//! ```text
//! 1 / (1 + (|u - v| / (0.2 max(|u|, |v|)))^2)
//! ```

use feedwright_plan::vector::{Vector, distance, norm, sub};

use super::model_fit::at;

/// Relative difference of speed at which commands count as half alike.
const ALIKE: f64 = 0.2;
/// Smallest reference speed for a comparison of speeds, mm/s.
const LEAST_MM_S: f64 = 1.0;
/// A command that moves less than this in a sample rests, mm; and tolerance for the arc lengths of
/// one rest, mm.
const RESTS_MM: f64 = 1e-6;
const SAME_MM: f64 = 5e-3;

/// A command along the programmed path.
#[derive(Debug, Clone, Default)]
pub(in crate::correct) struct PathTrack {
    /// Time between samples, s.
    pub(in crate::correct) sample_s: f64,
    /// Arc length along the programmed path, never falling, mm.
    pub(in crate::correct) s_mm: Vec<f64>,
    /// Command, mm.
    pub(in crate::correct) command_mm: Vec<Vector>,
}

impl PathTrack {
    fn speed_mm_s(&self, k: usize) -> Vector {
        let [before, after] = [k.saturating_sub(1), (k + 1).min(self.command_mm.len() - 1)];
        let time_s = (after - before).max(1) as f64 * self.sample_s;
        sub(self.command_mm[after], self.command_mm[before]).map(|way_mm| way_mm / time_s)
    }

    fn rests(&self, k: usize) -> bool {
        k > 0 && distance(self.command_mm[k], self.command_mm[k - 1]) < RESTS_MM
    }

    /// Returns the first sample at an arc length, and the number of samples there.
    fn samples_at(&self, s_mm: f64) -> [usize; 2] {
        let [first, end] =
            [s_mm - SAME_MM, s_mm + SAME_MM].map(|s_mm| self.s_mm.partition_point(|s| *s < s_mm));
        // If some of the near samples are at rest, only these count.
        let rest = (first..end).find(|&k| self.rests(k));
        let [first, end] = rest.map_or([first, first], |rest| {
            [
                rest,
                (rest..end)
                    .rev()
                    .find(|&k| self.rests(k))
                    .map_or(rest, |last| last + 1),
            ]
        });
        [first, end - first]
    }

    /// Returns the index in this track of each sample of another track; none before the start of
    /// this track.
    pub(super) fn places_of(&self, other: &Self) -> Vec<Option<f64>> {
        let mut rested = 0.0;
        let place = |k: usize| {
            let s_mm = other.s_mm[k];
            if self.s_mm.first().is_none_or(|first| s_mm < *first) {
                return None;
            }
            rested = if other.rests(k) {
                rested + other.sample_s / self.sample_s
            } else {
                0.0
            };
            if rested > 0.0 {
                let [first, count] = self.samples_at(s_mm);
                return Some(
                    (first as f64 + f64::min(rested, count as f64))
                        .min((self.s_mm.len() - 1) as f64),
                );
            }
            let after = self
                .s_mm
                .partition_point(|s| *s < s_mm)
                .min(self.s_mm.len() - 1);
            let before = after.saturating_sub(1);
            let way_mm = self.s_mm[after] - self.s_mm[before];
            let part = if way_mm > 0.0 {
                ((s_mm - self.s_mm[before]) / way_mm).clamp(0.0, 1.0)
            } else {
                1.0
            };
            Some(before as f64 + part * (after - before) as f64)
        };
        (0..other.s_mm.len()).map(place).collect()
    }
}

/// An error of the model along the path, and the command of its record.
#[derive(Debug, Clone, Default)]
pub struct PlaceError {
    pub(super) track: PathTrack,
    /// Vector from the model's position to the machine's position, sample by sample, mm.
    pub(super) error_mm: Vec<Vector>,
}

impl PlaceError {
    /// Carries the error over to the samples of another command, mm.
    pub(in crate::correct) fn along(&self, other: &PathTrack) -> Vec<Vector> {
        let places = self.track.places_of(other);
        let error = |(k, place): (usize, &Option<f64>)| {
            let Some(place) = place else { return [0.0; 3] };
            let (theirs, ours) = (
                other.speed_mm_s(k),
                self.track.speed_mm_s((*place + 0.5) as usize),
            );
            let apart = norm(sub(theirs, ours)) / norm(theirs).max(norm(ours)).max(LEAST_MM_S);
            let share = 1.0 / (1.0 + (apart / ALIKE).powi(2));
            at(&self.error_mm, *place).map(|error_mm| share * error_mm)
        };
        places.iter().enumerate().map(error).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line along X at a speed, with a rest in the middle.
    fn track(sample_s: f64, speed_mm_s: f64, rest_s: f64) -> PathTrack {
        let half_s = 10.0 / speed_mm_s;
        let samples = ((2.0 * half_s + rest_s) / sample_s).round() as usize;
        let at = |k: usize| {
            let t_s = k as f64 * sample_s;
            speed_mm_s
                * if t_s < half_s {
                    t_s
                } else {
                    half_s + (t_s - half_s - rest_s).max(0.0)
                }
        };
        let s_mm: Vec<f64> = (0..=samples).map(at).collect();
        PathTrack {
            sample_s,
            command_mm: s_mm.iter().map(|s| [*s, 0.0, 0.0]).collect(),
            s_mm,
        }
    }

    #[test]
    fn samples_of_another_clock_and_a_longer_rest_find_their_places() {
        let (slow, fast) = (track(0.002, 50.0, 0.1), track(0.001, 50.0, 0.06));
        let places = slow.places_of(&fast);
        // 0.1 s behind the start, in the rest, and 0.05 s behind the rest.
        for (k, expected) in [(100, 50.0), (230, 115.0), (310, 175.0)] {
            let place = places[k].unwrap();
            assert!(
                (place - expected).abs() <= 1.0,
                "{k}: {place} for {expected}"
            );
        }
    }

    #[test]
    fn an_error_is_carried_over_to_a_command_that_moves_alike_and_not_to_another() {
        let track_50 = track(0.001, 50.0, 0.0);
        let error = PlaceError {
            error_mm: vec![[0.01, -0.02, 0.0]; track_50.s_mm.len()],
            track: track_50,
        };
        let mean = |speed_mm_s: f64| {
            let errors = error.along(&track(0.001, speed_mm_s, 0.0));
            errors.iter().map(|error| error[1]).sum::<f64>() / errors.len() as f64
        };
        assert!(
            (mean(50.0) + 0.02).abs() < 1e-4 && (mean(40.0) + 0.01).abs() < 1e-3,
            "{} {}",
            mean(50.0),
            mean(40.0)
        );
        assert!(mean(10.0) > -0.002, "{}", mean(10.0));
    }
}
