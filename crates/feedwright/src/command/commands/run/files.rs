//! The files that `run` writes, all of them or none.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use feedwright_gcode::input::is_standard_input;
use feedwright_sim::{Row, SetpointWriter, Sink, TraceWriter, Watch};
use miette::{Result, miette};

use crate::command::args::run::RunArgs;
use crate::command::terminal::page_units;
use crate::job::{Job, JobOutcome};
use crate::output::{OutputError, OutputFile, OutputFiles, is_standard_output};
use crate::report::write_html_in;

/// Paths of the results; `None` is not written.
#[derive(Debug)]
pub(super) struct Outputs {
    /// The page.
    pub(super) report: Option<PathBuf>,
    /// All results as JSON.
    pub(super) json: Option<PathBuf>,
    /// One row per servo period of the last run.
    pub(super) trace: Option<PathBuf>,
    /// The model that came of the cut.
    pub(super) learned: Option<PathBuf>,
    /// Setpoints of the controller's cut (`.csv`), or the corrected program for a control without
    /// feedback (`.ngc`).
    pub(super) out: Option<PathBuf>,
}

/// `parts/star.ngc` gives `star.report.html`, in the folder where the user is.
fn report_of(part: &Path) -> PathBuf {
    if is_standard_input(part) {
        return PathBuf::from("stdin.report.html");
    }
    let mut name = part.file_stem().unwrap_or_default().to_owned();
    name.push(".report.html");
    PathBuf::from(name)
}

/// Kinds of `--out`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Form {
    Setpoints,
    Gcode,
}

impl Outputs {
    /// Returns the paths that the arguments name.
    pub(super) fn of(args: &RunArgs) -> Self {
        Self {
            report: Some(args.report.clone().unwrap_or_else(|| report_of(&args.part))),
            json: args.json.clone(),
            trace: args.trace.clone(),
            learned: args.learned.clone(),
            out: args.out.clone(),
        }
    }

    /// Returns true if `--out` requests a program.
    pub(super) fn is_program(&self) -> Result<bool> {
        Ok(self.form()? == Some(Form::Gcode))
    }

    /// Returns the form that the ending of `--out` requests.
    fn form(&self) -> Result<Option<Form>> {
        let Some(path) = &self.out else {
            return Ok(None);
        };
        let ending = path
            .extension()
            .and_then(|ending| ending.to_str())
            .map(str::to_ascii_lowercase);
        match ending.as_deref() {
            Some("csv") => Ok(Some(Form::Setpoints)),
            Some("ngc" | "nc" | "gcode" | "tap") => Ok(Some(Form::Gcode)),
            // A program on the standard output; setpoints are a file.
            _ if is_standard_output(path) => Ok(Some(Form::Gcode)),
            _ => Err(miette!(
                help = "the ending decides: .csv for setpoints, .ngc for G-code; - is G-code on the standard output",
                "{} does not say what to write",
                path.display()
            )),
        }
    }
}

/// The files while they are written.
pub(super) struct Files {
    report: Option<OutputFile>,
    json: Option<OutputFile>,
    trace: Option<TraceWriter<OutputFile>>,
    learned: Option<OutputFile>,
    setpoints: Option<SetpointWriter<OutputFile>>,
    program: Option<OutputFile>,
}

impl Files {
    /// Starts all of them, so that a place that cannot be written is known before the part is cut.
    pub(super) fn create(outputs: &Outputs, mut files: OutputFiles, axes: usize) -> Result<Self> {
        let mut start = |path: Option<&PathBuf>| files.start_wanted(path);
        let form = outputs.form()?;
        let out = |wanted: Form| outputs.out.as_ref().filter(|_| form == Some(wanted));
        let of_io = |error| OutputError::from_io(error, Path::new("the output"));
        let (report, json) = (
            start(outputs.report.as_ref())?,
            start(outputs.json.as_ref())?,
        );
        let (trace, setpoints) = (start(outputs.trace.as_ref())?, start(out(Form::Setpoints))?);
        Ok(Self {
            report,
            json,
            learned: start(outputs.learned.as_ref())?,
            trace: trace
                .map(|output| TraceWriter::new(output, axes))
                .transpose()
                .map_err(of_io)?,
            setpoints: setpoints
                .map(|output| SetpointWriter::new(output, axes))
                .transpose()
                .map_err(of_io)?,
            program: start(out(Form::Gcode))?,
        })
    }

    /// Writes the rest and moves all files to their places.
    pub(super) fn finish(
        self,
        job: &Job,
        outcome: &JobOutcome,
        watch: &dyn Watch,
    ) -> Result<(), OutputError> {
        let of_rows = |error| OutputError::from_io(error, Path::new("the output"));
        let mut complete = Vec::new();
        complete.extend(OutputFile::filled(self.report, |file| {
            write_html_in(file, &outcome.report, page_units())
        })?);
        complete.extend(OutputFile::filled(self.json, |file| {
            outcome.write_json(job, file)
        })?);
        let trace = self.trace.map(TraceWriter::finish);
        complete.extend(trace.transpose().map_err(of_rows)?);
        if let Some(model) = &outcome.learned {
            complete.extend(OutputFile::filled(self.learned, |file| {
                file.write_all(model.text().as_bytes())
            })?);
        }
        if outcome.is_of_use {
            let setpoints = self.setpoints.map(SetpointWriter::finish);
            complete.extend(setpoints.transpose().map_err(of_rows)?);
        }
        let exported = outcome.exported.as_ref();
        if let Some(program) = exported.and_then(|exported| exported.program()) {
            complete.extend(OutputFile::filled(self.program, |file| {
                file.write_all(program.as_bytes())
            })?);
        }
        OutputFile::commit_all(complete, watch)
    }
}

impl Sink for Files {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        self.trace.as_mut().map_or(Ok(()), |sink| sink.row(row))?;
        self.setpoints.as_mut().map_or(Ok(()), |sink| sink.row(row))
    }
}
