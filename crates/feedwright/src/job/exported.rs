//! `--out FILE.ngc`: the corrected program for a control that gets no feedback, and its cut beside the others.

use feedwright_sim::{Sink, Watch};

use super::record::RunRecord;
use super::{Job, JobError, Timeline};
use crate::correct::exported::ExportedCut;
use crate::correct::{CorrectJob, CorrectOutcome};
pub(crate) use crate::report::AS_EXPORTED;
use crate::report::{FullCircle, ReportedRun, RunSummary};

impl Job {
    /// The corrected program, where one is asked for, and its run; no run where no text could be written.
    pub(super) fn exported(
        &self,
        circles: &[FullCircle],
        watch: &dyn Watch,
    ) -> Result<Option<(CorrectOutcome, Option<ReportedRun>)>, JobError> {
        if !self.outputs.is_program() {
            return Ok(None);
        }
        let job = CorrectJob {
            part: self.part.clone(),
            machine: self.machine.clone(),
            believed: None,
            target: self.target,
            feed_mm_s: self.feed_mm_s,
            reader: self.reader.clone(),
        };
        let outcome = job.run(watch)?;
        let run = self.exported_run(&outcome, circles, watch)?;
        Ok(Some((outcome, run)))
    }

    /// The run of the text: the figures of all its cuts, and the rows of the one with the largest error.
    fn exported_run(
        &self,
        outcome: &CorrectOutcome,
        circles: &[FullCircle],
        watch: &dyn Watch,
    ) -> Result<Option<ReportedRun>, JobError> {
        let Some(written) = &outcome.written else { return Ok(None) };
        let mut record = RunRecord::new(outcome.axes, self.machine.period.servo_s, circles);
        let mut timeline = Timeline::new(&self.machine.plc_events);
        let stages = self.target.stages(&self.machine);
        let cut = ExportedCut {
            machine: &self.machine,
            stages,
            original: &outcome.original_steps,
            axes: outcome.axes,
            watch,
        };
        let [statistics, series, spectrum, radial] = record.sinks();
        let mut sinks: [&mut dyn Sink; 5] = [statistics, series, spectrum, radial, &mut timeline];
        let run = cut
            .worst(&written.steps, &outcome.corrected, &mut sinks)
            .map_err(|error| JobError::of_run(&self.part, error))?;
        let lines: Vec<&str> = written.text.lines().collect();
        let text = |line: u32| lines.get((line as usize).wrapping_sub(1)).copied().unwrap_or_default().to_owned();
        let figures = outcome.corrected;
        let reported = self.reported_as(record, AS_EXPORTED, run, text);
        let summary = RunSummary {
            time_s: figures.time_s,
            rms_um: figures.rms_um,
            max_um: figures.max_um,
            uncut_um: figures.uncut_um,
            ..reported.summary
        };
        Ok(Some(ReportedRun { summary, events: timeline.events, ..reported }))
    }
}
