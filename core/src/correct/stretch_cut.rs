//! What each stretch comes to in a cut.

use std::ops::Range;

use super::exported::CutRow;
use super::stretches::SmoothStretch;
use crate::vector::{dot, norm};

/// Weight of the largest error beside the RMS.
const MAX_WEIGHT: f64 = 0.3;
/// How long before and behind the end of a stretch the tool may run over it, s.
const AROUND_END_S: f64 = 0.02;

/// What a stretch came to in a cut.
#[derive(Debug, Clone, Default)]
pub(super) struct StretchCut {
    /// Rows in which the stretch is commanded.
    pub(super) rows: Range<usize>,
    /// Errors of those rows, and of those behind until the next stretch begins.
    pub(super) square_sum_mm2: f64,
    pub(super) max_mm: f64,
    /// Rows that cut.
    pub(super) cutting: u32,
    /// Servo periods of the command.
    pub(super) periods: u32,
}

impl StretchCut {
    /// One figure of it, mm.
    pub(super) fn figure_mm(&self) -> f64 {
        let rms_mm = if self.cutting == 0 { 0.0 } else { (self.square_sum_mm2 / f64::from(self.cutting)).sqrt() };
        rms_mm + MAX_WEIGHT * self.max_mm
    }
}

/// How far the tool runs over the end of a stretch, mm.
pub(super) fn overshoot_mm(rows: &[CutRow], cut: &StretchCut, stretch: &SmoothStretch, servo_s: f64) -> f64 {
    let around = (AROUND_END_S / servo_s) as usize;
    let [_, direction] = stretch.directions();
    let from = cut.rows.end.saturating_sub(around).max(cut.rows.start);
    let near = &rows[from..(cut.rows.end + around).min(rows.len())];
    near.iter().map(|row| -dot(row.error_mm, direction)).fold(0.0, f64::max)
}

/// Rows and errors of each stretch; what the tool still does when the command has gone on belongs to it, until the next begins.
pub(super) fn by_stretch(rows: &[CutRow], count: usize) -> Vec<StretchCut> {
    let mut cuts = vec![StretchCut::default(); count];
    let mut last = None;
    for (n, row) in rows.iter().enumerate() {
        if row.moves {
            last = (row.line as usize).checked_sub(1);
            if let Some(cut) = last.and_then(|last| cuts.get_mut(last)) {
                let from = if cut.rows.is_empty() { n } else { cut.rows.start };
                cut.rows = from..n + 1;
            }
        }
        let Some(cut) = last.and_then(|last| cuts.get_mut(last)) else { continue };
        if row.moves {
            cut.periods += 1;
        }
        if row.cutting {
            let error_mm = norm(row.error_mm);
            cut.square_sum_mm2 += error_mm * error_mm;
            cut.max_mm = cut.max_mm.max(error_mm);
            cut.cutting += 1;
        }
    }
    cuts
}
