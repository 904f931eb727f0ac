//! Which values a job takes.

use super::{Job, JobError};

/// A tolerance of a metre is a mistaken unit.
const MAX_TOLERANCE_UM: f64 = 1e6;

const fn is_positive(value: f64, most: f64) -> bool {
    value > 0.0 && value <= most
}

/// Refuses a tolerance that is not above 0 or looks like another unit.
pub(crate) fn check_tolerance(tolerance_um: Option<f64>) -> Result<(), JobError> {
    let Some(value) = tolerance_um.filter(|value| !is_positive(*value, MAX_TOLERANCE_UM)) else {
        return Ok(());
    };
    let bounds = format!("above 0 and up to {MAX_TOLERANCE_UM} um");
    let hint = Some("the unit is um: 0.01 mm is --tolerance 10");
    Err(JobError::Value {
        name: "--tolerance",
        value,
        unit: " um",
        bounds,
        hint,
    })
}

impl Job {
    /// Refuses values out of range, and what cannot be had together.
    pub(super) fn check_values(&self) -> Result<(), JobError> {
        // A feed that the machine lowers to its limit is not the feed that was asked for.
        let most_mm_s = self.machine.limits.max_feed_mm_s;
        if let Some(value) = self.feed_mm_s.filter(|feed| !is_positive(*feed, most_mm_s)) {
            let bounds = format!("above 0 and up to {most_mm_s} mm/s, the machine's max_feed_mm_s");
            let hint = Some("F3000 in a program is --feed 3000mm/min, or 50mm/s");
            return Err(JobError::Value {
                name: "--feed",
                value,
                unit: " mm/s",
                bounds,
                hint,
            });
        }
        check_tolerance(self.tolerance_um)?;
        if self.target.is_some() {
            let other = self
                .fastest
                .then_some("--fastest")
                .or_else(|| self.reference.as_ref().map(|_| "--reference"));
            if let Some(option) = other {
                return Err(JobError::NoProgramWith { option });
            }
        }
        Ok(())
    }
}
