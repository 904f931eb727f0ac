//! Errors and time of each stretch in a cut.

use std::ops::Range;

use crate::report::harm::MAX_UM;

use feedwright_plan::vector::{angle, dot, norm, sub};
use feedwright_sim::Commanded;

use super::exported::CutRow;
use super::stretches::{CORNER_RAD, SmoothStretch};

/// Weight of the largest error relative to the RMS.
const MAX_WEIGHT: f64 = 0.3;
/// Time before and after the end of a stretch in which the tool may overshoot it, s.
const AROUND_END_S: f64 = 0.02;

/// Standard deviations that a gain must exceed: a normal value is then negative with 5 %
/// probability.
const CERTAIN: f64 = 1.645;

/// Errors and time of a stretch in a cut.
#[derive(Debug, Clone, Default)]
pub(super) struct StretchCut {
    /// Rows in which the stretch is commanded.
    pub(super) rows: Range<usize>,
    /// Errors of those rows, and of the rows after them until the next stretch begins.
    pub(super) square_sum_mm2: f64,
    pub(super) max_mm: f64,
    /// The row with the largest error.
    pub(super) max_row: usize,
    /// Rows that cut.
    pub(super) cutting: u32,
    /// Servo periods of the command.
    pub(super) periods: u32,
}

impl StretchCut {
    /// Returns the RMS of its errors, mm.
    pub(super) fn rms_mm(&self) -> f64 {
        if self.cutting == 0 {
            0.0
        } else {
            (self.square_sum_mm2 / f64::from(self.cutting)).sqrt()
        }
    }

    /// Returns the error figure of the stretch: RMS plus weighted largest error, mm.
    pub(super) fn figure_mm(&self) -> f64 {
        self.rms_mm() + MAX_WEIGHT * self.max_mm
    }

    /// Combines several stretches into one; only its errors are meaningful.
    pub(super) fn together<'a>(cuts: impl IntoIterator<Item = &'a Self>) -> Self {
        cuts.into_iter().fold(Self::default(), |all, cut| Self {
            square_sum_mm2: all.square_sum_mm2 + cut.square_sum_mm2,
            max_mm: all.max_mm.max(cut.max_mm),
            cutting: all.cutting + cut.cutting,
            ..all
        })
    }
}

/// Returns the distance by which the tool overshoots the end of a stretch, mm.
pub(super) fn overshoot_mm(
    rows: &[CutRow],
    cut: &StretchCut,
    stretch: &SmoothStretch,
    servo_s: f64,
) -> f64 {
    let around = (AROUND_END_S / servo_s) as usize;
    let [_, direction] = stretch.directions();
    let from = cut.rows.end.saturating_sub(around).max(cut.rows.start);
    let near = &rows[from..(cut.rows.end + around).min(rows.len())];
    near.iter()
        .map(|row| -dot(row.error_mm, direction))
        .fold(0.0, f64::max)
}

/// Returns the distance by which the tool overshoots the end of the rapid that leads to a stretch,
/// mm.
pub(super) fn rapid_overshoot_mm(
    rows: &[CutRow],
    cut: &StretchCut,
    stretch: &SmoothStretch,
    servo_s: f64,
) -> f64 {
    let Some((_, rapid)) = &stretch.rapid else {
        return 0.0;
    };
    let way = sub(rapid.end_mm, rapid.start_mm);
    let to = cut.rows.start + (AROUND_END_S / servo_s) as usize;
    let from = rows[..cut.rows.start]
        .iter()
        .rposition(|row| row.commanded == Commanded::Rapid)
        .unwrap_or(0);
    let near = &rows[from..to.min(rows.len())];
    let [goes_on, _] = stretch.directions();
    let over_mm = |row: &CutRow| {
        let along_mm = dot(row.error_mm, way) / norm(way);
        // Where the stretch goes on in the same direction, the foot runs ahead with the tool and
        // stays there when the tool comes back.
        if angle(way, goes_on) < CORNER_RAD {
            along_mm.abs()
        } else {
            -along_mm
        }
    };
    near.iter().map(over_mm).fold(0.0, f64::max)
}

/// Returns rows and errors of each stretch. Rows after the end of its command count for it until
/// the next stretch begins. Rows at the end of a rapid count for the stretch that the rapid leads
/// to. Errors in a lead do not count for the stretches of `own`.
pub(super) fn by_stretch(rows: &[CutRow], count: usize, own: &Range<usize>) -> Vec<StretchCut> {
    let mut cuts = vec![StretchCut::default(); count];
    let (mut last, mut behind_rapid) = (None, None);
    let counts = |row: &CutRow, number: Option<usize>| {
        row.own || number.is_none_or(|number| !own.contains(&number))
    };
    for (n, row) in rows.iter().enumerate() {
        match row.commanded {
            Commanded::Cut => {
                let number = (row.line as usize).checked_sub(1);
                if let Some(cut) = number.and_then(|number| cuts.get_mut(number)) {
                    let from = if cut.rows.is_empty() {
                        n
                    } else {
                        cut.rows.start
                    };
                    cut.rows = from..n + 1;
                    cut.periods += 1;
                    if let Some(from) = behind_rapid.take() {
                        (from..n)
                            .filter(|&n| counts(&rows[n], number))
                            .for_each(|n| cut.take(n, &rows[n]));
                    }
                }
                last = number;
            }
            Commanded::Rapid => (last, behind_rapid) = (None, Some(n)),
            Commanded::Rest => {}
        }
        if let Some(cut) = last
            .filter(|_| counts(row, last))
            .and_then(|last| cuts.get_mut(last))
        {
            cut.take(n, row);
        }
    }
    cuts
}

impl StretchCut {
    /// Takes in the error of a row.
    fn take(&mut self, n: usize, row: &CutRow) {
        if row.cutting {
            let error_mm = norm(row.error_mm);
            self.square_sum_mm2 += error_mm * error_mm;
            if error_mm > self.max_mm {
                (self.max_mm, self.max_row) = (error_mm, n);
            }
            self.cutting += 1;
        }
    }
}

/// Gain of a command in a stretch on one machine.
#[derive(Debug, Clone, Copy)]
pub(super) struct StretchGain {
    /// Reduction of the mean square of the errors, mm2.
    square_mm2: f64,
    /// Distance of the largest error below the limit at which it counts as worse, mm.
    max_mm: f64,
}

impl StretchGain {
    /// Computes the gain from the cuts of the programmed command and of another command.
    pub(super) fn new(was: &StretchCut, is: &StretchCut) -> Self {
        let square = |cut: &StretchCut| cut.rms_mm() * cut.rms_mm();
        Self {
            square_mm2: square(was) - square(is),
            max_mm: was.max_mm + 1e-3 * MAX_UM - is.max_mm,
        }
    }

    pub(super) const fn is_loss(&self) -> bool {
        self.square_mm2 < 0.0 || self.max_mm < 0.0
    }

    /// Means over machines, in standard deviations.
    pub(super) fn certainty(all: &[Self]) -> [f64; 2] {
        let of = |value: fn(&Self) -> f64| {
            let count = all.len() as f64;
            let mean = all.iter().map(value).sum::<f64>() / count;
            let variance = all
                .iter()
                .map(|gain| (value(gain) - mean).powi(2))
                .sum::<f64>()
                / count;
            mean / variance.sqrt().max(1e-12)
        };
        [of(|gain| gain.square_mm2), of(|gain| gain.max_mm)]
    }

    /// Returns true if the gain over all machines exceeds its standard deviation by enough to make
    /// a loss unlikely.
    pub(super) fn is_certain(all: &[Self]) -> bool {
        Self::certainty(all)
            .iter()
            .all(|certainty| *certainty > CERTAIN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_counts_where_it_is_larger_than_its_deviation_over_machines_allows() {
        let gain = |square_mm2: f64, max_mm: f64| StretchGain { square_mm2, max_mm };
        // Mean 2 and standard deviation 1: 2 of them.
        assert!(StretchGain::is_certain(&[gain(1.0, 1.0), gain(3.0, 1.0)]));
        // Mean 1.5 and standard deviation 1.
        assert!(!StretchGain::is_certain(&[gain(0.5, 1.0), gain(2.5, 1.0)]));
        assert!(!StretchGain::is_certain(&[gain(1.0, -1.0), gain(3.0, 1.0)]));
        assert!(
            gain(1.0, -1.0).is_loss() && gain(-1.0, 1.0).is_loss() && !gain(1.0, 1.0).is_loss()
        );
    }
}
