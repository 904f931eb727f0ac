//! What the page keeps of the rows of a run.

use feedwright_sim::{RunResult, Sink};

use super::{Job, JobError, MEASURED};
use crate::report::{ErrorSpectrum, FullCircle, RadialDeviations, ReportedRun, RunFacts, Series, Statistics};

/// Everything that is drawn or counted of a run, while its rows come.
pub(super) struct RunRecord<'a> {
    axes: usize,
    statistics: Statistics,
    series: Series,
    spectrum: ErrorSpectrum,
    radial: RadialDeviations<'a>,
}

impl<'a> RunRecord<'a> {
    /// Nothing yet.
    pub(super) fn new(axes: usize, servo_s: f64, circles: &'a [FullCircle]) -> Self {
        Self {
            axes,
            statistics: Statistics::new(),
            series: Series::new(),
            spectrum: ErrorSpectrum::new(axes, servo_s),
            radial: RadialDeviations::of(circles),
        }
    }

    /// What takes the rows.
    pub(super) fn sinks(&mut self) -> [&mut dyn Sink; 4] {
        [&mut self.statistics, &mut self.series, &mut self.spectrum, &mut self.radial]
    }
}

impl Job {
    /// A run as the page has it; its events are still open.
    pub(super) fn reported(&self, record: RunRecord<'_>, name: &str, run: RunResult) -> Result<ReportedRun, JobError> {
        let mut reported = self.reported_as(record, name, run, |_| String::new());
        self.fill_in_texts(&mut reported.summary.worst)?;
        Ok(reported)
    }

    /// The same, of a program whose lines have this text.
    pub(super) fn reported_as(
        &self,
        record: RunRecord<'_>,
        name: &str,
        run: RunResult,
        text: impl Fn(u32) -> String,
    ) -> ReportedRun {
        let facts = RunFacts {
            controller: name.to_owned(),
            machine: self.machine.name.clone(),
            part: self.part_name(),
            axes: record.axes,
            measured: name == MEASURED,
            run,
        };
        let summary = record.statistics.summary(facts, text);
        let (spectrum, roundness) = (record.spectrum.bands(), record.radial.roundness());
        ReportedRun { summary, series: record.series, spectrum, roundness, events: Vec::new() }
    }
}
