//! The model of a job that has none: from a log of its machine.

use std::borrow::Cow;

use feedwright_sim::Watch;

use super::{CheckedJob, Job, JobError};

impl CheckedJob<'_> {
    /// The job with the model from the log, and what the log does not determine well enough, in
    /// words.
    pub(super) fn with_model(
        &self,
        watch: &dyn Watch,
    ) -> Result<(Cow<'_, Job>, Vec<String>), JobError> {
        let job = &*self.job;
        let log = job.model_of_log.as_ref().filter(|_| job.model.is_none());
        let found = log.map(|log| log.model(self.axes, (job.controller, &job.choices), watch));
        let Some(found) = found.transpose()?.flatten() else {
            return Ok((Cow::Borrowed(job), Vec::new()));
        };
        let job = Job {
            model: Some(found.model),
            fitting: found.fitting,
            ..job.clone()
        };
        job.check_model(self.axes)?;
        Ok((Cow::Owned(job), found.warnings))
    }
}
