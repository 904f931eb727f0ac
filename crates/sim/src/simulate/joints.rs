//! Contour error by the encoders: the error of the joints, with the tool where the control's
//! geometry puts it.
//!
//! It is measured in the same way as the error of the tool, with its own foot, over the same servo
//! periods. The rest of the tool's error is geometry that the control does not know.

use feedwright_plan::vector::Vector;

use super::foot::FootTracker;
use crate::machine::Machine;
use crate::reference::Reference;
use crate::row::Row;

/// Contour error by the encoders over the servo periods that cut, mm.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointError {
    /// Root mean square; 0 where nothing cuts.
    pub rms_mm: f64,
    /// Largest.
    pub max_mm: f64,
}

/// Measures it, servo period by servo period.
pub(super) struct JointErrorMeter {
    foot: FootTracker,
    square_sum_mm2: f64,
    max_mm: f64,
    rows: u64,
}

impl JointErrorMeter {
    /// Starts at rest at the start of the path.
    pub(super) fn new(machine: &Machine, start_mm: Vector) -> Self {
        Self {
            foot: FootTracker::new(machine, start_mm),
            square_sum_mm2: 0.0,
            max_mm: 0.0,
            rows: 0,
        }
    }

    /// The tool by the joints at the end of the servo period of a row that begins with the
    /// reference at `tau_s`.
    pub(super) fn row(
        &mut self,
        reference: &mut Reference<'_>,
        tau_s: f64,
        by_joints_mm: Vector,
        row: &Row,
    ) {
        let error_mm = self
            .foot
            .foot(reference, tau_s, row.s_mm, by_joints_mm)
            .distance_mm;
        if row.cutting {
            self.square_sum_mm2 += error_mm * error_mm;
            self.max_mm = self.max_mm.max(error_mm);
            self.rows += 1;
        }
    }

    pub(super) fn finish(&self) -> JointError {
        let rms_mm = if self.rows == 0 {
            0.0
        } else {
            (self.square_sum_mm2 / self.rows as f64).sqrt()
        };
        JointError {
            rms_mm,
            max_mm: self.max_mm,
        }
    }
}
