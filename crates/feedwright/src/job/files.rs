//! The files that a job writes, all of them or none.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use feedwright_plan::{EventName, PlcEvent, TimedEvent, named};
use feedwright_sim::{Row, SetpointWriter, Sink, TraceWriter, Watch};
use serde::{Deserialize, Serialize};

use super::{Job, JobError};
use crate::correct::CorrectOutcome;
use crate::output::{OutputError, OutputFile, OutputFiles, is_standard_output};
use crate::report::harm::Harm;
use crate::report::{Assumptions, Report, RunSummary, TimelineEvent, write_html};

/// Where to write what; `None` is not written.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Outputs {
    /// The page.
    pub report: Option<PathBuf>,
    /// All results as JSON.
    pub json: Option<PathBuf>,
    /// One row per servo period of the last run.
    pub trace: Option<PathBuf>,
    /// Setpoints of the controller's cut (`.csv`), or the corrected program for a control without feedback (`.ngc`).
    pub out: Option<PathBuf>,
}

/// A tolerance of a metre is a mistaken unit.
const MAX_TOLERANCE_UM: f64 = 1e6;

/// What `--out` writes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Setpoints,
    Gcode,
}

impl Outputs {
    /// Whether a program is to be written.
    pub(super) fn is_program(&self) -> bool {
        self.out.as_deref().is_some_and(|path| Self::form(path).is_ok_and(|form| form == Form::Gcode))
    }

    fn form(path: &Path) -> Result<Form, JobError> {
        let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
        match ending.as_deref() {
            Some("csv") => Ok(Form::Setpoints),
            Some("ngc" | "nc" | "gcode" | "tap") => Ok(Form::Gcode),
            // A program on the standard output; setpoints are a file.
            _ if is_standard_output(path) => Ok(Form::Gcode),
            _ => Err(JobError::Ending { path: path.to_owned() }),
        }
    }
}

impl Job {
    /// Refuses values out of range, and outputs of no known form.
    pub(super) fn check_values(&self) -> Result<(), JobError> {
        let positive = |value: &f64, limit: f64| *value > 0.0 && *value <= limit;
        // A feed that the machine lowers to its limit is not the feed that was asked for.
        let most_mm_s = self.machine.limits.max_feed_mm_s;
        if let Some(value) = self.feed_mm_s.filter(|feed| !positive(feed, most_mm_s)) {
            let bounds = format!("above 0 and up to {most_mm_s} mm/s, the machine's max_feed_mm_s");
            let hint = Some("F3000 in a program is --feed 3000mm/min, or 50mm/s");
            return Err(JobError::Value { name: "--feed", value, unit: " mm/s", bounds, hint });
        }
        if let Some(value) = self.tolerance_um.filter(|tolerance| !positive(tolerance, MAX_TOLERANCE_UM)) {
            let bounds = format!("above 0 and up to {MAX_TOLERANCE_UM} um");
            let hint = Some("the unit is um: 0.01 mm is --tolerance 10");
            return Err(JobError::Value { name: "--tolerance", value, unit: " um", bounds, hint });
        }
        if let Some(out) = &self.outputs.out {
            Outputs::form(out)?;
        }
        if self.outputs.is_program() {
            self.target.suits(&self.machine)?;
            let out = self.outputs.out.clone().unwrap_or_default();
            let other = self.fastest.then_some("--fastest").or_else(|| self.reference.as_ref().map(|_| "--reference"));
            if let Some(option) = other {
                return Err(JobError::NoProgramWith { out, option });
            }
        }
        Ok(())
    }
}

/// The files of a job while they are written.
pub(super) struct Files {
    report: Option<OutputFile>,
    json: Option<OutputFile>,
    trace: Option<TraceWriter<OutputFile>>,
    setpoints: Option<SetpointWriter<OutputFile>>,
    program: Option<OutputFile>,
}

impl Files {
    /// Starts all of them, so that a place that cannot be written is known before the part is cut.
    pub(super) fn create(job: &Job, axes: usize) -> Result<Self, JobError> {
        let outputs = &job.outputs;
        let mut files = OutputFiles::new(job.inputs.iter().chain([&job.part]).map(PathBuf::as_path));
        let mut start = |path: Option<&PathBuf>| path.map(|path| files.start(path)).transpose();
        let form = outputs.out.as_deref().map(Outputs::form).transpose()?;
        let out = |wanted: Form| outputs.out.as_ref().filter(|_| form == Some(wanted));
        Ok(Self {
            report: start(outputs.report.as_ref())?,
            json: start(outputs.json.as_ref())?,
            trace: start(outputs.trace.as_ref())?.map(|output| TraceWriter::new(output, axes)).transpose()?,
            setpoints: start(out(Form::Setpoints))?.map(|output| SetpointWriter::new(output, axes)).transpose()?,
            program: start(out(Form::Gcode))?,
        })
    }

    /// Writes the rest and moves all files to their places.
    pub(super) fn finish(
        self,
        job: &Job,
        report: &Report,
        exported: Option<&CorrectOutcome>,
        watch: &dyn Watch,
    ) -> Result<(), JobError> {
        let mut complete = Vec::new();
        let named = |path: &Path| {
            let path = path.to_owned();
            move |cause| OutputError::from_io(cause, &path)
        };
        if let Some(mut output) = self.report {
            write_html(&mut output, report).map_err(named(output.path()))?;
            complete.push(output);
        }
        if let Some(mut output) = self.json {
            write_json(&mut output, job, report, exported).map_err(named(output.path()))?;
            complete.push(output);
        }
        complete.extend(self.trace.map(TraceWriter::finish).transpose()?);
        if job.is_of_use(report) {
            complete.extend(self.setpoints.map(SetpointWriter::finish).transpose()?);
        }
        if let (Some(mut output), Some(program)) = (self.program, exported.and_then(CorrectOutcome::program)) {
            output.write_all(program.as_bytes()).map_err(named(output.path()))?;
            complete.push(output);
        }
        OutputFile::commit_all(complete, watch)?;
        Ok(())
    }
}

impl Sink for Files {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        self.trace.as_mut().map_or(Ok(()), |sink| sink.row(row))?;
        self.setpoints.as_mut().map_or(Ok(()), |sink| sink.row(row))
    }
}

/// All results: `runs` and what they were made with.
#[derive(Serialize)]
struct Results<'a> {
    version: &'static str,
    part: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<&'a Path>,
    tolerance_um: Option<f64>,
    within_tolerance: bool,
    simulated: bool,
    assumed: &'a Assumptions,
    worse_than_open_loop: Vec<Harm>,
    settings: std::collections::BTreeMap<&'a str, &'a str>,
    machine: &'a feedwright_sim::Machine,
    runs: Vec<&'a RunSummary>,
    #[serde(skip_serializing_if = "Option::is_none")]
    exported: Option<&'a CorrectOutcome>,
}

fn write_json(out: &mut impl Write, job: &Job, report: &Report, exported: Option<&CorrectOutcome>) -> io::Result<()> {
    let results = Results {
        version: env!("CARGO_PKG_VERSION"),
        part: &report.part,
        reference: job.reference.as_deref(),
        tolerance_um: job.tolerance_um,
        within_tolerance: report.is_within_tolerance() && exported.is_none_or(|outcome| outcome.refusal.is_none()),
        simulated: true,
        assumed: &report.assumed,
        worse_than_open_loop: report.harm(),
        settings: report.settings.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect(),
        machine: &job.machine,
        runs: report.runs.iter().map(|run| &run.summary).collect(),
        exported,
    };
    serde_json::to_writer_pretty(&mut *out, &results)?;
    out.write_all(b"\n")
}

/// Most events that the page shows: more than that nobody reads, and a program may have millions.
const MAX_EVENTS: usize = 500;

/// The events of a run, for the page.
#[derive(Debug)]
pub(super) struct Timeline<'a> {
    pub(super) events: Vec<TimelineEvent>,
    /// What the machine builder named.
    named: &'a [PlcEvent],
}

impl<'a> Timeline<'a> {
    pub(super) const fn new(named: &'a [PlcEvent]) -> Self {
        Self { events: Vec::new(), named }
    }
}

impl Sink for Timeline<'_> {
    fn row(&mut self, _: &Row) -> io::Result<()> {
        Ok(())
    }

    fn event(&mut self, t_s: f64, event: &TimedEvent) -> io::Result<()> {
        if self.events.len() < MAX_EVENTS {
            let TimedEvent { duration_s, event, .. } = event;
            let EventName { row, label } = named(&event.kind, self.named);
            self.events.push(TimelineEvent { t_s, duration_s: *duration_s, line: event.line, row, label });
        }
        Ok(())
    }
}
