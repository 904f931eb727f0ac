//! Which values a job takes.

use super::{Job, JobError};

impl Job {
    /// Refuses values out of range, and what cannot be had together.
    pub(super) fn check_values(&self) -> Result<(), JobError> {
        // A feed that the machine lowers to its limit is not the feed that was asked for.
        let most_mm_s = self.machine.limits.max_feed_mm_s;
        let in_range = |feed: &f64| *feed > 0.0 && *feed <= most_mm_s;
        if let Some(value) = self.request.feed_mm_s.filter(|feed| !in_range(feed)) {
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
        self.request.check_tolerance()?;
        if self.target.is_some() {
            let other = self
                .request
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
