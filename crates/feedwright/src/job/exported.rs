//! The corrected program for a control that gets no feedback, and its cut beside the others.

use feedwright_sim::{Sink, Watch};

use super::record::{RunRecord, Timeline};
use super::{Job, JobError};
use crate::correct::exported::ExportedCut;
use crate::correct::{CorrectJob, CorrectOutcome, TargetControl};
use crate::report::{AS_EXPORTED, FullCircle, ReportedRun, Role, RunSummary};

impl Job {
    /// Returns the corrected program, if one is requested. Its run, if a text could be written, is
    /// added behind the others.
    pub(super) fn push_exported(
        &self,
        runs: &mut Vec<ReportedRun>,
        circles: &[FullCircle],
        watch: &dyn Watch,
    ) -> Result<Option<CorrectOutcome>, JobError> {
        let Some(target) = self.target else {
            return Ok(None);
        };
        let job = CorrectJob {
            feed_mm_s: self.request.feed_mm_s,
            reader: self.reader.clone(),
            compensation: self.compensation.clone(),
            file_error: self.request.file_error_part(),
            ..CorrectJob::new(self.program.clone(), self.machine.clone(), target)
        };
        let outcome = job.run(watch)?;
        runs.extend(self.exported_run(target, &outcome, circles, watch)?);
        Ok(Some(outcome))
    }

    /// The run of the text: the figures of all its cuts, and the rows of the one with the largest
    /// error.
    fn exported_run(
        &self,
        target: &TargetControl,
        outcome: &CorrectOutcome,
        circles: &[FullCircle],
        watch: &dyn Watch,
    ) -> Result<Option<ReportedRun>, JobError> {
        let Some(written) = &outcome.written else {
            return Ok(None);
        };
        let mut record = RunRecord::new(outcome.axes, self.machine.period.servo_s, circles);
        let mut timeline = Timeline::new(&self.machine.plc_events);
        let stages = target.stages(&self.machine);
        let cut = ExportedCut {
            machine: &outcome.machine,
            error: None,
            stages,
            original: &outcome.original_steps,
            axes: outcome.axes,
            watch,
        };
        let [statistics, series, spectrum, radial] = record.sinks();
        let mut sinks: [&mut dyn Sink; 5] = [statistics, series, spectrum, radial, &mut timeline];
        let run = cut
            .worst(&written.steps, &outcome.corrected, &mut sinks)
            .map_err(|error| JobError::of_run(&self.program, error))?;
        let lines: Vec<&str> = written.text.lines().collect();
        let text = |line: u32| {
            lines
                .get((line as usize).wrapping_sub(1))
                .copied()
                .unwrap_or_default()
                .to_owned()
        };
        let figures = outcome.corrected;
        let reported = self.reported_as(record, (Role::Exported, AS_EXPORTED), run, text);
        let summary = RunSummary {
            time_s: figures.time_s,
            rms_um: figures.rms_um,
            max_um: figures.max_um,
            uncut_um: figures.uncut_um,
            ..reported.summary
        };
        Ok(Some(ReportedRun {
            summary,
            events: timeline.events,
            ..reported
        }))
    }
}
