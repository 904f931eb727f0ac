//! Limits that bind along the path: a record of bounded size of the motion along its path.
//!
//! Samples are gathered in stretches of equal time. When 2000 of them are full, neighbors merge in
//! pairs and each takes twice the time.

use serde::Serialize;

/// Largest number of stretches: a pixel each on a wide screen. Even, so that a full record merges
/// without a remainder.
const MOST: usize = 2000;

/// Initial time of a stretch, s.
const FIRST_S: f64 = 1e-3;

/// Number of limits: feedrate, tolerance, velocity, acceleration and jerk of three axes, and
/// acceleration along the path, across it, and corners.
pub const LIMITS: usize = 14;

/// A stretch of the motion.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct BindingStretch {
    /// Duration of the stretch, s; rests are left out.
    pub duration_s: f64,
    /// Arc length of the programmed path at its end, mm.
    pub to_mm: f64,
    /// Way of the tool in the stretch, mm.
    pub way_mm: f64,
    /// Lines of the program at its start and its end.
    pub lines: [u32; 2],
    /// Time in which each limit binds, s, in the order of [`super::limit_names`].
    pub bound_s: [f64; LIMITS],
}

impl BindingStretch {
    /// Merges this stretch with the next one.
    #[must_use]
    pub fn merged(&self, next: &Self) -> Self {
        Self {
            duration_s: self.duration_s + next.duration_s,
            to_mm: next.to_mm,
            way_mm: self.way_mm + next.way_mm,
            lines: [self.lines[0], next.lines[1]],
            bound_s: std::array::from_fn(|i| self.bound_s[i] + next.bound_s[i]),
        }
    }

    /// Returns the limit that binds for the longest time, if any binds.
    pub fn longest(&self) -> Option<usize> {
        let longest = (0..LIMITS).max_by(|&a, &b| self.bound_s[a].total_cmp(&self.bound_s[b]));
        longest.filter(|&limit| self.bound_s[limit] > 0.0)
    }
}

/// The stretches of a motion in order.
#[derive(Debug, Clone, PartialEq)]
pub struct BindingAlong {
    stretches: Vec<BindingStretch>,
    stretch_s: f64,
}

impl Default for BindingAlong {
    fn default() -> Self {
        Self {
            stretches: Vec::new(),
            stretch_s: FIRST_S,
        }
    }
}

impl BindingAlong {
    /// Returns the stretches in the order of time.
    pub fn stretches(&self) -> &[BindingStretch] {
        &self.stretches
    }

    /// Returns the stretches, merged into at most `parts` of about equal time.
    pub fn in_parts(&self, parts: usize) -> Vec<BindingStretch> {
        let each = self.stretches.len().div_ceil(parts.max(1)).max(1);
        let merged = |chunk: &[BindingStretch]| {
            chunk
                .iter()
                .skip(1)
                .fold(chunk[0], |before, next| before.merged(next))
        };
        self.stretches.chunks(each).map(merged).collect()
    }

    /// Adds a sample after the earlier ones.
    pub fn push(&mut self, sample: &BindingStretch) {
        match self.stretches.last_mut() {
            Some(last) if last.duration_s + 0.5 * sample.duration_s < self.stretch_s => {
                *last = last.merged(sample);
            }
            _ => {
                if self.stretches.len() == MOST {
                    self.stretches = self
                        .stretches
                        .chunks_exact(2)
                        .map(|pair| pair[0].merged(&pair[1]))
                        .collect();
                    self.stretch_s *= 2.0;
                }
                self.stretches.push(*sample);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_lost_where_stretches_merge() {
        let mut along = BindingAlong::default();
        let samples = 70_000;
        for i in 0..samples {
            let mut sample = BindingStretch {
                duration_s: 1e-4,
                to_mm: 0.01 * f64::from(i + 1),
                way_mm: 0.01,
                lines: [i, i],
                ..BindingStretch::default()
            };
            sample.bound_s[usize::from(i >= samples / 2)] = 1e-4;
            along.push(&sample);
        }
        let count = along.stretches().len();
        assert!(count > MOST / 4 && count <= MOST, "{count}");
        let halves = along.in_parts(2);
        assert_eq!(halves.len(), 2);
        assert_eq!(
            halves.iter().map(|half| half.longest()).collect::<Vec<_>>(),
            [Some(0), Some(1)]
        );
        let time_s: f64 = along
            .stretches()
            .iter()
            .map(|stretch| stretch.duration_s)
            .sum();
        assert!((time_s - 7.0).abs() < 1e-9, "{time_s}");
        assert_eq!((halves[0].lines[0], halves[1].lines[1]), (0, samples - 1));
    }
}
