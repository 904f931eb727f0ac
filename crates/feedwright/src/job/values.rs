//! Which values a job takes.

use super::{Job, JobError};

/// A tolerance of a metre is a mistaken unit.
const MAX_TOLERANCE_UM: f64 = 1e6;

impl Job {
    /// Refuses values out of range, and what cannot be had together.
    pub(super) fn check_values(&self) -> Result<(), JobError> {
        let positive = |value: &f64, limit: f64| *value > 0.0 && *value <= limit;
        // A feed that the machine lowers to its limit is not the feed that was asked for.
        let most_mm_s = self.machine.limits.max_feed_mm_s;
        if let Some(value) = self.feed_mm_s.filter(|feed| !positive(feed, most_mm_s)) {
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
        if let Some(value) = self
            .tolerance_um
            .filter(|tolerance| !positive(tolerance, MAX_TOLERANCE_UM))
        {
            let bounds = format!("above 0 and up to {MAX_TOLERANCE_UM} um");
            let hint = Some("the unit is um: 0.01 mm is --tolerance 10");
            return Err(JobError::Value {
                name: "--tolerance",
                value,
                unit: " um",
                bounds,
                hint,
            });
        }
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
