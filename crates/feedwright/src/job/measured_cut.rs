//! The cut that a log shows.

use feedwright_ident::LogFinding;
use feedwright_sim::{RunError, Sink, Stages, Watch, path_steps};

use super::record::RunRecord;
use super::{Job, JobError};
use crate::measured::{MeasuredLog, MeasuredRun, measured};
use crate::report::{FullCircle, ReportedRun, Role};

impl Job {
    /// Inserts the measured run of a log, if there is one, before the run of the requested
    /// controller. Returns guesses about the log, and remarks on it.
    pub(super) fn insert_measured(
        &self,
        runs: &mut Vec<ReportedRun>,
        axes: usize,
        circles: &[FullCircle],
        watch: &dyn Watch,
    ) -> Result<Vec<LogFinding>, JobError> {
        let Some(MeasuredLog { log, .. }) = self.log.as_deref() else {
            return Ok(Vec::new());
        };
        watch.begin("comparing the log", 1);
        let mut record = RunRecord::new(axes, log.sample_time_s, circles);
        let Some(MeasuredRun { run, findings }) =
            self.measured_run(axes, &mut record.sinks(), watch)?
        else {
            return Ok(Vec::new());
        };
        let run = self.reported(record, (Role::Measured, "measured"), run)?;
        let corrected = runs
            .iter()
            .position(|run| run.summary.role == Role::Corrected);
        runs.insert(corrected.unwrap_or(runs.len()), run);
        Ok([log.findings.clone(), findings].concat())
    }

    /// The cut that the log shows, where there is one.
    pub(super) fn measured_run(
        &self,
        axes: usize,
        rows: &mut [&mut dyn Sink],
        watch: &dyn Watch,
    ) -> Result<Option<MeasuredRun>, JobError> {
        let Some(MeasuredLog { name, log }) = self.log.as_deref() else {
            return Ok(None);
        };
        let steps = path_steps(self.steps()?);
        let limits = |error| JobError::of_run(&self.program, RunError::Limits(error));
        let mut reference = Stages::of(&self.machine)
            .reference(steps, &self.machine)
            .map_err(limits)?;
        let run = measured(log, &self.machine, axes, &mut reference, rows, watch);
        run.map(Some)
            .map_err(|error| JobError::of_log(name, &self.program, error))
    }
}
