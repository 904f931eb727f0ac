//! The worst places of a run: its largest contour errors, each listed once.
//!
//! A place is a peak of |contour error|. It ends when the error has fallen below [`PEAK_ENDS`]
//! times the peak. The next one begins when the error rises again by the same factor above its
//! least value since then. If a peak is closer than [`APART_MM`] or [`APART_S`] to a larger one,
//! only the larger counts. Memory does not grow with the run.

use feedwright_sim::Row;
use serde::Serialize;

/// Largest number of places in the list.
const PLACES: usize = 10;

/// A peak ends when the error falls to this fraction of it. Closer to 1, ripple on one bump makes
/// many places of it; closer to 0, neighboring corners join.
const PEAK_ENDS: f64 = 0.7;

/// Peaks smaller than this fraction of the largest are not listed: they do not matter for the part.
const MIN_SHARE: f64 = 0.01;

/// Peaks nearer to each other than this along the path are one place, mm.
const APART_MM: f64 = 0.5;

/// Peaks nearer to each other than this in time are one place, s.
const APART_S: f64 = 0.010;

/// One of the largest contour errors of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct WorstPlace {
    /// Contour error, µm, signed as in [`Row`].
    pub error_um: f64,
    /// Line of the program, from 1.
    pub line: u32,
    /// Text of that line.
    pub text: String,
    /// Position of the tool, mm.
    pub(crate) position_mm: [f64; 3],
    /// Time, s.
    pub t_s: f64,
    /// Arc length along the programmed path, mm.
    pub s_mm: f64,
}

#[derive(Debug, Clone, Copy)]
struct Peak {
    error_mm: f64,
    line: u32,
    position_mm: [f64; 3],
    t_s: f64,
    s_mm: f64,
}

/// Trend of the error: rising to a peak, or falling after one.
#[derive(Debug, Clone, Copy)]
enum Trend {
    Rising(Peak),
    Falling { least_mm: f64 },
}

/// Finds the worst places, row by row.
#[derive(Debug, Clone)]
pub(super) struct WorstFinder {
    trend: Trend,
    /// The last peak, which a larger one shortly after may still replace.
    pending: Option<Peak>,
    /// Largest first, at most [`PLACES`].
    found: Vec<Peak>,
}

impl Default for WorstFinder {
    fn default() -> Self {
        Self {
            trend: Trend::Falling { least_mm: 0.0 },
            pending: None,
            found: Vec::new(),
        }
    }
}

impl WorstFinder {
    /// Takes a row that cuts.
    pub(super) fn row(&mut self, row: &Row) {
        let error_mm = row.contour_error_mm.abs();
        match &mut self.trend {
            Trend::Rising(peak) if error_mm > peak.error_mm.abs() => *peak = Peak::of(row),
            Trend::Rising(peak) if error_mm < PEAK_ENDS * peak.error_mm.abs() => {
                let peak = *peak;
                self.trend = Trend::Falling { least_mm: error_mm };
                self.close(peak);
            }
            Trend::Rising(_) => {}
            Trend::Falling { least_mm } if PEAK_ENDS * error_mm > *least_mm => {
                self.trend = Trend::Rising(Peak::of(row));
            }
            Trend::Falling { least_mm } => *least_mm = least_mm.min(error_mm),
        }
    }

    /// Returns the places, largest first; `text` gives the text of a program line.
    pub(super) fn places(&self, mut text: impl FnMut(u32) -> String) -> Vec<WorstPlace> {
        let mut last = self.clone();
        if let Trend::Rising(peak) = last.trend {
            last.close(peak);
        }
        if let Some(peak) = last.pending {
            last.keep(peak);
        }
        let place = |p: &Peak| WorstPlace {
            error_um: p.error_mm * 1e3,
            line: p.line,
            text: text(p.line),
            position_mm: p.position_mm,
            t_s: p.t_s,
            s_mm: p.s_mm,
        };
        let least_mm = last
            .found
            .first()
            .map_or(0.0, |p| MIN_SHARE * p.error_mm.abs());
        last.found
            .iter()
            .filter(|p| p.error_mm.abs() >= least_mm)
            .map(place)
            .collect()
    }

    fn close(&mut self, peak: Peak) {
        match self.pending {
            Some(before) if before.is_near(&peak) => {
                if peak.error_mm.abs() > before.error_mm.abs() {
                    self.pending = Some(peak);
                }
            }
            Some(before) => {
                self.keep(before);
                self.pending = Some(peak);
            }
            None => self.pending = Some(peak),
        }
    }

    fn keep(&mut self, peak: Peak) {
        let rank = self
            .found
            .partition_point(|p| p.error_mm.abs() >= peak.error_mm.abs());
        self.found.insert(rank, peak);
        self.found.truncate(PLACES);
    }
}

impl Peak {
    fn of(row: &Row) -> Self {
        Self {
            error_mm: row.contour_error_mm,
            line: row.line,
            position_mm: row.act_mm,
            t_s: row.t_s,
            s_mm: row.s_mm,
        }
    }

    fn is_near(&self, other: &Self) -> bool {
        (other.s_mm - self.s_mm).abs() < APART_MM || (other.t_s - self.t_s).abs() < APART_S
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::row;

    fn places_of(errors: impl Iterator<Item = f64>, step_mm: f64) -> Vec<WorstPlace> {
        let mut finder = WorstFinder::default();
        for (k, error) in errors.enumerate() {
            let t_s = k as f64 * 1e-3;
            finder.row(&Row {
                contour_error_mm: error,
                s_mm: step_mm * k as f64,
                line: k as u32,
                ..row(t_s)
            });
        }
        finder.places(|line| format!("N{line}"))
    }

    /// Sum of Gaussian bumps 100 rows apart, alternating in sign, the k-th of height k + 1.
    fn bumps(row: u32, count: u32) -> f64 {
        let bump = |k: u32| {
            let x = (f64::from(row) - 100.0 * f64::from(k) - 50.0) / 12.0;
            f64::from(k + 1) * libm::exp(-x * x) * if k.is_multiple_of(2) { 1.0 } else { -1.0 }
        };
        (0..count).map(bump).sum::<f64>() * 1e-3
    }

    #[test]
    fn bumps_are_ranked_by_size() {
        let places = places_of((0..1200).map(|k| bumps(k, 12)), 0.05);
        let lines: Vec<u32> = places.iter().map(|p| p.line).collect();
        assert_eq!(lines, [1150, 1050, 950, 850, 750, 650, 550, 450, 350, 250]);
        assert!(
            (places[0].error_um + 12.0).abs() < 1e-9 && (places[1].error_um - 11.0).abs() < 1e-9,
            "{places:?}"
        );
    }

    #[test]
    fn ripple_on_one_bump_is_one_place() {
        let ripple = |k: u32| bumps(k, 1) * (1.0 + 0.1 * libm::sin(f64::from(k)));
        assert_eq!(places_of((0..100).map(ripple), 1.0).len(), 1);
    }

    #[test]
    fn of_close_peaks_the_larger_counts() {
        let close = [0.0, 3.0, 0.0, 5.0, 0.0, 4.0, 0.0].map(|e| e * 1e-3);
        let places = places_of(close.into_iter(), 0.05);
        assert_eq!(places.len(), 1);
        assert_eq!(places[0].line, 3);
    }

    #[test]
    fn an_error_that_grows_to_the_end_counts_at_the_end() {
        let places = places_of((0..50).map(|k| f64::from(k) * 1e-3), 0.05);
        assert_eq!((places.len(), places[0].line), (1, 49));
    }
}
