//! The model of a job that has none: from a log of its machine.

use std::borrow::Cow;

use feedwright_control::IdentifierKind;
use feedwright_sim::Watch;

use super::{CheckedJob, Job, JobError};
use crate::recorded_model::recorded_model;

impl CheckedJob<'_> {
    /// The job with the model from the log, and what the log does not determine well enough, in
    /// words.
    pub(super) fn with_model(
        &self,
        watch: &dyn Watch,
    ) -> Result<(Cow<'_, Job>, Vec<String>), JobError> {
        let job = &*self.job;
        let uses_log = job.controller.identifier == Some(IdentifierKind::Axes)
            && !job.request.exact_settings
            && job.model.is_none();
        let fitting = job.request.band.into();
        let found = uses_log.then(|| {
            let (entry, date) = ((job.controller, &job.choices), job.today.clone());
            recorded_model(&job.recorder, self.axes, entry, date, fitting, watch)
        });
        let Some(found) = found.transpose()? else {
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
