//! What the page keeps of the rows and the events of a run.

use std::io;

use feedwright_plan::{EventName, PlcEvent, TimedEvent, named};
use feedwright_sim::{Row, RunResult, Sink};

use super::{Job, JobError};
use crate::report::{
    DriveLimits, ErrorSpectrum, FullCircle, RadialDeviations, ReportedRun, Role, RunFacts, Series,
    Statistics, TimelineEvent,
};

/// Everything that is drawn or counted of a run, while its rows come.
pub(super) struct RunRecord<'a> {
    axes: usize,
    statistics: Statistics,
    series: Series,
    spectrum: ErrorSpectrum,
    radial: RadialDeviations<'a>,
}

impl<'a> RunRecord<'a> {
    /// Creates an empty record.
    pub(super) fn new(axes: usize, servo_s: f64, circles: &'a [FullCircle]) -> Self {
        Self {
            axes,
            statistics: Statistics::new(),
            series: Series::new(),
            spectrum: ErrorSpectrum::new(axes, servo_s),
            radial: RadialDeviations::of(circles),
        }
    }

    /// Returns the sinks of the rows.
    pub(super) fn sinks(&mut self) -> [&mut dyn Sink; 4] {
        [
            &mut self.statistics,
            &mut self.series,
            &mut self.spectrum,
            &mut self.radial,
        ]
    }
}

/// Most events that the page shows. A longer list would not be read, and a program may have
/// millions.
const MAX_EVENTS: usize = 500;

/// The events of a run, for the page.
#[derive(Debug)]
pub(super) struct Timeline<'a> {
    pub(super) events: Vec<TimelineEvent>,
    /// Events that the machine builder named.
    named: &'a [PlcEvent],
}

impl<'a> Timeline<'a> {
    pub(super) const fn new(named: &'a [PlcEvent]) -> Self {
        Self {
            events: Vec::new(),
            named,
        }
    }
}

impl Sink for Timeline<'_> {
    fn row(&mut self, _: &Row) -> io::Result<()> {
        Ok(())
    }

    fn event(&mut self, t_s: f64, event: &TimedEvent) -> io::Result<()> {
        if self.events.len() < MAX_EVENTS {
            let TimedEvent {
                duration_s, event, ..
            } = event;
            let EventName { row, label } = named(&event.kind, self.named);
            self.events.push(TimelineEvent {
                t_s,
                duration_s: *duration_s,
                line: event.line,
                row,
                label,
            });
        }
        Ok(())
    }
}

impl Job {
    /// A run as the page has it; its events are still open.
    pub(super) fn reported(
        &self,
        record: RunRecord<'_>,
        (role, name): (Role, &str),
        run: RunResult,
    ) -> Result<ReportedRun, JobError> {
        let mut reported = self.reported_as(record, (role, name), run, |_| String::new());
        self.fill_in_texts(&mut reported.summary.worst)?;
        Ok(reported)
    }

    /// The same, of a program whose lines have this text.
    pub(super) fn reported_as(
        &self,
        record: RunRecord<'_>,
        (role, name): (Role, &str),
        run: RunResult,
        text: impl Fn(u32) -> String,
    ) -> ReportedRun {
        let facts = RunFacts {
            controller: name.to_owned(),
            machine: self.machine.name.clone(),
            part: self.program.file_name(),
            axes: record.axes,
            role,
            drives: Some(DriveLimits::of(&self.machine)),
            run,
        };
        let summary = record.statistics.summary(facts, text);
        let (spectrum, roundness) = (record.spectrum.bands(), record.radial.roundness());
        ReportedRun {
            summary,
            series: record.series,
            spectrum,
            roundness,
            events: Vec::new(),
        }
    }
}
